//! Two engines on the same grains and the same specimen.

use serde_json::{Value, json};

use super::{
    program::{self, Folder, column},
    small,
};

/// Arguments of a comparison, with results in `out`.
fn compare<'a>(scenario: &'a str, backends: &'a str, out: &'a str) -> [&'a str; 8] {
    ["compare", scenario, "--quiet", "--json", "--backends", backends, "--out", out]
}

#[test]
fn engines_get_the_same_grains_and_the_specimen_is_handed_on() {
    if !cfg!(feature = "rapier") {
        return;
    }
    let folder = Folder::new();
    let scenario = folder.scenario("small.json", &small::scenario(30.0, 0.25, 0.2));
    let (code, printed, said) =
        program::run(&compare(&scenario, "bullet,rapier", &folder.out("out")));
    assert!(matches!(code, Some(0 | 1)), "done, with or without agreement, got {code:?}: {said}");
    let record: Value = serde_json::from_str(&printed).expect("JSON on the standard output");
    let written = folder.json("out/compare.json");
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
    let heights = |run: &str| -> Vec<u64> {
        let series = folder.path(&format!("out/runs/{run}/series.csv"));
        let (stages, heights) = (column(&series, "stage"), column(&series, "mean_grain_height_mm"));
        let before = stages.iter().zip(heights).filter(|(stage, _)| **stage != 3.0);
        before.map(|(_, height)| height.to_bits()).collect()
    };
    let (own, handed, other) =
        (heights("bullet"), heights("rapier-from-bullet-specimen"), heights("rapier"));
    assert!(own == handed, "law: the handed specimen is the first engine's to the last bit");
    assert!(own != other, "and the other engine's own is another");
    for file in ["report.html", "figures/compare-height.svg", "figures/compare-plate.csv"] {
        assert!(folder.path("out").join(file).is_file(), "{file} is written");
    }
}

/// Law: what one engine refuses is said with the file, or the change that gave it, and the engine.
#[test]
fn faults_in_one_engine_name_the_file_and_the_engine() {
    if !cfg!(feature = "rapier") {
        return;
    }
    let folder = Folder::new();
    let (file, out) = ("scenarios/laboratory/hopper.json", folder.out("out"));
    let asked = compare(file, "bullet,rapier", &out);
    let walls = ["pieces[0].shape.hopper.wall_mm", "pieces[2].shape.box.wall_mm"];
    let expected = walls.map(|wall| format!("{file}: {wall}: in rapier: a wall through which"));
    program::refused(&asked, 2, &expected.each_ref().map(String::as_str));
    let set = "pieces.0.shape.hopper.wall_mm=9";
    let expected = [format!("--set {set}: {}: in rapier: ", walls[0]), expected[1].clone()];
    let asked = [&asked[..], &["--set", set]].concat();
    program::refused(&asked, 2, &expected.each_ref().map(String::as_str));
    assert!(!folder.path("out").exists(), "law: faults are found before anything is written");
}

/// Law: an engine is named by `--backends`, and a change of it that no run would have is refused.
#[test]
fn an_engine_is_not_set() {
    let folder = Folder::new();
    let scenario = folder.scenario("small.json", &small::scenario(30.0, 0.25, 0.2));
    let out = folder.out("out");
    let asked = compare(&scenario, "bullet,rapier", &out);
    let asked = [&asked[..], &["--set", "engine.backend=rapier"]].concat();
    program::refused(&asked, 2, &["--set engine.backend=rapier: it would be lost", "--backends"]);
    assert!(!folder.path("out").exists(), "law: nothing is written");
}

/// Law: grains that cannot be read are reported before anything is written.
#[test]
fn grains_that_are_not_there_leave_nothing() {
    if !cfg!(feature = "rapier") {
        return;
    }
    let folder = Folder::new();
    let mut scenario = small::scenario(30.0, 0.25, 0.2);
    scenario["grains"] = json!({ "file": "nowhere.json" });
    let path = folder.scenario("small.json", &scenario);
    let words = ["nowhere.json", "grains.file of `small`"];
    program::refused(&compare(&path, "bullet,rapier", &folder.out("out")), 4, &words);
    assert!(!folder.path("out").exists(), "law: faults are found before anything is written");
}

/// Law: one engine alone is no comparison, and one that stands there twice is refused by its name.
#[test]
fn engines_are_compared_once_each_and_with_others() {
    let folder = Folder::new();
    let scenario = folder.scenario("small.json", &small::scenario(30.0, 0.25, 0.2));
    let out = folder.out("out");
    for (backends, words) in [
        ("bullet", "at least two engines"),
        ("bullet,bullet", "names bullet twice"),
        ("bullet,rapier,bullet", "names bullet twice"),
    ] {
        program::refused(&compare(&scenario, backends, &out), 2, &["--backends", words]);
        assert!(!folder.path("out").exists(), "law: nothing is written");
    }
}
