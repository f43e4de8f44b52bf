//! `scripts/load.sh` fails where a run takes more than it may, or misses the standard.

use std::{
    fs, os::unix::process::CommandExt, path::Path, process::Command, thread::sleep, time::Duration,
};

use super::program::{assert_holds, catches_signals, ended, root, script, spawned};

/// A program in the place of `pluvia` that writes this summary after a moment.
fn program(folder: &Path, meets_standard: &str, wall_s: f64) -> std::path::PathBuf {
    let summary = format!(
        "{{\n  \"void_ratio\": 0.9,\n  \"overlap\": {{\n    \"mean_percent\": 0.14,\n    \
         \"p99_percent\": 0.73\n  }},\n  \"creep_um_per_s\": 0.5,\n  {meets_standard}\
         \"wall_s\": {wall_s}\n}}\n"
    );
    fs::write(folder.join("summary.json"), summary).expect("a summary");
    let program = folder.join("pluvia");
    script(&program, "#!/bin/sh\nsleep 1\n");
    program
}

/// What it says of such a run, and its exit code.
fn load(meets_standard: &str, wall_s: f64, limits: [&str; 2]) -> (String, Option<i32>) {
    let folder = tempfile::tempdir().expect("a folder");
    let output = Command::new("bash")
        .current_dir(root())
        .args(["scripts/load.sh", "10000"])
        .args(limits)
        .arg(folder.path())
        .env("PLUVIA", program(folder.path(), meets_standard, wall_s))
        .output()
        .expect("bash");
    let said = [output.stdout, output.stderr].map(|s| String::from_utf8_lossy(&s).into_owned());
    (said.concat(), output.status.code())
}

const MET: &str = "\"meets_standard\": true,\n  ";

#[test]
fn a_load_within_its_limits_passes_and_says_all_in_one_line() {
    let (said, code) = load(MET, 300.4, ["1024", "90"]);
    assert_eq!(code, Some(0), "law: it is within all limits, got {said}");
    assert_eq!(said.lines().count(), 1, "law: one line, got {said}");
    assert_holds(&said, &["10000 grains", "300 s of 5400 s", "of 1024 MiB", "standard met"]);
    assert_holds(&said, &["0.14 / 0.73 %", "numerical creep 0.5 µm/s", "void ratio 0.9"]);
}

#[test]
fn a_load_beyond_a_limit_fails_and_says_which() {
    let cases = [
        (MET, 5401.0, ["1024", "90"], "more than LIMIT_MINUTES=90"),
        ("\"meets_standard\": false,\n  ", 300.0, ["1024", "90"], "meets_standard in"),
        ("", 300.0, ["1024", "90"], "summary.json is missing"),
    ];
    for (meets_standard, wall_s, limits, expected) in cases {
        let (said, code) = load(meets_standard, wall_s, limits);
        assert_eq!(code, Some(1), "law: {expected} fails, got {said}");
        assert!(said.contains(expected), "law: it says {expected}, got {said}");
    }
    // A shell that sleeps holds some MiB.
    let (said, code) = load(MET, 300.0, ["1", "90"]);
    assert!(code == Some(1) && said.contains("LIMIT_MIB=1"), "law: memory fails, got {said}");
    let (said, code) = load(MET, 300.0, ["1024", "soon"]);
    assert!(code == Some(2) && said.contains("LIMIT_MINUTES=soon"), "law: refused, got {said}");
}

/// Law: Ctrl-C at a terminal, a SIGINT to script and run alike, and a SIGTERM to the script alone
/// reach the run once; the script waits for the run and ends with its exit code.
#[test]
fn an_interrupted_load_asks_its_run_once_and_ends_with_it() {
    for (signal, to) in [("INT", "-"), ("TERM", "")] {
        let folder = tempfile::tempdir().expect("a folder");
        let at = |name: &str| folder.path().join(name);
        let [asked, begun] = [at("asked"), at("begun")];
        // What a shell runs in the background ignores SIGINT unless it has its own answer to it. The
        // shell of a substitution has none: nothing is substituted once the signal may come.
        let text = format!(
            "#!/bin/sh\nexec env --default-signal=INT sh -c '\n\
             tenths=$(seq 100)\ntrap \"echo asked >> {asked}\" INT TERM\ntouch {begun}\n\
             for _ in $tenths; do\n[ -e {asked} ] && sleep 1 && exit 7\nsleep 0.1\ndone'\n",
            asked = asked.display(),
            begun = begun.display(),
        );
        script(&at("pluvia"), &text);
        let mut load = Command::new("bash");
        load.current_dir(root()).args(["scripts/load.sh", "10000", "1024", "90"]);
        load.arg(folder.path()).env("PLUVIA", at("pluvia")).process_group(0);
        let load = spawned(load);
        for _ in 0..1000 {
            if begun.exists() && catches_signals(&load) {
                break;
            }
            sleep(Duration::from_millis(10));
        }
        let whom = format!("{to}{}", load.id());
        let sent = Command::new("kill").args(["-s", signal, "--", &whom]).status();
        let sent = sent.expect("kill starts");
        assert!(sent.success(), "law: SIG{signal} is sent, got {sent}");
        let output = ended(load, Duration::from_secs(20), "an interrupted load ends");
        let code = output.status.code();
        assert_eq!(code, Some(7), "law: SIG{signal}: the script ends by the run's exit code");
        let times = fs::read_to_string(&asked).unwrap_or_default().lines().count();
        assert_eq!(times, 1, "law: SIG{signal} reaches the run once");
    }
}
