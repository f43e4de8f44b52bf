//! Scenario files: those of the project load, and faulty ones are answered
//! with every fault, its place and what is allowed there.

mod beside_pieces;
mod from_file;
mod grains_alone;
mod hostile;
mod left_out;
mod motion;
mod random;
mod sizes;
mod stages;

use std::{
    fs,
    path::{Path, PathBuf},
};

use pluvia::grains::{ParticleSizeDistribution, load_scenario};
use pluvia::scenario::{Fault, GrainsSpec, Override, Scenario, ScenarioErrors, check, schema};
use serde_json::{Value, json};

use super::program::{assert_holds, json as read, root};

/// Every scenario of built-in apparatus under `scenarios/` that needs no other files: those of pieces
/// are in `laboratory.rs`, that of meshes in `meshes.rs`, that of a begun run in `begin.rs`.
fn files() -> Vec<PathBuf> {
    fn walk(folder: &Path, found: &mut Vec<PathBuf>) {
        for entry in fs::read_dir(folder).expect("scenarios/ can be listed") {
            let path = entry.expect("a folder entry can be read").path();
            if path.is_dir() { walk(&path, found) } else { found.push(path) }
        }
    }
    let mut found = Vec::new();
    for folder in ["load", "paper", "quick", "scale", "rounded", "spheres", "studies/joint"] {
        walk(&root().join("scenarios").join(folder), &mut found);
    }
    found.sort();
    assert!(found.len() >= 5, "expected the scenarios of the paper and the quick ones: {found:?}");
    found
}

fn grain_count(scenario: &Scenario) -> usize {
    let GrainsSpec::Sieved(sieved) = &scenario.grains else {
        panic!("{} has grains from a file", scenario.name)
    };
    let distribution = ParticleSizeDistribution::new(sieved).expect("no fraction is empty");
    distribution.fractions.iter().map(|f| f.grains).sum()
}

#[test]
fn every_scenario_of_the_project_loads_and_says_its_choices() {
    let validator = jsonschema::validator_for(&schema()).expect("a sound schema");
    for file in files() {
        let loaded =
            load_scenario(&file, &[]).unwrap_or_else(|e| panic!("{}: {e}", file.display()));
        let scenario = loaded.scenario;
        assert!(!scenario.notes.is_empty(), "{} has no notes", file.display());
        let expected = match file.parent().and_then(Path::file_name) {
            Some(folder) if folder == "paper" => Some(1456),
            Some(folder) if folder == "quick" => Some(364),
            Some(folder) if folder == "scale" => match scenario.name.as_str() {
                "sand" => Some(1623),
                "ballast" => Some(489),
                _ => Some(364),
            },
            Some(folder) if folder == "load" => {
                let name = file.file_stem().expect("a name").to_string_lossy();
                Some(name.trim_end_matches("-grains").parse().expect("a number of grains"))
            }
            _ => None,
        };
        if let Some(expected) = expected {
            let got = grain_count(&scenario);
            assert_eq!(got, expected, "law: n = V / (π/6 d³) a fraction, in {}", file.display());
        }
        check(&scenario).unwrap_or_else(|e| panic!("{} as a value: {e}", file.display()));
        let raw = read(&file);
        let faults: Vec<_> = validator.iter_errors(&raw).map(|e| e.to_string()).collect();
        assert!(faults.is_empty(), "{} and the schema disagree: {faults:?}", file.display());
    }
}

#[test]
fn extends_merges_objects_and_replaces_lists() {
    let load = |path: &str| load_scenario(&root().join(path), &[]).expect("it loads");
    let quick = load("scenarios/quick/vibration.json");
    assert_eq!(quick.files.len(), 3, "vibration, pluviation and the paper's: {:?}", quick.files);
    let scenario = quick.scenario;
    assert_eq!(scenario.apparatus.cylinder.inner_diameter_mm, 72.5, "from quick/pluviation");
    assert_eq!(scenario.apparatus.top_plate.thickness_mm, 10.0, "the default");
    assert_eq!(scenario.apparatus.top_plate.mass_g, 41.0, "its own");
    assert_eq!(scenario.stages.len(), 4, "the list of stages is its own");
    let GrainsSpec::Sieved(sieved) = scenario.grains else { panic!("sieved grains") };
    assert_eq!(sieved.density_kg_per_m3, 2673.9, "from paper/pluviation");
}

