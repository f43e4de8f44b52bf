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
    check_piles(parts, faults);
    check_placements(parts, faults);
}

/// A plate that would be laid into the wall.
fn check_placements(parts: &Parts, faults: &mut Vec<Fault>) {
    let (Some(cylinder), Some(plate)) = (&parts.cylinder, &parts.top_plate) else { return };
    let clearance = (cylinder.inner_diameter_mm - plate.diameter_mm) / 2.0;
    for (i, stage) in parts.stages.iter().enumerate() {
        let Some(StageSpec::PlaceTopPlate { offset_mm: Some(offset), .. }) = stage.spec else {
            continue;
        };
        if offset > clearance && clearance > 0.0 {
            faults.push(fault(
                &format!("stages[{i}].offset_mm"),
                offset,
                format!(
                    "at most the clearance between plate and cylinder, {} mm",
                    short(clearance)
                ),
                "the plate would be laid into the wall".into(),
            ));
        }
    }
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
    if parts.has_pieces() {
        return;
    }
    // Names of stages that cannot be read could be any: what follows one is not judged.
    let begun = parts.begun_after.as_deref();
    // Where it is not known what a specimen has been through, everything may have been done.
    let unknown = begun.is_some_and(<[String]>::is_empty);
    let known =
        |end: usize| !unknown && parts.stages[..end].iter().all(|stage| stage.name.is_some());
    for (i, stage) in parts.stages.iter().enumerate() {
        let Some(name) = stage.name.as_deref() else { continue };
        let mut add = |allowed: &str, message: String| {
            let path = format!("stages[{i}].stage");
            faults.push(fault(&path, Value::from(name), allowed.into(), message));
        };
        let before = |other: &str| {
            let own = parts.stages[..i].iter().any(|s| s.name.as_deref() == Some(other));
            own || begun.into_iter().flatten().any(|name| name == other)
        };
        if name == "fill_funnel" && begun.is_some() {
            let message =
                "`fill_funnel` begins with loose grains, and this scenario with a specimen";
            add("another stage, or `begin` left out", message.to_owned());
            continue;
        }
        if i == 0
            && begun.is_none()
            && !matches!(
                name,
                "fill_funnel" | "slow_pluviation" | "deposit" | "move" | "release" | "remove"
            )
        {
            add(
                "\"fill_funnel\" or \"slow_pluviation\"",
                "the first stage fills the funnel, or builds a pile".into(),
            );
            continue;
        }
        if name == "slow_pluviation" && (i > 0 || begun.is_some()) {
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
            let (field, limit) = match *spec {
                StageSpec::FillFunnel { time_limit_s }
                | StageSpec::SlowPluviation { time_limit_s, .. }
                | StageSpec::Pour { time_limit_s, .. }
                | StageSpec::Deposit { time_limit_s, .. }
                | StageSpec::Press { time_limit_s, .. }
                | StageSpec::Release { time_limit_s, .. }
                | StageSpec::Remove { time_limit_s, .. }
                | StageSpec::PlaceTopPlate { time_limit_s, .. } => ("time_limit_s", time_limit_s),
                StageSpec::Vibrate { settle_limit_s, .. } => ("settle_limit_s", settle_limit_s),
                StageSpec::Move { settle_limit_s, .. } if settle_limit_s > 0.0 => {
                    ("settle_limit_s", settle_limit_s)
                }
                StageSpec::Move { .. } | StageSpec::Rest { .. } => continue,
            };
            if limit <= settle.hold_s {
                faults.push(fault(
                    &format!("stages[{i}].{field}"),
                    limit,
                    format!("more than settle.hold_s, {} s", settle.hold_s),
                    "the stage ends before anything can count as settled".into(),
                ));
            }
        }
    }
    let total =
        specs().map(|(_, spec)| spec.longest()).sum::<f64>() + parts.rest_test_s.unwrap_or(0.0);
    if total > LONGEST {
        faults.push(fault(
            "stages",
            format!("{} s", short(total)),
            format!("at most {LONGEST} s"),
            "stages and rest test together take too long".into(),
        ));
    }
}
