//! `pluvia schema`

use super::{CliError, Ended, print_json};

/// Print the JSON Schema of the scenario file.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example:\n  pluvia schema > scenario.schema.json")]
pub struct Arguments {}

pub(super) fn run() -> Result<Ended, CliError> {
    print_json(&crate::scenario::schema());
    Ok(Ended::Well)
}
