//! Scenarios that begin with a specimen of another run.

use std::{fs, path::Path, process::Output};

use pluvia::grains::load_scenario;
use serde_json::{Value, json};

use super::{
    export::small_run as whole,
    interruption::{copy, stored},
    program::{self, assert_holds, done, json as read, refused, said, text, write},
    scenario::{assert_one, assert_told, told_of},
    small,
};

fn run(scenario: &Path, out: &Path) -> Output {
    program::output(&["run", text(scenario), "--out", text(out), "--quiet", "--no-figures"])
}

/// Runs it to its end.
fn ran(scenario: &Path, out: &Path) {
    let output = run(scenario, out);
    assert!(output.status.success(), "law: {} is run: {}", scenario.display(), said(&output));
}

/// The stages of the whole run after the first two.
fn last_two() -> Value {
    let stages = small::scenario(30.0, 0.25, 0.1)["stages"].clone();
    json!(stages.as_array().expect("stages")[2..])
}

/// Law: what is begun with a stored specimen is what one run would have done. Poured once and
/// shaken twice from it, the specimen, the series and the key of every stage are those of the run
/// that was not interrupted.
#[test]
fn shaken_from_a_stored_specimen_is_as_shaken_at_once() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut poured = small::scenario(30.0, 0.25, 0.1);
    poured["stages"] = json!(poured["stages"].as_array().expect("stages")[..2]);
    let poured = write(folder.path(), "poured.json", &poured);
    let from = folder.path().join("poured");
    ran(&poured, &from);
    let keys = |out: &Path| -> Vec<Value> {
        let manifest = read(&out.join("manifest.json"));
        let stages = manifest["stages"].as_array().expect("stages").iter();
        stages.map(|stage| stage["key"].clone()).collect()
    };
    let ways = [
        ("folder", json!({ "specimen": "poured" })),
        ("named", json!({ "specimen": "poured", "stage": "pour" })),
    ];
    for (name, begin) in ways {
        let scenario = json!({ "name": "shaken", "begin": begin, "stages": last_two() });
        let scenario = write(folder.path(), &format!("{name}.json"), &scenario);
        let out = folder.path().join(name);
        ran(&scenario, &out);
        for file in ["specimen.json", "grains.csv", "grains.json"] {
            let [one, two] = [&out, whole()].map(|out| fs::read(out.join(file)).expect(file));
            assert!(one == two, "law: {name}: the same bytes of {file}");
        }
        assert_eq!(keys(&out), keys(whole())[2..], "law: {name}: the same stages in the store");
        let summary = read(&out.join("summary.json"));
        assert_eq!(summary["falling_height_mm"], Value::Null, "law: nothing fell in this run");
        assert_eq!(
            summary["settlement_mm"],
            read(&whole().join("summary.json"))["settlement_mm"],
            "law: {name}: the same settlement"
        );
        let manifest = read(&out.join("manifest.json"));
        assert_eq!(manifest["began_with"]["after"], json!(["fill_funnel", "pour"]), "law: it says");
        assert_eq!(manifest["began_with"]["key"], keys(&from)[1], "law: which specimen it was");
        let exported = folder.path().join(format!("{name}-exported"));
        let checked = done(&["store", "check", text(&out)]);
        let known = checked.contains("it began with the specimen of the run in");
        assert!(known && !checked.contains("not there"), "law: its store knows it, got {checked}");
        // Such a run is read as any other.
        done(&["export", text(&out), "--format", "csv", "--out", text(&exported)]);
    }
}

/// Law: a specimen may be taken to another gravity: what was recorded of it was under its own.
#[test]
fn a_specimen_may_be_taken_to_another_gravity() {
    let folder = tempfile::tempdir().expect("a folder");
    let rest = json!([{ "stage": "rest", "duration_s": 0.1 }]);
    let mut from = whole().to_owned();
    // Begun with what has been there, too, and taken back.
    for (name, gravity) in [("moon", 1.62), ("earth", 9.81)] {
        let scenario = json!({
            "name": name, "begin": { "specimen": from }, "gravity_m_per_s2": gravity,
            "stages": rest, "rest_test_s": 0
        });
        let scenario = write(folder.path(), &format!("{name}.json"), &scenario);
        let out = folder.path().join(name);
        ran(&scenario, &out);
        from = out;
    }
}

