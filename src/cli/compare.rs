//! `pluvia compare` runs one scenario in several engines and puts their results side by side.

use super::*;
use crate::study::compare;

/// Run one scenario in several engines
#[derive(Debug, Args)]
#[command(after_help = "\
Every engine gets the same grains in the same places; then the specimen of the first is handed to
the others. Leaves compare.json, report.html, figures/ and runs/ in DIR. Exit code 1 means that the
engines differ by more than the stated bands, or that a run is not valid or lacks grains, so that
the bands are not judged. Bands are known for the height and the void ratio of a specimen in the
cylinder; what piles and laboratories measure is shown without a verdict. After an interruption, run
the same command again to resume.

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
    #[command(flatten)]
    changes: SetArgs,
    #[command(flatten)]
    jobs: Jobs,
    /// Folder for the results, created if needed
    #[arg(long, value_name = "DIR", default_value = "out/compare")]
    out: PathBuf,
}

/// The first engine that stands there before: its runs would have the names of the other's.
fn repeated(backends: &[Backend]) -> Option<Backend> {
    let mut numbered = backends.iter().enumerate();
    numbered.find_map(|(n, one)| backends[..n].contains(one).then_some(*one))
}

pub(super) fn run(args: &CompareArgs, context: &Context) -> Result<ExitStatus, CliError> {
    let backends = &args.backends;
    if let Some(twice) = repeated(backends) {
        let name = crate::world::info(twice).name;
        return Err(CliError::Usage(format!("--backends names {name} twice; name each once")));
    }
    if backends.len() < 2 {
        return Err(CliError::Usage(
            "--backends needs at least two engines, as in bullet,rapier".to_owned(),
        ));
    }
    let changes = args.changes.overrides()?;
    let backend = Override::new(&["engine", "backend"], Value::Null);
    if let Some(change) = changes.iter().find(|change| change.is_where(&backend)) {
        return Err(CliError::Usage(format!(
            "--set {}: it would be lost, for the engines are those of --backends; name them there",
            change.text()
        )));
    }
    let loaded = load_scenario(&args.scenario, changes)?;
    let study = compare(loaded, changes, backends)?;
    let run = context.run_options(&args.out, args.jobs);
    carry_out(study, &run, context, |record| {
        let mut text = table::of_comparison(record);
        if let Some(why) = &record.not_judged {
            text += &format!("bands are not judged: {why}\n");
        }
        text += &format!("report in {}\n", plain_path(&args.out.join("report.html")));
        text += &last_line::of_runs(record.runs.iter().map(|r| (r.name.as_str(), &r.summary)));
        context.print(&text, record)?;
        Ok(ExitStatus::by(record.as_expected))
    })
}
