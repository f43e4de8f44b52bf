//! Sweeps over engines, sweeps that others run, and what is edited in between.

use std::{
    fs,
    path::{Path, PathBuf},
    process::Command,
};

use serde_json::{Value, json};

use super::{
    interruption::{stored, stored_as},
    program::{assert_holds, done, json as read, pluvia, refused, said, script, text, write},
    small,
    sweep::{sweep, swept},
};

/// Every file of a folder and those below it, with its content.
fn content(folder: &Path) -> Vec<(PathBuf, Vec<u8>)> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).expect("a folder").flatten() {
        let path = entry.path();
        if path.is_dir() {
            found.extend(content(&path));
        } else {
            found.push((path.clone(), fs::read(&path).expect("a file")));
        }
    }
    found.sort();
    found
}

/// stock Bullet contacts and rapier as values of a sweep, each in its rows;
/// collected from the store, the table is the same.
#[test]
fn contact_solvers_and_engines_are_factors_like_any_other() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut layer = small::layer(30.0);
    layer["engine"]["rate_hz"] = json!(480);
    let scenario = write(folder.path(), "small.json", &layer);
    for (name, factor, values) in [
        ("paths", "engine.contact_solver", ["native", "stock"]),
        ("engines", "engine.backend", ["rapier", "bullet"]),
    ] {
        if values.contains(&"rapier") && !cfg!(feature = "rapier") {
            continue;
        }
        let out = folder.path().join(name);
        let over = format!("{factor}={},{}", values[0], values[1]);
        let arguments = ["--over", &over, "--over", "contact.restitution=0.2,0.3"];
        let found = swept(&scenario, &out, &arguments);
        let runs = found["runs"].as_array().expect("runs");
        assert_eq!(runs.len(), 4, "{name}");
        for run in runs {
            assert_eq!(run["failure"], Value::Null, "law: every run has a result: {run}");
            let height = &run["outcomes"]["standing_height_mm.mean_surface"];
            assert!(height.as_f64().is_some_and(|h| h > 1.0), "law: grains stand: {run}");
        }
        let heights: Vec<&Value> =
            runs.iter().map(|r| &r["outcomes"]["standing_height_mm.mean_surface"]).collect();
        assert_ne!(heights[0], heights[2], "law: {name} are not the same: {heights:?}");
        let effects = found["effects"].as_array().expect("effects");
        let words = effects.iter().find(|e| e["factor"] == factor).expect("an effect");
        assert_eq!(words["slope"], Value::Null, "law: words have no slope");
        // stock Bullet contacts may creep numerically: what is not valid has no mean.
        let left_out = runs.iter().filter(|r| r["left_out_of_means"] != Value::Null).count();
        let means = words["means"].as_array().map(Vec::len);
        let expected = if left_out > 0 { 0 } else { 2 };
        assert_eq!(means, Some(expected), "law: and two means, {left_out} left out");
        assert_eq!(words["left_out"], left_out, "law: counted");

        let table = fs::read(out.join("sweep.csv")).expect("a table");
        done(&["sweep", "--collect", "--quiet", "--out", text(&out)]);
        let again = fs::read(out.join("sweep.csv")).expect("a table");
        assert_eq!(table, again, "law: collected, the same bytes in the same order");
    }
}

#[test]
fn a_scenario_edited_between_two_commands_is_told_and_nothing_overwritten() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut layer = small::layer(30.0);
    let (scenario, out) = (write(folder.path(), "small.json", &layer), folder.path().join("out"));
    let arguments = ["--over", "contact.restitution=0.2,0.3", "--plan-only"];
    let plan = |more: &[&str]| sweep(&scenario, &out, &[&arguments[..], more].concat());
    assert_eq!(plan(&[]).0, Some(0));
    let before = content(&out);

    layer["stages"][1]["falling_height_mm"] = json!(20);
    layer["engine"]["rate_hz"] = json!(480);
    write(folder.path(), "small.json", &layer);
    for more in [&[][..], &["--configurations", "3"], &["--snakemake"]] {
        let (code, printed, said) = plan(more);
        assert_eq!(code, Some(2), "law: {more:?} is refused: {said}");
        assert!(printed.is_empty(), "{printed}");
        let fields =
            ["stages[1].falling_height_mm was 0.0, is 20.0", "engine.rate_hz was 240.0, is 480.0"];
        assert_holds(&said, &fields);
        assert_holds(&said, &["small.json", "plan.json", "--out"]);
        assert_eq!(content(&out), before, "law: nothing is written over");
    }
    // The folder has what it needs: what was planned is run, also now.
    let listed = ["stage", "--list", "--json", text(&out)];
    done(&listed);

    // Words are no change, nor is another order of fields.
    let mut words = small::layer(30.0);
    words["description"] = json!("other words");
    write(folder.path(), "small.json", &words);
    let (code, _, said) = plan(&["--configurations", "2"]);
    assert_eq!(code, Some(0), "law: words change no result: {said}");

    // What lies in the folder is not edited unnoticed either.
    let mut edited = read(&out.join("scenario.json"));
    edited["stages"][1]["falling_height_mm"] = json!(20);
    write(&out, "scenario.json", &edited);
    refused(&listed, 2, &["scenario.json was edited"]);
}

