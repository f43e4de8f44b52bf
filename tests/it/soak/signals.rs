//! Asked to stop (SIGTERM, Ctrl-C) at a random moment: it ends soon, and goes on where it was.

use std::{os::unix::process::ExitStatusExt, process::Stdio, thread::sleep, time::Duration};

use rand::RngExt;

use super::{
    super::same::assert_whole_files,
    Ground,
    log::ENDED,
    trials::{STOPS_WITHIN, Trial, ended, reproduce, said, segments, send, spawned, sweep},
};

const CLASS: &str = "signals";

fn asked_to_stop(trial: &Trial, signal: &str, jobs: u32, after: Duration, ground: &mut Ground) {
    let out = ground.place();
    let mut command = trial.command(&out);
    let at = command.get_args().position(|arg| arg == "--jobs").expect("law: jobs are said");
    let args: Vec<_> = command.get_args().map(ToOwned::to_owned).collect();
    command = std::process::Command::new(super::trials::program());
    command.args(&args[..=at]).arg(jobs.to_string()).args(&args[at + 2..]);
    command.stdout(Stdio::null()).stderr(Stdio::piped());
    let run = spawned(command);
    sleep(after);
    let phase = trial.phase(&out);
    send(&run, signal);
    let what = format!("SIG{signal} after {after:?} in {phase}, {jobs} jobs");
    let output = ended(run, STOPS_WITHIN, &what);
    let said = said(&output);
    assert!(!said.contains("panicked"), "law: {what}: no panic, got {said}");
    let early = output.status.signal().is_some_and(|got| got == 15 || got == 2);
    let outcome = match output.status.code() {
        Some(0) => ENDED.to_owned(),
        Some(130) => "exit code 130, then finished with the same bytes".to_owned(),
        // Before it has set up to stop by itself, the signal does what it does to any program.
        None if early && !out.join("stages").exists() => {
            "ended by the signal before it began, then finished with the same bytes".to_owned()
        }
        _ => panic!("law: {what}: exit code 0 or 130, got {}: {said}", output.status),
    };
    assert_whole_files(&out, &trial.whole, &what);
    trial.finish(&out, &what);
    ground.log.case(CLASS, &format!("SIG{signal}, {jobs} jobs, {phase}"), &outcome);
}

/// `make soak`: one signal.
pub fn round(ground: &mut Ground) {
    let trial = match ground.rng.random_range(0..7) {
        0..3 => segments(),
        3..6 => sweep(),
        _ => reproduce(),
    };
    let signal = if ground.rng.random() { "TERM" } else { "INT" };
    let jobs = ground.rng.random_range(1..3);
    let after = trial.takes.mul_f64(ground.rng.random::<f64>());
    asked_to_stop(trial, signal, jobs, after, ground);
}

#[test]
fn asked_to_stop_it_ends_soon_and_goes_on_to_the_same() {
    let mut ground = Ground::quick(9);
    let half = sweep().takes / 2;
    asked_to_stop(sweep(), "TERM", 2, half, &mut ground);
    asked_to_stop(sweep(), "INT", 1, half, &mut ground);
    assert_eq!(ground.log.of_class(CLASS), 2, "law: each is noted");
}
