//! Judges what a case measured: what was expected, what it got, and whether that is within the
//! tolerance.

use serde::{Deserialize, Serialize};

use super::{Case, Setting, VerifyError, experiment::Outcome};

/// Whether a value lies within a tolerance of what is expected; NaN never does.
pub fn within(expected: f64, got: f64, tolerance: f64) -> bool {
    (got - expected).abs() <= tolerance
}

/// What a case's outcome means.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Status {
    /// The law is met.
    Pass,
    /// The law is missed.
    Fail,
    /// The law is missed, as the case says it would be.
    KnownFailure,
    /// The law is met though the case calls it a known failure: the case must be corrected.
    UnexpectedPass,
}

impl Status {
    /// Of a measurement and what is known.
    pub fn of(met: bool, known: bool) -> Self {
        match (met, known) {
            (true, false) => Self::Pass,
            (false, false) => Self::Fail,
            (false, true) => Self::KnownFailure,
            (true, true) => Self::UnexpectedPass,
        }
    }

    /// Whether all is as the case says.
    pub fn as_expected(self) -> bool {
        matches!(self, Self::Pass | Self::KnownFailure)
    }

    /// In words.
    pub fn words(self) -> &'static str {
        match self {
            Self::Pass => "pass",
            Self::Fail => "FAIL",
            Self::KnownFailure => "known failure",
            Self::UnexpectedPass => "UNEXPECTED PASS",
        }
    }
}

/// One row of `verify.json`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Verdict {
    /// Name of the case.
    pub id: String,
    /// What is done.
    pub title: String,
    /// The law.
    pub law: String,
    /// Where law and values come from.
    pub source: String,
    /// `stock`, `rapier`.
    pub backend: String,
    /// Version of the engine.
    pub version: String,
    /// `double` or `single`.
    pub precision: String,
    /// Name of the setting.
    pub setting: String,
    /// What is measured.
    pub quantity: String,
    /// What the law says.
    pub expected: f64,
    /// What was measured; null when nothing could be.
    pub got: Option<f64>,
    /// Largest difference that passes.
    pub tolerance: f64,
    /// Unit of the values.
    pub unit: String,
    /// Whether the law is met.
    pub pass: bool,
    /// What that means for the suite.
    pub status: Status,
    /// Why it is known to fail.
    pub known_reason: Option<String>,
    /// What went wrong in the experiment, or what else is to be said.
    pub note: Option<String>,
    /// Wall time in s.
    pub wall_s: f64,
    /// Curves for the figure.
    #[serde(skip)]
    pub outcome: Option<Outcome>,
}

impl Verdict {
    /// Judges an outcome.
    pub fn of(case: &Case, setting: &Setting, outcome: Result<Outcome, VerifyError>) -> Self {
        let engine = crate::world::info(setting.engine.backend);
        let tolerance = match case.tolerance_single {
            Some(single) if engine.precision == "single" => single,
            _ => case.tolerance,
        };
        let known = case.known_failures.iter().find(|k| k.covers(&setting.name));
        let note = match &outcome {
            Ok(outcome) => outcome.note.clone(),
            Err(error) => Some(error.to_string()),
        };
        let outcome = outcome.ok();
        let got = outcome.as_ref().map(|o| o.got).filter(|got| got.is_finite());
        let pass = got.is_some_and(|got| within(case.expected, got, tolerance));
        Self {
            id: case.id.clone(),
            title: case.title.clone(),
            law: case.law.clone(),
            source: case.source.clone(),
            backend: engine.name,
            version: engine.version,
            precision: engine.precision,
            setting: setting.name.clone(),
            quantity: case.quantity.clone(),
            expected: case.expected,
            got,
            tolerance,
            unit: case.unit.clone(),
            pass,
            status: Status::of(pass, known.is_some()),
            known_reason: known.map(|k| k.reason.clone()),
            note,
            wall_s: 0.0,
            outcome,
        }
    }

    /// Why it is known to fail, and what else is to be said.
    pub fn remarks(&self) -> String {
        sentences(self.known_reason.iter().chain(&self.note).map(String::as_str))
    }
}

/// Remarks in a row, each but the last ended by one full stop.
fn sentences<'a>(remarks: impl Iterator<Item = &'a str>) -> String {
    let mut text = String::new();
    for remark in remarks {
        let between = match text.as_str() {
            "" => "",
            before if before.ends_with('.') => " ",
            _ => ". ",
        };
        text = text + between + remark;
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_comparison_can_fail_in_both_directions() {
        for got in [1.0, 0.9, 1.1] {
            assert!(within(1.0, got, 0.1 + 1e-12), "law: {got} is within 0.1 of 1");
        }
        for got in [0.89, 1.11, f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            assert!(!within(1.0, got, 0.1), "law: {got} is not within 0.1 of 1");
        }
    }

    #[test]
    fn remarks_are_sentences() {
        for (remarks, expected) in [
            (&["Slow.", "0.35 at 240 Hz"][..], "Slow. 0.35 at 240 Hz"),
            (&["slow", "0.35 at 240 Hz"][..], "slow. 0.35 at 240 Hz"),
            (&["Slow."][..], "Slow."),
            (&[][..], ""),
        ] {
            assert_eq!(sentences(remarks.iter().copied()), expected, "law: one full stop each");
        }
    }

    #[test]
    fn a_known_failure_that_passes_is_no_success() {
        assert_eq!(Status::of(true, true), Status::UnexpectedPass);
        assert!(!Status::UnexpectedPass.as_expected() && !Status::Fail.as_expected());
        assert!(Status::of(true, false).as_expected() && Status::of(false, true).as_expected());
    }
}