/// Law: a plan that was edited is called so: no file has changed.
#[test]
fn an_edited_plan_is_not_taken_for_a_changed_file() {
    let folder = tempfile::tempdir().expect("a folder");
    let scenario = write(folder.path(), "small.json", &small::layer(30.0));
    let out = folder.path().join("out");
    let arguments = ["--over", "contact.restitution=0.2,0.3", "--plan-only"];
    let (code, _, said) = sweep(&scenario, &out, &arguments);
    assert_eq!(code, Some(0), "law: it is planned: {said}");
    let plan = read(&out.join("plan.json"));
    let listed = ["stage", "--list", "--json", text(&out)];
    for (field, to) in [
        ("configurations", json!(2)),
        ("over", json!(["contact.restitution=0.2,0.4"])),
        ("runs", json!([plan["runs"][0]])),
    ] {
        let mut edited = plan.clone();
        edited[field] = to;
        write(&out, "plan.json", &edited);
        refused(&listed, 2, &["plan.json is no longer", "it was edited, and lists other runs"]);
    }
    let (code, _, said) = sweep(&scenario, &out, &arguments);
    assert_eq!(code, Some(2), "law: nor is it planned again: {said}");
    assert_holds(&said, &["plan.json there was edited"]);
}

/// Law: a recorded motion that was edited since a sweep was planned is reported as a file that the
/// scenario names, not as one that grains come from, which there is none.
#[test]
fn a_motion_edited_between_two_commands_is_reported_as_a_file() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut layer = small::layer(30.0);
    let shaken = json!({ "stage": "vibrate", "waveform": "file", "motion_file": "motion.csv" });
    layer["stages"].as_array_mut().expect("stages").push(shaken);
    let motion = |middle_mm: f64| {
        let rows = format!("time_s,x_mm\n0,0\n0.1,0.1\n0.2,{middle_mm}\n0.3,0.1\n0.4,0\n");
        fs::write(folder.path().join("motion.csv"), rows).expect("a motion");
    };
    motion(0.5);
    let (scenario, out) = (write(folder.path(), "small.json", &layer), folder.path().join("out"));
    let arguments = ["--over", "contact.restitution=0.2,0.3", "--plan-only"];
    let (code, _, said) = sweep(&scenario, &out, &arguments);
    assert_eq!(code, Some(0), "law: it is planned: {said}");
    motion(0.6);
    let (code, _, said) = sweep(&scenario, &out, &arguments);
    assert_eq!(code, Some(2), "law: another motion is another sweep: {said}");
    assert_holds(&said, &["files (motions,", "have changed"]);
    assert!(!said.contains("takes its grains"), "law: its grains are cut: {said}");
    refused(&["stage", "--list", "--json", text(&out)], 2, &["files (motions,"]);
}

/// A stand-in for sbatch, which numbers what it is given.
const SBATCH: &str = "#!/bin/sh
cd \"$(dirname \"$0\")\" && echo x >> submitted && wc -l < submitted | tr -d ' '
";

/// A folder with such an sbatch, as the first of the places where programs are sought.
fn path_with_sbatch(folder: &Path) -> String {
    let bin = folder.join("bin");
    fs::create_dir(&bin).expect("a folder");
    script(&bin.join("sbatch"), SBATCH);
    format!("{}:{}", bin.display(), std::env::var("PATH").unwrap_or_default())
}

