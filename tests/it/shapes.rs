//! Spheres and rounded polyhedra as a user meets them: grains, a run on every engine, exports, and
//! faults.

use serde_json::{Value, json};

use crate::program::{Folder, done, run};

/// Some 200 grams in a cylinder of some ten grains.
fn scenario(name: &str, grains: Value, opening_mm: f64, friction: f64, restitution: f64) -> Value {
    json!({
        "name": name,
        "grains": grains,
        "contact": {
            "grain_grain_friction": friction, "grain_wall_friction": 0.3, "restitution": restitution
        },
        "apparatus": {
            "cylinder": { "inner_diameter_mm": 75, "height_mm": 120 },
            "funnel": { "opening_diameter_mm": opening_mm, "top_diameter_mm": 160 }
        },
        "stages": [
            { "stage": "fill_funnel", "time_limit_s": 1.5 },
            { "stage": "pour", "falling_height_mm": 20, "time_limit_s": 2.5 }
        ],
        "rest_test_s": 0.5
    })
}

/// Some 380 beads.
fn beads() -> Value {
    let grains = json!({
        "shape": "spheres", "total_mass_g": 200, "density_kg_per_m3": 2500,
        "sieve_table": [{ "passing_mm": 8, "retained_mm": 7, "mass_percent": 100 }]
    });
    scenario("beads", grains, 60.0, 0.3, 0.5)
}

/// Some 200 grains.
fn gravel(rounding: f64) -> Value {
    let grains = json!({
        "total_mass_g": 200, "density_kg_per_m3": 2650,
        "sieve_table": [{ "passing_mm": 10, "retained_mm": 8, "mass_percent": 100 }],
        "cells": { "relaxation_steps": 5, "rounding": rounding }
    });
    scenario("gravel", grains, 65.0, 0.5, 0.3)
}

/// Makes the grains of a scenario, pours them by every engine, exports and draws the run, and takes
/// the grains from their file. Gives what `pluvia grains` says of them.
///
/// Law: no grain passes a wall or changes, whatever the engine; poured grains fill a share of their
/// room between these ends; grains from their file are the same to the bit.
fn pour_and_export(folder: &Folder, scenario: &Value, solid: [f64; 2], in_scene: &str) -> Value {
    let out = |name: &str| folder.out(name);
    let path = folder.scenario("scenario.json", scenario);
    let made = done(&["grains", &path, "--json", "--quiet", "--out", &out("made")]);
    let made: Value = serde_json::from_str(&made).expect("JSON");
    let mass = made["mass_g"].as_f64().expect("a number");
    assert!((mass - 200.0).abs() < 1e-6, "law: total mass 200 g, got {mass}");

    for (name, settings) in [
        ("native", &[][..]),
        ("stock", &["--set", "engine.contact_solver=stock"][..]),
        ("rapier", &["--set", "engine.backend=rapier"][..]),
    ] {
        if name == "rapier" && !cfg!(feature = "rapier") {
            continue;
        }
        let ran = out(name);
        done(&[&["run", &path, "--quiet", "--no-figures", "--out", &ran][..], settings].concat());
        let summary = folder.json(&format!("{name}/summary.json"));
        let grains = &summary["grains"];
        assert_eq!(grains["count"], made["grains"], "law: the same grains are poured");
        assert_eq!(grains["escaped"], 0, "{name}, law: none passes a wall");
        let got = 1.0 / (1.0 + summary["void_ratio"].as_f64().expect("a void ratio"));
        println!("{name}: solid fraction {got:.4}, {grains}");
        let [low, high] = solid;
        assert!(
            (low..high).contains(&got),
            "{name}, law: solid fraction from {low} to {high}, got {got}"
        );
        let sieved = &summary["sieve_analysis"]["secondary"];
        assert_eq!(sieved["unchanged"], true, "{name}, law: no grain changes: {sieved}");
    }

    let native = out("native");
    for format in ["vtk", "glb", "stl", "ply", "obj", "json", "csv"] {
        done(&["export", &native, "--format", format, "--quiet", "--out", &out(format)]);
    }
    let scene = folder.json("json/scene.json").to_string();
    assert!(scene.contains(in_scene) && scene.contains("vertices_m"), "law: both are handed on");
    for (file, more) in [("run.png", &[][..]), ("grains.png", &["--grains"][..])] {
        let to = out(file);
        let args = ["picture", &native, "--width", "200", "--quiet", "--out", &to];
        done(&[&args[..], more].concat());
    }

    let mut again = scenario.clone();
    again["grains"] = json!({ "file": out("made/grains.json") });
    let path = folder.scenario("again.json", &again);
    done(&["grains", &path, "--quiet", "--out", &out("again")]);
    assert!(
        folder.bytes("made/grains.json") == folder.bytes("again/grains.json"),
        "law: grains.json comes back bit by bit"
    );
    made
}

