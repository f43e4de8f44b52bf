//! Least squares in one stratum: of specimens, or of the runs within them.

use nalgebra::{DMatrix, DVector};

/// y = X b + e by ordinary least squares; e of one scatter and independent.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Plane {
    pub coefficients: DVector<f64>,
    /// (XᵀX)⁻¹.
    pub inverse: DMatrix<f64>,
    /// Degrees of freedom of the residuals.
    pub freedom: f64,
    /// Variance of the residuals, in squared units of y; no number without freedom.
    pub variance: f64,
}

impl Plane {
    /// Fits a row of X a value. `spent`: degrees of freedom that other coefficients took from y.
    /// `None` where columns of X go together.
    pub fn fit(x: &DMatrix<f64>, y: &DVector<f64>, spent: usize) -> Option<Self> {
        let terms = x.ncols();
        let freedom = y.len() as f64 - (terms + spent) as f64;
        if terms == 0 {
            return Some(Self {
                coefficients: DVector::zeros(0),
                inverse: DMatrix::zeros(0, 0),
                freedom,
                variance: y.norm_squared() / freedom,
            });
        }
        let square = x.tr_mul(x);
        // Factors that go together: what is left of one beside the others.
        let spread = square.clone().symmetric_eigenvalues();
        if !(spread.min() >= 1e-9 * spread.max() && spread.max() > 0.0) {
            return None;
        }
        let inverse = square.try_inverse()?;
        let coefficients = &inverse * x.tr_mul(y);
        let residuals = y - x * &coefficients;
        let variance = residuals.norm_squared() / freedom;
        Some(Self { coefficients, inverse, freedom, variance })
    }

    /// Value at a row of X.
    pub fn at(&self, row: &DVector<f64>) -> f64 {
        if row.is_empty() { 0.0 } else { row.dot(&self.coefficients) }
    }

    /// Variance of the value at a row, over that of the residuals.
    pub fn leverage(&self, row: &DVector<f64>) -> f64 {
        if row.is_empty() { 0.0 } else { (&self.inverse * row).dot(row) }
    }
}