/// Hands a sweep of one point to that sbatch.
fn submit(scenario: &Path, out: &Path) {
    let mut command = pluvia();
    command.args(["sweep", "--quiet", "--slurm", "--over", "contact.restitution=0.2", "--out"]);
    let folder = scenario.parent().expect("a folder");
    command.arg(out).arg(scenario).env("PATH", path_with_sbatch(folder));
    let submitted = command.output().expect("the program starts");
    assert!(submitted.status.success(), "{}", said(&submitted));
}

/// Law: a machine without Slurm is not reported as a script that is missing.
#[test]
fn a_machine_without_slurm_is_called_so() {
    let folder = tempfile::tempdir().expect("a folder");
    let scenario = write(folder.path(), "small.json", &small::layer(30.0));
    let out = folder.path().join("out");
    let mut command = pluvia();
    command.args(["sweep", "--quiet", "--slurm", "--over", "seed=1,2", "--out", text(&out)]);
    let refused = command.arg(scenario).env("PATH", folder.path()).output().expect("it starts");
    let said = said(&refused);
    assert_eq!(refused.status.code(), Some(2), "law: refused, got {said}");
    assert_holds(&said, &["the program sbatch cannot be run", "is Slurm installed"]);
    assert!(out.join("slurm/level-0-0.sh").is_file(), "law: the script is there");
}

/// Law: jobs that were submitted are noted, also where the cluster takes no more.
#[test]
fn jobs_before_one_that_is_refused_are_noted() {
    let folder = tempfile::tempdir().expect("a folder");
    let scenario = write(folder.path(), "small.json", &small::layer(30.0));
    let out = folder.path().join("out");
    let path = path_with_sbatch(folder.path());
    let takes_one = format!("{SBATCH}[ \"$(wc -l < submitted)\" -lt 2 ]\n");
    script(&folder.path().join("bin/sbatch"), &takes_one);
    let mut command = pluvia();
    command.args(["sweep", "--quiet", "--slurm", "--over", "seed=1,2", "--out", text(&out)]);
    let refused = command.arg(scenario).env("PATH", path).output().expect("it starts");
    let said = said(&refused);
    assert_eq!(refused.status.code(), Some(2), "law: refused, got {said}");
    assert_holds(&said, &["sbatch does not take", "level-1-0.sh"]);
    let expected = json!([{ "id": "1", "level": 0, "tasks": 2 }]);
    let got = read(&out.join("slurm/jobs.json"));
    assert_eq!(got, expected, "law: left the jobs noted, right those that were submitted");
}

/// Runs a script as Slurm does: in a shell, from some other folder.
fn run_job(script: &Path) {
    let mut command = Command::new("sh");
    command.arg(script).env("SLURM_ARRAY_TASK_ID", "0").current_dir("/");
    let job = command.output().expect("a shell");
    assert!(job.status.success(), "{}: {}", script.display(), said(&job));
}

/// Law: jobs ask for as many CPUs as a stage has threads, as its world is read back.
#[test]
fn clusters_are_asked_for_the_threads_that_are_used() {
    let there = std::thread::available_parallelism().map_or(1, usize::from);
    for (typed, asked) in [(None, 1), (Some(2), 2)] {
        let folder = tempfile::tempdir().expect("a folder");
        let mut layer = small::layer(30.0);
        if let Some(threads) = typed {
            layer["engine"]["native"] = json!({ "threads": threads });
        }
        let scenario = write(folder.path(), "small.json", &layer);
        let out = folder.path().join("out");
        submit(&scenario, &out);
        for (script, asked) in [
            ("level-0-0.sh", asked),
            ("level-1-0.sh", asked),
            ("level-2-0.sh", asked),
            ("collect.sh", 1),
        ] {
            let script = out.join("slurm").join(script);
            let text = fs::read_to_string(&script).expect("a script");
            let line = format!("#SBATCH --cpus-per-task={asked}");
            assert!(text.lines().any(|l| l == line), "law: {typed:?} has a line {line}:\n{text}");
            run_job(&script);
        }
        let threads = |stage: PathBuf| threads_of(&read(&stage.join("stage.json")));
        let used: Option<Vec<f64>> = stored(&out).into_iter().map(threads).collect();
        let used = used.expect("law: the threads of a world are read back");
        // A machine with fewer cores gives no more threads than it has.
        let expected = asked.min(there) as f64;
        assert_eq!(used, [expected; 3], "law: with {typed:?} typed a stage uses what is asked for");

        let flow = folder.path().join("flow");
        let arguments = ["--over", "contact.restitution=0.2", "--snakemake"];
        swept(&scenario, &flow, &arguments);
        let text = fs::read_to_string(flow.join("Snakefile")).expect("a Snakefile");
        let lines = text.lines().filter(|l| *l == format!("    threads: {asked}")).count();
        assert_eq!(lines, 3, "law: all levels ask for {asked}:\n{text}");
    }
}

