//! Interpretations of the paper side by side: one table, a column an interpretation, as JSON,
//! Markdown and a page, with figures that lay their curves over each other.

mod page;
mod table;

use super::*;

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
    /// The runs that were run, with the rows of their series that settlement is measured at.
    pub runs: Vec<RunRecord>,
    /// Those that failed.
    pub failures: Vec<InterpretationFailure>,
    /// What its results must be read with.
    pub warnings: Vec<String>,
    /// The paper's claims, judged.
    pub claims: Vec<Claim>,
}

/// A run that could not be made.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct InterpretationFailure {
    /// Its name.
    pub run: String,
    /// What happened, at which stage.
    pub reason: String,
}

impl InterpretationColumn {
    /// The runs of a kind that kept grains.
    pub(super) fn of_kind(&self, kind: RunKind) -> impl Iterator<Item = &RunRecord> {
        self.runs.iter().filter(move |r| r.kind == kind && has_grains(r))
    }

    /// The runs that were poured from a height in mm and kept grains.
    pub(super) fn poured_from(&self, height_mm: f64) -> impl Iterator<Item = &RunRecord> {
        let poured = self.of_kind(RunKind::Pluviation);
        poured.filter(move |r| (r.falling_height_mm - height_mm).abs() < 0.5)
    }

    pub(super) fn meeting_standard(&self) -> usize {
        self.runs.iter().filter(|r| r.summary.meets_standard).count()
    }

    /// How many runs do not count in means.
    pub(super) fn left_out(&self) -> usize {
        self.runs.iter().filter(|r| !r.counts_in_means()).count()
    }

    /// The runs that lost every grain.
    pub(super) fn emptied(&self) -> impl Iterator<Item = &RunRecord> {
        self.runs.iter().filter(|r| !has_grains(r))
    }
}

/// Whether any grain is left in the cylinder.
fn has_grains(run: &RunRecord) -> bool {
    run.summary.grains.in_cylinder > 0
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