/// Law: the file of a stored stage means that stage, and the grains are those of the run.
#[test]
fn the_file_of_a_stage_means_that_stage() {
    let folder = tempfile::tempdir().expect("a folder");
    let manifest = read(&whole().join("manifest.json"));
    let key = manifest["stages"][1]["key"].as_str().expect("a key");
    let stored = whole().join("stages").join(&key[..24]).join("specimen.json");
    let begun = |specimen: &Path, more: &[(&str, Value)]| {
        let mut begin = json!({ "specimen": specimen });
        for (field, value) in more {
            begin[*field] = value.clone();
        }
        let stages = json!([{ "stage": "rest", "duration_s": 0.1 }]);
        let scenario = json!({ "name": "rests", "begin": begin, "stages": stages });
        write(folder.path(), "rests.json", &scenario)
    };
    let after = |scenario: &Path| {
        let loaded = load_scenario(scenario, &[]).unwrap_or_else(|e| panic!("{e}")).scenario;
        loaded.begin.expect("it begins with a specimen").after
    };
    assert_eq!(after(&begun(&stored, &[])), ["fill_funnel", "pour"], "law: the stage of the file");
    let all = ["fill_funnel", "pour", "place_top_plate", "vibrate"];
    assert_eq!(after(&begun(&whole().join("specimen.json"), &[])), all, "law: the run's own");
    let rest_test = [("stage", json!("rest_test"))];
    assert_eq!(after(&begun(whole(), &rest_test)).last().map(String::as_str), Some("rest"));

    let scenario = begun(whole(), &[("stage", json!("pour"))]);
    let out = folder.path().join("grains");
    done(&["grains", text(&scenario), "--out", text(&out), "--json"]);
    let [one, two] = [&out, whole()].map(|out| fs::read(out.join("grains.json")).expect("grains"));
    assert!(one == two, "law: those of the run");
}

#[test]
fn what_cannot_be_begun_with_is_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let rest = json!([{ "stage": "rest", "duration_s": 0.1 }]);
    let refused = |begin: &Value, stages: &Value, words: &[&str]| {
        let scenario = json!({ "name": "begun", "begin": begin, "stages": stages });
        let scenario = write(folder.path(), "begun.json", &scenario);
        let out = folder.path().join("out");
        let output = run(&scenario, &out);
        let said = said(&output);
        assert_eq!(output.status.code(), Some(2), "law: {begin} is refused, got {said}");
        assert_holds(&said, words);
        assert!(!out.join("summary.json").exists(), "law: nothing is run");
    };
    refused(&json!({ "specimen": "none" }), &rest, &["begin.specimen", "is not there"]);
    refused(&json!({ "specimen": "." }), &rest, &["begin.specimen", "manifest.json"]);
    let whole_run = text(whole());
    let melt = json!({ "specimen": whole_run, "stage": "poor" });
    refused(&melt, &rest, &["begin.stage", "did you mean `pour`", "vibrate"]);
    let control = json!({ "specimen": whole_run, "stage": "control" });
    refused(&control, &rest, &["begin.stage", "now called `rest_test`"]);
    let earlier = json!({ "scenario": { "engine": { "contact_path": "bullet" } } });
    write(folder.path(), "manifest.json", &earlier);
    let named = json!({ "specimen": text(folder.path()) });
    refused(&named, &rest, &["begin.specimen", "now called `engine.contact_solver`"]);
    let stage = json!({ "stage": "pour", "key": "a", "specimen_sha256": "b" });
    let bare = json!({ "scenario": {}, "stages": [stage] });
    write(folder.path(), "manifest.json", &bare);
    let mut scenario = small::scenario(30.0, 0.25, 0.1);
    (scenario["begin"], scenario["stages"]) = (named, rest.clone());
    assert_one(&scenario, "begin.specimen", "has no grains in it");
    let pour = json!([{ "stage": "pour", "falling_height_mm": 0 }]);
    let again = ["stages[0]", "`pour` cannot be done again", "the specimen"];
    refused(&json!({ "specimen": whole_run }), &pour, &again);
    let fill = json!([{ "stage": "fill_funnel" }]);
    refused(&json!({ "specimen": whole_run }), &fill, &["stages[0]", "fill_funnel"]);
    let pinned = json!({ "specimen": whole_run, "specimen_sha256": "00" });
    refused(&pinned, &rest, &["begin.specimen_sha256", "another specimen"]);

    // A stored specimen that was changed, and one that does not stand in such a cylinder.
    let changed = folder.path().join("changed");
    copy(whole(), &changed);
    for file in stored(&changed).iter().map(|stage| stage.join("specimen.json")) {
        let content = fs::read_to_string(&file).expect("a specimen");
        fs::write(&file, content.replacen("0.0", "0.1", 1)).expect("changed");
    }
    refused(&json!({ "specimen": text(&changed) }), &rest, &["specimen.json", "not what was"]);
    for (inner_mm, height_mm) in [(60, 200), (130, 20)] {
        let cylinder = json!({ "inner_diameter_mm": inner_mm, "height_mm": height_mm });
        let scenario = json!({
            "name": "begun", "begin": { "specimen": whole_run, "stage": "pour" }, "stages": rest,
            "apparatus": { "cylinder": cylinder }
        });
        let words = format!("stands in the run's apparatus: leave the field out (found {inner_mm}");
        assert_told(&told_of(&scenario), "apparatus.cylinder.inner_diameter_mm", &words);
    }
}

