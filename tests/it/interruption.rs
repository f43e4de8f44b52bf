//! A small run for tests that interrupt it, and what one that nobody interrupted leaves.

use std::{
    fs,
    path::{Path, PathBuf},
    process::{Command, Stdio},
    sync::OnceLock,
    thread::sleep,
    time::{Duration, Instant},
};

use serde_json::json;
use tempfile::TempDir;

use super::{
    program::{self, write},
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

/// A folder with that scenario.
pub fn prepared() -> (TempDir, PathBuf) {
    let folder = tempfile::tempdir().expect("a folder");
    let scenario = write_scenario(folder.path());
    (folder, scenario)
}

/// The same, and in `out` what the scenario leaves.
pub fn with_results() -> (TempDir, PathBuf, PathBuf) {
    let (folder, scenario) = prepared();
    let out = folder.path().join("out");
    copy(finished(), &out);
    (folder, scenario, out)
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

/// Folders of the stages that are stored, in order.
pub fn stored(out: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(out.join("stages")).expect("stages").flatten().map(|e| e.path());
    let mut stored: Vec<PathBuf> =
        entries.filter(|path| path.join("stage.json").exists()).collect();
    stored.sort();
    stored
}

/// The first of them of a name.
pub fn stored_as(out: &Path, name: &str) -> PathBuf {
    let is_named = |folder: &PathBuf| program::json(&folder.join("stage.json"))["stage"] == name;
    stored(out).into_iter().find(is_named).unwrap_or_else(|| panic!("law: {name} is stored"))
}

/// How many stages are stored.
pub fn stages(out: &Path) -> usize {
    let named = |e: &fs::DirEntry| !e.file_name().to_string_lossy().starts_with('.');
    fs::read_dir(out.join("stages")).map_or(0, |entries| entries.flatten().filter(named).count())
}

/// Waits until the wanted number of stages is stored, two minutes at most.
pub fn wait_for_stages(out: &Path, wanted: usize) {
    let patience = Instant::now();
    while stages(out) < wanted && patience.elapsed() < Duration::from_secs(120) {
        sleep(Duration::from_millis(2));
    }
}
