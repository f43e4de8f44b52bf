//! How everything comes to rest after a vibration.

use schemars::JsonSchema;

use super::*;

/// What became of a specimen after the last period of a vibration, with the table at its place.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Settling {
    /// Time in s from the end of shaking to the end of the stage: with what was held to count
    /// as settled, or the limit.
    pub time_s: f64,
    /// The limit in s.
    pub limit_s: f64,
    /// Whether it settled by the scenario's criterion.
    pub settled: bool,
}
