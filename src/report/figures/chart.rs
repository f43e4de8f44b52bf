//! The figure of a chart, with the table of its points.

use super::{Figure, Table, cell};
use crate::report::{LawChart, ReportError, plot::Plot};

/// The figure of a chart that was laid out.
///
/// # Errors
/// [`ReportError::Figure`].
pub(in crate::report) fn of_chart(chart: &LawChart, plot: &Plot) -> Result<Figure, ReportError> {
    let mut table = Table::new(&["curve", &chart.x, &chart.y]);
    for curve in &chart.curves {
        for (x, y) in &curve.points {
            table.row([curve.name.clone(), cell(*x), cell(*y)]);
        }
    }
    Figure::new(&chart.stem, &chart.title, chart.caption.clone(), plot, &table)
}
