//! Pressed pieces whose forces keep a mean stress while others move.

use super::*;

/// Which pieces keep the mean stress in which region.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct KeepMeanStressSpec {
    /// Name of a region of `measures.regions`. The mean stress of its contacts, a third of the
    /// trace, is to stay what it was when the stage began.
    #[schemars(length(min = 1, max = 40))]
    pub region: String,
    /// Names of pieces that forces press: all these forces are multiplied by the same factor.
    #[schemars(length(min = 1, max = 100))]
    pub pieces: Vec<String>,
    /// Time in s over which the mean stress is smoothed, and within which the factor follows it.
    #[serde(default = "window")]
    #[schemars(extend("exclusiveMinimum" = 0.0, "maximum" = 60.0))]
    pub window_s: f64,
}

defaults! {
    pub(super) window: f64 = 0.1;
}
