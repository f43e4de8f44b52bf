//! `pluvia run`.

use std::path::PathBuf;

use clap::Args;
use serde_json::Value;

use super::{CliError, Context, ExitStatus, output_folder, table};
use crate::scenario::{Backend, Override, load};
use crate::study::{RunOptions, run_scenario};

/// Carry out one scenario
#[derive(Debug, Args)]
#[command(after_help = "\
Leaves manifest.json, summary.json, series.csv, grains.csv, grains.json, specimen.json and figures
in DIR. Interrupted, the same command goes on where it stopped.

Examples:
  pluvia run scenarios/quick/pluviation.json --out out/first
  pluvia run scenarios/paper/pluviation.json --set stages.1.falling_height_mm=200 \\
      --set engine.rate_hz=960 --out out/from-20-cm")]
pub(super) struct RunArgs {
    /// The scenario file
    #[arg(value_name = "SCENARIO.json")]
    scenario: PathBuf,
    /// Physics engine, in place of the scenario's
    #[arg(long, value_name = "B", value_parser = backend)]
    backend: Option<Backend>,
    /// Seed of the random streams, in place of the scenario's
    #[arg(long, value_name = "N")]
    seed: Option<u64>,
    /// Change one value of the scenario (repeatable)
    #[arg(long, value_name = "path=value")]
    set: Vec<Override>,
    /// Folder for the results; it is made if needed
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
}

/// The engine of a name, as in scenario files.
pub(super) fn backend(name: &str) -> Result<Backend, String> {
    serde_json::from_value(Value::from(name)).map_err(|error| error.to_string())
}

impl RunArgs {
    /// What the options change in the scenario; `--set` has the last word.
    fn overrides(&self) -> Vec<Override> {
        let backend = self.backend.and_then(|b| serde_json::to_value(b).ok());
        let backend = backend.map(|b| Override::new(&["engine", "backend"], b));
        let seed = self.seed.map(|n| Override::new(&["seed"], n.into()));
        backend.into_iter().chain(seed).chain(self.set.iter().cloned()).collect()
    }
}

pub(super) fn run(args: &RunArgs, context: &Context) -> Result<ExitStatus, CliError> {
    let loaded = load(&args.scenario, &args.overrides())?;
    tracing::info!(files = ?loaded.files, "the scenario `{}` is sound", loaded.scenario.name);
    output_folder::prepare(&args.out)?;
    context.stop_on_ctrl_c();
    let options = RunOptions {
        out: args.out.clone(),
        // The stages of one run follow each other.
        jobs: 1,
        cancel: context.cancel.clone(),
        progress: context.progress.clone(),
    };
    let record = run_scenario(&loaded.scenario, &options)?;
    let mut text = table::of_summary(&record.summary);
    text += &format!("results in {}\n", args.out.display());
    context.print(&text, &record.summary)?;
    Ok(ExitStatus::Done)
}
