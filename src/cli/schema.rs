//! `pluvia schema`.

use clap::{Args, ValueEnum};

use super::{CliError, Context, ExitStatus};
use crate::scenario;
use crate::study::{ConvergenceDesign, SensitivityDesign};

/// Print the JSON Schema of the scenario file, or of a study's design
#[derive(Debug, Args)]
#[command(after_help = "\
Editors use it to check and complete scenarios: name it in their settings, or in a scenario's
own \"$schema\".

Examples:
  pluvia schema > scenario.schema.json
  pluvia schema --of convergence > convergence.schema.json")]
pub(super) struct SchemaArgs {
    /// Which file
    #[arg(long, value_enum, value_name = "FILE", default_value_t = Of::Scenario)]
    of: Of,
}

/// Files with a schema.
#[derive(Debug, Clone, Copy, ValueEnum)]
enum Of {
    /// A scenario
    Scenario,
    /// The design of `pluvia converge`
    Convergence,
    /// The design of `pluvia sensitivity`
    Sensitivity,
}

pub(super) fn run(args: &SchemaArgs, context: &Context) -> Result<ExitStatus, CliError> {
    let schema = match args.of {
        Of::Scenario => scenario::schema(),
        Of::Convergence => scenario::document_schema::<ConvergenceDesign>(),
        Of::Sensitivity => scenario::document_schema::<SensitivityDesign>(),
    };
    context.print(&format!("{schema:#}"), &schema)?;
    Ok(ExitStatus::Done)
}
