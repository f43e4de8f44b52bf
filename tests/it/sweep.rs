//! `pluvia sweep` on a few grains: what it plans, what it finds, what it
//! refuses, and that it goes on from where it was.

use std::{
    collections::BTreeSet,
    fs,
    path::{Path, PathBuf},
    process::Command,
};

use serde_json::Value;

use super::small;

fn write(folder: &Path) -> PathBuf {
    let path = folder.join("small.json");
    fs::write(&path, small::layer(30.0).to_string()).expect("a scenario file");
    path
}

/// Runs the command; gives its exit code, standard output and standard error.
pub fn sweep(scenario: &Path, out: &Path, more: &[&str]) -> (Option<i32>, String, String) {
    let output = Command::new(env!("CARGO_BIN_EXE_pluvia"))
        .args(["sweep", "--quiet", "--json"])
        .arg(scenario)
        .arg("--out")
        .arg(out)
        .args(more)
        .output()
        .expect("the program starts");
    let text = |bytes| String::from_utf8(bytes).expect("UTF-8");
    (output.status.code(), text(output.stdout), text(output.stderr))
}

const GRID: [&str; 4] =
    ["--over", "grains.total_mass_g=30,60", "--over", "contact.grain_grain_friction=0.3,0.8"];

/// The table, its header first.
fn rows(out: &Path) -> Vec<Vec<String>> {
    let table = csv::ReaderBuilder::new().has_headers(false).from_path(out.join("sweep.csv"));
    let rows = table.expect("sweep.csv").into_records().map(|r| r.expect("a row"));
    rows.map(|row| row.iter().map(str::to_owned).collect()).collect()
}

#[test]
fn a_grid_gives_one_row_a_run_and_goes_on_where_it_was() {
    let folder = tempfile::tempdir().expect("a folder");
    let (scenario, out) = (write(folder.path()), folder.path().join("out"));
    let (code, _, said) = sweep(&scenario, &out, &GRID);
    assert_eq!(code, Some(0), "{said}");
    let first = rows(&out);
    assert_eq!(first.len(), 5, "law: a header and 2 × 2 points in one configuration");
    let column = |name: &str| {
        first[0].iter().position(|n| n == name).unwrap_or_else(|| panic!("no column {name}"))
    };
    let heights: Vec<f64> = first[1..]
        .iter()
        .map(|row| row[column("standing_height_mm.mean_surface")].parse().expect("a height"))
        .collect();
    assert!(heights[2] > heights[0], "law: more grains stand higher, got {heights:?}");

    assert_eq!(column("valid"), column("meets_standard") + 1, "law: one beside the other");
    for row in &first[1..] {
        let path = out.join("runs").join(&row[column("run")]).join("summary.json");
        let summary: Value =
            serde_json::from_str(&fs::read_to_string(path).expect("a summary")).expect("JSON");
        for name in ["meets_standard", "valid"] {
            assert_eq!(
                row[column(name)],
                summary[name].to_string(),
                "law: {name} as the run has it"
            );
        }
    }

    // With two more configurations only what is new is run.
    let stages = || -> BTreeSet<_> {
        let found = fs::read_dir(out.join("stages")).expect("stages").flatten();
        found.map(|e| (e.file_name(), e.metadata().and_then(|m| m.modified()).ok())).collect()
    };
    let before = stages();
    let more = [&GRID[..], &["--configurations", "3"]].concat();
    let (code, printed, said) = sweep(&scenario, &out, &more);
    assert_eq!(code, Some(0), "{said}");
    assert!(before.is_subset(&stages()), "law: stored stages are taken as they are");
    let second = rows(&out);
    assert_eq!(second.len(), 13, "law: three configurations");
    assert_eq!(first[..5], second[..5], "law: the first configuration is what it was");
    let found: Value = serde_json::from_str(&printed).expect("JSON");
    let effects = found["effects"].as_array().expect("effects");
    let of_mass = effects.iter().find(|e| e["factor"] == "grains.total_mass_g").expect("mass");
    assert!(of_mass["slope"].as_f64().is_some_and(|s| s > 0.0), "law: height grows, {of_mass}");
    assert!(of_mass["slope_half_width"].is_number(), "law: three configurations, an interval");
    assert_eq!((&of_mass["runs"], &of_mass["left_out"]), (&12.into(), &0.into()), "law: all count");
    for file in ["plan.json", "sweep.json", "sweep.md", "report.html"] {
        assert!(out.join(file).exists(), "{file} is missing");
    }
    let drawn = fs::read_dir(out.join("figures")).expect("figures").count();
    assert_eq!(drawn, 9, "law: two factors and a pair, in three formats each");

    let plan: Value =
        serde_json::from_str(&fs::read_to_string(out.join("plan.json")).expect("plan.json"))
            .expect("JSON");
    let runs = plan["runs"].as_array().expect("runs");
    assert_eq!(runs.len(), 12, "law: the plan has every run");
    for run in runs {
        // Folders have the first digits of the key.
        let key = run["key"].as_str().and_then(|k| k.get(..24)).expect("a key");
        assert!(out.join("stages").join(key).is_dir(), "law: the last stage lies under its key");
    }

    let (code, _, said) = sweep(&scenario, &out, &GRID);
    assert_eq!(code, Some(2), "law: fewer configurations would take rows out: {said}");
    for words in ["plan.json", "`configurations` is 3 there and 1 now", "at least 3", "--out"] {
        assert!(said.contains(words), "`{words}` is missing in: {said}");
    }
    assert_eq!(rows(&out), second, "law: no row is lost");

    let other = ["--over", "seed=1,2"];
    let (code, _, said) = sweep(&scenario, &out, &other);
    assert_eq!(code, Some(2), "law: the folder of another sweep is refused");
    assert!(said.contains("another sweep"), "{said}");
    assert_eq!(rows(&out), second, "law: nothing was written over");
}

