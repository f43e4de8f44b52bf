//! Which stage may follow which, and how long all of them take.

use super::*;

/// Longest simulated time of a scenario in s: an hour is 180 times the
/// paper's longest test.
const LONGEST: f64 = 3600.0;

pub(super) fn check(parts: &Parts, faults: &mut Faults) {
    check_order(parts, faults);
    check_time(parts, faults);
    for (i, spec) in parts.specs() {
        check_pile(parts, spec, &mut faults.at(format!("stages[{i}]")));
    }
    check_placements(parts, faults);
}

/// A plate that would be laid into the wall, and limits of a placement where none is drawn.
fn check_placements(parts: &Parts, faults: &mut Faults) {
    for (i, spec) in parts.specs() {
        let StageSpec::PlaceTopPlate(stage) = spec else { continue };
        let mut faults = faults.at(format!("stages[{i}]"));
        if stage.placement == 0 {
            let why =
                "it means nothing with placement 0, which lays the plate on the axis, unturned";
            // That of a plate whose rotation was not typed.
            let rotation = Some(stage.rotation_deg).filter(|deg| *deg != half_turn());
            faults.idle("offset_mm", stage.offset_mm, why);
            faults.idle("rotation_deg", rotation, why);
            continue;
        }
        let (Some(cylinder), Some(plate)) = (&parts.cylinder, &parts.top_plate) else { continue };
        let clearance = (cylinder.inner_diameter_mm - plate.diameter_mm) / 2.0;
        let Some(offset) = stage.offset_mm else { continue };
        let wrong = offset > clearance && clearance > 0.0;
        let room = no_more(clearance);
        let allowed = format!("at most the clearance between plate and cylinder, {room} mm");
        let why = "the plate would be laid into the wall";
        faults.add_if(wrong, "offset_mm", offset, allowed, why);
    }
}

/// Base and time of a pile.
fn check_pile(parts: &Parts, spec: &StageSpec, faults: &mut Faults) {
    let StageSpec::SlowPluviation(stage) = spec else { return };
    let SlowPluviationSpec { base, base_diameter_mm, spout_diameter_mm, time_limit_s, .. } = stage;
    match (base.kind, base.friction) {
        (BaseKind::Plane, None) => {
            let allowed = "a number of at least 0 and at most 10";
            let why = "a plane needs its friction with the grains";
            faults.add("base.friction", "", allowed, why);
        }
        (BaseKind::FixedGrains, Some(friction)) => {
            let allowed =
                "the field left out; contact.grain_grain_friction is that of fixed grains, too";
            let why = "fixed grains have the friction between grains";
            faults.add("base.friction", friction, allowed, why);
        }
        _ => {}
    }
    let wrong = spout_diameter_mm >= base_diameter_mm;
    let allowed = format!("more than the spout's diameter, {spout_diameter_mm} mm");
    let why = "grains would be released outside the base";
    faults.add_if(wrong, "base_diameter_mm", base_diameter_mm, allowed, why);
    let Some(grading) = &parts.grading else { return };
    let feeding = grading.count / stage.feed_rate_grains_per_s;
    let wrong = feeding.is_finite() && *time_limit_s <= feeding;
    let allowed = format!("more than {} s", no_less(feeding));
    let why = "the stage ends before all grains have been fed";
    faults.add_if(wrong, "time_limit_s", time_limit_s, allowed, why);
}

fn check_order(parts: &Parts, faults: &mut Faults) {
    if parts.has_pieces() {
        return;
    }
    // Names of stages that cannot be read, or are none, could be any: they and what follows one are
    // not judged.
    let begun = parts.begun_after.as_deref();
    let unknown = parts.begins_with_unknown();
    let known =
        |end: usize| !unknown && parts.stages[..end].iter().all(|stage| stage.known().is_some());
    for (i, stage) in parts.stages.iter().enumerate() {
        let Some(name) = stage.known() else { continue };
        let mut faults = faults.at(format!("stages[{i}]"));
        let mut add = |allowed: &str, message: String| {
            faults.add("stage", Value::from(name), allowed, message);
        };
        let in_file =
            |other: &str| parts.stages[..i].iter().any(|s| s.name.as_deref() == Some(other));
        let in_specimen = |other: &str| begun.into_iter().flatten().any(|name| name == other);
        let before = |other: &str| in_file(other) || in_specimen(other);
        let is_first = i == 0 && begun.is_none();
        // What may be done with all grains at hand.
        let begins = matches!(
            name,
            "fill_funnel" | "slow_pluviation" | "deposit" | "move" | "release" | "remove"
        );
        let (allowed, message) = match name {
            "fill_funnel" if begun.is_some() => (
                "another stage, or `begin` left out",
                "`fill_funnel` begins with loose grains, and this scenario with a specimen".into(),
            ),
            _ if is_first && !begins => (
                "\"fill_funnel\" or \"slow_pluviation\"",
                "the first stage fills the funnel, or builds a pile".into(),
            ),
            "slow_pluviation" if !is_first => (
                "it as the first stage",
                "`slow_pluviation` begins with an empty base and all grains at hand".into(),
            ),
            _ if before("slow_pluviation") && name != "rest" => (
                "`rest` after `slow_pluviation`",
                format!("a pile has no cylinder, so `{name}` is not possible"),
            ),
            _ => {
                let needs = match name {
                    "pour" => "fill_funnel",
                    "place_top_plate" | "vibrate" => "pour",
                    _ => "",
                };
                if !needs.is_empty() && !before(needs) && known(i) {
                    let message = format!("`{name}` cannot be done before `{needs}`");
                    add(&format!("`{name}` after a stage `{needs}`"), message);
                }
                let once = matches!(name, "fill_funnel" | "pour" | "place_top_plate");
                if once && in_file(name) {
                    let allowed = "it once; only `vibrate` and `rest` may be repeated";
                    add(allowed, format!("`{name}` is there twice"));
                } else if once && in_specimen(name) {
                    let allowed = "another stage; only `vibrate` and `rest` may be repeated";
                    let message = format!(
                        "`{name}` cannot be done again: the specimen that is begun with has been \
                         through it"
                    );
                    add(allowed, message);
                }
                continue;
            }
        };
        add(allowed, message);
    }
}

fn check_time(parts: &Parts, faults: &mut Faults) {
    if let Some(settle) = &parts.settle {
        for (i, spec) in parts.specs() {
            let Some((field, limit)) = spec.limit() else { continue };
            if matches!(spec, StageSpec::Move { .. }) && limit <= 0.0 {
                continue;
            }
            let wrong = limit <= settle.hold_s;
            let field = format!("stages[{i}].{field}");
            let allowed = format!("more than settle.hold_s, {} s", settle.hold_s);
            let why = "the stage ends before anything can count as settled";
            faults.add_if(wrong, &field, limit, allowed, why);
        }
    }
    let stages: f64 = parts.specs().map(|(_, spec)| spec.longest()).sum();
    let total = stages + parts.rest_test_s.unwrap_or(0.0);
    let found = format!("{} s", no_less(total));
    let allowed = format!("at most {LONGEST} s");
    let why = "stages and rest test together take too long";
    faults.add_if(total > LONGEST, "stages", found, allowed, why);
}
