//! Student's t distribution: its quantiles and p-values.

use statrs::distribution::ContinuousCDF;

use super::*;

/// Quantile of Student's t distribution; `None` for a probability outside 0 to 1 or no freedom.
pub fn t_quantile(probability: f64, freedom: f64) -> Option<f64> {
    if !(probability > 0.0 && probability < 1.0) {
        return None;
    }
    Some(StudentsT::new(0.0, 1.0, freedom).ok()?.inverse_cdf(probability))
}

/// Two-sided p-value of a value of Student's t: 0 where it is infinite, `None`
/// where it is not a number or there is no freedom.
pub fn two_sided_p(t: f64, freedom: f64) -> Option<f64> {
    match t {
        t if t.is_nan() => None,
        t if t.is_infinite() => Some(0.0),
        t => Some(2.0 * StudentsT::new(0.0, 1.0, freedom).ok()?.sf(t.abs())),
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::assert_near;
    use super::*;

    /// Quantiles as every table of Student's t prints them.
    #[test]
    fn quantiles_are_those_of_the_tables() {
        for (probability, freedom, expected) in [
            (0.975, 1.0, 12.706_2),
            (0.975, 2.0, 4.302_65),
            (0.975, 10.0, 2.228_14),
            (0.95, 5.0, 2.015_05),
            (0.995, 30.0, 2.750_00),
            (0.025, 2.0, -4.302_65),
            (0.5, 7.0, 0.0),
        ] {
            let got = t_quantile(probability, freedom).expect("a quantile");
            assert_near(&format!("t of {probability} with {freedom}"), expected, got, 1e-4);
        }
        assert_eq!(t_quantile(0.0, 3.0), None);
        assert_eq!(t_quantile(0.9, 0.0), None);
    }
}
