//! What a calibration found: the value of an unknown at which a result is as wanted, with everything
//! that was tried.

use serde::Serialize;

use crate::measure::Interval;

/// Friction coefficient between grains that Izadi & Bezuijen (2014, section 3) took from an angle of
/// repose, as its tangent.
pub const PUBLISHED_FRICTION: f64 = 0.793;
/// That angle in degrees.
pub const PUBLISHED_ANGLE_OF_REPOSE_DEG: f64 = 38.40;

/// One run of a calibration.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct CalibrationRun {
    /// Value of the unknown.
    pub value: f64,
    /// Which realisation, counted from the scenario's own as 1.
    pub configuration: u32,
    /// Name of the run and of its folder under `runs/`.
    pub run: String,
    /// The result; `None` where the run failed or did not measure it.
    pub result: Option<f64>,
    /// Grains left hanging in the funnel at the end.
    pub left_in_funnel: Option<u64>,
    /// Grains that passed a wall or the floor: an engine failure.
    pub escaped: Option<u64>,
    /// Whether overlap and numerical creep meet the accuracy standard.
    pub meets_standard: Option<bool>,
    /// Wall time in s of all its stages, whenever they were computed.
    pub wall_s: Option<f64>,
    /// Whether the run is valid, as its summary has it.
    pub valid: Option<bool>,
    /// Why the result is left out, as that of a run that failed; none where it counts.
    pub left_out_of_means: Option<String>,
    /// Why there is no result.
    pub failure: Option<String>,
}

impl CalibrationRun {
    /// The result, where it counts.
    pub fn counted(&self) -> Option<f64> {
        self.result.filter(|_| self.left_out_of_means.is_none())
    }

    /// Whether there is a result that is left out.
    pub fn is_left_out(&self) -> bool {
        self.result.is_some() && self.left_out_of_means.is_some()
    }

    /// A run that has nothing yet.
    pub fn new(value: f64, configuration: u32, run: &str) -> Self {
        Self { value, configuration, run: run.to_owned(), ..Self::default() }
    }
}

/// All runs of one value of the unknown.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CalibrationValue {
    /// Value of the unknown.
    pub value: f64,
    /// Number of runs.
    pub runs: usize,
    /// How many have no result.
    pub failed: usize,
    /// How many have a result that is left out.
    pub left_out: usize,
    /// Mean result.
    pub mean: Option<f64>,
    /// Standard deviation of single results, with n − 1 in the denominator.
    pub standard_deviation: Option<f64>,
    /// Half the 95 % confidence interval of the mean, by Student's t.
    pub half_width_95: Option<f64>,
    /// Whether the final line was fitted to it; of none where there is no solution.
    pub in_fit: bool,
}

/// How a calibration ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum CalibrationEnding {
    /// Found, as well as was asked.
    Found,
    /// The runs that were allowed are used up; what is known is reported.
    RunsUsedUp,
    /// No value in the range gives the wanted result.
    OutOfReach,
    /// The result does not depend on the unknown beyond its scatter, in the range or around the
    /// wanted result.
    Flat,
    /// Too many runs failed.
    Failed,
}

/// The value of the unknown that was asked for.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct CalibrationSolution {
    /// Value of the unknown at which the mean result is the wanted one.
    pub value: f64,
    /// Its 95 % confidence interval (Fieller's); `None` where it has no ends.
    /// It may reach beyond the range that was searched.
    pub interval_95: Option<Interval>,
    /// Half the 95 % confidence interval of the mean result there.
    pub result_half_width_95: f64,
    /// Half the interval of the unknown in units of the result: the larger
    /// side times the slope. Compared with the tolerance.
    pub interval_in_result: Option<f64>,
    /// Slope of the line: change of the result for one unit of the unknown.
    pub slope: f64,
    /// Half its 95 % confidence interval.
    pub slope_half_width_95: f64,
    /// Mean of the values that the line was fitted to.
    pub centre: f64,
    /// Height of the line there.
    pub level: f64,
    /// p-value of no curvature within the values of the fit; `None` of two values.
    pub curvature_p: Option<f64>,
    /// Number of configurations that the line was fitted to.
    pub configurations: usize,
}

/// The assumption that the angle of repose is the angle of friction between
/// surfaces, compared with the runs.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct FrictionIdentity {
    /// Friction coefficient it gives: the tangent of the wanted angle.
    pub friction: f64,
    /// Angle of friction in degrees of the coefficient that was found; `None` where
    /// none was.
    pub friction_angle_found_degrees: Option<f64>,
    /// Friction coefficient of the runs beside it: `friction`, rounded as values are.
    pub tried: f64,
    /// Mean angle of repose of these runs in degrees.
    pub degrees_there: Option<f64>,
    /// Mean of angle of repose less angle of friction at `tried`, in degrees.
    pub difference_degrees: Option<f64>,
    /// Half its 95 % confidence interval.
    pub difference_half_width_95: Option<f64>,
    /// Two-sided p-value of no difference (Student's t-test).
    pub p: Option<f64>,
    /// Whether the found interval holds `friction`.
    pub inside_interval: Option<bool>,
    /// The friction coefficient that the paper took from it.
    pub paper_friction: f64,
}

/// `calibrate.json`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Calibration {
    /// Name of the scenario.
    pub scenario: String,
    /// Field of the run's `summary.json` that is wanted.
    pub target: String,
    /// Its unit; empty for pure numbers.
    pub unit: String,
    /// Its wanted value.
    pub wanted: f64,
    /// Field of the scenario that is sought.
    pub unknown: String,
    /// Between which values.
    pub between: Interval,
    /// How it ended.
    pub ending: CalibrationEnding,
    /// That in a sentence.
    pub statement: String,
    /// The value found.
    pub solution: Option<CalibrationSolution>,
    /// How well the result was to be known, in its unit.
    pub tolerance: Option<f64>,
    /// Whether the tolerance was given, and not taken from the scatter.
    pub tolerance_given: bool,
    /// Standard deviation of a single run about the mean of its value.
    pub scatter: Option<f64>,
    /// Runs at least a value of the unknown.
    pub replicates: u32,
    /// Most runs allowed.
    pub most_runs: usize,
    /// What a reader must know beside.
    pub notes: Vec<String>,
    /// Where the target is the angle of repose and the unknown the friction
    /// between grains.
    pub identity: Option<FrictionIdentity>,
    /// Every value tried, in rising order.
    pub values: Vec<CalibrationValue>,
    /// Every run.
    pub runs: Vec<CalibrationRun>,
}

/// What is sought, for sentences: a name where there is one, or the field.
pub fn unknown_in_words(field: &str) -> &str {
    if field == "contact.grain_grain_friction" { "friction between grains" } else { field }
}

/// What is measured, for sentences.
pub fn target_in_words(field: &str) -> &str {
    if field == "angle_of_repose.degrees" { "angle of repose" } else { field }
}

/// A value with its unit, `38.4°` or `160 mm`.
pub fn with_unit(number: &str, unit: &str) -> String {
    match unit {
        "" => number.to_owned(),
        "°" => format!("{number}°"),
        unit => format!("{number} {unit}"),
    }
}
