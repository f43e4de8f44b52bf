//! The referee: what the native solver finds, beside an exact solution of the same
//! contact problem.
//!
//! `make referee` runs it; `docs/referee.md` says what it solves and how. The
//! solutions come from a program of its own (`main.cpp` and its like in this
//! folder), which knows problems and scenes in files and nothing of Pluvia.

#[path = "../programs/beside.rs"]
mod beside;
mod cells;
mod certificate;
mod crew;
mod fields;
mod kept;
mod nearness;
mod packing;
mod pours;
mod program;
mod steps;
mod table;
mod tap;
#[path = "../programs/tree.rs"]
mod tree;

use std::{
    path::{Path, PathBuf},
    process::ExitCode,
};

use clap::{Parser, ValueEnum};
use pluvia::record::{create_folder, write_json};
use serde_json::{Map, Value, json};

use pours::Engine;

/// Compare the native contact solver with an exact solution.
#[derive(Debug, Parser)]
#[command(name = "make referee ARGS=...")]
struct Options {
    /// A few instants, pours and specimens of each kind: some minutes
    #[arg(long)]
    quick: bool,
    /// Only these parts, with commas between; results of the others stay in the file
    #[arg(long, value_enum, value_delimiter = ',', default_values_t = Part::value_variants())]
    only: Vec<Part>,
    /// Instants of each scene [default: 10, quick 1]
    #[arg(long)]
    instants: Option<usize>,
    /// Solver tolerances of the native solver, one after the other, beside its default
    #[arg(long, value_delimiter = ',')]
    tolerances: Vec<f64>,
    /// Also solve each instant from nothing, to see whether velocities are unique
    #[arg(long)]
    twice: bool,
    /// Keep the contact problems that are solved, some megabytes each
    #[arg(long)]
    keep: bool,
    /// Realisations of each kind of pour [default: 400, quick 2]
    #[arg(long, value_parser = clap::value_parser!(u64).range(2..))]
    pours: Option<u64>,
    /// Only specimens with these names: quick (364 grains), paper (1456)
    /// [default: both, with --quick only quick]
    #[arg(long, value_delimiter = ',', value_parser = SPECIMENS)]
    specimens: Vec<String>,
    /// Instants or pours that are computed at a time [default: processors]
    #[arg(long)]
    jobs: Option<usize>,
    /// Only pours with this coefficient of restitution
    #[arg(long)]
    restitution: Option<f64>,
    /// Only pours with this friction coefficient
    #[arg(long)]
    friction: Option<f64>,
    /// File for the results; what a later run goes on with lies in a folder of its name
    #[arg(long, default_value = "out/referee.json")]
    out: PathBuf,
}

/// Names of the specimens that are looked at: of `SCENARIOS` in `steps` and `certificate`.
const SPECIMENS: [&str; 2] = ["quick", "paper"];

/// Entries of the parts, by their names.
type Results = Map<String, Value>;

/// What is compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Part {
    /// One sub-step at random instants
    OneStep,
    /// The least friction with which specimens stand
    Static,
    /// Small pours
    Pours,
}

impl std::fmt::Display for Part {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.to_possible_value().expect("none is skipped").get_name())
    }
}

