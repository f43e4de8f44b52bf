//! Two engines on the same grains and the same specimen.

use std::{fs, path::Path, process::Command};

use serde_json::{Value, json};

use super::small;

/// Thirty grams of gravel, poured and shaken for a moment.
fn write_scenario(folder: &Path) -> std::path::PathBuf {
    let path = folder.join("small.json");
    let scenario = small::scenario(30.0, 0.25, 0.2);
    fs::write(&path, scenario.to_string()).expect("a scenario file");
    path
}

fn compare(scenario: &Path, backends: &str, out: &Path) -> std::process::Output {
    Command::new(env!("CARGO_BIN_EXE_pluvia"))
        .args(["compare", "--quiet", "--json", "--backends", backends, "--out"])
        .arg(out)
        .arg(scenario)
        .output()
        .expect("the program starts")
}

#[test]
fn engines_get_the_same_grains_and_the_specimen_is_handed_on() {
    if !cfg!(feature = "rapier") {
        return;
    }
    let folder = tempfile::tempdir().expect("a folder");
    let scenario = write_scenario(folder.path());
    let out = folder.path().join("out");
    let output = compare(&scenario, "bullet,rapier", &out);
    let code = output.status.code();
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(matches!(code, Some(0 | 1)), "done, with or without agreement, got {code:?}: {said}");
    let record: Value =
        serde_json::from_slice(&output.stdout).expect("JSON on the standard output");
    let written = fs::read(out.join("compare.json")).expect("compare.json");
    let written: Value = serde_json::from_slice(&written).expect("JSON");
    assert_eq!(record["runs"], written["runs"], "what is printed is what is written");
    assert_eq!(code == Some(0), record["within_bands"] == json!(true), "the exit code says so");
    let names: Vec<&str> = record["runs"]
        .as_array()
        .expect("runs")
        .iter()
        .filter_map(|r| r["name"].as_str())
        .collect();
    assert_eq!(names, ["bullet", "rapier", "rapier-from-bullet-specimen"]);

    // The handed specimen: the rows before the vibration are Bullet's own.
    let heights = |run: &str| -> Vec<String> {
        let text =
            fs::read_to_string(out.join("runs").join(run).join("series.csv")).expect("a series");
        let mut rows = csv_rows(&text);
        let stage = rows[0].iter().position(|h| h == "stage").expect("a column for the stage");
        let height =
            rows[0].iter().position(|h| h == "mean_grain_height_mm").expect("a column for it");
        rows.remove(0);
        rows.into_iter().filter(|r| r[stage] != "3").map(|r| r[height].clone()).collect()
    };
    let (own, handed, other) =
        (heights("bullet"), heights("rapier-from-bullet-specimen"), heights("rapier"));
    assert!(own == handed, "law: the handed specimen is the first engine's to the last bit");
    assert!(own != other, "and the other engine's own is another");
    for file in ["report.html", "figures/compare-height.svg", "figures/compare-plate.csv"] {
        assert!(out.join(file).is_file(), "{file} is written");
    }
}

fn csv_rows(text: &str) -> Vec<Vec<String>> {
    text.lines().map(|l| l.split(',').map(str::to_owned).collect()).collect()
}

/// Law: what one of the engines cannot do is refused before the other runs.
#[test]
fn what_an_engine_cannot_do_is_refused_before_the_other_runs() {
    if !cfg!(feature = "rapier") {
        return;
    }
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("pressed.json");
    let scenario = json!({
        "name": "pressed",
        "grains": {
            "total_mass_g": 20, "density_kg_per_m3": 2650,
            "sieve_table": [{ "passing_mm": 10, "retained_mm": 8, "mass_percent": 100 }]
        },
        "pieces": [
            { "name": "box", "shape": { "box": { "inner_mm": [50, 50, 50] } } },
            { "name": "lid", "shape": { "plate": { "size_mm": [48, 48, 5] } }, "at_mm": [0, 0, 100] }
        ],
        "stages": [
            { "stage": "deposit", "at_mm": [0, 0, 60], "area_mm": [40, 40], "rate_g_per_s": 50 },
            { "stage": "press", "loads": [{ "piece": "lid", "force_n": 5 }] }
        ],
        "rest_test_s": 0
    });
    fs::write(&path, scenario.to_string()).expect("a scenario file");
    let out = folder.path().join("out");
    let output = compare(&path, "bullet,rapier", &out);
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "law: it is a fault of the scenario, got {said}");
    for word in ["stages[1]", "rapier"] {
        assert!(said.contains(word), "`{word}` is missing in: {said}");
    }
    assert!(!out.exists(), "law: faults are found before anything is written");
}

/// Law: grains that cannot be read are reported before anything is written.
#[test]
fn grains_that_are_not_there_leave_nothing() {
    if !cfg!(feature = "rapier") {
        return;
    }
    let folder = tempfile::tempdir().expect("a folder");
    let mut scenario = small::scenario(30.0, 0.25, 0.2);
    scenario["grains"] = json!({ "file": "nowhere.json" });
    let path = folder.path().join("small.json");
    fs::write(&path, scenario.to_string()).expect("a scenario file");
    let out = folder.path().join("out");
    let output = compare(&path, "bullet,rapier", &out);
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(!output.status.success(), "law: there are no grains, got {said}");
    for word in ["nowhere.json", "grains.file of `small`"] {
        assert!(said.contains(word), "`{word}` is missing in: {said}");
    }
    assert!(!out.exists(), "law: faults are found before anything is written");
}

/// Law: one engine alone is no comparison, and one that stands there twice is refused by its name.
#[test]
fn engines_are_compared_once_each_and_with_others() {
    let folder = tempfile::tempdir().expect("a folder");
    let scenario = write_scenario(folder.path());
    let out = folder.path().join("out");
    for (backends, words) in [
        ("bullet", "at least two engines"),
        ("bullet,bullet", "names bullet twice"),
        ("bullet,rapier,bullet", "names bullet twice"),
    ] {
        let output = compare(&scenario, backends, &out);
        assert_eq!(output.status.code(), Some(2), "law: wrong usage ends with 2: {backends}");
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(said.contains("--backends") && said.contains(words), "law: `{words}` in {said}");
        assert!(!out.exists(), "law: nothing is written");
    }
}
