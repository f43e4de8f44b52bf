//! Conditions that end stages: something measured reaches what is asked for.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// One condition on one piece, group or opening. It is looked at every 0.02 s of grains of the
/// paper's size, from when the stage begins.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct UntilSpec {
    /// Name of a piece, or of a group of `measures.groups`; or `opening`.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(with = "String", length(min = 1, max = 40))]
    pub piece: Option<String>,
    /// Name of an opening of `measures.openings`.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(with = "String", length(min = 1, max = 40))]
    pub opening: Option<String>,
    /// Direction along which a force or a displacement counts; its length does not matter. A
    /// force needs it; a displacement without it counts in every direction.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(with = "[f64; 3]")]
    pub direction: Option<[f64; 3]>,
    /// Ends when the force of the grains on the piece along `direction`, mean over the window,
    /// is as large as this, in N.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(with = "f64", extend("exclusiveMinimum" = 0.0, "maximum" = 1e9))]
    pub force_n: Option<f64>,
    /// Ends when that force has changed by no more than this from the window before to the last
    /// one, in percent of the last one.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(with = "f64", extend("exclusiveMinimum" = 0.0, "maximum" = 100.0))]
    pub steady_force_percent: Option<f64>,
    /// Ends when the piece has moved so far since the stage began, in mm.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(with = "f64", extend("exclusiveMinimum" = 0.0, "maximum" = 100000.0))]
    pub moved_mm: Option<f64>,
    /// Ends when the flow through the opening, mean over the window, falls below this, in g/s,
    /// after it was above it.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(with = "f64", extend("exclusiveMinimum" = 0.0, "maximum" = 1e9))]
    pub flow_below_g_per_s: Option<f64>,
    /// Ends when the flow has changed by no more than this from the window before to the last
    /// one, in percent of the last one.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(with = "f64", extend("exclusiveMinimum" = 0.0, "maximum" = 100.0))]
    pub steady_flow_percent: Option<f64>,
    /// Length of the window in s; left out, 0.2.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(with = "f64", extend("exclusiveMinimum" = 0.0, "maximum" = 60.0))]
    pub window_s: Option<f64>,
}

/// Length of a window in s that is not given.
const WINDOW: f64 = 0.2;

impl UntilSpec {
    /// The conditions that are given, by their fields, with the numbers.
    pub(super) fn conditions(&self) -> Vec<(&'static str, f64)> {
        let all = [
            ("force_n", self.force_n),
            ("steady_force_percent", self.steady_force_percent),
            ("moved_mm", self.moved_mm),
            ("flow_below_g_per_s", self.flow_below_g_per_s),
            ("steady_flow_percent", self.steady_flow_percent),
        ];
        all.into_iter().filter_map(|(name, value)| Some((name, value?))).collect()
    }

    /// Length of the window in s.
    pub fn window(&self) -> f64 {
        self.window_s.unwrap_or(WINDOW)
    }
}
