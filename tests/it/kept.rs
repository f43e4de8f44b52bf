//! What a command finds in its way is kept, unless `--force` says otherwise.

use std::{fs, path::Path, process::Command};

use serde_json::{Value, json};

use super::{
    interruption::{copy, finished, write_scenario},
    same::assert_same_files,
    small,
};

fn run(scenario: &Path, out: &Path, more: &[&str]) -> (Option<i32>, String, String) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_pluvia"));
    let output = command.arg("run").arg(scenario).arg("--out").arg(out).args(more).output();
    let output = output.expect("it starts");
    let text = |bytes| String::from_utf8_lossy(bytes).into_owned();
    (output.status.code(), text(&output.stdout), text(&output.stderr))
}

/// Law: the results of another scenario are kept; those of the same may be made again; `--force`
/// replaces them.
#[test]
fn a_run_does_not_write_over_another() {
    let folder = tempfile::tempdir().expect("a folder");
    let scenario = write_scenario(folder.path());
    let out = folder.path().join("out");
    copy(finished(), &out);
    let summary = || fs::read(out.join("summary.json")).expect("a summary");
    let was = summary();
    let other = ["--set", "contact.restitution=0.1", "--set", "rest_test_s=0"];
    let (code, printed, said) = run(&scenario, &out, &other);
    assert_eq!(code, Some(2), "law: another scenario is refused, got {said}");
    for words in ["contact.restitution", "--force", "out"] {
        assert!(said.contains(words), "`{words}` is missing in: {said}");
    }
    assert!(printed.is_empty() && summary() == was, "law: nothing is written");
    let (code, _, said) = run(&scenario, &out, &["--quiet", "--no-figures"]);
    assert_eq!(code, Some(0), "law: the same run may be made again, got {said}");
    let forced = [&other[..], &["--force", "--no-figures"]].concat();
    let (code, printed, said) = run(&scenario, &out, &forced);
    assert_eq!(code, Some(0), "law: --force replaces it, got {said}");
    assert!(printed.contains("NOT VALID"), "law: with what the other gives, got {printed}");
    assert!(!out.join("rest_test.csv").exists(), "law: nothing of the first run stays");
    assert!(!out.join("unfinished.json").exists(), "law: it is finished");
}

/// A box, and a lid that stands in it.
fn overlapping() -> Value {
    json!({
        "name": "overlapping",
        "grains": {
            "total_mass_g": 20, "density_kg_per_m3": 2650,
            "sieve_table": [{ "passing_mm": 10, "retained_mm": 8, "mass_percent": 100 }]
        },
        "pieces": [
            { "name": "box", "shape": { "box": { "inner_mm": [100, 100, 100] } } },
            { "name": "lid", "shape": { "plate": { "size_mm": [90, 90, 10] } }, "at_mm": [0, 0, 2] }
        ],
        "stages": [
            { "stage": "deposit", "at_mm": [0, 0, 90], "area_mm": [80, 80], "rate_g_per_s": 50 }
        ],
        "rest_test_s": 0.1
    })
}

/// Law: what a folder holds is kept, by force, too, where the run that would replace it cannot
/// begin; grains that cannot be read are reported, and not that the scenario is another.
#[test]
fn results_are_kept_where_the_next_run_cannot_begin() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("out");
    copy(finished(), &out);
    let mut unread = small::scenario(40.0, 0.5, 0.2);
    unread["grains"] = json!({ "file": "gone.json" });
    for (name, scenario, code, word) in [
        ("unread", unread, Some(4), "cannot read"),
        ("overlapping", overlapping(), Some(2), "overlap"),
    ] {
        let path = folder.path().join(format!("{name}.json"));
        fs::write(&path, scenario.to_string()).expect("a scenario");
        let mut tried = vec![&["--force"][..]];
        if name == "unread" {
            tried.push(&[]);
        }
        for more in tried {
            let (got, _, said) = run(&path, &out, more);
            assert_eq!(got, code, "law: {name} {more:?} is refused, got {said}");
            assert!(said.contains(word), "`{word}` is missing in: {said}");
            assert!(!said.contains("another scenario"), "law: {name}: the reason, got {said}");
            assert_same_files(finished(), &out, name);
        }
        let bare = folder.path().join(name);
        assert_eq!(run(&path, &bare, &[]).0, code, "law: {name} is refused anywhere");
        let left = fs::read_dir(&bare).expect("a folder").count();
        assert_eq!(left, 0, "law: {name}: nothing is written");
    }
}

