//! Two to eight processes that work in one output folder, begun at random moments, of which one
//! may be killed.

use std::{
    path::Path,
    process::{Child, Command, Stdio},
    thread::sleep,
    time::Duration,
};

use rand::{RngExt, seq::SliceRandom};
use serde_json::Value;

use super::{
    Ground,
    log::{ENDED, KILLED},
    trials::{PATIENCE, Trial, ended, program, reproduce, said, segments, spawned, sweep},
};

const CLASS: &str = "several processes";

/// All that are not killed end well.
fn all_end(children: Vec<(Child, bool)>, what: &str) {
    for (child, killed) in children {
        let output = ended(child, PATIENCE, what);
        let said = said(&output);
        assert!(killed || output.status.success(), "law: {what}: each ends with 0, got {said}");
    }
}

/// Has one killed, if that is wanted, after a while.
fn kill_one(children: &mut [(Child, bool)], within: Duration, ground: &mut Ground) {
    sleep(within.mul_f64(ground.rng.random::<f64>()));
    let chosen = ground.rng.random_range(0..children.len());
    let (child, killed) = &mut children[chosen];
    let _ = child.kill();
    *killed = true;
}

/// The same command many times.
fn together(trial: &Trial, count: usize, kill: bool, ground: &mut Ground) {
    let out = ground.place();
    let mut children = Vec::new();
    for _ in 0..count {
        children.push((spawned(trial.command(&out)), false));
        sleep(trial.takes.mul_f64(ground.rng.random::<f64>() / count as f64));
    }
    if kill {
        kill_one(&mut children, trial.takes, ground);
    }
    let what = format!("{count} times {} at once", trial.name);
    all_end(children, &what);
    let phase = format!("{}, {count} processes", trial.name);
    if kill {
        trial.finish(&out, &what);
        ground.log.case(CLASS, &phase, KILLED);
    } else {
        trial.assert_same(&out, &what);
        ground.log.case(CLASS, &phase, ENDED);
    }
}

fn pluvia(args: &[&str], out: &Path) -> Command {
    let mut command = Command::new(program());
    let (first, rest) = args.split_first().expect("a command");
    command.arg(first);
    // The folder of a sweep is an argument of `stage`, an option of `sweep`.
    let folder = if *first == "stage" { command.arg(out) } else { command.arg("--out").arg(out) };
    folder.args(rest).stdout(Stdio::null()).stderr(Stdio::piped());
    command
}

/// A sweep whose stages are run by processes of their own, each twice at once, with a
/// `sweep` beside them.
fn stage_by_stage(kill: bool, ground: &mut Ground) {
    let (trial, out) = (sweep(), ground.place());
    let mut plan = trial.command(&out);
    assert!(plan.arg("--plan-only").status().expect("started").success(), "law: it is planned");
    let list = pluvia(&["stage", "--list", "--json"], &out).stdout(Stdio::piped()).output();
    let list: Value = serde_json::from_slice(&list.expect("started").stdout).expect("JSON");
    let levels = list["levels"].as_array().expect("levels").clone();
    let mut beside = vec![(spawned(trial.command(&out)), false)];
    if kill {
        kill_one(&mut beside, trial.takes / 2, ground);
    }
    let mut count = 1;
    for (level, tasks) in levels.iter().enumerate() {
        let tasks = tasks.as_u64().expect("a number");
        let mut each: Vec<u64> = (0..tasks).chain(0..tasks).collect();
        each.shuffle(&mut ground.rng);
        let child = |task: u64| {
            let (level, task) = (level.to_string(), task.to_string());
            (spawned(pluvia(&["stage", "--level", &level, "--task", &task], &out)), false)
        };
        let children: Vec<_> = each.into_iter().map(child).collect();
        count += children.len();
        all_end(children, "stages of a sweep");
    }
    all_end(beside, "a sweep beside its stages");
    let collected = pluvia(&["sweep", "--collect"], &out).output().expect("started");
    assert!(collected.status.success(), "law: it is collected: {}", said(&collected));
    trial.finish(&out, "a sweep stage by stage");
    let outcome = if kill { KILLED } else { ENDED };
    ground.log.case(CLASS, &format!("stage and sweep, {count} processes"), outcome);
}

/// `make soak`: one command or the other, with a kill in half of the rounds.
pub fn round(ground: &mut Ground) {
    let kill = ground.rng.random();
    match ground.rng.random_range(0..8) {
        0..3 => together(segments(), ground.rng.random_range(2..9), kill, ground),
        3..5 => together(sweep(), ground.rng.random_range(2..9), kill, ground),
        5 => together(reproduce(), ground.rng.random_range(2..5), kill, ground),
        _ => stage_by_stage(kill, ground),
    }
}

#[test]
#[ignore = "slow: make test-all"]
fn processes_in_one_folder_leave_what_one_alone_does() {
    let mut ground = Ground::quick(5);
    together(sweep(), 3, true, &mut ground);
    stage_by_stage(false, &mut ground);
    assert_eq!(ground.log.of_class(CLASS), 2, "law: each is noted");
}
