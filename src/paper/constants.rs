//! Numbers the paper's text gives, in the units it gives them in.

/// Density of the solids in kg/m³ (section 2; mercury intrusion at zero pressure).
pub const SOLID_DENSITY_KG_PER_M3: f64 = 2673.9;
/// Mass of the gravel in g, in every pluviation and vibration test (section 2).
pub const TOTAL_MASS_G: f64 = 2343.0;
/// Number of polyhedra simulated (section 3).
pub const GRAIN_COUNT: usize = 1456;
/// Falling heights of the pluviation tests in mm (section 2: 0, 5, 10 and 20 cm).
pub const FALLING_HEIGHTS_MM: [f64; 4] = [0.0, 50.0, 100.0, 200.0];
/// Millimetres in a centimetre, in which the text gives falling heights.
pub(super) const MM_IN_CM: f64 = 10.0;
/// Falling height of the specimens that were vibrated, in mm (section 2: 5 cm).
pub const VIBRATED_FALLING_HEIGHT_MM: f64 = 50.0;
/// Frequency of the vibration in Hz (section 2: 3 cps).
pub const FREQUENCY_HZ: f64 = 3.0;
/// Length of the continuous vibration in s (section 2).
pub const CONTINUOUS_S: f64 = 20.0;
/// Length of one period of the intermittent vibration in s (section 2).
pub const PERIOD_S: f64 = 5.0;
/// Number of periods of the intermittent vibration (section 2).
pub const PERIODS: u32 = 4;
/// Friction coefficient between the surfaces of the gravels (section 3: "friction ratio").
pub const FRICTION_COEFFICIENT: f64 = 0.793;
/// Coefficient of restitution (section 3, after Robotham et al. 1995).
pub const RESTITUTION: f64 = 0.315;
/// Angle of repose in degrees, from slow pluviation on a rough surface (section 2).
pub const ANGLE_OF_REPOSE_DEG: f64 = 38.40;
/// Time between two readings of the plate's position in the simulations, in s (section 4).
pub const MONITORING_INTERVAL_S: f64 = 0.08;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report;

    #[test]
    fn the_numbers_agree_with_each_other() {
        let per_100_g = GRAIN_COUNT as f64 / TOTAL_MASS_G * 100.0;
        assert!(
            (55.0..=65.0).contains(&per_100_g),
            "section 3: 1456 grains of 2343 g are 55 to 65 in 100 g; got {per_100_g}"
        );
        let vibrated = FREQUENCY_HZ * PERIOD_S * f64::from(PERIODS);
        let continuous = FREQUENCY_HZ * CONTINUOUS_S;
        assert!(
            (vibrated - continuous).abs() < 1e-9,
            "both modes shake for the same 60 cycles: got {vibrated} and {continuous}"
        );
    }

    /// Law: what a calibration quotes of the paper is what the paper gives.
    #[test]
    fn a_calibration_quotes_the_paper() {
        let quoted = [report::PUBLISHED_FRICTION, report::PUBLISHED_ANGLE_OF_REPOSE_DEG];
        assert_eq!(quoted, [FRICTION_COEFFICIENT, ANGLE_OF_REPOSE_DEG], "law: quoted, stated");
    }
}
