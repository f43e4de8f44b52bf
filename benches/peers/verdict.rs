//! What a row of the results says: whether it meets the accuracy standard (docs/accuracy.md), and
//! its step rate.

use pluvia::{scale::Scale, study::standard};

/// Whether no grain that must stay is lost and all three are within the standard; not known where
/// the first two are and nobody measured the third.
pub fn meets_standard(lost: usize, mean: f64, p99: f64, creep: Option<f64>) -> Option<bool> {
    // The scenes of the peers are of the paper's gravel.
    let limits = standard(&Scale::PAPER);
    let (mean_limit, p99_limit) = (limits.overlap_mean_percent, limits.overlap_p99_percent);
    let creep_limit = limits.creep_um_per_s;
    if lost == 0 && mean < mean_limit && p99 < p99_limit {
        creep.map(|c| c.abs() < creep_limit)
    } else {
        Some(false)
    }
}

/// Steps per second of `steps` in a simulated time: the rate that was asked for, unless the engine
/// chose another. The time is a sum of steps, and their quotient has its rounding.
pub fn rate_hz(asked: f64, steps: u64, simulated_s: f64) -> f64 {
    let got = steps as f64 / simulated_s;
    if (got - asked).abs() <= 1e-9 * got { asked } else { got }
}