/// The number at `threads`, wherever it stands in a stage's record.
fn threads_of(value: &Value) -> Option<f64> {
    match value {
        Value::Object(fields) => fields
            .get("threads")
            .and_then(Value::as_f64)
            .or_else(|| fields.values().find_map(threads_of)),
        Value::Array(items) => items.iter().find_map(threads_of),
        _ => None,
    }
}

#[test]
fn folders_with_blanks_and_quotes_come_through_slurm_and_snakemake() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut layer = small::layer(30.0);
    layer["rest_test_s"] = json!(0);
    let scenario = write(folder.path(), "small.json", &layer);
    let out = folder.path().join("it's a \"sweep\" of 100 %");
    submit(&scenario, &out);
    let log = format!(
        "#SBATCH --output=\"{}/it's a \\\"sweep\\\" of 100 %%/slurm/%x-%A_%a.log\"",
        folder.path().display()
    );
    for script in ["level-0-0.sh", "level-1-0.sh", "collect.sh"] {
        let script = out.join("slurm").join(script);
        let text = fs::read_to_string(&script).expect("a script");
        if !script.ends_with("collect.sh") {
            assert!(text.lines().any(|l| l == log), "law: there is a line {log}, got\n{text}");
        }
        run_job(&script);
    }
    let by_slurm = fs::read(out.join("sweep.csv")).expect("a table");

    // Another folder, run stage by stage from within, as a Snakefile has it.
    let other = folder.path().join("it's a \"flow\"");
    let arguments = ["--over", "contact.restitution=0.2", "--snakemake"];
    swept(&scenario, &other, &arguments);
    let moved = folder.path().join("another place");
    fs::rename(&other, &moved).expect("moved");
    fs::remove_file(&scenario).expect("removed");
    let text = fs::read_to_string(moved.join("Snakefile")).expect("a Snakefile");
    assert!(!text.contains("flow\\\""), "law: the folder's own place is not in it: {text}");
    let keys: Vec<&str> =
        text.lines().filter_map(|l| l.strip_prefix("        \"")?.strip_suffix("\",")).collect();
    assert_eq!(keys.len(), 2, "law: every stage has a line: {text}");
    for arguments in [
        vec!["stage", ".", "--key", keys[0]],
        vec!["stage", ".", "--key", keys[1]],
        vec!["sweep", "--collect", "--out", "."],
    ] {
        let step = pluvia().args(&arguments).arg("--quiet").current_dir(&moved).output();
        let step = step.expect("the program starts");
        assert!(step.status.success(), "{arguments:?}: {}", said(&step));
    }
    let by_flow = fs::read(moved.join("sweep.csv")).expect("a table");
    assert_eq!(by_slurm, by_flow, "law: the same table");
    // A stage that there is not is refused.
    let moved = super::program::text(&moved);
    refused(&["stage", "--key", "0000", "--quiet", moved], 2, &[]);
    refused(&["stage", "--key", "", moved], 2, &["a value is required for '--key <KEY>'"]);
    let no_level = ["stage", "--level", "9", "--task", "0", moved];
    refused(&no_level, 2, &["no stage 0 on level 9: level 0 has ", ", level 1 has "]);
}

