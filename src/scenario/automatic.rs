//! Values that follow from the grains where nobody typed them.
//!
//! What is left out of a scenario and depends on the size of the grains is filled in
//! here, before anything is checked: for the paper's gravel every value is its default,
//! for other grains that default times the law of [`crate::scale`]. A value that is typed
//! is taken as it is.

use serde_json::Number;

use super::*;
use crate::scale::OPENING_OF_CYLINDER;

/// Strongest gravity that is allowed, in m/s².
const STRONGEST: f64 = 100.0;

/// Fills in what is left out of a scenario's JSON and follows from its grains.
pub(super) fn fill(value: &mut Value, grading: &Grading) {
    if !value.is_object() {
        return;
    }
    let scale = scale_of(value, grading);
    // The apparatus follows from the grains alone, all else from gravity, too.
    let on_earth = || grading.scale_for_filling(super::default_gravity());
    fill_apparatus(value, &scale.unwrap_or_else(on_earth));
    let Some(scale) = scale else { return };
    fill_stages(value, &scale);
    calm_deposits(value, grading, &scale);
    for field in BY_SIZE {
        let default = field.default_value();
        let factor = match by_scenario(field.path, value, grading, &scale) {
            Some(number) => number / default,
            None => field.law.factor(&scale),
        };
        put(value, field.path, default, factor);
    }
    let default = f64::from(NativeSettings::default().iterations);
    put(value, ITERATIONS, default, iterations(value, grading, &scale) / default);
}

/// The scale that values of a scenario's JSON follow from; none where its gravity is at fault.
pub(super) fn scale_of(value: &Value, grading: &Grading) -> Option<Scale> {
    let gravity = match value.get("gravity_m_per_s2") {
        None => super::default_gravity(),
        Some(gravity) => gravity.as_f64()?,
    };
    (gravity > 0.0 && gravity <= STRONGEST).then(|| grading.scale_for_filling(gravity))
}

/// The value of a field that follows from the motions or loads of a scenario as well as from its
/// grains; `None` for every other field.
pub(super) fn by_scenario(
    path: &str,
    value: &Value,
    grading: &Grading,
    scale: &Scale,
) -> Option<f64> {
    let asked = match path {
        RATE => rate,
        STIFFNESS => stiffness,
        DEPENETRATION => depenetration,
        SUBSTEPS => substep_rate,
        ITERATIONS => iterations,
        RMS_SPEED => rms_speed,
        LARGEST_SPEED => largest_speed,
        _ => return None,
    };
    Some(asked(value, grading, scale))
}

/// Sizes of the apparatus that are automatic where they are left out.
const OF_APPARATUS: [&str; 9] = [
    "apparatus.cylinder.inner_diameter_mm",
    "apparatus.cylinder.height_mm",
    "apparatus.cylinder.wall_thickness_mm",
    "apparatus.funnel.opening_diameter_mm",
    "apparatus.funnel.top_diameter_mm",
    "apparatus.funnel.wall_thickness_mm",
    "apparatus.top_plate.diameter_mm",
    "apparatus.top_plate.thickness_mm",
    "apparatus.top_plate.mass_g",
];

/// Paths of the fields that are automatic where they are left out, those of stages aside.
pub(super) fn automatic_paths() -> impl Iterator<Item = &'static str> {
    BY_SIZE.iter().map(|field| field.path).chain([ITERATIONS]).chain(OF_APPARATUS)
}

/// What is automatic of stages where it is left out: stage, field, law and default.
pub(super) fn fields_of_stages() -> [(&'static str, &'static str, Law, f64); 15] {
    use Law::{Coarse, Rate, Speed, Time};
    [
        ("fill_funnel", "time_limit_s", Time, fill_limit()),
        ("pour", "time_limit_s", Time, pour_limit()),
        ("place_top_plate", "time_limit_s", Time, place_limit()),
        ("slow_pluviation", "time_limit_s", Time, slow_limit()),
        ("slow_pluviation", "feed_rate_grains_per_s", Rate, feed_rate()),
        ("slow_pluviation", "drop_height_mm", Coarse, drop_height()),
        ("slow_pluviation", "spout_diameter_mm", Coarse, spout_diameter()),
        ("vibrate", "settle_limit_s", Time, settle_limit()),
        ("deposit", "time_limit_s", Time, deposit_limit()),
        ("move", "keep_mean_stress.window_s", Time, stress_window()),
        ("press", "time_limit_s", Time, deposit_limit()),
        ("press", "ramp_s", Time, press_ramp()),
        ("press", "approach_mm_per_s", Speed, approach()),
        ("release", "time_limit_s", Time, deposit_limit()),
        ("remove", "time_limit_s", Time, deposit_limit()),
    ]
}

