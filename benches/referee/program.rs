//! The referee's own program, which answers a line of JSON with a line of JSON.

use std::{
    io::{BufRead, BufReader, Write},
    path::{Path, PathBuf},
    process::{Child, ChildStdin, ChildStdout, Command, Stdio},
};

use pluvia::record::hash_bytes;
use serde_json::Value;

/// Folder that `scripts/referee.sh` builds into.
pub const WORKSHOP: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/target/referee");

/// A running referee.
pub struct Program {
    child: Child,
    questions: Option<ChildStdin>,
    answers: BufReader<ChildStdout>,
}

impl Program {
    /// Starts it with arguments (`benches/referee/main.cpp` says which).
    pub fn start(args: &[&str]) -> Result<Self, String> {
        let file = Path::new(WORKSHOP).join("referee");
        Self::run(&file, args)
    }

    /// Starts the certificate of `certificate.py`.
    pub fn certificate() -> Result<Self, String> {
        let script = concat!(env!("CARGO_MANIFEST_DIR"), "/benches/referee/certificate.py");
        Self::run(&Path::new(WORKSHOP).join("venv/bin/python"), &[script, "answer"])
    }

    fn run(file: &Path, args: &[&str]) -> Result<Self, String> {
        let mut child = Command::new(file)
            .args(args)
            .env("OMP_NUM_THREADS", "1")
            .env("OPENBLAS_NUM_THREADS", "1")
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            // Siconos tells there what it tries.
            .stderr(Stdio::null())
            .spawn()
            .map_err(|e| format!("{}: {e}; `make referee` builds it", file.display()))?;
        let questions = child.stdin.take();
        let answers = BufReader::new(child.stdout.take().ok_or("no output")?);
        Ok(Self { child, questions, answers })
    }

    /// Asks one question.
    pub fn ask(&mut self, question: &Value) -> Result<Value, String> {
        let told = |e: std::io::Error| format!("the referee stopped: {e}");
        let questions = self.questions.as_mut().ok_or("the referee takes no questions")?;
        writeln!(questions, "{question}").map_err(told)?;
        let mut line = String::new();
        self.answers.read_line(&mut line).map_err(told)?;
        if line.is_empty() {
            return Err("the referee stopped without an answer".into());
        }
        serde_json::from_str(&line).map_err(|e| format!("the referee answers {line:?}: {e}"))
    }
}

impl Drop for Program {
    fn drop(&mut self) {
        // It ends with its questions.
        self.questions = None;
        let _ = self.child.wait();
    }
}

/// Names the program that computed something: a hash of its file.
pub fn identity(file: &Path) -> Result<String, String> {
    let bytes = std::fs::read(file).map_err(|e| format!("{}: {e}", file.display()))?;
    Ok(hash_bytes(&bytes)[..16].to_owned())
}

/// The file of the referee's program.
pub fn file() -> PathBuf {
    Path::new(WORKSHOP).join("referee")
}

/// A number of an answer.
pub fn number(answer: &Value, field: &str) -> Result<f64, String> {
    answer[field].as_f64().ok_or_else(|| format!("the referee's answer has no number `{field}`"))
}
