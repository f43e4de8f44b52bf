//! A linear model of a result over several factors, and what it predicts, with its uncertainty.

use nalgebra::{DMatrix, DVector};
use serde::Serialize;
use statrs::distribution::ContinuousCDF;

use super::*;

/// y = b₀ + Σ bᵢ zᵢ by ordinary least squares, zᵢ from −1 to 1 over the range of factor i in the
/// data. Errors are taken to be normal, of one scatter, and independent of each other.
#[derive(Debug, Clone, PartialEq)]
pub struct LinearModel {
    /// Middle and half range of each factor.
    scales: Vec<(f64, f64)>,
    coefficients: DVector<f64>,
    /// (XᵀX)⁻¹.
    inverse: DMatrix<f64>,
    freedom: f64,
    quality: LinearFit,
}

/// How well a [`LinearModel`] fits.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct LinearFit {
    /// Number of values.
    pub count: usize,
    /// Standard deviation of the residuals, in units of the result.
    pub residual_standard_deviation: f64,
    /// Share of the variance that the model explains (R²).
    pub explained: f64,
    /// The same of values that the model has not seen: each predicted from all others (Allen
    /// 1974, PRESS). Negative where the mean alone predicts better.
    pub predicted: f64,
}

impl LinearModel {
    /// Fits rows of factors and results. `None` with fewer than two values more than coefficients,
    /// where factors cannot be told apart, one does not vary, or a number is not finite.
    pub fn fit(rows: &[(Vec<f64>, f64)]) -> Option<Self> {
        let factors = rows.first()?.0.len();
        let terms = factors + 1;
        let finite = |(x, y): &(Vec<f64>, f64)| {
            x.len() == factors && y.is_finite() && x.iter().all(|x| x.is_finite())
        };
        if rows.len() < terms + 2 || !rows.iter().all(finite) {
            return None;
        }
        let scale = |n: usize| {
            let values = || rows.iter().map(|(x, _)| x[n]);
            let (low, high) =
                (values().fold(f64::MAX, f64::min), values().fold(f64::MIN, f64::max));
            (high > low).then_some(((low + high) / 2.0, (high - low) / 2.0))
        };
        let scales: Vec<(f64, f64)> = (0..factors).map(scale).collect::<Option<_>>()?;
        let x = DMatrix::from_fn(rows.len(), terms, |row, term| match term {
            0 => 1.0,
            _ => scaled(rows[row].0[term - 1], scales[term - 1]),
        });
        let y = DVector::from_iterator(rows.len(), rows.iter().map(|r| r.1));
        let square = x.tr_mul(&x);
        // Factors that go together: what is left of one beside the others.
        let spread = square.clone().symmetric_eigenvalues();
        if spread.min() < 1e-9 * spread.max() {
            return None;
        }
        let inverse = square.try_inverse()?;
        let coefficients = &inverse * x.tr_mul(&y);
        let residuals = &y - &x * &coefficients;
        let freedom = (rows.len() - terms) as f64;
        let sum = residuals.norm_squared();
        let middle = mean(y.as_slice())?;
        let total: f64 = y.iter().map(|y| (y - middle).powi(2)).sum();
        let unseen: f64 = (0..rows.len())
            .map(|row| {
                let leverage = (x.row(row) * &inverse * x.row(row).transpose())[(0, 0)];
                (residuals[row] / (1.0 - leverage)).powi(2)
            })
            .sum();
        let share = |of: f64| if total > 0.0 { 1.0 - of / total } else { 0.0 };
        Some(Self {
            scales,
            coefficients,
            inverse,
            freedom,
            quality: LinearFit {
                count: rows.len(),
                residual_standard_deviation: (sum / freedom).sqrt(),
                explained: share(sum),
                predicted: share(unseen),
            },
        })
    }

    /// How well it fits.
    pub fn quality(&self) -> LinearFit {
        self.quality
    }

    /// Change of the result over the range of each factor in the data, with half of its 95 %
    /// confidence interval.
    pub fn effects(&self) -> Vec<(f64, f64)> {
        let t = t_quantile(0.975, self.freedom).unwrap_or(f64::NAN);
        let residual = self.quality.residual_standard_deviation;
        let of = |n: usize| {
            let error = residual * self.inverse[(n + 1, n + 1)].sqrt();
            (2.0 * self.coefficients[n + 1], 2.0 * t * error)
        };
        (0..self.scales.len()).map(of).collect()
    }

