//! Curves of several interpretations of the paper in one frame.

use super::*;
use crate::paper::mean_settlement::mean_curve;

/// What every caption says of runs that do not count.
const MIND: &str =
    "Means are of valid runs; “not valid” marks curves of which, in part or in whole, no run is.";
/// Curves that colours and markers can tell apart; those after them are dashed.
const DISTINCT: usize = 6;

/// Figure 7 and the settlements, a line an interpretation.
pub(in crate::paper::report) fn of_interpretations(
    columns: &[InterpretationColumn],
) -> Result<Vec<Figure>, ReportError> {
    Ok(vec![
        heights(columns)?,
        settlement(columns, RunKind::VibrationContinuous, true)?,
        settlement(columns, RunKind::VibrationContinuous, false)?,
        settlement(columns, RunKind::VibrationIntermittent, true)?,
        settlement(columns, RunKind::VibrationIntermittent, false)?,
    ])
}

fn look(n: usize, marker_spacing: Option<f64>) -> Look {
    let again = n >= DISTINCT;
    Look {
        marker: Some(style::marker(n + usize::from(again))),
        marker_spacing,
        ..Look::line(n).dash(if again { style::DASHED } else { style::SOLID })
    }
}

/// An interpretation's curve, and whether a point of it is of runs that are not valid.
type Curve<'a> = (&'a InterpretationColumn, Vec<(f64, f64)>, bool);

/// Adds the curves that have points, and says which interpretations have none: their runs failed,
/// lost their grains, or have no such value.
fn add(plot: &mut Plot, curves: Vec<Curve>, marker_spacing: Option<f64>) -> String {
    let mut missing = Vec::new();
    for (n, (column, points, not_valid)) in curves.into_iter().enumerate() {
        if points.is_empty() {
            missing.push(column.name.clone());
        }
        let mark = if not_valid { " (not valid)" } else { "" };
        plot.add_some(format!("{}{mark}", column.name), look(n, marker_spacing), points);
    }
    listed(" No run gives a curve of:", &missing)
}

fn heights(columns: &[InterpretationColumn]) -> Result<Figure, ReportError> {
    let mut table = Table::new([
        "interpretation",
        "configurations",
        "falling_height_mm",
        "mean_surface_mm",
        "valid",
        "left_out",
    ]);
    let mut curves: Vec<Curve> = Vec::new();
    let mut uneven = Vec::new();
    for column in columns {
        let mut points = Vec::new();
        let mut some_not_valid = false;
        let mut realisations: Vec<Vec<u32>> = Vec::new();
        for fh in FALLING_HEIGHTS_MM {
            let from = column.poured_from(fh).filter(|r| height_mm(r).is_finite());
            let (shown, left_out) = never_mixed(from);
            realisations.push(shown.iter().map(|r| r.configuration).collect());
            let heights: Vec<f64> = shown.into_iter().map(height_mm).collect();
            if let Some(mean) = mean(&heights) {
                points.push((fh / MM_IN_CM, mean));
                some_not_valid |= left_out.all;
                let (valid, count) = (!left_out.all, heights.len());
                table.row(row![&column.name, count, fh, mean, valid, left_out.runs]);
            }
        }
        if realisations.windows(2).any(|next| next[0] != next[1]) {
            uneven.push(column.name.clone());
        }
        curves.push((column, points, some_not_valid));
    }
    let uneven = listed(
        " Heights of these are not all of the same realisations, as some runs do not count or are \
         missing:",
        &uneven,
    );
    let mut plot = Plot::of_standing_heights(20.0);
    let missing = add(&mut plot, curves, None);
    let caption = format!(
        "Mean surface after pluviation over falling height, mean over the configurations. The \
         laboratory's range stood in the paper's figure, which was not available to us (only its text \
         was). A height is comparable only where \
         grains do not overlap: see the table.{uneven} {MIND}{missing}"
    );
    let stem = "interpretations-standing-height";
    Figure::new(stem, "Figure 7 under each interpretation", caption, &[plot], &table)
}

fn settlement(
    columns: &[InterpretationColumn],
    kind: RunKind,
    plate: bool,
) -> Result<Figure, ReportError> {
    let mut table = Table::new(["interpretation", "time_s", "settlement_mm", "valid"]);
    let mut curves: Vec<Curve> = Vec::new();
    for column in columns {
        let curve = |r: &RunRecord| {
            settlement_curve(r, |s| if plate { s.settlement_mm } else { s.surface_settlement_mm })
        };
        let (shown, left_out) = never_mixed(column.of_kind(kind).filter(|r| !curve(r).is_empty()));
        let points = mean_curve(&shown.into_iter().map(curve).collect::<Vec<_>>());
        for (time, value) in &points {
            table.row(row![&column.name, *time, *value, !left_out.all]);
        }
        curves.push((column, points, left_out.all));
    }
    let continuous = kind == RunKind::VibrationContinuous;
    let quick = columns.iter().any(|c| c.quick);
    let of_laboratory = (continuous && plate).then_some(bands::FINAL_SETTLEMENT_MM);
    let band = of_laboratory.filter(|_| !quick);
    let mut plot = Plot::of_settlement();
    if let Some(band) = band {
        plot.add_band("Laboratory, range of the final settlement", (band.low, band.high));
    }
    let missing = add(&mut plot, curves, Some(style::MARKER_SPACING));
    let what = if plate { "top plate" } else { "mean surface" };
    let (number, mode) = if continuous { (9, "continuous") } else { (10, "intermittent") };
    let range = match (band, of_laboratory) {
        (Some(_), _) => {
            " Hatched: the laboratory's range of the final settlement; it belongs to the end of the \
             curves. Grains that sink into each other settle too: see the table."
                .to_owned()
        }
        (None, Some(_)) => format!(" {NO_RANGE_OF_QUICK}"),
        (None, None) => String::new(),
    };
    let caption = format!(
        "Settlement of the {what} under {mode} vibration, mean over the configurations. \
         {MIND}{range}{missing}"
    );
    let stem = format!("interpretations-{mode}-{}", if plate { "plate" } else { "surface" });
    let title = format!("Figure {number} under each interpretation: {what}");
    Figure::new(&stem, &title, caption, &[plot], &table)
}
