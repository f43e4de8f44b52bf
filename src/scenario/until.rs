//! Conditions that end stages: something measured reaches what is asked for.

use super::*;

/// What ends a stage: one condition; or a list of conditions, of which any one ends it; or an
/// object with `all_of`, a list of conditions that have to hold at the same time. Conditions are
/// looked at every 0.02 s of grains of the paper's size, from when the stage begins.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
#[allow(clippy::large_enum_variant)] // a scenario has a handful of stages
pub enum UntilSpec {
    /// Conditions that have to hold at the same time.
    All(AllOfSpec),
    /// Conditions of which any one ends the stage.
    Any(#[schemars(length(min = 1, max = 20))] Vec<ConditionSpec>),
    /// One condition.
    One(ConditionSpec),
}

parts! {
/// Conditions that have to hold at the same time.
pub struct AllOfSpec {
    /// The conditions.
    pub all_of: Vec<ConditionSpec>, length 1 to 20;
}

/// One condition on one piece, group or opening.
#[derive(Default)]
#[serde(default)]
pub struct ConditionSpec {
    /// Name of a piece, or of a group of `measures.groups`; or `opening`.
    pub piece: Option<String>, skip "Option::is_none", length 1 to 40;
    /// Name of an opening of `measures.openings`.
    pub opening: Option<String>, skip "Option::is_none", length 1 to 40;
    /// Direction along which a force or a displacement counts; its length does not matter. A
    /// force needs it; a displacement without it counts in every direction.
    pub direction: Option<[f64; 3]>, skip "Option::is_none";
    /// Ends when the force of the grains on the piece along `direction`, mean over the window,
    /// is as large as this, in N.
    pub force_n: Option<f64>, skip "Option::is_none", above 0.0 to 1e9;
    /// Ends when that force has changed by no more than this from the window before to the last
    /// one, in percent of the last one.
    pub steady_force_percent: Option<f64>, skip "Option::is_none", above 0.0 to 100.0;
    /// Ends when the piece has moved so far since the stage began, in mm.
    pub moved_mm: Option<f64>, skip "Option::is_none", above 0.0 to 100000.0;
    /// Ends when the piece has turned so far since the stage began, in degrees: of one that a
    /// moment turns about its axis, the whole angle; of others at most 180.
    pub turned_deg: Option<f64>, skip "Option::is_none", above 0.0 to 1e6;
    /// Ends when the flow through the opening, mean over the window, falls below this, in g/s,
    /// after it was above it.
    pub flow_below_g_per_s: Option<f64>, skip "Option::is_none", above 0.0 to 1e9;
    /// Ends when the flow has changed by no more than this from the window before to the last
    /// one, in percent of the last one.
    pub steady_flow_percent: Option<f64>, skip "Option::is_none", above 0.0 to 100.0;
    /// Length of the window in s; left out, 0.2.
    pub window_s: Option<f64>, skip "Option::is_none", above 0.0 to 60.0;
}
}

/// Length of a window in s that is not given.
const WINDOW: f64 = 0.2;

impl UntilSpec {
    /// Its conditions, each with where it stands below `until`.
    pub(super) fn placed(&self) -> impl Iterator<Item = (String, &ConditionSpec)> {
        let place = move |k: usize| match self {
            Self::One(_) => String::new(),
            Self::Any(_) => format!("[{k}]"),
            Self::All(_) => format!(".all_of[{k}]"),
        };
        self.conditions().iter().enumerate().map(move |(k, condition)| (place(k), condition))
    }

    /// Its conditions.
    pub fn conditions(&self) -> &[ConditionSpec] {
        match self {
            Self::One(one) => std::slice::from_ref(one),
            Self::Any(conditions) | Self::All(AllOfSpec { all_of: conditions }) => conditions,
        }
    }
}

impl ConditionSpec {
    /// The conditions that are given, by their fields, with the numbers.
    pub fn given(&self) -> Vec<(&'static str, f64)> {
        let all = [
            ("force_n", self.force_n),
            ("steady_force_percent", self.steady_force_percent),
            ("moved_mm", self.moved_mm),
            ("turned_deg", self.turned_deg),
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
