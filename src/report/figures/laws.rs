//! The figure of a verification case: the law dashed, every engine's curves
//! in its own colour.

use super::Figure;
use crate::report::{
    LawCase, LawCurve, ReportError,
    axis::Axis,
    plot::{Look, Plot},
    style,
    table::{Table, row},
};

/// Points of a curve that are drawn and tabulated.
const MOST_POINTS: usize = 1500;

/// The figure of one case.
///
/// # Errors
/// [`ReportError::Figure`].
pub(in crate::report) fn of_law(case: &LawCase) -> Result<Figure, ReportError> {
    let points = || case.curves.iter().flat_map(|c| &c.points);
    let x_values: Vec<f64> = points().map(|p| p.0).filter(|v| v.is_finite()).collect();
    let y_values: Vec<f64> = points().map(|p| p.1).filter(|v| v.is_finite()).collect();
    // Errors over scales of length: both over many decades.
    let decades = |values: &[f64]| {
        let low = values.iter().copied().fold(f64::INFINITY, f64::min);
        let high = values.iter().copied().fold(0.0, f64::max);
        low > 0.0 && high / low > 1e3
    };
    let axis = |name: &str, values: Vec<f64>| {
        Axis::scaled(decades(&values) && !name.contains("(s)"), name, values)
    };
    let mut plot = Plot::new(axis(&case.x, x_values), axis(&case.y, y_values));
    let mut settings: Vec<&str> = Vec::new();
    let mut table = Table::new(["setting", "curve", "x", "y"]);
    // The law is drawn over the engines' curves.
    let order = case.curves.iter().filter(|c| c.setting.is_some());
    let laws: Vec<&LawCurve> = case.curves.iter().filter(|c| c.setting.is_none()).collect();
    for curve in order {
        let setting = curve.setting.as_deref().unwrap_or_default();
        let first = !settings.contains(&setting);
        if first {
            settings.push(setting);
        }
        let n = settings.iter().position(|s| *s == setting).unwrap_or(0);
        let label = if first { setting } else { "" };
        plot.add(label, Look::line(n).thin(), thinned(&curve.points));
    }
    if let Some(law) = laws.first() {
        plot.add(&law.name, Look::of(style::INK).dash(style::DASHED), thinned(&law.points));
    }
    for curve in &case.curves {
        let setting = curve.setting.as_deref().unwrap_or("law");
        for (x, y) in thinned(&curve.points) {
            table.row(row![setting, &curve.name, x, y]);
        }
    }
    Figure::new(&case.id, &case.title, &case.quantity, &[plot], &table)
}

fn thinned(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let every = points.len().div_ceil(MOST_POINTS).max(1);
    let last = points.len().saturating_sub(1);
    points
        .iter()
        .enumerate()
        .filter(|(i, _)| i % every == 0 || *i == last)
        .map(|(_, p)| *p)
        .collect()
}
