//! Convergence and sensitivity on a few grains, by designs of their own.

use std::{fs, path::Path};

use serde_json::{Value, json};

use super::{
    program::{self, assert_holds, text},
    small,
};

/// Runs a study; gives its exit code, standard output and standard error.
fn study(command: &str, design: &Path, out: &Path) -> (Option<i32>, String, String) {
    program::run(&[command, "--quiet", "--json", "--design", text(design), "--out", text(out)])
}

/// Writes a design beside a scenario of thirty grams.
fn write(folder: &Path, design: &Value) -> std::path::PathBuf {
    // Long enough for what was shaken to come to rest: shorter, some runs are not valid.
    program::write(folder, "small.json", &small::scenario(30.0, 0.25, 1.0));
    program::write(folder, "design.json", design)
}

fn convergence() -> Value {
    json!({
        "full": { "scenario": "small.json", "configurations": 2 },
        "limits": { "height_percent": 1, "settlement_percent": 5 },
        "reference": "rate",
        "ladders": [
            { "name": "rate", "title": "Rate", "rungs": [
                { "name": "240", "title": "240 Hz", "changes": ["engine.rate_hz=240"] },
                { "name": "480", "title": "480 Hz", "changes": ["engine.rate_hz=480"] },
            ] },
            { "name": "stock", "title": "Stock", "changes": ["engine.contact_solver=stock"],
              "configurations": 1, "rungs": [
                { "name": "10", "title": "10 iterations", "changes": ["engine.iterations=10"] },
                { "name": "20", "title": "20 iterations" },
            ] },
        ]
    })
}

fn sensitivity() -> Value {
    json!({
        "full": { "scenario": "small.json", "configurations": 2 },
        "parameters": [
            { "name": "restitution", "title": "Restitution", "reason": "A test.",
              "path": "contact.restitution", "low": 0.25, "default": 0.315, "high": 0.4 },
            { "name": "mass", "title": "Mass", "unit": "g", "reason": "More grains stand higher.",
              "path": "grains.total_mass_g", "low": 30, "high": 60 },
            { "name": "amplitude", "title": "Amplitude", "unit": "mm", "reason": "By changes.",
              "low": 5, "default": 10, "high": 10, "low_changes": ["stages[3].amplitude_mm=5"] },
        ]
    })
}

fn read(out: &Path, file: &str) -> Value {
    program::json(&out.join(file))
}

