//! A run that is killed goes on from what it had finished, and ends with the
//! bytes of one that was never killed.

use std::{
    fs,
    path::{Path, PathBuf},
    process::{Command, Stdio},
    thread::sleep,
    time::{Duration, Instant},
};

use serde_json::Value;

use super::small;

/// Forty grams of gravel, poured and shaken for half a second.
fn write_scenario(folder: &Path) -> PathBuf {
    let path = folder.join("small.json");
    let scenario = small::scenario(40.0, 0.5, 0.2);
    fs::write(&path, scenario.to_string()).expect("a scenario file");
    path
}

fn pluvia(scenario: &Path, out: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_pluvia"));
    command.arg("run").arg(scenario).arg("--out").arg(out).arg("--quiet");
    command.stdout(Stdio::null()).stderr(Stdio::null());
    command
}

/// The summary without what depends on the machine's speed.
fn summary(out: &Path) -> Value {
    let text = fs::read(out.join("summary.json")).expect("a summary");
    let mut summary: Value = serde_json::from_slice(&text).expect("JSON");
    let fields = summary.as_object_mut().expect("an object");
    for timing in ["wall_s", "engine_s", "peak_memory_mib"] {
        assert!(fields.remove(timing).is_some(), "the summary has {timing}");
    }
    summary
}

fn assert_same(a: &Path, b: &Path, what: &str) {
    assert_eq!(summary(a), summary(b), "law: {what}: the same summary but for timings");
    for file in ["specimen.json", "series.csv", "grains.csv", "control.csv", "grains.json"] {
        let (one, two) = (fs::read(a.join(file)), fs::read(b.join(file)));
        assert!(
            one.expect("written") == two.expect("written"),
            "law: {what}: the same bytes in {file}"
        );
    }
}

fn stages(out: &Path) -> usize {
    let named = |e: &fs::DirEntry| !e.file_name().to_string_lossy().starts_with('.');
    fs::read_dir(out.join("stages")).map_or(0, |entries| entries.flatten().filter(named).count())
}

#[test]
fn killed_in_the_middle_and_started_again_gives_the_same_as_uninterrupted() {
    let folder = tempfile::tempdir().expect("a folder");
    let scenario = write_scenario(folder.path());
    let [whole, again, killed] = ["whole", "again", "killed"].map(|name| folder.path().join(name));
    assert!(pluvia(&scenario, &whole).status().expect("started").success());
    assert!(pluvia(&scenario, &again).status().expect("started").success());
    assert_same(&whole, &again, "same seed twice");

    // Killed when one stage is stored, then when three are.
    for wanted in [1, 3] {
        let mut run = pluvia(&scenario, &killed).spawn().expect("started");
        let patience = Instant::now();
        while stages(&killed) < wanted && patience.elapsed() < Duration::from_secs(120) {
            if run.try_wait().expect("asked").is_some() {
                break;
            }
            sleep(Duration::from_millis(2));
        }
        // It may have ended by itself in the meantime: then nothing is killed.
        let _ = run.kill();
        run.wait().expect("ended");
        assert!(stages(&killed) >= wanted, "{wanted} stages stored before the kill");
    }
    assert!(pluvia(&scenario, &killed).status().expect("started").success());
    assert_same(&whole, &killed, "killed and started again");
}
