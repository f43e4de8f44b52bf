//! Standard tests of granular material: the laws by which they are read, as pure functions.
//!
//! Discharge of a hopper ([`fit_beverloo`]), height and run-out of a column ([`column_height`],
//! [`deposit_edge`], [`run_out_of_slope`]), a box that is tilted ([`sliding_tilt`]), direct shear
//! ([`shear_strength`], [`friction_angle`]), an oedometer ([`rebound`]), triaxial compression
//! ([`critical_state`]), where a curve of means takes a value ([`crossing`]), and how what was
//! measured is judged ([`judge`]).

mod beverloo;
mod judge;
mod oedometer;
mod run_out;
mod shear;
mod tilt;
mod triaxial;

pub use beverloo::{
    BeverlooFit, Discharge, Held, Outflow, fit_beverloo, k_in_words, steady_outflow,
};
pub use judge::{Verdict, judge};
pub use oedometer::{Compressed, Rebound, compression_index, rebound, void_ratio_of_height};
pub use run_out::{column_height, deposit_edge, run_out_of_lube, run_out_of_slope};
pub use shear::{ShearStrength, Sheared, friction_angle, inertial_number, shear_strength};
pub use tilt::{Tilted, sliding_tilt};
pub use triaxial::{CriticalState, Triaxial, angle_of_ratio, critical_state, peak_ratio};

/// Mean of some numbers; NaN of none.
fn mean_of(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0_u32), |(sum, count), x| (sum + x, count + 1));
    sum / f64::from(count)
}

/// The place at which a curve through points first takes a value, rising or falling, on straight
/// lines between points in the order of their places. `None` where it does not.
pub fn crossing(points: &[(f64, f64)], wanted: f64) -> Option<f64> {
    let mut points = points.to_vec();
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    points.windows(2).find_map(|pair| {
        let ((x0, y0), (x1, y1)) = (pair[0], pair[1]);
        let (a, b) = (y0 - wanted, y1 - wanted);
        match (a == 0.0, b == 0.0) {
            (true, _) => Some(x0),
            (_, true) => Some(x1),
            _ => (a * b < 0.0).then(|| x0 + (x1 - x0) * a / (a - b)),
        }
    })
}

/// A number is what a law says, but for rounding.
#[cfg(test)]
fn near(what: &str, got: f64, expected: f64) {
    let tolerance = 1e-12 * expected.abs().max(1.0);
    let off = (got - expected).abs();
    assert!(off < tolerance, "law: {what}: {expected}, got {got}, tolerance {tolerance:e}");
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_curve_takes_a_value_where_its_line_does() {
        let points = [(0.4, 40.0), (0.1, 20.0), (0.2, 30.0), (0.8, 35.0)];
        for (wanted, expected) in
            [(25.0, Some(0.15)), (38.0, Some(0.36)), (30.0, Some(0.2)), (45.0, None), (10.0, None)]
        {
            let got = crossing(&points, wanted);
            let near = match (got, expected) {
                (Some(a), Some(b)) => f64::abs(a - b) < 1e-12,
                (a, b) => a == b,
            };
            assert!(
                near,
                "law: linear between sorted points, {wanted} at {expected:?}, got {got:?}"
            );
        }
        assert_eq!(crossing(&points[..1], 40.0), None, "law: a point alone is no curve");
    }
}