/// A sound scenario, for tests to spoil.
fn sound() -> Value {
    json!({
        "name": "sound",
        "grains": {
            "total_mass_g": 500,
            "density_kg_per_m3": 2650,
            "sieve_table": [
                { "passing_mm": 16, "retained_mm": 11.2, "mass_percent": 60 },
                { "passing_mm": 11.2, "retained_mm": 8, "mass_percent": 40 },
            ],
        },
        "stages": [
            { "stage": "fill_funnel" },
            { "stage": "pour", "falling_height_mm": 50 },
        ],
    })
}

/// Paths and texts of the faults for which a scenario was refused; none where it was not.
pub fn told<T>(scenario: Result<T, ScenarioErrors>) -> Vec<(String, String)> {
    match scenario {
        Ok(_) => Vec::new(),
        Err(ScenarioErrors::Faults(faults)) => {
            faults.into_iter().map(|f| (f.path.clone(), f.to_string())).collect()
        }
        Err(other) => panic!("{other}"),
    }
}

/// The same of a scenario's file.
pub fn told_of(value: &Value) -> Vec<(String, String)> {
    told(load_text(&value.to_string(), &[]))
}

/// A fault is reported at a path, with words.
#[track_caller]
pub fn assert_told(found: &[(String, String)], path: &str, words: &str) {
    let is_told = found.iter().any(|(at, text)| at == path && text.contains(words));
    assert!(is_told, "law: `{path}` is reported with `{words}`, got {found:#?}");
}

/// A scenario's file has one fault, at a path, with words.
#[track_caller]
pub fn assert_one(value: &Value, path: &str, words: &str) {
    let found = told_of(value);
    assert_told(&found, path, words);
    assert_eq!(found.len(), 1, "law: it alone, got {found:#?}");
}

/// A value with another one at a path such as `stages[1].stage`.
pub fn changed(mut value: Value, path: &str, to: Value) -> Value {
    *place(&mut value, path) = to;
    value
}

/// A folder with the given files.
fn folder(files: &[(&str, &str)]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a temporary folder");
    for (name, text) in files {
        fs::write(folder.path().join(name), text).expect("a file in it");
    }
    folder
}

fn load_text(text: &str, overrides: &[&str]) -> Result<Scenario, ScenarioErrors> {
    let folder = folder(&[("s.json", text)]);
    let overrides: Vec<Override> =
        overrides.iter().map(|o| o.parse().expect("an override")).collect();
    load_scenario(&folder.path().join("s.json"), &overrides).map(|loaded| loaded.scenario)
}

fn faults(value: &Value) -> Vec<Fault> {
    match load_text(&value.to_string(), &[]) {
        Ok(_) => Vec::new(),
        Err(errors) => errors.faults().to_vec(),
    }
}

/// Spoils the sound scenario, and expects one fault at a path whose text holds the words.
fn expect_one(spoil: impl FnOnce(&mut Value), path: &str, words: &[&str]) {
    let mut value = sound();
    assert_eq!(faults(&value), [], "the scenario is sound before it is spoiled");
    spoil(&mut value);
    let found = faults(&value);
    assert_eq!(found.len(), 1, "one fault expected at {path}, got {found:#?}");
    assert_eq!(found[0].path, path, "path of the fault {}", found[0]);
    let text = found[0].to_string();
    assert!(found[0].file.ends_with("s.json"), "the fault names its file: {text}");
    assert_eq!(text.lines().count(), 1, "a fault is one line: {text}");
    assert_holds(&text, words);
}

/// Objects that a scenario may leave out: a path that leads into one makes it.
const LEFT_OUT: [&str; 10] = [
    "apparatus",
    "contact",
    "cylinder",
    "engine",
    "funnel",
    "native",
    "settle",
    "top_plate",
    "vertical",
    "video_frames",
];

