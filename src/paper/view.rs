//! A study as claims and report see it: plain data.

use crate::grains::GrainShape;
use crate::motion::TableMotion;
use crate::record::{GradationSummary, RunKind, RunRecord, SeriesRow, Settlement};
use crate::report::settlement::settlement_curve;

/// What a study found, and what it set out to do.
#[derive(Debug, Clone, PartialEq)]
pub struct StudyView<'a> {
    /// The finished runs; runs that are missing are simply not among them.
    pub runs: &'a [RunRecord],
    /// Runs that are finished and left out of means, in a view of those that count
    /// ([`StudyView::of_runs`]); empty in a view of all.
    pub left_out: &'a [RunRecord],
    /// Number of configurations asked for; they are counted from 1.
    pub configurations: u32,
    /// Grain size distribution the grains were made from: sieve opening in mm
    /// and percent of the mass that passes, from fine to coarse.
    pub sieve: Vec<(f64, f64)>,
    /// The same of the generated grains, sieved virtually; empty where that was not done.
    pub sieved_grains: Vec<(f64, f64)>,
    /// Number of grains generated.
    pub grain_count: usize,
    /// Their mass in g.
    pub total_mass_g: f64,
    /// Their solid volume in cm³.
    pub solids_volume_cm3: f64,
    /// What soil mechanics reads off the grain size distribution they were made from.
    pub gradation: GradationSummary,
    /// The same of the generated grains, sieved virtually; `None` where that was not done.
    pub generated: Option<GradationSummary>,
    /// Shapes of the generated grains; empty where they were not measured.
    pub shapes: Vec<GrainShape>,
    /// How the intermittent vibration was run.
    pub intermittent: TableMotion,
    /// Friction coefficient between the grains of the piles.
    pub pile_friction: f64,
    /// Whether this is the small, quick study, whose specimen is not the paper's.
    pub quick: bool,
    /// What is changed of the paper's specimen, plate and motion.
    pub departures: Vec<Departure>,
}

/// A value of the paper that is another in a changed programme.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Departure {
    /// What it is a value of.
    pub of: Departs,
    /// Both values in words.
    pub words: String,
}

/// What a changed value belongs to, and with it which results depend on it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Departs {
    /// The grains: of everything.
    Grains,
    /// The cylinder: of what stands in it.
    Cylinder,
    /// Plate and motion: of what is shaken.
    Shaking,
}

impl StudyView<'_> {
    /// The runs that count in means, and those that are left out of them.
    pub fn split(&self) -> (Vec<RunRecord>, Vec<RunRecord>) {
        self.runs.iter().cloned().partition(RunRecord::counts_in_means)
    }

    /// The same study seen by some of its runs, beside those that are left out.
    pub fn of_runs<'b>(
        &'b self,
        runs: &'b [RunRecord],
        left_out: &'b [RunRecord],
    ) -> StudyView<'b> {
        StudyView { runs, left_out, ..self.clone() }
    }

    /// Whether a pluviation run of a configuration from a falling height is left out.
    pub fn leaves_out_pluviation(&self, configuration: u32, falling_height_mm: f64) -> bool {
        self.left_out.iter().any(|r| is_pluviation(r, configuration, falling_height_mm))
    }

    /// The runs of a kind, in the order of the study.
    pub fn of_kind(&self, kind: RunKind) -> impl Iterator<Item = &RunRecord> {
        self.runs.iter().filter(move |r| r.kind == kind)
    }

    /// The vibration run of a kind and a configuration, if it was done.
    pub fn vibration(&self, kind: RunKind, configuration: u32) -> Option<&RunRecord> {
        self.of_kind(kind).find(|r| r.configuration == configuration)
    }

    /// The pluviation run of a configuration from a falling height, if it was done.
    pub fn pluviation(&self, configuration: u32, falling_height_mm: f64) -> Option<&RunRecord> {
        self.runs.iter().find(|r| is_pluviation(r, configuration, falling_height_mm))
    }

    /// What the runs of a kind show, where they do.
    pub(super) fn values(&self, kind: RunKind, of: impl Fn(&RunRecord) -> Option<f64>) -> Vec<f64> {
        self.of_kind(kind).filter_map(of).filter(|v| v.is_finite()).collect()
    }

    /// (falling height in mm, standing height in mm) of a configuration, ascending.
    pub(super) fn standing_heights(&self, configuration: u32) -> Vec<(f64, f64)> {
        let height = |fh| Some((fh, height_mm(self.pluviation(configuration, fh)?)));
        let heights = self.falling_heights_mm().into_iter().filter_map(height);
        heights.filter(|p| p.1.is_finite()).collect()
    }

    /// The configurations asked for.
    pub fn configurations(&self) -> impl Iterator<Item = u32> + use<> {
        1..=self.configurations
    }

    /// Falling heights in mm that occur in the pluviation runs, left out or not, ascending.
    pub fn falling_heights_mm(&self) -> Vec<f64> {
        let mut heights: Vec<f64> = self
            .runs
            .iter()
            .chain(self.left_out)
            .filter(|r| r.kind == RunKind::Pluviation)
            .map(|r| r.falling_height_mm)
            .filter(|h| h.is_finite())
            .collect();
        heights.sort_by(f64::total_cmp);
        heights.dedup_by(|a, b| (*a - *b).abs() < 0.5);
        heights
    }
}

