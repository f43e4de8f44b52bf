//! How much a settlement curve swings about its own trend.

/// Samples of a curve about its running mean.
///
/// `samples` are (time in s, value). The mean at a sample is taken over a window centred on it;
/// samples whose window reaches beyond the curve are left out, because a one-sided mean would count
/// the trend as a swing. Returns the root mean square of value minus mean over the samples whose
/// time `select` accepts; `None` where there are none.
///
/// A window of one shaking cycle leaves a steady trend out and keeps what
/// happens within a cycle and above.
pub fn rms_about_running_mean(
    samples: &[(f64, f64)],
    window_s: f64,
    select: impl Fn(f64) -> bool,
) -> Option<f64> {
    let (first, last) = (samples.first()?.0, samples.last()?.0);
    let half = 0.5 * window_s;
    let tolerance = 1e-9 * last.abs().max(1.0);
    let mut sum = 0.0;
    let mut count = 0usize;
    for &(time, value) in samples {
        let inside = time - half >= first - tolerance && time + half <= last + tolerance;
        if !inside || !select(time) {
            continue;
        }
        let from = samples.partition_point(|s| s.0 < time - half - tolerance);
        let to = samples.partition_point(|s| s.0 <= time + half + tolerance);
        let window = &samples[from..to];
        let mean = window.iter().map(|s| s.1).sum::<f64>() / window.len() as f64;
        sum += (value - mean).powi(2);
        count += 1;
    }
    (count > 0).then(|| (sum / count as f64).sqrt()).filter(|r| r.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sampled(f: impl Fn(f64) -> f64) -> Vec<(f64, f64)> {
        (0..500).map(|i| f64::from(i) * 0.02).map(|t| (t, f(t))).collect()
    }

    #[test]
    fn a_straight_line_does_not_fluctuate() {
        let line = sampled(|t| 3.0 + 2.0 * t);
        let got = rms_about_running_mean(&line, 0.4, |_| true).expect("a value");
        assert!(got < 1e-12, "a steady trend has no fluctuation: expected 0, got {got}");
    }

    #[test]
    fn a_sinusoid_has_its_amplitude_over_root_two() {
        // The window holds one cycle of 20 samples and one more, half a cycle
        // away from the centre: its mean is −value / 21.
        let wave = sampled(|t| t + 0.5 * (2.0 * std::f64::consts::PI * t / 0.4).sin());
        let got = rms_about_running_mean(&wave, 0.4, |_| true).expect("a value");
        let expected = 0.5 / 2f64.sqrt() * (1.0 + 1.0 / 21.0);
        assert!(
            (got - expected).abs() < 1e-3,
            "rms of 0.5 sin: expected {expected} ± 1e-3, got {got}"
        );
    }

    #[test]
    fn only_selected_samples_count() {
        let step = sampled(|t| if t < 5.0 { (20.0 * t).sin() } else { 0.0 });
        let quiet = rms_about_running_mean(&step, 0.4, |t| t > 6.0).expect("a value");
        let loud = rms_about_running_mean(&step, 0.4, |t| t < 4.0).expect("a value");
        assert!(
            quiet < 1e-12 && loud > 0.3,
            "expected still 0 and loud > 0.3, got {quiet}, {loud}"
        );
    }

    #[test]
    fn nothing_gives_nothing() {
        assert_eq!(rms_about_running_mean(&[], 0.4, |_| true), None);
        assert_eq!(rms_about_running_mean(&[(0.0, 1.0)], 0.4, |_| true), None);
        assert_eq!(rms_about_running_mean(&sampled(|t| t), 0.4, |_| false), None);
    }
}
