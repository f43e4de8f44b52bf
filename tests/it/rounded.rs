//! Rounded polyhedra as a user meets them: grains, a run on every engine, exports, and faults.

use std::{fs, path::Path};

use assert_cmd::Command;
use serde_json::{Value, json};

/// Runs the program; gives its exit code, standard output and standard error.
fn run(args: &[&str]) -> (Option<i32>, String, String) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_pluvia"));
    command.current_dir(env!("CARGO_MANIFEST_DIR"));
    let output = command.args(args).output().expect("the program starts");
    let text = |bytes| String::from_utf8(bytes).expect("UTF-8");
    (output.status.code(), text(output.stdout), text(output.stderr))
}

fn done(args: &[&str]) -> String {
    let (code, text, err) = run(args);
    assert_eq!(code, Some(0), "law: {args:?} ends well: {err}");
    text
}

fn read_json(folder: &Path, name: &str) -> Value {
    let text = fs::read_to_string(folder.join(name)).unwrap_or_else(|e| panic!("{name}: {e}"));
    serde_json::from_str(&text).expect("JSON")
}

/// Some 200 grains in a cylinder of eight.
fn gravel(rounding: f64) -> Value {
    json!({
        "name": "gravel",
        "grains": {
            "total_mass_g": 200, "density_kg_per_m3": 2650,
            "sieve_table": [{ "passing_mm": 10, "retained_mm": 8, "mass_percent": 100 }],
            "cells": { "relaxation_steps": 5, "rounding": rounding }
        },
        "contact": { "grain_grain_friction": 0.5, "grain_wall_friction": 0.3, "restitution": 0.3 },
        "apparatus": {
            "cylinder": { "inner_diameter_mm": 75, "height_mm": 120 },
            "funnel": { "opening_diameter_mm": 65, "top_diameter_mm": 160 }
        },
        "stages": [
            { "stage": "fill_funnel", "time_limit_s": 1.5 },
            { "stage": "pour", "falling_height_mm": 20, "time_limit_s": 2.5 }
        ],
        "rest_test_s": 0.5
    })
}

/// Law: no grain passes a wall or changes, whatever the engine; poured grains fill 0.45 to 0.68 of
/// their room; grains from their file are the same to the bit.
#[test]
fn rounded_grains_pour_settle_and_are_exported() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let out = |name: &str| folder.path().join(name).to_str().expect("UTF-8").to_owned();
    fs::write(folder.path().join("gravel.json"), gravel(0.4).to_string()).expect("a file");
    let scenario = out("gravel.json");

    let made = done(&["grains", &scenario, "--json", "--quiet", "--out", &out("made")]);
    let made: Value = serde_json::from_str(&made).expect("JSON");
    let mass = made["mass_g"].as_f64().expect("a number");
    assert!((mass - 200.0).abs() < 1e-6, "law: total mass 200 g, got {mass}");
    for at in ["p10", "p50", "p90"] {
        let round = made["shape"]["roundness"][at].as_f64().expect("a number");
        assert!((round - 0.4).abs() < 1e-4, "law: roundness 0.4 is Wadell's, got {round}");
    }

    for (name, settings) in [
        ("native", &[][..]),
        ("stock", &["--set", "engine.contact_solver=stock"][..]),
        ("rapier", &["--set", "engine.backend=rapier"][..]),
    ] {
        if name == "rapier" && !cfg!(feature = "rapier") {
            continue;
        }
        let ran = out(name);
        let mut args = vec!["run", &scenario, "--quiet", "--out", &ran];
        args.extend(settings);
        done(&args);
        let summary = read_json(&folder.path().join(name), "summary.json");
        let grains = &summary["grains"];
        assert_eq!(grains["count"], made["grains"], "law: the same grains are poured");
        assert_eq!(grains["escaped"], 0, "{name}, law: none passes a wall");
        let e = summary["void_ratio"].as_f64().expect("a void ratio");
        let solid = 1.0 / (1.0 + e);
        println!("{name}: solid fraction {solid:.4}, {grains}");
        assert!((0.45..0.68).contains(&solid), "{name}, law: solid fraction, got {solid}");
        let sieved = &summary["sieve_analysis"]["secondary"];
        assert_eq!(sieved["unchanged"], true, "{name}, law: no grain changes: {sieved}");
    }

    let native = out("native");
    for format in ["vtk", "glb", "stl", "ply", "obj", "json", "csv"] {
        let to = out(format);
        done(&["export", &native, "--format", format, "--quiet", "--out", &to]);
    }
    let text = read_json(&folder.path().join("json"), "scene.json").to_string();
    assert!(text.contains("rounded_m") && text.contains("vertices_m"), "law: both are handed on");
    let picture = out("gravel.png");
    done(&["picture", &native, "--width", "200", "--quiet", "--out", &picture]);
    let picture = out("grains.png");
    done(&["picture", &native, "--grains", "--width", "200", "--quiet", "--out", &picture]);

    // From their file, the same grains.
    let mut again = gravel(0.4);
    again["grains"] = json!({ "file": out("made/grains.json") });
    fs::write(folder.path().join("again.json"), again.to_string()).expect("a file");
    done(&["grains", &out("again.json"), "--quiet", "--out", &out("again")]);
    let text =
        |folder: &str| fs::read(Path::new(&out(folder)).join("grains.json")).expect("grains");
    assert!(text("made") == text("again"), "law: grains.json comes back bit by bit");
}

