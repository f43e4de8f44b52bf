//! Killed at a random moment, whatever it is doing.

use std::{fs, os::unix::process::ExitStatusExt, thread::sleep, time::Duration};

use rand::RngExt;

use super::{
    super::same::assert_whole_files,
    Ground,
    log::KILLED,
    trials::{
        PATIENCE, Trial, assert_whole_store, ended, reproduce, said, segments, spawned, sweep,
    },
};

const CLASS: &str = "kills";

/// Kills a command `kills` times at moments drawn evenly from the time it takes, then has it
/// finish, and compares. One that is over before it is killed begins anew, with less time where
/// it had been given all of it: the machine may have less to do than when it was timed.
pub fn survives(trial: &Trial, kills: usize, ground: &mut Ground) {
    let out = ground.place();
    let (mut phases, mut tried, mut takes, mut whole) = (Vec::new(), 0, trial.takes, true);
    while phases.len() < kills {
        tried += 1;
        assert!(tried <= 20 * kills, "law: it can be killed, {} of {kills} met", phases.len());
        let mut run = spawned(trial.command(&out));
        let after = takes.mul_f64(ground.rng.random::<f64>());
        sleep(after);
        // Killed outright (SIGKILL), whatever it is doing.
        let _ = run.kill();
        let phase = trial.phase(&out);
        let what = format!("kill {tried} after {after:?} in {phase}");
        let output = ended(run, PATIENCE, &what);
        let (done, said) = (output.status.success(), said(&output));
        if done {
            trial.assert_same(&out, &what);
            fs::remove_dir_all(&out).expect("removed");
            takes = if whole { takes.mul_f64(0.7).max(Duration::from_millis(50)) } else { takes };
        } else {
            let killed = output.status.signal() == Some(9);
            assert!(killed, "law: {what}: nothing else ends it, got {}: {said}", output.status);
            assert_whole_files(&out, &trial.whole, &what);
            assert_whole_store(&out, &what);
            phases.push(phase);
        }
        whole = done;
    }
    trial.finish(&out, &format!("{kills} kills"));
    for phase in phases {
        ground.log.case(CLASS, &phase, KILLED);
    }
}

/// `make soak`: one command, killed a few times on its way.
pub fn round(ground: &mut Ground) {
    let trial = match ground.rng.random_range(0..8) {
        0..2 => segments(),
        2..7 => sweep(),
        _ => reproduce(),
    };
    let kills = ground.rng.random_range(3..10);
    survives(trial, kills, ground);
}

#[test]
#[ignore = "slow: make test-all"]
fn killed_at_random_moments_a_command_leaves_only_whole_files_and_ends_the_same() {
    let mut ground = Ground::quick(7);
    for trial in [sweep(), segments()] {
        survives(trial, 2, &mut ground);
    }
    assert_eq!(ground.log.sum(CLASS, KILLED), 4, "law: each kill is noted");
}
