//! Conditions that end stages.

use super::mean_stress::{Hold, Holds, any_of, follow};
use super::*;

pub(super) fn check(parts: &Parts, faults: &mut Faults) {
    // What holds the pieces in a stage.
    let mut holds = Holds::new();
    for (i, spec) in parts.specs() {
        follow(spec, &mut holds);
        let mut faults = faults.at(format!("stages[{i}]"));
        check_limit(spec, &mut faults);
        for (place, condition) in spec.until().into_iter().flat_map(|until| until.placed()) {
            let mut faults = faults.at(format!("until{place}"));
            check_condition(condition, &mut faults);
            check_names(parts, condition, &mut faults);
            if !check_stands(parts, condition, &holds, &mut faults) {
                continue;
            }
            check_way(parts, spec, condition, &holds, &mut faults);
            check_turn(parts, condition, &holds, &mut faults);
            check_reach(spec, condition, &mut faults);
        }
    }
}

/// The limit of a motion that a condition ends.
fn check_limit(spec: &StageSpec, faults: &mut Faults) {
    let StageSpec::Move(stage) = spec else { return };
    let recorded = stage.motion_file.is_some() || stage.motion_rows.is_some();
    let (found, allowed, message) = match (&stage.until, stage.time_limit_s) {
        (_, Some(limit)) if recorded => {
            let why = "a recorded motion ends with its last row at the latest";
            return faults.idle("time_limit_s", Some(limit), why);
        }
        (Some(_), None) if !recorded => (
            String::new(),
            "a number above 0",
            "the motion would go on for ever where `until` is not reached",
        ),
        (None, Some(limit)) => (
            limit.to_string(),
            "`duration_s`, or `until` beside it",
            "it is the limit of a motion with `until`",
        ),
        _ => return,
    };
    faults.add("time_limit_s", found, allowed, message);
}

/// One condition, with what it needs and nothing else.
fn check_condition(until: &ConditionSpec, faults: &mut Faults) {
    let given = until.given();
    let [(condition, _)] = given[..] else {
        let names: Vec<&str> = given.iter().map(|(name, _)| *name).collect();
        let allowed = "one of `force_n`, `steady_force_percent`, `moved_mm`, `turned_deg`, \
                       `flow_below_g_per_s` and `steady_flow_percent`";
        return faults.add("force_n", names.join(", "), allowed, "a stage ends by one condition");
    };
    let of_flow = condition.contains("flow");
    let (piece, opening) = (("piece", &until.piece), ("opening", &until.opening));
    let (needed, other) = if of_flow { (opening, piece) } else { (piece, opening) };
    let message = format!("`{condition}` is that of one");
    faults.add_if(needed.1.is_none(), needed.0, "", "a name", message);
    let idle = format!("it means nothing with `{condition}`");
    faults.idle(other.0, other.1.as_ref().map(|name| format!("{name:?}")), &idle);
    match (until.direction, condition) {
        (Some(to), "turned_deg") => {
            faults.not_zero("direction", to, "nothing counts along it");
            faults.idle("direction", Some(format!("{to:?}")), &idle);
        }
        (Some(to), _) if of_flow => faults.idle("direction", Some(format!("{to:?}")), &idle),
        (Some(to), _) => faults.not_zero("direction", to, "nothing counts along it"),
        (None, "force_n" | "steady_force_percent") => {
            let allowed = "a direction, as [0, 0, 1]";
            faults.add("direction", "", allowed, "a force counts along a direction");
        }
        _ => {}
    }
    let without = matches!(condition, "moved_mm" | "turned_deg");
    faults.idle("window_s", until.window_s.filter(|_| without), &idle);
}

/// Names of what is there.
fn check_names(parts: &Parts, until: &ConditionSpec, faults: &mut Faults) {
    let mut known = |field: &str, name: &Option<String>, there: Vec<&str>, message: &str| {
        if let Some(name) = name.as_deref().filter(|name| !there.contains(name)) {
            // Pieces there are, openings perhaps not.
            let allowed = any_of(&there, "one of `measures.openings`, which has none");
            faults.add(field, Value::from(name), allowed, message);
        }
    };
    let there = parts.measures.as_ref().filter(|_| !parts.begins_with_unknown());
    let Some(measures) = there else { return };
    // A piece that cannot be read may have any name.
    if let Some(mut pieces) = parts.names_of_pieces().filter(|_| parts.has_pieces()) {
        pieces.extend(measures.groups.iter().map(|group| group.name.as_str()));
        known("piece", &until.piece, pieces, "there is no such piece or group");
    }
    let openings = measures.openings.iter().map(|opening| opening.name.as_str());
    known("opening", &until.opening, openings.collect(), "there is no such opening");
}

