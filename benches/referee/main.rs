//! The referee: what the native solver finds, beside an exact solution of the same
//! contact problem.
//!
//! `make referee` runs it; `docs/referee.md` says what it solves and how. The
//! solutions come from a program of its own (`main.cpp` and its like in this
//! folder), which knows problems and scenes in files and nothing of Pluvia.

mod certificate;
mod heap;
mod pours;
mod program;
mod steps;
mod table;

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
    /// Only these parts, with commas between; the others stay as they were
    #[arg(long, value_enum, value_delimiter = ',', default_values_t = Part::ALL)]
    only: Vec<Part>,
    /// Instants of each scene [default: 6, quick 2]
    #[arg(long)]
    instants: Option<usize>,
    /// Iterations a sub-step of the native solver, one after the other, beside its
    /// default
    #[arg(long, value_delimiter = ',')]
    iterations: Vec<u32>,
    /// Keep the contact problems, some megabytes each
    #[arg(long)]
    keep: bool,
    /// Realisations of each kind of pour [default: 400, quick 6]
    #[arg(long)]
    pours: Option<u64>,
    /// Only pours with this coefficient of restitution
    #[arg(long)]
    restitution: Option<f64>,
    /// Only pours with this friction coefficient
    #[arg(long)]
    friction: Option<f64>,
    /// File for the results
    #[arg(long, default_value = "out/referee.json")]
    out: PathBuf,
    /// Cargo says so to every benchmark
    #[arg(long, hide = true)]
    bench: bool,
}

/// What is compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Part {
    /// One sub-step at random instants
    OneStep,
    /// Small pours
    Pours,
    /// The least friction with which specimens stand
    Static,
}

impl Part {
    const ALL: [Self; 3] = [Self::OneStep, Self::Static, Self::Pours];
}

impl std::fmt::Display for Part {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::OneStep => "one-step",
            Self::Pours => "pours",
            Self::Static => "static",
        })
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
    let folder = options.out.with_extension("");
    create_folder(&folder).map_err(|e| e.to_string())?;
    let mut results = earlier(&options.out);
    let mut lines = Vec::new();
    for part in Part::ALL.into_iter().filter(|p| options.only.contains(p)) {
        let (field, value) = match part {
            Part::OneStep => ("one_step", one_step(options, &folder, &mut lines)?),
            Part::Pours => ("pours", pours(options, &folder, &mut lines)?),
            Part::Static => ("static", certificates(options, &mut lines)?),
        };
        results.insert(field.to_owned(), value);
        // After each part: the next may take hours.
        write_json(&options.out, &results).map_err(|e| e.to_string())?;
    }
    for line in lines {
        println!("{line}");
    }
    println!("results in {}", options.out.display());
    Ok(())
}

/// Parts of an earlier run.
fn earlier(path: &Path) -> Map<String, Value> {
    let text = std::fs::read_to_string(path).unwrap_or_default();
    serde_json::from_str(&text).unwrap_or_default()
}

fn one_step(options: &Options, folder: &Path, lines: &mut Vec<String>) -> Result<Value, String> {
    let instants = options.instants.unwrap_or(if options.quick { 2 } else { 6 });
    let mut found = Vec::new();
    for (name, scenario) in steps::SCENARIOS {
        if options.quick && name == "paper" {
            continue;
        }
        for iterations in std::iter::once(None).chain(options.iterations.iter().copied().map(Some))
        {
            let how = steps::Looking { folder, instants, iterations, keep: options.keep };
            found.extend(steps::look(&how, name, scenario)?);
        }
    }
    lines.extend(found.iter().map(table::nearness));
    Ok(json!(found))
}

fn pours(options: &Options, folder: &Path, lines: &mut Vec<String>) -> Result<Value, String> {
    let count = options.pours.unwrap_or(if options.quick { 6 } else { 400 });
    let wanted = |given: Option<f64>, value: f64| given.is_none_or(|g| g == value);
    let cells: Vec<(f64, f64)> = pours::RESTITUTIONS
        .into_iter()
        .filter(|e| wanted(options.restitution, *e))
        .flat_map(|e| pours::FRICTIONS.into_iter().map(move |mu| (e, mu)))
        .filter(|(_, mu)| wanted(options.friction, *mu))
        .collect();
    let found = pours::compare(folder, count, &cells)?;
    lines.extend(found.iter().map(table::cell));
    Ok(json!(found))
}

fn certificates(options: &Options, lines: &mut Vec<String>) -> Result<Value, String> {
    let mut found = Vec::new();
    for (name, scenario) in
        [("quick", "scenarios/quick/pluviation.json"), ("paper", "scenarios/paper/pluviation.json")]
    {
        if options.quick && name == "paper" {
            continue;
        }
        let engines = [Engine::Native, Engine::Rapier, Engine::Stock];
        found.extend(certificate::certify(name, scenario, &engines)?);
    }
    lines.extend(found.iter().map(table::certificate));
    Ok(json!(found))
}