/// The place in a value of a path such as `stages[1].stage`; what it leads through is there, or may
/// be left out.
fn place<'a>(value: &'a mut Value, path: &str) -> &'a mut Value {
    let (mut at, mut through) = (value, "");
    for step in path.split(['.', '[']).map(|step| step.trim_end_matches(']')) {
        let is_there = !at.is_null() || LEFT_OUT.contains(&through);
        assert!(is_there, "law: `{path}` leads somewhere: there is no `{through}`");
        at = match step.parse::<usize>() {
            Ok(index) => &mut at[index],
            Err(_) => &mut at[step],
        };
        through = step;
    }
    at
}

/// Puts a value at a path of the sound scenario, and expects one fault there.
fn expect_at(path: &str, to: Value, words: &[&str]) {
    expect_one(|s| *place(s, path) = to, path, words);
}

#[test]
fn unknown_fields_are_named_with_what_is_known() {
    let words = ["no such field", "did you mean `iterations`", "found 50", "`rate_hz`"];
    expect_at("engine.iteration", json!(50), &words);
    expect_at("engine.", json!(50), &["the field has no name", "`rate_hz`"]);
    expect_at("name", json!("\u{200b}\u{feff}"), &["nothing of the name is seen: U+200B, U+FEFF"]);
    expect_at("colour", json!("red"), &["no such field", "`gravity_m_per_s2`"]);
    expect_at("extend", json!("base.json"), &["did you mean `extends`", "and `extends`"]);
    expect_at("grains.densty_kg_per_m3", json!(1), &["did you mean `density_kg_per_m3`"]);
    expect_at("stages[1].height_mm", json!(1), &["no such field", "`falling_height_mm`"]);
}

#[test]
fn a_mass_too_small_for_every_fraction_is_a_fault_of_the_mass() {
    expect_at("grains.total_mass_g", json!(0.01), &["not every fraction", "at least"]);
}

#[test]
fn unions_are_decided_before_they_are_checked() {
    expect_one(
        |s| s["grains"] = json!({ "file": "grains.json", "total_mass_g": 1 }),
        "grains.total_mass_g",
        &["no such field", "the field `file`"],
    );
    expect_one(|s| s["grains"] = json!({ "file": 7 }), "grains.file", &["wrong type", "a text"]);
    let words = ["no such choice", "did you mean \"pour\"", "\"vibrate\""];
    expect_at("stages[1].stage", json!("poor"), &words);
    // What follows it, and what it might be, is not judged.
    let plate_and_more = |s: &mut Value| {
        let stages = s["stages"].as_array_mut().expect("a list");
        stages[1]["stage"] = json!("poor");
        stages.push(json!({ "stage": "place_top_plate" }));
        stages.push(json!({ "stage": "vibrate", "frequency_hz": 3, "amplitude_mm": 25,
            "duration_s": 1 }));
    };
    expect_one(plate_and_more, "stages[1].stage", &words);
    let words = ["no such choice", "did you mean \"fill_funnel\""];
    expect_at("stages[0].stage", json!("fill_funel"), &words);
    expect_one(
        |s| s["stages"][1] = json!({ "stage": "pour" }),
        "stages[1].falling_height_mm",
        &["missing", "a number of at least 0 and at most 10000"],
    );
    expect_one(|s| s["stages"][1] = json!({}), "stages[1].stage", &["missing", "\"fill_funnel\""]);
}

#[test]
fn wrong_types_and_missing_fields_are_named() {
    let words = ["wrong type", "found \"much\"", "a number above 0"];
    expect_at("grains.total_mass_g", json!("much"), &words);
    expect_at("engine", json!([]), &["wrong type", "an object"]);
    let words = ["wrong type", "20.5", "a whole number of at least 1"];
    expect_at("engine.iterations", json!(20.5), &words);
    expect_at("gravity_m_per_s2", Value::Null, &["wrong type", "found null"]);
    expect_one(
        |s| drop(s.as_object_mut().expect("an object").remove("grains")),
        "grains",
        &["missing", "`sieve_table`", "`file`"],
    );
    let mut whole = sound();
    whole["engine"] = json!({ "iterations": 20.0 });
    assert_eq!(faults(&whole), [], "20.0 is a whole number");
}

