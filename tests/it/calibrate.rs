//! `pluvia calibrate` on a few grains: what it finds, what it refuses, and that
//! it goes on from where it was.

use std::{
    fs,
    path::{Path, PathBuf},
    process::Command,
};

use serde_json::Value;

use super::small;

fn write(folder: &Path) -> PathBuf {
    let path = folder.join("small.json");
    fs::write(&path, small::layer(40.0).to_string()).expect("a scenario file");
    path
}

/// Runs the command; gives its exit code, standard output and standard error.
fn calibrate(scenario: &Path, out: &Path, more: &[&str]) -> (Option<i32>, String, String) {
    let output = Command::new(env!("CARGO_BIN_EXE_pluvia"))
        .args(["calibrate", "--quiet", "--json"])
        .arg(scenario)
        .arg("--out")
        .arg(out)
        .args(more)
        .output()
        .expect("the program starts");
    let text = |bytes| String::from_utf8(bytes).expect("UTF-8");
    (output.status.code(), text(output.stdout), text(output.stderr))
}

const BY_MASS: [&str; 10] = [
    "--target",
    "standing_height_mm.mean_surface=9",
    "--unknown",
    "grains.total_mass_g",
    "--between",
    "20..90",
    "--realisations",
    "3",
    "--tolerance",
    "1",
];

const FILES: [&str; 5] =
    ["calibrate.json", "calibrate.md", "report.html", "evaluations.csv", "figures/calibration.svg"];

fn bytes(out: &Path) -> Vec<Vec<u8>> {
    FILES.iter().map(|f| fs::read(out.join(f)).unwrap_or_else(|e| panic!("{f}: {e}"))).collect()
}

#[test]
fn a_mass_is_found_for_a_height_and_the_same_command_gives_the_same_bytes() {
    let folder = tempfile::tempdir().expect("a folder");
    let (scenario, out) = (write(folder.path()), folder.path().join("out"));
    // Few grains, and masses that are not far from each other: few runs.
    let mut asked = BY_MASS;
    asked[1] = "standing_height_mm.mean_surface=6";
    asked[5] = "30..60";
    let (code, printed, said) = calibrate(&scenario, &out, &asked);
    assert_eq!(code, Some(0), "{said}");
    let found: Value = serde_json::from_str(&printed).expect("JSON");
    let first = bytes(&out);
    assert_eq!(found, serde_json::from_slice::<Value>(&first[0]).expect("JSON"), "as written");
    assert_eq!(found["ending"], "found", "{printed}");
    let number = |value: &Value| value.as_f64().expect("a number");
    let solution = &found["solution"];
    let (mass, interval) = (number(&solution["value"]), &solution["interval_95"]);
    assert!(number(&interval["low"]) < mass && mass < number(&interval["high"]), "{solution}");
    assert!(number(&solution["slope"]) > 0.0, "law: more grains stand higher: {solution}");
    // Height over mass is known without a simulation but for the void ratio,
    // which is that of angular grains: h = m (1 + e) / (ρ A).
    let area = std::f64::consts::PI / 4.0 * 7.5 * 7.5;
    let void_ratio = 0.6 * area * 2.6739 / mass - 1.0;
    assert!((0.3..1.5).contains(&void_ratio), "law: h = m(1 + e)/(ρA); got e {void_ratio}");
    // Every value was run in the same configurations.
    let runs = found["runs"].as_array().expect("runs");
    for value in found["values"].as_array().expect("values") {
        let configurations: Vec<u64> = runs
            .iter()
            .filter(|r| r["value"] == value["value"])
            .filter_map(|r| r["configuration"].as_u64())
            .collect();
        let expected: Vec<u64> = (1..=configurations.len() as u64).collect();
        assert_eq!(configurations, expected, "law: pairs, at {}", value["value"]);
        assert!(configurations.len() >= 3, "law: at least the realisations");
    }
    let rows = String::from_utf8(first[3].clone()).expect("UTF-8").lines().count();
    assert_eq!(rows, runs.len() + 1, "law: a row a run and a header");

    // Again, all of it from the store: wall times are those of the first time.
    let (code, _, said) = calibrate(&scenario, &out, &asked);
    assert_eq!(code, Some(0), "{said}");
    assert!(bytes(&out) == first, "law: the same command gives the same bytes");
    // With stages lost, as when it was killed, it fills the gaps.
    let entries = fs::read_dir(out.join("stages")).expect("stages").flatten().map(|e| e.path());
    let mut stages: Vec<_> = entries.filter(|path| path.is_dir()).collect();
    stages.sort();
    for stage in stages.iter().step_by(7) {
        fs::remove_dir_all(stage).expect("removed");
    }
    let (code, printed, said) = calibrate(&scenario, &out, &asked);
    assert_eq!(code, Some(0), "{said}");
    let again: Value = serde_json::from_str(&printed).expect("JSON");
    assert_eq!(again["solution"], found["solution"], "law: the same bits, but for wall times");
}

