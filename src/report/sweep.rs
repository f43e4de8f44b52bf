//! What a sweep found.

use super::*;
use crate::measure::{bootstrap_interval, inference::MeanTest};
use crate::record::Withheld;
use crate::scenario::Scenario;

/// The field that names the specimen that a run begins with, and its column in the table of runs.
pub const SPECIMEN: &str = "begin.specimen";

/// What is varied.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SweepFactor {
    /// The field of the scenario.
    pub path: String,
    /// Its values in the order in which they were given; of a sampled range
    /// its two ends.
    pub values: Vec<Value>,
    /// Whether values were drawn from between the two.
    pub sampled: bool,
    /// Whether all values are numbers.
    pub numeric: bool,
}

impl SweepFactor {
    /// A value as a number: the number of its place, from 1, where values are
    /// no numbers.
    pub fn number(&self, value: &Value) -> f64 {
        let place = || self.values.iter().position(|v| v == value).map_or(0, |n| n + 1);
        if self.numeric { value.as_f64().unwrap_or(f64::NAN) } else { place() as f64 }
    }

    /// Its values as they rise; words in the order in which they were given.
    pub(super) fn rising(&self) -> Vec<&Value> {
        let mut values: Vec<&Value> = self.values.iter().collect();
        values.sort_by(|a, b| self.number(a).total_cmp(&self.number(b)));
        values
    }

    /// Whether a result can rise or fall along its values: not along words, nor along numbers that
    /// only name realisations.
    pub fn has_slope(&self) -> bool {
        self.numeric && !Scenario::names_realisations(&self.path)
    }
}

/// One run.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct SweepRun {
    /// Its name and that of its folder.
    pub run: String,
    /// The point that it belongs to.
    pub point: String,
    /// Which realisation, counted from 1.
    pub configuration: u32,
    /// The specimen that it begins with, where specimens stand for realisations.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub specimen: Option<Value>,
    /// The value of each factor.
    pub values: Vec<Value>,
    /// Results by their path in `summary.json`; what was not measured is absent.
    pub outcomes: BTreeMap<String, f64>,
    /// Whether overlap and numerical creep meet the accuracy standard; none without result.
    pub meets_standard: Option<bool>,
    /// Whether the run is valid, as its summary has it; none without result.
    pub valid: Option<bool>,
    /// Why its result is left out of means and effects; none where it counts, or has none.
    pub left_out_of_means: Option<String>,
    /// Why it has no result.
    pub failure: Option<String>,
    /// Results that its summary does not give, each with the reason.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub withheld: Vec<Withheld>,
}

/// How the reason ends of a run without result of which a stage has not been run so far.
pub const NOT_STORED: &str = "is not stored";

impl SweepRun {
    /// One for tests that counts, without a name and values.
    #[cfg(test)]
    pub fn counted() -> Self {
        Self { meets_standard: Some(true), valid: Some(true), ..Self::default() }
    }

    /// Whether it has no result because it has not been run to its end, and did not fail either.
    pub fn is_to_be_run(&self) -> bool {
        self.failure.as_deref().is_some_and(|why| why.ends_with(NOT_STORED))
    }

    /// Whether it counts in means and effects.
    pub fn counts_in_means(&self) -> bool {
        self.failure.is_none() && self.left_out_of_means.is_none()
    }

    /// Why its summary does not give a result, where it says so.
    pub fn why_withheld(&self, outcome: &str) -> Option<&str> {
        let is_of = |of: &&Withheld| {
            let rest = outcome.strip_prefix(of.field.as_str());
            rest.is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
        };
        self.withheld.iter().find(is_of).map(|of| of.reason.as_str())
    }
}

/// A mean over the configurations of a point.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct SweepEstimate {
    /// Number of values.
    pub count: usize,
    /// Their mean.
    pub mean: f64,
    /// Standard deviation; none of a single value.
    pub standard_deviation: Option<f64>,
    /// 95 % confidence interval of the mean by Student's t; none of a single value.
    pub t_low: Option<f64>,
    /// Its upper end.
    pub t_high: Option<f64>,
    /// 95 % percentile bootstrap interval; none of fewer than three values.
    pub bootstrap_low: Option<f64>,
    /// Its upper end.
    pub bootstrap_high: Option<f64>,
}