/// Law: a specimen that is not there is the only fault: pieces, regions and openings of its run
/// are not known.
#[test]
fn a_specimen_that_is_not_there_is_no_second_fault() {
    let force = json!({ "piece": "both", "direction": [0, 0, 1], "force_n": 3 });
    let scenario = json!({
        "name": "begun",
        "begin": { "specimen": "none" },
        "measures": { "groups": [{ "name": "both", "pieces": ["lid", "side"] }] },
        "stages": [
            { "stage": "move", "pieces": ["lid"], "velocity_mm_per_s": [0, 0, -5], "until": force,
              "time_limit_s": 1, "keep_mean_stress": { "region": "core", "pieces": ["side"] } },
            { "stage": "remove", "pieces": ["gate"],
              "until": { "opening": "mouth", "flow_below_g_per_s": 1 } }
        ]
    });
    assert_one(&scenario, "begin.specimen", "");
}

/// Law: a fault in the form of `begin` is the only one: the scenario needs no grains and no funnel
/// then either.
#[test]
fn a_beginning_of_a_wrong_form_is_no_second_fault() {
    for (begin, at) in [
        (json!({ "specimen": "none", "stage": 1 }), "begin.stage"),
        (json!({ "specimen": 1 }), "begin.specimen"),
        (json!({ "specimen": "" }), "begin.specimen"),
        (json!({ "specimen": whole(), "stage": "" }), "begin.stage"),
        (json!({ "stage": "pour" }), "begin.specimen"),
        (json!("none"), "begin"),
        (json!(null), "begin"),
    ] {
        let rest = json!([{ "stage": "rest", "duration_s": 0.1 }]);
        let scenario = json!({ "name": "begun", "begin": begin, "stages": rest });
        assert_one(&scenario, at, "");
    }
}

/// Law: grains that contradict the specimen's are one fault; nothing is said of a mixture of both.
#[test]
fn other_grains_than_those_of_the_specimen_are_no_second_fault() {
    let scenario = json!({
        "name": "begun", "begin": { "specimen": whole() }, "grains": { "total_mass_g": 1 },
        "stages": [{ "stage": "rest", "duration_s": 0.1 }]
    });
    assert_one(&scenario, "grains.total_mass_g", "leave the field out");
}

/// Law: which settings are taken over is for the program to say: a scenario that was loaded loads
/// again as it is, a list that is not whole is made whole, and a value of its own is not listed.
#[test]
fn a_typed_list_of_what_is_taken_over_is_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let loaded = |value: &Value| {
        let path = write(folder.path(), "rests.json", value);
        load_scenario(&path, &[]).unwrap_or_else(|e| panic!("{e}")).scenario
    };
    let stiffness = "engine.native.contact_stiffness_n_per_m";
    let mut scenario = json!({
        "name": "rests", "begin": { "specimen": whole(), "stage": "pour" },
        "stages": [{ "stage": "rest", "duration_s": 0.1 }]
    });
    let first = loaded(&scenario);
    let mut value = json!(first);
    assert_eq!(loaded(&value), first, "law: what was loaded loads again as it is");
    scenario["begin"]["taken_over"] = json!([stiffness]);
    assert_eq!(loaded(&scenario).begin, first.begin, "law: a list is made whole");
    value["engine"]["native"]["contact_stiffness_n_per_m"] = json!(1234);
    assert_one(&value, "begin.taken_over", stiffness);
    scenario["begin"]["taken_over"] = json!(["engine.rate_hz"]);
    assert_one(&scenario, "begin.taken_over", "engine.rate_hz");
}

