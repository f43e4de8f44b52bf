//! What a command finds in its way is kept, unless `--force` says otherwise.

use serde_json::{Value, json};

use super::{
    interruption::{copy, finished},
    program::{self, Folder, assert_holds, done, refused},
    same::assert_same_files,
    small,
};

/// A folder with the small scenario in `small.json`, and what it leaves in `out`.
fn folder() -> Folder {
    let folder = Folder::new();
    folder.scenario("small.json", &small::scenario(40.0, 0.5, 0.2));
    copy(finished(), &folder.path("out"));
    folder
}

fn run(scenario: &str, out: &str, more: &[&str]) -> (Option<i32>, String, String) {
    program::run(&[&["run", scenario, "--out", out][..], more].concat())
}

/// Law: the results of another scenario are kept; those of the same may be made again; `--force`
/// replaces them.
#[test]
fn a_run_does_not_write_over_another() {
    let folder = folder();
    let (scenario, out) = (folder.out("small.json"), folder.out("out"));
    let summary = || folder.bytes("out/summary.json");
    let was = summary();
    let other = ["--set", "contact.restitution=0.1", "--set", "rest_test_s=0"];
    let (code, printed, said) = run(&scenario, &out, &other);
    assert_eq!(code, Some(2), "law: another scenario is refused, got {said}");
    assert_holds(&said, &["contact.restitution", "--force", "out"]);
    assert!(printed.is_empty() && summary() == was, "law: nothing is written");
    let (code, _, said) = run(&scenario, &out, &["--quiet", "--no-figures"]);
    assert_eq!(code, Some(0), "law: the same run may be made again, got {said}");
    let forced = [&other[..], &["--force", "--no-figures"]].concat();
    let (code, printed, said) = run(&scenario, &out, &forced);
    assert_eq!(code, Some(0), "law: --force replaces it, got {said}");
    assert!(printed.contains("NOT VALID"), "law: with what the other gives, got {printed}");
    assert!(!folder.path("out/rest_test.csv").exists(), "law: nothing of the first run stays");
    assert!(!folder.path("out/unfinished.json").exists(), "law: it is finished");
}

/// A box, and a lid that stands in it.
fn overlapping() -> Value {
    json!({
        "name": "overlapping",
        "grains": small::fine(20.0),
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
    let folder = folder();
    let out = folder.out("out");
    let mut unread = small::scenario(40.0, 0.5, 0.2);
    unread["grains"] = json!({ "file": "gone.json" });
    for (name, scenario, code, word) in
        [("unread", unread, 4, "cannot read"), ("overlapping", overlapping(), 2, "may_cross")]
    {
        let path = folder.scenario(&format!("{name}.json"), &scenario);
        let mut tried = vec![&["--force"][..]];
        if name == "unread" {
            tried.push(&[]);
        }
        for more in tried {
            let args = ["run", &path, "--out", &out];
            let said = refused(&[&args[..], more].concat(), code, &[word]);
            assert!(!said.contains("another scenario"), "law: {name}: the reason, got {said}");
            let is_named = code == 4 || said.contains("overlapping.json: pieces[1].at_mm: ");
            assert!(is_named, "law: {name}: of which scenario, got {said}");
            assert_same_files(finished(), &folder.path("out"), name);
        }
        // Refused anywhere.
        refused(&["run", &path, "--out", &folder.out(name)], code, &[]);
        assert!(!folder.path(name).exists(), "law: {name}: nothing is written, not even a folder");
    }
}

/// Law: a study of what cannot be built leaves no results, so that its folder is free for the
/// scenario without the fault.
#[test]
fn a_study_that_cannot_begin_leaves_its_folder_free() {
    let folder = Folder::new();
    let path = folder.scenario("overlapping.json", &overlapping());
    let friction = "contact.grain_grain_friction";
    let calibrate = ["--target", "void_ratio=0.8", "--unknown", friction, "--between", "0.2..0.9"];
    let mut studies = vec![("calibrate", &calibrate[..])];
    if cfg!(feature = "rapier") {
        studies.push(("compare", &[]));
    }
    for (study, more) in studies {
        let args = [study, &path, "--out", &folder.out(study)];
        refused(&[&args[..], more].concat(), 2, &["overlap"]);
        assert!(!folder.path(study).exists(), "law: {study} leaves nothing, not even a folder");
    }
}

/// Law: quietly, nothing is printed but errors, and what `--json` asks for.
#[test]
fn quiet_commands_print_nothing() {
    let folder = folder();
    let (scenario, out) = (folder.out("small.json"), folder.out("out"));
    let (code, printed, said) = run(&scenario, &out, &["--quiet"]);
    assert_eq!((code, &*printed, &*said), (Some(0), "", ""), "law: nothing at all");
    let (code, printed, said) = run(&scenario, &out, &["--quiet", "--json", "--no-figures"]);
    assert_eq!((code, &*said), (Some(0), ""), "law: no progress");
    let summary: Value = serde_json::from_str(&printed).expect("JSON");
    assert_eq!(summary["scenario"], "small", "law: what --json asks for");
    let (code, printed, said) = run(&folder.out("none.json"), &out, &["--quiet"]);
    assert_eq!((code, &*printed), (Some(4), ""), "law: an error is one");
    assert!(said.contains("none.json"), "law: and is said, got {said}");
}

/// Law: what a command is there to print is printed quietly, too.
#[test]
fn lists_that_are_asked_for_are_printed_quietly() {
    let folder = folder();
    let (scenario, out) = (folder.out("small.json"), folder.out("out"));
    assert_holds(&done(&["plot", &out, "--list", "--quiet"]), &["series.csv", "time_s"]);
    let sweep = folder.out("sweep");
    done(&["sweep", &scenario, "--over", "seed=1,2", "--plan-only", "--quiet", "--out", &sweep]);
    assert_holds(&done(&["stage", &sweep, "--list", "--quiet"]), &["level 0", "not stored"]);
    let status = done(&["sweep", "--status", "--quiet", "--out", &sweep]);
    assert_holds(&status, &["0 of 2 runs complete"]);
}

/// Law: grains need no engine, apparatus or stages: faults there do not keep them from being made.
#[test]
fn grains_are_made_whatever_else_a_scenario_says() {
    let folder = Folder::new();
    let bare = folder.scenario("bare.json", &json!({ "name": "s", "grains": small::gravel(30.0) }));
    done(&["grains", &bare, "--out", &folder.out("bare")]);
    let faulty = |grains: Value| {
        let stages = json!([{ "stage": "melt" }]);
        let engine = json!({ "rate_hz": -1, "colour": 1 });
        json!({ "name": "s", "grains": grains, "engine": engine, "stages": stages })
    };
    let out = folder.out("out");
    let elsewhere = folder.scenario("elsewhere.json", &faulty(small::gravel(30.0)));
    done(&["grains", &elsewhere, "--out", &out]);
    let mut here = faulty(json!({ "total_mass_g": -1 }));
    here["sead"] = json!(2);
    let here = folder.scenario("here.json", &here);
    // A field that no scenario has may be misspelt grains.
    let words = ["grains.total_mass_g", "sead: there is no such field"];
    let said = refused(&["grains", &here, "--out", &out], 2, &words);
    assert!(!said.contains("rate_hz"), "law: of the grains alone, got {said}");
}