/// Law: names of files in changes lead from where the sweep was planned, wherever its stages are run;
/// tables have them as they were typed.
#[test]
fn files_that_changes_name_are_found_from_elsewhere() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut layer = small::layer(30.0);
    let sieved = write(folder.path(), "sieved.json", &layer);
    done(&["grains", text(&sieved), "--quiet", "--out", text(&folder.path().join("h"))]);
    layer["grains"] = json!({ "file": "none.json" });
    write(folder.path(), "small.json", &layer);
    let (named, other) = ("grains.file=h/grains.json", "contact.restitution=0.2");
    for (out, over, more) in [("set", other, vec!["--set", named]), ("over", named, Vec::new())] {
        let mut command = pluvia();
        command.args(["sweep", "small.json", "--quiet", "--snakemake", "--out", out]);
        command.args(["--over", over]).args(more).current_dir(folder.path());
        let planned = command.output().expect("the program starts");
        assert!(planned.status.success(), "law: --{out} is planned: {}", said(&planned));
        let place = folder.path().join(out);
        let stage = ["stage", ".", "--level", "0", "--task", "0", "--quiet"];
        let step = pluvia().args(stage).current_dir(&place).output().expect("it starts");
        let said = said(&step);
        assert!(step.status.success(), "law: a stage runs in the folder of --{out}: {said}");
        assert_eq!(stored(&place).len(), 1, "law: the stage of --{out} is stored");
    }
    let plan = read(&folder.path().join("over/plan.json"));
    let got = &plan["runs"][0]["values"]["grains.file"];
    assert_eq!(
        *got,
        json!("h/grains.json"),
        "law: left the value in tables, right as it was typed"
    );
}

/// Law: who asks how far a sweep is writes nothing into its folder, which may be one that he may only
/// read: no store is made, and nothing that others left is removed.
#[test]
fn what_is_stored_is_asked_without_writing() {
    let folder = tempfile::tempdir().expect("a folder");
    let scenario = write(folder.path(), "small.json", &small::layer(30.0));
    let out = folder.path().join("out");
    swept(&scenario, &out, &["--over", "contact.restitution=0.2,0.3", "--plan-only"]);
    fs::write(out.join(".pluvia-Ab12cd.part"), "half").expect("a leftover");
    let before = content(&out);
    let list = ["stage", text(&out), "--list"];
    let status = ["sweep", "--status", "--out", text(&out)];
    for args in [&list[..], &status[..]] {
        let printed = done(args);
        let after = content(&out);
        assert!(after == before, "law: {args:?} changes no file");
        assert!(!out.join("stages").exists(), "law: {args:?} makes no store");
        assert_holds(&printed, &["stage"]);
    }
    done(&["stage", text(&out), "--level", "0", "--task", "0", "--quiet"]);
    assert_eq!(stored(&out).len(), 1, "law: a stage that is run is stored");
    assert!(!out.join(".pluvia-Ab12cd.part").exists(), "law: who writes removes leftovers");
}

/// Law: collecting runs nothing. A stage whose files were changed counts as not stored, there and in
/// the lists of what is to be done.
#[test]
fn collecting_and_listing_believe_no_damaged_stage() {
    let folder = tempfile::tempdir().expect("a folder");
    let scenario = write(folder.path(), "small.json", &small::layer(30.0));
    let out = folder.path().join("out");
    let over = ["--over", "contact.restitution=0.2,0.3"];
    swept(&scenario, &out, &over);
    let table = fs::read(out.join("sweep.csv")).expect("a table");
    let pour = stored_as(&out, "pour").join("specimen.json");
    let content = fs::read_to_string(&pour).expect("a specimen");
    let changed = content.replacen("0.0", "0.1", 1);
    assert_ne!(changed, content, "a number is changed");
    fs::write(&pour, &changed).expect("changed");
    let found = |args: &[&str]| serde_json::from_str::<Value>(&done(args)).expect("JSON");
    let listed = found(&["stage", text(&out), "--list", "--json"]);
    let missing = listed["missing"].as_array().expect("levels").iter();
    let missing: usize = missing.map(|level| level.as_array().map_or(0, Vec::len)).sum();
    // The pour, and the rest that goes on from it.
    assert_eq!(missing, 2, "law: the changed stage is to be done again, got {listed}");
    let found = found(&["sweep", "--collect", "--out", text(&out), "--json"]);
    let failures: Vec<&str> = found["runs"]
        .as_array()
        .expect("runs")
        .iter()
        .filter_map(|run| run["failure"].as_str())
        .collect();
    assert!(failures.len() == 1 && failures[0].contains("is not stored"), "law: got {failures:?}");
    assert_eq!(fs::read_to_string(&pour).expect("a file"), changed, "law: nothing was run");
    swept(&scenario, &out, &over);
    assert!(fs::read(out.join("sweep.csv")).expect("a table") == table, "law: made anew, the same");
}
