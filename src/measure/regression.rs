//! A linear model of a result over several factors, and what it predicts, with its uncertainty.
//!
//! Runs may share specimens: a pour that is shaken with and without a ramp. Such runs differ less
//! than those of two specimens. Factors that vary within specimens are judged by the scatter of
//! differences within these, all others by that of the means of specimens: the two strata of a
//! split-plot design (Yates 1935; Montgomery 2017, chapter 14).

mod plane;
mod strata;

use std::collections::{BTreeMap, BTreeSet};

use serde::Serialize;
use statrs::distribution::ContinuousCDF;

use super::*;
use strata::{Run, Strata, Variance};

/// y = b₀ + Σ bᵢ zᵢ by least squares, zᵢ from −1 to 1 over the range of factor i in the data.
/// Errors are taken to be normal: one of the specimen, of one scatter, and one of the run, of
/// another. With a run a specimen this is the ordinary regression.
#[derive(Debug, Clone, PartialEq)]
pub struct LinearModel {
    /// Range of each factor.
    ranges: Vec<[f64; 2]>,
    /// Its middle, and half of it.
    scales: Vec<(f64, f64)>,
    strata: Strata,
    quality: LinearFit,
}

/// How well a [`LinearModel`] fits.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct LinearFit {
    /// Number of values.
    pub count: usize,
    /// Standard deviation of a run about the model, in units of the result: that of its specimen
    /// and its own.
    pub residual_standard_deviation: f64,
    /// Share of the variance that the model explains (R²).
    pub explained: f64,
    /// The same of values that the model has not seen: those of each specimen predicted from all
    /// other specimens (Allen 1974, PRESS). Negative where the mean alone predicts better; no
    /// number where the others do not tell all factors apart.
    pub predicted: f64,
}

/// What a factor moves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Effect {
    /// Change of the result over the range of the factor in the data.
    pub change: f64,
    /// That range.
    pub range: [f64; 2],
    /// Half of its 95 % confidence interval.
    pub half_width_95: f64,
    /// Degrees of freedom of that interval.
    pub freedom: f64,
    /// Whether it is of differences within specimens.
    pub is_within_specimens: bool,
}

/// Which factors differ between runs of any specimen; a specimen a row.
pub fn vary_within(rows: &[(Vec<f64>, f64)], specimens: &[usize]) -> Vec<bool> {
    strata::varies_within(&runs(rows, specimens, &[]))
}

/// Rows as runs, factors scaled where there are scales.
fn runs(rows: &[(Vec<f64>, f64)], specimens: &[usize], scales: &[(f64, f64)]) -> Vec<Run> {
    let run = |((x, y), specimen): (&(Vec<f64>, f64), &usize)| Run {
        specimen: *specimen,
        factors: if scales.is_empty() { x.clone() } else { scaled(x, scales) },
        result: *y,
    };
    rows.iter().zip(specimens).map(run).collect()
}

impl LinearModel {
    /// Fits rows of factors and results, each of a specimen by its number. Where all are of one,
    /// the model is of that one, and each run stands for itself. Where differences within specimens
    /// are too few, it is of the means of specimens.
    ///
    /// `None` with fewer than two values more than coefficients (of shared specimens: one in each
    /// stratum), where factors cannot be told apart, one does not vary, or a number is not finite.
    pub fn fit(rows: &[(Vec<f64>, f64)], specimens: &[usize]) -> Option<Self> {
        let factors = rows.first()?.0.len();
        let finite = |(x, y): &(Vec<f64>, f64)| {
            x.len() == factors && y.is_finite() && x.iter().all(|x| x.is_finite())
        };
        if specimens.len() != rows.len() || !rows.iter().all(finite) {
            return None;
        }
        let mut of: BTreeMap<usize, Vec<&(Vec<f64>, f64)>> = BTreeMap::new();
        for (row, specimen) in rows.iter().zip(specimens) {
            of.entry(*specimen).or_default().push(row);
        }
        if of.len() == 1 || of.len() == rows.len() {
            let each: Vec<usize> = (0..rows.len()).collect();
            return Self::of_strata(rows, &each);
        }
        Self::of_strata(rows, specimens).or_else(|| {
            let middle = |rows: &Vec<&(Vec<f64>, f64)>| {
                let count = rows.len() as f64;
                let mean = |n: usize| rows.iter().map(|row| row.0[n]).sum::<f64>() / count;
                let y = rows.iter().map(|row| row.1).sum::<f64>() / count;
                ((0..factors).map(mean).collect(), y)
            };
            let means: Vec<(Vec<f64>, f64)> = of.values().map(middle).collect();
            let each: Vec<usize> = (0..means.len()).collect();
            Self::of_strata(&means, &each)
        })
    }