/// Cylinder, funnel and plate are those of the paper times the size of the largest grains; funnel
/// and plate are narrower where they would not fit into a cylinder that is typed.
fn fill_apparatus(value: &mut Value, scale: &Scale) {
    let (cylinder, funnel, plate) =
        (CylinderSpec::default(), FunnelSpec::default(), TopPlateSpec::default());
    let coarser = Law::Coarse.factor(scale);
    let mut length = |path: &str, default: f64, factor: f64| {
        let factor = if factor == 1.0 { factor } else { rounded(default * factor, 4) / default };
        put(value, path, default, factor);
        number_at(value, path).unwrap_or(default)
    };
    let diameter =
        length("apparatus.cylinder.inner_diameter_mm", cylinder.inner_diameter_mm, coarser);
    length("apparatus.cylinder.height_mm", cylinder.height_mm, coarser);
    length("apparatus.cylinder.wall_thickness_mm", cylinder.wall_thickness_mm, coarser);
    // Nothing follows from a cylinder that is itself a fault.
    let across = match diameter > to_mm(scale.sizes.largest) {
        true => diameter / cylinder.inner_diameter_mm,
        false => coarser,
    };
    let widest =
        OPENING_OF_CYLINDER * across * cylinder.inner_diameter_mm / funnel.opening_diameter_mm;
    length("apparatus.funnel.opening_diameter_mm", funnel.opening_diameter_mm, coarser.min(widest));
    length("apparatus.funnel.top_diameter_mm", funnel.top_diameter_mm, coarser);
    length("apparatus.funnel.wall_thickness_mm", funnel.wall_thickness_mm, coarser);
    let across = coarser.min(across);
    length("apparatus.top_plate.diameter_mm", plate.diameter_mm, across);
    length("apparatus.top_plate.thickness_mm", plate.thickness_mm, coarser);
    let heavier = across.powi(2) * coarser;
    length("apparatus.top_plate.mass_g", plate.mass_g, heavier);
}

fn fill_stages(value: &mut Value, scale: &Scale) {
    let stages = value.get_mut("stages").and_then(Value::as_array_mut);
    for stage in stages.into_iter().flatten() {
        for (name, field, law, default) in fields_of_stages() {
            let is_there = |(part, _): (&str, &str)| stage[part].is_object();
            if stage["stage"] != name || !field.split_once('.').is_none_or(is_there) {
                continue;
            }
            let factor = law.factor(scale);
            // Small grains fall sooner; but a limit is one, and there may be many.
            let is_limit = field.ends_with("_limit_s");
            put(stage, field, default, if is_limit { factor.max(1.0) } else { factor });
        }
    }
}

/// A number as it is written to a field; none where it is none.
pub(super) fn written(path: &str, number: f64) -> Option<Number> {
    if path == ITERATIONS { Some((number as u64).into()) } else { Number::from_f64(number) }
}

