//! Stopped for a while (SIGSTOP) and continued: whoever works beside it is not held up for ever.

use std::{
    fs::{self, File},
    thread::sleep,
    time::{Duration, Instant},
};

use rand::RngExt;

use super::{
    super::program::catches_signals,
    Ground,
    log::ENDED,
    trials::{PATIENCE, STOPS_WITHIN, Trial, code, ended, said, segments, send, spawned, sweep},
};

const CLASS: &str = "suspended";

/// One is stopped, another does it all, and the first is continued.
fn beside_another(trial: &Trial, after: Duration, ground: &mut Ground) {
    let out = ground.place();
    let first = spawned(trial.command(&out));
    sleep(after);
    send(&first, "STOP");
    let phase = trial.phase(&out);
    let what = format!("stopped after {after:?} in {phase}");
    let second = spawned(trial.command(&out));
    // One that was stopped while it alone held the store is waited for.
    sleep(3 * trial.takes);
    send(&first, "CONT");
    for (who, child) in [("first", first), ("second", second)] {
        let output = ended(child, PATIENCE, &what);
        let said = said(&output);
        assert!(output.status.success(), "law: {what}: the {who} ends with 0, got {said}");
    }
    trial.assert_same(&out, &what);
    ground.log.case(CLASS, &phase, ENDED);
}

/// While somebody who never goes on holds the store, or the turn to replace a stage, alone, others
/// wait; they end when they are asked to, and finish once it is free.
fn held_up(signal: &str, ground: &mut Ground) {
    let (trial, out) = (sweep(), ground.place());
    fs::create_dir_all(out.join("stages")).expect("a folder");
    let lock = File::create(out.join("stages/.lock")).expect("a lock");
    lock.lock().expect("held");
    let mut run = spawned(trial.command(&out));
    // On a busy machine it may begin late; how long it waits afterwards does not matter.
    let begun = Instant::now();
    while !catches_signals(&run) && begun.elapsed() < PATIENCE {
        sleep(Duration::from_millis(2));
    }
    sleep(Duration::from_millis(700));
    let waits = run.try_wait().expect("its state").is_none();
    assert!(waits, "law: it waits while the store is held");
    send(&run, signal);
    let what = format!("SIG{signal} to one that waits for the store");
    let output = ended(run, STOPS_WITHIN, &what);
    let got = code(output.status);
    assert_eq!(got, "exit code 130", "law: {what}, got {}", said(&output));
    drop(lock);
    trial.finish(&out, &what);
    let outcome = "waits, exit code 130 within 10 s, then finished with the same bytes";
    ground.log.case(CLASS, &format!("{}, waiting, SIG{signal}", trial.name), outcome);
}

/// `make soak`: both.
pub fn round(ground: &mut Ground) {
    let trial = if ground.rng.random() { segments() } else { sweep() };
    let after = trial.takes.mul_f64(ground.rng.random::<f64>());
    beside_another(trial, after, ground);
    let signal = if ground.rng.random() { "TERM" } else { "INT" };
    held_up(signal, ground);
}

#[test]
#[ignore = "slow: make test-all"]
fn one_that_is_stopped_holds_nobody_up_for_ever() {
    let mut ground = Ground::quick(10);
    beside_another(sweep(), sweep().takes / 2, &mut ground);
    held_up("TERM", &mut ground);
    assert_eq!(ground.log.of_class(CLASS), 2, "law: each is noted");
}
