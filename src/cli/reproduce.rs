//! `pluvia reproduce`

use std::path::PathBuf;

use serde_json::json;

use super::{
    BackendName, CliError, Context, Ended, cores, print, print_json, table, usable_folder,
};
use crate::study::{ReproduceOptions, reproduce};

/// Run the paper's whole experimental programme and hold it against the paper's claims.
///
/// What is finished in the output folder is not done again: a study that was
/// stopped or killed goes on where it was.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  pluvia reproduce --quick --out out/quick
  pluvia reproduce --configurations 3 --out out/reproduce")]
pub struct Arguments {
    /// Folder for report.html, claims.json, figures/ and runs/.
    #[arg(long, value_name = "DIR", default_value = "out/reproduce")]
    out: PathBuf,
    /// A few hundred grains and short vibrations: the same pipeline in a minute or two.
    #[arg(long)]
    quick: bool,
    /// Number of mixings of the same grains [default: 3, with --quick 1].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1000))]
    configurations: Option<u32>,
    /// Stages carried out at a time [default: one a core].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    jobs: Option<u16>,
    /// Engine that carries the grains.
    #[arg(long, value_enum, default_value = "bullet")]
    backend: BackendName,
    /// Exit with 1 when a claim of the paper is missed.
    #[arg(long)]
    strict: bool,
}

pub(super) fn run(arguments: &Arguments, context: &Context) -> Result<Ended, CliError> {
    usable_folder(&arguments.out)?;
    let configurations = arguments.configurations.unwrap_or(if arguments.quick { 1 } else { 3 });
    let outcome = reproduce(&ReproduceOptions {
        out: arguments.out.clone(),
        quick: arguments.quick,
        configurations,
        jobs: arguments.jobs.map_or_else(cores, usize::from),
        backend: arguments.backend.into(),
        cancel: context.cancel.clone(),
        progress: context.progress.clone(),
    })?;
    if context.json {
        print_json(&json!({
            "claims_within": outcome.claims_within,
            "claims_outside": outcome.claims_outside,
            "claims_not_stated": outcome.claims_not_stated,
            "report": outcome.report,
        }));
    } else {
        print(&table::runs(&outcome.runs));
        print(&format!(
            "claims of the paper: {} within, {} outside, {} without a number in the text\nreport in {}",
            outcome.claims_within,
            outcome.claims_outside,
            outcome.claims_not_stated,
            outcome.report.display()
        ));
    }
    let missed = arguments.strict && outcome.claims_outside > 0;
    Ok(if missed { Ended::Missed } else { Ended::Well })
}