/// Sets a field that is left out to its default times a factor; nothing where that is the
/// default, or where something else stands in the way.
fn put(value: &mut Value, path: &str, default: f64, factor: f64) {
    let number = written(path, within(path, default * factor));
    let Some(number) = number.filter(|_| factor != 1.0) else { return };
    let (parents, name) = path.rsplit_once('.').unwrap_or(("", path));
    let mut at = value;
    for step in parents.split('.').filter(|step| !step.is_empty()) {
        let Some(object) = at.as_object_mut() else { return };
        at = object.entry(step).or_insert_with(|| Value::Object(Map::new()));
    }
    if let Some(object) = at.as_object_mut() {
        object.entry(name).or_insert(Value::Number(number));
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::super::{grading::larger, schema};
    use super::*;
    use crate::scale::GrainSizes;

    fn stages() -> Value {
        json!([{ "stage": "slow_pluviation", "base_diameter_mm": 500 }])
    }

    #[test]
    fn nothing_is_filled_in_for_the_papers_gravel() {
        let paper = Grading {
            sizes: GrainSizes::PAPER,
            density: Scale::PAPER.density,
            solids: 0.000_876,
            count: 1456.0,
        };
        let before = json!({ "stages": [{ "stage": "pour", "falling_height_mm": 50 }] });
        let mut after = before.clone();
        fill(&mut after, &paper);
        assert_eq!(after, before, "law: the defaults are those of the paper's gravel");
        let mut pile = json!({ "stages": stages() });
        fill(&mut pile, &paper);
        let speeds = json!({ "rms_speed_mm_per_s": 5.0, "largest_speed_mm_per_s": 50.0 });
        assert_eq!(pile["settle"], speeds, "law: a pile is at rest when its last grain is");
    }

    #[test]
    fn what_is_filled_in_is_what_the_schema_calls_automatic() {
        // A load, for what follows from loads alone.
        let mut value = json!({
            "pieces": [{ "name": "lid", "shape": { "plate": { "size_mm": [500, 500, 10] } } }],
            "stages": stages(),
        });
        let press = json!({ "stage": "press", "loads": [{ "piece": "lid", "stress_kpa": 100 }] });
        value["stages"].as_array_mut().expect("stages").push(press);
        fill(&mut value, &larger());
        let schema = schema::typed();
        let parts = [
            ("EngineSettings", "engine"),
            ("NativeSettings", "engine.native"),
            ("RapierSettings", "engine.rapier"),
            ("SettleSpec", "settle"),
            ("CylinderSpec", "apparatus.cylinder"),
            ("FunnelSpec", "apparatus.funnel"),
            ("TopPlateSpec", "apparatus.top_plate"),
        ];
        let mut got = Vec::new();
        for (part, place) in parts {
            let filled = field(&value, &pointer(place));
            let filled = filled.as_object().expect(part).iter();
            for (name, _) in filled.filter(|(_, value)| value.is_number()) {
                got.push(format!("{place}.{name}"));
                let known = &schema["$defs"][part]["properties"][name];
                assert!(known["x-automatic"] == true, "law: the schema says so of {name}");
            }
        }
        let mut expected: Vec<&str> = automatic_paths().collect();
        got.sort_unstable();
        expected.sort_unstable();
        assert_eq!(got, expected, "law: fields that are filled in");
        for (stage, field, law, default) in fields_of_stages() {
            let mut value = json!({ "stages": [{ "stage": stage }] });
            let part = field.split_once('.');
            if let Some((part, _)) = part {
                fill(&mut value, &larger());
                assert!(value["stages"][0][part].is_null(), "law: no `{part}` where none is asked");
                value["stages"][0][part] = json!({});
            }
            fill(&mut value, &larger());
            let got = number_at(&value["stages"][0], field).unwrap_or(f64::NAN);
            let expected = default * law.factor(&larger().scale_for_filling(9.81));
            let differs = (got / expected - 1.0).abs();
            assert!(differs < 1e-12, "law: {field} of {stage}: expected {expected}, got {got}");
            let variants = schema["$defs"]["StageSpec"]["oneOf"].as_array().expect("stages");
            let of_stage = |v: &&Value| v["properties"]["stage"]["const"] == stage;
            let known = variants.iter().find(of_stage).expect("law: it is a stage");
            let properties = match part {
                None => &known["properties"],
                Some((part, _)) => {
                    let name = known["properties"][part]["$ref"].as_str().expect("a type");
                    &schema.pointer(name.trim_start_matches('#')).expect("a type")["properties"]
                }
            };
            let known = &properties[field.rsplit('.').next().unwrap_or(field)]["x-automatic"];
            assert!(*known == true, "law: the schema says so of {field} of {stage}");
        }
    }

    #[test]
    fn what_is_typed_stays() {
        let typed = json!({
            "gravity_m_per_s2": 1.62,
            "stages": stages(),
            "engine": { "rate_hz": 77, "native": { "contact_stiffness_n_per_m": 5 } },
            "apparatus": { "cylinder": { "inner_diameter_mm": 200 } },
        });
        let mut value = typed.clone();
        fill(&mut value, &larger());
        for pointer in [
            "/gravity_m_per_s2",
            "/engine/rate_hz",
            "/engine/native/contact_stiffness_n_per_m",
            "/apparatus/cylinder/inner_diameter_mm",
        ] {
            assert_eq!(value.pointer(pointer), typed.pointer(pointer), "law: {pointer} is kept");
        }
        let plate = number_at(&value, "apparatus.top_plate.diameter_mm").expect("a plate");
        assert!((plate - 196.5).abs() < 0.1, "law: the plate fits the typed cylinder, {plate} mm");
    }

    #[test]
    fn what_is_no_scenario_is_left_alone() {
        for odd in [
            json!(3),
            json!({ "engine": 7, "stages": "no", "apparatus": [] }),
            json!({ "gravity_m_per_s2": "strong" }),
            json!({ "gravity_m_per_s2": 0 }),
        ] {
            let mut value = odd.clone();
            fill(&mut value, &larger());
            assert_eq!(value.get("engine"), odd.get("engine"), "law: faults stay as they are");
        }
    }

    /// Law: what nobody typed is no fault.
    #[test]
    fn extreme_grains_are_filled_in_as_is_allowed() {
        for size in [1e-6, 1e-4, 1.0, 10.0] {
            for gravity in [1e-300, 0.01, 100.0] {
                let sizes = GrainSizes { smallest: size, median: size, largest: 1.5 * size };
                let solids = 1000.0 * size.powi(3);
                let grading = Grading { sizes, density: 3000.0, solids, count: 1000.0 };
                let mut value = json!({
                    "name": "a", "gravity_m_per_s2": gravity, "grains": { "file": "g.json" },
                    "stages": [{ "stage": "slow_pluviation", "base_diameter_mm": 5000 }],
                });
                fill(&mut value, &grading);
                let faults = super::super::structure::check(&value).faults;
                assert!(faults.is_empty(), "grains of {size} m under {gravity} m/s²: {faults:?}");
            }
        }
    }

    #[test]
    fn a_cycle_takes_whole_steps() {
        let mut value = json!({ "stages": [{ "stage": "vibrate", "frequency_hz": 3 }] });
        fill(&mut value, &larger());
        let rate = number_at(&value, "engine.rate_hz").expect("a rate");
        let law = 480.0 / 3_f64.sqrt();
        assert_eq!(rate % 3.0, 0.0, "law: whole steps in a cycle, {rate} Hz");
        assert!((law..law + 12.0).contains(&rate), "law: at least {law} Hz, got {rate}");
    }
}
