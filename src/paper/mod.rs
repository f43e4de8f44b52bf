//! What the paper states, with section and figure, and how each statement is
//! compared with the runs of a study.
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
mod scorecard;
pub(crate) mod text;
pub mod uncertainty;
mod view;

pub use bands::{Interval, PaperValue, Stated};
pub use claim::{Claim, ClaimKind, NotValid, Verdict};
pub use claims::claims;
pub use scorecard::{ResultCounts, RowCounts, ScoreRow, Scorecard, scorecard};
pub use uncertainty::{Uncertainty, uncertainty};
pub use view::{Intermittent, StudyView};
pub(crate) use view::{gradation_in_words, settlement_curve};
