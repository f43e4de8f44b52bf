//! Interpretations of the paper side by side: one table, a column an interpretation, as JSON,
//! Markdown and a page, with figures that lay their curves over each other.

mod page;
mod table;

use std::path::Path;

use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use super::{ReportError, Standard, figures};
use crate::{
    paper::{Claim, settlement_curve},
    record::{RunKind, RunRecord, Summary, write_json},
};

pub use table::{InterpretationCell, InterpretationRow};

/// What one interpretation made of the programme.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct InterpretationColumn {
    /// Its name, as `--interpretation` takes it.
    pub name: String,
    /// What it is, in a few words.
    pub title: String,
    /// What it stands for.
    pub meaning: String,
    /// Where it comes from.
    pub source: String,
    /// The engine and every setting that is not the default.
    pub settings: String,
    /// What must be equal for two columns to stand side by side: a hash of the
    /// programme without engine and interpretation.
    pub programme: String,
    /// Whether it is the small, quick study.
    pub quick: bool,
    /// Number of configurations.
    pub configurations: u32,
    /// Number of runs that the programme has.
    pub planned_runs: usize,
    /// The runs that were run.
    pub runs: Vec<InterpretationRun>,
    /// Those that failed.
    pub failures: Vec<InterpretationFailure>,
    /// What its results must be read with.
    pub warnings: Vec<String>,
    /// The paper's claims, judged.
    pub claims: Vec<Claim>,
}

/// A run of an interpretation.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct InterpretationRun {
    /// Name of its folder.
    pub name: String,
    /// What it is in the paper's programme.
    pub kind: RunKind,
    /// Which mixing of the grains.
    pub configuration: u32,
    /// Distance between funnel and cylinder in mm.
    pub falling_height_mm: f64,
    /// Its figures.
    pub summary: Summary,
    /// Settlement of the plate: time since vibration began in s, mm.
    pub plate_curve: Vec<(f64, f64)>,
    /// Settlement of the mean surface, likewise.
    pub surface_curve: Vec<(f64, f64)>,
}

/// A run that could not be made.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct InterpretationFailure {
    /// Its name.
    pub run: String,
    /// What happened, at which stage.
    pub reason: String,
}

impl InterpretationRun {
    /// What the table and the figures need of a run.
    pub fn of(run: &RunRecord) -> Self {
        Self {
            name: run.name.clone(),
            kind: run.kind,
            configuration: run.configuration,
            falling_height_mm: run.falling_height_mm,
            summary: run.summary.clone(),
            plate_curve: settlement_curve(run, |row| row.settlement_mm),
            surface_curve: settlement_curve(run, |row| row.surface_settlement_mm),
        }
    }

    /// Whether the run counts in means.
    pub fn counts_in_means(&self) -> bool {
        self.summary.counts_in_means()
    }

    /// Whether any grain is left in the cylinder.
    pub fn has_grains(&self) -> bool {
        self.summary.grains.in_cylinder > 0
    }
}

impl InterpretationColumn {
    /// The runs of a kind that kept grains.
    pub(super) fn of_kind(&self, kind: RunKind) -> impl Iterator<Item = &InterpretationRun> {
        self.runs.iter().filter(move |r| r.kind == kind && r.has_grains())
    }

    /// Of runs those that count in means; where none does, all of them, which are then to be
    /// marked: valid runs and others never stand in one mean.
    pub(super) fn never_mixed<'a>(
        runs: impl Iterator<Item = &'a InterpretationRun>,
    ) -> (Vec<&'a InterpretationRun>, LeftOut) {
        let all: Vec<&InterpretationRun> = runs.collect();
        let counting: Vec<&InterpretationRun> =
            all.iter().copied().filter(|r| r.counts_in_means()).collect();
        let left_out = all.len() - counting.len();
        if counting.is_empty() {
            (all, LeftOut { runs: left_out, all: left_out > 0 })
        } else {
            (counting, LeftOut { runs: left_out, all: false })
        }
    }

    /// How many runs meet the accuracy standard.
    pub(super) fn meeting_standard(&self) -> usize {
        self.runs.iter().filter(|r| r.summary.meets_standard).count()
    }

    /// How many runs do not count in means.
    pub(super) fn left_out(&self) -> usize {
        self.runs.iter().filter(|r| !r.counts_in_means()).count()
    }

    /// The runs that lost every grain.
    pub(super) fn emptied(&self) -> impl Iterator<Item = &InterpretationRun> {
        self.runs.iter().filter(|r| !r.has_grains())
    }
}

/// What does not count of the runs behind a number.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct LeftOut {
    /// How many runs do not count.
    pub(super) runs: usize,
    /// Whether none counts, so that the number is theirs.
    pub(super) all: bool,
}

/// Writes `interpretations.json`, `interpretations.md`, `interpretations.html` and `figures/` into a folder.
///
/// # Errors
/// [`ReportError`] naming the file or the figure.
pub fn write_interpretations(
    out: &Path,
    columns: &[InterpretationColumn],
    standard: Standard,
) -> Result<(), ReportError> {
    let rows = table::rows(columns);
    let about: Vec<Value> = columns.iter().map(about).collect();
    write_json(
        &out.join("interpretations.json"),
        &json!({ "interpretations": about, "rows": rows }),
    )?;
    let figures = figures::of_interpretations(columns)?;
    page::page(columns, &rows, figures, standard)
        .write(out, &["interpretations.md", "interpretations.html"])
}

/// What stands above a column.
fn about(c: &InterpretationColumn) -> Value {
    json!({
        "name": c.name,
        "title": c.title,
        "meaning": c.meaning,
        "source": c.source,
        "settings": c.settings,
        "quick": c.quick,
        "configurations": c.configurations,
        "runs_planned": c.planned_runs,
        "runs_done": c.runs.len(),
        "runs_meeting_standard": c.meeting_standard(),
        "runs_left_out_of_means": c.left_out(),
        "failures": c.failures,
        "warnings": c.warnings,
    })
}

#[cfg(test)]
mod tests;