fn is_pluviation(run: &RunRecord, configuration: u32, falling_height_mm: f64) -> bool {
    run.configuration == configuration && is_poured_from(run, falling_height_mm)
}

/// Whether a run is a pluviation from a falling height.
pub(super) fn is_poured_from(run: &RunRecord, falling_height_mm: f64) -> bool {
    run.kind == RunKind::Pluviation && (run.falling_height_mm - falling_height_mm).abs() < 0.5
}

/// Standing height of a run in mm: the mean surface.
pub(super) fn height_mm(run: &RunRecord) -> f64 {
    run.summary.standing_height_mm.mean_surface
}

/// Angle of repose of a run's pile in degrees.
pub(super) fn angle_of_repose(run: &RunRecord) -> Option<f64> {
    Some(run.summary.angle_of_repose.as_ref()?.degrees)
}

/// Settlement of a run's plate.
pub(super) fn plate(run: &RunRecord) -> Option<&Settlement> {
    run.summary.settlement_mm.as_ref()
}

/// Settlement of the mean surface of a run's grains.
pub(super) fn surface(run: &RunRecord) -> Option<&Settlement> {
    run.summary.surface_settlement_mm.as_ref()
}

/// Share in percent of a part of a settlement; none where the whole is no settlement, as of a plate
/// that rose.
pub(super) fn share_percent(part_mm: f64, whole_mm: f64) -> Option<f64> {
    (whole_mm > 0.0).then(|| 100.0 * part_mm / whole_mm)
}

/// Settlement over the time since vibration began up to the end of the last period: while the table
/// shakes, and rests between periods.
pub(crate) fn shaken_curve(
    run: &RunRecord,
    settlement_mm: impl Fn(&SeriesRow) -> Option<f64>,
) -> Vec<(f64, f64)> {
    /// Times in s that differ by less are the same.
    const ROUNDING: f64 = 1e-6;
    let end = shaken_periods(run).last().map_or(0.0, |p| p.1);
    let mut curve = settlement_curve(run, settlement_mm);
    curve.retain(|(time, _)| *time <= end + ROUNDING);
    curve
}

/// Beginning and end of each period in s since vibration began.
pub(crate) fn shaken_periods(run: &RunRecord) -> Vec<(f64, f64)> {
    let periods = || run.summary.vibrations.iter().flat_map(|v| &v.periods_s);
    let start = periods().next().map_or(0.0, |p| p[0]);
    periods().map(|p| (p[0] - start, p[1] - start)).collect()
}
