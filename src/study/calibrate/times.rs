//! Targets that are settlements at a time of vibration: refused before anything runs where the table
//! does not shake for so long.

use super::*;
use crate::measure::EARLY_SHAKING;

/// Rounding of a sum of times, in s.
const ROUNDING: f64 = 1e-9;

/// How a stage shakes the table.
struct Shaking {
    /// Number of the stage.
    stage: usize,
    periods: u32,
    /// Length of a period in s.
    length: f64,
}

impl Shaking {
    /// Time in s in which the table moves, rests left out.
    fn total(&self) -> f64 {
        f64::from(self.periods) * self.length
    }

    /// The stage and how long it shakes, in words.
    fn in_words(&self) -> String {
        let length = compact(self.length);
        match self.periods {
            1 => format!("stages[{}] (`vibrate`) for {length} s", self.stage),
            many => format!("stages[{}] (`vibrate`) for {many} × {length} s", self.stage),
        }
    }
}

/// Checks that the table shakes for as long as a target asks for, at each end of the range in which
/// the unknown is sought.
///
/// # Errors
/// [`StudyError::Scenario`] with what is asked, the stages that vibrate, and the times that exist.
pub(super) fn reached(target: &CalibrationTarget, ends: &Varied) -> Result<(), StudyError> {
    let lacking: Vec<(&Variation, String)> = ends
        .all
        .iter()
        .filter_map(|(variation, scenario)| Some((variation, lack(&target.field, scenario)?)))
        .collect();
    let Some((variation, why)) = lacking.first() else { return Ok(()) };
    let changes: Vec<&str> = variation.changes.iter().map(Override::text).collect();
    let end = match lacking.len() < ends.all.len() {
        true => format!(", with {},", changes.join(" and ")),
        false => String::new(),
    };
    refused(format!(
        "--target {}: the scenario `{}`{end} does not measure it: {why}",
        target.field, ends.base.name
    ))
}