/// Law: a name that several stages have means none of them, unless a key says which; each has its
/// number.
#[test]
fn of_several_stages_of_a_name_the_number_is_asked_for() {
    let folder = tempfile::tempdir().expect("a folder");
    let run = folder.path().join("run");
    copy(whole(), &run);
    let mut manifest = read(&run.join("manifest.json"));
    manifest["stages"][2]["stage"] = json!("pour");
    write(&run, "manifest.json", &manifest);
    let loaded = |stage: &str, key: Option<&String>| {
        let mut begin = json!({ "specimen": run, "stage": stage });
        if let Some(key) = key {
            begin["key"] = json!(key);
        }
        let stages = json!([{ "stage": "rest", "duration_s": 0.1 }]);
        let scenario = json!({ "name": "rests", "begin": begin, "stages": stages });
        let path = write(folder.path(), "rests.json", &scenario);
        let loaded = load_scenario(&path, &[]).map_err(|e| e.to_string())?;
        Ok::<_, String>(loaded.scenario.begin.expect("it begins with a specimen"))
    };
    let said = loaded("pour", None).expect_err("law: which of them?");
    assert_holds(&said, &["begin.stage", "several", "1 or 2"]);
    for number in ["1", "2"] {
        let meant = loaded(number, None).expect("law: a number says which").key;
        assert!(meant.is_some(), "law: its key is noted");
        let noted = loaded("pour", meant.as_ref()).expect("law: so does the key");
        assert_eq!(noted.key, meant, "law: the stage of number {number}");
    }
}

/// Law: a file is begun with that is a specimen of the run as it was written, and no other.
#[test]
fn a_file_that_is_no_specimen_of_the_run_is_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let run = folder.path().join("run");
    copy(whole(), &run);
    let loaded = |specimen: &Path| {
        let stages = json!([{ "stage": "rest", "duration_s": 0.1 }]);
        let scenario =
            json!({ "name": "rests", "begin": { "specimen": specimen }, "stages": stages });
        let path = write(folder.path(), "rests.json", &scenario);
        load_scenario(&path, &[]).map(|_| ()).map_err(|e| e.to_string())
    };
    let manifest = read(&run.join("manifest.json"));
    let key = manifest["stages"][1]["key"].as_str().expect("a key");
    let stored = run.join("stages").join(&key[..24]).join("specimen.json");
    for file in [run.join("specimen.json"), stored] {
        assert_eq!(loaded(&file), Ok(()), "law: as it was written");
        let was = fs::read_to_string(&file).expect("a specimen");
        for other in [was.replacen("0.0", "0.1", 1), was[..was.len() / 2].to_owned()] {
            fs::write(&file, other).expect("changed");
            let said = loaded(&file).expect_err("law: it is another");
            let words = ["begin.specimen", "specimen.json", "not what the run has written"];
            assert_holds(&said, &words);
        }
        fs::write(&file, was).expect("as it was");
    }
    fs::write(run.join("notes.txt"), "no specimen").expect("written");
    for name in ["notes.txt", "manifest.json", "grains.json"] {
        let said = loaded(&run.join(name)).expect_err("law: it is no specimen");
        assert!(said.contains("begin.specimen") && said.contains(name), "law: got {said}");
    }
}