#[test]
#[ignore = "slow: make test-all"]
fn convergence_holds_every_rung_against_the_finest() {
    let folder = tempfile::tempdir().expect("a folder");
    let design = write(folder.path(), &convergence());
    let out = folder.path().join("out");
    let (code, printed, said) = study("converge", &design, &out);
    assert_eq!(code, Some(0), "{said}");
    let found = read(&out, "convergence.json");
    assert_eq!(serde_json::from_str::<Value>(&printed).expect("JSON"), found, "printed as written");
    let rows = found["rows"].as_array().expect("rows");
    assert_eq!(rows.len(), 4, "one row a rung");
    for (row, runs) in rows.iter().zip([2, 2, 1, 1]) {
        assert_eq!(row["result"]["runs"], runs, "a ladder may have fewer configurations: {row}");
        let from = &row["from_ladder"]["height"]["percent"]["mean"];
        let zero = from.as_f64().is_some_and(|d| d == 0.0);
        if row["result"]["left_out"] == row["result"]["runs"] {
            assert_eq!(*from, Value::Null, "law: what is not valid has no deviation: {row}");
            assert_eq!(row["meets"], json!(false), "law: and does not pass: {row}");
            continue;
        }
        assert_eq!(
            row["finest_of_ladder"],
            json!(zero),
            "law: only the finest deviates by 0: {row}"
        );
    }
    let table = read(&out, "variations.json");
    let runs = table["runs"].as_array().expect("runs");
    let left_out: Vec<&Value> = runs.iter().filter(|r| !r["left_out_of_means"].is_null()).collect();
    assert!(left_out.iter().all(|r| r["valid"] == false), "law: nothing is missing here");
    let counted = rows.iter().filter_map(|r| r["result"]["left_out"].as_u64()).sum::<u64>();
    assert_eq!(counted, left_out.len() as u64, "law: rungs count what their runs are");
    assert!(
        !left_out.is_empty(),
        "law: stock Bullet contacts with ten iterations creep numerically: {rows:?}"
    );
    let page = fs::read_to_string(out.join("convergence.md")).expect("a page");
    assert!(page.contains("no valid run") && page.contains("left out"), "law: told: {page}");
    assert_eq!(table["runs"].as_array().map(Vec::len), Some(6));
    assert_eq!(table["variations"].as_array().map(Vec::len), Some(4));
    for file in [
        "convergence.csv",
        "convergence.md",
        "variations.csv",
        "variation-runs.csv",
        "figures/convergence-height.png",
        "figures/convergence-plate-settlement.svg",
        "figures/convergence-overlap.csv",
        "figures/convergence-creep.svg",
        "figures/convergence-deviations.png",
        "figures/convergence-cost.svg",
        "runs/rate-240-c1/summary.json",
        "runs/stock-20-c1/manifest.json",
    ] {
        assert!(out.join(file).is_file(), "{file} is written");
    }
    // What is done is not done again: wall times come from the store.
    let (code, _, said) = study("converge", &design, &out);
    assert_eq!(code, Some(0), "{said}");
    assert_eq!(read(&out, "convergence.json"), found, "law: resumed, the same to the last bit");

    // Another design, or less of this one, leaves all as it is.
    type Change = fn(&mut Value);
    let changes: [(Change, &str); 4] = [
        (|d| d["limits"]["height_percent"] = json!(2), "`limits.height_percent` differs"),
        (|d| d["full"]["configurations"] = json!(1), "`configurations` was 2, and is 1"),
        (|d| drop(d["ladders"].as_array_mut().map(Vec::pop)), "`variations.stock-10` is missing"),
        (|d| d["full"]["changes"] = json!(["contact.restitution=0.2"]), "`scenario.contact"),
    ];
    for (change, words) in changes {
        let mut other = convergence();
        change(&mut other);
        let (code, _, said) = study("converge", &write(folder.path(), &other), &out);
        assert_eq!(code, Some(2), "law: refused: {said}");
        assert!(said.contains(words) && said.contains("--out"), "law: `{words}`, got {said}");
        assert_eq!(read(&out, "convergence.json"), found, "law: nothing is written over");
    }
}

#[test]
#[ignore = "slow: make test-all"]
fn sensitivity_gives_effects_in_pairs() {
    let folder = tempfile::tempdir().expect("a folder");
    let design = write(folder.path(), &sensitivity());
    let out = folder.path().join("out");
    let (code, printed, said) = study("sensitivity", &design, &out);
    assert_eq!(code, Some(0), "{said}");
    let found: Value = serde_json::from_str(&printed).expect("JSON");
    let [restitution, mass, amplitude] = &found["parameters"].as_array().expect("rows")[..] else {
        panic!("three parameters: {printed}")
    };
    let of = |row: &Value, what: &str| row["height"][what]["mean"].as_f64();
    let (low, high) = (of(restitution, "low_mm"), of(restitution, "high_mm"));
    let range = of(restitution, "range_mm").expect("an effect");
    let sum = high.zip(low).map(|(h, l)| h - l).expect("both ends");
    assert!((range - sum).abs() < 1e-9, "law: high - low = (high - default) - (low - default)");
    assert_eq!(mass["default"], 30.0, "law: a default left out is the scenario's own");
    assert!(
        of(mass, "range_mm").is_some_and(|h| h > 1.0),
        "law: twice the grains stand higher: {mass}"
    );
    let slope = of(mass, "per_unit_mm").zip(of(mass, "range_mm")).expect("an effect");
    assert!((slope.0 * 30.0 - slope.1).abs() < 1e-9, "law: 30 g of range: {mass}");
    assert_eq!(of(amplitude, "high_mm"), Some(0.0), "law: the default end moves nothing");
    assert_eq!(of(amplitude, "low_mm"), Some(0.0), "law: pouring knows nothing of the table");
    for file in
        ["sensitivity.csv", "sensitivity.md", "figures/sensitivity.svg", "figures/sensitivity.png"]
    {
        assert!(out.join(file).is_file(), "{file} is written");
    }
    let runs = fs::read_dir(out.join("runs")).expect("runs").count();
    assert_eq!(runs, 10, "the default, two ends, one end and one end, twice each");
    by_sweeps(&design, &out, &found);

    let mut other = sensitivity();
    other["parameters"][0]["high"] = json!(0.5);
    let (code, _, said) = study("sensitivity", &write(folder.path(), &other), &out);
    assert_eq!(code, Some(2), "law: another design is refused: {said}");
    assert!(said.contains("`variations.restitution-high`"), "law: it says where, got {said}");
    assert_eq!(read(&out, "sensitivity.json"), found, "law: nothing is written over");
}

