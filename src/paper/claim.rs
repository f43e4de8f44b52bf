//! A statement of the paper beside what a study found.

use super::*;

/// What a statement is: only results test the simulation.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ClaimKind {
    /// What went in, or follows from it: it agrees because it was chosen so.
    Input,
    /// What the simulation could have missed, with a number of the paper to compare with.
    #[default]
    Result,
    /// The paper's text gives no number.
    NoNumber,
}

/// Whether a statement was met.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// Ours lies in the interval in which the paper's statement is read.
    Within,
    /// It does not.
    Outside,
    /// The paper's text gives no number to compare with.
    #[default]
    NotStated,
    /// It was not measured: runs are missing, or do not tell.
    NotRun,
    /// It was measured, but not as the paper's statement needs it: on a smaller specimen, or in
    /// runs that are left out of means.
    NotComparable,
}

/// One entry of `claims.json`.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
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
    /// Input, result, or a statement without a number.
    #[serde(default)]
    pub kind: ClaimKind,
    /// Whether the statement was met.
    pub verdict: Verdict,
    /// Why it was not run or cannot be compared; empty with every other verdict.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub reason: String,
    /// Whether only the paper's own specimen and programme can show it.
    #[serde(default)]
    pub full_size: bool,
    /// Names of the runs it was read from.
    pub runs: Vec<String>,
    /// The interval in which the paper's number counts as met.
    pub read_as: Option<Interval>,
    /// Smallest and largest of our values, where several make `ours`.
    pub spread: Option<Interval>,
    /// How number and statement are read, what is missing, what to mind.
    pub note: String,
    /// Names of the runs that are left out of it, as they do not count in means.
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

/// The unit of a number of things: of one of them it has no plural.
pub(super) fn unit_of(count: f64, unit: &str) -> &str {
    match unit {
        _ if count != 1.0 => unit,
        "configurations" => "configuration",
        "vibration runs" => "vibration run",
        "cases below 14 mm" => "case below 14 mm",
        "grains changed or lost" => "grain changed or lost",
        "grains" => "grain",
        _ => unit,
    }
}

/// Said where runs are missing.
const NOT_RUN: &str = "Not run.";
/// Said where runs are there, but do not tell.
const NOT_MEASURED: &str = "Not measured.";

/// Why the quick study does not show what takes longer.
pub(super) const TOO_SHORT: &str = "shaken for less time";

/// A statement as `claims.json` has it.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(deny_unknown_fields)]
struct Statement {
    id: String,
    source: String,
    /// What the paper says, with the configuration in the place of `{configuration}`.
    statement: String,
    /// Its number; none where the text has none, or the study decides.
    paper: Option<Stated>,
    /// Unit of our number.
    unit: String,
    /// Whether it is no result, but goes in, or follows from what does.
    #[serde(default)]
    input: bool,
    #[serde(default)]
    full_size: bool,
    #[serde(default)]
    note: String,
}

fn statements() -> &'static [Statement] {
    static ALL: LazyLock<Vec<Statement>> =
        LazyLock::new(|| serde_json::from_str(include_str!("claims.json")).unwrap_or_default());
    &ALL
}

/// A claim in the making; [`Draft::judge`] gives the verdict.
pub(super) struct Draft {
    claim: Claim,
    /// How many of what is counted were not run.
    missing: usize,
}

impl Draft {
    /// Of a statement of `claims.json`.
    pub(super) fn of(id: &str) -> Self {
        let of = statements().iter().find(|s| s.id == id).cloned().unwrap_or_default();
        let claim = Claim {
            id: of.id,
            source: of.source,
            statement: of.statement,
            unit: of.unit,
            kind: if of.input { ClaimKind::Input } else { ClaimKind::NoNumber },
            full_size: of.full_size,
            ..Claim::default()
        };
        let mut draft = Self { claim, missing: 0 };
        if let Some(stated) = &of.paper {
            draft = draft.paper(stated);
        }
        draft.note(of.note)
    }

