//! `pluvia calibrate` finds the value of a field, friction between grains unless another is
//! named, that gives a measured result such as an angle of repose.

use super::*;
use crate::measure::Interval;
use crate::report::CalibrationEnding;
use crate::study::{CalibrationOptions, CalibrationTarget, GRAIN_FRICTION, calibrate};

/// Where friction between grains is sought unless a range is given.
const FRICTION_RANGE: Interval = Interval::new(0.1, 1.5);

/// Find the friction for a measured angle of repose, or the value of a field for a result
#[derive(Debug, Args)]
#[command(after_help = "\
The command scans the whole range, narrows in on where the result passes the target, and fits a line
there; the interval reflects the scatter between realisations. Leaves calibrate.json, calibrate.md,
report.html, evaluations.csv, figures/ and runs/ in DIR. Exit code 1 means that no value reaches the
target, or that the interval is wider than --tolerance asks; the results are kept. Finished stages
in DIR are reused: after an interruption, run the same command again to resume.

Examples:
  pluvia calibrate scenarios/paper/repose.json --angle-of-repose 38.4 --jobs 2
  pluvia calibrate scenarios/quick/pluviation.json --target standing_height_mm.mean_surface=105 \\
      --unknown contact.grain_grain_friction --between 0.2..1.2 --out out/height
  pluvia calibrate scenarios/quick/vibration.json --target settlement_mm.final=9 \\
      --unknown stages.3.amplitude_mm --between 5..40 --realisations 8 --tolerance 0.5")]
pub(super) struct CalibrateArgs {
    /// The scenario file
    #[arg(value_name = "SCENARIO.json")]
    scenario: PathBuf,
    /// Target angle of repose in degrees
    #[arg(long, value_name = "DEGREES", value_parser = angle, conflicts_with = "target",
          allow_negative_numbers = true)]
    angle_of_repose: Option<CalibrationTarget>,
    /// A number of summary.json by its path, and its target value
    #[arg(long, value_name = "field=value", requires = "unknown", requires = "between")]
    target: Option<CalibrationTarget>,
    /// The number to find, by its path in the scenario [default: contact.grain_grain_friction, with
    /// --angle-of-repose]
    #[arg(long, value_name = "path", requires = "between")]
    unknown: Option<String>,
    /// Range in which to search for it [default: 0.1..1.5, with --angle-of-repose and without
    /// --unknown]
    #[arg(long, value_name = "low..high", allow_hyphen_values = true)]
    between: Option<Interval>,
    /// Number of realisations per value, each a new random arrangement of the same grains; the same
    /// at every value
    #[arg(long, value_name = "N", default_value_t = 5,
          value_parser = whole(2_u32, 1000), allow_negative_numbers = true)]
    realisations: u32,
    /// Stop when half the 95 % interval is at most this, in the result's unit [default: the
    /// standard deviation of a single run]
    #[arg(long, value_name = "WIDTH", value_parser = positive, allow_negative_numbers = true)]
    tolerance: Option<f64>,
    /// Maximum number of runs [default: 16 per realisation]
    #[arg(long, value_name = "N", value_parser = whole(1, usize::MAX), allow_negative_numbers = true)]
    most_runs: Option<usize>,
    #[command(flatten)]
    changes: Changes,
    #[command(flatten)]
    jobs: Jobs,
    /// Folder for the results, created if needed
    #[arg(long, value_name = "DIR", default_value = "out/calibrate")]
    out: PathBuf,
}

fn angle(text: &str) -> Result<CalibrationTarget, String> {
    let degrees = text.parse().map_err(|_| format!("`{text}` is not a number of degrees"))?;
    CalibrationTarget::angle_of_repose(degrees)
}

fn positive(text: &str) -> Result<f64, String> {
    let value = text.parse().ok().filter(|v: &f64| *v > 0.0 && v.is_finite());
    value.ok_or_else(|| format!("`{text}` is not a positive number"))
}

pub(super) fn run(args: &CalibrateArgs, context: &Context) -> Result<ExitStatus, CliError> {
    let target = args.angle_of_repose.clone().or_else(|| args.target.clone());
    let target = target.ok_or_else(|| {
        let text = "no target is given; allowed are --angle-of-repose <DEGREES>, or --target \
                    <field=value> with --unknown <path> and --between <low..high>";
        CliError::Usage(text.to_owned())
    })?;
    let run = context.run_options(&args.out, args.jobs);
    let study = calibrate(CalibrationOptions {
        scenario: args.scenario.clone(),
        changes: args.changes.overrides()?,
        target,
        unknown: args.unknown.clone().unwrap_or_else(|| GRAIN_FRICTION.to_owned()),
        between: args.between.unwrap_or(FRICTION_RANGE),
        realisations: args.realisations,
        tolerance: args.tolerance,
        most_runs: args.most_runs,
    })?;
    carry_out(study, &run, context, |found| {
        let mut text = table::of_calibration(found);
        text += &format!("report in {}\n", plain_path(&args.out.join("report.html")));
        let left_out = found.runs.iter().filter(|r| r.is_left_out()).count();
        let with_result = found.runs.iter().filter(|r| r.result.is_some()).count();
        text += &last_line::of_study((left_out, with_result));
        context.print(&text, found)?;
        match found.ending {
            CalibrationEnding::Found => Ok(ExitStatus::Done),
            CalibrationEnding::Failed => Err(StudyError::Measure(found.statement.clone()).into()),
            _ => Ok(ExitStatus::ExpectationMissed),
        }
    })
}
