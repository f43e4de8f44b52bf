//! Commands that faults are done to, what each leaves undisturbed, and what is asked of it
//! afterwards.

use std::{
    ffi::OsString,
    fs,
    path::{Path, PathBuf},
    process::{Command, ExitStatus, Output, Stdio},
    sync::OnceLock,
    time::{Duration, Instant},
};

use tempfile::TempDir;

pub use super::super::program::{ended, said, send, spawned};
use super::super::{
    interruption::stages,
    program::{words, write},
    reproduce::PROGRAMME,
    same::{assert_same_files, half_written},
    segments::in_segments_timed,
    small,
};

/// No command here may take longer, whatever the machine does beside.
pub const PATIENCE: Duration = Duration::from_secs(180);

/// How long after a signal a process may still be there.
pub const STOPS_WITHIN: Duration = Duration::from_secs(10);

/// A command, undisturbed.
#[derive(Debug)]
pub struct Trial {
    pub name: &'static str,
    /// What it is called with, but for the output folder.
    args: Vec<OsString>,
    /// What it leaves.
    pub whole: PathBuf,
    pub takes: Duration,
    _folder: Option<TempDir>,
}

/// The file of the program under test.
pub fn program() -> &'static str {
    env!("CARGO_BIN_EXE_pluvia")
}

impl Trial {
    /// Carries it out once; `args` are given the folder for scenarios.
    fn new(name: &'static str, args: impl Fn(&Path) -> Vec<OsString>) -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        let (args, whole) = (args(folder.path()), folder.path().join("whole"));
        let mut trial = Self { name, args, whole, takes: Duration::ZERO, _folder: Some(folder) };
        let started = Instant::now();
        let done = trial.command(&trial.whole).status().expect("started");
        assert!(done.success(), "law: {name} can be run");
        trial.takes = started.elapsed();
        trial
    }

    /// The program's arguments, with results in `out`.
    pub fn args(&self, out: &Path) -> Vec<OsString> {
        let mut args = self.args.clone();
        args.extend(["--out".into(), out.into()]);
        args
    }

    /// The command, its messages kept.
    pub fn command(&self, out: &Path) -> Command {
        let mut command = Command::new(program());
        command.args(self.args(out)).stdout(Stdio::null()).stderr(Stdio::piped());
        command
    }

    /// The command as another program's, which begins it.
    pub fn under(&self, outer: &[&str], out: &Path) -> Command {
        let mut command = Command::new(outer[0]);
        command.args(&outer[1..]).arg(program()).args(self.args(out));
        command.stdout(Stdio::null()).stderr(Stdio::piped());
        command
    }

    /// Once more, undisturbed: all is as if nothing had happened, and the store is whole.
    pub fn finish(&self, out: &Path, what: &str) {
        let output = ended(spawned(self.command(out)), PATIENCE, what);
        let said = said(&output);
        assert!(output.status.success(), "law: {what}: {} can be finished: {said}", self.name);
        self.assert_same(out, what);
    }

    /// What there is is what an undisturbed command leaves.
    pub fn assert_same(&self, out: &Path, what: &str) {
        assert_same_files(&self.whole, out, &format!("{}, {what}", self.name));
        let left = half_written(out);
        assert!(left.is_empty(), "law: {what}: nothing half written stays: {left:?}");
        assert_whole_store(out, what);
    }

    /// What it is doing, by what is in its folder.
    pub fn phase(&self, out: &Path) -> String {
        format!("{}, {}", self.name, phase(out))
    }
}

/// How far a command is, by what is in its folder.
fn phase(out: &Path) -> String {
    let is_there = |name: &str| out.join(name).exists();
    let runs = || fs::read_dir(out.join("runs")).into_iter().flatten().flatten();
    let tables = is_there("series.csv") || runs().any(|run| run.path().join("series.csv").exists());
    if is_there("report.html") {
        "report".to_owned()
    } else if is_there("figures") {
        "figures".to_owned()
    } else if tables {
        "tables".to_owned()
    } else if is_there("stages") {
        format!("stage {}", stages(out) + 1)
    } else if is_there("grains.json") {
        "grains".to_owned()
    } else {
        "beginning".to_owned()
    }
}

/// `pluvia store check` finds no damage in an output folder, where there is a store at all.
pub fn assert_whole_store(out: &Path, what: &str) {
    if !out.join("stages").is_dir() {
        return;
    }
    let output = Command::new(program()).args(["store", "check"]).arg(out).output();
    let output = output.expect("it starts");
    assert_eq!(
        output.status.code(),
        Some(0),
        "law: {what}: the store is whole, got {}{}",
        String::from_utf8_lossy(&output.stdout),
        said(&output)
    );
}

/// How a process ended, in words.
pub fn code(status: ExitStatus) -> String {
    use std::os::unix::process::ExitStatusExt;
    match (status.code(), status.signal()) {
        (Some(code), _) => format!("exit code {code}"),
        (None, Some(signal)) => format!("signal {signal}"),
        (None, None) => "neither exit code nor signal".to_owned(),
    }
}

/// The verdict on a process for which something was not to be had: it ended well, or with one of
/// the exit codes and one message.
pub fn verdict(output: &Output, codes: &[i32]) -> Result<String, String> {
    let said = said(output);
    let errors = said.lines().filter(|line| line.starts_with("error: ")).count();
    let refused = output.status.code().filter(|code| codes.contains(code));
    match refused {
        _ if output.status.success() => Ok(super::log::ENDED.to_owned()),
        Some(code) if errors == 1 && !said.contains("panicked") => {
            Ok(format!("exit code {code} with one message, then finished with the same bytes"))
        }
        _ => Err(format!("{}, {errors} errors: {said}", code(output.status))),
    }
}

/// A run of forty grams in segments of a tenth of a second.
pub fn segments() -> &'static Trial {
    static MADE: OnceLock<Trial> = OnceLock::new();
    MADE.get_or_init(|| {
        let (folder, takes) = in_segments_timed();
        let scenario = folder.path().join("segments.json");
        let args = vec!["run".into(), scenario.into(), "--jobs".into(), "1".into()];
        let whole = folder.path().join("out");
        Trial { name: "run in segments", args, whole, takes: *takes, _folder: None }
    })
}

/// Two pours of fifteen grains, a table and a report.
pub fn sweep() -> &'static Trial {
    static MADE: OnceLock<Trial> = OnceLock::new();
    MADE.get_or_init(|| {
        Trial::new("sweep", |folder| {
            let path = write(folder, "small.json", &small::layer(30.0));
            let mut args = vec!["sweep".into(), path.into_os_string()];
            args.extend(["--over", "seed=1,2", "--jobs", "2"].map(OsString::from));
            args
        })
    })
}

/// The whole programme on some fifteen grains.
pub fn reproduce() -> &'static Trial {
    static MADE: OnceLock<Trial> = OnceLock::new();
    MADE.get_or_init(|| {
        Trial::new("reproduce", |_| {
            let args = words(PROGRAMME).into_iter().chain(["--jobs", "2"]);
            args.map(OsString::from).collect()
        })
    })
}
