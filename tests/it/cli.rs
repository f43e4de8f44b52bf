//! The program as a user meets it: what it prints, and its exit codes.

use std::{fs, path::Path};

use serde_json::{Value, json};

use crate::export::small_run;
use crate::program::{Folder, assert_holds, refused, root, run, text};

const SCENARIO: &str = "scenarios/quick/pluviation.json";

#[test]
fn schema_is_printed() {
    let (code, out, _) = run(&["schema"]);
    assert_eq!(code, Some(0));
    let schema: Value = serde_json::from_str(&out).expect("the schema is JSON");
    assert_eq!(schema, pluvia::scenario::schema());
}

#[test]
fn info_names_the_engine() {
    let (code, out, _) = run(&["info", "--json"]);
    assert_eq!(code, Some(0));
    let info: Value = serde_json::from_str(&out).expect("JSON");
    assert_eq!(info["backends"][0]["name"], "bullet", "{out}");
    assert!(info["cores"].as_u64().is_some_and(|cores| cores >= 1), "{out}");
    assert_eq!(info["stage_format"], pluvia::study::STAGE_FORMAT, "{out}");
    let (_, text, _) = run(&["info"]);
    let version = info["backends"][0]["version"].as_str().expect("a version");
    assert!(text.contains(version), "the same version {version} in: {text}");
}

#[test]
fn wrong_usage_ends_with_2() {
    for args in [
        &["bogus"][..],
        &["run", SCENARIO],
        &["run", SCENARIO, "--out", "x", "--backend", "abacus"],
        &["run", SCENARIO, "--out", "x", "--set", "rate"],
        &["reproduce", "--configurations", "0"],
        &["grains", SCENARIO, "--format", "dwg", "--out", "x"],
    ] {
        assert!(!refused(args, 2, &[]).is_empty(), "law: {args:?}: it says why");
    }
    // With what is allowed, in words of people.
    for (option, value, words) in [
        ("--seed", "-1", "allowed are whole numbers from 0 to"),
        ("--jobs", "0", "allowed are whole numbers from 1 to 1024"),
        ("--jobs", "many", "allowed are whole numbers from 1 to 1024"),
        ("--backend", "abacus", "allowed are bullet and rapier"),
    ] {
        let said = refused(&["run", SCENARIO, "--out", "x", option, value], 2, &[words]);
        assert!(!said.contains("..=") && !said.contains("variant"), "law: no code, got {said}");
    }
    // Of two values for one path neither is chosen.
    let twice = ["--set", "engine.rate_hz=480", "--set", "engine.rate_hz=960"];
    let words = ["engine.rate_hz=480", "engine.rate_hz=960", "twice"];
    for command in ["run", "compare"] {
        refused(&[&[command, SCENARIO, "--out", "x"][..], &twice].concat(), 2, &words);
    }
    // Where one of several options is needed, all of them are named.
    let none = "scenarios/none.json";
    let cases: [([&str; 2], &[&str]); 3] = [
        (["calibrate", none], &["--angle-of-repose", "--target", "--unknown", "--between"]),
        (["sweep", none], &["--over", "--samples", "--range", "--design"]),
        (["stage", none], &["--level", "--task", "--key", "--list"]),
    ];
    for (args, words) in cases {
        refused(&args, 2, words);
    }
    for (option, value) in
        [("--time", "0,5"), ("--azimuth", "north"), ("--elevation", "nan"), ("--time", "1s")]
    {
        let words = &["allowed are numbers, with a decimal point", option, value];
        let said = refused(&["picture", "x", "--out", "x.png", option, value], 2, words);
        assert!(!said.contains("float"), "law: no word of code, got {said}");
    }
    // A page is no JSON.
    refused(&["schema", "--page", "--json"], 2, &["--page", "--json", "give one of them"]);
    // A list draws nothing.
    for option in ["--force", "--log-x", "--log-y", "--points"] {
        refused(&["plot", "x", "--list", option], 2, &["cannot be used with", option]);
    }
    // A picture has no frames.
    refused(&["picture", "x", "--out", "x.png", "--every", "1"], 2, &[]);
}

#[test]
fn a_faulty_scenario_ends_with_2_and_all_its_faults() {
    let folder = Folder::new();
    let out: &str = &folder.out("out");
    let args = ["run", SCENARIO, "--set", "engine.rate_hz=-1", "--set", "colour=red", "--out", out];
    let (code, stdout, err) = run(&args);
    assert_eq!(code, Some(2), "{err}");
    assert_holds(&err, &["2 faults", "engine.rate_hz", "colour", "no such field"]);
    assert!(stdout.is_empty(), "nothing is printed as a result: {stdout}");
    assert!(!Path::new(out).exists(), "nothing is written for a faulty scenario");
}

/// Law: a run that cannot begin leaves no folder that was not there.
#[test]
fn a_run_that_cannot_begin_leaves_no_folder() {
    let folder = Folder::new();
    let out: &str = &folder.out("out");
    let args = ["run", SCENARIO, "--set", "grains={\"file\":\"none.json\"}", "--out", out];
    refused(&args, 4, &["none.json"]);
    assert!(!Path::new(out).exists(), "law: it is not made");
    fs::create_dir(out).expect("a folder");
    refused(&args, 4, &["none.json"]);
    assert!(Path::new(out).exists(), "law: one that was there stays");
}

