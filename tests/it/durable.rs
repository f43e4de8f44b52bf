//! What is to outlive a power cut is brought to the disk in the right order: a file before it is
//! given its name, a name before anybody relies on it. Looked at where strace is: in the order of
//! the system calls of a run.

use std::{
    collections::HashMap,
    fs,
    path::{Path, PathBuf},
    process::{Command, Stdio},
};

use super::{
    interruption::write_scenario_in_segments,
    program::{said, skipped},
};

/// A call that changes names, or brings something to the disk.
#[derive(Debug, Clone, PartialEq)]
enum Call {
    Make(PathBuf),
    Rename(PathBuf, PathBuf),
    Sync(PathBuf),
}

/// The calls of a log of `strace -f -y` that were successful, in the order in which they ended.
fn calls(log: &str, folder: &Path) -> Vec<Call> {
    let mut begun: HashMap<&str, String> = HashMap::new();
    let mut calls = Vec::new();
    for line in log.lines() {
        let Some((process, rest)) = line.split_once(' ') else { continue };
        let mut text = rest.trim().to_owned();
        if let Some(begins) = text.strip_suffix("<unfinished ...>") {
            begun.insert(process, begins.trim().to_owned());
            continue;
        }
        if text.starts_with("<...") {
            let end = text.split_once("resumed>").map_or("", |(_, end)| end);
            text = begun.remove(process).unwrap_or_default() + end;
        }
        if !text.trim_end().ends_with("= 0") {
            continue;
        }
        let named: Vec<PathBuf> = text.split('"').skip(1).step_by(2).map(PathBuf::from).collect();
        let call = match (text.split('(').next().unwrap_or_default(), named.as_slice()) {
            ("mkdir" | "mkdirat", [made]) => Call::Make(made.clone()),
            ("rename" | "renameat" | "renameat2", [from, to]) => {
                Call::Rename(from.clone(), to.clone())
            }
            ("fsync" | "fdatasync", _) => {
                let path = text.split_once('<').and_then(|(_, rest)| rest.split_once('>'));
                Call::Sync(path.map_or_else(PathBuf::new, |(path, _)| PathBuf::from(path)))
            }
            _ => continue,
        };
        let at = match &call {
            Call::Make(path) | Call::Sync(path) | Call::Rename(_, path) => path,
        };
        if at.starts_with(folder) {
            calls.push(call);
        }
    }
    calls
}

fn is_temporary(path: &Path) -> bool {
    path.file_name().is_some_and(|name| name.to_string_lossy().starts_with(".part-"))
}

/// What a power cut could take though somebody relies on it.
fn faults(calls: &[Call]) -> Vec<String> {
    let mut faults = Vec::new();
    for (n, call) in calls.iter().enumerate() {
        let synced = |path: &Path, calls: &[Call]| calls.contains(&Call::Sync(path.to_owned()));
        match call {
            Call::Rename(from, to) => {
                if !synced(from, &calls[..n]) {
                    faults.push(format!("{} is named before it is on the disk", to.display()));
                }
                if !to.parent().is_some_and(|above| synced(above, &calls[n..])) {
                    faults.push(format!("the name of {} is not on the disk", to.display()));
                }
            }
            Call::Make(made) if !is_temporary(made) => {
                let above = made.parent().unwrap_or(Path::new("/"));
                // Something is relied on when it gets a name in the new folder.
                let relied =
                    |call: &Call| matches!(call, Call::Rename(_, to) if to.starts_with(made));
                let later = &calls[n..];
                let until = later.iter().position(relied).unwrap_or(later.len());
                if !synced(above, &later[..until]) {
                    faults
                        .push(format!("the name of {} is not on the disk in time", made.display()));
                }
            }
            Call::Make(_) | Call::Sync(_) => {}
        }
    }
    faults
}

/// Law: of the calls of a run, none leaves a name or a file behind that is not on the disk.
#[test]
fn names_are_on_the_disk_before_anybody_relies_on_them() {
    let folder = tempfile::tempdir().expect("a folder");
    let root = folder.path().canonicalize().expect("a path");
    let log = root.join("log");
    let watched = "trace=mkdir,mkdirat,rename,renameat,renameat2,fsync,fdatasync";
    let strace = |log: &Path| {
        let mut command = Command::new("strace");
        command.args(["-f", "-qq", "-y", "-s", "4096", "-e", watched, "-o"]).arg(log);
        command
    };
    let tried = strace(&log).arg("true").stderr(Stdio::null()).status();
    if !tried.is_ok_and(|status| status.success()) {
        let why = "no strace that works here; try: apt-get install strace";
        return skipped("the order of writes", why);
    }
    let scenario = write_scenario_in_segments(&root);
    let out = root.join("new/folders/out");
    let mut command = strace(&log);
    command.arg(env!("CARGO_BIN_EXE_pluvia")).arg("run").arg(&scenario).arg("--out").arg(&out);
    let output = command.arg("--quiet").output().expect("strace starts");
    assert!(output.status.success(), "{}", said(&output));
    let text = fs::read_to_string(&log).expect("a log");
    let calls = calls(&text, &root);
    let count = |is: fn(&Call) -> bool| calls.iter().filter(|call| is(call)).count();
    let renamed = count(|call| matches!(call, Call::Rename(..)));
    let made = count(|call| matches!(call, Call::Make(_)));
    assert!(renamed > 20 && made >= 6, "law: calls are seen, got {renamed} names, {made} folders");
    let faults = faults(&calls);
    assert!(faults.is_empty(), "law: nothing is relied on too early, got {faults:#?}");
}

/// A log, and what is wrong with it.
#[test]
fn a_log_that_is_in_another_order_has_faults() {
    let sound = "\
1 mkdir(\"/t/out\", 0777) = 0
1 fsync(3</t>) = 0
2 fsync(4</t/out/.pluvia-a.part> <unfinished ...>
1 mkdir(\"/t/out\", 0777) = -1 EEXIST (File exists)
2 <... fsync resumed>) = 0
1 rename(\"/t/out/.pluvia-a.part\", \"/t/out/a\") = 0
1 fsync(3</t/out>) = 0";
    let faults_of = |log: &str| faults(&calls(log, Path::new("/t")));
    assert_eq!(faults_of(sound), [""; 0], "law: files, then names, then folders");
    for (left_out, expected) in [
        ("fsync(3</t>)", "the name of /t/out is not on the disk in time"),
        ("resumed", "/t/out/a is named before it is on the disk"),
        ("fsync(3</t/out>)", "the name of /t/out/a is not on the disk"),
    ] {
        let lines: Vec<&str> = sound.lines().filter(|line| !line.contains(left_out)).collect();
        assert_eq!(faults_of(&lines.join("\n")), [expected], "law: without `{left_out}`");
    }
}
