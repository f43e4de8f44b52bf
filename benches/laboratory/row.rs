//! A row of the table: a published number, where it was seen, and ours beside it.

use pluvia::{measure::inference::MeanTest, study::STAGE_FORMAT};
use serde::{Deserialize, Serialize};

use super::{
    references::{self, Published, Stated},
    standard_tests::{Verdict, judge},
};

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
    /// `FORMAT` of stages of the build that ran it; `None` of builds that did not write it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub format: Option<u32>,
}

/// What a test found.
pub struct Found {
    pub rows: Vec<Row>,
    pub charts: Vec<pluvia::report::Chart>,
}

impl Row {
    /// What realisations gave, judged by the reference of the row.
    pub fn of(test: &str, id: &str, quantity: &str, values: &[f64]) -> Self {
        let mut row = Self {
            id: id.to_owned(),
            test: test.to_owned(),
            quantity: quantity.to_owned(),
            published: None,
            source: String::new(),
            ours: None,
            interval: None,
            values: values.to_vec(),
            verdict: Verdict::NotRun,
            note: String::new(),
            decimals: 2,
            design: String::new(),
            format: Some(STAGE_FORMAT),
        };
        row.judge();
        row
    }

    /// The same beside what a law says of something else that was measured, and judged by it.
    pub fn beside(mut self, published: Published) -> Self {
        self.published = Some(published);
        self.judge();
        self
    }

    /// Judges the values by the reference of the row, whose published number it takes.
    pub fn judge(&mut self) {
        let reference = references::of(&self.id);
        match reference.stated {
            Stated::Nothing => self.published = None,
            Stated::Known(published) => self.published = Some(published),
            Stated::OfTheRow => {}
        }
        self.ours = pluvia::measure::statistics::mean(&self.values);
        self.interval = MeanTest::of(&self.values, 0.95).map(|t| {
            let mean = t.estimate.mean;
            Interval { low: mean - t.half_width, high: mean + t.half_width }
        });
        let ends = self.interval.map(|i| (i.low, i.high));
        self.verdict = match self.published {
            _ if !self.ours.is_some_and(f64::is_finite) => Verdict::NotRun,
            Some(Published::Range { low, high }) if reference.is_judged => {
                judge((low, high), self.ours, ends)
            }
            _ => Verdict::NotJudged,
        };
        self.source = reference.source;
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
            "{:<34} published {published:<16} ours {ours}{interval}: {}\n",
            row.id, row.verdict
        );
    }
    text
}
