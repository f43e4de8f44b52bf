//! The program as users run it, and the files that it is given and leaves.

use std::{
    fs,
    io::{self, Write},
    path::{Path, PathBuf},
    process::{Child, Command, Output, Stdio},
    thread::sleep,
    time::{Duration, Instant},
};

use serde_json::Value;

/// The root of the tree.
pub fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The text of a file of the tree.
pub fn page(path: &str) -> String {
    fs::read_to_string(root().join(path)).unwrap_or_else(|e| panic!("{path} cannot be read: {e}"))
}

/// The program, at the root of the tree.
pub fn pluvia() -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_pluvia"));
    command.current_dir(root());
    // What it says is compared: a test that means colours or another width asks for them itself.
    command.env_remove("CLICOLOR_FORCE").env_remove("COLUMNS");
    command
}

/// Runs it.
pub fn output(args: &[&str]) -> Output {
    pluvia().args(args).output().expect("the program starts")
}

/// Runs it; gives its exit code, standard output and standard error.
pub fn run(args: &[&str]) -> (Option<i32>, String, String) {
    let output = output(args);
    let text = |bytes| String::from_utf8(bytes).expect("UTF-8");
    (output.status.code(), text(output.stdout), text(output.stderr))
}

/// Runs it to a good end; gives its standard output.
pub fn done(args: &[&str]) -> String {
    let (code, text, err) = run(args);
    assert_eq!(code, Some(0), "law: {args:?} ends well: {err}");
    text
}

/// Runs it where it is to be refused, with an exit code and words; gives what it said.
pub fn refused(args: &[&str], expected: i32, words: &[&str]) -> String {
    let (code, _, err) = run(args);
    assert_eq!(code, Some(expected), "law: {args:?} is refused: {err}");
    assert_holds(&err, words);
    err
}

pub fn spawned(mut command: Command) -> Child {
    command.spawn().unwrap_or_else(|e| panic!("{command:?} cannot be started: {e}"))
}

/// Waits for a process, which is given so long, and reads what it said.
pub fn ended(mut child: Child, within: Duration, what: &str) -> Output {
    let begun = Instant::now();
    while child.try_wait().expect("its state").is_none() {
        if begun.elapsed() > within {
            let _ = child.kill();
            let output = child.wait_with_output().expect("its output");
            panic!("law: {what}: it ends within {within:?}; it said: {}", said(&output));
        }
        sleep(Duration::from_millis(3));
    }
    child.wait_with_output().expect("its output")
}

/// Sends a signal by its name to a process that was not waited for: it is there, even if it ended.
#[track_caller]
pub fn send(child: &Child, signal: &str) {
    let mut kill = Command::new("kill");
    kill.args(["-s", signal, &child.id().to_string()]);
    let sent = kill.stdout(Stdio::null()).stderr(Stdio::null()).status().expect("kill starts");
    assert!(sent.success(), "law: SIG{signal} is sent, got {sent}");
}

/// Whether a process has its own answer to SIGTERM and to Ctrl-C, as Linux says; where no system
/// says so, it is taken to have.
#[cfg(unix)]
pub fn catches_signals(child: &Child) -> bool {
    let status = fs::read_to_string(format!("/proc/{}/status", child.id())).unwrap_or_default();
    let Some(caught) = status.lines().find_map(|line| line.strip_prefix("SigCgt:")) else {
        return true;
    };
    let caught = u64::from_str_radix(caught.trim(), 16).unwrap_or(0);
    // SIGINT is number 2 and SIGTERM number 15; the lowest bit is that of number 1.
    caught & (1 << 1) != 0 && caught & (1 << 14) != 0
}

/// A text has all of these words.
#[track_caller]
pub fn assert_holds(text: &str, words: &[&str]) {
    for word in words {
        assert!(text.contains(word), "law: `{word}` is said, got: {text}");
    }
}

/// What a program said.
pub fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// Says aloud that a test was skipped: what a macro prints is captured, and nobody would see it.
pub fn skipped(what: &str, why: &str) {
    let said = format!("\n*** SKIPPED: {what} is NOT tested: {why} ***\n");
    let _ = io::stderr().write_all(said.as_bytes());
}

/// A path as an argument.
pub fn text(path: &Path) -> &str {
    path.to_str().expect("UTF-8")
}

pub fn json(path: &Path) -> Value {
    let bytes = fs::read(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    serde_json::from_slice(&bytes).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

/// Writes JSON into a folder; gives its path.
pub fn write(folder: &Path, name: &str, value: &Value) -> PathBuf {
    let path = folder.join(name);
    fs::write(&path, value.to_string()).expect("a file");
    path
}

/// Writes a script that can be run.
#[cfg(unix)]
pub fn script(path: &Path, text: &str) {
    use std::os::unix::fs::PermissionsExt;
    fs::write(path, text).expect("written");
    fs::set_permissions(path, fs::Permissions::from_mode(0o755)).expect("made a program");
}

/// Arguments, as they are typed.
pub fn words(line: &str) -> Vec<&str> {
    line.split_whitespace().collect()
}

/// A column of a table, empty cells as NaN.
pub fn column(file: &Path, name: &str) -> Vec<f64> {
    let mut reader = csv::Reader::from_path(file).expect("a table");
    let head = reader.headers().expect("a head").clone();
    let at = head.iter().position(|h| h == name);
    let at = at.unwrap_or_else(|| panic!("no column {name} among {head:?}"));
    let cell = |row: csv::StringRecord| row[at].parse().unwrap_or(f64::NAN);
    reader.records().map(|row| cell(row.expect("a row"))).collect()
}

/// A folder that is gone when this is.
pub struct Folder(tempfile::TempDir);

impl Folder {
    pub fn new() -> Self {
        Self(tempfile::tempdir().expect("a temporary folder"))
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// Path of a file or folder in it, as an argument.
    pub fn out(&self, name: &str) -> String {
        text(&self.path(name)).to_owned()
    }

    /// Writes a scenario; gives its path.
    pub fn scenario(&self, name: &str, scenario: &Value) -> String {
        text(&write(self.0.path(), name, scenario)).to_owned()
    }

    pub fn bytes(&self, name: &str) -> Vec<u8> {
        fs::read(self.path(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
    }

    pub fn text(&self, name: &str) -> String {
        fs::read_to_string(self.path(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
    }

    pub fn json(&self, name: &str) -> Value {
        json(&self.path(name))
    }
}

/// Lines at which a test ends after words that are captured, so that nobody learns of it.
fn silent_ends(text: &str) -> Vec<usize> {
    let lines: Vec<&str> = text.lines().map(str::trim).collect();
    let is_silent = |end: &usize| {
        let before = lines[..*end].iter().rev().take_while(|line| !line.ends_with(['{', '}']));
        lines[*end].starts_with("return;") && before.take(6).any(|line| line.contains("println!("))
    };
    (0..lines.len()).filter(is_silent).map(|line| line + 1).collect()
}

/// Law: a test that ends before it has tested says so by [`skipped`].
#[test]
fn tests_are_skipped_aloud() {
    let found = silent_ends("if there {\neprintln!(\n\"none\"\n);\nreturn;\n}\nreturn;");
    assert_eq!(found, [5], "law: the check finds faults");
    for (path, text) in super::architecture::files(&["tests/it"], &["rs"]) {
        let found = silent_ends(&text);
        assert!(found.is_empty(), "law: skipped by `skipped`, got lines {found:?} of {path}");
    }
}