/// Holds what `pluvia sweep` makes of the same changes against a sensitivity
/// study: of its design, and of fields one at a time. Both go on with the
/// study's stages, which they find only if they plan the same.
fn by_sweeps(design: &Path, study: &Path, found: &Value) {
    let folder = design.parent().expect("a folder");
    let stages = || fs::read_dir(study.join("stages")).expect("stages").count();
    let stored = stages();
    let sweep = |name: &str, arguments: &[&str]| -> Value {
        let out = folder.join(name);
        fs::create_dir_all(&out).expect("a folder");
        fs::rename(study.join("stages"), out.join("stages")).expect("moved");
        let args = ["sweep", "--quiet", "--json", "--out", text(&out)];
        let printed = program::done(&[&args[..], arguments].concat());
        fs::rename(out.join("stages"), study.join("stages")).expect("moved");
        assert_eq!(stages(), stored, "law: {name} plans the very stages of the study");
        let swept: Value = serde_json::from_str(&printed).expect("JSON");
        let table = read(&out, "sensitivity.json");
        hold_slopes(name, &table, &swept);
        table
    };
    let by_design = sweep("by-design", &["--design", text(design)]);
    assert_eq!(by_design["parameters"], found["parameters"], "law: the same table to the last bit");
    let [same, other] = [study, &folder.join("by-design")].map(|out| {
        let table = fs::read(out.join("sensitivity.csv")).expect("a table");
        String::from_utf8(table).expect("UTF-8")
    });
    assert_eq!(same, other, "law: and as bytes");

    let scenario = folder.join("small.json");
    let by_fields = [
        "--one-at-a-time",
        "--configurations=2",
        "--over=contact.restitution=0.25,0.4",
        "--over=grains.total_mass_g=60",
        "--over=stages.3.amplitude_mm=5",
        text(&scenario),
    ];
    let by_fields = sweep("by-fields", &by_fields);
    for n in 0..3 {
        for what in ["low", "default", "high", "height", "plate", "surface"] {
            let [one, other] = [&by_fields, found].map(|table| &table["parameters"][n][what]);
            assert_eq!(one, other, "law: {what} of parameter {n} to the last bit");
        }
    }
}

/// Expects the effects of a sweep to be those of the table beside it: change for
/// one unit and its 95 % confidence interval.
fn hold_slopes(name: &str, table: &Value, swept: &Value) {
    let effects = swept["effects"].as_array().expect("effects");
    let mut held = 0;
    for (n, row) in table["parameters"].as_array().expect("rows").iter().enumerate() {
        let factor = &swept["factors"][n]["path"];
        for (ours, theirs) in [
            ("height", "poured_height_mm.mean_surface"),
            ("plate", "settlement_mm.final"),
            ("surface", "surface_settlement_mm.final"),
        ] {
            let effect = effects.iter().find(|e| e["factor"] == *factor && e["outcome"] == theirs);
            let effect = effect.unwrap_or_else(|| panic!("{name}: {factor} on {theirs}"));
            let row = &row[ours];
            assert!(row["per_unit_mm"]["mean"].is_number(), "{name}: {row}");
            assert_eq!(effect["slope"], row["per_unit_mm"]["mean"], "law: {name}, {factor}");
            let half = &row["per_unit_half_width_95_mm"];
            assert_eq!(effect["slope_half_width"], *half, "law: {name}, {factor}, interval");
            held += 1;
        }
    }
    assert_eq!(held, 9, "{name}: three parameters on three lengths");
}

