//! `pluvia sweep` on a few grains: what it plans, what it finds, what it
//! refuses, and that it goes on from where it was.

use std::{collections::BTreeSet, fs, path::Path};

use serde_json::{Value, json};

use super::{
    program::{self, Folder, assert_holds, text, words},
    small,
};

/// A folder with `small.json`.
fn folder() -> Folder {
    let folder = Folder::new();
    folder.scenario("small.json", &small::layer(30.0));
    folder
}

/// Runs the command; gives its exit code, standard output and standard error.
pub fn sweep(scenario: &Path, out: &Path, more: &[&str]) -> (Option<i32>, String, String) {
    let args = ["sweep", "--quiet", "--json", text(scenario), "--out", text(out)];
    program::run(&[&args[..], more].concat())
}

/// The same to a good end; gives what it found.
pub fn swept(scenario: &Path, out: &Path, more: &[&str]) -> Value {
    let (code, printed, said) = sweep(scenario, out, more);
    assert_eq!(code, Some(0), "{}: {said}", out.display());
    serde_json::from_str(&printed).expect("JSON")
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
    let folder = folder();
    let (scenario, out) = (folder.path("small.json"), folder.path("out"));
    swept(&scenario, &out, &GRID);
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
        let summary = folder.json(&format!("out/runs/{}/summary.json", row[column("run")]));
        for name in ["meets_standard", "valid"] {
            let got = &row[column(name)];
            assert_eq!(*got, summary[name].to_string(), "law: {name} as the run has it");
        }
    }

    // With two more configurations only what is new is run.
    let stages = || -> BTreeSet<_> {
        let found = fs::read_dir(out.join("stages")).expect("stages").flatten();
        found.map(|e| (e.file_name(), e.metadata().and_then(|m| m.modified()).ok())).collect()
    };
    let before = stages();
    let more = [&GRID[..], &["--configurations", "3"]].concat();
    let found = swept(&scenario, &out, &more);
    assert!(before.is_subset(&stages()), "law: stored stages are taken as they are");
    let second = rows(&out);
    assert_eq!(second.len(), 13, "law: three configurations");
    assert_eq!(first[..5], second[..5], "law: the first configuration is what it was");
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

    let plan = folder.json("out/plan.json");
    let runs = plan["runs"].as_array().expect("runs");
    assert_eq!(runs.len(), 12, "law: the plan has every run");
    for run in runs {
        // Folders have the first digits of the key.
        let key = run["key"].as_str().and_then(|k| k.get(..24)).expect("a key");
        assert!(out.join("stages").join(key).is_dir(), "law: the last stage lies under its key");
    }

    let (code, _, said) = sweep(&scenario, &out, &GRID);
    assert_eq!(code, Some(2), "law: fewer configurations would take rows out: {said}");
    let words = ["plan.json", "`configurations` is 3 there and 1 now", "at least 3", "--out"];
    assert_holds(&said, &words);
    assert_eq!(rows(&out), second, "law: no row is lost");

    let other = ["--over", "seed=1,2"];
    let (code, _, said) = sweep(&scenario, &out, &other);
    assert_eq!(code, Some(2), "law: the folder of another sweep is refused");
    assert_holds(&said, &["another sweep", "`over`: grains.total_mass_g=30,60", "seed=1,2 now"]);
    assert_eq!(rows(&out), second, "law: nothing was written over");
}

/// Law: realisations of a scenario as it is are one point with a mean, and its page speaks of no
/// factor; more of them add to it.
#[test]
fn realisations_of_one_scenario_need_no_factor() {
    let folder = folder();
    let (scenario, out) = (folder.path("small.json"), folder.path("out"));
    for (count, more) in [(2, "2"), (3, "3")] {
        let found = swept(&scenario, &out, &["--configurations", more]);
        assert_eq!((&found["factors"], &found["effects"]), (&json!([]), &json!([])), "law: none");
        let points = found["points"].as_array().expect("points");
        assert_eq!(points.len(), 1, "law: one point of {count}");
        let height = &points[0]["outcomes"]["standing_height_mm.mean_surface"];
        assert_eq!(height["count"], count, "law: values of the mean, got {height}");
        assert!(height["t_low"].is_number(), "law: with an interval, got {height}");
        let rows = rows(&out);
        assert_eq!(rows.len(), count + 1, "law: a row for each");
        assert_eq!(rows[0][..3], ["run", "point", "configuration"], "law: no factor has a column");
    }
    let page = fs::read_to_string(out.join("sweep.md")).expect("a page");
    assert!(page.contains("1 point in 3 realisations"), "law: what was run, got {page}");
    for section in ["## What each factor moves", "## Figures"] {
        assert!(!page.contains(section), "law: nothing is varied, got {page}");
    }
    assert!(out.join("report.html").exists(), "law: the report is there");
}

