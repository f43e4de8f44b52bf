//! Mean, standard deviation, percentiles.
//!
//! The unit of a result is that of the values.

/// Arithmetic mean; `None` of no values.
pub fn mean(values: &[f64]) -> Option<f64> {
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}

/// Sample standard deviation, with n − 1 in the denominator; `None` of fewer than two values.
pub fn sample_standard_deviation(values: &[f64]) -> Option<f64> {
    if values.len() < 2 {
        return None;
    }
    // Two passes: squares of the values themselves would cancel when the
    // spread is small beside the mean, as it is with standing heights.
    let centre = mean(values)?;
    let squares: f64 = values.iter().map(|v| (v - centre).powi(2)).sum();
    Some((squares / (values.len() - 1) as f64).sqrt())
}

/// Percentile by nearest rank: the ⌈p/100 · n⌉-th smallest value, so that at
/// least p percent of the values are no larger. It is always one of the values
/// (no interpolation); p = 0 gives the smallest.
///
/// `None` of no values, of a percentile outside 0 to 100, or where a value is NaN.
pub fn percentile(values: &[f64], percent: f64) -> Option<f64> {
    if values.is_empty() || !(0.0..=100.0).contains(&percent) || values.iter().any(|v| v.is_nan()) {
        return None;
    }
    let mut values = values.to_vec();
    // The small deduction keeps a rank that is a whole number in decimals,
    // such as 95 % of 20, from being rounded up by the binary fraction.
    let rank = (percent / 100.0 * values.len() as f64 - 1e-9).ceil().max(1.0) as usize;
    let (_, value, _) = values.select_nth_unstable_by(rank - 1, f64::total_cmp);
    Some(*value)
}

/// Slope of the least squares line through points (x, y), in units of y over x;
/// `None` without two distinct abscissae.
pub fn least_squares_slope(points: &[(f64, f64)]) -> Option<f64> {
    let (xs, ys): (Vec<f64>, Vec<f64>) = points.iter().copied().unzip();
    let (mx, my) = (mean(&xs)?, mean(&ys)?);
    let sxx: f64 = points.iter().map(|p| (p.0 - mx).powi(2)).sum();
    let sxy: f64 = points.iter().map(|p| (p.0 - mx) * (p.1 - my)).sum();
    (sxx > 0.0).then(|| sxy / sxx)
}

#[cfg(test)]
mod tests {
    use super::super::testing::assert_near;
    use super::*;

    #[test]
    fn mean_of_none_one_and_some() {
        assert_eq!(mean(&[]), None);
        assert_eq!(mean(&[3.5]), Some(3.5));
        assert_eq!(mean(&[1.0, 2.0, 6.0]), Some(3.0));
    }

    #[test]
    fn a_line_has_its_slope() {
        let line: Vec<(f64, f64)> =
            [0.0, 50.0, 100.0, 200.0].iter().map(|x| (*x, 163.0 - 0.04 * x)).collect();
        let got = least_squares_slope(&line).expect("a slope");
        assert_near("slope of 163 − 0.04 x", -0.04, got, 1e-12);
        assert_eq!(least_squares_slope(&[(1.0, 2.0)]), None, "one point has no slope");
        assert_eq!(least_squares_slope(&[(1.0, 2.0), (1.0, 3.0)]), None, "nor a vertical line");
    }

    /// Law: Σ(x − x̄)²/(n − 1); for 2, 4, 4, 4, 5, 5, 7, 9 that is 32/7.
    #[test]
    fn standard_deviation_is_that_of_a_sample() {
        assert_eq!(sample_standard_deviation(&[1.0]), None);
        let values = [2.0, 4.0, 4.0, 4.0, 5.0, 5.0, 7.0, 9.0];
        let expected = (32.0f64 / 7.0).sqrt();
        let got = sample_standard_deviation(&values).unwrap();
        assert_near("sample standard deviation", expected, got, 1e-14);
        // Law: a shift changes nothing, even one that dwarfs the spread.
        let shifted = values.map(|v| v + 1e7);
        let got = sample_standard_deviation(&shifted).unwrap();
        assert_near("standard deviation after a shift", expected, got, 1e-8);
    }

    /// The worked example of the nearest-rank method: 15, 20, 35, 40, 50.
    #[test]
    fn percentile_is_the_nearest_rank() {
        let values = [35.0, 15.0, 50.0, 20.0, 40.0];
        for (percent, expected) in
            [(0.0, 15.0), (5.0, 15.0), (30.0, 20.0), (40.0, 20.0), (50.0, 35.0), (100.0, 50.0)]
        {
            assert_eq!(percentile(&values, percent), Some(expected), "{percent} %");
        }
        let twenty: Vec<f64> = (1..=20).map(f64::from).collect();
        assert_eq!(percentile(&twenty, 95.0), Some(19.0), "95 % of 20 is the 19th");
        assert_eq!(percentile(&twenty, 95.1), Some(20.0), "a little more is the 20th");
        for n in 1..400 {
            let values: Vec<f64> = (1..=n).map(f64::from).collect();
            let got = percentile(&values, 99.0).unwrap() as i32;
            let expected = (99 * n + 99) / 100;
            assert_eq!(got, expected, "rank of 99 % among {n}, in whole numbers");
        }
    }

    #[test]
    fn percentile_refuses_nonsense() {
        assert_eq!(percentile(&[], 50.0), None);
        assert_eq!(percentile(&[1.0], -1.0), None);
        assert_eq!(percentile(&[1.0], 100.5), None);
        assert_eq!(percentile(&[1.0, f64::NAN], 50.0), None);
    }
}