/// Law: without a rest test no run is valid; the sweep says so in every file and as its last
/// line, and makes no mean of such runs.
#[test]
fn where_no_run_is_valid_there_is_no_mean() {
    let folder = tempfile::tempdir().expect("a folder");
    let (scenario, out) = (write(folder.path()), folder.path().join("out"));
    let over = ["--over", "grains.total_mass_g=30,60", "--set", "rest_test_s=0"];
    let (code, printed, said) = sweep(&scenario, &out, &over);
    assert_eq!(code, Some(0), "{said}");
    let found: Value = serde_json::from_str(&printed).expect("JSON");
    for point in found["points"].as_array().expect("points") {
        assert_eq!(point["left_out"], 1, "law: counted: {point}");
        assert_eq!(point["outcomes"], serde_json::json!({}), "law: no mean: {point}");
    }
    for effect in found["effects"].as_array().expect("effects") {
        assert_eq!((&effect["slope"], &effect["left_out"]), (&Value::Null, &2.into()), "{effect}");
    }
    let table = rows(&out);
    let column = table[0].iter().position(|n| n == "left_out_of_means").expect("a column");
    for row in &table[1..] {
        assert!(row[column].contains("accuracy standard"), "law: the row says why: {row:?}");
    }
    for file in ["sweep.md", "report.html"] {
        let page = fs::read_to_string(out.join(file)).expect(file);
        for said in ["no valid run", "2 of 2 runs with a result are left out of means"] {
            assert!(page.contains(said), "law: {file} says `{said}`");
        }
    }
    let output = Command::new(env!("CARGO_BIN_EXE_pluvia"))
        .args(["sweep", "--collect", "--quiet", "--out"])
        .arg(&out)
        .output()
        .expect("the program starts");
    let text = String::from_utf8_lossy(&output.stderr);
    let last = text.lines().last().unwrap_or_default();
    assert!(last.contains("NOT VALID") && last.contains("2 of 2"), "law: got `{last}`");
}

#[test]
fn values_can_be_drawn_and_varied_one_at_a_time() {
    let folder = tempfile::tempdir().expect("a folder");
    let scenario = write(folder.path());
    let drawn = [
        "--samples",
        "latin-hypercube:3",
        "--range",
        "contact.grain_grain_friction=0.2..0.9",
        "--plan-only",
    ];
    let out = folder.path().join("drawn");
    let (code, printed, said) = sweep(&scenario, &out, &drawn);
    assert_eq!(code, Some(0), "{said}");
    assert_eq!(serde_json::from_str::<Value>(&printed).expect("JSON")["runs"], 3);
    assert!(!out.join("stages").exists(), "law: only the plan is written");

    let out = folder.path().join("single");
    let one = ["--one-at-a-time", "--over", "contact.grain_grain_friction=0.3,0.793"];
    let (code, printed, said) = sweep(&scenario, &out, &one);
    assert_eq!(code, Some(0), "{said}");
    let found: Value = serde_json::from_str(&printed).expect("JSON");
    let points = found["points"].as_array().expect("points").len();
    assert_eq!(points, 2, "law: the scenario and what differs from it");
}

#[test]
fn what_cannot_be_swept_is_told_before_anything_runs() {
    let folder = tempfile::tempdir().expect("a folder");
    let (scenario, out) = (write(folder.path()), folder.path().join("out"));
    for (more, words) in [
        (&["--over", "contact.grain_friction=1,2"][..], ["grain_friction", "point-0001"]),
        (&["--over", "contact.restitution=0.3,7"][..], ["restitution", "7"]),
        (&["--over", "seed=1", "--over", "seed=2"][..], ["seed", "twice"]),
        (
            &[
                "--over",
                "stages[1].falling_height_mm=1,200",
                "--over",
                "stages.1.falling_height_mm=3",
            ][..],
            ["stages[1].falling_height_mm", "varied twice"],
        ),
        (
            &["--over", "contact={\"restitution\":0.1}", "--over", "contact.restitution=0.2,0.3"][..],
            ["`contact.restitution` is part of `contact`", "both are varied"],
        ),
        (
            &["--over", "contact={\"restitution\":0.1}", "--set", "contact.restitution=0.2"][..],
            ["--set contact.restitution=0.2", "`contact` is varied"],
        ),
        (&["--over", "seed"][..], ["path=value", "seed"]),
        (&["--samples", "sobol:4", "--range", "seed=1..9"][..], ["latin-hypercube:N", "sobol"]),
        (&[][..], ["--over", "required"]),
    ] {
        let (code, printed, said) = sweep(&scenario, &out, more);
        assert_eq!(code, Some(2), "{more:?}: {said}");
        assert!(printed.is_empty(), "nothing is printed as a result: {printed}");
        for word in words {
            assert!(said.contains(word), "{more:?}: `{word}` is missing in: {said}");
        }
    }
    assert!(!out.exists(), "law: nothing was made");
}
