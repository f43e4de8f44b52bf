//! `pluvia reproduce` runs the paper's programme and compares its statements with the results.

use super::*;
use crate::paper::{Claim, ReproduceOptions, reproduce};

/// Run the whole paper and compare its claims
#[derive(Debug, Args)]
#[command(after_help = "\
Leaves report.html, scorecard.json, claims.json, figures/ and runs/ in DIR. Finished runs are
reused: after Ctrl-C or a crash, rerun the same command to resume. The report also shows results of
the same programme in DIR from other engines and settings.

Examples:
  pluvia reproduce --quick --out out/quick
  pluvia reproduce --configurations 3 --jobs 4 --strict --out out/reproduce
  pluvia reproduce --backend rapier --out out/reproduce
  pluvia reproduce --set engine.contact_solver=stock --out out/reproduce
  pluvia reproduce --interpretation full_stroke --out out/reproduce
  pluvia reproduce --placements 10 --out out/reproduce")]
pub(super) struct ReproduceArgs {
    /// A few hundred grains instead of 1456, and shorter vibration
    #[arg(long)]
    quick: bool,
    /// Number of realisations, each a new random arrangement of the same grains
    /// [default: 3, with --quick 1]
    #[arg(long, value_name = "N", value_parser = whole(1_u32, 1000), allow_negative_numbers = true)]
    configurations: Option<u32>,
    /// How often the plate is laid on each specimen; with more than 1, that many random offsets
    /// and rotations are shaken, which separates the scatter of placements from that of specimens
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = whole(1_u32, 1000),
          allow_negative_numbers = true)]
    placements: u32,
    #[command(flatten)]
    jobs: Jobs,
    /// An interpretation of the paper, in place of the default `converged` (pluvia interpretations --help)
    #[arg(long, value_name = "NAME", value_parser = super::interpretations::interpretation)]
    interpretation: Option<Interpretation>,
    #[command(flatten)]
    changes: Changes,
    /// End with exit code 1 when a claim of the paper is missed
    #[arg(long)]
    strict: bool,
    /// Folder for the results, created if needed
    #[arg(long, value_name = "DIR", default_value = "out/reproduce")]
    out: PathBuf,
}

pub(super) fn run(args: &ReproduceArgs, context: &Context) -> Result<ExitStatus, CliError> {
    let study = reproduce(ReproduceOptions {
        quick: args.quick,
        configurations: args.configurations.unwrap_or(if args.quick { 1 } else { 3 }),
        placements: args.placements,
        changes: args.changes.overrides()?,
        interpretation: args.interpretation.clone(),
    })?;
    let run = RunOptions { frames: true, ..context.run_options(&args.out, args.jobs) };
    carry_out(study, &run, context, |outcome| {
        let mut text = scorecard::of(&outcome.scorecard);
        let [claims, report] =
            ["claims.json", "report.html"].map(|name| plain_path(&args.out.join(name)));
        text += &format!("every statement in {claims}, report in {report}\n");
        text += &last_line::of_runs(outcome.runs.iter().map(|r| (r.name.as_str(), &r.summary)));
        context.print(&text, &outcome.claims)?;
        Ok(ExitStatus::by(!args.strict || !outcome.claims.iter().any(Claim::is_missed)))
    })
}
