//! The results that decide whether the paper is reproduced, a row each, and the words that say
//! so. A row is a mean over the configurations where the paper gives a number, and a count
//! where it states what every test shows. Inputs have no row, and no place in the tally.

mod headline;
mod rows;
#[cfg(test)]
mod tests;

use super::*;

/// `scorecard.json`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Scorecard {
    /// What is reproduced, what is not and what is not decided, a line each.
    pub paragraph: String,
    /// Why, what was not compared, and how far the runs can be believed; a line each.
    pub reasons: String,
    /// How many rows stand where. A row counts once, however many configurations, and entries of
    /// `claims.json`, are behind it.
    pub tally: RowCounts,
    /// How many results of `claims.json` have which verdict; inputs and statements without a
    /// number are not among them. A statement on each configuration has an entry for each.
    pub results: ResultCounts,
    /// The rows, in the paper's order.
    pub rows: Vec<ScoreRow>,
}

/// Where rows stand.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
pub struct RowCounts {
    /// Ours lies where the paper's number is read to lie, decidedly where that can be asked.
    pub within: usize,
    /// It does not, likewise.
    pub outside: usize,
    /// Runs speak for one of the two, and intervals leave it open.
    pub not_decided: usize,
    /// The paper's text gives no number.
    pub not_stated: usize,
    /// Not measured.
    pub not_run: usize,
    /// Measured, but not as the paper's statement needs it.
    pub not_comparable: usize,
}

/// Verdicts of results.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
pub struct ResultCounts {
    /// Ours lies where the paper's number is read to lie.
    pub within: usize,
    /// It does not.
    pub outside: usize,
    /// Not measured.
    pub not_run: usize,
    /// Measured, but not as the paper's statement needs it.
    pub not_comparable: usize,
}

/// One row of the scorecard.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct ScoreRow {
    /// Stable name, for scripts.
    pub id: &'static str,
    /// What the paper states, in a few words.
    pub statement: &'static str,
    /// Section and figure of the paper.
    pub source: String,
    /// Its number in words; a dash where its text has none.
    pub paper: String,
    /// Ours: a mean over the runs that count, or how many show it; null where nothing does.
    pub ours: Option<f64>,
    /// 95 % confidence interval of the mean by Student's t, of the specimens' means where each
    /// has several placements of the plate; null of fewer than two specimens, and of counts.
    pub interval: Option<Interval>,
    /// Number of runs behind the mean, or of what was counted.
    pub count: usize,
    /// Unit of `ours`.
    pub unit: String,
    /// Ours with its interval, for a reader.
    pub in_words: String,
    /// Of the mean: whether it lies where the paper's number is read to lie; of a count: whether
    /// all show it; of the angle of repose: whether our interval holds the paper's number.
    pub verdict: Verdict,
    /// Whether the verdict is more than chance. Of a mean that was judged by a range: whether its
    /// whole interval lies on the same side of the range's ends; of a count of what is measured:
    /// whether the whole interval of its mean says the same. One run decides nothing. Null of what
    /// is not judged so.
    pub decided: Option<bool>,
    /// Why it was not run or cannot be compared; empty with every other verdict.
    pub reason: String,
    /// How it was judged, and what to mind; empty where nothing is.
    pub note: String,
    /// Runs left out, as they do not count in means.
    pub left_out: usize,
    /// The entries of `claims.json` behind it.
    pub claims: Vec<String>,
    /// How far ours lies beyond the paper's interval: below it negative; 0 within.
    pub beyond: f64,
}

impl ScoreRow {
    /// The verdict that a reader is shown; none where runs speak for one that intervals leave open.
    pub fn stands(&self) -> Option<Verdict> {
        (self.decided != Some(false)).then_some(self.verdict)
    }

    /// Adds a sentence to the note.
    fn add_note(&mut self, sentence: &str) {
        if !self.note.is_empty() && !sentence.is_empty() {
            self.note.push(' ');
        }
        self.note.push_str(sentence);
    }
}

impl RowCounts {
    /// Of rows.
    pub fn of(rows: &[ScoreRow]) -> Self {
        let count = |stands| rows.iter().filter(|row| row.stands() == stands).count();
        Self {
            within: count(Some(Verdict::Within)),
            outside: count(Some(Verdict::Outside)),
            not_decided: count(None),
            not_stated: count(Some(Verdict::NotStated)),
            not_run: count(Some(Verdict::NotRun)),
            not_comparable: count(Some(Verdict::NotComparable)),
        }
    }

    /// "8 rows: …" for the reader.
    pub fn in_words(&self) -> String {
        let always = [(self.within, "within"), (self.outside, "outside")];
        let others = [
            (self.not_decided, "not decided"),
            (self.not_stated, "not stated"),
            (self.not_run, "not run"),
            (self.not_comparable, "not comparable"),
        ];
        let all: usize = always.iter().chain(&others).map(|(count, _)| count).sum();
        let shown = always.into_iter().chain(others.into_iter().filter(|(count, _)| *count > 0));
        let parts: Vec<String> = shown.map(|(count, what)| format!("{count} {what}")).collect();
        format!("{}: {}", counted(all, "row"), parts.join(", "))
    }
}

impl ResultCounts {
    /// Of the results among claims.
    pub fn of(claims: &[Claim]) -> Self {
        let count = |verdict| {
            claims.iter().filter(|c| c.kind == ClaimKind::Result && c.verdict == verdict).count()
        };
        Self {
            within: count(Verdict::Within),
            outside: count(Verdict::Outside),
            not_run: count(Verdict::NotRun),
            not_comparable: count(Verdict::NotComparable),
        }
    }
}

/// The scorecard of a study and its judged claims.
pub fn scorecard(study: &StudyView, claims: &[Claim]) -> Scorecard {
    let (runs, left_out) = study.split();
    let counting = &study.of_runs(&runs, &left_out);
    let rows = rows::rows(study, counting, claims);
    let (tally, results) = (RowCounts::of(&rows), ResultCounts::of(claims));
    let paragraph = headline::paragraph(study, &rows);
    let reasons = headline::reasons(study, counting, &rows, &tally);
    Scorecard { paragraph, reasons, tally, results, rows }
}