/// Law: a study of what cannot be built leaves no results, so that its folder is free for the
/// scenario without the fault.
#[test]
fn a_study_that_cannot_begin_leaves_its_folder_free() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("overlapping.json");
    fs::write(&path, overlapping().to_string()).expect("a scenario");
    let friction = "contact.grain_grain_friction";
    let calibrate = ["--target", "void_ratio=0.8", "--unknown", friction, "--between", "0.2..0.9"];
    let mut studies = vec![("calibrate", &calibrate[..])];
    if cfg!(feature = "rapier") {
        studies.push(("compare", &[]));
    }
    for (study, more) in studies {
        let out = folder.path().join(study);
        let mut command = Command::new(env!("CARGO_BIN_EXE_pluvia"));
        command.arg(study).arg(&path).arg("--out").arg(&out).args(more);
        let output = command.output().expect("it starts");
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "law: {study} is refused, got {said}");
        assert!(said.contains("overlap"), "law: with the reason, got {said}");
        let left = fs::read_dir(&out).expect("a folder").flatten().map(|e| e.file_name());
        let is_result = |name: &str| name != "command.json" && !name.ends_with(".lock");
        let left: Vec<_> = left.filter(|name| is_result(&name.to_string_lossy())).collect();
        assert!(left.is_empty(), "law: {study} leaves nothing, got {left:?}");
    }
}

/// Law: quietly, nothing is printed but errors, and what `--json` asks for.
#[test]
fn quiet_commands_print_nothing() {
    let folder = tempfile::tempdir().expect("a folder");
    let scenario = write_scenario(folder.path());
    let out = folder.path().join("out");
    copy(finished(), &out);
    let (code, printed, said) = run(&scenario, &out, &["--quiet"]);
    assert_eq!((code, &*printed, &*said), (Some(0), "", ""), "law: nothing at all");
    let (code, printed, said) = run(&scenario, &out, &["--quiet", "--json", "--no-figures"]);
    assert_eq!((code, &*said), (Some(0), ""), "law: no progress");
    let summary: serde_json::Value = serde_json::from_str(&printed).expect("JSON");
    assert_eq!(summary["scenario"], "small", "law: what --json asks for");
    let (code, printed, said) = run(&folder.path().join("none.json"), &out, &["--quiet"]);
    assert_eq!((code, &*printed), (Some(4), ""), "law: an error is one");
    assert!(said.contains("none.json"), "law: and is said, got {said}");
}

/// Law: grains need no engine, apparatus or stages: faults there do not keep them from being made.
#[test]
fn grains_are_made_whatever_else_a_scenario_says() {
    let folder = tempfile::tempdir().expect("a folder");
    let grains = serde_json::json!({
        "total_mass_g": 30, "density_kg_per_m3": 2673.9,
        "sieve_table": [{ "passing_mm": 12.5, "retained_mm": 10, "mass_percent": 100 }]
    });
    let path = folder.path().join("s.json");
    let make = |scenario: serde_json::Value| {
        fs::write(&path, scenario.to_string()).expect("a scenario");
        let mut command = Command::new(env!("CARGO_BIN_EXE_pluvia"));
        command.arg("grains").arg(&path).arg("--out").arg(folder.path().join("out"));
        let output = command.output().expect("it starts");
        (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
    };
    let (code, said) = make(serde_json::json!({
        "name": "s", "grains": grains, "engine": { "rate_hz": -1, "colour": 1 },
        "apparatus": { "funnel": { "opening_diameter_mm": 1 } },
        "stages": [{ "stage": "melt" }]
    }));
    assert_eq!(code, Some(0), "law: only the grains count, got {said}");
    let (code, said) = make(serde_json::json!({ "name": "s", "grains": grains }));
    assert_eq!(code, Some(0), "law: nothing else is needed, got {said}");
    let (code, said) = make(serde_json::json!({
        "name": "s", "grains": { "total_mass_g": -1 }, "sead": 2, "engine": { "rate_hz": -1 }
    }));
    assert_eq!(code, Some(2), "law: faults of the grains are faults, got {said}");
    for words in ["grains.total_mass_g", "sead"] {
        assert!(said.contains(words), "`{words}` is missing in: {said}");
    }
    assert!(!said.contains("rate_hz"), "law: of the grains alone, got {said}");
}
