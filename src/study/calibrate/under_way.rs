//! A search under way: what is asked, what was run for it, and how far off that is.

use super::*;

#[derive(Debug, Clone)]
pub(super) struct Question {
    /// The result that is wanted.
    pub wanted: f64,
    /// Between which values of the unknown.
    pub between: (f64, f64),
    /// Runs at least a value.
    pub realisations: u32,
    /// How well the result is to be known: half of the interval, in the
    /// result's unit. `None` for the scatter of a single run.
    pub tolerance: Option<f64>,
    /// Most runs altogether.
    pub most_runs: usize,
    /// Whether the unknown takes whole numbers only.
    pub whole: bool,
    /// A value to try in any case.
    pub also: Option<f64>,
}

impl Question {
    pub(super) fn width(&self) -> f64 {
        self.between.1 - self.between.0
    }

    /// A value with no more digits than the range can use: one part in ten
    /// thousand of it, or whole; the ends are as given.
    pub(super) fn rounded(&self, value: f64) -> f64 {
        let (low, high) = self.between;
        let power = if self.whole { 0 } else { self.width().log10().floor() as i32 - 4 };
        let rounded = if power < 0 {
            let decimals = power.unsigned_abs() as usize;
            format!("{value:.decimals$}").parse().unwrap_or(value)
        } else {
            let step = 10f64.powi(power);
            (value / step).round() * step
        };
        if rounded <= low {
            low
        } else if rounded >= high {
            high
        } else {
            rounded
        }
    }
}

/// Runs values in a range of configurations, counted from 0.
pub(super) type Experiment<'a> =
    &'a mut dyn FnMut(&[f64], Range<u32>) -> Result<Vec<CalibrationRun>, StudyError>;

/// Why a search goes no further.
pub(super) enum Halt {
    RunsUsedUp,
    Error(StudyError),
}

pub(super) type Going<T> = Result<T, Halt>;

pub(super) struct Search<'a> {
    pub(super) question: &'a Question,
    pub(super) experiment: Experiment<'a>,
    pub(super) kept: Kept,
    /// Values of the line.
    pub(super) window: Vec<f64>,
    /// Whether the window was found fit for a line.
    pub(super) settled: bool,
    pub(super) notes: Vec<String>,
}

impl Search<'_> {
    /// Runs what is missing of values up to a number of configurations.
    pub(super) fn evaluate(&mut self, values: &[f64], configurations: u32) -> Going<()> {
        let values = each_once(values.iter().copied());
        let tried = values.into_iter().map(|value| (self.kept.tried(value), value));
        let missing = grouped(tried.filter(|(from, _)| *from < configurations));
        let runs: usize =
            missing.iter().map(|(from, v)| (configurations - from) as usize * v.len()).sum();
        if runs > self.left() {
            return Err(Halt::RunsUsedUp);
        }
        for (from, values) in missing {
            let runs = (self.experiment)(&values, from..configurations).map_err(Halt::Error)?;
            self.kept.runs.extend(runs);
        }
        Ok(())
    }

    pub(super) fn left(&self) -> usize {
        self.question.most_runs.saturating_sub(self.kept.runs.len())
    }

    /// Mean result less the wanted one.
    pub(super) fn off(&self, value: f64) -> Option<f64> {
        self.kept.mean(value).map(|mean| mean - self.question.wanted)
    }

    /// Scatter of a single run, over all usable values.
    pub(super) fn scatter(&self, values: &[f64]) -> f64 {
        self.kept.scatter(values).map_or(0.0, |s| s.deviation)
    }
}
