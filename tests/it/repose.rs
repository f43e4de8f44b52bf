//! Scenarios of piles: what they may say, and what is answered where they cannot.

use pluvia::grains::load_scenario;
use pluvia::scenario::{BaseKind, Override, Scenario, StageSpec, check};
use serde_json::{Value, json};

use super::{
    scenario::{assert_told, told_of as faults},
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
    let StageSpec::SlowPluviation { base, time_limit_s, .. } = &scenario.stages[0] else {
        panic!("{:?}", scenario.stages)
    };
    assert_eq!((base.kind, base.friction), (BaseKind::FixedGrains, None), "the default base");
    assert!(*time_limit_s > 0.0);
    check(&scenario).expect("sound as a value, too");
    let mut rests = sound();
    rests["stages"] = json!([rests["stages"][0], { "stage": "rest", "duration_s": 1 }]);
    assert_eq!(faults(&rests), [], "a pile may rest");
}

#[test]
fn faults_of_a_pile_name_field_and_what_is_allowed() {
    let stage = |change: Value| {
        let mut value = sound();
        small::put(&mut value["stages"][0], &change);
        value
    };
    let cases = [
        (json!({ "base": { "kind": "plane" } }), "stages[0].base.friction", "needs its friction"),
        (
            json!({ "base": { "kind": "fixed_grains", "friction": 0.5 } }),
            "stages[0].base.friction",
            "grain_grain_friction",
        ),
        (json!({ "base": { "kind": "sand" } }), "stages[0].base.kind", "fixed_grains"),
        (
            json!({ "base": { "kind": "plane", "friction": -1 } }),
            "stages[0].base.friction",
            "at least 0",
        ),
        (json!({ "base": { "kind": "plane", "fricton": 1 } }), "", "friction"),
        (json!({ "base_diameter_mm": 10 }), "stages[0].base_diameter_mm", "more than the spout"),
        (json!({ "feed_rate_grains_per_s": 0 }), "stages[0].feed_rate_grains_per_s", "above 0"),
        (json!({ "time_limit_s": 1 }), "stages[0].time_limit_s", "all grains have been fed"),
        (json!({ "funnel": 1 }), "stages[0].funnel", "no such field"),
    ];
    for (change, path, words) in cases {
        let found = faults(&stage(change.clone()));
        let told =
            found.iter().any(|(p, text)| (path.is_empty() || p == path) && text.contains(words));
        assert!(told, "{change}: expected `{path}` with “{words}”, got {found:?}");
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
    let StageSpec::SlowPluviation { feed_rate_grains_per_s, .. } = scenario.stages[0] else {
        panic!("{:?}", scenario.stages)
    };
    assert_eq!(feed_rate_grains_per_s, 12.5);
}
