//! A mean and how far it can be trusted: standard errors, and differences of runs that go in pairs.
//!
//! The unit of a result is that of the values.

use serde::{Deserialize, Serialize};

use super::*;

/// The mean of repeated runs with its standard error.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Estimate {
    /// Arithmetic mean.
    pub mean: f64,
    /// Sample standard deviation over the root of the number of values; `None`
    /// of a single value, which tells nothing of scatter.
    pub standard_error: Option<f64>,
    /// Number of values.
    pub count: usize,
}

impl Estimate {
    /// Of values; `None` of no values.
    pub fn of(values: &[f64]) -> Option<Self> {
        let mean = mean(values)?;
        let standard_error =
            sample_standard_deviation(values).map(|s| s / (values.len() as f64).sqrt());
        Some(Self { mean, standard_error, count: values.len() })
    }

    /// Half of the confidence interval of a confidence such as 0.95: Student's t for one degree of
    /// freedom less than there are values, times the standard error. `None` of a single value.
    pub fn half_width(&self, confidence: f64) -> Option<f64> {
        let freedom = self.count.checked_sub(1).filter(|f| *f > 0)? as f64;
        Some(t_quantile(0.5 + confidence / 2.0, freedom)? * self.standard_error?)
    }

    /// Half of the 95 % confidence interval. `None` of a single value.
    pub fn half_width_95(&self) -> Option<f64> {
        self.half_width(0.95)
    }

    /// Whether the mean cannot be told from zero: its 95 % confidence interval
    /// holds it. `None` where the scatter is not known.
    pub fn inside_scatter(&self) -> Option<bool> {
        self.half_width_95().map(|half| self.mean.abs() <= half)
    }

    /// The same in another unit: values times a factor.
    pub fn scaled(&self, factor: f64) -> Self {
        Self {
            mean: self.mean * factor,
            standard_error: self.standard_error.map(|s| s * factor.abs()),
            count: self.count,
        }
    }
}

/// Mean of `a` less `b` over what both have, by the number that names a pair: what the members of a
/// pair have in common falls out of the scatter. `None` without a pair.
pub fn paired_difference(a: &[(u32, f64)], b: &[(u32, f64)]) -> Option<Estimate> {
    let differences: Vec<f64> = a
        .iter()
        .filter_map(|(key, value)| {
            b.iter().find(|(other, _)| other == key).map(|(_, reference)| value - reference)
        })
        .collect();
    Estimate::of(&differences)
}

/// Change for one unit of what was varied: the result at its high end less that
/// at its low end, by pairs, over the distance of the ends. `None` without a pair.
pub fn change_for_one_unit(
    low: &[(u32, f64)],
    high: &[(u32, f64)],
    distance: f64,
) -> Option<Estimate> {
    paired_difference(high, low).map(|difference| difference.scaled(1.0 / distance))
}

#[cfg(test)]
mod tests {
    use super::super::testing::assert_near;
    use super::*;

    #[test]
    fn standard_errors_are_of_the_mean() {
        assert_eq!(Estimate::of(&[]), None);
        let one = Estimate::of(&[3.0]).expect("a mean");
        assert_eq!((one.standard_error, one.inside_scatter()), (None, None), "no scatter of one");
        // Law: s/√n; of 1, 2, 3: s = 1, so 1/√3.
        let three = Estimate::of(&[1.0, 2.0, 3.0]).expect("a mean");
        assert_near("standard error", 1.0 / 3f64.sqrt(), three.standard_error.expect("3"), 1e-15);
        let scaled = three.scaled(-2.0);
        assert_near("scaled mean", -4.0, scaled.mean, 1e-15);
        assert_near("scaled error", 2.0 / 3f64.sqrt(), scaled.standard_error.expect("3"), 1e-15);
    }

    /// Two-sided 95 % quantiles of Student's t (Student 1908, any table):
    /// 12.706 for one degree of freedom, 4.303 for two, 2.228 for ten.
    #[test]
    fn confidence_intervals_are_students() {
        for (count, t) in [(2, 12.706), (3, 4.303), (11, 2.228)] {
            let estimate = Estimate { mean: 0.0, standard_error: Some(1.0), count };
            let got = estimate.half_width_95().expect("known");
            assert_near(&format!("t for {count} values"), t, got, 1e-3);
        }
    }

    #[test]
    fn what_lies_inside_the_scatter_is_told_and_what_does_not_is_not() {
        let of = |mean| Estimate { mean, standard_error: Some(1.0), count: 3 };
        for (mean, inside) in
            [(0.0, true), (4.29, true), (-4.29, true), (4.31, false), (-4.31, false)]
        {
            assert_eq!(of(mean).inside_scatter(), Some(inside), "mean {mean}, t 4.303");
        }
    }

    #[test]
    fn pairs_are_made_by_their_number() {
        // What the pairs have in common, 100 and 200, falls out.
        let a = [(1, 101.0), (2, 203.0), (4, 7.0)];
        let b = [(2, 200.0), (1, 100.0), (3, 9.0)];
        let got = paired_difference(&a, &b).expect("two pairs");
        assert_eq!((got.mean, got.count), (2.0, 2), "law: the mean of 1 and 3");
        assert_near("standard error", 1.0, got.standard_error.expect("two"), 1e-12);
        let other = paired_difference(&b, &a).expect("two pairs");
        assert_eq!(other.mean, -2.0, "law: the other way round, the other sign");
        assert_eq!(paired_difference(&a, &[(9, 1.0)]), None, "no pair");
    }
}
