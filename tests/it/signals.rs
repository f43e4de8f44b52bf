//! SIGTERM and Ctrl-C end every command within ten seconds, in whatever state it is.

use std::{
    fs,
    os::unix::process::ExitStatusExt,
    process::{Child, Command, ExitStatus, Stdio},
    thread::sleep,
    time::{Duration, Instant},
};

use serde_json::{Value, json};

use super::{
    interruption::{copy, finished, pluvia, prepared, stages},
    program::{self, catches_signals, ended, said, send, words, write},
    same::assert_whole_files,
    small,
};

/// Longest that a process may take to end once it was asked to.
const WITHIN: Duration = Duration::from_secs(10);

/// Longest that a command may take to come to the state that is meant.
const PATIENCE: Duration = Duration::from_secs(120);

/// As shells have it: 128 + SIGINT.
const STOPPED: Option<i32> = Some(130);

/// Waits until a command is where it is meant to be, and listens to signals.
fn reach(child: &mut Child, what: &str, reached: &dyn Fn() -> bool) {
    let begun = Instant::now();
    // On a busy machine much time may pass between its first file and its listening.
    while !reached() || !catches_signals(child) {
        let ended = child.try_wait().expect("its state");
        assert!(ended.is_none(), "{what}: it is over before it is asked to stop: {ended:?}");
        assert!(begun.elapsed() < PATIENCE, "{what}: it does not come there");
        sleep(Duration::from_millis(2));
    }
}

/// How a process ends that was asked to.
fn ends(child: Child, what: &str) -> ExitStatus {
    ended(child, WITHIN, what).status
}

/// Law: a command that is somewhere ends when it is asked to, and says that it was stopped.
fn stops(mut command: Command, signal: &str, what: &str, reached: &dyn Fn() -> bool) {
    let what = format!("{what}, SIG{signal}");
    let mut child = command.spawn().expect("it starts");
    reach(&mut child, &what, reached);
    send(&child, signal);
    let status = ends(child, &what);
    assert_eq!(status.code(), STOPPED, "law: {what}: it says that it was stopped, got {status:?}");
}

/// Half a tonne of gravel: cutting and sieving its grains takes minutes.
fn many() -> Value {
    json!({
        "name": "many",
        "grains": small::gravel(5e5),
        "apparatus": {
            "cylinder": { "inner_diameter_mm": 1500, "height_mm": 1500 },
            "funnel": { "opening_diameter_mm": 900, "top_diameter_mm": 1400 }
        },
        "stages": [{ "stage": "fill_funnel" }]
    })
}

#[test]
#[ignore = "slow: make test-all"]
fn while_grains_are_cut() {
    let folder = tempfile::tempdir().expect("a folder");
    let scenario = write(folder.path(), "many.json", &many());
    for signal in ["TERM", "INT"] {
        let out = folder.path().join(signal);
        // The folder is there just before signals are listened to.
        let reached = || {
            let there = out.exists();
            sleep(Duration::from_millis(if there { 500 } else { 0 }));
            there
        };
        stops(pluvia(&scenario, &out), signal, "grains are cut", &reached);
    }
}

#[test]
fn in_a_pour() {
    let folder = tempfile::tempdir().expect("a folder");
    let scenario = write(folder.path(), "long.json", &small::scenario(400.0, 20.0, 0.2));
    for signal in ["TERM", "INT"] {
        let out = folder.path().join(signal);
        let reached = || stages(&out) >= 1;
        stops(pluvia(&scenario, &out), signal, "a pour", &reached);
        assert!(stages(&out) >= 1, "law: what was finished is kept");
    }
}

#[test]
fn in_every_command_that_computes() {
    let folder = tempfile::tempdir().expect("a folder");
    let scenario = write(folder.path(), "long.json", &small::scenario(200.0, 20.0, 0.2));
    let friction =
        "--target void_ratio=0.8 --unknown contact.grain_grain_friction --between 0.2..0.9";
    let commands = [
        ("sweep", true, "--over seed=1,2 --jobs 2"),
        ("compare", true, ""),
        ("calibrate", true, friction),
        ("reproduce", false, "--quick"),
        ("interpretations", false, "--quick"),
        ("verify", false, ""),
    ];
    for (n, (name, of_scenario, more)) in commands.into_iter().enumerate() {
        let out = folder.path().join(name);
        let mut command = program::pluvia();
        command.arg(name).args(of_scenario.then_some(&scenario)).args(words(more));
        command.arg("--quiet").arg("--out").arg(&out);
        command.stdout(Stdio::null()).stderr(Stdio::null());
        let reached = || {
            let there = out.join("stages/.lock").exists() || name == "verify" && out.exists();
            sleep(Duration::from_millis(if there { 300 } else { 0 }));
            there
        };
        stops(command, ["TERM", "INT"][n % 2], name, &reached);
    }
}

/// Law: a command without stages does not say that it keeps them.
#[test]
fn what_is_said_to_be_kept_is_kept() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("verify");
    let mut command = program::pluvia();
    command.args(["verify", "--out"]).arg(&out).stdout(Stdio::null()).stderr(Stdio::piped());
    let mut child = command.spawn().expect("it starts");
    reach(&mut child, "verify", &|| out.exists());
    send(&child, "INT");
    let output = ended(child, WITHIN, "verify");
    let said = said(&output);
    assert_eq!(output.status.code(), STOPPED, "law: it was stopped, got: {said}");
    let is_true = said.contains("stop") && !said.contains("stages");
    assert!(is_true, "law: it was stopped and keeps no stages, got: {said}");
}

