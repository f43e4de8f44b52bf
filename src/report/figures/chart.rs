//! The figure of a chart, with the table of its points.

use super::{Figure, Table, cell};
use crate::report::{Chart, ReportError};

/// The figure of a chart that was drawn.
///
/// # Errors
/// [`ReportError::Figure`].
pub(in crate::report) fn of_chart(chart: &Chart, svg: String) -> Result<Figure, ReportError> {
    let x = chart.panels.first().map_or("", |panel| panel.x.as_str());
    let header: Vec<&str> =
        ["curve", x].into_iter().chain(chart.panels.iter().map(|panel| panel.y.as_str())).collect();
    let mut table = Table::new(&header);
    for (n, panel) in chart.panels.iter().enumerate() {
        for curve in &panel.curves {
            for (x, y) in &curve.points {
                let mut row = vec![curve.name.clone(), cell(*x)];
                row.extend((0..chart.panels.len()).map(|k| match k == n {
                    true => cell(*y),
                    false => String::new(),
                }));
                table.row(row);
            }
        }
    }
    Figure::of_svg(&chart.stem, &chart.title, chart.caption.clone(), svg, &table)
}