/// Law: a sweep of which no run can be valid says so before the first run.
#[test]
fn a_sweep_without_a_rest_test_is_warned_of() {
    let folder = folder();
    let (scenario, out) = (folder.path("small.json"), folder.path("out"));
    let args = ["sweep", text(&scenario), "--over", "contact.restitution=0.1,0.3", "--plan-only"];
    let planned = |name: &str, more: &[&str]| {
        let out = out.join(name);
        let (code, _, said) = program::run(&[&args[..], &["--out", text(&out)], more].concat());
        assert_eq!(code, Some(0), "{said}");
        said
    };
    let said = planned("without", &["--set", "rest_test_s=0"]);
    assert_holds(&said, &["warning: rest_test_s is 0", "not valid", "no mean"]);
    let said = planned("with", &[]);
    assert!(!said.contains("rest_test_s"), "law: it has one: {said}");
}

/// Law: without a rest test no run is valid; the sweep says so in every file and as its last
/// line, and makes no mean of such runs.
#[test]
fn where_no_run_is_valid_there_is_no_mean() {
    let folder = folder();
    let (scenario, out) = (folder.path("small.json"), folder.path("out"));
    let over = ["--over", "grains.total_mass_g=30,60", "--set", "rest_test_s=0"];
    let found = swept(&scenario, &out, &over);
    for point in found["points"].as_array().expect("points") {
        assert_eq!(point["left_out"], 1, "law: counted: {point}");
        assert_eq!(point["outcomes"], json!({}), "law: no mean: {point}");
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
        let words = ["no valid run", "2 of 2 runs with a result are left out of means"];
        assert_holds(&fs::read_to_string(out.join(file)).expect(file), &words);
    }
    let (_, _, said) = program::run(&["sweep", "--collect", "--quiet", "--out", text(&out)]);
    let last = said.lines().last().unwrap_or_default();
    assert!(last.contains("NOT VALID") && last.contains("2 of 2"), "law: got `{last}`");
}

/// Law: options that would do nothing are refused: what is planned is said by the plan that is there,
/// and what jobs ask for is asked where jobs are submitted.
#[test]
fn options_that_would_do_nothing_are_refused() {
    let folder = folder();
    let (scenario, out) = (folder.out("small.json"), folder.out("out"));
    for of_a_plan in [
        &["--configurations", "3"][..],
        &["--set", "seed=4"],
        &["--seed", "4"],
        &["--backend", "rapier"],
        &["--one-at-a-time"],
        &["--samples", "latin-hypercube:3", "--range", "seed=1..9"],
        &["--partition", "long"],
        &["--mem", "1G"],
    ] {
        for of_what_is_there in ["--status", "--collect"] {
            let args = [&["sweep", of_what_is_there, "--out", &out][..], of_a_plan].concat();
            program::refused(&args, 2, &["cannot be used with", of_a_plan[0]]);
        }
    }
    for (instead, option, value) in [
        ("--plan-only", "--time", "00:10:00"),
        ("--snakemake", "--time", "00:10:00"),
        ("--snakemake", "--jobs", "2"),
        ("--slurm", "--jobs", "2"),
    ] {
        let over = ["sweep", &scenario, "--over", "seed=1,2", "--out", &out];
        let args = [&over[..], &[instead, option, value]].concat();
        program::refused(&args, 2, &["cannot be used with", option]);
        assert!(!folder.path("out").exists(), "law: nothing is written");
    }
}

/// Law: no option of a job adds a line to the script of the jobs.
#[test]
fn options_of_jobs_are_single_words() {
    let folder = folder();
    let (scenario, out) = (folder.out("small.json"), folder.out("out"));
    let slurm = ["sweep", &scenario, "--over", "seed=1,2", "--out", &out, "--slurm"];
    for (option, value) in
        [("--time", "1\nls"), ("--mem", "1 G"), ("--partition", ""), ("--account", "a\tb")]
    {
        program::refused(&[&slurm[..], &[option, value]].concat(), 2, &[option, "one word"]);
        assert!(!folder.path("out").exists(), "law: nothing is written");
    }
}

