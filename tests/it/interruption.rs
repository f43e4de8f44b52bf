//! A run that is killed goes on from what it had finished, and ends with the
//! bytes of one that was never killed.

use std::{
    fs,
    path::{Path, PathBuf},
    process::{Command, Stdio},
    sync::OnceLock,
    thread::sleep,
    time::{Duration, Instant},
};

use serde_json::{Value, json};
use tempfile::TempDir;

use super::{
    program::{self, write},
    same::{assert_same_bytes, assert_same_files},
    small,
};

/// Forty grams of gravel, poured and shaken for half a second.
pub fn write_scenario(folder: &Path) -> PathBuf {
    write(folder, "small.json", &small::scenario(40.0, 0.5, 0.2))
}

/// The same, stored on its way after every tenth of a simulated second.
pub fn write_scenario_in_segments(folder: &Path) -> PathBuf {
    let mut scenario = small::scenario(40.0, 0.5, 0.2);
    scenario["engine"] = json!({ "native": { "checkpoint_every_s": 0.1 } });
    write(folder, "segments.json", &scenario)
}

/// What an uninterrupted run of [`write_scenario`] leaves, once for all tests.
pub fn finished() -> &'static Path {
    static MADE: OnceLock<(TempDir, PathBuf)> = OnceLock::new();
    let (_, out) = MADE.get_or_init(|| {
        let folder = tempfile::tempdir().expect("a folder");
        let out = folder.path().join("out");
        let done = pluvia(&write_scenario(folder.path()), &out).status().expect("started");
        assert!(done.success(), "law: the small scenario can be run");
        (folder, out)
    });
    out
}

/// A copy of a folder, to be changed.
pub fn copy(from: &Path, to: &Path) {
    fs::create_dir_all(to).expect("a folder");
    for entry in fs::read_dir(from).expect("a folder").flatten() {
        let (source, target) = (entry.path(), to.join(entry.file_name()));
        if source.is_dir() {
            copy(&source, &target);
        } else {
            fs::copy(&source, &target).expect("a copy");
        }
    }
}

/// `pluvia run`, saying nothing.
pub fn pluvia(scenario: &Path, out: &Path) -> Command {
    let mut command = program::pluvia();
    command.arg("run").arg(scenario).arg("--out").arg(out).arg("--quiet");
    command.stdout(Stdio::null()).stderr(Stdio::null());
    command
}

/// The same without figures and pictures, which take longer than a few grains do.
pub fn without_figures(scenario: &Path, out: &Path) -> Command {
    let mut command = pluvia(scenario, out);
    command.arg("--no-figures");
    command
}

/// The summary without what depends on the machine's speed.
fn summary(out: &Path) -> Value {
    let mut summary = program::json(&out.join("summary.json"));
    let fields = summary.as_object_mut().expect("an object");
    for timing in ["wall_s", "engine_s", "peak_memory_mib"] {
        assert!(fields.remove(timing).is_some(), "the summary has {timing}");
    }
    summary
}

/// The same results.
pub fn assert_same(a: &Path, b: &Path, what: &str) {
    assert_eq!(summary(a), summary(b), "law: {what}: the same summary but for timings");
    let files = ["specimen.json", "series.csv", "grains.csv", "rest_test.csv", "grains.json"];
    assert_same_bytes(a, b, &files, what);
}

/// How many stages are stored.
pub fn stages(out: &Path) -> usize {
    let named = |e: &fs::DirEntry| !e.file_name().to_string_lossy().starts_with('.');
    fs::read_dir(out.join("stages")).map_or(0, |entries| entries.flatten().filter(named).count())
}

/// Waits until so many stages are stored, two minutes at most.
pub fn wait_for_stages(out: &Path, wanted: usize) {
    let patience = Instant::now();
    while stages(out) < wanted && patience.elapsed() < Duration::from_secs(120) {
        sleep(Duration::from_millis(2));
    }
}

#[test]
fn killed_in_the_middle_and_started_again_gives_the_same_as_uninterrupted() {
    let folder = tempfile::tempdir().expect("a folder");
    let scenario = write_scenario(folder.path());
    let killed = folder.path().join("killed");
    // Killed when one stage is stored, then when three are.
    for wanted in [1, 3] {
        let mut run = pluvia(&scenario, &killed).spawn().expect("started");
        wait_for_stages(&killed, wanted);
        // It may have ended by itself in the meantime: then nothing is killed.
        let _ = run.kill();
        run.wait().expect("ended");
        assert!(stages(&killed) >= wanted, "{wanted} stages stored before the kill");
    }
    assert!(pluvia(&scenario, &killed).status().expect("started").success());
    assert_same(finished(), &killed, "killed and started again");
    assert_same_files(finished(), &killed, "killed and started again");
}
