//! A row of the table: a published number, where it was seen, and ours beside it.

use pluvia::measure::inference::MeanTest;
use serde::{Deserialize, Serialize};

use super::standard_tests::{Verdict, judge};

/// What is published.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Published {
    /// From one value to another.
    Range { low: f64, high: f64 },
    /// One value.
    Value { value: f64 },
}

/// An interval.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Interval {
    pub low: f64,
    pub high: f64,
}

/// A reference, and what became of it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Row {
    pub id: String,
    /// The test that it belongs to.
    pub test: String,
    pub quantity: String,
    pub published: Option<Published>,
    /// Where the number was seen, with what was seen; or that it was not.
    pub source: String,
    /// Mean over realisations.
    pub ours: Option<f64>,
    /// Its 95 % confidence interval by Student's t.
    pub interval: Option<Interval>,
    /// Each realisation.
    pub values: Vec<f64>,
    pub verdict: Verdict,
    /// What a reader must know: why it is not judged, or what was tried where it misses.
    pub note: String,
    /// Digits that are shown.
    pub decimals: usize,
    /// `quick`, `small` or `full`.
    pub design: String,
}

/// How a row is judged.
#[derive(Debug, Clone, Copy)]
pub enum Rule {
    /// Against a range that was seen in a source.
    Range(f64, f64),
    /// Against a value, which the interval must hold.
    Value(f64),
    /// Not at all: no source was seen that states what is published.
    Unseen(Option<Published>),
}

/// What a test found.
pub struct Found {
    pub rows: Vec<Row>,
    pub charts: Vec<pluvia::report::Chart>,
}

impl Row {
    /// Judges what realisations gave.
    pub fn of(test: &str, id: &str, quantity: &str, rule: Rule, values: &[f64]) -> Self {
        let test_of_mean = MeanTest::of(values, 0.95);
        let ours = pluvia::measure::statistics::mean(values);
        let interval = test_of_mean.map(|t| {
            let mean = t.estimate.mean;
            Interval { low: mean - t.half_width, high: mean + t.half_width }
        });
        let ends = interval.map(|i| (i.low, i.high));
        let (published, verdict) = match rule {
            Rule::Range(low, high) => {
                (Some(Published::Range { low, high }), judge((low, high), ours, ends))
            }
            Rule::Value(value) => {
                let verdict = match (ours, ends) {
                    (None, _) => Verdict::NotRun,
                    (_, None) => Verdict::Undecided,
                    (_, Some((low, high))) if low <= value && value <= high => Verdict::Within,
                    _ => Verdict::Outside,
                };
                (Some(Published::Value { value }), verdict)
            }
            Rule::Unseen(published) => (published, Verdict::NotJudged),
        };
        Self {
            id: id.to_owned(),
            test: test.to_owned(),
            quantity: quantity.to_owned(),
            published,
            source: String::new(),
            ours,
            interval,
            values: values.to_vec(),
            verdict,
            note: String::new(),
            decimals: 2,
            design: String::new(),
        }
    }

    /// The same with where the published number was seen.
    pub fn seen(mut self, source: &str) -> Self {
        source.clone_into(&mut self.source);
        self
    }

    /// The same with what a reader must know.
    pub fn noted(mut self, note: impl Into<String>) -> Self {
        self.note = note.into();
        self
    }
}

/// Rows for a terminal.
pub fn table<'a>(rows: impl Iterator<Item = &'a Row>) -> String {
    let mut text = String::new();
    for row in rows {
        let digits = row.decimals;
        let published = match row.published {
            Some(Published::Range { low, high }) => format!("{low:.digits$} to {high:.digits$}"),
            Some(Published::Value { value }) => format!("{value:.digits$}"),
            None => "-".to_owned(),
        };
        let ours = row.ours.map_or("-".to_owned(), |v| format!("{v:.digits$}"));
        let interval = row
            .interval
            .map_or(String::new(), |i| format!(" ({:.digits$} to {:.digits$})", i.low, i.high));
        text += &format!(
            "{:<34} published {published:<16} ours {ours}{interval}: {:?}\n",
            row.id, row.verdict
        );
    }
    text
}