    /// Ends of a range at a point, as multiples of the spread of one more result about its mean
    /// there: the scatter of the residuals and the uncertainty of the model. Without any scatter
    /// they are infinite.
    pub fn in_spreads(&self, point: &[f64], low: f64, high: f64) -> [f64; 2] {
        let row = self.row(point);
        let spread = self.quality.residual_standard_deviation * (1.0 + self.leverage(&row)).sqrt();
        let middle = row.dot(&self.coefficients);
        if spread > 0.0 {
            return [(low - middle) / spread, (high - middle) / spread];
        }
        let end = |is_above: bool| if is_above { f64::INFINITY } else { f64::NEG_INFINITY };
        [end(low > middle), end(high >= middle)]
    }

    /// Probability that one more result lies between these multiples of its spread: Student's t.
    pub fn between(&self, [low, high]: [f64; 2]) -> f64 {
        let student = StudentsT::new(0.0, 1.0, self.freedom);
        let below = |x: f64| match x.is_infinite() {
            true => f64::from(u8::from(x > 0.0)),
            false => student.map_or(f64::NAN, |student| student.cdf(x)),
        };
        below(high) - below(low)
    }

    /// Degrees of freedom: values less coefficients.
    pub fn freedom(&self) -> f64 {
        self.freedom
    }

    /// Residual of a result that the model was fitted to, over its standard deviation (internally
    /// studentised: Cook & Weisberg 1982). No number where there is no scatter.
    pub fn studentised(&self, point: &[f64], result: f64) -> f64 {
        let row = self.row(point);
        let spread = self.quality.residual_standard_deviation * (1.0 - self.leverage(&row)).sqrt();
        (result - row.dot(&self.coefficients)) / spread
    }

    fn leverage(&self, row: &DVector<f64>) -> f64 {
        (&self.inverse * row).dot(row)
    }

    fn row(&self, point: &[f64]) -> DVector<f64> {
        let scaled = point.iter().zip(&self.scales).map(|(x, scale)| scaled(*x, *scale));
        DVector::from_iterator(self.coefficients.len(), std::iter::once(1.0).chain(scaled))
    }
}

fn scaled(x: f64, (middle, half): (f64, f64)) -> f64 {
    (x - middle) / half
}

#[cfg(test)]
mod tests {
    use super::super::testing::assert_near;
    use super::*;

    impl LinearModel {
        /// Mean of the result at a point.
        fn at(&self, point: &[f64]) -> f64 {
            self.row(point).dot(&self.coefficients)
        }

        /// Probability that one more result at a point lies from `low` to `high`.
        fn probability(&self, point: &[f64], low: f64, high: f64) -> f64 {
            self.between(self.in_spreads(point, low, high))
        }
    }

    /// y = 2 + 3 a − 5 b with a given error at each of nine points of a grid.
    fn grid(error: impl Fn(usize) -> f64) -> Vec<(Vec<f64>, f64)> {
        (0..9)
            .map(|n| {
                let (a, b) = ((n % 3) as f64, 10.0 * (n / 3) as f64);
                (vec![a, b], 2.0 + 3.0 * a - 5.0 * b + error(n))
            })
            .collect()
    }

    #[test]
    fn a_plane_is_found_exactly() {
        let model = LinearModel::fit(&grid(|_| 0.0)).expect("a fit");
        assert_near("value of 2 + 3 a − 5 b at (0.5, 7)", -31.5, model.at(&[0.5, 7.0]), 1e-10);
        let effects = model.effects();
        assert_near("3 over a range of 2", 6.0, effects[0].0, 1e-10);
        assert_near("−5 over a range of 20", -100.0, effects[1].0, 1e-10);
        assert_near("all is explained", 1.0, model.quality().explained, 1e-12);
        assert_near("and predicted", 1.0, model.quality().predicted, 1e-12);
    }