    fn of_strata(rows: &[(Vec<f64>, f64)], specimens: &[usize]) -> Option<Self> {
        let factors = rows.first()?.0.len();
        let range = |n: usize| {
            let values = || rows.iter().map(|(x, _)| x[n]);
            let (low, high) =
                (values().fold(f64::MAX, f64::min), values().fold(f64::MIN, f64::max));
            (high > low).then_some([low, high])
        };
        let ranges: Vec<[f64; 2]> = (0..factors).map(range).collect::<Option<_>>()?;
        let scales: Vec<(f64, f64)> =
            ranges.iter().map(|[low, high]| ((low + high) / 2.0, (high - low) / 2.0)).collect();
        let runs = runs(rows, specimens, &scales);
        let strata = Strata::fit(&runs, strata::varies_within(&runs))?;
        let least = if strata.within.is_some() { 1.0 } else { 2.0 };
        let has_none = |of: &plane::Plane| of.freedom < 1.0;
        if strata.between.freedom < least || strata.within.as_ref().is_some_and(has_none) {
            return None;
        }
        let squares = |of: &dyn Fn(&Run) -> f64| {
            runs.iter().map(|run| (run.result - of(run)).powi(2)).sum::<f64>()
        };
        let middle = mean(&runs.iter().map(|run| run.result).collect::<Vec<_>>())?;
        let total = squares(&|_| middle);
        let share = |of: f64| if total > 0.0 { 1.0 - of / total } else { 0.0 };
        let quality = LinearFit {
            count: rows.len(),
            residual_standard_deviation: strata.of_run().sum().sqrt(),
            explained: share(squares(&|run| strata.at(&run.factors))),
            predicted: unseen(&strata, &runs).map_or(f64::NAN, share),
        };
        Some(Self { ranges, scales, strata, quality })
    }

    /// How well it fits.
    pub fn quality(&self) -> LinearFit {
        self.quality
    }

    /// What each factor moves.
    pub fn effects(&self) -> Vec<Effect> {
        let of = |(n, range): (usize, &[f64; 2])| {
            let variance = self.strata.of_coefficient(n);
            let freedom = variance.freedom();
            let t = t_quantile(0.975, freedom).unwrap_or(f64::NAN);
            Effect {
                change: 2.0 * self.strata.coefficient(n),
                range: *range,
                half_width_95: 2.0 * t * variance.sum().sqrt(),
                freedom,
                is_within_specimens: self.strata.is_within[n],
            }
        };
        self.ranges.iter().enumerate().map(of).collect()
    }

    /// Probabilities that one more result, of a run of one more specimen, is below the ends of a
    /// range at a point: Student's t with the scatter of both strata and the uncertainty of the
    /// model. Without any scatter they are 0 or 1.
    pub fn below(&self, point: &[f64], [low, high]: [f64; 2]) -> [f64; 2] {
        let factors = scaled(point, &self.scales);
        let middle = self.strata.at(&factors);
        let variance = self.strata.of_next(&factors);
        let spread = variance.sum().sqrt();
        if spread > 0.0 {
            let student = StudentsT::new(0.0, 1.0, variance.freedom());
            return [low, high].map(|end| match (end - middle) / spread {
                x if x.is_infinite() => f64::from(u8::from(x > 0.0)),
                x => student.as_ref().map_or(f64::NAN, |student| student.cdf(x)),
            });
        }
        [low > middle, high >= middle].map(|is_above| f64::from(u8::from(is_above)))
    }

    /// Probability that one more result at a point lies in a range.
    pub fn between(&self, point: &[f64], ends: [f64; 2]) -> f64 {
        let [low, high] = self.below(point, ends);
        high - low
    }

    /// Residual of a result that the model was fitted to, over its standard deviation (internally
    /// studentised: Cook & Weisberg 1982). No number where there is no scatter.
    pub fn studentised(&self, specimen: usize, point: &[f64], result: f64) -> f64 {
        let factors = scaled(point, &self.scales);
        let variance: Variance = self.strata.of_residual(specimen, &factors);
        (result - self.strata.at(&factors)) / variance.sum().sqrt()
    }
}

/// Sum of squares of results about what all other specimens predict; `None` where these do not
/// tell all factors apart.
fn unseen(strata: &Strata, runs: &[Run]) -> Option<f64> {
    if strata.within.is_none() {
        // A run a specimen: the share of its own value is its leverage.
        let off = |run: &Run| {
            let free = 1.0 - strata.leverage(&run.factors);
            (free > 1e-9).then(|| ((run.result - strata.at(&run.factors)) / free).powi(2))
        };
        return runs.iter().map(off).sum();
    }
    let specimens: BTreeSet<usize> = runs.iter().map(|run| run.specimen).collect();
    let mut sum = 0.0;
    for left in specimens {
        let is_left = |run: &&Run| run.specimen == left;
        let others: Vec<Run> = runs.iter().filter(|run| !is_left(run)).cloned().collect();
        let model = Strata::fit(&others, strata.is_within.clone())?;
        let off = |run: &Run| (run.result - model.at(&run.factors)).powi(2);
        sum += runs.iter().filter(is_left).map(off).sum::<f64>();
    }
    Some(sum)
}

fn scaled(x: &[f64], scales: &[(f64, f64)]) -> Vec<f64> {
    x.iter().zip(scales).map(|(x, (middle, half))| (x - middle) / half).collect()
}

#[cfg(test)]
mod tests;
