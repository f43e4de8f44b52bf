//! Interpretations of the paper: settings that only stock Bullet contacts take, steps
//! that are coarse by leave, and the command that lays interpretations side by side.

use pluvia::scenario::{Scenario, check, warnings};
use serde_json::{Value, json};

use crate::{
    program::{Folder, assert_holds, done, refused},
    scenario::told,
    small,
};

fn scenario(engine: Value) -> Scenario {
    let mut value = small::scenario(40.0, 0.25, 0.1);
    value["engine"] = engine;
    // As often as its vibration asks for, so that no warning is of the samples.
    value["sample_interval_s"] = json!(0.02);
    serde_json::from_value(value).expect("a scenario")
}

fn faults(engine: Value) -> Vec<(String, String)> {
    told(check(&scenario(engine)))
}

#[test]
fn what_only_bullets_contacts_have_is_refused_elsewhere() {
    let settings = json!({
        "collision_margin_mm": 0.4, "inertia": "bounding_box", "least_mass_g": 1,
        "relative_contact_threshold": 0.02, "sleeping": true,
        "sleeping_speed_m_per_s": 0.4, "sleeping_spin_rad_per_s": 0.5
    });
    let names: Vec<&String> = settings.as_object().expect("an object").keys().collect();
    for engine in [
        json!({ "contact_solver": "native", "stock": settings }),
        json!({ "backend": "rapier", "stock": settings }),
    ] {
        let faults = faults(engine.clone());
        for name in &names {
            let path = format!("engine.stock.{name}");
            let found = faults.iter().find(|(p, _)| *p == path);
            let (_, text) = found.unwrap_or_else(|| panic!("{path} passes with {engine}"));
            assert!(text.contains("contact_solver"), "law: a fault says what to do: {text}");
        }
        assert_eq!(faults.len(), names.len(), "law: nothing else is wrong: {faults:?}");
    }
    let own = faults(json!({ "contact_solver": "stock", "stock": settings }));
    assert!(own.is_empty(), "law: stock Bullet contacts take them all: {own:?}");
    let none = faults(json!({ "contact_solver": "native", "stock": {} }));
    assert!(none.is_empty(), "law: the defaults are taken everywhere: {none:?}");
}

#[test]
fn coarse_steps_are_refused_or_a_warning() {
    let coarse = json!({ "contact_solver": "stock", "rate_hz": 130 });
    let refused = faults(coarse.clone());
    assert!(refused.iter().any(|(path, _)| path == "engine.rate_hz"), "refused: {refused:?}");
    assert!(warnings(&scenario(coarse.clone())).is_empty(), "law: no leave, no warning");
    let mut let_pass = coarse;
    let_pass["allow_coarse_steps"] = json!(true);
    assert_eq!(faults(let_pass.clone()), [], "law: by leave they pass");
    let found: Vec<String> =
        warnings(&scenario(let_pass.clone())).iter().map(ToString::to_string).collect();
    assert_eq!(found.len(), refused.len(), "law: each fault becomes a warning: {found:?}");
    assert!(found.iter().any(|w| w.contains("cannot resolve the motion")), "{found:?}");
    let_pass["rate_hz"] = json!(1000);
    assert!(warnings(&scenario(let_pass)).is_empty(), "law: fine steps are not warned of");
}

#[test]
fn wrong_names_are_refused_with_the_allowed_ones() {
    for args in [
        ["interpretations", "--only", "converged,blender"],
        ["reproduce", "--interpretation", "blender"],
    ] {
        let names = ["`blender`", "converged", "per_body", "bullet_stock", "blender_2014_mm"];
        refused(&args, 2, &names);
    }
    let twice = ["interpretations", "--only", "converged,per_body,converged"];
    refused(&twice, 2, &["--only names converged twice"]);
}

#[test]
#[ignore = "slow: make test-all"]
fn interpretations_of_one_programme_accumulate() {
    let folder = Folder::new();
    let out = folder.out("");
    let run = |only: &str, more: &[&str]| {
        let args = ["interpretations", "--quick", "--jobs", "1", "--out", &out, "--only", only];
        let small = ["--set", "grains.total_mass_g=40", "--set", "rest_test_s=0.2"];
        done(&[&args[..], &small, more].concat())
    };
    run("converged", &[]);
    let text = run("blender_2014_cm,per_body", &[]);
    // Earlier interpretations stay.
    assert_holds(&text, &["converged", "blender_2014_cm", "per_body"]);
    let json = folder.json("interpretations.json");
    let names: Vec<&str> = json["interpretations"]
        .as_array()
        .expect("a list")
        .iter()
        .filter_map(|r| r["name"].as_str())
        .collect();
    assert_eq!(
        names,
        ["converged", "per_body", "blender_2014_cm"],
        "in the order of the interpretations"
    );
    let warned = |n: usize| json["interpretations"][n]["warnings"].as_array().map_or(0, Vec::len);
    assert_eq!((warned(0), warned(2) > 0), (0, true), "coarse steps are reported: {json}");
    let run_of = "runs/pluviation-c1-fh000-interpretation-blender-2014-cm";
    let summary = folder.text(&format!("{run_of}/summary.json"));
    assert!(summary.contains("allow_coarse_steps"), "and kept in the summary: {summary}");
    let manifest = folder.json(&format!("{run_of}/manifest.json"));
    let held = &manifest["engine_settings_read_back"];
    assert_eq!(held["sleeping"], 1.0, "read back: {held}");
    for file in ["interpretations.md", "interpretations.html"] {
        assert_holds(&folder.text(file), &["blender_2014_cm"]);
    }
    // Its runs are read as those of any study, also those of an earlier interpretation.
    for name in ["converged", "per-body"] {
        let of = folder.out(&format!("runs/pluviation-c1-fh000-interpretation-{name}"));
        done(&["export", &of, "--format", "csv", "--out", &folder.out(&format!("csv-{name}"))]);
        let grains = folder.text(&format!("csv-{name}/grains.csv"));
        let rows = grains.lines().skip(1).count();
        assert!(rows > 5, "law: {name}: all grains are exported, got {rows}: {grains}");
    }
    // Its few grains went through the floor: it has no heights, and the page says so.
    let figure = folder.text("figures/interpretations-standing-height.svg");
    assert!(figure.contains("per_body"), "law: an interpretation with heights has a line");
    let without = "No run gives a curve of: blender_2014_cm";
    assert_holds(&folder.text("interpretations.html"), &[without]);

    // Another gravity is another programme.
    let text = run("full_stroke", &["--set", "gravity_m_per_s2=9.8"]);
    assert!(text.contains("full_stroke"), "another programme has a table of its own: {text}");
    assert!(!text.contains("per_body"), "law: other programmes do not stand beside: {text}");
}
