//! The results that decide whether the paper is reproduced, a row each, and the paragraph that
//! says so. A row is a mean over the configurations where the paper gives a number, and a count
//! where it states what every test shows. Inputs have no row, and no place in the tally.

mod headline;
#[cfg(test)]
mod tests;

use serde::Serialize;

use super::{
    Claim, ClaimKind, Interval, PaperValue, StudyView, Verdict,
    text::{compact, number},
    view::{angle_of_repose, plate},
};
use crate::measure::{inference::MeanTest, statistics::mean};
use crate::record::{RunKind, Settlement};

/// Confidence of the rows' intervals.
const CONFIDENCE: f64 = 0.95;

/// `scorecard.json`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Scorecard {
    /// What is reproduced, what is not and why, in one paragraph.
    pub paragraph: String,
    /// How many results of `claims.json` have which verdict; inputs and statements without a
    /// number are not among them.
    pub results: ResultCounts,
    /// The rows, in the paper's order.
    pub rows: Vec<ScoreRow>,
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
    /// 95 % confidence interval of the mean by Student's t; null of fewer than two runs, and of
    /// counts.
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
    /// Of a mean that was judged by a range: whether its whole interval lies on the same side of
    /// the range's ends, so that the verdict is more than chance. One run decides nothing. Null of
    /// what is not judged so.
    pub decided: Option<bool>,
    /// Why it was not run or cannot be compared; empty with every other verdict.
    pub reason: String,
    /// Runs left out, being not valid or short of grains.
    pub left_out: usize,
    /// The entries of `claims.json` behind it.
    pub claims: Vec<String>,
    /// How far ours lies beyond the paper's interval: below it negative; 0 within.
    pub beyond: f64,
}

impl ScoreRow {
    /// Whether runs speak for a verdict that more of them could turn.
    pub fn is_undecided(&self) -> bool {
        self.decided == Some(false)
    }
}

struct Row<'a> {
    id: &'static str,
    statement: &'static str,
    claims: Vec<&'a Claim>,
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

    /// All of them.
    pub fn total(&self) -> usize {
        self.within + self.outside + self.not_run + self.not_comparable
    }

    /// "Of 13 results …" for the reader.
    pub fn in_words(&self) -> String {
        let mut parts =
            vec![format!("{} within", self.within), format!("{} outside", self.outside)];
        for (count, what) in [(self.not_run, "not run"), (self.not_comparable, "not comparable")] {
            if count > 0 {
                parts.push(format!("{count} {what}"));
            }
        }
        format!("{} results: {}", self.total(), parts.join(", "))
    }
}

/// The scorecard of a study and its judged claims.
pub fn scorecard(study: &StudyView, claims: &[Claim]) -> Scorecard {
    let (runs, left_out) = study.split();
    let counting = &study.of_runs(&runs, &left_out);
    let rows = rows(counting, claims);
    let results = ResultCounts::of(claims);
    let paragraph = headline::paragraph(study, counting, &rows, &results);
    Scorecard { paragraph, results, rows }
}

fn rows(study: &StudyView, claims: &[Claim]) -> Vec<ScoreRow> {
    let of = |id, statement, wanted: &dyn Fn(&str) -> bool| Row {
        id,
        statement,
        claims: claims.iter().filter(|c| wanted(&c.id)).collect(),
    };
    let one = |id: &'static str, statement| of(id, statement, &|name| name == id);
    // "…-1", "…-2": one claim a configuration.
    let each = |id: &'static str, statement| {
        of(id, statement, &|name| {
            let number = name.strip_prefix(id).and_then(|rest| rest.strip_prefix('-'));
            number.is_some_and(|n| n.parse::<u32>().is_ok())
        })
    };
    let settled =
        |kind, value: fn(&Settlement) -> Option<f64>| study.values(kind, move |r| value(plate(r)?));
    let (continuous, intermittent) = (RunKind::VibrationContinuous, RunKind::VibrationIntermittent);
    let mut falls =
        one("standing-height-falls", "Gravel that falls from higher stands lower").counted();
    if let (Some(row), Some(slope)) = (&mut falls, super::uncertainty::trend(study).slope) {
        let mean = number(slope.mean_mm_per_cm, 2);
        row.in_words += &format!("; {mean} mm per cm {}", in_brackets(slope.interval, 2));
    }
    let after_20_s = settled(continuous, |s| Some(s.final_mm));
    let after_5_s = settled(continuous, |s| Some(100.0 * s.share_after_5_s?));
    let of_first = |s: &Settlement| Some(100.0 * s.after_each_period.first()? / s.final_mm);
    let after_first = settled(intermittent, of_first);
    let after_last = settled(intermittent, |s| Some(s.final_mm));
    let angles = study.values(RunKind::Repose, angle_of_repose);
    [
        falls,
        one("denser-after-vibration", "Gravel is denser after vibration").counted(),
        each("continuous-final-settlement", "Settlement of the plate after 20 s of vibration")
            .mean(&after_20_s, "mm", 1),
        each("continuous-share-after-5-s", "Share of it in the first 5 s").mean(&after_5_s, "%", 0),
        each(
            "intermittent-share-in-first-period",
            "Share in the first of four periods of vibration",
        )
        .mean(&after_first, "%", 0),
        one("intermittent-fluctuation-at-ends", "The plate moves most as a period begins and ends")
            .counted(),
        one("intermittent-in-laboratory-range", "Settlement of the plate after four periods").mean(
            &after_last,
            "mm",
            1,
        ),
        one("angle-of-repose", "Angle of repose").mean(&angles, "°", 1),
    ]
    .into_iter()
    .flatten()
    .collect()
}

