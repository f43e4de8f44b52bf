//! The effects of parameters as ranked bars, a panel an outcome.

use super::{Figure, Table, cell};
use crate::{
    measure::Estimate,
    paper::text::compact,
    report::{
        Effect, ParameterRow, ReportError, Sensitivity,
        axis::Axis,
        plot::{Look, Mark, Plot, Series, stacked},
        sensitivity::ranked,
        style::{self, Dash},
    },
};

const STEM: &str = "sensitivity";

/// Height given to a parameter, in SVG units.
const ROW: u32 = 80;

/// Width of a bar, in SVG units.
const BAR: u32 = 26;

/// What each panel shows: name of its axis, name in the table, effect.
type Panel = (&'static str, &'static str, fn(&ParameterRow) -> Effect);

/// An end of a range: its entry in the legend, number of its colour, how far
/// it is drawn below the middle of its line, and its change.
type End = (&'static str, usize, f64, fn(&Effect) -> Option<Estimate>);

const PANELS: [Panel; 3] = [
    ("Change of the height after pouring (mm)", "height", |r| r.height),
    ("Change of the settlement of the plate (mm)", "plate_settlement", |r| r.plate),
    ("Change of the settlement of the surface (mm)", "surface_settlement", |r| r.surface),
];

/// The figure of a sensitivity study.
///
/// # Errors
/// [`ReportError::Figure`].
pub(in crate::report) fn of_sensitivity(of: &Sensitivity) -> Result<Figure, ReportError> {
    let fail = |reason: String| ReportError::Figure { figure: STEM.to_owned(), reason };
    let mut table =
        Table::new(&["outcome", "parameter", "end", "value", "change_mm", "standard_error_mm"]);
    let mut panels = Vec::new();
    for (index, (axis, outcome, effect)) in PANELS.into_iter().enumerate() {
        let rows = ranked(&of.parameters, effect);
        // One legend does for all panels.
        let last = index + 1 == PANELS.len();
        panels.push(panel(axis, &rows, effect, last).svg().map_err(fail)?);
        for row in rows {
            let e = effect(row);
            for (end, value, change) in [("low", row.low, e.low_mm), ("high", row.high, e.high_mm)]
            {
                table.row([
                    outcome.to_owned(),
                    row.parameter.clone(),
                    end.to_owned(),
                    cell(value),
                    cell(change.map(|c| c.mean)),
                    cell(change.and_then(|c| c.standard_error)),
                ]);
            }
        }
    }
    Ok(Figure {
        stem: STEM.to_owned(),
        title: "What each parameter moves over its range".to_owned(),
        caption:
            "Change from the default at either end of each parameter's range, the largest first; \
                  thin lines: ± standard error over configurations. A bar no longer than its thin \
                  line is scatter; the table says which effects lie inside it."
                .to_owned(),
        svg: stacked(&panels).map_err(fail)?,
        csv: table.csv().map_err(|e| fail(e.to_string()))?,
    })
}

fn panel(
    axis: &str,
    rows: &[&ParameterRow],
    effect: fn(&ParameterRow) -> Effect,
    legend: bool,
) -> Plot {
    let ends = |e: Estimate| {
        let error = e.standard_error.unwrap_or(0.0);
        [e.mean - error, e.mean + error]
    };
    let values = rows
        .iter()
        .flat_map(|r| [effect(r).low_mm, effect(r).high_mm])
        .flatten()
        .flat_map(ends)
        .chain([0.0]);
    let x = Axis::linear(axis, values);
    let count = rows.len().max(1);
    let y = Axis::rows(count);
    let mut plot = Plot::new(x, y);
    plot.y_names = Some(rows.iter().map(|r| label(r)).collect());
    plot.frame_height = (ROW * count as u32).max(3 * ROW);
    plot.marks.push(Mark { label: String::new(), at: 0.0, upright: true });
    let parts: [End; 2] =
        [("at the low end", 0, -0.18, |e| e.low_mm), ("at the high end", 1, 0.18, |e| e.high_mm)];
    for (name, colour, offset, value) in parts {
        let bar = look(style::colour(colour), style::SOLID, BAR);
        let mut label = if legend { name.to_owned() } else { String::new() };
        let mut add = |points: Vec<(f64, f64)>, look: Look| {
            let label = std::mem::take(&mut label);
            plot.series.push(Series { label, look, points });
        };
        for (i, row) in rows.iter().enumerate() {
            let Some(estimate) = value(&effect(row)) else { continue };
            let at = i as f64 + offset;
            add(vec![(0.0, at), (estimate.mean, at)], bar);
            if estimate.standard_error.is_some() {
                let [from, to] = ends(estimate);
                add(vec![(from, at), (to, at)], look(style::INK, style::SOLID, style::CURVE));
            }
        }
    }
    plot
}

fn look(colour: plotters::style::RGBColor, line: Dash, width: u32) -> Look {
    Look { colour, line: Some(line), width, marker: None, marker_spacing: None }
}

/// Title and range.
fn label(row: &ParameterRow) -> String {
    let unit = if row.unit.is_empty() { String::new() } else { format!(" {}", row.unit) };
    format!("{}, {}–{}{unit}", row.title, compact(row.low), compact(row.high))
}