/// Law: a begun specimen whose stages draw nothing is one realisation, however often it is run: what
/// would count it several times is refused before anything is written; what draws, or is run once,
/// is not.
#[test]
fn one_specimen_is_not_taken_for_several_realisations() {
    let folder = tempfile::tempdir().expect("a folder");
    let begun = |name: &str, stage: Value| {
        let begin = json!({ "specimen": text(whole()), "stage": "pour" });
        let scenario = json!({ "name": "begun", "begin": begin, "stages": [stage] });
        write(folder.path(), name, &scenario)
    };
    let rests = begun("rests.json", json!({ "stage": "rest", "duration_s": 0.1 }));
    let placed = begun("placed.json", json!({ "stage": "place_top_plate", "placement": 1 }));
    let full = json!({ "scenario": "rests.json", "configurations": 2 });
    let rung = |of: &str| {
        let changes = [format!("contact.restitution={of}")];
        json!({ "name": of, "title": of, "changes": changes })
    };
    let ladders = json!({
        "full": full, "reference": "rebound",
        "limits": { "height_percent": 1, "settlement_percent": 5 },
        "ladders": [{ "name": "rebound", "title": "Rebound", "rungs": [rung("0.2"), rung("0.3")] }]
    });
    let ranges = json!({ "full": full, "parameters": [{ "name": "rebound", "title": "Rebound",
        "reason": "A test.", "path": "contact.restitution", "low": 0.2, "high": 0.4 }] });
    let ladders = write(folder.path(), "ladders.json", &ladders);
    let ranges = write(folder.path(), "ranges.json", &ranges);
    let out = folder.path().join("out");
    let to = ["--out", text(&out), "--quiet"];
    let (rests, over) = (text(&rests), ["--over", "contact.restitution=0.2,0.3"]);
    let height = ["--target", "standing_height_mm.mean_surface=9"];
    let unknown = ["--unknown", "contact.restitution", "--between", "0.1..0.3"];
    for (args, words) in [
        (
            [&["sweep", rests, "--configurations", "3"][..], &over[..]].concat(),
            "--configurations 3",
        ),
        (vec!["sweep", rests, "--over", "seed=1,2,3"], "`seed` cannot be varied"),
        (vec!["sweep", rests, "--over", "configuration=1,2"], "`configuration` cannot be varied"),
        (
            vec!["sweep", rests, "--samples", "latin-hypercube:3", "--range", "seed=1..9"],
            "`seed` cannot be varied",
        ),
        ([&["calibrate", rests][..], &height[..], &unknown[..]].concat(), "--realisations 5"),
        (vec!["converge", "--design", text(&ladders)], "--configurations 2"),
        (vec!["sensitivity", "--design", text(&ranges)], "--configurations 2"),
    ] {
        refused(&[&args[..], &to].concat(), 2, &[words, "begins with one specimen"]);
        assert!(!out.exists(), "law: nothing was written");
    }
    for args in [
        [&["sweep", rests, "--plan-only"][..], &over[..]].concat(),
        [&["sweep", text(&placed), "--plan-only", "--configurations", "3"][..], &over[..]].concat(),
    ] {
        done(&[&args[..], &to].concat());
        fs::remove_dir_all(&out).expect("the plan is removed");
    }
}

/// Law: a specimen that a run only rests is not called another realisation than it is: a seed and a
/// configuration that are not its own are refused, both at once, before anything is written.
#[test]
fn a_specimen_is_not_called_another_realisation() {
    let folder = tempfile::tempdir().expect("a folder");
    let begin = json!({ "specimen": text(whole()), "stage": "pour" });
    let rest = json!({ "stage": "rest", "duration_s": 0.1 });
    let scenario = json!({ "name": "rests", "begin": begin, "stages": [rest], "rest_test_s": 0 });
    let rests = write(folder.path(), "rests.json", &scenario);
    let out = folder.path().join("out");
    let args = |sets: [&'static str; 2]| {
        let [one, two] = sets;
        ["run", text(&rests), "--out", text(&out), "--no-figures", "--set", one, "--set", two]
    };
    let words = [
        "rests.json: `rests` begins with one specimen",
        "seed: it is not that of the specimen (found 7; allowed: 1",
        "configuration: it is not that of the specimen (found 3; allowed: 1",
    ];
    refused(&args(["seed=7", "configuration=3"]), 2, &words);
    assert!(!out.exists(), "law: nothing was written");
    done(&args(["seed=1", "configuration=1"]));
}

