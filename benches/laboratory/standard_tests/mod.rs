//! Standard tests of granular material: the laws by which they are read, as pure functions.
//!
//! Discharge of a hopper ([`fit_beverloo`]), height and run-out of a column ([`column_height`],
//! [`deposit_edge`], [`run_out_of_slope`]), a box that is tilted ([`sliding_tilt`]), a drum that
//! turns ([`carried_up`]), direct shear
//! ([`shear_strength`], [`friction_angle`]), an oedometer ([`rebound`]), triaxial compression
//! ([`critical_state`]), where a curve takes a value ([`crossing`]), and how what was
//! measured is judged ([`judge`]).

mod beverloo;
mod crossing;
mod judge;
mod oedometer;
mod run_out;
mod shear;
mod tilt;
mod triaxial;

pub use beverloo::{
    BeverlooFit, Discharge, Held, Outflow, fit_beverloo, k_in_words, steady_outflow,
};
pub use crossing::{Crossing, crossing};
pub use judge::{Verdict, judge};
pub use oedometer::{Compressed, Rebound, compression_index, rebound, void_ratio_of_height};
pub use run_out::{column_height, deposit_edge, run_out_of_lube, run_out_of_slope};
pub use shear::{
    ShearStrength, Sheared, between_samples, friction_angle, inertial_number, shear_strength,
};
pub use tilt::{Borne, Tilted, Turned, carried_up, sliding_tilt};
pub use triaxial::{
    CriticalState, Triaxial, angle_of_ratio, critical_state, mean_stress_deviation, peak_ratio,
};

/// Mean of some numbers; NaN of none.
fn mean_of(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0_u32), |(sum, count), x| (sum + x, count + 1));
    sum / f64::from(count)
}

/// A number is what a law says, but for rounding.
#[cfg(test)]
fn near(what: &str, got: f64, expected: f64) {
    let tolerance = 1e-12 * expected.abs().max(1.0);
    let off = (got - expected).abs();
    assert!(off < tolerance, "law: {what}: {expected}, got {got}, tolerance {tolerance:e}");
}
