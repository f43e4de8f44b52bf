//! The report of the paper's programme: its figures, and one page that needs nothing else.

mod choices;
mod figures;
mod interpretations;
mod page;
mod sections;
mod shortfalls;
#[cfg(test)]
mod tests;
mod uncertainty;

use std::collections::BTreeMap;

use super::*;
use crate::world::EffectiveSettings;

pub use choices::{Choice, choices, pile_choices};
pub use interpretations::{
    InterpretationCell, InterpretationColumn, InterpretationFailure, InterpretationRow,
    write_interpretations,
};

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
    /// The results that decide, and the words that sum them up.
    pub scorecard: &'a Scorecard,
    /// What other engines and settings made of the same programme.
    pub beside: &'a [Column],
    /// Values the paper does not give, and why they were chosen.
    pub choices: &'a [Choice],
    /// How the programme differs from the default one, a change each; empty where it does not.
    pub changes: &'a [String],
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
    page::page(input, headline, figures).write(out, &["report.html"])
}
