//! Killed at every call that makes something durable: before the first `fsync`, the second, and
//! so on to the last, and the same for what gives files their names (strace, Linux).

use std::{
    os::unix::process::ExitStatusExt,
    path::Path,
    process::{Command, Stdio},
    sync::{Mutex, PoisonError},
};

use rand::RngExt;

use super::{
    super::same::assert_whole_files,
    Ground,
    log::KILLED,
    trials::{PATIENCE, Trial, assert_whole_store, ended, said, segments, spawned, sweep},
};

const CLASS: &str = "durable points";

/// The calls. strace counts each by itself, and in each thread.
const CALLS: [&str; 4] = ["fsync", "renameat", "rename", "linkat"];

/// Whether strace can look at programs here.
pub fn strace() -> bool {
    let mut command = Command::new("strace");
    command.args(["-f", "-o", "/dev/null", "-e", "trace=fsync", "true"]);
    command.stdout(Stdio::null()).stderr(Stdio::null()).status().is_ok_and(|s| s.success())
}

/// Runs a command and kills it when it makes the n-th such call; its phase then, or none where
/// it makes fewer.
fn killed_at(trial: &Trial, call: &str, n: u32, out: &Path) -> Option<String> {
    let (trace, inject) = (format!("trace={call}"), format!("inject={call}:signal=KILL:when={n}"));
    let outer = ["strace", "-f", "-qq", "-o", "/dev/null", "-e", &trace, "-e", &inject];
    let output = ended(spawned(trial.under(&outer, out)), PATIENCE, call);
    if output.status.success() {
        return None;
    }
    let killed = output.status.signal() == Some(9) || output.status.code() == Some(137);
    assert!(killed, "law: it is killed, got {}: {}", output.status, said(&output));
    Some(trial.phase(out))
}

/// Kills a command at one point, and has it finish; whether there is such a point.
fn point(trial: &Trial, call: &str, n: u32, ground: &mut Ground) -> bool {
    let out = ground.place();
    let what = format!("{call} {n}");
    let Some(phase) = killed_at(trial, call, n, &out) else {
        trial.assert_same(&out, &what);
        return false;
    };
    assert_whole_files(&out, &trial.whole, &what);
    assert_whole_store(&out, &what);
    trial.finish(&out, &what);
    ground.log.case(CLASS, &phase, KILLED);
    true
}

/// Which point is next: command, call, number.
static NEXT: Mutex<(usize, usize, u32)> = Mutex::new((0, 0, 1));

/// `make soak`: some points after those of the round before; each point of each command once,
/// then random ones.
pub fn round(ground: &mut Ground) {
    if !strace() {
        return ground.skip(CLASS, "-", "no strace");
    }
    let trials = [sweep(), segments()];
    for _ in 0..8 {
        let (trial, call, n) = *NEXT.lock().unwrap_or_else(PoisonError::into_inner);
        let Some(of_round) = trials.get(trial) else {
            let n = ground.rng.random_range(1..150);
            point(sweep(), CALLS[0], n, ground);
            continue;
        };
        let met = point(of_round, CALLS[call], n, ground);
        let next = if met {
            (trial, call, n + 1)
        } else {
            let all = format!("{}, all {} of {}", of_round.name, n - 1, CALLS[call]);
            ground.log.case(CLASS, &all, "every point of these tried");
            if call + 1 < CALLS.len() { (trial, call + 1, 1) } else { (trial + 1, 0, 1) }
        };
        *NEXT.lock().unwrap_or_else(PoisonError::into_inner) = next;
    }
}

#[test]
fn killed_before_something_is_durable_it_ends_the_same() {
    let mut ground = Ground::quick(3);
    if !strace() {
        return ground.skip(CLASS, "-", "no strace");
    }
    for (call, n) in [("fsync", 9), ("rename", 2)] {
        assert!(point(sweep(), call, n, &mut ground), "law: {call} {n} is met");
    }
}