/// Law: what is stored of a sweep that begins with a specimen is found again, by those who ask how far
/// it is, collect it, or run its stages one by one.
#[test]
fn a_sweep_from_a_specimen_is_collected() {
    let folder = tempfile::tempdir().expect("a folder");
    let scenario = json!({
        "name": "rests", "begin": { "specimen": text(whole()), "stage": "pour" },
        "stages": [{ "stage": "rest", "duration_s": 0.05 }], "rest_test_s": 0.05
    });
    let scenario = write(folder.path(), "rests.json", &scenario);
    let out = folder.path().join("out");
    let to = ["--out", text(&out), "--quiet", "--json"];
    let over = ["sweep", text(&scenario), "--over", "contact.restitution=0.2,0.3", "--plan-only"];
    done(&[&over[..], &to].concat());
    // A stage of each level, in the order of the levels.
    for level in ["0", "1"] {
        done(&["stage", text(&out), "--level", level, "--task", "0", "--quiet"]);
    }
    let printed = |args: &[&str]| -> Value {
        let printed = done(&[args, &to].concat());
        serde_json::from_str(&printed).expect("JSON on the standard output")
    };
    let status = printed(&["sweep", "--status"]);
    assert_eq!(status["stored"], 2, "law: two of four stages, got {status}");
    done(&[&over[..4], &to].concat());
    let collected = printed(&["sweep", "--collect"]);
    let failures: Vec<&Value> =
        collected["runs"].as_array().expect("runs").iter().map(|run| &run["failure"]).collect();
    assert_eq!(failures, [&Value::Null; 2], "law: both runs are there, got {collected}");
}

/// Law: grains of a file are those of the run, or the file is refused.
#[test]
fn a_file_of_other_grains_is_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut filled = small::scenario(30.0, 0.25, 0.1);
    filled["stages"] = json!([filled["stages"][0]]);
    let same = folder.path().join("same.json");
    fs::copy(whole().join("grains.json"), &same).expect("a copy");
    filled["grains"] = json!({ "file": text(&same) });
    let filled = write(folder.path(), "filled.json", &filled);
    let from = folder.path().join("filled");
    ran(&filled, &from);
    let mut other = small::scenario(30.0, 0.25, 0.1);
    other["seed"] = json!(2);
    let other = write(folder.path(), "seed.json", &other);
    let made = folder.path().join("made");
    done(&["grains", text(&other), "--out", text(&made), "--quiet"]);
    let other = folder.path().join("other.json");
    fs::copy(made.join("grains.json"), &other).expect("a copy");
    let begun = |file: &Path| {
        let scenario = json!({
            "name": "begun", "grains": { "file": text(file) },
            "begin": { "specimen": text(&from) },
            "stages": [{ "stage": "rest", "duration_s": 0.01 }]
        });
        let scenario = write(folder.path(), "begun.json", &scenario);
        run(&scenario, &folder.path().join("begun"))
    };
    let output = begun(&other);
    assert_eq!(output.status.code(), Some(2), "law: it is refused, got {}", said(&output));
    assert_holds(&said(&output), &["grains.file", "other.json", "leave the field out"]);
    let output = begun(&same);
    assert!(output.status.success(), "law: the same grains may be named: {}", said(&output));
    // Beside the scenario, though the run is named from elsewhere.
    let beside = json!({
        "name": "beside", "grains": { "file": "same.json" },
        "stages": [{ "stage": "rest", "duration_s": 0.01 }]
    });
    let beside = write(folder.path(), "beside.json", &beside);
    let (out, set) = (folder.path().join("beside"), format!("begin.specimen={}", text(&from)));
    done(&["run", text(&beside), "--out", text(&out), "--quiet", "--no-figures", "--set", &set]);
}

/// Law: the shipped example begins with what the README's first run leaves.
#[test]
fn the_example_is_sound() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let example = fs::read_to_string(root.join("scenarios/begin/shaken-again.json"));
    let folder = tempfile::tempdir().expect("a folder");
    let example = example.expect("the example").replace("../../out/first", text(whole()));
    let path = folder.path().join("example.json");
    fs::write(&path, example).expect("a scenario");
    let loaded = load_scenario(&path, &[]).unwrap_or_else(|e| panic!("{e}")).scenario;
    assert_eq!(loaded.stages.len(), 3, "law: nothing is poured again");
    let begin = loaded.begin.expect("it begins with a specimen");
    assert_eq!(begin.after, ["fill_funnel", "pour"], "law: poured before");
}
