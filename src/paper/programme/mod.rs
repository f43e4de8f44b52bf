//! The paper's whole programme, run and compared with what the paper states: as it is, and under
//! several interpretations of the paper side by side.

mod beside;
mod departures;
mod interpretations;
mod pictures;
mod reproduce;
mod side_by_side;

use super::*;

pub use interpretations::Interpretation;
pub use reproduce::{ReproduceOptions, ReproduceOutcome, reproduce};
pub use side_by_side::{InterpretationsOptions, InterpretationsOutcome, interpretations};