#[test]
fn what_cannot_be_is_told_with_what_was_measured() {
    let folder = tempfile::tempdir().expect("a folder");
    let (scenario, out) = (write(folder.path()), folder.path().join("out"));
    let mut asked = BY_MASS;
    asked[1] = "standing_height_mm.mean_surface=70";
    asked[7] = "2";
    let (code, printed, said) = calibrate(&scenario, &out, &asked);
    assert_eq!(code, Some(1), "law: an expectation missed is 1: {said}");
    let found: Value = serde_json::from_str(&printed).expect("JSON");
    assert_eq!(found["ending"], "out_of_reach", "{printed}");
    let statement = found["statement"].as_str().expect("a statement");
    for words in ["no grains.total_mass_g in 20..90", "70 mm", "at 20 it is", "at 90 it is"] {
        assert!(statement.contains(words), "`{words}` is missing in: {statement}");
    }
    assert_eq!(found["values"].as_array().map(Vec::len), Some(4), "what was tried is kept");
    bytes(&out);
}

#[test]
fn a_result_that_is_not_measured_is_told_with_what_is() {
    let folder = tempfile::tempdir().expect("a folder");
    let (scenario, out) = (write(folder.path()), folder.path().join("out"));
    let misspelt = ["--target", "settlement_mm.finel=3", "--unknown", "contact.restitution"];
    let misspelt = [&misspelt[..], &["--between", "0..1"]].concat();
    let (code, _, said) = calibrate(&scenario, &out, &misspelt);
    assert_eq!(code, Some(2), "law: a misspelt result is refused: {said}");
    assert!(said.contains("did you mean `settlement_mm.final`"), "law: with what is meant: {said}");
    assert!(!out.exists(), "law: before anything runs");
    let restitution = ["--unknown", "contact.restitution", "--between", "0..1"];
    for (target, words, ran) in [
        ("slope.degrees=3", ["slope.degrees", "standing_height_mm.mean_surface"], false),
        ("settlement_mm.final=3", ["does not measure it", "a stage `vibrate`"], false),
        // Cells have corners, of whose roundness nobody speaks: known from the first run alone.
        ("shape.roundness.p50=0.3", ["has no number at", "coordination_number"], true),
    ] {
        let (code, printed, said) =
            calibrate(&scenario, &out, &[&["--target", target], &restitution[..]].concat());
        assert_eq!(code, Some(2), "{said}");
        assert!(printed.is_empty(), "nothing is printed as a result: {printed}");
        assert_eq!(out.exists(), ran, "law: what can be known before is refused before: {said}");
        for word in words {
            assert!(said.contains(word), "`{word}` is missing in: {said}");
        }
    }
    let runs = fs::read_dir(out.join("runs")).expect("runs").count();
    assert_eq!(runs, 1, "law: one run is enough to tell");
}

#[test]
fn wrong_usage_is_told_before_anything_runs() {
    let folder = tempfile::tempdir().expect("a folder");
    let (scenario, out) = (write(folder.path()), folder.path().join("out"));
    let height = ["--target", "standing_height_mm.mean_surface=40"];
    let friction = ["--unknown", "contact.grain_grain_friction"];
    let between = ["--between", "0.2..1.2"];
    let cases: [(Vec<&str>, &str); 15] = [
        (vec![], "--angle-of-repose"),
        ([&height[..], &["--angle-of-repose", "38"]].concat(), "cannot be used with"),
        (vec!["--angle-of-repose", "95"], "between 0 and 90"),
        (vec!["--angle-of-repose", "-5"], "between 0 and 90"),
        ([&height[..], &friction].concat(), "--between"),
        ([&height[..], &between].concat(), "--unknown"),
        (["--target", "height"].to_vec(), "not field=number"),
        ([&height[..], &friction, &["--between", "1.2..0.2"]].concat(), "reversed"),
        (
            [&height[..], &friction, &["--between", "-1..0.2"]].concat(),
            "contact.grain_grain_friction",
        ),
        ([&height[..], &["--unknown", "contact.colour"], &between].concat(), "no such field"),
        ([&height[..], &["--unknown", "name"], &between].concat(), "no number there"),
        ([&height[..], &["--unknown", "seed"], &between].concat(), "samples"),
        ([&height[..], &friction, &between, &["--realisations", "1"]].concat(), "--realisations"),
        ([&height[..], &friction, &between, &["--most-runs", "7"]].concat(), "at least 30 runs"),
        // Without a rest test no run is valid.
        (
            [&height[..], &friction, &between, &["--set", "rest_test_s=0"]].concat(),
            "rest_test_s is 0",
        ),
    ];
    for (more, words) in cases {
        let (code, printed, said) = calibrate(&scenario, &out, &more);
        assert_eq!(code, Some(2), "{more:?}: {said}");
        assert!(said.contains(words), "{more:?}: `{words}` is missing in: {said}");
        assert!(printed.is_empty() && !out.exists(), "nothing is printed or written: {more:?}");
    }
}
