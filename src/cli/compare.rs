//! `pluvia compare`.

use super::*;
use crate::study::compare;

/// Run one scenario in several engines
#[derive(Debug, Args)]
#[command(after_help = "\
Every engine gets the same grains in the same places; then the specimen of the first is handed to
the others. Leaves compare.json, report.html, figures/ and runs/ in DIR. Exit code 1 means that the
engines differ by more than the stated bands, or that a run is not valid or lacks grains, so that
the bands are not judged. After an interruption, run the same command again to resume.

Examples:
  pluvia compare scenarios/quick/vibration.json --out out/compare
  pluvia compare scenarios/paper/vibration-continuous.json --backends bullet,rapier --out out/full")]
pub(super) struct CompareArgs {
    /// The scenario file
    #[arg(value_name = "SCENARIO.json")]
    scenario: PathBuf,
    /// The engines; the specimen of the first is handed to the others
    #[arg(long, value_name = "B,B", value_delimiter = ',', default_value = "bullet,rapier",
          value_parser = backend)]
    backends: Vec<Backend>,
    /// Change one value of the scenario (repeatable)
    #[arg(long, value_name = "path=value")]
    set: Vec<Override>,
    #[command(flatten)]
    jobs: Jobs,
    /// Folder for the results, created if needed
    #[arg(long, value_name = "DIR", default_value = "out/compare")]
    out: PathBuf,
}

pub(super) fn run(args: &CompareArgs, context: &Context) -> Result<ExitStatus, CliError> {
    let mut distinct = args.backends.clone();
    distinct.dedup();
    if distinct.len() < 2 {
        return Err(CliError::Usage(
            "--backends needs at least two different engines, as in bullet,rapier".to_owned(),
        ));
    }
    let loaded = load_scenario(&args.scenario, &args.set)?;
    let question = json!({ "scenario": asked::scenario(&loaded.scenario), "backends": distinct });
    context.begin(&args.out, "compare", &question)?;
    let options = context.run_options(&args.out, args.jobs);
    let record = compare(&loaded.scenario, &distinct, &options)?;
    let mut text = table::of_comparison(&record);
    if let Some(why) = &record.not_judged {
        text += &format!("bands are not judged: {why}\n");
    }
    text += &format!("report in {}\n", plain_path(&args.out.join("report.html")));
    text += &last_line::of_runs(record.runs.iter().map(|r| (r.name.as_str(), &r.summary)));
    context.print(&text, &record)?;
    Ok(ExitStatus::by(record.within_bands == Some(true)))
}
