//! A statement of the paper beside what a study found.

use serde::{Deserialize, Serialize};

use super::bands::{Band, Interval, PaperValue};
use crate::record::RunRecord;

/// Whether a statement was met.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// Ours lies in the interval in which the paper's statement is read.
    Within,
    /// It does not, or the runs that would show it are missing.
    Outside,
    /// The paper's text gives nothing to hold it against.
    NotStated,
    /// Runs were done, and none of those that would show it counts in means.
    NotComparable,
}

/// One entry of `claims.json`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Claim {
    /// Stable name, for scripts.
    pub id: String,
    /// Section and figure of the paper.
    pub source: String,
    /// What the paper says, in a sentence.
    pub statement: String,
    /// Its number; null where the text has none.
    pub paper: Option<PaperValue>,
    /// What the runs show; null where they are missing.
    pub ours: Option<f64>,
    /// Unit of both.
    pub unit: String,
    /// Whether the statement was met.
    pub verdict: Verdict,
    /// Names of the runs it was read from.
    pub runs: Vec<String>,
    /// The interval in which the paper's number counts as met.
    pub read_as: Option<Interval>,
    /// Smallest and largest of our values, where several make `ours`.
    pub spread: Option<Interval>,
    /// How number and statement are read, what is missing, what to mind.
    pub note: String,
    /// Names of the runs that are left out of it, being not valid or short of grains.
    #[serde(default)]
    pub left_out: Vec<String>,
    /// What the runs that are left out show, where no other run does; for information only,
    /// and never part of `ours`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub not_valid: Option<NotValid>,
}

/// What runs show that are left out.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct NotValid {
    /// Their value, in the claim's unit.
    pub value: f64,
    /// Smallest and largest, where several make it.
    pub spread: Option<Interval>,
}

/// Said where runs are missing.
const NOT_RUN: &str = "Not run.";
/// Said where runs are there, but do not tell.
const NOT_MEASURED: &str = "Not measured.";

/// A claim in the making; [`Draft::judge`] gives the verdict.
pub(super) struct Draft(Claim);

impl Draft {
    pub(super) fn new(id: impl Into<String>, source: &str, statement: impl Into<String>) -> Self {
        Self(Claim {
            id: id.into(),
            source: source.to_owned(),
            statement: statement.into(),
            paper: None,
            ours: None,
            unit: String::new(),
            verdict: Verdict::NotStated,
            runs: Vec::new(),
            read_as: None,
            spread: None,
            note: String::new(),
            left_out: Vec::new(),
            not_valid: None,
        })
    }

    /// What the paper states; without it the verdict is "not stated".
    pub(super) fn paper(mut self, band: Band) -> Self {
        self.0.paper = Some(band.paper);
        self.0.read_as = Some(band.read_as);
        self.note(&band.reading)
    }

    /// What the runs show, and its unit; what is no number counts as missing.
    pub(super) fn ours(mut self, value: Option<f64>, unit: &str) -> Self {
        self.0.ours = value.filter(|v| v.is_finite());
        self.0.unit = unit.to_owned();
        self
    }

    pub(super) fn runs<'a>(mut self, runs: impl IntoIterator<Item = &'a RunRecord>) -> Self {
        self.0.runs.extend(runs.into_iter().map(|r| r.name.clone()));
        self
    }

    pub(super) fn spread(mut self, values: impl IntoIterator<Item = f64>) -> Self {
        self.0.spread = Interval::of(values);
        self
    }

    /// Adds a sentence to the note.
    pub(super) fn note(mut self, sentence: impl AsRef<str>) -> Self {
        let sentence = sentence.as_ref();
        if !sentence.is_empty() {
            self.0.add_note(sentence);
        }
        self
    }

    /// Gives the verdict. What was not run never reads as within.
    pub(super) fn judge(mut self) -> Claim {
        self.0.verdict = match (self.0.read_as, self.0.ours) {
            (None, _) => Verdict::NotStated,
            (Some(_), None) => Verdict::Outside,
            (Some(band), Some(ours)) if band.contains(ours) => Verdict::Within,
            (Some(_), Some(_)) => Verdict::Outside,
        };
        self.0
    }
}

impl Claim {
    /// Adds a sentence to the note.
    pub(super) fn add_note(&mut self, sentence: &str) {
        if !self.note.is_empty() {
            self.note.push(' ');
        }
        self.note.push_str(sentence);
    }

    /// Says what is missing where there is no value.
    pub(super) fn explained(mut self) -> Self {
        if self.ours.is_none() {
            self.add_note(if self.runs.is_empty() { NOT_RUN } else { NOT_MEASURED });
        }
        self
    }

    /// With the runs that are left out of it, each with its name and what is against it, and
    /// with what they show. Without any it is [`Claim::explained`].
    pub(super) fn leaving_out(mut self, runs: &[(String, String)], they: &Self) -> Self {
        if runs.is_empty() {
            return self.explained();
        }
        self.left_out = runs.iter().map(|(name, _)| name.clone()).collect();
        let each: Vec<String> = runs.iter().map(|(name, why)| format!("{name} ({why})")).collect();
        if self.ours.is_none() && (self.runs.is_empty() || they.ours.is_some()) {
            if self.paper.is_some() {
                self.verdict = Verdict::NotComparable;
            }
            self.not_valid = they.ours.map(|value| NotValid { value, spread: they.spread });
            self.add_note(&format!("No valid run shows it; left out: {}.", each.join("; ")));
            return self;
        }
        self.add_note(&format!("Left out: {}.", each.join("; ")));
        self.explained()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn judged(band: Option<Band>, ours: Option<f64>) -> Claim {
        let draft = Draft::new("id", "section 4", "statement").ours(ours, "mm");
        match band {
            Some(band) => draft.paper(band),
            None => draft,
        }
        .judge()
        .explained()
    }

    #[test]
    fn verdicts_follow_the_rule() {
        let band = || Some(Band::range(14.0, 19.61));
        for (band, ours, expected) in [
            (band(), Some(16.0), Verdict::Within),
            (band(), Some(13.9), Verdict::Outside),
            (band(), Some(20.0), Verdict::Outside),
            (band(), None, Verdict::Outside),
            (band(), Some(f64::NAN), Verdict::Outside),
            (None, Some(16.0), Verdict::NotStated),
            (None, None, Verdict::NotStated),
        ] {
            let claim = judged(band, ours);
            assert_eq!(claim.verdict, expected, "expected right for ours = {ours:?}: {claim:?}");
        }
    }

    #[test]
    fn what_was_not_run_says_so() {
        let claim = judged(Some(Band::range(1.0, 2.0)), None);
        assert!(claim.note.ends_with(NOT_RUN), "expected \"{NOT_RUN}\" in {:?}", claim.note);
        let claim = judged(Some(Band::range(1.0, 2.0)), Some(1.5));
        assert!(!claim.note.contains(NOT_RUN), "it was run: {:?}", claim.note);
    }

    #[test]
    fn looks_as_scripts_expect() {
        let json = serde_json::to_value(judged(None, None)).expect("serialises");
        for field in ["id", "source", "statement", "paper", "ours", "unit", "verdict", "runs"] {
            assert!(json.get(field).is_some(), "`{field}` is missing in {json}");
        }
        assert!(json["paper"].is_null() && json["ours"].is_null(), "null, not left out: {json}");
        assert_eq!(json["verdict"], "not_stated");
    }
}
