//! What readers see of runs and studies: figures as SVG, PNG and CSV, tables, and pages that need
//! nothing else.

mod axis;
mod calibration;
mod calibration_page;
mod chart;
mod column_chart;
mod columns;
mod comparison;
mod convergence;
pub(crate) mod figures;
pub(crate) mod html;
pub(crate) mod page;
pub(crate) mod plot;
mod png;
pub(crate) mod quality;
mod sensitivity;
pub(crate) mod settlement;
mod sheet;
mod silhouette;
pub(crate) mod style;
mod sweep;
mod sweep_outcomes;
mod sweep_page;
mod sweep_reading;
mod sweep_reasons;
pub(crate) mod table;
mod targets;
pub(crate) mod text;

#[cfg(test)]
mod tests;

use std::{collections::BTreeMap, path::Path};

use serde::Serialize;
use serde_json::Value;

use crate::{
    grains::{self, GrainShape, ParticleSizeDistribution, SieveAnalysis},
    measure::{Estimate, Interval, statistics::mean},
    plain::{counted, in_number, plain},
    record::{
        AngleOfRepose, FileError, GradationSummary, LaboratoryNames, RunRecord, SeriesRow,
        VariationRow, left_out_in_words, write_file, write_json,
    },
    specimen::Specimen,
    units::to_mm,
};

// What several files share.
use {
    axis::Scale,
    page::{Block, Page},
    plot::{stacked, with_one_legend},
    style::{Dash, Marker},
    sweep::{NO_UNIT, shown},
    sweep_outcomes::{in_words, withheld_in_words},
    table::{
        Cell, Record, Table, besides, dash, from_to, mean_within, missing, row, scattered, table,
    },
    text::{capital, compact, number},
};

pub use axis::Axis;
pub use calibration::{
    Calibration, CalibrationEnding, CalibrationRun, CalibrationSolution, CalibrationValue,
    FrictionIdentity, PUBLISHED_ANGLE_OF_REPOSE_DEG, PUBLISHED_FRICTION, target_in_words,
    unknown_in_words, with_unit,
};
pub use calibration_page::{found as calibration_rows, write_calibration, write_calibration_runs};
pub use chart::Chart;
pub use column_chart::{ChartColumn, ColumnChart};
pub use columns::{ColumnRange, ColumnTable, unit_of};
pub use comparison::{CompareRecord, CompareRun, ComparedQuantity, write_comparison};
pub use convergence::{
    Cheapest, Convergence, ConvergenceRow, Deviation, Deviations, write_convergence,
};
pub use figures::{Figure, side_view as pile_picture};
pub use plot::{Look, Plot};
pub use png::{Picture, draw as draw_svg, render as svg_to_png};
pub use quality::Standard;
pub use sensitivity::{Effect, ParameterRow, Sensitivity, write_sensitivity};
pub use sweep::{
    NOT_STORED, SPECIMEN, Sweep, SweepEffect, SweepEstimate, SweepFactor, SweepPoint, SweepRun,
};
pub use sweep_outcomes::{OUTCOMES, averaged_outcomes, main_outcomes, numbers_in, outcomes_in};
pub use sweep_page::write_sweep;
pub use targets::{MetAt, PointsMet, Target, TargetFound, TargetsFound, Together, write_targets};

/// Why a report could not be written.
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    /// A file could not be written.
    #[error(transparent)]
    File(#[from] FileError),
    /// A figure could not be drawn.
    #[error("the figure `{figure}` cannot be drawn: {reason}")]
    Figure {
        /// Name of its files.
        figure: String,
        /// What went wrong.
        reason: String,
    },
}

/// Writes the figures of a set of grains into a folder: `grain-size-distribution`
/// and `grain-shape`, each as SVG, PNG and CSV.
///
/// # Errors
/// [`ReportError`] naming the file or the figure.
pub fn grain_figures(
    folder: &Path,
    sieved: &SieveAnalysis,
    specified: Option<&ParticleSizeDistribution>,
    shapes: &[GrainShape],
) -> Result<(), ReportError> {
    let generated: Vec<(f64, f64)> = sieved.points().iter().map(|p| (to_mm(p.0), p.1)).collect();
    let curve = specified.map_or_else(Vec::new, ParticleSizeDistribution::passing_curve);
    let in_words = |of: grains::Gradation| text::gradation_in_words(&GradationSummary::from(of));
    let mut words = format!("Generated: {}.", in_words(sieved.gradation()));
    if let Some(specified) = specified {
        words = format!("Specified: {}. {words}", in_words(specified.gradation()));
    }
    let caption = format!(
        "Grain size distribution of the grains, each through the virtual sieve (the smallest \
         square opening that it passes in any orientation). {words}"
    );
    let (stem, title) = ("grain-size-distribution", "Grain size distribution");
    figures::grains::curves(stem, title, caption, [&curve, &generated])?.write(folder)?;
    figures::of_shapes(shapes)?.write(folder)
}

/// Writes the figures of a single run into a folder: `heights`, `energy` and,
/// where it was vibrated, `settlement`, each as SVG, PNG and CSV.
///
/// # Errors
/// [`ReportError`] naming the file or the figure.
pub fn run_figures(folder: &Path, run: &RunRecord) -> Result<(), ReportError> {
    figures::of_run(run)?.iter().try_for_each(|figure| figure.write(folder))
}

/// Writes the figures of a pile into a folder: `pile`, its side view with the
/// fitted flanks, and `angle-by-azimuth`, each as SVG, PNG and CSV.
///
/// # Errors
/// [`ReportError`] naming the file or the figure.
pub fn pile_figures(
    folder: &Path,
    specimen: &Specimen,
    pile: &AngleOfRepose,
) -> Result<(), ReportError> {
    let both = [figures::side_view(specimen, pile)?, figures::by_azimuth(&[("", pile)])?];
    both.iter().try_for_each(|figure| figure.write(folder))
}
