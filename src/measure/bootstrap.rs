//! Confidence intervals without a distribution assumed: resampling what was measured.

use super::*;
use crate::grains::streams::{below, stream};

/// Resamples of an interval: its ends are then known to about a fiftieth of its width (Efron &
/// Tibshirani 1993, *An Introduction to the Bootstrap*, section 13.3 asks for a thousand at least).
const RESAMPLES: usize = 4000;

/// The percentile bootstrap interval of a mean (Efron & Tibshirani 1993,
/// chapter 13) for a confidence such as 0.95: the values are drawn anew with
/// replacement, and the middle share of the means is taken. The draws come from
/// a named stream, so that the same values have the same interval.
///
/// With few values it is too narrow: of three by about a half. Student's t
/// ([`super::inference::MeanTest`]) is the safer one there.
///
/// `None` of fewer than three values, or where one is not finite.
pub fn bootstrap_interval(values: &[f64], confidence: f64) -> Option<(f64, f64)> {
    if values.len() < 3 || values.iter().any(|v| !v.is_finite()) {
        return None;
    }
    let mut rng = stream(values.len() as u64, "bootstrap");
    let mut resample = vec![0.0; values.len()];
    let mut means = Vec::with_capacity(RESAMPLES);
    for _ in 0..RESAMPLES {
        for drawn in &mut resample {
            *drawn = values[below(&mut rng, values.len() as u64) as usize];
        }
        means.push(mean(&resample)?);
    }
    let tail = 50.0 * (1.0 - confidence);
    Some((percentile(&means, tail)?, percentile(&means, 100.0 - tail)?))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grains::streams::uniform;

    /// Law: of many values it is that of the normal distribution, ± 1.96 s/√n.
    #[test]
    fn many_values_have_the_interval_of_the_normal_distribution() {
        let mut rng = stream(3, "test");
        let values: Vec<f64> = (0..400).map(|_| uniform(&mut rng)).collect();
        let (low, high) = bootstrap_interval(&values, 0.95).expect("an interval");
        let expected = 2.0 * 1.96 / 12.0_f64.sqrt() / 400.0_f64.sqrt();
        let got = high - low;
        assert!(
            (got / expected - 1.0).abs() < 0.1,
            "law: width of the interval, expected {expected}, got {got}, tolerance 10 %"
        );
        let middle = mean(&values).expect("a mean");
        assert!(low < middle && middle < high, "law: {middle} lies in {low} to {high}");
    }

    #[test]
    fn the_same_values_have_the_same_interval() {
        let values = [15.9, 15.1, 15.0, 16.2];
        assert_eq!(bootstrap_interval(&values, 0.95), bootstrap_interval(&values, 0.95));
        assert_eq!(bootstrap_interval(&[2.0; 5], 0.95), Some((2.0, 2.0)), "law: no scatter");
    }

    #[test]
    fn too_little_gives_none() {
        assert_eq!(bootstrap_interval(&[1.0, 2.0], 0.95), None);
        assert_eq!(bootstrap_interval(&[1.0, 2.0, f64::NAN], 0.95), None);
    }
}
