//! The figure of a chart, with the table of its points.

use super::Figure;
use crate::report::{
    Chart, ReportError,
    plot::Plot,
    table::{Cell, Table},
};

/// The figure of a chart that was drawn.
///
/// # Errors
/// [`ReportError::Figure`].
pub(in crate::report) fn of_chart(chart: &Chart, plots: &[Plot]) -> Result<Figure, ReportError> {
    let x = chart.panels.first().map_or("", |panel| panel.x.as_str());
    let header: Vec<&str> =
        ["curve", x].into_iter().chain(chart.panels.iter().map(|panel| panel.y.as_str())).collect();
    let mut table = Table::new(header);
    for (n, panel) in chart.panels.iter().enumerate() {
        for curve in &panel.curves {
            for (x, y) in &curve.points {
                let mut row = vec![Cell::from(&curve.name), Cell::from(*x)];
                row.extend((0..chart.panels.len()).map(|k| (k == n).then_some(*y).into()));
                table.row(row);
            }
        }
    }
    Figure::new(&chart.stem, &chart.title, &chart.caption, plots, &table)
}
