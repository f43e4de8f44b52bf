//! The program as users run it.

use std::{fs, path::PathBuf};

use assert_cmd::Command;
use serde_json::Value;

/// The program, at the root of the tree.
pub fn pluvia() -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_pluvia"));
    command.current_dir(env!("CARGO_MANIFEST_DIR"));
    command
}

/// Runs it; gives its exit code, standard output and standard error.
pub fn run(args: &[&str]) -> (Option<i32>, String, String) {
    let output = pluvia().args(args).output().expect("the program starts");
    let text = |bytes| String::from_utf8(bytes).expect("UTF-8");
    (output.status.code(), text(output.stdout), text(output.stderr))
}

/// Runs it to a good end; gives its standard output.
pub fn done(args: &[&str]) -> String {
    let (code, text, err) = run(args);
    assert_eq!(code, Some(0), "law: {args:?} ends well: {err}");
    text
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
        self.path(name).to_str().expect("UTF-8").to_owned()
    }

    /// Writes a scenario; gives its path.
    pub fn scenario(&self, name: &str, scenario: &Value) -> String {
        fs::write(self.path(name), scenario.to_string()).expect("a file");
        self.out(name)
    }

    pub fn bytes(&self, name: &str) -> Vec<u8> {
        fs::read(self.path(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
    }

    pub fn json(&self, name: &str) -> Value {
        serde_json::from_slice(&self.bytes(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
    }
}
