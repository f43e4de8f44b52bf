//! What was evaluated so far, and what it says of scatter and direction.

use super::*;
use crate::measure::{bend_pattern, inference::two_sided_p, inverse_prediction, statistics::mean};

/// Confidence of every interval and test.
pub(super) const CONFIDENCE: f64 = 0.95;

/// Every run, in the order in which it came.
#[derive(Debug, Clone, Default)]
pub(super) struct Kept {
    pub runs: Vec<CalibrationRun>,
}

/// How far results scatter where nothing but chance moves them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Scatter {
    /// Standard deviation.
    pub deviation: f64,
    /// Degrees of freedom.
    pub freedom: f64,
}

impl Kept {
    /// Every value tried, in rising order.
    pub fn values(&self) -> Vec<f64> {
        let mut values: Vec<f64> = self.runs.iter().map(|r| r.value).collect();
        values.sort_by(f64::total_cmp);
        values.dedup();
        values
    }

    /// Configurations tried of a value.
    pub fn tried(&self, value: f64) -> u32 {
        let of = self.runs.iter().filter(|r| r.value == value);
        of.map(|r| r.configuration).max().unwrap_or(0)
    }

    /// Results of a value that count, by configuration: everything that follows rests on these.
    pub fn at(&self, value: f64) -> Vec<(u32, f64)> {
        let of = self.runs.iter().filter(|r| r.value == value);
        let mut found: Vec<(u32, f64)> =
            of.filter_map(|r| Some((r.configuration, r.counted()?))).collect();
        found.sort_by_key(|(configuration, _)| *configuration);
        found
    }

    /// Results of a value.
    pub fn results(&self, value: f64) -> Vec<f64> {
        self.at(value).into_iter().map(|(_, result)| result).collect()
    }

    /// Mean result of a value.
    pub fn mean(&self, value: f64) -> Option<f64> {
        mean(&self.results(value))
    }

    /// Values of which at least two runs, and no less than half, have results that count:
    /// what is known of the others is too little to build on.
    pub fn usable(&self) -> Vec<f64> {
        let usable = |value: &f64| {
            let (results, tried) = (self.results(*value).len(), self.tried(*value) as usize);
            results >= 2 && 2 * results >= tried
        };
        self.values().into_iter().filter(usable).collect()
    }

    /// Scatter of a single run about the mean of its value, over the given values.
    pub fn scatter(&self, values: &[f64]) -> Option<Scatter> {
        let (mut squares, mut freedom) = (0.0, 0.0);
        for value in values {
            let results = self.results(*value);
            let Some(mean) = mean(&results) else { continue };
            squares += results.iter().map(|r| (r - mean).powi(2)).sum::<f64>();
            freedom += results.len() as f64 - 1.0;
        }
        (freedom > 0.0).then(|| Scatter { deviation: (squares / freedom).sqrt(), freedom })
    }

    /// The configurations that have a result at each of the given values, and
    /// their results: one block a configuration.
    pub fn blocks(&self, values: &[f64]) -> Vec<Vec<f64>> {
        let by_value: Vec<Vec<(u32, f64)>> = values.iter().map(|v| self.at(*v)).collect();
        let Some(first) = by_value.first() else { return Vec::new() };
        let block = |configuration: u32| {
            by_value
                .iter()
                .map(|at| at.iter().find(|(c, _)| *c == configuration).map(|(_, r)| *r))
                .collect::<Option<Vec<f64>>>()
        };
        first.iter().filter_map(|(configuration, _)| block(*configuration)).collect()
    }

    /// The line through the results of some values.
    pub fn fit(&self, values: &[f64], wanted: f64) -> Option<InversePrediction> {
        inverse_prediction(values, &self.blocks(values), wanted, CONFIDENCE)
    }