/// Law: a command that leaves all its files or none says that it is stopped, leaves none, and ends at
/// once at the second Ctrl-C.
#[test]
fn while_grains_alone_are_cut() {
    let folder = tempfile::tempdir().expect("a folder");
    let scenario = write(folder.path(), "many.json", &many());
    let out = folder.path().join("grains");
    let mut command = program::pluvia();
    command.arg("grains").arg(&scenario).arg("--out").arg(&out);
    let mut child =
        command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().expect("it starts");
    reach(&mut child, "grains", &|| out.exists());
    send(&child, "INT");
    sleep(Duration::from_millis(500));
    send(&child, "INT");
    let output = ended(child, Duration::from_secs(5), "grains, Ctrl-C twice");
    let said = said(&output);
    assert_eq!(output.status.code(), STOPPED, "law: it was stopped, got: {said}");
    let is_said = said.contains("stopping") && said.contains("error: stopped; ");
    assert!(is_said, "law: it says that it stops, and that it was stopped, got: {said}");
    assert!(!out.exists(), "law: nothing is left, not even a folder");
}

/// Law: results are there whole or not at all, also when figures and report are being written.
#[test]
#[ignore = "slow: make test-all"]
fn while_figures_and_report_are_written() {
    let (folder, scenario) = prepared();
    let mut stopped = 0;
    for (n, signal) in ["TERM", "INT", "TERM", "INT"].into_iter().enumerate() {
        let out = folder.path().join(n.to_string());
        copy(&finished().join("stages"), &out.join("stages"));
        let mut child = pluvia(&scenario, &out).spawn().expect("it starts");
        let what = format!("figures, SIG{signal} number {n}");
        reach(&mut child, &what, &|| out.join("figures").exists());
        sleep(Duration::from_millis(60 * n as u64));
        send(&child, signal);
        let status = ends(child, &what);
        // It may have had little left to do.
        let is_stopped = status.code() == STOPPED;
        assert!(is_stopped || status.success(), "law: {what}: stopped or done, got {status:?}");
        stopped += u32::from(is_stopped);
        assert_whole_files(&out, finished(), &what);
        assert!(
            pluvia(&scenario, &out).status().expect("it starts").success(),
            "law: {what}: again"
        );
        assert_whole_files(&out, finished(), &what);
    }
    println!("stopped while figures were written: {stopped} of 4");
}

/// Law: who waits for a store that somebody else is clearing ends, too.
#[test]
fn while_it_waits_for_a_lock() {
    let (folder, scenario) = prepared();
    for signal in ["TERM", "INT"] {
        let out = folder.path().join(signal);
        fs::create_dir_all(out.join("stages")).expect("a folder");
        let lock = fs::File::create(out.join("stages/.lock")).expect("a lock");
        lock.lock().expect("held alone");
        // The grains are written just before the store is opened.
        let reached = || {
            let there = out.join("grains.json").exists();
            sleep(Duration::from_millis(if there { 500 } else { 0 }));
            there
        };
        stops(pluvia(&scenario, &out), signal, "a lock is waited for", &reached);
        assert_eq!(stages(&out), 0, "law: it has waited, and nothing was stored");
    }
}

/// Law: a process that was suspended ends when it goes on, whether it was asked to before or after.
#[test]
fn after_it_was_suspended() {
    let folder = tempfile::tempdir().expect("a folder");
    let scenario = write(folder.path(), "long.json", &small::scenario(400.0, 20.0, 0.2));
    for order in [["CONT", "TERM"], ["TERM", "CONT"], ["INT", "CONT"]] {
        let what = format!("suspended, then {}", order.join(" and "));
        let out = folder.path().join(order.join("-"));
        let mut child = pluvia(&scenario, &out).spawn().expect("it starts");
        reach(&mut child, &what, &|| stages(&out) >= 1);
        send(&child, "STOP");
        sleep(Duration::from_secs(1));
        assert!(child.try_wait().expect("its state").is_none(), "law: {what}: it is suspended");
        order.iter().for_each(|signal| send(&child, signal));
        let status = ends(child, &what);
        assert_eq!(status.code(), STOPPED, "law: {what}: it was stopped, got {status:?}");
    }
}

/// Law: a command that only reads or prints, and one that serves, end at once.
#[test]
fn while_it_serves() {
    use std::io::{BufRead, BufReader};
    for (signal, number, quiet) in [("TERM", 15, None), ("INT", 2, Some("--quiet"))] {
        let mut command = program::pluvia();
        command.arg("view").arg(super::export::small_run()).arg("--no-browser").args(quiet);
        let mut child = command.stdout(Stdio::piped()).spawn().expect("it starts");
        let lines = BufReader::new(child.stdout.take().expect("a pipe")).lines();
        let served = lines.map_while(Result::ok).any(|line| line.starts_with("http://"));
        assert!(served, "law: it says where it serves, {quiet:?}");
        send(&child, signal);
        let status = ends(child, signal);
        assert_eq!(status.code(), Some(0), "law: SIG{signal} is the way to end it: {status:?}");
        assert_ne!(status.signal(), Some(number), "law: it ends by itself");
    }
}
