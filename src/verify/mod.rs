//! Analytical benchmarks: small experiments whose outcome is known from mechanics,
//! run on an engine through the same seam as the paper's experiment.
//!
//! A case is a file of `scenarios/verification/`: an experiment with its numbers, the law it must
//! obey, the expected value, the tolerance and where they come from. What an engine is known to
//! miss stands in the case with the reason; it stays in the table as failing, and a known failure
//! that passes is reported, so that it cannot go unnoticed.

mod bench;
mod case;
mod experiment;
mod judge;
mod page;
mod scene;
mod suite;
mod view;

pub use bench::{Bench, Setting, settings};
pub use case::{Case, KnownFailure, builtin};
pub use experiment::Outcome;
pub use judge::{Status, Verdict, within};
pub use scene::grains;
pub use suite::{SuiteError, SuiteOptions, run_suite, tally};
pub use view::View;

use std::sync::RwLock;

use crate::geometry::PolyhedronError;
use crate::world::{WorldError, WorldMaker};

/// Why a case could not be run.
#[derive(Debug, thiserror::Error)]
pub enum VerifyError {
    /// A case file has a fault.
    #[error("{file}: {reason}")]
    Case {
        /// The file.
        file: String,
        /// What is wrong, with the place in the file.
        reason: String,
    },
    /// The engine refused or failed.
    #[error(transparent)]
    World(#[from] WorldError),
    /// The experiment could not be set up.
    #[error("the experiment could not be set up: {0}")]
    Setup(String),
    /// The experiment ended without the event it waits for.
    #[error("the experiment ended without {0}")]
    NoEvent(&'static str),
}

impl From<PolyhedronError> for VerifyError {
    fn from(error: PolyhedronError) -> Self {
        Self::Setup(error.to_string())
    }
}

/// Worlds of one process must agree on what Bullet keeps per process. Cases
/// that change it run alone.
static PROCESS: RwLock<()> = RwLock::new(());

/// Runs a case on an engine and judges what came out. An experiment
/// that could not be run has failed; the reason is in the note.
pub fn verify(case: &Case, setting: &Setting, make: WorldMaker) -> Verdict {
    let bench = Bench::new(setting.engine.clone(), make);
    let outcome = if case.experiment.needs_the_process() {
        let _alone = PROCESS.write().unwrap_or_else(std::sync::PoisonError::into_inner);
        case.experiment.run(&bench)
    } else {
        let _shared = PROCESS.read().unwrap_or_else(std::sync::PoisonError::into_inner);
        case.experiment.run(&bench)
    };
    Verdict::of(case, setting, outcome)
}
