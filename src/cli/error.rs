//! What went wrong, and with which code the program ends.

use super::*;
use crate::picture::PictureError;
use crate::scenario::ScenarioErrors;
use crate::verify::{SuiteError, VerifyError};
use crate::viewer::ServerError;

/// How a command ended that did what it was asked.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ExitStatus {
    /// Done: exit code 0.
    Done = 0,
    /// Done, but an expectation was missed that was to be met: exit code 1.
    ExpectationMissed = 1,
}

impl ExitStatus {
    /// By whether all that was expected is so.
    pub(super) fn by(is_met: bool) -> Self {
        if is_met { Self::Done } else { Self::ExpectationMissed }
    }
}

impl From<ExitStatus> for ExitCode {
    fn from(status: ExitStatus) -> Self {
        Self::from(status as u8)
    }
}

/// Why a command did not do what it was asked.
#[derive(Debug, thiserror::Error)]
pub enum CliError {
    /// The scenario has faults, or could not be read.
    #[error(transparent)]
    Scenario(#[from] ScenarioErrors),
    /// The study did not finish.
    #[error(transparent)]
    Study(#[from] StudyError),
    /// A built-in verification case has a fault.
    #[error(transparent)]
    Case(#[from] VerifyError),
    /// The verification did not finish.
    #[error(transparent)]
    Suite(#[from] SuiteError),
    /// A run could not be exported.
    #[error(transparent)]
    Export(#[from] ExportError),
    /// A picture could not be made.
    #[error(transparent)]
    Picture(#[from] PictureError),
    /// A page could not be served.
    #[error(transparent)]
    Server(#[from] ServerError),
    /// An option names something that is not there.
    #[error("{0}")]
    Usage(String),
    /// A file could not be read or written.
    #[error(transparent)]
    File(#[from] FileError),
    /// The system starts no threads.
    #[error("no thread could be started: {0}; is the number of processes limited (ulimit -u)?")]
    Threads(String),
    /// The program itself failed: a panic.
    #[error("a fault of the program ended it, please report it: {0}")]
    Fault(String),
    /// Stopped by Ctrl-C before the command wrote its files.
    #[error("stopped; nothing is written")]
    Stopped,
    /// The results could not be printed.
    #[error("cannot write to the standard output: {0}")]
    Output(#[from] io::Error),
}

impl CliError {
    /// The exit code: 2 wrong usage or scenario, or a file or folder of the wrong kind, 3 the
    /// simulation failed, 4 files that are not there or that the system does not let be read or
    /// written, as an `--out` that is a file, 130 stopped by Ctrl-C (as shells have it: 128 +
    /// SIGINT).
    pub fn exit_code(&self) -> u8 {
        let by_refusal = |refused| if refused { 2 } else { 4 };
        match self {
            Self::Stopped | Self::Picture(PictureError::Cancelled) => 130,
            Self::File(error)
            | Self::Export(ExportError::File(error))
            | Self::Suite(SuiteError::File(error))
            | Self::Study(StudyError::File(error)) => by_refusal(error.refused),
            Self::Picture(error) => by_refusal(error.is_usage()),
            Self::Scenario(error) | Self::Study(StudyError::Faults(error)) => {
                by_refusal(matches!(error, ScenarioErrors::Faults(_)))
            }
            Self::Usage(_) | Self::Case(_) | Self::Server(_) | Self::Export(_) => 2,
            Self::Study(StudyError::Scenario(_) | StudyError::Stage { .. }) => 2,
            Self::Threads(_) | Self::Fault(_) | Self::Suite(SuiteError::Threads(_)) => 3,
            Self::Study(
                StudyError::Simulation { .. } | StudyError::Fault { .. } | StudyError::Measure(_),
            ) => 3,
            Self::Output(_) => 4,
            Self::Suite(SuiteError::Report(_)) | Self::Study(StudyError::Report(_)) => 4,
            Self::Suite(SuiteError::Cancelled(_)) | Self::Study(StudyError::Cancelled) => 130,
        }
    }
}

/// A file or folder that a command leaves as it is, with the reason.
pub(super) fn refused(action: &'static str, path: &Path, reason: impl ToString) -> FileError {
    FileError { refused: true, ..FileError::new(action, path, reason) }
}

#[cfg(test)]
mod tests {
    use std::path::{Path, PathBuf};

    use super::*;

    #[test]
    fn exit_codes_are_those_of_the_contract() {
        let file = || FileError::new("write", Path::new("a"), "full");
        let simulation =
            StudyError::Simulation { stage: "pour".into(), what: "NaN".into(), kept: "b".into() };
        let unfit = || FileError::unfit(Path::new("a"), "it is of other grains");
        let cases: [(CliError, u8); 13] = [
            (ScenarioErrors::Faults(Vec::new()).into(), 2),
            (ScenarioErrors::Unreadable { file: PathBuf::new(), reason: "".into() }.into(), 4),
            (StudyError::Scenario("bad".into()).into(), 2),
            (simulation.into(), 3),
            (StudyError::File(file()).into(), 4),
            (file().into(), 4),
            (unfit().into(), 2),
            (StudyError::File(unfit()).into(), 2),
            (ExportError::File(unfit()).into(), 2),
            (PictureError::File(unfit()).into(), 2),
            (StudyError::Cancelled.into(), 130),
            (CliError::Stopped, 130),
            (PictureError::Cancelled.into(), 130),
        ];
        for (error, expected) in cases {
            assert_eq!(error.exit_code(), expected, "exit code of: {error}");
        }
    }
}
