//! Settings of the contact solver that follow from the largest stress of a scenario, as well as from
//! its grains.

use super::*;
use crate::scale::{FASTER_UNDER_LOAD, STRESS_OF_DEFAULT, SUBSTEP_OF_INERTIAL_TIME};

/// Fields that follow from the largest stress as well as from the grains.
pub(super) const BY_LOAD: [&str; 3] = [STIFFNESS, DEPENETRATION, SUBSTEPS];

/// Stiffness of a contact point in N/m, to two digits: that of the law, and so much more as
/// the largest stress exceeds what the default is for.
pub(super) fn stiffness(value: &Value, grading: &Grading, scale: &Scale) -> f64 {
    let default = NativeSettings::default().contact_stiffness_n_per_m;
    rounded(default * Law::Stiffness.factor(scale) * heavier(value, grading, scale), 2)
}

/// Largest speed in m/s at which an overlap is pushed apart: that of the law, and more where the
/// largest stress exceeds what the default stiffness is for.
pub(super) fn depenetration(value: &Value, grading: &Grading, scale: &Scale) -> f64 {
    let default = NativeSettings::default().max_depenetration_velocity_m_per_s;
    let faster = if heavier(value, grading, scale) > 1.0 { FASTER_UNDER_LOAD } else { 1.0 };
    default * Law::Speed.factor(scale) * faster
}

/// Has deposits before the first load push overlaps apart as slowly as grains without a load do,
/// where nobody typed how fast: at the speed that a load asks for, overlaps of grains that fall burst
/// and throw them about. Until the load comes, what presses is the weight, which is less.
pub(super) fn calm_deposits(value: &mut Value, grading: &Grading, scale: &Scale) {
    let weight = weight_stress(value, grading, scale.gravity);
    let is_mostly_weight = largest_stress(value, grading, scale.gravity) <= 2.0 * weight;
    let is_typed = number_at(value, DEPENETRATION).is_some() || value.get("begin").is_some();
    if is_typed || is_mostly_weight || heavier(value, grading, scale) <= 1.0 {
        return;
    }
    let slow =
        NativeSettings::default().max_depenetration_velocity_m_per_s * Law::Speed.factor(scale);
    let stages = value.get_mut("stages").and_then(Value::as_array_mut).into_iter().flatten();
    let unloaded =
        stages.take_while(|stage| stage["stage"] != "press" && stage["stage"] != "release");
    for stage in unloaded.filter(|stage| stage["stage"] == "deposit") {
        if let Some(fields) = stage.as_object_mut() {
            fields.entry("max_depenetration_velocity_m_per_s").or_insert(json!(slow));
        }
    }
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

/// By how much the largest stress exceeds what the default stiffness is for; 1 where it does not.
fn heavier(value: &Value, grading: &Grading, scale: &Scale) -> f64 {
    let light = scale.density * scale.gravity * STRESS_OF_DEFAULT * scale.sizes.median;
    (largest_stress(value, grading, scale.gravity) / light).max(1.0)
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

    /// Law: before the first load contacts push apart as slowly as without one; afterwards, and where
    /// somebody typed a speed, or nothing but weight presses, deposits have the engine's.
    #[test]
    fn deposits_before_a_load_are_calm() {
        let scale = larger().scale_for_filling(9.81);
        let speeds = |change: &dyn Fn(&mut Value)| -> Vec<Option<f64>> {
            let mut value = json!({
                "apparatus": { "cylinder": { "inner_diameter_mm": 3000 } },
                "pieces": [{ "name": "lid", "shape": { "plate": { "size_mm": [500, 500, 10] } } }],
                "stages": [{ "stage": "deposit" }, { "stage": "move" }, { "stage": "deposit" },
                    { "stage": "press", "loads": [{ "piece": "lid", "stress_kpa": 1000 }] },
                    { "stage": "deposit" }]
            });
            change(&mut value);
            calm_deposits(&mut value, &larger(), &scale);
            let stages = value["stages"].as_array().expect("stages").iter();
            let deposits = stages.filter(|stage| stage["stage"] == "deposit");
            deposits.map(|stage| stage["max_depenetration_velocity_m_per_s"].as_f64()).collect()
        };
        let got = speeds(&|_| ());
        // 0.3 m/s × √3.
        let slow = |speed: Option<f64>| speed.is_some_and(|v| (v - 0.5196).abs() < 1e-4);
        assert!(slow(got[0]) && slow(got[1]), "law: 0.52 m/s before the load, got {got:?}");
        assert_eq!(got[2], None, "law: the engine's after it");
        let own = speeds(&|value| {
            value["stages"][0]["max_depenetration_velocity_m_per_s"] = json!(2.0);
        });
        assert_eq!(own[0], Some(2.0), "law: what is typed stays");
        let typed = speeds(&|value| {
            value["engine"]["native"]["max_depenetration_velocity_m_per_s"] = json!(3.0);
        });
        assert_eq!(typed, [None; 3], "law: what is typed for all stages holds");
        let begun = speeds(&|value| value["begin"] = json!({ "specimen": "out" }));
        assert_eq!(begun, [None; 3], "law: another run may have left a load");
        let light = speeds(&|value| value["stages"][3]["loads"] = json!([]));
        assert_eq!(light, [None; 3], "law: nothing presses");
        let heavy = speeds(&|value| {
            value["stages"][3]["loads"] = json!([]);
            value["apparatus"]["cylinder"]["inner_diameter_mm"] = json!(200);
        });
        assert_eq!(heavy, [None; 3], "law: grains are heavy themselves");
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
