//! `pluvia targets` finds which values of the factors of sweeps meet several targets together.

use super::*;
use crate::report::{Target, write_targets};
use crate::study::{TargetRuns, meet_targets};

/// Find which values of the factors of sweeps meet several targets together
#[derive(Debug, Args)]
#[command(after_help = "\
Reads finished sweeps and runs nothing. A target is a range for a column of their tables, or for the
ratio of two columns in percent. Runs of different sweeps form a point if they agree in all factors
that their sweeps share; the points that meet all targets are counted and listed. The command fits a
linear model of all factors to each target. From the scatter about the model follows the probability
that a run meets the target; from the correlations of residuals at the same point, the probability
that it meets several. The answer says whether a combination meets all targets, and which two
targets exclude each other. Runs of one pour are of one specimen: what varies on it is judged by
differences within specimens, all else by the means of specimens. Sweeps of the same name are
merged. Leaves targets.json and targets.md in DIR.

Examples:
  pluvia targets --runs shaken=out/shaken --target shaken:settlement_mm.final=14..19.61 \\
      --target shaken:settlement_mm.after_5_s/settlement_mm.final=75..85 --out out/targets
  pluvia targets --runs pile=out/piles --runs shaken=out/shaken-1 --runs shaken=out/shaken-2 \\
      --target pile:angle_of_repose.degrees=37..40 --target shaken:settlement_mm.final=14..19.61 \\
      --out out/targets-of-both")]
pub(super) struct TargetsArgs {
    /// A name for the runs of a sweep, and its folder or sweep.csv (repeatable)
    #[arg(long, value_name = "NAME=PATH", required = true)]
    runs: Vec<TargetRuns>,
    /// A result, or a ratio in percent, and its target range (repeatable)
    #[arg(long, value_name = "NAME:RESULT[/RESULT]=LOW..HIGH", required = true)]
    target: Vec<Target>,
    /// A factor that is chance alone, such as a placement or a seed: its effect counts as scatter
    /// (repeatable)
    #[arg(long, value_name = "FACTOR")]
    chance: Vec<String>,
    /// Folder for the results, created if needed
    #[arg(long, value_name = "DIR", default_value = "out/targets")]
    out: PathBuf,
}

pub(super) fn run(args: &TargetsArgs, context: &Context) -> Result<ExitStatus, CliError> {
    let found = meet_targets(&args.runs, &args.target, &args.chance)?;
    let runs = args.runs.iter().map(|of| {
        let path = std::path::absolute(&of.path).unwrap_or_else(|_| of.path.clone());
        format!("{}={}", of.name, path.display())
    });
    let question = json!({
        "target": args.target,
        "chance": args.chance,
        (AT_LEAST): { "runs": runs.collect::<Vec<_>>() },
    });
    let _at_work = asked::begin(&args.out, "targets", &question)?;
    context.stop_without_stages();
    write_targets(&args.out, &found).map_err(StudyError::from)?;
    let page = found.page().markdown();
    let text = format!("{page}\nfull results in {}\n", plain_path(&args.out.join("targets.md")));
    context.done(&text, &found)
}