/// Random loose to dense packing of spheres with friction is 0.55 to 0.64, less what is lost along
/// the walls of a narrow cylinder.
#[test]
#[ignore = "slow: make test-all"]
fn beads_pour_settle_and_are_exported() {
    let made = pour_and_export(&Folder::new(), &beads(), [0.52, 0.66], "sphere_m");
    let round = made["shape"]["sphericity"]["p50"].as_f64().expect("a number");
    assert!((round - 1.0).abs() < 1e-12, "law: a sphere has sphericity 1, got {round}");
}

#[test]
#[ignore = "slow: make test-all"]
fn rounded_grains_pour_settle_and_are_exported() {
    let made = pour_and_export(&Folder::new(), &gravel(0.4), [0.45, 0.68], "rounded_m");
    for at in ["p10", "p50", "p90"] {
        let round = made["shape"]["roundness"][at].as_f64().expect("a number");
        assert!((round - 0.4).abs() < 1e-4, "law: roundness 0.4 is Wadell's, got {round}");
    }
}

/// Law: a roundness of 0 is no roundness: the same grains to the bit, in the same files.
#[test]
fn no_rounding_changes_nothing() {
    let folder = Folder::new();
    let mut without = gravel(0.0);
    without["grains"]["cells"].as_object_mut().expect("cells").remove("rounding");
    for (name, scenario) in [("with", gravel(0.0)), ("without", without)] {
        let path = folder.scenario(&format!("{name}.json"), &scenario);
        done(&["grains", &path, "--quiet", "--out", &folder.out(name)]);
    }
    let [with, without] = ["with", "without"].map(|of| folder.bytes(&format!("{of}/grains.json")));
    assert!(with == without, "law: the same bits");
    assert!(!String::from_utf8(with).expect("UTF-8").contains("radius_m"), "law: sharp");
}

/// Runs a command that must be refused with these words.
fn refused(command: &str, scenario: &Value, words: &str) {
    let folder = Folder::new();
    let path = folder.scenario("s.json", scenario);
    let (code, _, err) = run(&[command, &path, "--quiet", "--out", &folder.out("out")]);
    assert_eq!(code, Some(2), "law: {words}: refused: {err}");
    assert!(err.contains(words), "law: it says `{words}`, got {err}");
}

#[test]
fn what_cannot_be_rounded_is_refused() {
    for (value, words) in [
        (json!(-0.1), "grains.cells.rounding"),
        (json!(0.95), "grains.cells.rounding"),
        (json!(0.001), "0, or 0.01 to 0.9"),
        (json!("round"), "rounding"),
    ] {
        let mut scenario = gravel(0.0);
        scenario["grains"]["cells"]["rounding"] = value;
        refused("run", &scenario, words);
    }
    let mut scenario = gravel(0.3);
    scenario["grains"]["shape"] = json!("spheres");
    refused("run", &scenario, "spheres are cut from no cells");
}

#[test]
fn what_does_not_go_with_spheres_is_refused() {
    for (field, value, words) in [
        ("cells", json!({ "relaxation_steps": 3 }), "spheres are cut from no cells"),
        ("shape", json!("balls"), "\"spheres\""),
        ("shape", json!(3), "grains.shape"),
        ("largest_vertex_count", json!(64), "largest_vertex_count"),
    ] {
        let mut scenario = beads();
        scenario["grains"][field] = value;
        refused("run", &scenario, words);
    }
    let mut scenario = beads();
    // More than one of 0.66 g, less than two.
    scenario["grains"]["sieve_table"][0]["retained_mm"] = json!(7.9);
    scenario["grains"]["total_mass_g"] = json!(0.9);
    refused("grains", &scenario, "no whole number of spheres");
}
