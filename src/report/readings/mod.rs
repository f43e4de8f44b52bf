//! Readings of the paper side by side: one table, a column a reading, as JSON,
//! Markdown and a page, with figures that lay their curves over each other.

mod page;
mod table;

use std::path::Path;

use serde::{Deserialize, Serialize};

use super::{ReportError, Standard, figures};
use crate::{
    paper::{Claim, settlement_curve},
    record::{RunKind, RunRecord, Summary, write_file, write_json},
};

pub use table::{ReadingCell, ReadingRow};

/// What one reading made of the programme.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ReadingColumn {
    /// Its name, as `--reading` takes it.
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
    /// programme without engine and reading.
    pub programme: String,
    /// Whether it is the small, quick study.
    pub quick: bool,
    /// Number of configurations.
    pub configurations: u32,
    /// Number of runs that the programme has.
    pub planned_runs: usize,
    /// The runs that were carried out.
    pub runs: Vec<ReadingRun>,
    /// Those that failed.
    pub failures: Vec<ReadingFailure>,
    /// What its results must be read with.
    pub warnings: Vec<String>,
    /// The paper's claims, judged.
    pub claims: Vec<Claim>,
}

/// A run of a reading.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ReadingRun {
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

/// A run that could not be carried out.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct ReadingFailure {
    /// Its name.
    pub run: String,
    /// What happened, at which stage.
    pub reason: String,
}

impl ReadingRun {
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

impl ReadingColumn {
    /// The runs of a kind that kept grains.
    pub(super) fn of_kind(&self, kind: RunKind) -> impl Iterator<Item = &ReadingRun> {
        self.runs.iter().filter(move |r| r.kind == kind && r.has_grains())
    }

    /// Of runs those that count in means; where none does, all of them, which are then to be
    /// marked: valid runs and others never stand in one mean.
    pub(super) fn never_mixed<'a>(
        runs: impl Iterator<Item = &'a ReadingRun>,
    ) -> (Vec<&'a ReadingRun>, LeftOut) {
        let all: Vec<&ReadingRun> = runs.collect();
        let counting: Vec<&ReadingRun> =
            all.iter().copied().filter(|r| r.counts_in_means()).collect();
        let left_out = all.len() - counting.len();
        if counting.is_empty() {
            (all, LeftOut { runs: left_out, all: left_out > 0 })
        } else {
            (counting, LeftOut { runs: left_out, all: false })
        }
    }

    /// The runs that lost every grain.
    pub(super) fn emptied(&self) -> impl Iterator<Item = &ReadingRun> {
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

/// `readings.json`.
#[derive(Serialize)]
struct Readings<'a> {
    readings: Vec<About<'a>>,
    rows: &'a [ReadingRow],
}

/// What stands above a column.
#[derive(Serialize)]
struct About<'a> {
    name: &'a str,
    title: &'a str,
    meaning: &'a str,
    source: &'a str,
    settings: &'a str,
    quick: bool,
    configurations: u32,
    runs_planned: usize,
    runs_done: usize,
    runs_meeting_standard: usize,
    runs_left_out_of_means: usize,
    failures: &'a [ReadingFailure],
    warnings: &'a [String],
}

/// Writes `readings.json`, `readings.md`, `readings.html` and `figures/` into a folder.
///
/// # Errors
/// [`ReportError`] naming the file or the figure.
pub fn write_readings(
    out: &Path,
    columns: &[ReadingColumn],
    standard: Standard,
) -> Result<(), ReportError> {
    let rows = table::rows(columns);
    let figures = figures::of_readings(columns)?;
    for figure in &figures {
        figure.write(&out.join("figures"))?;
    }
    let about = |c: &'_ ReadingColumn| -> usize {
        c.runs.iter().filter(|r| r.summary.meets_standard).count()
    };
    let readings = columns
        .iter()
        .map(|c| About {
            name: &c.name,
            title: &c.title,
            meaning: &c.meaning,
            source: &c.source,
            settings: &c.settings,
            quick: c.quick,
            configurations: c.configurations,
            runs_planned: c.planned_runs,
            runs_done: c.runs.len(),
            runs_meeting_standard: about(c),
            runs_left_out_of_means: c.runs.iter().filter(|r| !r.counts_in_means()).count(),
            failures: &c.failures,
            warnings: &c.warnings,
        })
        .collect();
    write_json(&out.join("readings.json"), &Readings { readings, rows: &rows })?;
    write_file(&out.join("readings.md"), page::markdown(columns, &rows, standard).as_bytes())?;
    let html = page::html(columns, &rows, &figures, standard);
    write_file(&out.join("readings.html"), html.as_bytes())?;
    Ok(())
}

#[cfg(test)]
mod tests;