/// Law: a pattern that no file matches ends a command as the name of a file does that is not there.
#[test]
fn meshes_that_are_not_there_end_commands_alike() {
    let folder = Folder::new();
    let stages = json!([{ "stage": "fill_funnel" }]);
    for (name, why) in [("none/*.stl", "no file has such a name"), ("none/a.stl", "No such file")] {
        let grains = json!({ "meshes": [name], "mesh_unit": "mm", "density_kg_per_m3": 2650 });
        let scenario = json!({ "name": "lost", "grains": grains, "stages": stages });
        let scenario = folder.scenario("lost.json", &scenario);
        for command in ["grains", "run"] {
            let words = ["cannot read", name, why, "(grains.meshes names it)"];
            refused(&[command, &scenario, "--out", &folder.out("out")], 4, &words);
            assert!(!folder.path("out").exists(), "law: `{command}` leaves no folder");
        }
    }
}

/// Law: a file that Pluvia writes or ships, given as a scenario, is called what it is, in one line.
#[test]
fn other_files_of_the_program_are_no_scenarios() {
    let folder = Folder::new();
    let out: &str = &folder.out("out");
    let run = small_run();
    for (file, what) in [
        (run.join("manifest.json"), "the manifest of a run"),
        (run.join("summary.json"), "the summary of a run"),
        (run.join("specimen.json"), "the specimen of a run"),
        (run.join("grains.json"), "a file of grains"),
        (root().join("scenarios/studies/convergence.json"), "a design of `pluvia converge`"),
        (root().join("scenarios/studies/sensitivity.json"), "a design of `pluvia sensitivity`"),
    ] {
        let said = refused(&["run", text(&file), "--out", out], 2, &[what, "not a scenario"]);
        assert_eq!(said.lines().count(), 1, "law: one line, got {said}");
    }
}

#[test]
fn an_unwritable_output_folder_ends_with_4_before_anything_runs() {
    let folder = Folder::new();
    let file: &str = &folder.out("file");
    fs::write(file, "in the way").expect("a file");
    for command in [&["run", SCENARIO][..], &["grains", SCENARIO], &["reproduce", "--quick"]] {
        let err = refused(&[command, &["--out", file]].concat(), 4, &[file, "it is a file"]);
        assert_eq!(err.lines().count(), 1, "one message: {err}");
    }
    let page = fs::read_to_string(root().join("docs/faq.md")).expect("the page");
    for (what, of_code) in [("help", run(&["--help"]).1), ("docs/faq.md", page.replace('`', ""))] {
        let words = of_code.split_whitespace().collect::<Vec<_>>().join(" ");
        let expected = "not be read or written, as an --out that is a file";
        assert!(words.contains(expected), "law: {what} says so of 4, got {words}");
    }
}

/// Law: help and page name every command that may end with 1.
#[test]
fn commands_that_may_end_with_1_are_named() {
    let page = fs::read_to_string(root().join("docs/faq.md")).expect("the page");
    let between = |text: &str, from: &str, to: &str| -> String {
        let rest = text.split(from).nth(1).unwrap_or_default();
        rest.split(to).next().unwrap_or_default().to_owned()
    };
    let help = between(&run(&["--help"]).1, "; 1 done", "; 2 wrong");
    let page = between(&page, "\n- 1: ", "\n- 2: ");
    let mut count = 0;
    for entry in fs::read_dir(root().join("src/cli")).expect("the files of the commands") {
        let path = entry.expect("an entry").path();
        let code = fs::read_to_string(&path).unwrap_or_default();
        if !code.contains("ExitStatus::by(") && !code.contains("ExitStatus::ExpectationMissed") {
            continue;
        }
        let name = path.file_stem().expect("a name").to_string_lossy().into_owned();
        let name = if name == "reproduce" { "--strict" } else { name.as_str() };
        for (what, text) in [("help", &help), ("docs/faq.md", &page)] {
            assert!(text.contains(name), "law: {what} says of 1 when {name} ends so, got {text}");
        }
        count += 1;
    }
    assert_eq!(count, 7, "law: calibrate, compare, density, reproduce, store, sweep, verify");
}

#[test]
fn grains_are_written_in_every_format() {
    let folder = Folder::new();
    let out: &str = &folder.out("");
    for format in ["json", "obj", "stl", "ply"] {
        let (code, text, err) =
            run(&["grains", SCENARIO, "--format", format, "--json", "--out", out]);
        assert_eq!(code, Some(0), "--format {format}: {err}");
        let made: Value = serde_json::from_str(&text).expect("JSON");
        assert_eq!(made["grains"], 364, "a quarter of the paper's grains: {text}");
        for file in made["files"].as_array().expect("a list") {
            let path = Path::new(file.as_str().expect("a path"));
            let size = fs::metadata(path).map_or(0, |m| m.len());
            assert!(size > 100, "{} holds {size} bytes", path.display());
        }
    }
    for file in ["grains.json", "sieve.csv", "grains.obj", "grains.stl", "grains.ply"] {
        assert!(folder.path(file).exists(), "{file} is missing");
    }
}