fn main() -> ExitCode {
    match compare(&Options::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn compare(options: &Options) -> Result<(), String> {
    let folder = beside::folder_of(&options.out)?;
    create_folder(&folder).map_err(|e| e.to_string())?;
    kept::own_identity()?;
    let mut results = earlier(&options.out)?;
    options.check_others(&results)?;
    let mut tables = String::new();
    for part in Part::value_variants().iter().filter(|part| options.only.contains(part)) {
        tables += &match part {
            Part::OneStep => one_step(options, &folder, &mut results)?,
            Part::Pours => pours(options, &folder, &mut results)?,
            Part::Static => certificates(options, &folder, &mut results)?,
        };
    }
    println!("{tables}\nresults in {}", options.out.display());
    Ok(())
}

impl Options {
    fn jobs(&self) -> usize {
        let processors = || std::thread::available_parallelism().map_or(1, usize::from);
        self.jobs.unwrap_or_else(processors).max(1)
    }

    /// Whether a specimen is looked at.
    fn takes(&self, specimen: &str) -> bool {
        if self.specimens.is_empty() {
            return !self.quick || specimen == "quick";
        }
        self.specimens.iter().any(|s| s == specimen)
    }

    /// Puts a part's results beside those that are there, whether or not the part is
    /// finished: the rest may take hours.
    fn write(&self, results: &mut Results, field: &str, value: Value) -> Result<(), String> {
        results.insert(field.to_owned(), value);
        self.check_fields(results)?;
        write_json(&self.out, results).map_err(|e| e.to_string())
    }

    /// Whether the parts that stay can be written again, before hours are spent on the others:
    /// another version may have written them with other fields.
    fn check_others(&self, results: &Results) -> Result<(), String> {
        let mut others = results.clone();
        for part in &self.only {
            others.insert(part.to_string().replace('-', "_"), json!([]));
        }
        let hint = "compute these parts, too, or move the file away";
        self.check_fields(&others).map_err(|faults| format!("{faults}; {hint}"))
    }

    fn check_fields(&self, results: &Results) -> Result<(), String> {
        let faults = fields::faults(&json!(results));
        if faults.is_empty() {
            return Ok(());
        }
        Err(format!("{}: {}", self.out.display(), faults.join("; ")))
    }
}

/// Parts of an earlier run.
fn earlier(path: &Path) -> Result<Results, String> {
    match std::fs::read_to_string(path) {
        Ok(text) => serde_json::from_str(&text).map_err(|e| format!("{}: {e}", path.display())),
        Err(e) if e.kind() == std::io::ErrorKind::NotFound => {
            let none = |field: &str| (field.to_owned(), json!([]));
            Ok(fields::PARTS.iter().map(|p| none(p.name)).collect())
        }
        Err(e) => Err(format!("{}: {e}", path.display())),
    }
}

fn one_step(options: &Options, folder: &Path, results: &mut Results) -> Result<String, String> {
    let instants = options.instants.unwrap_or(if options.quick { 1 } else { 10 });
    let mut found = Vec::new();
    for (name, scenario) in steps::SCENARIOS.into_iter().filter(|(name, _)| options.takes(name)) {
        let others = options.tolerances.iter().copied().map(Some);
        for tolerance in std::iter::once(None).chain(others) {
            let Options { twice, keep, .. } = *options;
            let jobs = options.jobs();
            let how = steps::Looking { folder, instants, tolerance, twice, keep, jobs };
            found.extend(steps::look(&how, name, scenario)?);
            options.write(results, "one_step", json!(found))?;
        }
    }
    Ok(table::one_step(&found))
}

fn pours(options: &Options, folder: &Path, results: &mut Results) -> Result<String, String> {
    let count = options.pours.unwrap_or(if options.quick { 2 } else { 400 });
    let wanted = |given: Option<f64>, value: f64| given.is_none_or(|g| g == value);
    let kinds: Vec<(f64, f64)> = pours::RESTITUTIONS
        .into_iter()
        .filter(|e| wanted(options.restitution, *e))
        .flat_map(|e| pours::FRICTIONS.into_iter().map(move |mu| (e, mu)))
        .filter(|(_, mu)| wanted(options.friction, *mu))
        .collect();
    if kinds.is_empty() {
        return Err(format!(
            "--restitution is one of {:?}, --friction one of {:?}",
            pours::RESTITUTIONS,
            pours::FRICTIONS
        ));
    }
    let found = pours::compare(folder, count, options.jobs(), &kinds, |cells| {
        options.write(results, "pours", json!(cells))
    })?;
    Ok(table::pours(&found))
}

fn certificates(options: &Options, folder: &Path, results: &mut Results) -> Result<String, String> {
    let engines = [Engine::Native, Engine::Rapier, Engine::Stock];
    let mut found = Vec::new();
    let taken = |(name, _): &(&str, &str)| options.takes(name);
    for (name, scenario) in certificate::SCENARIOS.into_iter().filter(taken) {
        found.extend(certificate::certify(folder, name, scenario, &engines)?);
        options.write(results, "static", json!(found))?;
    }
    Ok(table::certificates(&found))
}
