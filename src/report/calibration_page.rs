//! The files of a calibration: tables, a figure, and the page as Markdown and as HTML.

use super::*;
use crate::record::{to_csv, write_csv};

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

const HOW_TO_READ: &str = "Every value is run in the same realisations, each a new random \
     arrangement of the same grains. A line is fitted to each realisation's results near the \
     solution; the realisations' lines are a sample, and the interval holds all values at which \
     Student's t-test does not reject that their mean is the wanted result (Fieller 1954). Runs \
     that are not valid, or of which too many grains are missing, are left out as runs that failed \
     are (docs/accuracy.md). The interval covers random arrangement only, not the effects of a \
     time step, an engine or a model.";

fn page(of: &Calibration, figure: Figure) -> Page {
    let (target, unknown) = (target_in_words(&of.target), unknown_in_words(&of.unknown));
    let lead = format!("{}.", capital(&of.statement));
    let found = found(of).into_iter().map(|(name, value)| (capital(&name), value));
    let notes = of.notes.iter().map(|note| format!("{}.", capital(note))).collect();
    let title = format!("Calibration: {target} by {unknown}");
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
    let (target, unknown) = (target_in_words(&of.target), unknown_in_words(&of.unknown));
    let Interval { low, high } = of.between;
    let mut rows = Vec::new();
    let mut row = |name: &str, value: String| rows.push((name.to_owned(), value));
    row(&format!("{target} wanted"), unit(of.wanted));
    row("searched", format!("{unknown} from {low} to {high}"));
    if let Some(s) = of.solution {
        row(&format!("{unknown} needed"), compact(s.value));
        let none = || "none: the slope does not differ significantly from zero".to_owned();
        let interval = s.interval_95.map_or_else(none, |i| from_to(i.low, i.high));
        row("its 95 % confidence interval", interval);
        let known_to = |mean, off| with_unit(&mean_within(mean, Some(off)), &of.unit);
        let there = known_to(of.wanted, s.result_half_width_95);
        row(&format!("{target} there"), there);
        let per_unit = known_to(s.slope, s.slope_half_width_95);
        let realisations = counted(s.configurations, "realisation");
        row("change for one unit", format!("{per_unit}, {realisations}"));
    }
    if let Some(scatter) = of.scatter {
        row("scatter of a single run (standard deviation, at all values)", unit(scatter));
    }
    if let Some(tolerance) = of.tolerance {
        let whence = match (of.tolerance_given, of.solution) {
            (true, _) => "given",
            (false, Some(_)) => "scatter of a single run at the values of the line",
            (false, None) => "scatter of a single run",
        };
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
        format!(
            "{} for {PUBLISHED_ANGLE_OF_REPOSE_DEG}° (section 3)",
            compact(of_it.paper_friction)
        ),
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
                "{}°, less its angle of friction {}° ({p}): {verdict}",
                scattered(there, half),
                mean_within(difference, Some(half))
            ),
        );
    }
    if let Some(inside) = of_it.inside_interval {
        let does = if inside { "holds" } else { "does not hold" };
        row("the interval found", format!("{does} tan {}°", compact(of.wanted)));
    }
}

fn values(of: &Calibration) -> Table {
    let has_no_valid_run = |v: &CalibrationValue| v.left_out > 0 && v.left_out + v.failed == v.runs;
    // To the second digit of how far it may be off, where that is known.
    let shown = |value: Option<f64>, off: Option<f64>| {
        value.map(|v| with_unit(&scattered(v, off.unwrap_or_default()), &of.unit))
    };
    let or_dash = |value| Cell::number(shown(value, value).unwrap_or_else(dash));
    let mean = |v: &CalibrationValue| {
        let mean = shown(v.mean, v.half_width_95);
        mean.unwrap_or_else(|| missing(has_no_valid_run(v)))
    };
    let runs = |v: &CalibrationValue| {
        let (failed, left_out) =
            (besides(v.failed, "without result"), besides(v.left_out, "left out"));
        format!("{}{failed}{left_out}", v.runs)
    };
    table!(&of.values, |v| {
        "Value" => v.value,
        "Runs" => runs(v),
        "Mean" => Cell::number(mean(v)),
        "± 95 %" => or_dash(v.half_width_95),
        "Standard deviation" => or_dash(v.standard_deviation),
        "In the line" => if v.in_fit { "yes" } else { "" },
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Law: what was measured has the digits that its interval leaves.
    #[test]
    fn digits_follow_from_the_interval() {
        let value = |mean, half_width_95| CalibrationValue {
            value: 0.5,
            runs: 3,
            failed: 0,
            left_out: 0,
            mean: Some(mean),
            standard_deviation: half_width_95,
            half_width_95,
            in_fit: true,
        };
        let of = Calibration {
            scenario: "s".to_owned(),
            target: "angle_of_repose.degrees".to_owned(),
            unit: "°".to_owned(),
            wanted: 38.4,
            unknown: "contact.grain_grain_friction".to_owned(),
            between: Interval::new(0.2, 1.0),
            ending: CalibrationEnding::Flat,
            statement: String::new(),
            solution: None,
            tolerance: None,
            tolerance_given: false,
            scatter: None,
            replicates: 3,
            most_runs: 48,
            notes: Vec::new(),
            identity: None,
            values: vec![value(38.4567, Some(0.5123)), value(38.4567, None)],
            runs: Vec::new(),
        };
        let table = values(&of).markdown();
        for row in
            ["| 0.5 | 3 | 38.46° | 0.51° | 0.51° | yes |", "| 0.5 | 3 | 38.46° | – | – | yes |"]
        {
            assert!(table.contains(row), "law: {row}, got\n{table}");
        }
    }
}