    /// Of a statement on each configuration.
    pub(super) fn of_configuration(id: &str, configuration: u32) -> Self {
        let mut draft = Self::of(id);
        let claim = &mut draft.claim;
        claim.id = format!("{id}-{configuration}");
        claim.statement = claim.statement.replace("{configuration}", &configuration.to_string());
        draft
    }

    /// What the paper states; without it the verdict is "not stated".
    pub(super) fn paper(mut self, stated: &Stated) -> Self {
        self.claim.paper = Some(stated.paper());
        self.claim.read_as = Some(stated.read_as());
        if self.claim.kind == ClaimKind::NoNumber {
            self.claim.kind = ClaimKind::Result;
        }
        self.note(stated.interpretation())
    }

    /// What the runs show; what is no number counts as missing.
    pub(super) fn ours(mut self, value: Option<f64>) -> Self {
        self.claim.ours = value.filter(|v| v.is_finite());
        self
    }

    /// How many of what `ours` counts were not run: they neither meet the statement nor miss it.
    pub(super) fn missing(mut self, count: usize) -> Self {
        self.missing = count;
        self
    }

    pub(super) fn runs<'a>(mut self, runs: impl IntoIterator<Item = &'a RunRecord>) -> Self {
        self.claim.runs.extend(runs.into_iter().map(|r| r.name.clone()));
        self
    }

    pub(super) fn spread(mut self, values: impl IntoIterator<Item = f64>) -> Self {
        self.claim.spread = Interval::of(values);
        self
    }

    pub(super) fn note(mut self, sentence: impl AsRef<str>) -> Self {
        let sentence = sentence.as_ref();
        if !sentence.is_empty() {
            self.claim.add_note(sentence);
        }
        self
    }

    /// Gives the verdict. What was not run reads neither as within nor as outside.
    pub(super) fn judge(mut self) -> Claim {
        let missing = self.missing as f64;
        self.claim.verdict = match (self.claim.read_as, self.claim.ours) {
            (None, _) => Verdict::NotStated,
            (Some(_), None) => Verdict::NotRun,
            (Some(band), Some(ours)) if band.contains(ours) => Verdict::Within,
            (Some(band), Some(ours)) if self.missing > 0 && band.contains(ours + missing) => {
                self.claim.reason = format!("{} not run", self.missing);
                Verdict::NotRun
            }
            (Some(_), Some(_)) => Verdict::Outside,
        };
        self.claim
    }
}

