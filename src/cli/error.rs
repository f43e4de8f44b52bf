//! What can go wrong on the command line, and with which exit code.

use crate::record::FileError;
use crate::scenario::ScenarioErrors;
use crate::study::StudyError;

/// Why a command did not do its work.
#[derive(Debug, thiserror::Error)]
pub enum CliError {
    /// The scenario cannot be read or is faulty.
    #[error(transparent)]
    Scenario(#[from] ScenarioErrors),
    /// A file could not be read or written.
    #[error(transparent)]
    File(#[from] FileError),
    /// A study did not finish.
    #[error(transparent)]
    Study(#[from] StudyError),
}

impl CliError {
    /// 2 bad scenario, 3 the simulation failed, 4 files, 130 interrupted.
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Scenario(ScenarioErrors::Faults(_)) => 2,
            Self::Scenario(ScenarioErrors::Unreadable { .. }) | Self::File(_) => 4,
            Self::Study(error) => match error {
                StudyError::Scenario(_) | StudyError::Stage { .. } => 2,
                StudyError::Simulation { .. } | StudyError::Measure(_) => 3,
                StudyError::File(_) | StudyError::Report(_) => 4,
                StudyError::Cancelled => 130,
            },
        }
    }
}