    /// Scatter of a single run once the means of its value and of its
    /// configuration are taken off: what is left of a two-way table without
    /// interaction. Differences of two values are known by this.
    fn paired_scatter(&self, values: &[f64]) -> Option<(Scatter, usize)> {
        let blocks = self.blocks(values);
        let (rows, columns) = (blocks.len(), values.len());
        if rows < 2 || columns < 2 {
            return None;
        }
        let grand = mean(&blocks.concat())?;
        let by_block: Vec<f64> = blocks.iter().filter_map(|b| mean(b)).collect();
        let by_value = column_means(&blocks);
        let rest = blocks.iter().zip(&by_block).flat_map(|(block, of_block)| {
            block.iter().zip(&by_value).map(move |(r, of_value)| r - of_block - of_value + grand)
        });
        let squares: f64 = rest.map(|r| r * r).sum();
        let freedom = ((rows - 1) * (columns - 1)) as f64;
        Some((Scatter { deviation: (squares / freedom).sqrt(), freedom }, rows))
    }

    /// Half the second derivative of the means over some values, and the
    /// p-value of there being none, by Student's t with the scatter of the
    /// two-way table. `None` of fewer than three values.
    pub fn bend(&self, values: &[f64]) -> Option<(f64, f64)> {
        let (scatter, blocks) = self.paired_scatter(values)?;
        let means = column_means(&self.blocks(values));
        let pattern = bend_pattern(values)?;
        let square: f64 = pattern.iter().map(|p| p * p).sum();
        let bend = pattern.iter().zip(&means).map(|(p, m)| p * m).sum::<f64>() / square;
        let error = scatter.deviation / (blocks as f64 * square).sqrt();
        Some((bend, two_sided_p(bend / error, scatter.freedom)?))
    }

    /// Which pairs of values differ beyond scatter: lower value, higher value,
    /// and whether results rise from one to the other. All pairs are tested at
    /// a level that holds for them together (Bonferroni's inequality).
    pub fn differences(&self) -> Vec<(f64, f64, bool)> {
        let values = self.usable();
        let Some((scatter, blocks)) = self.paired_scatter(&values) else { return Vec::new() };
        let pairs = (values.len() * (values.len() - 1) / 2) as f64;
        let level = (1.0 - CONFIDENCE) / pairs;
        let Some(t) = t_quantile(1.0 - level / 2.0, scatter.freedom) else { return Vec::new() };
        let least = t * scatter.deviation * (2.0 / blocks as f64).sqrt();
        let means = column_means(&self.blocks(&values));
        let mut found = Vec::new();
        for low in 0..values.len() {
            for high in low + 1..values.len() {
                let rise = means[high] - means[low];
                if rise.abs() > least {
                    found.push((values[low], values[high], rise > 0.0));
                }
            }
        }
        found
    }

    /// Pairs of values that differ one way and the other: a rise and a fall,
    /// neither of which is scatter. `None` where all go one way.
    pub fn turn(&self) -> Option<((f64, f64), (f64, f64))> {
        let differences = self.differences();
        // The closest pairs tell best where it turns.
        let closest = |rising: bool| {
            differences
                .iter()
                .filter(|d| d.2 == rising)
                .min_by(|a, b| (a.1 - a.0).total_cmp(&(b.1 - b.0)))
                .map(|d| (d.0, d.1))
        };
        closest(true).zip(closest(false))
    }

    /// The table of values.
    pub fn table(&self, in_fit: &[f64]) -> Vec<CalibrationValue> {
        let row = |value: f64| {
            let results = self.results(value);
            let of: Vec<&CalibrationRun> = self.runs.iter().filter(|r| r.value == value).collect();
            let test = MeanTest::of(&results, CONFIDENCE);
            CalibrationValue {
                value,
                runs: of.len(),
                failed: of.iter().filter(|r| r.result.is_none()).count(),
                left_out: of.iter().filter(|r| r.is_left_out()).count(),
                mean: mean(&results),
                standard_deviation: test.map(|t| t.standard_deviation),
                half_width_95: test.map(|t| t.half_width),
                in_fit: in_fit.contains(&value),
            }
        };
        self.values().into_iter().map(row).collect()
    }
}

/// The mean of every column of rows of the same length.
fn column_means(rows: &[Vec<f64>]) -> Vec<f64> {
    let columns = rows.first().map_or(0, Vec::len);
    let column = |i: usize| rows.iter().map(|row| row[i]).collect::<Vec<f64>>();
    (0..columns).filter_map(|i| mean(&column(i))).collect()
}
