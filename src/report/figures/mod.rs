//! The figures: what they are, and those of runs and studies.

mod calibration;
mod convergence;
pub(crate) mod grains;
mod of_run;
mod pile;
mod sensitivity;
pub(crate) mod settlement;
mod sweep;

use super::png;
use super::*;
use crate::record::create_folder;

pub(super) use calibration::of_calibration;
pub(super) use convergence::of_convergence;
pub(super) use grains::of_shapes;
pub(crate) use of_run::of_run;
pub(crate) use pile::by_azimuth;
pub use pile::side_view;
pub(super) use sensitivity::of_sensitivity;
pub(super) use sweep::of_sweep;

/// A figure with the numbers it shows.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    /// Name of its files, without extension.
    pub stem: String,
    /// Title.
    pub title: String,
    /// What is to be seen, and how it is read.
    pub caption: String,
    /// The drawing.
    pub svg: String,
    /// The numbers, as CSV with a header row.
    pub csv: Vec<u8>,
}

impl Figure {
    /// A figure of plots below each other.
    pub(crate) fn new(
        stem: &str,
        title: &str,
        caption: impl Into<String>,
        plots: &[Plot],
        table: &Table,
    ) -> Result<Self, ReportError> {
        Self::of_svg(stem, title, caption, stacked(plots), table)
    }

    /// A figure of plots below each other, and the table of their points: the curve, its value on
    /// the horizontal axis, and a column for each plot.
    pub(crate) fn of_curves(
        stem: &str,
        title: &str,
        caption: impl Into<String>,
        plots: &[Plot],
        columns: &[&str],
    ) -> Result<Self, ReportError> {
        let mut table = Table::new(columns.iter().copied());
        for (n, plot) in plots.iter().enumerate() {
            for series in &plot.series {
                for (x, y) in &series.points {
                    let mut cells = row![&series.label, *x];
                    cells.extend((0..plots.len()).map(|k| (k == n).then_some(*y).into()));
                    table.row(cells);
                }
            }
        }
        Self::new(stem, title, caption, plots, &table)
    }

    fn of_svg(
        stem: &str,
        title: &str,
        caption: impl Into<String>,
        svg: Result<String, String>,
        table: &Table,
    ) -> Result<Self, ReportError> {
        let fail = |reason: String| ReportError::Figure { figure: stem.to_owned(), reason };
        Ok(Self {
            stem: stem.to_owned(),
            title: title.to_owned(),
            caption: caption.into(),
            svg: svg.map_err(fail)?,
            csv: table.csv().map_err(|e| fail(e.to_string()))?,
        })
    }

    /// Writes `STEM.svg`, `STEM.png` and `STEM.csv` into a folder, which is
    /// made where it is missing.
    ///
    /// # Errors
    /// [`ReportError`] naming the file or the figure.
    pub fn write(&self, folder: &Path) -> Result<(), ReportError> {
        create_folder(folder)?;
        let png = png::render(&self.svg)
            .map_err(|reason| ReportError::Figure { figure: self.stem.clone(), reason })?;
        let parts: [(&str, &[u8]); 3] =
            [("svg", self.svg.as_bytes()), ("png", &png), ("csv", &self.csv)];
        for (extension, content) in parts {
            write_file(&folder.join(format!("{}.{extension}", self.stem)), content)?;
        }
        Ok(())
    }
}