impl Claim {
    /// Whether a strict reader counts it as missed: it is outside, or the runs that would show it
    /// are missing or left out. What the quick study does not compare, or is too short to show, is
    /// no miss.
    pub fn is_missed(&self) -> bool {
        match self.verdict {
            Verdict::Outside => true,
            Verdict::NotRun => self.reason != TOO_SHORT,
            Verdict::NotComparable => !self.left_out.is_empty() && self.ours.is_none(),
            Verdict::Within | Verdict::NotStated => false,
        }
    }

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
            let why = if self.runs.is_empty() { NOT_RUN } else { NOT_MEASURED };
            self.add_note(why);
            if self.verdict == Verdict::NotRun {
                self.reason = why.trim_end_matches('.').to_lowercase();
            }
        }
        self
    }

    /// Takes the verdict back, with the reason: what was measured is not what the statement is of.
    pub(super) fn not_comparable(&mut self, reason: &str) {
        self.verdict = Verdict::NotComparable;
        reason.clone_into(&mut self.reason);
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
                self.not_comparable("no run that would show it counts in means");
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

    /// A statement that has no number of its own.
    fn draft() -> Draft {
        Draft::of("plate-fluctuates")
    }

    fn judged(band: Option<Stated>, ours: Option<f64>) -> Claim {
        let draft = draft().ours(ours);
        match band {
            Some(band) => draft.paper(&band),
            None => draft,
        }
        .judge()
        .explained()
    }

    #[test]
    fn verdicts_follow_the_rule() {
        let band = || Some(Stated::Range(14.0, 19.61));
        for (band, ours, expected) in [
            (band(), Some(16.0), Verdict::Within),
            (band(), Some(13.9), Verdict::Outside),
            (band(), Some(20.0), Verdict::Outside),
            (band(), None, Verdict::NotRun),
            (band(), Some(f64::NAN), Verdict::NotRun),
            (None, Some(16.0), Verdict::NotStated),
            (None, None, Verdict::NotStated),
        ] {
            let claim = judged(band, ours);
            assert_eq!(claim.verdict, expected, "expected right for ours = {ours:?}: {claim:?}");
        }
    }

    #[test]
    fn what_was_not_run_says_so() {
        let claim = judged(Some(Stated::Range(1.0, 2.0)), None);
        assert!(claim.note.ends_with(NOT_RUN), "expected \"{NOT_RUN}\" in {:?}", claim.note);
        let claim = judged(Some(Stated::Range(1.0, 2.0)), Some(1.5));
        assert!(!claim.note.contains(NOT_RUN), "it was run: {:?}", claim.note);
    }

    /// Law: what is missing of a count is no miss, and what was run and misses is one.
    #[test]
    fn a_count_that_is_not_complete_is_not_outside() {
        for (ours, missing, expected) in [
            (3.0, 0, Verdict::Within),
            (2.0, 1, Verdict::NotRun),
            (1.0, 2, Verdict::NotRun),
            (1.0, 1, Verdict::Outside),
            (2.0, 0, Verdict::Outside),
        ] {
            let draft = draft().ours(Some(ours)).paper(&Stated::Count(3));
            let claim = draft.missing(missing).judge();
            assert_eq!(claim.verdict, expected, "law: {ours} of 3, {missing} not run: {claim:?}");
            assert_eq!(claim.reason.is_empty(), expected != Verdict::NotRun, "law: {claim:?}");
        }
    }

    #[test]
    fn a_kind_follows_from_the_number_unless_it_is_an_input() {
        let kind = |draft: Draft| draft.judge().kind;
        let input = Draft::of("no-crushing").paper(&Stated::Count(3));
        assert_eq!(kind(draft()), ClaimKind::NoNumber, "law: without a number");
        assert_eq!(kind(draft().paper(&Stated::Count(3))), ClaimKind::Result, "law: with one");
        assert_eq!(kind(input), ClaimKind::Input, "law: said");
    }

    #[test]
    fn statements_can_be_read_and_their_names_are_unique() {
        let mut ids: Vec<&str> = statements().iter().map(|s| s.id.as_str()).collect();
        assert_eq!(ids.len(), 25, "law: every statement of `claims.json` is read");
        ids.sort_unstable();
        ids.dedup();
        assert_eq!(ids.len(), 25, "law: each once");
        let settlement = Draft::of("continuous-final-settlement").judge().read_as;
        assert_eq!(settlement, Some(crate::paper::bands::FINAL_SETTLEMENT_MM), "law: one number");
    }

    #[test]
    fn one_of_a_thing_has_no_plural() {
        for (count, unit, expected) in [
            (1.0, "configurations", "configuration"),
            (1.0, "vibration runs", "vibration run"),
            (0.0, "configurations", "configurations"),
            (3.0, "cases below 14 mm", "cases below 14 mm"),
            (1.0, "mm", "mm"),
        ] {
            assert_eq!(unit_of(count, unit), expected, "law: {count} {unit}");
        }
        // Every unit of a count is known.
        for statement in statements() {
            let plural = statement.unit.split(' ').next().is_some_and(|word| word.ends_with('s'));
            let counted = (plural && statement.unit != "s") || statement.unit == "vibration runs";
            let has_singular = unit_of(1.0, &statement.unit) != statement.unit;
            assert_eq!(has_singular, counted, "law: {} of {}", statement.unit, statement.id);
        }
    }

    #[test]
    fn looks_as_scripts_expect() {
        let json = serde_json::to_value(judged(None, None)).expect("serialises");
        let fields =
            ["id", "source", "statement", "paper", "ours", "unit", "kind", "verdict", "runs"];
        for field in fields {
            assert!(json.get(field).is_some(), "`{field}` is missing in {json}");
        }
        assert!(json["paper"].is_null() && json["ours"].is_null(), "null, not left out: {json}");
        assert_eq!((&json["verdict"], &json["kind"]), (&"not_stated".into(), &"no_number".into()));
    }
}
