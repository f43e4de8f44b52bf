//! Scenarios of piles: what they may say, and what is answered where they cannot.

use pluvia::grains::load_scenario;
use pluvia::scenario::{BaseKind, Override, Scenario, StageSpec, check};
use serde_json::{Value, json};

use super::{
    scenario::{assert_told, changed, told_of as faults},
    small,
};

fn sound() -> Value {
    json!({
        "name": "pile",
        "grains": small::gravel(100.0),
        "stages": [{ "stage": "slow_pluviation", "base_diameter_mm": 200 }]
    })
}

#[test]
fn a_pile_needs_no_apparatus_and_little_else() {
    assert_eq!(faults(&sound()), [], "a base and grains are enough");
    let scenario: Scenario = serde_json::from_value(sound()).expect("a scenario");
    let StageSpec::SlowPluviation(pile) = &scenario.stages[0] else {
        panic!("{:?}", scenario.stages)
    };
    let base = &pile.base;
    assert_eq!((base.kind, base.friction), (BaseKind::FixedGrains, None), "the default base");
    assert!(pile.time_limit_s > 0.0);
    check(&scenario).expect("sound as a value, too");
    let mut rests = sound();
    rests["stages"] = json!([rests["stages"][0], { "stage": "rest", "duration_s": 1 }]);
    assert_eq!(faults(&rests), [], "a pile may rest");
    // Of a scenario that it extends, say.
    let narrow = json!({ "cylinder": { "inner_diameter_mm": 25 },
        "funnel": { "opening_diameter_mm": 12 } });
    let beside = changed(sound(), "apparatus", narrow);
    assert_eq!(faults(&beside), [], "law: no grain comes into cylinder and funnel");
    let filled = changed(beside, "stages[0]", json!({ "stage": "fill_funnel" }));
    for path in ["apparatus.cylinder.inner_diameter_mm", "apparatus.funnel.opening_diameter_mm"] {
        assert_told(&faults(&filled), path, "grain");
    }
}

#[test]
fn faults_of_a_pile_name_field_and_what_is_allowed() {
    let held = json!({ "kind": "fixed_grains", "friction": 0.5 });
    for (field, to, path, words) in [
        ("base", json!({ "kind": "plane" }), "base.friction", "needs its friction"),
        ("base", held, "base.friction", "grain_grain_friction"),
        ("base", json!({ "kind": "sand" }), "base.kind", "fixed_grains"),
        ("base", json!({ "kind": "plane", "friction": -1 }), "base.friction", "at least 0"),
        ("base", json!({ "kind": "plane", "fricton": 1 }), "base.fricton", "friction"),
        ("base_diameter_mm", json!(10), "base_diameter_mm", "more than the spout"),
        ("feed_rate_grains_per_s", json!(0), "feed_rate_grains_per_s", "above 0"),
        ("time_limit_s", json!(1), "time_limit_s", "all grains have been fed"),
        ("funnel", json!(1), "funnel", "no such field"),
    ] {
        let value = changed(sound(), &format!("stages[0].{field}"), to);
        assert_told(&faults(&value), &format!("stages[0].{path}"), words);
    }
}

#[test]
fn a_pile_comes_first_and_only_rests_afterwards() {
    let named = |name: &str| match name {
        "slow_pluviation" => json!({ "stage": name, "base_diameter_mm": 200 }),
        "pour" => json!({ "stage": name, "falling_height_mm": 50 }),
        "rest" => json!({ "stage": name, "duration_s": 1 }),
        _ => json!({ "stage": name }),
    };
    for (stages, index) in [
        (["fill_funnel", "slow_pluviation"], 1),
        (["rest", "slow_pluviation"], 0),
        (["slow_pluviation", "slow_pluviation"], 1),
        (["slow_pluviation", "fill_funnel"], 1),
        (["slow_pluviation", "place_top_plate"], 1),
        (["slow_pluviation", "pour"], 1),
    ] {
        let mut value = sound();
        value["stages"] = stages.iter().map(|s| named(s)).collect();
        assert_told(&faults(&value), &format!("stages[{index}].stage"), "");
    }
}

#[test]
fn fields_of_the_pile_can_be_set_from_outside() {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/scenarios/quick/repose.json");
    let set: Override = "stages.0.feed_rate_grains_per_s=12.5".parse().expect("an override");
    let scenario = load_scenario(file.as_ref(), &[set]).expect("the quick pile").scenario;
    let StageSpec::SlowPluviation(pile) = &scenario.stages[0] else {
        panic!("{:?}", scenario.stages)
    };
    assert_eq!(pile.feed_rate_grains_per_s, 12.5);
}
