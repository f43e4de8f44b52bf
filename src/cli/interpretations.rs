//! `pluvia interpretations` runs the paper's programme under several interpretations, side by side.

use super::*;
use crate::paper::{InterpretationsOptions, interpretations};

/// Run the paper's programme under several interpretations of it, side by side
#[derive(Debug, Args)]
#[command(after_help = "\
An interpretation is what the paper's authors may have meant or typed; scenarios/interpretations/
holds them. Leaves interpretations.json, interpretations.md, interpretations.html, figures/ and
runs/ in DIR. Finished stages there are reused, and interpretations run there by earlier commands
stay in the table. A run that fails is marked in the table; the others continue. `bullet_stock`
takes hours.

Examples:
  pluvia interpretations --quick --out out/quick-interpretations
  pluvia interpretations --only converged,per_body,full_stroke --configurations 1 \\
      --out out/interpretations
  pluvia interpretations --only blender_2014_cm --configurations 1 --out out/interpretations")]
pub(super) struct InterpretationsArgs {
    /// A few hundred grains instead of 1456, and shorter vibration
    #[arg(long)]
    quick: bool,
    /// Number of realisations [default: 3, with --quick 1]
    #[arg(long, value_name = "N", value_parser = whole(1_u32, 1000), allow_negative_numbers = true)]
    configurations: Option<u32>,
    /// Only these interpretations [default: all]
    #[arg(long, value_name = "NAME,NAME", value_delimiter = ',', value_parser = interpretation)]
    only: Vec<Interpretation>,
    #[command(flatten)]
    jobs: Jobs,
    #[command(flatten)]
    changes: Changes,
    /// Folder for the results, created if needed
    #[arg(long, value_name = "DIR", default_value = "out/interpretations")]
    out: PathBuf,
}

pub(super) fn interpretation(name: &str) -> Result<Interpretation, String> {
    Interpretation::named(name).map_err(|error| error.to_string())
}

pub(super) fn run(args: &InterpretationsArgs, context: &Context) -> Result<ExitStatus, CliError> {
    let all = args.only.is_empty();
    let twice = |(n, of): &(usize, &Interpretation)| args.only[..*n].contains(of);
    if let Some((_, twice)) = args.only.iter().enumerate().find(twice) {
        let name = twice.name;
        return Err(CliError::Usage(format!("--only names {name} twice; name each once")));
    }
    let study = interpretations(InterpretationsOptions {
        quick: args.quick,
        configurations: args.configurations.unwrap_or(if args.quick { 1 } else { 3 }),
        interpretations: if all { Interpretation::all()? } else { args.only.clone() },
        changes: args.changes.overrides()?,
    })?;
    let run = context.run_options(&args.out, args.jobs);
    carry_out(study, &run, context, |outcome| {
        let mut text = table::of_interpretations(&outcome.columns);
        text += &format!("report in {}\n", plain_path(&outcome.report));
        let runs = outcome.columns.iter().flat_map(|c| &c.runs);
        text += &last_line::of_runs(runs.map(|r| (r.name.as_str(), &r.summary)));
        let value: Value = read_json(&args.out.join("interpretations.json"))?;
        context.done(&text, &value)
    })
}
