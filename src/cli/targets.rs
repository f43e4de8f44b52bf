//! `pluvia targets`.

use super::*;
use crate::report::{Target, write_targets};
use crate::study::{TargetRuns, meet_targets};

/// Find which values of the factors of sweeps meet several targets together
#[derive(Debug, Args)]
#[command(after_help = "\
Reads finished sweeps, runs nothing. A target is a column of their tables, or the share of one in
another in percent, and the range in which it is wanted. To each a linear model of all factors is
fitted; its scatter gives the probability that a run meets the target, and the product that of
several. Says whether a combination meets them all, and which two targets exclude each other.
Sweeps of the same name are put together. Leaves targets.json and targets.md in DIR.

Examples:
  pluvia targets --runs shaken=out/shaken --target shaken:settlement_mm.final=14..19.61 \\
      --target shaken:settlement_mm.after_5_s/settlement_mm.final=75..85 --out out/targets
  pluvia targets --runs pile=out/piles --runs shaken=out/shaken-1 --runs shaken=out/shaken-2 \\
      --target pile:angle_of_repose.degrees=37..40 --target shaken:settlement_mm.final=14..19.61")]
pub(super) struct TargetsArgs {
    /// A name for the runs of a sweep, and its folder or sweep.csv (repeatable)
    #[arg(long, value_name = "NAME=PATH", required = true)]
    runs: Vec<TargetRuns>,
    /// A result, or a share in percent, and where it is wanted (repeatable)
    #[arg(long, value_name = "NAME:RESULT[/RESULT]=LOW..HIGH", required = true)]
    target: Vec<Target>,
    /// A factor that stands for chance alone, as a placement or a seed: what it moves is scatter
    /// (repeatable)
    #[arg(long, value_name = "FACTOR")]
    chance: Vec<String>,
    /// Folder for the results; it is made if needed
    #[arg(long, value_name = "DIR", default_value = "out/targets")]
    out: PathBuf,
}

pub(super) fn run(args: &TargetsArgs, context: &Context) -> Result<ExitStatus, CliError> {
    let found = meet_targets(&args.runs, &args.target, &args.chance)?;
    output_folder::prepare(&args.out)?;
    write_targets(&args.out, &found).map_err(StudyError::from)?;
    let text =
        format!("{}\nall of it in {}\n", found.page(), plain_path(&args.out.join("targets.md")));
    context.done(&text, &found)
}
