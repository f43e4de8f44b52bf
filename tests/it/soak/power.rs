//! The power is cut: an ext4 of the run's own forgets what it has not been made to write.
//!
//! Mounted so that nothing is written by itself (no flushing at renames, no commit for ten
//! minutes), so that only what the program has had brought to the disk is there afterwards. Not
//! modelled: other file systems, and what a drive keeps in a cache of its own.

use std::{fs, path::Path, process::Child, thread::sleep, time::Duration};

use rand::RngExt;

use super::{
    super::{
        interruption::stages,
        same::{assert_same_files, assert_whole_files},
    },
    Ground,
    durable::strace,
    image::Mounted,
    trials::{PATIENCE, Trial, assert_whole_store, ended, said, segments, spawned, sweep},
};

const CLASS: &str = "power cut";
const WITHOUT: &str = "power cut without fsync";
const OPTIONS: &str = "noauto_da_alloc,commit=600";
const OUTCOME: &str = "what had ended is there, then finished with the same bytes";

/// Cuts the power, and ends the process as that does; whether it had ended by itself, and what it
/// had said.
fn dark(disk: &Mounted, mut run: Child) -> Option<(bool, String)> {
    let done = run.try_wait().expect("its state").is_some_and(|status| status.success());
    let cut = disk.cut();
    let _ = run.kill();
    let output = ended(run, PATIENCE, "a process without power");
    disk.again(false, OPTIONS);
    cut.then(|| (done, said(&output)))
}

/// How many stages it had said to have ended.
fn announced(said: &str) -> usize {
    said.lines().filter(|line| line.contains(": ended after ")).count()
}

fn cut_after(trial: &Trial, after: Duration, ground: &mut Ground) {
    let place = ground.place();
    let Some(disk) = Mounted::ext4(&place, OPTIONS) else {
        return ground.skip(CLASS, trial.name, "no ext4 can be mounted");
    };
    let out = place.join("out");
    let run = spawned(trial.command(&out));
    sleep(after);
    let phase = trial.phase(&out);
    let Some((done, said)) = dark(&disk, run) else {
        return ground.skip(CLASS, trial.name, "ext4 is not shut down");
    };
    let what = format!("the power gone after {after:?} in {phase}");
    assert_whole_files(&out, &trial.whole, &what);
    assert_whole_store(&out, &what);
    let (ended, kept) = (announced(&said), stages(&out));
    assert!(kept >= ended, "law: {what}: {ended} stages had ended, got {kept}: {said}");
    if done {
        assert_same_files(&trial.whole, &out, &what);
    }
    trial.finish(&out, &what);
    ground.log.case(CLASS, &phase, OUTCOME);
}

/// `make soak`: one cut.
pub fn round(ground: &mut Ground) {
    let trial = if ground.rng.random() { segments() } else { sweep() };
    let after = trial.takes.mul_f64(1.1 * ground.rng.random::<f64>());
    cut_after(trial, after, ground);
}

/// Files of a sweep without times, from the first to the last that is written.
const FILES: [&str; 4] = ["grains.json", "plan.json", "figures/effect-seed.svg", "sweep.csv"];

/// How many of them are there, whole.
fn whole_files(part: &Path, whole: &Path) -> usize {
    let is_whole = |name: &&str| {
        let here = fs::read(part.join(name)).ok();
        here.is_some() && here == fs::read(whole.join(name)).ok()
    };
    FILES.into_iter().filter(is_whole).count()
}

/// The control: with calls of `fsync` that do nothing, a cut at the end loses files. If it did
/// not, the class would prove nothing.
fn nothing_brought_to_the_disk(ground: &mut Ground) {
    let (trial, place) = (sweep(), ground.place());
    if !strace() {
        return ground.skip(WITHOUT, trial.name, "no strace");
    }
    let Some(disk) = Mounted::ext4(&place, OPTIONS) else {
        return ground.skip(WITHOUT, trial.name, "no ext4 can be mounted");
    };
    let out = place.join("out");
    let outer = ["strace", "-f", "--seccomp-bpf", "-qq", "-o", "/dev/null"];
    let how = ["-e", "trace=fsync,fdatasync", "-e", "inject=fsync,fdatasync:retval=0"];
    let run = spawned(trial.under(&[&outer[..], &how[..]].concat(), &out));
    let output = ended(run, PATIENCE, "a run without fsync");
    assert!(output.status.success(), "law: it notices nothing: {}", said(&output));
    let all = FILES.len();
    assert_eq!(whole_files(&out, &trial.whole), all, "law: with power all is there");
    if !disk.cut() {
        return ground.skip(WITHOUT, trial.name, "ext4 is not shut down");
    }
    disk.again(false, OPTIONS);
    let left = whole_files(&out, &trial.whole);
    assert!(left < all, "law: what is not brought to the disk is lost, got all of it");
    ground.log.case(WITHOUT, trial.name, "files lost, as they must be");
}

/// `make soak`: the control.
pub fn control(ground: &mut Ground) {
    nothing_brought_to_the_disk(ground);
}

#[test]
fn a_power_cut_loses_nothing_that_had_ended_and_without_fsync_it_does() {
    let mut ground = Ground::quick(6);
    cut_after(sweep(), sweep().takes / 2, &mut ground);
    nothing_brought_to_the_disk(&mut ground);
    let tried = ground.log.of_class(CLASS) + ground.log.of_class(WITHOUT);
    assert_eq!(tried, 2, "law: each is noted");
}
