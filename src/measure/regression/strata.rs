//! The two strata of a linear model: specimens, and the runs within them.

use std::collections::BTreeMap;

use nalgebra::{DMatrix, DVector};

use super::plane::Plane;
use crate::measure::statistics::mean;

/// A run: its specimen, its factors in halves of their ranges, and its result.
#[derive(Debug, Clone)]
pub(super) struct Run {
    pub specimen: usize,
    pub factors: Vec<f64>,
    pub result: f64,
}

/// The runs of a specimen: how many, and their means.
#[derive(Debug, Clone, PartialEq)]
struct Specimen {
    runs: usize,
    factors: Vec<f64>,
    result: f64,
}

/// Coefficients, each of the stratum in which its factor varies.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Strata {
    pub is_within: Vec<bool>,
    specimens: BTreeMap<usize, Specimen>,
    /// A constant, and the factors that do not vary within specimens, over means of specimens.
    pub between: Plane,
    /// The other factors, over differences from these means; none of a run a specimen.
    pub within: Option<Plane>,
    /// Values of the other factors at which the means of specimens are compared.
    middle: DVector<f64>,
    /// What a coefficient of the other factors adds to those between specimens, by taking their
    /// means to the middle: zero where every specimen has the same runs.
    carried: DMatrix<f64>,
    /// Mean over specimens of 1 / runs.
    share: f64,
}

/// A variance of two parts, each with its degrees of freedom.
#[derive(Debug, Clone, Copy)]
pub(super) struct Variance {
    between: (f64, f64),
    within: (f64, f64),
}

impl Variance {
    pub fn sum(self) -> f64 {
        self.between.0 + self.within.0
    }

    /// Degrees of freedom of the sum (Satterthwaite 1946).
    pub fn freedom(self) -> f64 {
        let part = |(variance, freedom): (f64, f64)| {
            if variance > 0.0 { (variance / self.sum()).powi(2) / freedom } else { 0.0 }
        };
        let parts = part(self.between) + part(self.within);
        if parts > 0.0 { 1.0 / parts } else { self.between.1 }
    }
}

/// Which factors differ between runs of any specimen.
pub(super) fn varies_within(runs: &[Run]) -> Vec<bool> {
    let mut first: BTreeMap<usize, &Run> = BTreeMap::new();
    let mut is_within = vec![false; runs.first().map_or(0, |run| run.factors.len())];
    for run in runs {
        let known = *first.entry(run.specimen).or_insert(run);
        for (n, is) in is_within.iter_mut().enumerate() {
            *is |= run.factors[n] != known.factors[n];
        }
    }
    is_within
}

impl Strata {
    /// Fits runs, whatever freedom is left. `None` where coefficients cannot be told apart.
    pub fn fit(runs: &[Run], is_within: Vec<bool>) -> Option<Self> {
        let mut groups: BTreeMap<usize, Vec<&Run>> = BTreeMap::new();
        for run in runs {
            groups.entry(run.specimen).or_default().push(run);
        }
        let specimen = |runs: &Vec<&Run>| {
            let results: Vec<f64> = runs.iter().map(|run| run.result).collect();
            let factor =
                |n: usize| mean(&runs.iter().map(|run| run.factors[n]).collect::<Vec<_>>());
            Some(Specimen {
                runs: runs.len(),
                factors: (0..is_within.len()).map(factor).collect::<Option<_>>()?,
                result: mean(&results)?,
            })
        };
        let specimens: BTreeMap<usize, Specimen> =
            groups.iter().map(|(id, runs)| Some((*id, specimen(runs)?))).collect::<Option<_>>()?;
        let places = |of: bool| -> Vec<usize> {
            (0..is_within.len()).filter(|n| is_within[*n] == of).collect()
        };
        let (outer, inner) = (places(false), places(true));
        let within = if runs.len() > specimens.len() {
            let off = |run: &Run, n: usize| run.factors[n] - specimens[&run.specimen].factors[n];
            let x = DMatrix::from_fn(runs.len(), inner.len(), |row, n| off(&runs[row], inner[n]));
            let y = runs.iter().map(|run| run.result - specimens[&run.specimen].result);
            let y = DVector::from_iterator(runs.len(), y);
            Some(Plane::fit(&x, &y, specimens.len())?)
        } else {
            None
        };
        if within.is_none() && !inner.is_empty() {
            return None;
        }
        let means: Vec<&Specimen> = specimens.values().collect();
        let count = means.len() as f64;
        let middle = DVector::from_fn(inner.len(), |n, _| {
            means.iter().map(|of| of.factors[inner[n]]).sum::<f64>() / count
        });
        let off = DMatrix::from_fn(means.len(), inner.len(), |row, n| {
            means[row].factors[inner[n]] - middle[n]
        });
        let x = DMatrix::from_fn(means.len(), outer.len() + 1, |row, n| match n {
            0 => 1.0,
            _ => means[row].factors[outer[n - 1]],
        });
        let mut y = DVector::from_iterator(means.len(), means.iter().map(|of| of.result));
        if let Some(within) = within.as_ref().filter(|_| !inner.is_empty()) {
            y -= &off * &within.coefficients;
        }
        let between = Plane::fit(&x, &y, 0)?;
        let carried = match inner.is_empty() {
            true => DMatrix::zeros(0, outer.len() + 1),
            false => off.tr_mul(&x) * &between.inverse,
        };
        let share = means.iter().map(|of| 1.0 / of.runs as f64).sum::<f64>() / count;
        Some(Self { is_within, specimens, between, within, middle, carried, share })
    }

