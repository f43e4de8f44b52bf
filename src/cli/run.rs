//! `pluvia run`

use std::path::PathBuf;

use super::{
    BackendName, CliError, Context, Ended, cores, print, print_json, table, usable_folder,
};
use crate::scenario::{Override, load};
use crate::study::{RunOptions, run_scenario};

/// Carry out one scenario.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  pluvia run scenarios/quick/pluviation.json --out out/first
  pluvia run scenarios/quick/pluviation.json --set stages.1.falling_height_mm=200 --out out/high")]
pub struct Arguments {
    /// The scenario file.
    scenario: PathBuf,
    /// Folder for results; what is finished there is not done again.
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Engine that carries the grains, in place of the scenario's.
    #[arg(long, value_enum)]
    backend: Option<BackendName>,
    /// Seed of the random streams, in place of the scenario's.
    #[arg(long)]
    seed: Option<u64>,
    /// Change a value of the scenario; may be given several times.
    #[arg(long = "set", value_name = "PATH=VALUE")]
    set: Vec<Override>,
}

pub(super) fn run(arguments: &Arguments, context: &Context) -> Result<Ended, CliError> {
    let mut scenario = load(&arguments.scenario, &arguments.set)?.scenario;
    scenario.seed = arguments.seed.unwrap_or(scenario.seed);
    if let Some(backend) = arguments.backend {
        scenario.engine.backend = backend.into();
    }
    usable_folder(&arguments.out)?;
    let record = run_scenario(
        &scenario,
        &RunOptions {
            out: arguments.out.clone(),
            jobs: cores(),
            cancel: context.cancel.clone(),
            progress: context.progress.clone(),
        },
    )?;
    if context.json {
        print_json(&record.summary);
    } else {
        print(&table::summary(&record.summary));
        print(&format!("results in {}", arguments.out.display()));
    }
    Ok(Ended::Well)
}
