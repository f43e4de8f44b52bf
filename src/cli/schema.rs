//! `pluvia schema` prints the JSON Schema of scenarios or designs, or the page of their fields.

use super::*;
use crate::scenario;
use crate::study::{ConvergenceDesign, SensitivityDesign};

/// Print the JSON Schema of the scenario file, or of a study's design
#[derive(Debug, Args)]
#[command(after_help = "\
With the schema, editors check a file and complete its fields. Name it in the editor's settings, or
in the file itself as \"$schema\".

Examples:
  pluvia schema > scenario.schema.json
  pluvia schema --of convergence > convergence.schema.json
  pluvia schema --page > scenario.md")]
pub(super) struct SchemaArgs {
    /// The file that the schema describes
    #[arg(long, value_enum, value_name = "FILE", default_value_t = Of::Scenario)]
    of: Of,
    /// Print a page of Markdown instead: every field with its limits and default
    #[arg(long)]
    page: bool,
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
    if args.page && context.json {
        let text = "--page prints Markdown, and --json the schema; give one of them";
        return Err(CliError::Usage(text.to_owned()));
    }
    let (schema, title, introduction) = match args.of {
        Of::Scenario => (
            scenario::schema(),
            "Every field of a scenario",
            "Written by `pluvia schema --page`, from the same source by which scenarios are \
             checked.\n[The scenario file](scenario-files.md) shows one with nearly every \
             field in its place; units are in the names. A file must\nhave `name`, `grains` \
             and `stages`, its own or those of the file that it extends; all else has a \
             default. What is\nautomatic follows from the grains ([any grain size](scale.md)); \
             its value for the paper's gravel is in brackets. Any\nfield can be changed for \
             one run by its path: `--set engine.rate_hz=960`.",
        ),
        Of::Convergence => (
            scenario::document_schema::<ConvergenceDesign>(),
            "Every field of a convergence design",
            "Written by `pluvia schema --of convergence --page`. docs/studies.md explains it.",
        ),
        Of::Sensitivity => (
            scenario::document_schema::<SensitivityDesign>(),
            "Every field of a sensitivity design",
            "Written by `pluvia schema --of sensitivity --page`. docs/studies.md explains it.",
        ),
    };
    let text = match args.page {
        true => page(title, introduction, &schema).trim_end().to_owned(),
        false => format!("{schema:#}"),
    };
    context.done_asked(&text, &schema)
}
