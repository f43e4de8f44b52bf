//! What `make referee` is asked.

use std::path::PathBuf;

use clap::{Parser, ValueEnum};

/// Compare the native contact solver with an exact solution.
#[derive(Debug, Parser)]
#[command(name = "make referee ARGS=...")]
pub struct Options {
    /// A few instants, pours and specimens of each kind: some minutes
    #[arg(long)]
    pub quick: bool,
    /// Only these parts, with commas between; results of the others stay in the file
    #[arg(long, value_enum, value_delimiter = ',', default_values_t = Part::value_variants())]
    pub only: Vec<Part>,
    /// Instants of each scene [default: 10, quick 1]
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..))]
    pub instants: Option<u16>,
    /// Solver tolerances of the native solver, one after the other, beside its default
    #[arg(long, value_delimiter = ',')]
    pub tolerances: Vec<f64>,
    /// Also solve each instant from nothing, to see whether velocities are unique
    #[arg(long)]
    pub twice: bool,
    /// Keep the contact problems that are solved, some megabytes each
    #[arg(long)]
    pub keep: bool,
    /// Realisations of each kind of pour [default: 400, quick 2]
    #[arg(long, value_parser = clap::value_parser!(u64).range(2..))]
    pub pours: Option<u64>,
    /// Only specimens with these names: quick (364 grains), paper (1456)
    /// [default: both, with --quick only quick]
    #[arg(long, value_delimiter = ',', value_parser = SPECIMENS)]
    pub specimens: Vec<String>,
    /// Instants or pours that are computed at a time [default: processors]
    #[arg(long)]
    pub jobs: Option<usize>,
    /// Only pours with this coefficient of restitution
    #[arg(long)]
    pub restitution: Option<f64>,
    /// Only pours with this friction coefficient
    #[arg(long)]
    pub friction: Option<f64>,
    /// File for the results; what a later run goes on with lies in a folder of its name
    #[arg(long, default_value = "out/referee.json")]
    pub out: PathBuf,
}

/// Names of the specimens that are looked at: of `SCENARIOS` in `steps` and `certificate`.
const SPECIMENS: [&str; 2] = ["quick", "paper"];

/// What is compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Part {
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

impl Options {
    /// How many instants or pours are computed at a time.
    pub fn jobs(&self) -> usize {
        let processors = || std::thread::available_parallelism().map_or(1, usize::from);
        self.jobs.unwrap_or_else(processors).max(1)
    }

    /// Whether a specimen is looked at.
    pub fn takes(&self, specimen: &str) -> bool {
        if self.specimens.is_empty() {
            return !self.quick || specimen == "quick";
        }
        self.specimens.iter().any(|s| s == specimen)
    }
}