/// Expects a design to be refused, with a number of faults and these words.
fn refused(command: &str, design: &Value, count: usize, words: &[&str]) {
    let folder = tempfile::tempdir().expect("a folder");
    let path = write(folder.path(), design);
    let out = folder.path().join("out");
    let (code, printed, said) = study(command, &path, &out);
    assert_eq!(code, Some(2), "law: a faulty design ends with 2: {said}");
    if count > 1 {
        assert!(said.contains(&format!("{count} faults")), "expected {count} faults: {said}");
    }
    assert_holds(&said, words);
    assert!(printed.is_empty() && !out.exists(), "nothing is printed or written: {said}");
}

#[test]
fn faulty_designs_are_refused_with_every_fault_named() {
    let mut bad = convergence();
    bad["ladders"][0]["rungs"][0]["changes"] = json!(["rate"]);
    bad["ladders"][1]["name"] = json!("a/b");
    bad["reference"] = json!("nothing");
    let words = ["design.json", "ladders[0].rungs[0].changes[0]", "ladders[1].name", "reference"];
    refused("converge", &bad, 3, &words);

    let mut bad = convergence();
    bad["limits"]["height_percent"] = json!(-1);
    bad["ladders"][0]["colour"] = json!("red");
    bad["ladders"][1]["rungs"] = json!([]);
    let words = ["limits.height_percent", "ladders[0].colour", "no such field", "ladders[1].rungs"];
    refused("converge", &bad, 3, &words);

    let mut bad = convergence();
    bad["ladders"][0]["rungs"][0]["changes"] = json!(["engine.rate_hz=1"]);
    bad["ladders"][1]["rungs"][0]["changes"] = json!(["engine.iteration=10"]);
    let words = ["rate-240", "engine.rate_hz", "stock-10", "did you mean `iterations`"];
    refused("converge", &bad, 2, &words);

    let mut bad = sensitivity();
    bad["parameters"][0]["default"] = json!(0.4);
    bad["parameters"][1]["path"] = json!("grains.nothing");
    bad["parameters"][2]["low_changes"] = json!([]);
    let words = ["the scenario has another value", "no number there", "parameters[2].low_changes"];
    refused("sensitivity", &bad, 3, &words);

    let mut bad = sensitivity();
    bad["parameters"][0]["high"] = json!(0.1);
    bad["parameters"][1]["name"] = json!("restitution");
    refused("sensitivity", &bad, 2, &["out of order", "parameters[1].name", "given twice"]);

    let mut bad = sensitivity();
    bad["parameters"][0]["path"] = json!("engine.native.sweeps");
    let words = ["parameters[0].path", "this field is now called `engine.native.iterations`"];
    refused("sensitivity", &bad, 1, &words);
}

#[test]
fn a_design_without_a_smaller_specimen_is_refused_with_quick() {
    let folder = tempfile::tempdir().expect("a folder");
    let design = write(folder.path(), &convergence());
    for (command, arguments, code) in [
        ("converge", vec!["--quick", "--design", text(&design)], 2),
        ("converge", vec!["--design", "nowhere.json"], 4),
        ("sensitivity", vec!["--configurations", "0"], 2),
    ] {
        let out = folder.path().join("out");
        let args = [&[command, "--out", text(&out)][..], &arguments].concat();
        program::refused(&args, code, &[]);
        assert!(!out.exists(), "nothing is written");
    }
}