/// Law: a roundness of 0 is no roundness: the same grains to the bit, in the same files.
#[test]
fn no_rounding_changes_nothing() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let out = |name: &str| folder.path().join(name).to_str().expect("UTF-8").to_owned();
    let mut without = gravel(0.0);
    without["grains"]["cells"].as_object_mut().expect("cells").remove("rounding");
    for (name, scenario) in [("with", gravel(0.0)), ("without", without)] {
        let path = out(&format!("{name}.json"));
        fs::write(&path, scenario.to_string()).expect("a file");
        done(&["grains", &path, "--quiet", "--out", &out(name)]);
    }
    let text =
        |folder: &str| fs::read(Path::new(&out(folder)).join("grains.json")).expect("grains");
    assert!(text("with") == text("without"), "law: the same bits");
    assert!(!String::from_utf8(text("with")).expect("UTF-8").contains("radius_m"), "law: sharp");
}

#[test]
fn what_cannot_be_rounded_is_refused() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("s.json");
    for (value, words) in [
        (json!(-0.1), "grains.cells.rounding"),
        (json!(0.95), "grains.cells.rounding"),
        (json!(0.001), "0, or 0.01 to 0.9"),
        (json!("round"), "rounding"),
    ] {
        let mut scenario = gravel(0.0);
        scenario["grains"]["cells"]["rounding"] = value;
        fs::write(&path, scenario.to_string()).expect("a file");
        let out = folder.path().join("out");
        let args = ["run", path.to_str().expect("UTF-8"), "--quiet", "--out"];
        let (code, _, err) = run(&[&args[..], &[out.to_str().expect("UTF-8")]].concat());
        assert_eq!(code, Some(2), "law: refused: {err}");
        assert!(err.contains(words), "law: it says `{words}`, got {err}");
    }
    let mut scenario = gravel(0.3);
    scenario["grains"]["shape"] = json!("spheres");
    fs::write(&path, scenario.to_string()).expect("a file");
    let out = folder.path().join("out");
    let args = ["run", path.to_str().expect("UTF-8"), "--quiet", "--out"];
    let (code, _, err) = run(&[&args[..], &[out.to_str().expect("UTF-8")]].concat());
    assert_eq!(code, Some(2), "law: spheres are round already: {err}");
    assert!(err.contains("spheres are cut from no cells"), "law: it says so, got {err}");
}
