//! Settings that follow from the motions and the kind of experiment of a scenario, as well as from
//! its grains.

use super::validate::least_rate_hz;
use super::*;
use crate::scale::{LARGEST_OF_PILE, RMS_OF_PILE};

/// The step rate in Hz is a multiple of this, so that a cycle of 1, 2, 3, 4, 6 or 12 Hz takes a
/// whole number of steps and the table stops in its middle.
const CYCLES: f64 = 12.0;

/// Step rate in Hz: that of the law, or more where something moves by more than a grain in a step.
pub(super) fn rate(value: &Value, grading: &Grading, scale: &Scale) -> f64 {
    let rate = EngineSettings::default().rate_hz * Law::Rate.factor(scale);
    let rate = least_rate_hz(value, Some(grading)).map_or(rate, |least| rate.max(least.ceil()));
    (rate / CYCLES - 1e-9).ceil() * CYCLES
}

fn settling_speed(value: &Value, scale: &Scale, default: f64, of_pile: f64) -> f64 {
    let mut stages = value["stages"].as_array().into_iter().flatten();
    let is_pile = stages.any(|stage| stage["stage"] == "slow_pluviation");
    default * Law::Speed.factor(scale) * if is_pile { of_pile } else { 1.0 }
}

/// Root mean square speed in mm/s with which a specimen counts as settled.
pub(super) fn rms_speed(value: &Value, _: &Grading, scale: &Scale) -> f64 {
    settling_speed(value, scale, SettleSpec::default().rms_speed_mm_per_s, RMS_OF_PILE)
}

/// Largest speed in mm/s with which a specimen counts as settled.
pub(super) fn largest_speed(value: &Value, _: &Grading, scale: &Scale) -> f64 {
    settling_speed(value, scale, SettleSpec::default().largest_speed_mm_per_s, LARGEST_OF_PILE)
}
