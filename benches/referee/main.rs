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
mod options;
mod packing;
mod pours;
mod program;
mod steps;
mod table;
mod tap;
#[path = "../programs/tree.rs"]
mod tree;

use std::{path::Path, process::ExitCode};

use clap::{Parser, ValueEnum};
use pluvia::record::{create_folder, write_json};
use serde_json::{Map, Value, json};

use options::{Options, Part};
use pours::Engine;

/// Entries of the parts, by their names.
type Results = Map<String, Value>;

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
    let instants = usize::from(options.instants.unwrap_or(if options.quick { 1 } else { 10 }));
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
