//! Prescribed motions of pieces.

use super::{Parts, fault, motion::report_rows, short};
use crate::motion::RecordedMotion;
use crate::scenario::{Fault, StageSpec, accessors::joined};

/// Where a stage is found at fault: field, what was found, what is allowed, what it means.
type Add<'a> = dyn FnMut(&str, String, &str, &str) + 'a;

pub(super) fn check(parts: &Parts, faults: &mut Vec<Fault>) {
    for (i, stage) in parts.stages.iter().enumerate() {
        let Some(spec @ StageSpec::Move { motion_rows, interpolation, .. }) = &stage.spec else {
            continue;
        };
        let mut add = |field: &str, found: String, allowed: &str, message: &str| {
            let path = format!("stages[{i}].{field}");
            faults.push(fault(&path, found, allowed.into(), message.into()));
        };
        check_move(spec, &mut add);
        if let Some(rows) = motion_rows
            && let Err(found) = RecordedMotion::of_piece(rows, joined(*interpolation))
        {
            report_rows(found, &format!("stages[{i}].motion_rows"), faults);
        }
    }
}

fn check_move(spec: &StageSpec, add: &mut Add) {
    let StageSpec::Move {
        velocity_mm_per_s,
        rotation,
        sine,
        motion_file,
        motion_rows,
        interpolation,
        duration_s,
        travel_mm,
        travel_deg,
        until,
        time_limit_s,
        ramp_s,
        ..
    } = spec
    else {
        return;
    };
    let recorded = motion_file.is_some() || motion_rows.is_some();
    let motions = [velocity_mm_per_s.is_some(), rotation.is_some(), sine.is_some(), recorded];
    if motions.iter().filter(|given| **given).count() != 1 {
        let allowed = "one of `velocity_mm_per_s`, `rotation`, `sine` and `motion_file`";
        return add("velocity_mm_per_s", String::new(), allowed, "pieces move in one way");
    }
    if recorded {
        return check_recorded(spec, add);
    }
    if let Some(how) = interpolation {
        let found = format!("{how:?}").to_lowercase();
        add("interpolation", found, "the field left out", "only a `motion_file` has rows to join");
    }
    let (travel, name) = match () {
        () if velocity_mm_per_s.is_some() => (*travel_mm, "travel_mm"),
        () if rotation.is_some() => (*travel_deg, "travel_deg"),
        () => (None, ""),
    };
    for (field, other) in [("travel_mm", travel_mm), ("travel_deg", travel_deg)] {
        if let Some(other) = other.filter(|_| field != name) {
            add(field, other.to_string(), "the field left out", "it is no end of this motion");
        }
    }
    let ends = [duration_s.is_some(), travel.is_some(), until.is_some()];
    if ends.iter().filter(|given| **given).count() != 1 {
        let allowed = match name {
            "" => "`duration_s` or `until`".to_owned(),
            name => format!("one of `duration_s`, `{name}` and `until`"),
        };
        return add("duration_s", String::new(), &allowed, "a motion has one end");
    }
    let still = match (velocity_mm_per_s, rotation, sine) {
        (Some(v), ..) => v.iter().all(|v| *v == 0.0).then_some("velocity_mm_per_s"),
        (_, Some(turn), _) if turn.deg_per_s == 0.0 => Some("rotation.deg_per_s"),
        (_, Some(turn), _) => turn.axis.iter().all(|x| *x == 0.0).then_some("rotation.axis"),
        (.., Some(sine)) => {
            sine.amplitude_mm.iter().all(|a| *a == 0.0).then_some("sine.amplitude_mm")
        }
        _ => None,
    };
    if let Some(field) = still {
        return add(field, "0".into(), "not all of it 0", "nothing would move");
    }
    let (length, length_s) = match until {
        Some(_) => ("time_limit_s", time_limit_s),
        None => ("duration_s", duration_s),
    };
    let Some(duration) = length_s.filter(|duration| 2.0 * ramp_s > *duration) else {
        if let (Some(sine), Some(duration)) = (sine, length_s)
            && *ramp_s == 0.0
            && ((sine.frequency_hz * duration).round() - sine.frequency_hz * duration).abs() > 1e-6
        {
            add(
                length,
                duration.to_string(),
                "a whole number of cycles, or `ramp_s` above 0",
                "the sine would stop abruptly, away from its place",
            );
        }
        return;
    };
    let allowed = format!("at most {} s, half of the duration", short(duration / 2.0));
    add(
        "ramp_s",
        ramp_s.to_string(),
        &allowed,
        "the motion would not have grown when it dies away",
    );
}

/// A recorded motion has its own beginning and end.
fn check_recorded(spec: &StageSpec, add: &mut Add) {
    let StageSpec::Move {
        motion_file,
        motion_rows,
        duration_s,
        travel_mm,
        travel_deg,
        until,
        ramp_s,
        ..
    } = spec
    else {
        return;
    };
    if motion_file.is_some() && motion_rows.is_some() {
        let message = "`motion_rows` are there already";
        add("motion_file", "both".into(), "the field left out", message);
    }
    let number = |of: &Option<f64>| of.map(|value| value.to_string());
    for (field, found) in [
        ("duration_s", number(duration_s)),
        ("travel_mm", number(travel_mm)),
        ("travel_deg", number(travel_deg)),
        ("ramp_s", number(&Some(*ramp_s).filter(|ramp| *ramp != 0.0 && until.is_none()))),
    ] {
        if let Some(found) = found {
            let message = "a recorded motion begins with its first row and ends with its last";
            add(field, found, "the field left out", message);
        }
    }
    if let Some(rows) = motion_rows.as_ref().filter(|rows| rows.len() > 1)
        && rows.iter().all(|row| row[1..] == rows[0][1..])
    {
        add("motion_rows", "no displacement".into(), "rows that differ", "nothing would move");
    }
}
