//! Prescribed motions of pieces.

use super::motion::{CYCLE_TOLERANCE, report_rows};
use super::*;

pub(super) fn check(parts: &Parts, faults: &mut Faults) {
    for (i, spec) in parts.specs() {
        let StageSpec::Move(stage) = spec else { continue };
        let mut faults = faults.at(format!("stages[{i}]"));
        check_move(stage, &mut faults);
        let how = stage.interpolation.unwrap_or_default();
        if let Some(rows) = &stage.motion_rows
            && let Err(found) = RecordedMotion::of_piece(rows, how)
        {
            report_rows(found, &mut faults);
        }
    }
}

fn check_move(stage: &MoveSpec, faults: &mut Faults) {
    let MoveSpec { velocity_mm_per_s, rotation, sine, ref until, ramp_s, .. } = *stage;
    let MoveSpec { duration_s, travel_mm, travel_deg, .. } = *stage;
    let recorded = stage.motion_file.is_some() || stage.motion_rows.is_some();
    let motions = given(&[
        ("velocity_mm_per_s", velocity_mm_per_s.is_some()),
        ("rotation", rotation.is_some()),
        ("sine", sine.is_some()),
        ("motion_file", recorded),
    ]);
    if motions.len() != 1 {
        let allowed = "one of `velocity_mm_per_s`, `rotation`, `sine` and `motion_file`";
        let (found, why) = (motions.join(", "), "a `move` has one motion");
        return faults.add("velocity_mm_per_s", found, allowed, why);
    }
    if recorded {
        let both = stage.motion_rows.as_ref().and(stage.motion_file.as_ref()).map(|_| "both");
        faults.idle("motion_file", both, "`motion_rows` are there already");
        let ramp = Some(ramp_s).filter(|ramp| *ramp != 0.0 && until.is_none());
        for (field, found) in [
            ("duration_s", duration_s),
            ("travel_mm", travel_mm),
            ("travel_deg", travel_deg),
            ("ramp_s", ramp),
        ] {
            let why = "a recorded motion begins with its first row and ends with its last";
            faults.idle(field, found, why);
        }
        let rows = stage.motion_rows.as_deref().unwrap_or_default();
        let still = rows.len() > 1 && rows.iter().all(|row| row[1..] == rows[0][1..]);
        let (found, allowed) = ("no displacement", "rows that differ");
        return faults.add_if(still, "motion_rows", found, allowed, "nothing would move");
    }
    let how = stage.interpolation.map(|how| format!("{how:?}").to_lowercase());
    faults.idle("interpolation", how, "only a `motion_file` has rows to join");
    let (travel, name) = match () {
        () if velocity_mm_per_s.is_some() => (travel_mm, "travel_mm"),
        () if rotation.is_some() => (travel_deg, "travel_deg"),
        () => (None, ""),
    };
    for (field, other) in [("travel_mm", travel_mm), ("travel_deg", travel_deg)] {
        faults.idle(field, other.filter(|_| field != name), "it is no end of this motion");
    }
    let ends = given(&[
        ("duration_s", duration_s.is_some()),
        (name, travel.is_some()),
        ("until", until.is_some()),
    ]);
    if ends.len() != 1 {
        let allowed = match name {
            "" => "`duration_s` or `until`".to_owned(),
            name => format!("one of `duration_s`, `{name}` and `until`"),
        };
        return faults.add("duration_s", ends.join(", "), allowed, "a motion has one end");
    }
    let (field, by): (&str, &[f64]) = match (&velocity_mm_per_s, &rotation, &sine) {
        (Some(velocity), ..) => ("velocity_mm_per_s", velocity),
        (_, Some(turn), _) if turn.deg_per_s == 0.0 => ("rotation.deg_per_s", &[0.0]),
        (_, Some(turn), _) => ("rotation.axis", &turn.axis),
        (.., Some(sine)) => ("sine.amplitude_mm", &sine.amplitude_mm),
        _ => return,
    };
    if !has_length(by) {
        return faults.not_zero(field, by, "nothing would move");
    }
    let (length, length_s) = match until {
        Some(_) => ("time_limit_s", stage.time_limit_s),
        None => ("duration_s", duration_s),
    };
    let speed = match (&velocity_mm_per_s, &rotation) {
        (Some(velocity), _) => velocity.iter().map(|v| v * v).sum::<f64>().sqrt(),
        (_, Some(turn)) => turn.deg_per_s.abs(),
        _ => 0.0,
    };
    if let Some(travel) = travel.filter(|travel| !(travel / speed).is_finite()) {
        let allowed = "a travel that the speed covers in a finite time";
        return faults.add(name, travel, allowed, "the motion would never end");
    }
    // Times and travels below zero are faults already.
    let too_short = |time: &f64| *time > 0.0 && ramp_s > *time;
    if let Some(time) = travel.map(|travel| travel / speed).filter(too_short) {
        let allowed = format!("at most {} s, `{name}` over the speed", no_more(time));
        let why = "the motion would not have grown when it dies away";
        return faults.add("ramp_s", ramp_s, allowed, why);
    }
    let Some(duration) = length_s.filter(|length| *length > 0.0) else { return };
    if 2.0 * ramp_s > duration {
        let allowed = format!("at most {} s, half of the duration", no_more(duration / 2.0));
        let why = "the motion would not have grown when it dies away";
        faults.add("ramp_s", ramp_s, allowed, why);
    } else if let Some(sine) = sine {
        let cycles = sine.frequency_hz * duration;
        let wrong = ramp_s == 0.0 && (cycles.round() - cycles).abs() > CYCLE_TOLERANCE;
        let allowed = "a whole number of cycles, or `ramp_s` above 0";
        let why = "the sine would stop abruptly, away from its place";
        faults.add_if(wrong, length, duration, allowed, why);
    }
}
