//! What a convergence study found: every setting beside the finest of its
//! ladder and of the study, as tables and figures.

use std::path::Path;

use serde::Serialize;

use super::{
    ReportError, Standard,
    convergence_page::page,
    figures,
    table::{Record, Table},
};
use crate::measure::Estimate;
use crate::record::{VariationRow, write_json};

/// Deviation of a result from a converged one.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Deviation {
    /// In percent of the converged value, over the configurations that both
    /// have; `None` where they have none in common.
    pub percent: Option<Estimate>,
    /// Largest that passes, in percent.
    pub limit_percent: f64,
    /// Whether it passes: the mean, without regard to its scatter.
    pub within: Option<bool>,
    /// Whether it cannot be told from zero, at 95 %; `None` of a single configuration.
    pub inside_scatter: Option<bool>,
    /// Whether scatter leaves open if it passes, at 95 %; `None` of a single configuration.
    pub open: Option<bool>,
}

impl Deviation {
    /// Judges a deviation in percent.
    pub fn judged(percent: Option<Estimate>, limit_percent: f64) -> Self {
        let half = percent.and_then(|p| p.half_width_95());
        let open = percent.zip(half).map(|(p, half)| {
            let size = p.mean.abs();
            size - half <= limit_percent && limit_percent < size + half
        });
        Self {
            percent,
            limit_percent,
            within: percent.map(|p| p.mean.abs() <= limit_percent),
            inside_scatter: percent.and_then(|p| p.inside_scatter()),
            open,
        }
    }

    /// Whether it passes, or may do so for all that is known.
    pub fn may_pass(&self) -> Option<bool> {
        self.within.map(|within| within || self.open == Some(true))
    }
}

/// Deviations of the three lengths that are measured.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Deviations {
    /// Of the height after pouring.
    pub height: Deviation,
    /// Of the settlement of the plate.
    pub plate: Deviation,
    /// Of the settlement of the mean surface.
    pub surface: Deviation,
}

impl Deviations {
    /// All three.
    pub fn all(&self) -> [&Deviation; 3] {
        [&self.height, &self.plate, &self.surface]
    }
}

/// One rung of a ladder, judged.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ConvergenceRow {
    /// What the ladder refines.
    pub ladder: String,
    /// The setting in words.
    pub rung: String,
    /// Whether it is what its ladder is held against.
    pub finest_of_ladder: bool,
    /// Whether it is what the study is held against.
    pub finest_of_study: bool,
    /// Its settings and means.
    pub result: VariationRow,
    /// From the finest rung of its ladder.
    pub from_ladder: Deviations,
    /// From the finest rung of the study.
    pub from_study: Deviations,
    /// The largest of overlap, creep and deviations, each over what is
    /// allowed: 1 at the limit. Where one is not known, that of the others if they
    /// miss by themselves (it is at least as large), else `None`. This and what
    /// follows holds in every ladder that has the setting.
    pub error_over_limit: Option<f64>,
    /// Whether it meets the whole standard by its means.
    pub meets: Option<bool>,
    /// Whether the scatter of a deviation leaves that open; `None` where the
    /// scatter is not known.
    pub open: Option<bool>,
}

impl ConvergenceRow {
    /// Whether another row is of the same setting, as a rung of another ladder.
    pub fn same_setting(&self, other: &Self) -> bool {
        self.result.experiment == other.result.experiment
            && self.result.precision == other.result.precision
    }
}

/// Which settings are the cheapest, as numbers of rows.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
pub struct Cheapest {
    /// The cheapest that meets the whole standard by its means.
    pub meeting: Option<usize>,
    /// The cheapest that meets it whatever the scatter.
    pub surely_meeting: Option<usize>,
    /// The cheapest that is not shown to miss it.
    pub not_shown_to_miss: Option<usize>,
}

/// `convergence.json`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Convergence {
    /// Name of the scenario.
    pub scenario: String,
    /// Whether it was run on the smaller specimen.
    pub quick: bool,
    /// Number of grains of a run.
    pub grains: Option<usize>,
    /// The accuracy standard for overlap and creep.
    pub standard: Standard,
    /// Largest deviation of the height that passes, in percent.
    pub height_limit_percent: f64,
    /// Largest deviation of the settlements that passes, in percent.
    pub settlement_limit_percent: f64,
    /// The ladder whose finest rung stands for the study.
    pub reference: String,
    /// Every rung of every ladder in every precision.
    pub rows: Vec<ConvergenceRow>,
    /// The cheapest settings.
    pub cheapest: Cheapest,
}

impl Convergence {
    /// Runs that are left out of the means, and runs with a result; a setting that stands in
    /// several ladders once.
    pub fn left_out(&self) -> (usize, usize) {
        let settings = self.settings();
        let results = settings.iter().map(|row| &row.result);
        results.fold((0, 0), |(out, all), v| (out + v.left_out, all + v.runs - v.failed))
    }

    /// Every setting once, though it may stand in several ladders.
    pub(super) fn settings(&self) -> Vec<&ConvergenceRow> {
        let mut settings: Vec<&ConvergenceRow> = Vec::new();
        for row in &self.rows {
            if !settings.iter().any(|known| known.same_setting(row)) {
                settings.push(row);
            }
        }
        settings
    }
}

/// Writes `convergence.json`, `convergence.csv`, `convergence.md` and figures.
///
/// # Errors
/// [`ReportError`] naming the file or the figure.
pub fn write_convergence(out: &Path, of: &Convergence) -> Result<(), ReportError> {
    table(of).write(&out.join("convergence.csv"))?;
    write_json(&out.join("convergence.json"), of)?;
    page(of, figures::of_convergence(of)?).write(out, &["convergence.md"])
}

fn table(of: &Convergence) -> Table {
    Table::of_records(of.rows.iter().map(|row| {
        let v = &row.result;
        let mut record = Record::default();
        record.add("ladder", &row.ladder);
        record.add("rung", &row.rung);
        record.add("precision", &v.precision);
        record.add("contact_solver", &v.contact_solver);
        record.add("rate_hz", v.rate_hz);
        record.add("iterations", v.iterations);
        record.add("substeps", v.substeps);
        record.add("contact_stiffness_n_per_m", v.contact_stiffness_n_per_m);
        record.add("runs", v.runs);
        record.add("failed", v.failed);
        record.add("left_out", v.left_out);
        record.add_estimate("poured_height_mm", v.poured_height_mm);
        record.add_estimate("plate_settlement_mm", v.plate_settlement_mm);
        record.add_estimate("surface_settlement_mm", v.surface_settlement_mm);
        record.add_estimate("overlap_mean_percent", v.overlap_mean_percent);
        record.add_estimate("overlap_p99_percent", v.overlap_p99_percent);
        record.add_estimate("creep_um_per_s", v.creep_um_per_s);
        record.add_estimate("wall_s_per_simulated_s", v.wall_s_per_simulated_s);
        for (from, of) in [("ladder", &row.from_ladder), ("study", &row.from_study)] {
            record.add_estimate(&format!("height_from_{from}_percent"), of.height.percent);
            record.add_estimate(&format!("plate_from_{from}_percent"), of.plate.percent);
            record.add_estimate(&format!("surface_from_{from}_percent"), of.surface.percent);
        }
        record.add("error_over_limit", row.error_over_limit);
        record.add("meets", row.meets);
        record.add("open", row.open);
        record
    }))
}
