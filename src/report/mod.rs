//! What readers see of a study: figures as SVG, PNG and CSV, and one page that
//! needs nothing else.

mod axis;
mod calibration;
mod chart;
mod choices;
mod column_chart;
mod columns;
mod comparison;
mod convergence;
mod figures;
mod html;
mod interpretations;
mod laws;
mod mean_settlement;
mod page;
mod plot;
mod png;
mod quality;
mod sections;
mod sensitivity;
mod sheet;
mod shortfalls;
mod silhouette;
mod style;
mod sweep;
mod sweep_outcomes;
mod sweep_page;
mod table;
mod targets;
mod uncertainty;

#[cfg(test)]
mod tests;

use std::{collections::BTreeMap, path::Path};

use serde::{Deserialize, Serialize};

use crate::{
    grains::{self, GrainShape, ParticleSizeDistribution, SieveAnalysis},
    paper::{Claim, Scorecard, StudyView, gradation_in_words},
    record::{AngleOfRepose, FileError, GradationSummary, RunRecord},
    specimen::Specimen,
    units::to_mm,
    world::EffectiveSettings,
};

pub use axis::Axis;
pub use calibration::{
    Calibration, CalibrationEnding, CalibrationRun, CalibrationSolution, CalibrationValue,
    FrictionIdentity, found as calibration_rows, target_in_words, unknown_in_words, with_unit,
    write_calibration, write_calibration_runs,
};
pub use chart::Chart;
pub use choices::{Choice, choices, pile_choices};
pub use column_chart::{ChartColumn, ChartStyle, ColumnChart};
pub use columns::{ColumnRange, ColumnTable, unit_of};
pub use comparison::{CompareRecord, CompareRun, ComparedQuantity, write_comparison};
pub use convergence::{
    Cheapest, Convergence, ConvergenceRow, Deviation, Deviations, write_convergence,
};
pub use figures::{Figure, side_view as pile_picture};
pub use interpretations::{
    InterpretationCell, InterpretationColumn, InterpretationFailure, InterpretationRow,
    write_interpretations,
};
pub use laws::{LawCase, LawCurve, LawRow, write_laws};
pub use mean_settlement::MeanSettlement;
pub use plot::{Look, Plot};
pub use png::{Picture, draw as draw_svg, render as svg_to_png};
pub use quality::Standard;
pub use sensitivity::{Effect, ParameterRow, Sensitivity, write_sensitivity};
pub use sweep::{
    Sweep, SweepEffect, SweepEstimate, SweepFactor, SweepPoint, SweepRun, write_sweep,
};
pub use sweep_outcomes::{OUTCOMES, averaged_outcomes, main_outcomes, outcomes_in};
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

/// What one engine, or one choice of settings, made of the claims.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Column {
    /// Head of the column: the engine, its contacts, and what is not default.
    pub label: String,
    /// What must be equal for two columns to stand side by side: a hash of
    /// everything but the engine.
    pub programme: String,
    /// The claims, judged.
    pub claims: Vec<Claim>,
    /// Whether stock Bullet found and solved the contacts.
    pub stock_bullet: bool,
    /// Its settlement under continuous vibration; null where it has none.
    pub settlement: Option<MeanSettlement>,
}

/// Everything a report is made from.
#[derive(Debug, Clone)]
pub struct ReportInput<'a> {
    /// What the study found.
    pub study: StudyView<'a>,
    /// The claims, judged.
    pub claims: &'a [Claim],
    /// The results that decide, and the paragraph that sums them up.
    pub scorecard: &'a Scorecard,
    /// What other engines and settings made of the same programme.
    pub beside: &'a [Column],
    /// Values the paper does not give, and why they were chosen.
    pub choices: &'a [Choice],
    /// The accuracy standard that runs are compared with.
    pub standard: Standard,
    /// Versions, seed, commands: names and values in words.
    pub provenance: &'a BTreeMap<String, String>,
    /// Engine settings as read back from the engine.
    pub effective: &'a EffectiveSettings,
    /// Views of piles, shown after the figures of the study.
    pub piles: &'a [Figure],
    /// Pictures of grains, apparatus and specimen, in the paper's order; none where
    /// they could not be made.
    pub pictures: &'a [Picture],
    /// Findings of the study itself that a reader must know; those of runs
    /// are taken from their summaries.
    pub warnings: &'a [String],
}

/// Writes `figures/*.{svg,png,csv}`, the pictures beside them, and then `report.html` into a folder. Each
/// file is written whole or not at all.
///
/// # Errors
/// [`ReportError`] naming the file or the figure.
pub fn write(out: &Path, input: &ReportInput) -> Result<(), ReportError> {
    let headline = figures::headline(&input.study, input.beside)?;
    let mut figures = figures::of_study(&input.study, &input.standard)?;
    figures.extend_from_slice(input.piles);
    for picture in input.pictures {
        picture.write(&out.join("figures"))?;
    }
    html::page(input, headline, figures).write(out, &["report.html"])
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
    let in_words = |of: grains::Gradation| gradation_in_words(&GradationSummary::from(of));
    let mut words = format!("Generated: {}.", in_words(sieved.gradation()));
    if let Some(specified) = specified {
        words = format!("Specified: {}. {words}", in_words(specified.gradation()));
    }
    figures::of_grains(&curve, &generated, &words)?.write(folder)?;
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