/// Whether a condition is about a piece that stands, or a group of which one does.
fn check_stands(parts: &Parts, until: &ConditionSpec, holds: &Holds, faults: &mut Faults) -> bool {
    let (Some(name), Some(measures)) = (&until.piece, &parts.measures) else { return true };
    let is_removed = |name: &String| holds.get(name.as_str()) == Some(&Hold::Removed);
    let names = pieces_of(measures, until);
    let wrong = !names.is_empty() && names.iter().all(is_removed);
    let name = Value::from(name.as_str());
    faults.add_if(wrong, "piece", name, "a piece that stands", "the piece was removed before");
    !wrong
}

/// What ends by its displacement must be able to move.
fn check_way(
    parts: &Parts,
    spec: &StageSpec,
    until: &ConditionSpec,
    holds: &Holds,
    faults: &mut Faults,
) {
    let way = until.moved_mm.or(until.turned_deg);
    let (Some(name), Some(_), Some(measures)) = (&until.piece, way, &parts.measures) else {
        return;
    };
    let names = pieces_of(measures, until);
    let kinematic = |name: &String| match spec {
        StageSpec::Move(stage) => stage.pieces.is_empty() || stage.pieces.contains(name),
        _ => false,
    };
    // A piece may be pressed or free from a stage that cannot be read, or from another run.
    let may_be = parts.begun_after.is_some() || parts.stages.iter().any(|s| s.spec.is_none());
    let gives_way =
        |name: &String| holds.get(name.as_str()).map_or(may_be, |hold| hold.gives_way());
    let moves = |name: &String| kinematic(name) || gives_way(name);
    let wrong = parts.have(names) && !names.iter().any(moves);
    let allowed = "a piece that is pressed or free, or moved by this stage";
    let name = Value::from(name.as_str());
    faults.add_if(wrong, "piece", name, allowed, "the piece does not move");
}

/// Names of the pieces that a condition is about: those of a group, or one.
fn pieces_of<'a>(measures: &'a MeasuresSpec, until: &'a ConditionSpec) -> &'a [String] {
    let group = measures.groups.iter().find(|group| Some(&group.name) == until.piece.as_ref());
    group.map_or(until.piece.as_slice(), |group| &group.pieces)
}

/// The whole angle is known of what a moment turns about its axis; of any other piece half a turn
/// at most.
fn check_turn(parts: &Parts, until: &ConditionSpec, holds: &Holds, faults: &mut Faults) {
    let (Some(_), Some(deg), Some(measures)) = (&until.piece, until.turned_deg, &parts.measures)
    else {
        return;
    };
    // A moment may act from a stage that cannot be read, or from another run.
    let all_read = parts.stages.iter().all(|stage| stage.spec.is_some());
    let by_moment = |name: &String| match holds.get(name.as_str()) {
        Some(hold) => *hold == Hold::Moment,
        None => parts.begun_after.is_some(),
    };
    let names = pieces_of(measures, until);
    let wrong = deg > 180.0 && all_read && parts.have(names) && !names.iter().any(by_moment);
    let why = "a piece that no moment turns about an axis shows half a turn at most";
    faults.add_if(wrong, "turned_deg", deg, "at most 180", why);
}

/// How far a motion carries the pieces that it moves until its limit, at full speed but for the
/// time in which it grows and dies away.
fn check_reach(spec: &StageSpec, until: &ConditionSpec, faults: &mut Faults) {
    let StageSpec::Move(stage) = spec else { return };
    let MoveSpec { pieces, velocity_mm_per_s, rotation, sine, time_limit_s, ramp_s, .. } = stage;
    let (Some(piece), Some(limit)) = (&until.piece, time_limit_s) else { return };
    if !(pieces.contains(piece) && sine.is_none() && limit > ramp_s) {
        return;
    }
    let towards = |velocity: &[f64; 3]| match until.direction {
        Some(to) => {
            let length = to.iter().map(|x| x * x).sum::<f64>().sqrt();
            to.iter().zip(velocity).map(|(x, v)| x * v).sum::<f64>() / length
        }
        None => velocity.iter().map(|v| v * v).sum::<f64>().sqrt(),
    };
    let way = (until.moved_mm, until.turned_deg, velocity_mm_per_s, rotation);
    let (field, wanted, speed, unit) = match way {
        (Some(mm), None, Some(velocity), _) => ("moved_mm", mm, towards(velocity), "mm"),
        (None, Some(deg), _, Some(turn)) => ("turned_deg", deg, turn.deg_per_s.abs(), "degrees"),
        _ => return,
    };
    let reach = speed * (limit - ramp_s);
    let wrong = wanted > reach * (1.0 + 1e-9);
    let most = no_more(reach.max(0.0));
    let allowed = format!("at most {most} {unit}, or a longer `time_limit_s`");
    faults.add_if(wrong, field, wanted, allowed, "the motion does not carry the piece so far");
}
