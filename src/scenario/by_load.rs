//! Settings of the contact solver that follow from the largest stress of a scenario, as well as from
//! its grains.

use super::*;
use crate::scale::{
    FASTER_UNDER_LOAD, MOST_ITERATIONS_OF_LOAD, STRESS_OF_DEFAULT, SUBSTEP_OF_INERTIAL_TIME,
};

/// Fields that follow from the largest stress as well as from the grains.
pub(super) const BY_LOAD: [&str; 4] = [STIFFNESS, DEPENETRATION, SUBSTEPS, ITERATIONS];

/// Stiffness of a contact point in N/m, to two digits: that of the law, and so much more as
/// the largest stress exceeds what the default is for.
pub(super) fn stiffness(value: &Value, grading: &Grading, scale: &Scale) -> f64 {
    let default = NativeSettings::default().contact_stiffness_n_per_m;
    rounded(default * Law::Stiffness.factor(scale) * heavier(value, grading, scale), 2)
}

/// Largest speed in m/s at which an overlap is pushed apart: that of the law, and more where the
/// largest stress exceeds what the default stiffness is for.
pub(super) fn depenetration(value: &Value, grading: &Grading, scale: &Scale) -> f64 {
    let faster = if heavier(value, grading, scale) > 1.0 { FASTER_UNDER_LOAD } else { 1.0 };
    unloaded_depenetration(scale) * faster
}

/// That speed in m/s where little presses.
pub(super) fn unloaded_depenetration(scale: &Scale) -> f64 {
    NativeSettings::default().max_depenetration_velocity_m_per_s * Law::Speed.factor(scale)
}

/// Sub-steps per second: those of the law, and more where the largest stress asks for shorter ones,
/// to two digits.
pub(super) fn substep_rate(value: &Value, grading: &Grading, scale: &Scale) -> f64 {
    let default = NativeSettings::default().substep_rate_hz * Law::Rate.factor(scale);
    let stress = largest_stress(value, grading, scale.gravity);
    let inertial_time = scale.sizes.smallest * (scale.density / stress).sqrt();
    let loaded = rounded(1.0 / (SUBSTEP_OF_INERTIAL_TIME * inertial_time), 2);
    if loaded > default { loaded } else { default }
}

/// Iterations in a sub-step: more by as much as contacts are stiffer under the largest stress.
pub(super) fn iterations(value: &Value, grading: &Grading, scale: &Scale) -> f64 {
    let default = f64::from(NativeSettings::default().iterations);
    (default * heavier(value, grading, scale)).round().min(MOST_ITERATIONS_OF_LOAD)
}

/// By how much the largest stress exceeds what the default stiffness is for; 1 where it does not.
fn heavier(value: &Value, grading: &Grading, scale: &Scale) -> f64 {
    heavier_by(largest_stress(value, grading, scale.gravity), scale)
}

/// The same of a stress in Pa.
pub(super) fn heavier_by(stress: f64, scale: &Scale) -> f64 {
    let light = scale.density * scale.gravity * STRESS_OF_DEFAULT * scale.sizes.median;
    (stress / light).max(1.0)
}

#[cfg(test)]
mod tests {
    use super::super::grading::larger;
    use super::*;

    #[test]
    fn a_load_makes_contacts_stiffer() {
        let scale = larger().scale_for_filling(9.81);
        let of = |diameter: f64| {
            let value = json!({ "apparatus": { "cylinder": { "inner_diameter_mm": diameter } } });
            stiffness(&value, &larger(), &scale)
        };
        let (wide, narrow, narrower) = (of(3000.0), of(200.0), of(200.0 / 2_f64.sqrt()));
        // 10 kN/m × 3² × 2000/2673.9 is 67 kN/m.
        assert_eq!(wide, 67_000.0, "law: that of the size where little weighs on a grain");
        assert!(narrow > wide, "law: more where more does");
        assert!((narrower / narrow - 2.0).abs() < 0.05, "law: as the stress, {narrow}, {narrower}");
        let speed = |diameter: f64| {
            let value = json!({ "apparatus": { "cylinder": { "inner_diameter_mm": diameter } } });
            depenetration(&value, &larger(), &scale)
        };
        let (wide, narrow) = (speed(3000.0), speed(200.0));
        // 0.3 m/s × √3.
        assert!((wide - 0.5196).abs() < 1e-4, "law: that of the size, got {wide} m/s");
        assert_eq!(narrow, 10.0 * wide, "law: ten times that under a load");
    }

    /// Law: eight iterations where little presses, more in proportion to the stress, 40 at most.
    #[test]
    fn a_load_asks_for_more_iterations() {
        let scale = larger().scale_for_filling(9.81);
        let value = |diameter: f64| json!({ "apparatus": { "cylinder": { "inner_diameter_mm": diameter } } });
        let of = |diameter: f64| iterations(&value(diameter), &larger(), &scale);
        assert_eq!(of(3000.0), 8.0, "law: the default where little weighs on a grain");
        let stiffer = |diameter: f64| stiffness(&value(diameter), &larger(), &scale) / 67_000.0;
        let narrow = 200.0;
        let (got, expected) = (of(narrow), 8.0 * stiffer(narrow));
        assert!(got > 8.0 && got < 40.0, "law: between the bounds, {got} of {narrow} mm");
        assert!((got - expected).abs() < 0.8, "law: as the stiffness, {expected}, got {got}");
        assert_eq!(of(50.0), 40.0, "law: no more than 40");
        let mut filled = value(narrow);
        automatic::fill(&mut filled, &larger());
        let whole = &filled["engine"]["native"]["iterations"];
        assert_eq!(whole.as_u64(), Some(got as u64), "law: a whole number, {whole}");
    }

    /// Law: under a load a sub-step lasts a fifth of d √(ρ/P) at most; else the law of the size holds.
    #[test]
    fn a_load_makes_sub_steps_shorter() {
        let scale = larger().scale_for_filling(9.81);
        let of = |stress_kpa: f64| {
            let value = json!({
                "pieces": [{ "name": "lid", "shape": { "plate": { "size_mm": [500, 500, 10] } } }],
                "apparatus": { "cylinder": { "inner_diameter_mm": 3000 } },
                "stages": [{ "stage": "press",
                    "loads": [{ "piece": "lid", "stress_kpa": stress_kpa }] }]
            });
            substep_rate(&value, &larger(), &scale)
        };
        let law = 1440.0 / 3_f64.sqrt();
        assert!((of(1.0) - law).abs() < 1e-9, "law: {law} Hz under 1 kPa, got {}", of(1.0));
        let (one, four) = (of(1e3), of(4e3));
        // d of the smallest is 24 mm: 5 √(10⁶/2000)/0.024 s.
        assert!((one / 4658.0 - 1.0).abs() < 0.02, "law: 4658 Hz under 1 MPa, got {one}");
        assert!((four / one - 2.0).abs() < 0.05, "law: as √P, got {one} and {four} Hz");
    }
}