    /// Law: of errors e = ±1 that are orthogonal to the plane the residuals are these, and
    /// s² = Σ e² / (n − 3).
    #[test]
    fn scatter_is_that_of_the_residuals() {
        let orthogonal = [1.0, -2.0, 1.0, -2.0, 4.0, -2.0, 1.0, -2.0, 1.0];
        let model = LinearModel::fit(&grid(|n| orthogonal[n])).expect("a fit");
        let expected = (orthogonal.iter().map(|e| e * e).sum::<f64>() / 6.0).sqrt();
        let got = model.quality().residual_standard_deviation;
        assert_near("standard deviation of the residuals", expected, got, 1e-10);
        // In the middle of the grid (XᵀX)⁻¹ is 1/9: a new value has s √(1 + 1/9).
        let spread = expected * (1.0_f64 + 1.0 / 9.0).sqrt();
        let t = StudentsT::new(0.0, 1.0, 6.0).expect("a distribution").inverse_cdf(0.95);
        let middle = model.at(&[1.0, 10.0]);
        let got = model.probability(&[1.0, 10.0], middle - t * spread, middle + t * spread);
        assert_near("nine tenths within ± t₀.₉₅ s √(1 + 1/9)", 0.9, got, 1e-9);
        let far = model.probability(&[1.0, 10.0], middle + 100.0 * spread, f64::INFINITY);
        assert!(far < 1e-6, "law: next to none a hundred spreads away, got {far}");
    }

    /// Law: the variance of a residual is s² (1 − h) with Σ e² = s² (n − terms); a value of a
    /// plane without scatter is certain.
    #[test]
    fn residuals_have_their_own_spread() {
        let rows = grid(|n| (n as f64 * 1.7).sin());
        let model = LinearModel::fit(&rows).expect("a fit");
        let share = |x: &[f64]| 1.0 - model.leverage(&model.row(x));
        let sum: f64 = rows.iter().map(|(x, y)| model.studentised(x, *y).powi(2) * share(x)).sum();
        assert_near("Σ r² (1 − h) is the freedom", model.freedom(), sum, 1e-10);
        let quality = LinearFit { residual_standard_deviation: 0.0, ..model.quality() };
        let still = LinearModel { quality, ..model };
        let middle = still.at(&[1.0, 10.0]);
        let of = |low: f64, high: f64| still.probability(&[1.0, 10.0], middle + low, middle + high);
        assert_near("inside", 1.0, of(-1.0, 1.0), 0.0);
        assert_near("above", 0.0, of(1.0, 2.0), 0.0);
        assert_near("below", 0.0, of(-2.0, -1.0), 0.0);
    }

    /// Law: PRESS is the sum over fits that leave one value out.
    #[test]
    fn prediction_leaves_each_value_out_in_turn() {
        let rows = grid(|n| (n as f64 * 1.7).sin());
        let model = LinearModel::fit(&rows).expect("a fit");
        let middle = mean(&rows.iter().map(|r| r.1).collect::<Vec<_>>()).expect("a mean");
        let total: f64 = rows.iter().map(|r| (r.1 - middle).powi(2)).sum();
        let unseen: f64 = (0..rows.len())
            .map(|left| {
                let mut others = rows.clone();
                let (x, y) = others.remove(left);
                (y - LinearModel::fit(&others).expect("a fit").at(&x)).powi(2)
            })
            .sum();
        assert_near("1 − PRESS/total", 1.0 - unseen / total, model.quality().predicted, 1e-12);
    }

    #[test]
    fn what_cannot_be_told_apart_is_not_fitted() {
        let together: Vec<_> = (0..8).map(|n| (vec![n as f64, 2.0 * n as f64], 1.0)).collect();
        assert_eq!(LinearModel::fit(&together), None, "law: one factor is twice the other");
        let still: Vec<_> = (0..8).map(|n| (vec![n as f64, 3.0], 1.0)).collect();
        assert_eq!(LinearModel::fit(&still), None, "law: a factor that does not vary");
        assert_eq!(LinearModel::fit(&grid(|_| 0.0)[..4]), None, "law: four values, three unknowns");
        let mut broken = grid(|_| 0.0);
        broken[3].1 = f64::NAN;
        assert_eq!(LinearModel::fit(&broken), None, "law: a number that is none");
        assert_eq!(LinearModel::fit(&[]), None, "law: nothing");
    }
}
