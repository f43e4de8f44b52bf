//! `pluvia stage` runs one stage of a planned sweep and stores it: the work of a job on a cluster.

use clap::builder::NonEmptyStringValueParser;

use super::*;

/// Run one stage of a planned sweep and store it
#[derive(Debug, Args)]
#[command(after_help = "\
For engines that spread a sweep over many machines: `pluvia sweep --plan-only` makes the plan, this
command runs one of its stages in the folder that all machines share, and `pluvia sweep --collect`
collects the results. A stage needs only stages of earlier levels. A stored stage is skipped; a
stage whose predecessor is not stored is refused with exit code 2.

Examples:
  pluvia stage out/sweep --list
  pluvia stage out/sweep --level 0 --task 3
  pluvia stage out/sweep --key 5f0c1a2b3c4d")]
pub(super) struct StageArgs {
    /// Folder of the sweep, with its plan.json
    #[arg(value_name = "DIR")]
    folder: PathBuf,
    /// The stage's key in the store, or the first characters of it
    #[arg(long, value_name = "KEY", conflicts_with_all = ["level", "task", "list"],
          value_parser = NonEmptyStringValueParser::new())]
    key: Option<String>,
    /// Level of the stage, from 0
    #[arg(long, value_name = "N", requires = "task", value_parser = whole(0, usize::MAX),
          allow_negative_numbers = true)]
    level: Option<usize>,
    /// Number of the stage within its level, from 0
    #[arg(long, value_name = "N", requires = "level", value_parser = whole(0, usize::MAX),
          allow_negative_numbers = true)]
    task: Option<usize>,
    /// Print how many stages each level has, and how many are not stored
    #[arg(long, conflicts_with = "level")]
    list: bool,
}

pub(super) fn run(args: &StageArgs, context: &Context) -> Result<ExitStatus, CliError> {
    if args.key.is_none() && args.level.is_none() && !args.list {
        let text = "no stage is named; allowed are --level <N> with --task <N>, or --key <KEY>; \
                    --list prints how many stages each level has";
        return Err(CliError::Usage(text.to_owned()));
    }
    let options = context.run_options(&args.folder, Jobs::default());
    let tasks = SweepTasks::read(RunOptions { jobs: 1, ..options })?;
    let asked = match &args.key {
        Some(key) => Some(tasks.find(key)?),
        None => args.level.zip(args.task),
    };
    let Some((level, task)) = asked else {
        let levels = tasks.levels();
        let missing: Vec<Vec<usize>> = (0..levels.len()).map(|n| tasks.missing(n)).collect();
        let lines = levels.iter().zip(&missing).enumerate().map(|(n, (stages, missing))| {
            format!("level {n}: {}, {} not stored\n", counted(*stages, "stage"), missing.len())
        });
        let text: String = lines.collect();
        return context.done_asked(&text, &json!({ "levels": levels, "missing": missing }));
    };
    remove_abandoned(&args.folder);
    context.stop_on_ctrl_c();
    let label = tasks.carry_out(level, task)?;
    context.done(&format!("{label}: stored\n"), &json!({ "stored": label }))
}
