//! Which stage may follow which, and how long all of them take.

use serde_json::Value;

use super::{Parts, fault, short};
use crate::scenario::{BaseKind, Fault, StageSpec};

/// Longest simulated time of a scenario in s: an hour is 180 times the
/// paper's longest test.
const LONGEST: f64 = 3600.0;

pub(super) fn check(parts: &Parts, faults: &mut Vec<Fault>) {
    check_order(parts, faults);
    check_time(parts, faults);
    check_cycles(parts, faults);
    check_ramps(parts, faults);
    check_piles(parts, faults);
}

/// Base and time of a pile.
fn check_piles(parts: &Parts, faults: &mut Vec<Fault>) {
    let specs = parts.stages.iter().enumerate().filter_map(|(i, s)| Some((i, s.spec.as_ref()?)));
    for (i, spec) in specs {
        let StageSpec::SlowPluviation {
            feed_rate_grains_per_s,
            spout_diameter_mm,
            base,
            base_diameter_mm,
            time_limit_s,
            ..
        } = spec
        else {
            continue;
        };
        let mut add = |field: &str, found: String, allowed: String, message: &str| {
            faults.push(fault(&format!("stages[{i}].{field}"), found, allowed, message.into()));
        };
        match (base.kind, base.friction) {
            (BaseKind::Plane, None) => add(
                "base.friction",
                String::new(),
                "a number of at least 0 and at most 10".into(),
                "a plane needs its friction with the grains",
            ),
            (BaseKind::FixedGrains, Some(friction)) => add(
                "base.friction",
                friction.to_string(),
                "the field left out; contact.grain_grain_friction is that of fixed grains, too"
                    .into(),
                "fixed grains have the friction between grains",
            ),
            _ => {}
        }
        if spout_diameter_mm >= base_diameter_mm {
            add(
                "base_diameter_mm",
                base_diameter_mm.to_string(),
                format!("more than the spout's diameter, {spout_diameter_mm} mm"),
                "grains would be let go beside the base",
            );
        }
        let Some(grading) = &parts.grading else { continue };
        let feeding = grading.count / feed_rate_grains_per_s;
        if feeding.is_finite() && *time_limit_s <= feeding {
            add(
                "time_limit_s",
                time_limit_s.to_string(),
                format!("more than {} s", short(feeding)),
                "the stage ends before all grains have been fed",
            );
        }
    }
}

fn check_order(parts: &Parts, faults: &mut Vec<Fault>) {
    // Names of stages that cannot be read could be any: what follows one is not judged.
    let known = |end: usize| parts.stages[..end].iter().all(|stage| stage.name.is_some());
    for (i, stage) in parts.stages.iter().enumerate() {
        let Some(name) = stage.name.as_deref() else { continue };
        let mut add = |allowed: &str, message: String| {
            let path = format!("stages[{i}].stage");
            faults.push(fault(&path, Value::from(name), allowed.into(), message));
        };
        let before = |other: &str| {
            parts.stages[..i].iter().any(|stage| stage.name.as_deref() == Some(other))
        };
        if i == 0 && !matches!(name, "fill_funnel" | "slow_pluviation") {
            add(
                "\"fill_funnel\" or \"slow_pluviation\"",
                "the first stage fills the funnel, or builds a pile".into(),
            );
            continue;
        }
        if name == "slow_pluviation" && i > 0 {
            add(
                "it as the first stage",
                "`slow_pluviation` begins with an empty base and all grains at hand".into(),
            );
            continue;
        }
        if before("slow_pluviation") && name != "rest" {
            add(
                "`rest` after `slow_pluviation`",
                format!("a pile stands in no cylinder: `{name}` cannot be done with it"),
            );
            continue;
        }
        let needs = match name {
            "pour" => "fill_funnel",
            "place_top_plate" | "vibrate" => "pour",
            _ => "",
        };
        if !needs.is_empty() && !before(needs) && known(i) {
            add(
                &format!("`{name}` after a stage `{needs}`"),
                format!("`{name}` cannot be done before `{needs}`"),
            );
        }
        let once = matches!(name, "fill_funnel" | "pour" | "place_top_plate");
        if once && before(name) {
            add(
                "it once; only `vibrate` and `rest` may be repeated",
                format!("`{name}` is there twice"),
            );
        }
    }
}

fn check_time(parts: &Parts, faults: &mut Vec<Fault>) {
    let specs = || parts.stages.iter().enumerate().filter_map(|(i, s)| Some((i, s.spec.as_ref()?)));
    if let Some(settle) = &parts.settle {
        for (i, spec) in specs() {
            let settles = matches!(
                spec.name(),
                "fill_funnel" | "slow_pluviation" | "pour" | "place_top_plate"
            );
            if settles && spec.longest() <= settle.hold_s {
                faults.push(fault(
                    &format!("stages[{i}].time_limit_s"),
                    spec.longest(),
                    format!("more than settle.hold_s, {} s", settle.hold_s),
                    "the stage ends before anything can count as settled".into(),
                ));
            }
        }
    }
    let total =
        specs().map(|(_, spec)| spec.longest()).sum::<f64>() + parts.control_s.unwrap_or(0.0);
    if total > LONGEST {
        faults.push(fault(
            "stages",
            format!("{} s", short(total)),
            format!("at most {LONGEST} s"),
            "stages and control together take too long".into(),
        ));
    }
}

/// How far a period may be from a whole number of cycles, in cycles: decimals
/// of a fraction such as 0.6667 s at 3 Hz must do.
const CYCLE_TOLERANCE: f64 = 1e-3;

/// A table stopped away from its middle position would jump there in one step.
fn check_cycles(parts: &Parts, faults: &mut Vec<Fault>) {
    let specs = parts.stages.iter().enumerate().filter_map(|(i, s)| Some((i, s.spec.as_ref()?)));
    for (i, spec) in specs {
        let Some(motion) = spec.vibration() else { continue };
        let cycles = motion.duration * motion.frequency;
        if (cycles - cycles.round()).abs() > CYCLE_TOLERANCE || cycles.round() < 1.0 {
            faults.push(fault(
                &format!("stages[{i}].duration_s"),
                motion.duration,
                format!(
                    "a whole number of cycles of {} s, as {}",
                    short(1.0 / motion.frequency),
                    short(cycles.round().max(1.0) / motion.frequency)
                ),
                "a period of vibration must end where it began, in the middle of the stroke".into(),
            ));
        }
    }
}

/// A shorter ramp would move the table faster than the sinusoid does; longer
/// ones would meet.
fn check_ramps(parts: &Parts, faults: &mut Vec<Fault>) {
    let specs = parts.stages.iter().enumerate().filter_map(|(i, s)| Some((i, s.spec.as_ref()?)));
    for (i, spec) in specs {
        let Some(motion) = spec.vibration() else { continue };
        let cycle = 1.0 / motion.frequency;
        let longest = motion.duration / 2.0;
        if motion.ramp > 0.0 && !(cycle..=longest).contains(&motion.ramp) {
            let allowed = if cycle <= longest {
                format!(
                    "0, or from one cycle, {} s, to half of duration_s, {} s",
                    short(cycle),
                    short(longest)
                )
            } else {
                "0: the period is too short for a ramp of one cycle at either end".to_owned()
            };
            faults.push(fault(
                &format!("stages[{i}].ramp_s"),
                motion.ramp,
                allowed,
                "the amplitude can neither grow within a part of a cycle, nor still grow when it begins to die \
                 away"
                    .into(),
            ));
        }
    }
}
