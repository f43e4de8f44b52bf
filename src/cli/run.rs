//! `pluvia run` runs one scenario, from its grains to its report.

use super::*;
use crate::scenario::GrainsSpec;
use crate::study::{ReadyRun, tell_warnings};

/// Run one scenario
#[derive(Debug, Args)]
#[command(after_help = "\
Leaves manifest.json, summary.json, series.csv, grains.csv, grains.json, specimen.json and figures
in DIR. After an interruption, run the same command again to resume. A folder that holds the results
of another scenario, of grains or of export is refused, unless --force replaces them; the folder of
a study (reproduce, compare, sweep ...), and its runs/, are always refused.

Examples:
  pluvia run scenarios/quick/pluviation.json --out out/first
  pluvia run scenarios/paper/pluviation.json --set stages.1.falling_height_mm=200 \\
      --set engine.rate_hz=960 --out out/from-20-cm")]
pub(super) struct RunArgs {
    /// The scenario file
    #[arg(value_name = "SCENARIO.json")]
    scenario: PathBuf,
    #[command(flatten)]
    changes: Changes,
    /// Folder for the results, created if needed
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Replace the results of another run in that folder
    #[arg(long)]
    force: bool,
    /// Leave out pictures and figures of series and grains, which take seconds; figures that are
    /// there stay as they are
    #[arg(long)]
    no_figures: bool,
    #[command(flatten)]
    jobs: Jobs,
}

pub(super) fn run(args: &RunArgs, context: &Context) -> Result<ExitStatus, CliError> {
    let loaded = load_scenario(&args.scenario, &args.changes.overrides()?)?;
    let scenario = &loaded.scenario;
    tracing::info!(files = ?loaded.files, "the scenario `{}` is sound", scenario.name);
    tell_warnings([scenario], context.progress.as_ref());
    loaded.notes.iter().for_each(|note| context.progress.message(&format!("warning: {note}")));
    // Not even an empty folder is left among the runs of a study.
    earlier_run::refuse_run_of_study(&args.out)?;
    earlier_run::refuse_beginning(&args.out, scenario)?;
    output_folder::prepare(&args.out)?;
    context.stop_on_ctrl_c();
    // Cutting grains may take minutes. Those that are read are tried first: where they cannot be,
    // the scenario may seem to be another than that of the folder.
    if scenario.begin.is_none() && matches!(scenario.grains, GrainsSpec::Sieved(_)) {
        earlier_run::refuse(&args.out, scenario, args.force)?;
    }
    // Before anything is written or removed it is known that the run can begin.
    let ready = ReadyRun::new(scenario).map_err(|error| of_file(&args.scenario, error))?;
    let _at_work = earlier_run::begin(&args.out, scenario, args.force)?;
    let options = RunOptions { frames: true, ..context.run_options(&args.out, args.jobs) };
    let record = ready.carry_out(&options)?;
    if !args.no_figures {
        ready.draw(&record, &options)?;
    }
    earlier_run::finished(&args.out);
    let mut text = table::of_summary(&record.summary);
    text += &format!("results in {}\n", plain_path(&args.out));
    text += &last_line::of_run(&record.summary);
    context.done(&text, &record.summary)
}

/// An error that names the file of the scenario that it is about.
fn of_file(file: &Path, error: StudyError) -> StudyError {
    match error {
        StudyError::Scenario(why) => StudyError::Scenario(format!("{}: {why}", plain_path(file))),
        other => other,
    }
}