#[test]
fn all_faults_come_at_once() {
    let mut value = sound();
    value["colour"] = json!("red");
    value["grains"]["total_mass_g"] = json!(0);
    value["grains"]["sieve_table"][1]["passing_mm"] = json!(10);
    value["apparatus"] = json!({ "cylinder": { "inner_diameter_mm": "wide", "height_mm": -1 } });
    value["engine"] = json!({ "rate_hz": 100, "iteration": 5 });
    value["stages"][1]["falling_height_mm"] = json!(true);
    let found = faults(&value);
    let mut paths: Vec<&str> = found.iter().map(|f| f.path.as_str()).collect();
    paths.sort_unstable();
    let expected = [
        "apparatus.cylinder.height_mm",
        "apparatus.cylinder.inner_diameter_mm",
        "colour",
        "engine.iteration",
        "engine.rate_hz",
        "grains.sieve_table[1].passing_mm",
        "grains.total_mass_g",
        "stages[1].falling_height_mm",
    ];
    assert_eq!(paths, expected, "structure and meaning together, got {found:#?}");
}

#[test]
fn text_that_is_no_json_is_located() {
    let found = load_text("{\n  \"name\": \"a\",\n  oops\n}", &[]).expect_err("no JSON");
    assert_eq!(found.faults()[0].path, "line 3, column 3", "{found}");
    let found = load_text("{} {}", &[]).expect_err("two values");
    assert!(found.to_string().contains("line 1"), "{found}");
    let found = load_text("[1]", &[]).expect_err("a list");
    assert!(found.to_string().contains("a scenario is an object"), "{found}");
}

#[test]
fn fields_given_twice_are_refused() {
    let text = sound().to_string();
    let text = text.replacen("\"density_kg_per_m3\":2650", "\"total_mass_g\":7,$0", 1);
    let text = text.replace("$0", "\"density_kg_per_m3\":2650");
    let found = load_text(&text, &[]).expect_err("a field is given twice");
    assert_eq!(found.faults().len(), 1, "{found}");
    assert_eq!(found.faults()[0].path, "grains.total_mass_g");
    assert!(found.to_string().contains("given twice"), "{found}");
}

#[test]
fn faults_name_the_file_that_gives_the_value() {
    let mut base = sound();
    base["engine"] = json!({ "rate_hz": -1, "iterations": 20 });
    let top = json!({ "extends": "base.json", "name": "top", "engine": { "iterations": 0 } });
    let folder = folder(&[("base.json", &base.to_string()), ("top.json", &top.to_string())]);
    let found =
        load_scenario(&folder.path().join("top.json"), &["seed=x".parse().expect("an override")])
            .expect_err("three faults");
    let mut files: Vec<(String, String)> = found
        .faults()
        .iter()
        .map(|f| (f.path.clone(), f.file.rsplit('/').next().unwrap_or_default().to_owned()))
        .collect();
    files.sort();
    let expected = [
        ("engine.iterations", "top.json"),
        ("engine.rate_hz", "base.json"),
        ("seed", "--set seed=x"),
    ];
    assert_eq!(files, expected.map(|(p, f)| (p.to_owned(), f.to_owned())), "{found}");
}

