//! The figures: the paper's, drawn from our runs, and those that show how far
//! the runs can be trusted.

mod calibration;
mod convergence;
mod grains;
mod headline;
mod heights;
mod interpretations;
mod of_run;
mod pile;
mod quality;
mod sensitivity;
mod settlement;
mod sweep;

use std::path::Path;

use super::{
    ReportError, Standard,
    plot::{Plot, stacked},
    png,
    table::{Table, row},
};
use crate::{
    paper::StudyView,
    record::{AngleOfRepose, RunKind, create_folder, write_file},
};

pub(super) use calibration::{capital, of_calibration};
pub(super) use convergence::of_convergence;
pub(super) use grains::{of_grains, of_shapes};
pub(super) use headline::figure as headline;
pub(super) use interpretations::of_interpretations;
pub(super) use of_run::of_run;
pub(super) use pile::by_azimuth;
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
    pub(super) fn new(
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
    pub(super) fn of_curves(
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

/// The figures of a study, in the order of the paper.
pub(super) fn of_study(study: &StudyView, standard: &Standard) -> Result<Vec<Figure>, ReportError> {
    let mut figures = vec![
        grains::sizes(study)?,
        of_shapes(&study.shapes)?,
        heights::over_falling_height(study)?,
        heights::with_confidence(study)?,
        settlement::continuous(study)?,
        settlement::intermittent(study)?,
        quality::creep(study, standard)?,
        quality::overlap(study, standard)?,
    ];
    let piles = study.of_kind(RunKind::Repose);
    let piles: Vec<(&str, &AngleOfRepose)> = piles
        .filter_map(|r| Some((r.name.as_str(), r.summary.angle_of_repose.as_ref()?)))
        .collect();
    if !piles.is_empty() {
        figures.push(by_azimuth(&piles)?);
    }
    Ok(figures)
}