impl SweepEstimate {
    /// Of values; none of no values.
    pub fn of(values: &[f64]) -> Option<Self> {
        let mean = crate::measure::statistics::mean(values)?;
        let test = MeanTest::of(values, 0.95);
        let bootstrap = bootstrap_interval(values, 0.95);
        Some(Self {
            count: values.len(),
            mean,
            standard_deviation: test.map(|t| t.standard_deviation),
            t_low: test.map(|t| t.estimate.mean - t.half_width),
            t_high: test.map(|t| t.estimate.mean + t.half_width),
            bootstrap_low: bootstrap.map(|b| b.0),
            bootstrap_high: bootstrap.map(|b| b.1),
        })
    }
}

/// One point: means over its configurations, of the runs that count in means.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SweepPoint {
    /// Its name.
    pub point: String,
    /// The value of each factor.
    pub values: Vec<Value>,
    /// Runs with a result.
    pub runs: usize,
    /// How many of them are valid.
    pub valid: usize,
    /// How many of them are left out of the means.
    pub left_out: usize,
    /// Runs without.
    pub failed: usize,
    /// Results by their path in `summary.json`.
    pub outcomes: BTreeMap<String, SweepEstimate>,
}

/// How one factor moves one result, all others averaged over.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct SweepEffect {
    /// The field of the scenario.
    pub factor: String,
    /// The result, by its path in `summary.json`.
    pub outcome: String,
    /// Runs that have the result and count.
    pub runs: usize,
    /// Runs that have the result and are left out.
    pub left_out: usize,
    /// Runs that count and withhold the result.
    pub withheld: usize,
    /// The mean at each value; empty where values were drawn.
    pub means: Vec<(Value, SweepEstimate)>,
    /// Change of the result for one unit of the factor: the mean over
    /// configurations of each one's own slope. None where values are no numbers, or only name
    /// realisations.
    pub slope: Option<f64>,
    /// Factors that change together with it in all runs, so that nothing tells which of them moves
    /// the result: there is no slope then.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub together_with: Vec<String>,
    /// Half of its 95 % confidence interval by Student's t; none of one configuration.
    pub slope_half_width: Option<f64>,
    /// Two-sided p-value of no slope.
    pub slope_p: Option<f64>,
    /// Two-sided p-value of Page's trend test by ranks; none of fewer than three values or two
    /// configurations, or more than eight values.
    pub page_p: Option<f64>,
    /// Configurations that would show a slope of this size among this scatter, at
    /// 95 % confidence with a probability of 80 %; none of fewer than three
    /// configurations, where it is not known, or more than 100 000.
    pub configurations_needed: Option<usize>,
}

/// Everything that a sweep found.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Sweep {
    /// Name of the scenario.
    pub scenario: String,
    /// `grid`, `one_at_a_time` or `latin_hypercube`.
    pub design: &'static str,
    /// What is varied.
    pub factors: Vec<SweepFactor>,
    /// Realisations of each point: configurations, or specimens.
    pub configurations: u32,
    /// The specimens that stand for realisations, in the order of their numbers; none where
    /// configurations are the realisations.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub specimens: Vec<Value>,
    /// How many runs the plan has; fewer have been run so far, or failed.
    pub planned: usize,
    /// The runs.
    pub runs: Vec<SweepRun>,
    /// The points.
    pub points: Vec<SweepPoint>,
    /// The effects, factor by factor.
    pub effects: Vec<SweepEffect>,
    /// Names of a laboratory, by which its results are called on the page.
    #[serde(skip)]
    pub names: LaboratoryNames,
}

impl Sweep {
    /// What a realisation of a point is.
    pub fn realisation(&self) -> &'static str {
        if self.specimens.is_empty() { "realisation" } else { "specimen" }
    }

    /// Runs whose results are left out of means and effects.
    pub fn left_out(&self) -> impl Iterator<Item = &SweepRun> {
        self.runs.iter().filter(|r| r.failure.is_none() && !r.counts_in_means())
    }

    /// Runs that have no result.
    pub fn failed(&self) -> impl Iterator<Item = &SweepRun> {
        self.runs.iter().filter(|r| r.failure.is_some())
    }
}

/// What stands in the place of a change for one unit of a number that only names realisations.
pub(super) const NO_UNIT: &str = "none: its numbers only name realisations";

/// A value without the quotes of a text.
pub(super) fn shown(value: &Value) -> String {
    value.as_str().map_or_else(|| value.to_string(), str::to_owned)
}
