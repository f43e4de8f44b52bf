//! Scenarios that are loaded for their grains alone.

use std::fs;

use pluvia::grains::load_grains;
use pluvia::scenario::{GrainsSpec, Override, Scenario};
use serde_json::{Value, json};

use super::{folder, sound};
use crate::small;

/// A scenario with changes, loaded for its grains, or why not.
fn load(value: &Value, changes: &[&str]) -> Result<Scenario, String> {
    let folder = folder(&[("s.json", &value.to_string())]);
    let changes: Vec<Override> =
        changes.iter().map(|text| text.parse().expect("a change")).collect();
    let loaded = load_grains(&folder.path().join("s.json"), &changes);
    loaded.map(|loaded| loaded.scenario).map_err(|errors| errors.to_string())
}

/// Law: nothing beside the grains keeps them from being made, an old name neither; a field that no
/// scenario has does.
#[test]
fn grains_are_made_whatever_is_done_with_them() {
    let load = |fields: &Value| {
        let mut value = sound();
        small::put(&mut value, fields);
        load(&value, &[])
    };
    for ignored in [
        json!({ "control_s": 2 }),
        json!({ "rest_test_s": -1 }),
        json!({ "engine": { "contact_path": "manifold", "rate_hz": 1 } }),
        json!({ "stages": [{ "stage": "melt", "control_s": 2 }] }),
        json!({ "apparatus": { "cylinder": { "inner_diameter_mm": 1 } }, "contact": 5 }),
        json!({ "index_densities": { "e_max": 0.5, "e_min": 0.9 }, "gravity_m_per_s2": 0 }),
    ] {
        let said = load(&ignored).err();
        assert_eq!(said, None, "law: {ignored} does not matter for grains");
    }
    for (fault, words) in [
        (json!({ "grians": {} }), "did you mean `grains`"),
        (json!({ "grains": { "total_mass_g": 500 } }), "grains.sieve_table"),
    ] {
        let said = load(&fault).expect_err("law: refused");
        assert!(said.contains(words), "law: `{words}` is said of {fault}, got `{said}`");
    }
}

/// Law: grains have the values of changes; a change that they do not depend on is refused, since it
/// would do nothing.
#[test]
fn changes_of_grains_count_and_others_are_refused() {
    let changes = ["grains.total_mass_g=300", "grains.cells.flatness=2", "seed=7"];
    let scenario = load(&sound(), &changes).expect("law: grains are changed");
    let GrainsSpec::Sieved(sieved) = &scenario.grains else { panic!("sieved grains") };
    assert_eq!((sieved.total_mass_g, scenario.seed), (300.0, 7), "law: as typed");
    for change in [
        "engine.rate_hz=960",
        "engine . rate_hz=960",
        "stages.1.falling_height_mm=1",
        "rest_test_s=null",
        "configuration=2",
    ] {
        let said = load(&sound(), &[change, "seed=7"]).expect_err("law: refused");
        let words = "the grains do not depend on it";
        let is_named = said.starts_with(&format!("--set {change}: ")) && said.contains(words);
        assert!(is_named, "law: `{words}` is said of `{change}` alone, got `{said}`");
    }
    for (old, now) in [
        ("control_s=1", "rest_test_s"),
        ("engine.contact_path=manifold", "engine.contact_solver"),
        ("engine.manifold.sweeps=4", "engine.native.iterations"),
    ] {
        let said = load(&sound(), &[old]).expect_err("law: refused");
        let words = format!("this field is now called `{now}`; the grains do not depend on it");
        assert!(said.contains(&words), "law: `{words}` is said of `{old}`, got `{said}`");
    }
    let said = load(&sound(), &["grains.total_mas_g=1"]).expect_err("law: refused");
    assert!(said.contains("did you mean `total_mass_g`"), "law: a slip is one, got `{said}`");
}

/// Law: grains of every size that a scenario may have are made; sizes that nobody typed, of a cylinder
/// or of the engine, are not judged.
#[test]
fn what_follows_from_the_grains_does_not_keep_them_from_being_made() {
    for (passing, retained, mass) in [(5000.0, 4000.0, 1e9), (0.002, 0.001, 1e-9)] {
        let table =
            json!([{ "passing_mm": passing, "retained_mm": retained, "mass_percent": 100 }]);
        let mut value = sound();
        small::put(&mut value["grains"], &json!({ "total_mass_g": mass, "sieve_table": table }));
        let said = load(&value, &[]).err();
        assert_eq!(said, None, "law: grains of {retained} to {passing} mm");
    }
}

/// Law: it does not matter where a specimen is named that a scenario begins with: in the file or by a
/// change, its grains are found.
#[test]
fn grains_of_a_specimen_are_found_where_a_change_names_it() {
    let shape = json!({ "box": { "inner_mm": [100, 100, 100] } });
    let run = json!({
        "scenario": { "name": "run", "grains": sound()["grains"],
            "pieces": [{ "name": "box", "shape": shape }] },
        "stages": [{ "stage": "deposit", "key": "a", "specimen_sha256": "b" }]
    });
    let folder = folder(&[("manifest.json", &run.to_string()), ("grains.json", "{}")]);
    fs::create_dir(folder.path().join("stages")).expect("a store");
    let stages = json!([{ "stage": "rest", "duration_s": 1 }]);
    let change = format!("begin.specimen={}", folder.path().display());
    let scenario = load(&json!({ "name": "rests", "stages": stages }), &[&change]);
    let scenario = scenario.unwrap_or_else(|said| panic!("law: it loads, got {said}"));
    let GrainsSpec::Sieved(sieved) = &scenario.grains else { panic!("sieved grains") };
    assert_eq!(json!(sieved.total_mass_g), json!(500.0), "law: those of the run");
}