/// What a scenario lacks to give a settlement at a time of vibration, and which times it has; nothing
/// where it gives it, and of every other result.
fn lack(field: &str, scenario: &Scenario) -> Option<String> {
    let steps: Vec<&str> =
        field.split(['.', '[', ']']).map(str::trim).filter(|step| !step.is_empty()).collect();
    let [of @ ("settlement_mm" | "surface_settlement_mm"), what, place @ ..] = steps.as_slice()
    else {
        return None;
    };
    let shaken: Vec<Shaking> = scenario
        .stages
        .iter()
        .enumerate()
        .filter_map(|(stage, spec)| {
            let motion = spec.motion()?;
            Some(Shaking { stage, periods: motion.periods, length: motion.duration })
        })
        .collect();
    let total: f64 = shaken.iter().map(Shaking::total).sum();
    let periods = shaken.iter().map(|shaking| shaking.periods as usize).sum::<usize>();
    let needed = match (*what, place) {
        ("after_5_s" | "share_after_5_s", _) => {
            (total < EARLY_SHAKING - ROUNDING).then(|| format!("{EARLY_SHAKING} s of vibration"))
        }
        ("after_each_period", [number]) => {
            let number: usize = number.parse().ok()?;
            (number >= periods).then(|| format!("{} periods of vibration", number + 1))
        }
        _ => None,
    }?;
    let stages: Vec<String> = shaken.iter().map(Shaking::in_words).collect();
    let whole = compact(total);
    let after_periods = match (periods, shaken.first()) {
        (0, _) | (_, None) => String::new(),
        (1, Some(_)) => format!("`{of}.after_each_period[0]`, after {whole} s, "),
        (_, Some(first)) => format!(
            "`{of}.after_each_period[0]` to `[{}]`, after {} to {whole} s, ",
            periods - 1,
            compact(first.length)
        ),
    };
    Some(format!(
        "that needs {needed}, and the table shakes for {whole} s in all: {} (allowed: \
         {after_periods}`{of}.end_of_shaking` and `{of}.final`)",
        stages.join(", ")
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::tests::bare_scenario;

    /// A scenario that vibrates: periods and their length in s, a stage each.
    fn vibrated(stages: &[(u32, f64)]) -> Scenario {
        let mut scenario = bare_scenario();
        scenario.stages.extend(stages.iter().map(|(periods, duration_s)| -> StageSpec {
            serde_json::from_value(json!({
                "stage": "vibrate", "frequency_hz": 4, "amplitude_mm": 10,
                "duration_s": duration_s, "periods": periods, "rest_s": 1
            }))
            .expect("a stage")
        }));
        scenario
    }

    fn said(field: &str, scenario: &Scenario) -> String {
        lack(field, scenario).unwrap_or_default()
    }

    /// Law: the settlement after five seconds is refused of a table that shakes for two, with stage,
    /// duration and the times that exist; periods of all stages count, rests do not.
    #[test]
    fn settlements_at_times_that_do_not_exist_are_refused() {
        let short = vibrated(&[(1, 2.0)]);
        for field in ["settlement_mm.after_5_s", "settlement_mm.share_after_5_s"] {
            let said = said(field, &short);
            for words in [
                "needs 5 s of vibration",
                "stages[1] (`vibrate`) for 2 s",
                "`settlement_mm.after_each_period[0]`, after 2 s",
                "`settlement_mm.final`",
            ] {
                assert!(said.contains(words), "law: `{words}` is said of {field}, got `{said}`");
            }
        }
        let surface = said("surface_settlement_mm.after_5_s", &short);
        assert!(surface.contains("`surface_settlement_mm.final`"), "law: its own, got `{surface}`");
        let third = said("settlement_mm.after_each_period[2]", &vibrated(&[(2, 1.5)]));
        for words in ["needs 3 periods", "for 2 × 1.5 s", "`[1]`, after 1.5 to 3 s"] {
            assert!(third.contains(words), "law: `{words}` is said, got `{third}`");
        }
        for (field, scenario) in [
            ("settlement_mm.after_5_s", vibrated(&[(1, 5.0)])),
            ("settlement_mm.after_5_s", vibrated(&[(2, 1.25), (1, 2.5)])),
            ("surface_settlement_mm.share_after_5_s", vibrated(&[(4, 5.0)])),
            ("settlement_mm.after_each_period.1", vibrated(&[(1, 1.0), (1, 1.0)])),
            ("settlement_mm.final", vibrated(&[(1, 2.0)])),
            ("void_ratio", vibrated(&[])),
        ] {
            assert_eq!(lack(field, &scenario), None, "law: {field} is measured");
        }
    }

    /// Law: where the unknown is the duration, both ends of its range count, and the end that is too
    /// short is named.
    #[test]
    fn both_ends_of_a_range_must_shake_for_long_enough() {
        let target: CalibrationTarget = "settlement_mm.after_5_s=3".parse().expect("a target");
        let ends = |low: f64, high: f64| {
            let end = |duration_s: f64| {
                let change = format!("stages.1.duration_s={duration_s}").parse().expect("a change");
                let variation = Variation::new(format!("at-{duration_s}"), "end", vec![change]);
                (variation, vibrated(&[(1, duration_s)]))
            };
            Varied { base: bare_scenario(), all: vec![end(low), end(high)] }
        };
        let said = |low, high| reached(&target, &ends(low, high)).err().map(|e| e.to_string());
        let one = said(2.0, 8.0).expect("law: it is refused");
        assert!(one.contains("with stages.1.duration_s=2,"), "law: at which end, got `{one}`");
        let both = said(2.0, 4.0).expect("law: it is refused");
        assert!(!both.contains("duration_s="), "law: at no end, got `{both}`");
        assert_eq!(said(5.0, 8.0), None, "law: both are long enough");
    }
}
