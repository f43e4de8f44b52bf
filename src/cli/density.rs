//! `pluvia density` finds the loosest and the densest state of a scenario's grains,
//! for relative densities.

use super::*;
use crate::study::{DensityOptions, IndexState, density};

/// Find the loosest and the densest state of a scenario's grains
#[derive(Debug, Args)]
#[command(after_help = "\
Grains, contact and engine are the scenario's; the command has a mould and a procedure of its own.
Loosest state: grains fall into the mould from just above those already there (after ASTM D4254),
and the height follows their surface.
Densest state: the same grains, vibrated vertically. Grains poured without friction are a bound that
grains with friction do not reach by themselves. ASTM D4253 vibrates for 8 minutes at 60 Hz and
0.33 mm under 13.8 kPa. That is too long to simulate, and after a few seconds grains still sink, so
the defaults differ. Leaves density.json, with all deviations from the standards, and runs/ in DIR;
finished stages there are reused. A scenario with e_max and e_min as `index_densities` has relative
densities in its summary.

Examples:
  pluvia density scenarios/quick/pluviation.json --configurations 3 --out out/density
  pluvia density scenarios/quick/pluviation.json --frequency-hz 60 --double-amplitude-mm 0.33 \\
      --surcharge-kpa 13.8 --seconds 60 --out out/d4253")]
pub(super) struct DensityArgs {
    /// The scenario file
    #[arg(value_name = "SCENARIO.json")]
    scenario: PathBuf,
    /// Number of realisations, each a new random arrangement of the same grains
    #[arg(long, value_name = "N", default_value_t = 3,
          value_parser = whole(1_u32, 1000), allow_negative_numbers = true)]
    configurations: u32,
    /// Stress of a plate on the vibrated grains in kPa; 0 for no plate
    #[arg(long, value_name = "KPA", default_value_t = 0.0, value_parser = between(0.0, 1000.0),
          allow_negative_numbers = true)]
    surcharge_kpa: f64,
    /// Frequency of the vibration in Hz
    #[arg(long, value_name = "HZ", default_value_t = 12.0, value_parser = between(1.0, 200.0),
          allow_negative_numbers = true)]
    frequency_hz: f64,
    /// Double amplitude (end to end) of the vibration in mm
    #[arg(long, value_name = "MM", default_value_t = 8.0, value_parser = between(0.001, 100.0),
          allow_negative_numbers = true)]
    double_amplitude_mm: f64,
    /// Duration of the vibration in s: a whole number of cycles
    #[arg(long, value_name = "S", default_value_t = 8.0, value_parser = between(1.0, 3600.0),
          allow_negative_numbers = true)]
    seconds: f64,
    #[command(flatten)]
    changes: Changes,
    #[command(flatten)]
    jobs: Jobs,
    /// Folder for the results, created if needed
    #[arg(long, value_name = "DIR", default_value = "out/density")]
    out: PathBuf,
}

/// A reader of numbers from `low` to `high`, for an option.
fn between(low: f64, high: f64) -> impl Fn(&str) -> Result<f64, String> + Clone + Send + Sync {
    move |text: &str| {
        let number = text.parse::<f64>().ok().filter(|n| (low..=high).contains(n));
        number.ok_or_else(|| format!("`{text}` is not a number from {low} to {high}"))
    }
}

pub(super) fn run(args: &DensityArgs, context: &Context) -> Result<ExitStatus, CliError> {
    let run = context.run_options(&args.out, args.jobs);
    let study = density(DensityOptions {
        scenario: args.scenario.clone(),
        changes: args.changes.overrides()?,
        configurations: args.configurations,
        surcharge_kpa: args.surcharge_kpa,
        frequency_hz: args.frequency_hz,
        double_amplitude_mm: args.double_amplitude_mm,
        duration_s: args.seconds,
    })?;
    carry_out(study, &run, context, |found| {
        let of = &found.states;
        let states =
            [("e_max", &of.e_max), ("e_min", &of.e_min), ("frictionless", &of.frictionless)];
        let mut text = format!("{}, {}\n", found.scenario, counted(found.grains, "grain"));
        for (name, state) in states {
            text += &format!("{name:<13} {}: {}\n", in_words(state), state.method);
            for failure in &state.failures {
                text += &format!("              {failure}\n");
            }
        }
        for departure in &found.departures {
            text += &format!("{departure}\n");
        }
        text += &format!("full results in {}\n", plain_path(&args.out.join("density.json")));
        context.print(&text, found)?;
        Ok(ExitStatus::by(states.iter().any(|(_, state)| state.mean.is_some())))
    })
}

/// A void ratio with its interval.
fn in_words(state: &IndexState) -> String {
    match (state.mean, state.half_width_95) {
        (Some(mean), Some(half)) => format!("{mean:.3} ± {half:.3}"),
        (Some(mean), None) => format!("{mean:.3}"),
        (None, _) => "none".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_out_of_their_range_are_refused_with_what_is_allowed() {
        let read = between(0.0, 1000.0);
        assert_eq!(read("13.8"), Ok(13.8), "law: within");
        for text in ["-1", "1001", "nan", "much"] {
            let told = read(text).expect_err("law: refused");
            assert!(
                told.contains(text) && told.contains("0 to 1000"),
                "law: value and range: {told}"
            );
        }
        assert!(between(1.0, 200.0)("0.5").is_err(), "law: no frequency below 1 Hz");
    }
}
