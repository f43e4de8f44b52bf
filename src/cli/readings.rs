//! `pluvia readings`.

use std::path::PathBuf;

use clap::Args;

use super::{
    CliError, Context, ExitStatus, changes::Changes, jobs::Jobs, last_line, output_folder, table,
};
use crate::plain::plain_path;
use crate::record::read_json;
use crate::study::{Reading, ReadingsOptions, readings};

/// Run the paper's programme under several readings of it, side by side
#[derive(Debug, Args)]
#[command(after_help = "\
A reading is what the paper's authors may have meant or typed: scenarios/readings/ holds them.
Leaves readings.json, readings.md, readings.html, figures/ and runs/ in DIR. What is already done
there is not done again, and readings carried out there by earlier commands stay in the table. A
run that fails is said in the table; the others go on. `bullet_stock` takes hours.

Examples:
  pluvia readings --quick --out out/quick-readings
  pluvia readings --only converged,per_body,full_stroke --configurations 1 --out out/readings
  pluvia readings --only blender_2014_cm --configurations 1 --out out/readings")]
pub(super) struct ReadingsArgs {
    /// A few hundred grains instead of 1456, and shorter vibration
    #[arg(long)]
    quick: bool,
    /// Number of initial configurations [default: 3, with --quick 1]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1000))]
    configurations: Option<u32>,
    /// Only these readings [default: all]
    #[arg(long, value_name = "NAME,NAME", value_delimiter = ',', value_parser = reading)]
    only: Vec<Reading>,
    #[command(flatten)]
    jobs: Jobs,
    #[command(flatten)]
    changes: Changes,
    /// Folder for the results; it is made if needed
    #[arg(long, value_name = "DIR", default_value = "out/readings")]
    out: PathBuf,
}

/// The reading of a name.
pub(super) fn reading(name: &str) -> Result<Reading, String> {
    Reading::named(name).map_err(|error| error.to_string())
}

pub(super) fn run(args: &ReadingsArgs, context: &Context) -> Result<ExitStatus, CliError> {
    let readings_asked = if args.only.is_empty() { Reading::all()? } else { args.only.clone() };
    output_folder::prepare(&args.out)?;
    context.stop_on_ctrl_c();
    let outcome = readings(&ReadingsOptions {
        out: args.out.clone(),
        quick: args.quick,
        configurations: args.configurations.unwrap_or(if args.quick { 1 } else { 3 }),
        readings: readings_asked,
        jobs: args.jobs.cores(),
        changes: args.changes.overrides(),
        cancel: context.cancel.clone(),
        progress: context.progress.clone(),
    })?;
    let mut text = table::of_readings(&outcome.columns);
    text += &format!("report in {}\n", plain_path(&outcome.report));
    let runs = outcome.columns.iter().flat_map(|c| &c.runs);
    text += &last_line::of_runs(runs.map(|r| (r.name.as_str(), &r.summary)));
    let value: serde_json::Value = read_json(&args.out.join("readings.json"))?;
    context.print(&text, &value)?;
    Ok(ExitStatus::Done)
}
