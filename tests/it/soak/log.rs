//! What became of each case: lines of JSON as they come, and counts of them.

use std::{
    collections::BTreeMap,
    fs::File,
    io::Write,
    path::{Path, PathBuf},
};

use serde::{Deserialize, Serialize};
use serde_json::json;

/// Outcome of a process that was killed and of what followed.
pub const KILLED: &str = "killed, then finished with the same bytes";

/// Outcome of a run that ended by itself, whatever was done to it.
pub const ENDED: &str = "ended with the same bytes";

/// How outcomes begin that prove nothing.
pub const SKIPPED: &str = "skipped: ";

/// How outcomes begin that should not be.
pub const FAULT: &str = "FAULT: ";

/// Cases of one class, phase and outcome.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Count {
    pub class: String,
    pub phase: String,
    pub outcome: String,
    pub count: u64,
}

/// Where cases are noted.
#[derive(Debug, Default)]
pub struct Log {
    file: Option<File>,
    counts: BTreeMap<(String, String, String), u64>,
}

/// The file that `make soak` writes, and `scripts/robustness.sh` reads.
pub fn place() -> PathBuf {
    Path::new(env!("CARGO_TARGET_TMPDIR")).join("soak.jsonl")
}

impl Log {
    /// Begins the log of a soak anew; its first line says what is tried.
    pub fn begin(file: &Path, seed: u64) -> Self {
        let file = File::create(file).expect("law: the log can be written");
        let mut log = Self { file: Some(file), counts: BTreeMap::new() };
        let profile = if cfg!(debug_assertions) { "dev" } else { "release" };
        let program = format!("pluvia {}", env!("CARGO_PKG_VERSION"));
        log.line(&json!({ "program": program, "profile": profile, "seed": seed }));
        log
    }

    fn line(&mut self, line: &serde_json::Value) {
        if let Some(file) = &mut self.file {
            writeln!(file, "{line}").expect("law: the log can be written");
        }
    }

    /// Notes one case.
    pub fn case(&mut self, class: &str, phase: &str, outcome: &str) {
        self.cases(class, phase, outcome, 1);
    }

    /// Notes several of a kind.
    pub fn cases(&mut self, class: &str, phase: &str, outcome: &str, count: u64) {
        if outcome.starts_with(SKIPPED) || outcome.starts_with(FAULT) {
            eprintln!("{class}, {phase}: {outcome}");
        }
        self.line(&json!({ "class": class, "phase": phase, "outcome": outcome, "count": count }));
        let key = (class.to_owned(), phase.to_owned(), outcome.to_owned());
        *self.counts.entry(key).or_default() += count;
    }

    /// All counts so far.
    pub fn counts(&self) -> Vec<Count> {
        let each = self.counts.iter().map(|((class, phase, outcome), count)| Count {
            class: class.clone(),
            phase: phase.clone(),
            outcome: outcome.clone(),
            count: *count,
        });
        each.collect()
    }

    /// How many cases have a class that begins so and an outcome.
    pub fn sum(&self, class: &str, outcome: &str) -> u64 {
        let of = |(key, _): &(&(String, String, String), &u64)| {
            key.0.starts_with(class) && key.2 == outcome
        };
        self.counts.iter().filter(of).map(|(_, count)| count).sum()
    }

    /// What should not have been.
    pub fn faults(&self) -> Vec<String> {
        let faulty = self.counts.keys().filter(|(_, _, outcome)| outcome.starts_with(FAULT));
        faulty.map(|(class, phase, outcome)| format!("{class}, {phase}: {outcome}")).collect()
    }

    /// The number of cases of a class, for tests that all are met.
    pub fn of_class(&self, class: &str) -> u64 {
        self.counts.iter().filter(|(key, _)| key.0 == class).map(|(_, count)| count).sum()
    }
}

#[test]
fn cases_are_counted_and_written() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("log.jsonl");
    let mut log = Log::begin(&file, 7);
    log.case("kills", "figures", KILLED);
    log.case("kills", "stage 1", KILLED);
    log.case("kills", "stage 1", "FAULT: torn");
    log.cases("inputs: mesh", "-", "read or refused", 40);
    assert_eq!((log.sum("kills", KILLED), log.of_class("kills")), (2, 3), "law: counted");
    assert_eq!(log.sum("inputs", "read or refused"), 40, "law: of every reader");
    assert_eq!(log.faults(), ["kills, stage 1: FAULT: torn"], "law: faults are found");
    let text = std::fs::read_to_string(&file).expect("a log");
    assert_eq!(text.lines().count(), 5, "law: a line each beside the first, got {text}");
    let page = super::page::Soaked::read(&text).expect("law: it can be read");
    assert_eq!((page.seed, page.counts), (7, log.counts()), "law: as it was written");
}
