//! Disks that fill up or break, folders that go away under way.

use std::{
    fs,
    thread::sleep,
    time::{Duration, Instant},
};

use rand::RngExt;

use super::{
    super::same::{assert_whole_files, files},
    Ground,
    durable::strace,
    image::Mounted,
    trials::{PATIENCE, Trial, ended, segments, spawned, sweep, verdict},
};

const CLASS: &str = "disk";

/// Disks of a size at which some files do not fit; with room again it goes on.
fn full(kib: u64, ground: &mut Ground) {
    let (trial, place) = (sweep(), ground.place());
    let phase = format!("{}, full", trial.name);
    let Some(disk) = Mounted::tmpfs(&place, kib) else {
        return ground.skip(CLASS, &phase, "no file system can be mounted");
    };
    let out = place.join("out");
    let what = format!("a disk of {kib} KiB");
    let output = ended(spawned(trial.command(&out)), PATIENCE, &what);
    let outcome = verdict(&output, &[4]).unwrap_or_else(|got| panic!("law: {what}: {got}"));
    assert_whole_files(&out, &trial.whole, &what);
    disk.resize(64 << 10);
    trial.finish(&out, &what);
    ground.log.case(CLASS, &phase, &outcome);
}

/// A disk that breaks down and is read-only from then on.
fn read_only(after: f64, ground: &mut Ground) {
    let (trial, place) = (segments(), ground.place());
    let phase = format!("{}, read-only", trial.name);
    let Some(disk) = Mounted::ext4(&place, "errors=remount-ro") else {
        return ground.skip(CLASS, &phase, "no ext4 can be mounted");
    };
    let out = place.join("out");
    let run = spawned(trial.command(&out));
    sleep(trial.takes.mul_f64(after));
    let broken = disk.break_down();
    let what = "a disk that breaks down";
    let output = ended(run, PATIENCE, what);
    if !broken {
        return ground.skip(CLASS, &phase, "the kernel has no trigger_fs_error");
    }
    let outcome = verdict(&output, &[4]).unwrap_or_else(|got| panic!("law: {what}: {got}"));
    disk.again(true, "defaults");
    assert_whole_files(&out, &trial.whole, what);
    trial.finish(&out, what);
    ground.log.case(CLASS, &phase, &outcome);
}

/// The output folder gets another name under way.
fn renamed_away(trial: &Trial, after: f64, ground: &mut Ground) {
    let (out, away) = (ground.place(), ground.place());
    let run = spawned(trial.command(&out));
    sleep(trial.takes.mul_f64(after));
    // It is there at last, however late a busy machine begins.
    let begun = Instant::now();
    while !out.exists() && begun.elapsed() < PATIENCE {
        sleep(Duration::from_millis(2));
    }
    fs::rename(&out, &away).expect("law: it is there");
    let what = "a folder that is renamed";
    let output = ended(run, PATIENCE, what);
    let outcome = verdict(&output, &[4]).unwrap_or_else(|got| panic!("law: {what}: {got}"));
    assert_whole_files(&away, &trial.whole, what);
    if output.status.success() {
        // It had ended before, or nothing had been written yet and all is where it was asked for.
        let (all, none) = if files(&away).is_empty() { (&out, &away) } else { (&away, &out) };
        trial.assert_same(all, what);
        assert!(files(none).is_empty(), "law: {what}: results are in one folder");
    }
    if out.exists() {
        assert_whole_files(&out, &trial.whole, what);
    }
    trial.finish(&away, what);
    ground.log.case(CLASS, &format!("{}, folder renamed", trial.name), &outcome);
}

/// A call that the system refuses once, or from then on.
fn refused(trial: &Trial, call: &str, error: &str, when: &str, ground: &mut Ground) {
    let phase = format!("{}, {call} fails with {error}", trial.name);
    if !strace() {
        return ground.skip(CLASS, &phase, "no strace");
    }
    let out = ground.place();
    let trace = format!("trace={call}");
    let inject = format!("inject={call}:error={error}:when={when}");
    let outer = ["strace", "-f", "-qq", "-o", "/dev/null", "-e", &trace, "-e", &inject];
    let what = format!("{call} number {when} fails with {error}");
    let output = ended(spawned(trial.under(&outer, &out)), PATIENCE, &what);
    let outcome = verdict(&output, &[4]).unwrap_or_else(|got| panic!("law: {what}: {got}"));
    assert_whole_files(&out, &trial.whole, &what);
    if output.status.success() {
        trial.assert_same(&out, &what);
    }
    trial.finish(&out, &what);
    ground.log.case(CLASS, &phase, &outcome);
}

/// `make soak`: each of them once.
pub fn round(ground: &mut Ground) {
    let kib = ground.rng.random_range(8..1400);
    full(kib, ground);
    let (one, other) = (ground.rng.random(), ground.rng.random());
    read_only(one, ground);
    renamed_away(segments(), other, ground);
    let calls = ["fsync", "renameat", "rename", "linkat", "mkdir", "openat"];
    let call = calls[ground.rng.random_range(0..calls.len())];
    let error = ["ENOSPC", "EIO"][ground.rng.random_range(0..2)];
    // Of the first calls the system loads the program with.
    let first = if call == "openat" { 40 } else { 1 };
    let n: u32 = ground.rng.random_range(first..first + 60);
    let when = if ground.rng.random() { n.to_string() } else { format!("{n}+") };
    let trial = if ground.rng.random() { segments() } else { sweep() };
    refused(trial, call, error, &when, ground);
}

#[test]
fn a_disk_that_fails_is_reported_and_nothing_is_lost() {
    let mut ground = Ground::quick(4);
    full(60, &mut ground);
    renamed_away(sweep(), 0.3, &mut ground);
    refused(sweep(), "fsync", "EIO", "11", &mut ground);
    assert_eq!(ground.log.of_class(CLASS), 3, "law: each is noted");
}
