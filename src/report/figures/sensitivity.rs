//! The effects of parameters as ranked bars, a panel an outcome.

use super::*;
use crate::report::sensitivity::ranked;

/// Height given to a parameter, in SVG units.
const ROW: u32 = 80;

/// Width of a bar, in SVG units.
const BAR: u32 = 26;

/// An end of a range: its entry in the legend, number of its colour, how far
/// it is drawn below the middle of its line, and its change.
type End = (&'static str, usize, f64, fn(&Effect) -> Option<Estimate>);

pub(in crate::report) fn of_sensitivity(of: &Sensitivity) -> Result<Figure, ReportError> {
    let mut table =
        Table::new(["outcome", "parameter", "end", "value", "change_mm", "standard_error_mm"]);
    let mut panels = Vec::new();
    for (outcome, title, effect, _) in of.shown() {
        let rows = ranked(&of.parameters, effect);
        panels.push(panel(&format!("{title}, change (mm)"), &rows, effect));
        for row in rows {
            let e = effect(row);
            for (end, value, change) in [("low", row.low, e.low_mm), ("high", row.high, e.high_mm)]
            {
                let (mean, error) = (change.map(|c| c.mean), change.and_then(|c| c.standard_error));
                table.row(row![outcome, &row.parameter, end, value, mean, error]);
            }
        }
    }
    let caption = "Change from the default at either end of each parameter's range, the largest \
                   first; thin lines: ± standard error over realisations. A bar no longer than \
                   its thin line is scatter; the table says which effects lie inside it.";
    let title = "What each parameter moves over its range";
    Figure::new("sensitivity", title, caption, &with_one_legend(panels), &table)
}

fn panel(axis: &str, rows: &[&ParameterRow], effect: fn(&ParameterRow) -> Effect) -> Plot {
    let mut plot = Plot::of_rows(Axis::linear(axis), rows.iter().map(|r| label(r)).collect(), ROW);
    plot.mark_upright("", [0.0]);
    let parts: [End; 2] =
        [("At the low end", 0, -0.18, |e| e.low_mm), ("At the high end", 1, 0.18, |e| e.high_mm)];
    for (mut label, colour, offset, value) in parts {
        let bar = Look { width: BAR, ..Look::line(colour) };
        for (i, row) in rows.iter().enumerate() {
            let Some(estimate) = value(&effect(row)) else { continue };
            let at = i as f64 + offset;
            plot.add(std::mem::take(&mut label), bar, vec![(0.0, at), (estimate.mean, at)]);
            if let Some(error) = estimate.standard_error {
                let ends = vec![(estimate.mean - error, at), (estimate.mean + error, at)];
                plot.add("", Look::of(style::INK), ends);
            }
        }
    }
    plot
}

/// Title and range.
fn label(row: &ParameterRow) -> String {
    let range = format!("{}–{}", compact(row.low), compact(row.high));
    format!("{}, {}", row.title, with_unit(&range, &row.unit))
}