    /// Mean of the result.
    pub fn at(&self, factors: &[f64]) -> f64 {
        let within = self.within.as_ref().map_or(0.0, |of| of.at(&self.inner(factors)));
        self.between.at(&self.outer(factors)) + within
    }

    /// Variance of a coefficient, of a factor by its place.
    pub fn of_coefficient(&self, factor: usize) -> Variance {
        let place = (0..factor).filter(|n| self.is_within[*n] == self.is_within[factor]).count();
        if self.is_within[factor] {
            let share = self.within.as_ref().map_or(f64::NAN, |of| of.inverse[(place, place)]);
            return self.variance(0.0, share);
        }
        let row = DVector::from_fn(self.carried.nrows(), |n, _| self.carried[(n, place + 1)]);
        let carried = self.within.as_ref().map_or(0.0, |of| of.leverage(&row));
        self.variance(self.between.inverse[(place + 1, place + 1)], carried)
    }

    /// A coefficient, of a factor by its place.
    pub fn coefficient(&self, factor: usize) -> f64 {
        let place = (0..factor).filter(|n| self.is_within[*n] == self.is_within[factor]).count();
        match (&self.within, self.is_within[factor]) {
            (Some(within), true) => within.coefficients[place],
            _ => self.between.coefficients[place + 1],
        }
    }

    /// Variance of a run of another specimen about the model, were that known exactly: of the
    /// specimen's mean, and what a run scatters more than that.
    pub fn of_run(&self) -> Variance {
        self.variance(1.0, 1.0 - self.share)
    }

    /// The same, with what is not known of the model there.
    pub fn of_next(&self, factors: &[f64]) -> Variance {
        let outer = self.outer(factors);
        let carried = match self.carried.is_empty() {
            true => 0.0,
            false => {
                let row = self.inner(factors) - &self.carried * &outer;
                self.within.as_ref().map_or(0.0, |of| of.leverage(&row))
            }
        };
        self.variance(1.0 + self.between.leverage(&outer), 1.0 - self.share + carried)
    }

    /// Variance of the residual of a run that was fitted.
    pub fn of_residual(&self, specimen: usize, factors: &[f64]) -> Variance {
        let between = 1.0 - self.leverage(factors);
        let Some((within, own)) = self.within.as_ref().zip(self.specimens.get(&specimen)) else {
            return self.variance(between, 0.0);
        };
        let off = self.inner(factors) - self.inner(&own.factors);
        self.variance(between, 1.0 - 1.0 / own.runs as f64 - within.leverage(&off))
    }

    /// Share of the mean of a specimen in what the model gives for it.
    pub fn leverage(&self, factors: &[f64]) -> f64 {
        self.between.leverage(&self.outer(factors))
    }

    /// These multiples of the variances of both strata.
    fn variance(&self, between: f64, within: f64) -> Variance {
        let of = |share: f64, plane: &Plane| (share * plane.variance, plane.freedom);
        Variance {
            between: of(between, &self.between),
            within: self.within.as_ref().map_or((0.0, 0.0), |plane| of(within, plane)),
        }
    }

    /// A constant, and the factors that do not vary within specimens.
    fn outer(&self, factors: &[f64]) -> DVector<f64> {
        let own = factors.iter().zip(&self.is_within).filter(|(_, is)| !**is).map(|(x, _)| *x);
        let row: Vec<f64> = std::iter::once(1.0).chain(own).collect();
        DVector::from_vec(row)
    }

    /// The other factors, from the middle.
    fn inner(&self, factors: &[f64]) -> DVector<f64> {
        let own = factors.iter().zip(&self.is_within).filter(|(_, is)| **is).map(|(x, _)| *x);
        let row: Vec<f64> = own.zip(self.middle.iter()).map(|(x, middle)| x - middle).collect();
        DVector::from_vec(row)
    }
}
