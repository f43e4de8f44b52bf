//! What a calibration found: the value of an unknown at which a result is as
//! wanted, with everything that was tried, as tables and a figure.

use std::path::Path;

use serde::Serialize;

use super::{
    Figure, ReportError,
    figures::{self, capital},
    page::{Block, Page},
    table::{Cell, Table, besides, dash, from_to, missing, plus_minus, table},
};
use crate::{
    paper::{
        Interval,
        constants::ANGLE_OF_REPOSE_DEG,
        text::{compact, number},
    },
    record::{FileError, to_csv, write_csv, write_json},
};

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
    /// Whether the standard is met and no run-time check found anything.
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
    /// Whether the final line was fitted to it.
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
    /// The result does not depend on the unknown beyond its scatter.
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

impl Calibration {
    /// What is sought, for sentences.
    pub fn unknown_in_words(&self) -> &str {
        unknown_in_words(&self.unknown)
    }
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

/// Writes `evaluations.csv`: one row a run.
///
/// # Errors
/// When it cannot be written.
pub fn write_calibration_runs(out: &Path, runs: &[CalibrationRun]) -> Result<(), FileError> {
    write_csv(&out.join("evaluations.csv"), to_csv(runs))
}

/// Writes `calibrate.json`, `calibrate.md`, `report.html`, `evaluations.csv`
/// and the figure.
///
/// # Errors
/// [`ReportError`] naming the file or the figure.
pub fn write_calibration(out: &Path, of: &Calibration) -> Result<(), ReportError> {
    write_calibration_runs(out, &of.runs)?;
    write_json(&out.join("calibrate.json"), of)?;
    page(of, figures::of_calibration(of)?).write(out, &["calibrate.md", "report.html"])
}

const HOW_TO_READ: &str = "Every value is run in the same configurations, each a new random \
     arrangement of the same grains. A line is fitted to each configuration's results near the \
     solution; the configurations' lines are a sample, and the interval holds all values at which \
     Student's t-test does not reject that their mean is the wanted result (Fieller 1954). Runs \
     that are not valid, or of which too many grains are missing, are left out as runs that failed \
     are (docs/accuracy.md). The interval covers random arrangement only, not the effects of a \
     time step, an engine or a model.";

fn page(of: &Calibration, figure: Figure) -> Page {
    let title =
        format!("Calibration: {} by {}", target_in_words(&of.target), of.unknown_in_words());
    let lead = format!("{}.", capital(&of.statement));
    let found = found(of).into_iter().map(|(name, value)| (capital(&name), value));
    let notes = of.notes.iter().map(|note| format!("{}.", capital(note))).collect();
    Page::new(title, [Block::lead(lead, of.ending == CalibrationEnding::Found)])
        .section("found", "What was found", [Block::Table(Table::of_pairs(found))])
        .section("notes", "Notes", [Block::List(notes)])
        .figures("figure", "Figure", [figure])
        .section("values", "Values tried", [Block::Table(values(of))])
        .section("reading", "How to read it", [Block::Text(HOW_TO_READ.to_owned())])
}

/// Name and value of what was found.
pub fn found(of: &Calibration) -> Vec<(String, String)> {
    let unit = |v: f64| with_unit(&compact(v), &of.unit);
    let mut rows = vec![
        (format!("{} wanted", target_in_words(&of.target)), unit(of.wanted)),
        (
            "searched".to_owned(),
            format!("{} from {} to {}", of.unknown_in_words(), of.between.low, of.between.high),
        ),
    ];
    let mut row = |name: &str, value: String| rows.push((name.to_owned(), value));
    if let Some(s) = of.solution {
        row(&format!("{} needed", of.unknown_in_words()), compact(s.value));
        let none = || "none: the slope does not differ significantly from zero".to_owned();
        let interval = s.interval_95.map_or_else(none, |i| from_to(i.low, i.high));
        row("its 95 % confidence interval", interval);
        let known_to = |mean, off| with_unit(&plus_minus(mean, Some(off), compact), &of.unit);
        let there = known_to(of.wanted, s.result_half_width_95);
        row(&format!("{} there", target_in_words(&of.target)), there);
        let per_unit = known_to(s.slope, s.slope_half_width_95);
        row("change for one unit", format!("{per_unit}, {} configurations", s.configurations));
    }
    if let Some(scatter) = of.scatter {
        row("scatter of a single run (standard deviation)", unit(scatter));
    }
    if let Some(tolerance) = of.tolerance {
        let whence = if of.tolerance_given { "given" } else { "that of a single run" };
        row("tolerance", format!("{} ({whence})", unit(tolerance)));
    }
    let left_out = besides(of.runs.iter().filter(|r| r.is_left_out()).count(), "left out");
    row("runs", format!("{} of at most {}{left_out}", of.runs.len(), of.most_runs));
    if let Some(identity) = &of.identity {
        identity_rows(of, identity, &mut row);
    }
    rows
}

/// The assumption of the paper, beside what was found.
fn identity_rows(of: &Calibration, of_it: &FrictionIdentity, row: &mut impl FnMut(&str, String)) {
    row(
        "friction in the paper",
        format!("{} for {ANGLE_OF_REPOSE_DEG}° (section 3)", compact(of_it.paper_friction)),
    );
    row(
        "friction if angle of repose = atan μ",
        format!("{} (Lambe & Whitman 1979)", compact(of_it.friction)),
    );
    if let Some(angle) = of_it.friction_angle_found_degrees {
        row("angle of friction of what was found", format!("{}°", number(angle, 1)));
    }
    if let (Some(there), Some(difference), Some(half), Some(p)) =
        (of_it.degrees_there, of_it.difference_degrees, of_it.difference_half_width_95, of_it.p)
    {
        let verdict = match (p < 0.05, difference > 0.0) {
            (true, true) => "steeper than the assumption has it",
            (true, false) => "flatter than the assumption has it",
            (false, _) => "the assumption cannot be refused",
        };
        let p = if p < 0.001 { "p < 0.001".to_owned() } else { format!("p {}", number(p, 3)) };
        row(
            &format!("angle of repose at {}", compact(of_it.tried)),
            format!(
                "{}°, less its angle of friction {} ± {}° ({p}): {verdict}",
                number(there, 1),
                number(difference, 1),
                number(half, 1)
            ),
        );
    }
    if let Some(inside) = of_it.inside_interval {
        let does = if inside { "holds" } else { "does not hold" };
        row("the interval found", format!("{does} tan {}°", compact(of.wanted)));
    }
}

fn values(of: &Calibration) -> Table {
    let shown = |value: Option<f64>| value.map(|v| with_unit(&compact(v), &of.unit));
    let or_dash = |value| Cell::number(shown(value).unwrap_or_else(dash));
    let has_no_valid_run = |v: &CalibrationValue| v.left_out > 0 && v.left_out + v.failed == v.runs;
    let runs = |v: &CalibrationValue| {
        let (failed, left_out) =
            (besides(v.failed, "without result"), besides(v.left_out, "left out"));
        format!("{}{failed}{left_out}", v.runs)
    };
    table!(&of.values, |v| {
        "Value" => v.value,
        "Runs" => runs(v),
        "Mean" => Cell::number(shown(v.mean).unwrap_or_else(|| missing(has_no_valid_run(v)))),
        "± 95 %" => or_dash(v.half_width_95),
        "Standard deviation" => or_dash(v.standard_deviation),
        "In the line" => if v.in_fit { "yes" } else { "" },
    })
}
