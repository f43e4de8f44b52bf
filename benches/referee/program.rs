//! The referee's own programs, which answer a line of JSON with a line of JSON.

use std::{
    io::{BufRead, BufReader, Write},
    path::{Path, PathBuf},
    process::{Child, ChildStdin, ChildStdout, Command, Stdio},
};

use serde_json::Value;

use super::tree::root;

/// A running program.
pub struct Program {
    name: String,
    child: Child,
    questions: Option<ChildStdin>,
    answers: BufReader<ChildStdout>,
}

/// Folder that `scripts/referee.sh` builds into.
fn workshop() -> PathBuf {
    root().join("target/referee")
}

/// The file of the program that solves, pours and measures (`main.cpp`).
pub fn referee() -> PathBuf {
    workshop().join("referee")
}

/// The file of the certificate.
pub fn certificate() -> PathBuf {
    root().join("benches/referee/certificate.py")
}

impl Program {
    /// Starts the referee with arguments (`main.cpp` says which).
    pub fn referee(args: &[&str]) -> Result<Self, String> {
        Self::run(Command::new(referee()).args(args))
    }

    /// Starts the certificate of `certificate.py`.
    pub fn certificate() -> Result<Self, String> {
        let python = workshop().join("venv/bin/python");
        Self::run(Command::new(python).arg(certificate()).arg("answer"))
    }

    fn run(command: &mut Command) -> Result<Self, String> {
        let name = Path::new(command.get_program()).display().to_string();
        // One thread each: work is spread over programs.
        let mut child = command
            .env("OMP_NUM_THREADS", "1")
            .env("OPENBLAS_NUM_THREADS", "1")
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            // Siconos reports its attempts there.
            .stderr(Stdio::null())
            .spawn()
            .map_err(|e| format!("{name}: {e}; `make referee` builds it"))?;
        let questions = child.stdin.take();
        let answers = BufReader::new(child.stdout.take().ok_or("no output")?);
        Ok(Self { name, child, questions, answers })
    }

    /// Asks one question.
    pub fn ask(&mut self, question: &Value) -> Result<Value, String> {
        let name = &self.name;
        let stopped = |e: std::io::Error| format!("{name} stopped: {e}");
        let questions = self.questions.as_mut().ok_or("no questions are taken any more")?;
        writeln!(questions, "{question}").map_err(stopped)?;
        let mut line = String::new();
        self.answers.read_line(&mut line).map_err(stopped)?;
        if line.is_empty() {
            return Err(format!("{name} stopped without an answer"));
        }
        serde_json::from_str(&line).map_err(|e| format!("{name} answers {line:?}: {e}"))
    }
}

impl Drop for Program {
    fn drop(&mut self) {
        // It ends when its input does.
        self.questions = None;
        let _ = self.child.wait();
    }
}

/// A number of an answer.
pub fn number(answer: &Value, field: &str) -> Result<f64, String> {
    answer[field].as_f64().ok_or_else(|| format!("the answer has no number `{field}`"))
}
