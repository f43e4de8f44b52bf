//! Deposits before the first load: contacts push overlaps apart there as slowly as grains without a
//! load do. At the speed that a load asks for, overlaps of grains that fall burst and throw them about.

use super::*;

/// Name of the field by which a deposit has a speed of its own.
pub(super) const OWN_SPEED: &str = "max_depenetration_velocity_m_per_s";

/// Gives deposits before the first load that speed where nobody typed one. Until the load comes, what
/// presses is the weight, which is less. Of a scenario that begins with a specimen, see
/// [`calm_begun`].
pub(super) fn calm_deposits(value: &mut Value, grading: &Grading, scale: &Scale) {
    let is_typed = number_at(value, DEPENETRATION).is_some() || value.get("begin").is_some();
    if !is_typed && presses(value, grading, scale) {
        calm(value, scale);
    }
}

/// The same of a scenario that begins with a specimen of a run and has taken over its automatic
/// speed, which loads of either may have made higher: unless the specimen has been under a load.
pub(super) fn calm_begun(value: &mut Value, run: &Value, grading: &Grading, scale: &Scale) {
    let slow = unloaded_depenetration(scale) * (1.0 + 1e-9);
    let is_faster = number_at(value, DEPENETRATION).is_some_and(|speed| speed > slow);
    let stress = |of: &Value| largest_stress(of, grading, scale.gravity);
    let largest = stress(run).max(stress(value));
    let weight = weight_stress(value, grading, scale.gravity);
    // Where neither of them presses so much, what the run began with itself did.
    let is_by_weight = heavier_by(largest, scale) > 1.0 && largest <= 2.0 * weight;
    if is_faster && !is_by_weight {
        calm(value, scale);
    }
}

/// Whether loads ask for a higher speed than grains without a load have, and are more than weights.
fn presses(value: &Value, grading: &Grading, scale: &Scale) -> bool {
    let largest = largest_stress(value, grading, scale.gravity);
    let weight = weight_stress(value, grading, scale.gravity);
    heavier_by(largest, scale) > 1.0 && largest > 2.0 * weight
}

/// Gives deposits before the first load the speed of grains without a load, where native contacts
/// read it and none is there.
fn calm(value: &mut Value, scale: &Scale) {
    let engine = &value["engine"];
    if engine["backend"] == "rapier" || engine["contact_solver"] == "stock" {
        return;
    }
    for n in deposits_before_a_load(value) {
        if let Some(fields) = value["stages"][n].as_object_mut() {
            fields.entry(OWN_SPEED).or_insert(json!(unloaded_depenetration(scale)));
        }
    }
}

/// The speed in m/s that deposits before the first load have where nobody types one.
pub(super) fn speed_before_a_load(value: &Value, grading: &Grading, scale: &Scale) -> f64 {
    match presses(value, grading, scale) {
        true => unloaded_depenetration(scale),
        false => depenetration(value, grading, scale),
    }
}

/// Numbers of the stages that deposit grains before the first load; none where the specimen that is
/// begun with has been under one, or nothing is known of it.
pub(super) fn deposits_before_a_load(value: &Value) -> Vec<usize> {
    let is_load = |name: &Value| *name == "press" || *name == "release";
    if let Some(begin) = value.get("begin") {
        let after = begin["after"].as_array();
        if after.is_none_or(|after| after.is_empty() || after.iter().any(is_load)) {
            return Vec::new();
        }
    }
    let stages = value["stages"].as_array().into_iter().flatten().enumerate();
    let unloaded = stages.take_while(|(_, stage)| !is_load(&stage["stage"]));
    unloaded.filter(|(_, stage)| stage["stage"] == "deposit").map(|(n, _)| n).collect()
}

#[cfg(test)]
mod tests {
    use super::super::grading::larger;
    use super::*;

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
            deposits.map(|stage| stage[OWN_SPEED].as_f64()).collect()
        };
        let got = speeds(&|_| ());
        // 0.3 m/s × √3.
        let slow = |speed: Option<f64>| speed.is_some_and(|v| (v - 0.5196).abs() < 1e-4);
        assert!(slow(got[0]) && slow(got[1]), "law: 0.52 m/s before the load, got {got:?}");
        assert_eq!(got[2], None, "law: the engine's after it");
        let own = speeds(&|value| value["stages"][0][OWN_SPEED] = json!(2.0));
        assert_eq!(own[0], Some(2.0), "law: what is typed stays");
        let typed = speeds(&|value| {
            value["engine"]["native"]["max_depenetration_velocity_m_per_s"] = json!(3.0);
        });
        assert_eq!(typed, [None; 3], "law: what is typed for all stages holds");
        let begun = speeds(&|value| value["begin"] = json!({ "specimen": "out" }));
        assert_eq!(begun, [None; 3], "law: what a run left decides, and is not known here");
        let light = speeds(&|value| value["stages"][3]["loads"] = json!([]));
        assert_eq!(light, [None; 3], "law: nothing presses");
        let heavy = speeds(&|value| {
            value["stages"][3]["loads"] = json!([]);
            value["apparatus"]["cylinder"]["inner_diameter_mm"] = json!(200);
        });
        assert_eq!(heavy, [None; 3], "law: grains are heavy themselves");
    }

    /// Law: the speed of deposits before a load is that of grains without one, also where another is
    /// typed, which is compared with it.
    #[test]
    fn the_usual_speed_before_a_load_does_not_depend_on_what_is_typed() {
        let scale = larger().scale_for_filling(9.81);
        let mut value = json!({
            "apparatus": { "cylinder": { "inner_diameter_mm": 3000 } },
            "engine": { "native": { "max_depenetration_velocity_m_per_s": 7 } },
            "pieces": [{ "name": "lid", "shape": { "plate": { "size_mm": [500, 500, 10] } } }],
            "stages": [{ "stage": "deposit" },
                { "stage": "press", "loads": [{ "piece": "lid", "stress_kpa": 1000 }] }]
        });
        let usual = |value: &Value| speed_before_a_load(value, &larger(), &scale);
        let pressed = usual(&value);
        assert!((pressed - 0.5196).abs() < 1e-4, "law: 0.3 m/s × √3, got {pressed} m/s");
        // Weights alone ask for the engine's speed.
        value["stages"][1]["loads"] = json!([]);
        value["apparatus"]["cylinder"]["inner_diameter_mm"] = json!(200);
        let heavy = usual(&value);
        assert!((heavy - 5.196).abs() < 1e-3, "law: ten times that, got {heavy} m/s");
    }

    /// Law: what a specimen has been through counts as stages before: a load, or nothing known of it,
    /// leaves no deposit before the first load.
    #[test]
    fn loads_on_a_specimen_that_is_begun_with_count() {
        let stages = json!([{ "stage": "rest" }, { "stage": "deposit" }, { "stage": "release" },
            { "stage": "deposit" }]);
        let of = |begin: Value| {
            let mut value = json!({ "stages": stages });
            if !begin.is_null() {
                value["begin"] = begin;
            }
            deposits_before_a_load(&value)
        };
        assert_eq!(of(Value::Null), [1], "law: those before the release");
        assert_eq!(of(json!({ "after": ["deposit", "move"] })), [1], "law: none pressed before");
        for begin in [json!({}), json!({ "after": [] }), json!({ "after": ["deposit", "press"] })] {
            assert!(of(begin.clone()).is_empty(), "law: {begin} may have been under a load");
        }
    }
}
