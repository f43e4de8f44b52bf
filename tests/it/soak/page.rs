//! From the log of a soak to the table of docs/robustness.md.
//!
//! `scripts/robustness.sh` has the log made into `docs/results/robustness.json`, and that into
//! the table.

use std::{collections::BTreeMap, fmt::Write, fs};

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::{
    super::program::{page as read, root},
    log::{Count, FAULT, SKIPPED},
};

const PAGE: &str = "docs/robustness.md";
const COUNTS: &str = "docs/results/robustness.json";
const BEGIN: &str = "<!-- SOAK: from docs/results/robustness.json -->\n";
const END: &str = "<!-- END -->";

/// What a soak has shown.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Soaked {
    pub program: String,
    pub profile: String,
    pub seed: u64,
    pub counts: Vec<Count>,
}

impl Soaked {
    /// From the lines of a log.
    pub fn read(log: &str) -> Result<Self, String> {
        let mut lines = log.lines();
        let parsed = |line: &str| -> Result<Value, String> {
            serde_json::from_str(line).map_err(|e| format!("`{line}`: {e}"))
        };
        let head = parsed(lines.next().unwrap_or_default())?;
        let text = |name: &str| head[name].as_str().unwrap_or_default().to_owned();
        let mut counts = BTreeMap::<_, u64>::new();
        for line in lines {
            let Count { class, phase, outcome, count } =
                serde_json::from_value(parsed(line)?).map_err(|e| format!("`{line}`: {e}"))?;
            *counts.entry((class, phase, outcome)).or_default() += count;
        }
        let counts = counts.into_iter().map(|((class, phase, outcome), count)| Count {
            class,
            phase,
            outcome,
            count,
        });
        Ok(Self {
            program: text("program"),
            profile: text("profile"),
            seed: head["seed"].as_u64().ok_or("the first line has no seed")?,
            counts: counts.collect(),
        })
    }

    /// How many cases of each class; the counts have outcomes and phases.
    pub fn table(&self) -> String {
        let mut rows = BTreeMap::<&str, u64>::new();
        for Count { class, outcome, count, .. } in &self.counts {
            if !outcome.starts_with(SKIPPED) {
                *rows.entry(class.as_str()).or_default() += count;
            }
        }
        let mut text = "| class | cases |\n| --- | ---: |\n".to_owned();
        for (class, cases) in rows {
            let _ = writeln!(text, "| {class} | {cases} |");
        }
        text
    }
}

fn write(path: &str, content: &str) {
    fs::write(root().join(path), content).expect("written");
}

/// The page with another table.
fn with_table(page: &str, table: &str) -> String {
    let (before, rest) = page.split_once(BEGIN).expect("law: the page has the mark");
    let (_, after) = rest.split_once(END).expect("law: and its end");
    format!("{before}{BEGIN}{table}{END}{after}")
}

/// `PLUVIA_SOAK_LOG=FILE` writes counts and page anew from a log.
#[test]
fn the_page_has_the_counts_of_the_logged_soak() {
    if let Ok(log) = std::env::var("PLUVIA_SOAK_LOG") {
        let log = fs::read_to_string(&log).unwrap_or_else(|e| panic!("{log} cannot be read: {e}"));
        let soaked = Soaked::read(&log).unwrap_or_else(|e| panic!("the log has a line {e}"));
        let counts = serde_json::to_string_pretty(&soaked).expect("JSON");
        write(COUNTS, &(counts + "\n"));
        write(PAGE, &with_table(&read(PAGE), &soaked.table()));
    }
    let soaked: Soaked = serde_json::from_str(&read(COUNTS)).expect("law: counts as JSON");
    let page = read(PAGE);
    assert_eq!(
        page,
        with_table(&page, &soaked.table()),
        "law: the table of {PAGE} is that of {COUNTS}; scripts/robustness.sh writes both"
    );
    let faults = soaked.counts.iter().filter(|c| c.outcome.starts_with(FAULT)).count();
    assert_eq!(faults, 0, "law: a soak that found a fault is no result to show");
    let told = soaked.counts.iter().any(|c| !c.outcome.starts_with(SKIPPED));
    assert!(told, "law: something was tried");
}

#[test]
fn phases_of_a_class_are_summed() {
    let count = |class: &str, phase: &str, count| Count {
        class: class.into(),
        phase: phase.into(),
        outcome: "same".into(),
        count,
    };
    let counts = vec![
        count("kills", "run, figures", 2),
        count("kills", "run, stage 1", 3),
        count("kills", "run, stage 2", 4),
    ];
    let (program, profile) = ("p".to_owned(), "release".to_owned());
    let soaked = Soaked { program, profile, seed: 1, counts };
    let table = soaked.table();
    assert!(table.ends_with("| kills | 9 |\n"), "law: got {table}");
    let page = format!("a\n{BEGIN}old\n{END}\nb");
    assert_eq!(with_table(&page, "new\n"), format!("a\n{BEGIN}new\n{END}\nb"));
    assert!(Soaked::read("{\"seed\": 1}\n{\"class\": 3}").is_err(), "law: no line is passed over");
}
