//! Too few threads, too little memory: the same bytes, or one message.

use std::{
    fs,
    os::unix::process::ExitStatusExt,
    path::{Path, PathBuf},
    process::{Command, Output, Stdio},
    thread::sleep,
    time::Duration,
};

use rand::RngExt;

use super::{
    super::same::assert_whole_files,
    Ground,
    log::KILLED,
    trials::{PATIENCE, Trial, ended, said, segments, spawned, sweep, verdict},
};

const CLASS: &str = "limits";

/// A group of processes with a limit, which is removed when it is dropped (cgroups, version 1).
struct Group(PathBuf);

impl Group {
    /// None where this process may make none.
    fn new(controller: &str, file: &str, limit: u64) -> Option<Self> {
        let root = Path::new("/sys/fs/cgroup").join(controller);
        if !root.join("cgroup.procs").exists() {
            return None;
        }
        let group = Self(root.join(format!("pluvia-soak-{}-{controller}", std::process::id())));
        fs::create_dir(&group.0).ok()?;
        fs::write(group.0.join(file), limit.to_string()).ok()?;
        Some(group)
    }

    /// A command whose process joins first.
    fn command(&self, trial: &Trial, out: &Path) -> Command {
        let join = "echo $$ > \"$0/cgroup.procs\" && exec \"$@\"";
        trial.under(&["sh", "-c", join, self.0.to_str().expect("UTF-8")], out)
    }
}

impl Drop for Group {
    fn drop(&mut self) {
        // Its last process may not be gone yet.
        for _ in 0..100 {
            if fs::remove_dir(&self.0).is_ok() {
                return;
            }
            sleep(Duration::from_millis(10));
        }
        eprintln!("{} stays", self.0.display());
    }
}

/// The verdict, where memory may be short: the allocators of Rust and C++ end a process.
fn of_memory(output: &Output) -> Result<String, String> {
    let said = said(output);
    let short = ["memory allocation of", "bad_alloc", "memory allocation failed", "out of memory"];
    let is_short = short.iter().any(|words| said.contains(words));
    let loader = said.contains("error while loading shared libraries")
        || said.contains("cannot allocate memory") && output.status.code() == Some(127);
    match (output.status.signal(), output.status.code()) {
        (Some(6), _) if is_short => {
            Ok("ended by the allocator, which says so, then finished with the same bytes".into())
        }
        (_, Some(126 | 127)) if loader => Ok("not started: the system cannot load it".into()),
        _ => verdict(output, &[3, 4]),
    }
}

/// After a limit without it.
fn concluded(trial: &Trial, out: &Path, what: &str, got: (&str, &str), ground: &mut Ground) {
    assert_whole_files(out, &trial.whole, what);
    trial.finish(out, what);
    let (phase, outcome) = got;
    ground.log.case(CLASS, phase, outcome);
}

/// A limit of threads and processes, the program included.
fn threads(trial: &Trial, most: u64, ground: &mut Ground) {
    let phase = format!("{}, threads", trial.name);
    let out = ground.place();
    let Some(group) = Group::new("pids", "pids.max", most) else {
        return ground.skip(CLASS, &phase, "no cgroup of pids can be made");
    };
    let what = format!("{} with {most} threads", trial.name);
    let output = ended(spawned(group.command(trial, &out)), PATIENCE, &what);
    let outcome = verdict(&output, &[3, 4]).unwrap_or_else(|got| panic!("law: {what}: {got}"));
    concluded(trial, &out, &what, (&phase, &outcome), ground);
}

/// A limit of addresses in MiB.
fn addresses(trial: &Trial, mib: u64, ground: &mut Ground) {
    let phase = format!("{}, addresses", trial.name);
    let mut tried = Command::new("prlimit");
    tried.args(["--version"]).stdout(Stdio::null()).stderr(Stdio::null());
    if !tried.status().is_ok_and(|status| status.success()) {
        return ground.skip(CLASS, &phase, "no prlimit");
    }
    let out = ground.place();
    let limit = format!("--as={}", mib << 20);
    let what = format!("{} in {mib} MiB", trial.name);
    let output = ended(spawned(trial.under(&["prlimit", &limit], &out)), PATIENCE, &what);
    let outcome = of_memory(&output).unwrap_or_else(|got| panic!("law: {what}: {got}"));
    concluded(trial, &out, &what, (&phase, &outcome), ground);
}

/// A limit of memory in MiB, beyond which the system kills.
fn memory(trial: &Trial, mib: u64, ground: &mut Ground) {
    let phase = format!("{}, memory of a cgroup", trial.name);
    let out = ground.place();
    let Some(group) = Group::new("memory", "memory.limit_in_bytes", mib << 20) else {
        return ground.skip(CLASS, &phase, "no cgroup of memory can be made");
    };
    let what = format!("{} in a cgroup of {mib} MiB", trial.name);
    let output = ended(spawned(group.command(trial, &out)), PATIENCE, &what);
    let outcome = match output.status.signal() {
        Some(9) => KILLED.to_owned(),
        _ => of_memory(&output).unwrap_or_else(|got| panic!("law: {what}: {got}")),
    };
    concluded(trial, &out, &what, (&phase, &outcome), ground);
}

/// `make soak`: one of each.
pub fn round(ground: &mut Ground) {
    let pick = |ground: &mut Ground| if ground.rng.random() { segments() } else { sweep() };
    let (trial, most) = (pick(ground), ground.rng.random_range(1..13));
    threads(trial, most, ground);
    // In a sweep a run that fails is a row that says so, and the table is another.
    let (addresses_mib, memory_mib) =
        (ground.rng.random_range(50..401), ground.rng.random_range(4..40));
    addresses(segments(), addresses_mib, ground);
    memory(segments(), memory_mib, ground);
}

#[test]
#[ignore = "slow: make test-all"]
fn limits_end_in_the_same_bytes_or_one_message() {
    let mut ground = Ground::quick(8);
    for most in [1, 3] {
        threads(sweep(), most, &mut ground);
    }
    addresses(segments(), 60, &mut ground);
    assert_eq!(ground.log.of_class(CLASS), 3, "law: each is noted");
}
