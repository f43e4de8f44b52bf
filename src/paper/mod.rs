//! One paper: what it states, with section and figure, its programme run by us, how each statement
//! is compared with the runs, and the report that says so. No module below uses it; its scenarios
//! stand in `study/presets.rs`, its friction and angle of repose in `report/calibration.rs`.
//!
//! The paper is Izadi & Bezuijen (2014), "Simulation of granular soil behaviour using the Bullet
//! physics library". Only its text was available to us: for what stood in its figures alone (sieve
//! curve, laboratory bands of Figures 7 and 10, size of the funnel) we substitute no values.

pub mod bands;
#[cfg(test)]
pub(crate) mod canned;
mod claim;
mod claims;
pub mod constants;
mod fluctuation;
mod mean_settlement;
mod programme;
mod report;
mod scorecard;
pub mod uncertainty;
mod view;

pub use bands::{PaperValue, Stated};
pub use claim::{Claim, ClaimKind, NotValid, Verdict};
pub use claims::claims;
pub use mean_settlement::MeanSettlement;
pub use programme::{
    Interpretation, InterpretationsOptions, InterpretationsOutcome, ReproduceOptions,
    ReproduceOutcome, interpretations, reproduce,
};
pub use report::{
    Choice, Column, InterpretationCell, InterpretationColumn, InterpretationFailure,
    InterpretationRow, ReportInput, choices, pile_choices, write as write_report,
    write_interpretations,
};
pub use scorecard::{ResultCounts, RowCounts, ScoreRow, Scorecard, scorecard};
pub use uncertainty::{Uncertainty, uncertainty};
pub use view::{Intermittent, StudyView};
