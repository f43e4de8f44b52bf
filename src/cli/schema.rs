//! `pluvia schema`.

use clap::Args;

use super::{CliError, Context, ExitStatus};
use crate::scenario;

/// Print the JSON Schema of the scenario file
#[derive(Debug, Args)]
#[command(after_help = "\
Editors use it to check and complete scenarios: name it in their settings, or in a scenario's
own \"$schema\".

Example:
  pluvia schema > scenario.schema.json")]
pub(super) struct SchemaArgs {}

pub(super) fn run(_: &SchemaArgs, context: &Context) -> Result<ExitStatus, CliError> {
    let schema = scenario::schema();
    context.print(&format!("{schema:#}"), &schema)?;
    Ok(ExitStatus::Done)
}
