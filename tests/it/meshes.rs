//! Grains from meshes as a user meets them: the example, and faulty files.

use std::fs;

use serde_json::{Value, json};

use crate::{
    near::near,
    program::{Folder, assert_holds, done, refused},
};

const EXAMPLE: &str = "scenarios/meshes/stones.json";

#[test]
fn the_example_of_stones_makes_grains_and_runs() {
    let folder = Folder::new();
    let grains = |args: &[&str], name: &str| -> Value {
        let out = folder.out(name);
        let args = [&["grains", "--json", "--quiet", "--out", &out][..], args].concat();
        serde_json::from_str(&done(&args)).expect("JSON")
    };
    let made_json = grains(&[EXAMPLE, "--format", "obj"], "grains");
    let mass = made_json["mass_g"].as_f64().expect("a number");
    near("total mass, g", mass, 120.0, 1e-9);
    let stones = folder.text("grains/stones.csv");
    assert_eq!(stones.lines().count(), 7, "a head and six meshes");
    let sieve = folder.text("grains/sieve.csv");
    for (row, expected) in sieve.lines().skip(1).zip([48.0, 72.0]) {
        let mass: f64 = row.split(',').nth(7).and_then(|m| m.parse().ok()).expect("a mass");
        near("mass on a sieve, g", mass, expected, 1e-4);
    }

    // What was written as meshes are the same grains as meshes.
    let again = json!({
        "name": "again",
        "grains": { "meshes": ["grains/*.obj"], "mesh_unit": "m", "density_kg_per_m3": 2650 },
        "stages": [{ "stage": "fill_funnel" }],
    });
    let back = grains(&[&folder.scenario("again.json", &again)], "twice");
    assert_eq!(back["grains"], made_json["grains"], "as many grains as were written");
    let mass = back["mass_g"].as_f64().expect("a number");
    near("mass read back, g", mass, 120.0, 1e-9);
    assert_eq!(back["notes"], json!([]), "convex as they are");
    assert_eq!(back["sieve_analysis"]["specified"], Value::Null, "law: no sieve table, none said");

    done(&["run", EXAMPLE, "--quiet", "--no-figures", "--out", &folder.out("run")]);
    let summary = folder.json("run/summary.json");
    assert_eq!(summary["grains"]["count"], made_json["grains"], "the same grains are poured");
    assert_eq!(summary["grains"]["escaped"], 0, "none through a wall");
    let inside = summary["grains"]["in_cylinder"].as_u64().expect("a number");
    assert!(inside >= 30, "most of some forty lie in the cylinder, got {inside}");
    assert_eq!(folder.text("run/stones.csv"), stones, "the same meshes");
}

#[test]
fn faulty_meshes_end_with_2_and_missing_ones_with_4() {
    let folder = Folder::new();
    let scenario = |meshes: &[&str]| {
        let scenario = json!({
            "name": "faulty",
            "grains": { "meshes": meshes, "mesh_unit": "mm", "density_kg_per_m3": 2650 },
            "stages": [{ "stage": "fill_funnel" }],
        });
        folder.scenario("s.json", &scenario)
    };
    fs::write(folder.path("a.stl"), "").expect("a file");
    fs::write(folder.path("b.obj"), "v 0 0 0\nf 1 2 3\n").expect("a file");
    let out = folder.out("out");
    for command in ["grains", "run"] {
        let path = scenario(&["a.stl", "b.obj", "c.ply"]);
        let words = ["a.stl", "the file is empty", "b.obj", "line 2", "c.ply", "cannot be read"];
        let err = refused(&[command, &path, "--quiet", "--out", &out], 2, &words);
        assert!(!err.contains("panicked"), "{command}: {err}");
    }
    // A file that is not there.
    refused(&["grains", &scenario(&["c.ply"]), "--quiet", "--out", &out], 4, &["c.ply"]);
}

#[test]
fn fields_that_do_not_go_together_are_told() {
    let folder = Folder::new();
    let faults = |grains: Value| {
        let stages = json!([{ "stage": "fill_funnel" }]);
        let scenario = json!({ "name": "s", "grains": grains, "stages": stages });
        let path = folder.scenario("s.json", &scenario);
        let loaded = pluvia::grains::load_scenario(path.as_ref(), &[]);
        loaded.err().map_or_else(String::new, |error| error.to_string())
    };
    let table = json!([{ "passing_mm": 16, "retained_mm": 8, "mass_percent": 100 }]);
    let base = json!({ "meshes": ["a.stl"], "mesh_unit": "mm", "density_kg_per_m3": 2650 });
    let with = |fields: Value| {
        let mut grains = base.clone();
        for (field, value) in fields.as_object().expect("an object") {
            grains[field] = value.clone();
        }
        faults(grains)
    };
    assert_eq!(with(json!({})), "", "sound");
    assert_eq!(with(json!({ "sieve_table": table, "total_mass_g": 500 })), "", "sound");
    assert_eq!(with(json!({ "count": 20, "hull": true })), "", "sound");
    for (fields, words) in [
        (json!({ "sieve_table": table }), "grains.total_mass_g: the field is missing"),
        (json!({ "total_mass_g": 500 }), "keep their own mass"),
        (json!({ "sieve_table": table, "total_mass_g": 500, "count": 3 }), "grains.count"),
        (json!({ "mesh_unit": "feet" }), "\"mm\""),
        (json!({ "mesh_unit": null }), "grains.mesh_unit"),
        (json!({ "meshes": [] }), "grains.meshes: the list is too short"),
        (json!({ "largest_vertex_count": 3 }), "at least 8"),
        (json!({ "hul": true }), "did you mean `hull`?"),
    ] {
        let said = with(fields.clone());
        assert!(said.contains(words), "{fields}: `{words}` is missing in: {said}");
    }
    let mut table = table.clone();
    table[0]["mass_percent"] = json!(60);
    let said = with(json!({ "sieve_table": table, "total_mass_g": 500 }));
    assert!(said.contains("do not add up"), "a sieve table is checked as any other: {said}");
    let cells = json!({ "total_mass_g": 500, "density_kg_per_m3": 2650,
        "sieve_table": [{ "passing_mm": 16, "retained_mm": 8, "mass_percent": 100 }],
        "cells": { "elongation": 0.5, "relaxation": 3 } });
    let words = ["grains.cells.elongation", "at least 1", "`relaxation_steps`"];
    assert_holds(&faults(cells), &words);
}