fn in_brackets(interval: Interval, decimals: usize) -> String {
    format!("[{} … {}]", number(interval.low, decimals), number(interval.high, decimals))
}

impl Row<'_> {
    /// A mean over configurations; none where no claim is of it.
    fn mean(self, values: &[f64], unit: &str, decimals: usize) -> Option<ScoreRow> {
        let test = MeanTest::of(values, CONFIDENCE);
        let ours = mean(values);
        let interval = test.map(|t| Interval::around(t.estimate.mean, t.half_width));
        let mut row = self.begun(unit, false)?;
        let space = if unit == "°" { "" } else { " " };
        row.in_words = match (ours, interval) {
            (None, _) => "–".to_owned(),
            (Some(m), None) => format!("{}{space}{unit} (one run)", number(m, decimals)),
            (Some(m), Some(i)) => {
                format!("{}{space}{unit} {}", number(m, decimals), in_brackets(i, decimals))
            }
        };
        (row.ours, row.interval, row.count) = (ours, interval, values.len());
        let band = self.claims.first().and_then(|c| c.read_as);
        if let (Some(band), Some(ours)) = (band, ours) {
            row.beyond =
                if ours < band.low { ours - band.low } else { (ours - band.high).max(0.0) };
            // One claim a configuration: the row's verdict is of their mean.
            if matches!(row.verdict, Verdict::Within | Verdict::Outside) {
                let within = band.contains(ours);
                row.verdict = if within { Verdict::Within } else { Verdict::Outside };
                row.decided = Some(interval.is_some_and(|i| match within {
                    true => band.contains(i.low) && band.contains(i.high),
                    false => i.high < band.low || i.low > band.high,
                }));
            }
        }
        // The angle of repose has no band: it is compared by our own interval.
        if let (None, Some(PaperValue::Value { value }), Some(ours)) =
            (band, self.claims.first().and_then(|c| c.paper), ours)
        {
            row.beyond = ours - value;
        }
        Some(row)
    }

    /// A count of what shows it.
    fn counted(self) -> Option<ScoreRow> {
        let claim = *self.claims.first()?;
        let mut row = self.begun(&claim.unit, true)?;
        let expected = claim.read_as.map_or(0.0, |i| i.high);
        row.ours = claim.ours;
        row.count = expected as usize;
        row.in_words = claim.ours.map_or("–".to_owned(), |ours| {
            format!("{} of {} {}", number(ours, 0), number(expected, 0), claim.unit)
        });
        row.beyond = claim.ours.map_or(0.0, |ours| ours - expected);
        Some(row)
    }

    /// The row without its value; none where no claim is of it.
    fn begun(&self, unit: &str, all: bool) -> Option<ScoreRow> {
        let first = self.claims.first()?;
        let judged = |verdict| self.claims.iter().find(|c| c.verdict == verdict);
        // What was compared counts; what was not has its reason.
        let speaks = [Verdict::Outside, Verdict::Within, Verdict::NotComparable, Verdict::NotRun]
            .into_iter()
            .find_map(judged)
            .unwrap_or(first);
        let mut left_out: Vec<&String> = self.claims.iter().flat_map(|c| &c.left_out).collect();
        left_out.sort();
        left_out.dedup();
        let paper = match first.paper {
            None => "–".to_owned(),
            Some(_) if all => "all".to_owned(),
            Some(PaperValue::Range(i)) => {
                format!("{} to {} {unit}", compact(i.low), compact(i.high))
            }
            Some(PaperValue::Value { value }) if unit == "°" => format!("{}°", number(value, 2)),
            Some(PaperValue::Value { value }) => format!("about {} {unit}", compact(value)),
        };
        Some(ScoreRow {
            id: self.id,
            statement: self.statement,
            source: first.source.clone(),
            paper,
            unit: unit.to_owned(),
            verdict: speaks.verdict,
            reason: speaks.reason.clone(),
            left_out: left_out.len(),
            claims: self.claims.iter().map(|c| c.id.clone()).collect(),
            ..ScoreRow::default()
        })
    }
}