#[test]
fn values_can_be_drawn_and_varied_one_at_a_time() {
    let folder = folder();
    let scenario = folder.path("small.json");
    let range = ["--range", "contact.grain_grain_friction=0.2..0.9", "--plan-only"];
    let drawn = [&["--samples", "latin-hypercube:3"][..], &range].concat();
    assert_eq!(swept(&scenario, &folder.path("drawn"), &drawn)["runs"], 3);
    assert!(!folder.path("drawn/stages").exists(), "law: only the plan is written");

    let one = ["--one-at-a-time", "--over", "contact.grain_grain_friction=0.3,0.793"];
    let found = swept(&scenario, &folder.path("single"), &one);
    let points = found["points"].as_array().expect("points").len();
    assert_eq!(points, 2, "law: the scenario and what differs from it");
}

#[test]
fn what_cannot_be_swept_is_told_before_anything_runs() {
    let folder = folder();
    let (scenario, out) = (folder.path("small.json"), folder.path("out"));
    for (more, told) in [
        ("--over contact.grain_friction=1,2", ["grain_friction", "point-0001"]),
        (
            "--over contact.restitution=0.3,7",
            ["--over contact.restitution=7: contact.restitution", "found 7"],
        ),
        (
            "--samples latin-hypercube:2 --range contact.restitution=0.5..9",
            ["--range contact.restitution=", "out of range"],
        ),
        ("--over seed=1 --over seed=2", ["seed", "twice"]),
        ("--over seed", ["path=value", "seed"]),
        ("--samples sobol:4 --range seed=1..9", ["latin-hypercube:N", "sobol"]),
        ("--over name=a,b", ["(name=a)", "(name=b) are the same run"]),
        ("--over description=a,b --over seed=1,2", ["description=a seed=1", "are the same run"]),
        ("--over engine.native.threads=1,2", ["engine.native.threads=1", "are the same run"]),
        ("", ["nothing is varied", "--over"]),
        ("--configurations 1", ["nothing is varied", "--configurations of at least 2"]),
        ("--configurations 2 --one-at-a-time", ["nothing is varied", "--over"]),
    ] {
        let (code, printed, said) = sweep(&scenario, &out, &words(more));
        assert_eq!(code, Some(2), "{more:?}: {said}");
        assert!(printed.is_empty(), "nothing is printed as a result: {printed}");
        assert_holds(&said, &told);
    }
    assert!(!out.exists(), "law: nothing was made");
}

/// Law: a sweep over specimens that were made alike takes them for realisations: points that differ in
/// them alone are one, its table names them, and their folder is found again. The specimen that stands
/// in the scenario need not be there.
#[test]
fn specimens_of_a_sweep_are_realisations() {
    let folder = folder();
    let begun = ["1", "2"].map(|number| {
        let (out, set) = (folder.path(number), format!("configuration={number}"));
        let small = folder.path("small.json");
        let run = ["run", text(&small), "--out", text(&out), "--quiet", "--no-figures"];
        program::done(&[&run[..], &["--set", &set]].concat());
        text(&out).to_owned()
    });
    folder.scenario(
        "rests.json",
        &json!({
            "name": "rests", "begin": { "specimen": "none" },
            "stages": [{ "stage": "rest", "duration_s": 0.05 }], "rest_test_s": 0.05
        }),
    );
    let (scenario, out) = (folder.path("rests.json"), folder.path("out"));
    let specimens = format!("begin.specimen={}", begun.join(","));
    let over = ["--over", "contact.restitution=0.2,0.3", "--over", &specimens];
    for time in ["first", "second"] {
        let found = swept(&scenario, &out, &over);
        assert_eq!(found["specimens"], json!(begun), "law: the realisations, {time} time");
        let names: Vec<&Value> = found["points"]
            .as_array()
            .expect("points")
            .iter()
            .map(|point| &point["point"])
            .collect();
        assert_eq!(names, ["point-0001", "point-0003"], "law: the points, {time} time");
        let rows = rows(&out);
        let first = ["run", "point", "configuration", "begin.specimen", "contact.restitution"];
        assert_eq!(rows[0][..5], first, "law: a column that names the specimen, {time} time");
        let last = ["point-0004-c1", "point-0003", "2", &begun[1], "0.3"];
        assert_eq!(rows[4][..5], last, "law: the second specimen, {time} time");
    }
    let plan = folder.json("out/plan.json");
    assert_eq!(plan["changes"], json!([]), "law: a change of every run is one that was asked for");
}