#[test]
fn circles_and_chains_of_extends_end() {
    let folder_of = |files: &[(&str, &str)]| {
        let folder = folder(files);
        load_scenario(&folder.path().join("a.json"), &[]).expect_err("a fault")
    };
    let circle = folder_of(&[
        ("a.json", r#"{ "extends": "b.json" }"#),
        ("b.json", r#"{ "extends": "./a.json" }"#),
    ]);
    assert!(circle.to_string().contains("in a circle"), "{circle}");
    let own = folder_of(&[("a.json", r#"{ "extends": "a.json" }"#)]);
    assert!(own.to_string().contains("in a circle"), "{own}");
    let empty = folder_of(&[("a.json", r#"{ "extends": "" }"#)]).to_string();
    assert!(empty.contains("extends: it is empty"), "law: a fault of its field, got {empty}");
    let missing = folder_of(&[("a.json", r#"{ "extends": "nowhere.json" }"#)]);
    assert!(
        matches!(&missing, ScenarioErrors::Unreadable { file, .. } if file.ends_with("nowhere.json")),
        "{missing}"
    );
    assert!(missing.to_string().contains("a.json extends it"), "{missing}");
    let names: Vec<String> =
        (0..12).map(|i| if i == 0 { "a.json".into() } else { format!("{i}.json") }).collect();
    let texts: Vec<String> =
        (0..12).map(|i| format!(r#"{{ "extends": "{}.json" }}"#, i + 1)).collect();
    let files: Vec<(&str, &str)> =
        names.iter().map(String::as_str).zip(texts.iter().map(String::as_str)).collect();
    let long = folder_of(&files);
    assert!(long.to_string().contains("more than 8 files"), "{long}");
}

#[test]
fn grains_files_are_found_beside_the_scenario() {
    let mut base = sound();
    base["grains"] = json!({ "file": "my/grains.json" });
    let top = json!({ "extends": "base.json", "name": "top" });
    let sieved = json!({ "extends": "base.json", "grains": sound()["grains"] });
    let folder = folder(&[
        ("base.json", &base.to_string()),
        ("top.json", &top.to_string()),
        ("sieved.json", &sieved.to_string()),
    ]);
    let load =
        |name: &str| load_scenario(&folder.path().join(name), &[]).expect("it loads").scenario;
    let GrainsSpec::File(grains) = load("top.json").grains else { panic!("grains from a file") };
    assert_eq!(Path::new(&grains.file), folder.path().join("my/grains.json"));
    assert!(
        matches!(load("sieved.json").grains, GrainsSpec::Sieved(_)),
        "sieve data replace a file"
    );
}

#[test]
fn overrides_change_values() {
    let text = sound().to_string();
    let overrides = [
        "engine.rate_hz=960",
        "stages.1.falling_height_mm=200",
        "stages[1].time_limit_s=8",
        "name=other",
    ];
    let scenario = load_text(&text, &overrides).expect("sound overrides");
    assert_eq!(scenario.engine.rate_hz, 960.0);
    assert_eq!(scenario.engine.iterations, 20, "fields beside it keep their values");
    assert_eq!(scenario.falling_height_mm(), Some(200.0));
    assert_eq!(scenario.stages[1].longest(), 8.0);
    assert_eq!(scenario.name, "other");
    for (change, words) in [
        ("engine.ratehz=960", "did you mean `rate_hz`"),
        ("motor.rate_hz=960", "no such field"),
        ("stages.7.falling_height_mm=1", "found 7; allowed: 0 to 1, the elements of the list"),
        ("stages.last.falling_height_mm=1", "the path leads nowhere"),
        ("name.first=a", "the path leads nowhere"),
        ("engine.rate_hz=fast", "wrong type"),
        ("engine=960", "wrong type"),
        ("extends=b.json", "what a scenario extends cannot be changed"),
        ("extends.a=1", "what a scenario extends cannot be changed"),
    ] {
        let found = load_text(&text, &[change]).expect_err(change);
        assert_eq!(found.faults().len(), 1, "{found}");
        let said = found.to_string();
        assert!(said.contains(words) && said.starts_with("--set "), "`{change}`: {said}");
    }
    for (notes, words) in [("[]", "the list is empty"), (r#"["b"]"#, "0, the only element")] {
        let given = format!("notes={notes}");
        let found =
            load_text(&text, &[&given, "notes.1=a"]).expect_err("law: there is no such element");
        assert!(found.to_string().contains(words), "law: `{words}` of {notes}, got {found}");
    }
}

#[test]
fn scenarios_survive_the_round_trip_through_json() {
    for file in files() {
        let scenario = load_scenario(&file, &[]).expect("it loads").scenario;
        let back =
            load_text(&serde_json::json!(scenario).to_string(), &[]).expect("its own JSON loads");
        assert_eq!(back, scenario, "{} read, written and read again", file.display());
    }
    let mut unsound = load_text(&sound().to_string(), &[]).expect("it loads");
    unsound.engine.rate_hz = f64::NAN;
    let found = check(&unsound).expect_err("a rate that is no number");
    assert_eq!(found.faults()[0].path, "engine.rate_hz", "{found}");
}
