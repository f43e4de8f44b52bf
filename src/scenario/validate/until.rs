//! Conditions that end stages.

use std::collections::HashSet;

use serde_json::Value;

use super::{Parts, fault};
use crate::scenario::{ConditionSpec, Fault, StageSpec};

/// Where a condition is found at fault: field, what was found, what is allowed, what it means.
type Add<'a> = dyn FnMut(&str, String, &str, &str) + 'a;

pub(super) fn check(parts: &Parts, faults: &mut Vec<Fault>) {
    // Pieces that are pressed or free when a stage begins.
    let mut pressed: HashSet<&str> = HashSet::new();
    for (i, stage) in parts.stages.iter().enumerate() {
        let Some(spec) = &stage.spec else { continue };
        follow(spec, &mut pressed);
        let mut add = |field: &str, found: String, allowed: &str, message: &str| {
            let path = format!("stages[{i}].{field}");
            faults.push(fault(&path, found, allowed.into(), message.into()));
        };
        if let StageSpec::Move { until, time_limit_s, motion_file, motion_rows, .. } = spec {
            let recorded = motion_file.is_some() || motion_rows.is_some();
            match (until, time_limit_s) {
                (_, Some(limit)) if recorded => add(
                    "time_limit_s",
                    limit.to_string(),
                    "the field left out",
                    "a recorded motion ends with its last row at the latest",
                ),
                (Some(_), None) if recorded => {}
                (Some(_), None) => add(
                    "time_limit_s",
                    String::new(),
                    "a number above 0",
                    "the motion would go on for ever where `until` is not reached",
                ),
                (None, Some(limit)) => add(
                    "time_limit_s",
                    limit.to_string(),
                    "`duration_s`, or `until` beside it",
                    "it is the limit of a motion with `until`",
                ),
                _ => {}
            }
        }
        if let Some(until) = spec.until() {
            for (place, condition) in until.placed() {
                let mut add = |field: &str, found: String, allowed: &str, message: &str| {
                    add(&format!("until{place}.{field}"), found, allowed, message);
                };
                check_condition(condition, &mut add);
                check_names(parts, condition, &mut add);
                check_way(parts, spec, condition, &pressed, &mut add);
            }
        }
    }
}

/// Which pieces are pressed or free in and after a stage.
fn follow<'a>(spec: &'a StageSpec, pressed: &mut HashSet<&'a str>) {
    match spec {
        StageSpec::Press { loads, .. } => {
            for load in loads {
                match load.locked {
                    true => pressed.remove(load.piece.as_str()),
                    false => pressed.insert(load.piece.as_str()),
                };
            }
        }
        // What is free moves as well.
        StageSpec::Release { pieces, .. } => pressed.extend(pieces.iter().map(String::as_str)),
        StageSpec::Move { pieces, .. } | StageSpec::Remove { pieces, .. } => {
            pressed.retain(|name| !pieces.iter().any(|piece| piece == name));
        }
        _ => {}
    }
}

/// One condition, with what it needs and nothing else.
fn check_condition(until: &ConditionSpec, add: &mut Add) {
    let given = until.given();
    let [(condition, _)] = given[..] else {
        let names: Vec<&str> = given.iter().map(|(name, _)| *name).collect();
        let allowed = "one of `force_n`, `steady_force_percent`, `moved_mm`, `turned_deg`, \
                       `flow_below_g_per_s` and `steady_flow_percent`";
        return add("force_n", names.join(", "), allowed, "a stage ends by one condition");
    };
    let of_flow = condition.contains("flow");
    let (needed, other) = if of_flow { ("opening", "piece") } else { ("piece", "opening") };
    let name = |field: &str| match field {
        "piece" => until.piece.as_ref(),
        _ => until.opening.as_ref(),
    };
    if name(needed).is_none() {
        let message = format!("`{condition}` is that of one");
        add(needed, String::new(), "a name", &message);
    }
    if let Some(name) = name(other) {
        idle(condition, add, other, format!("{name:?}"));
    }
    match (until.direction, condition) {
        (Some(to), _) if of_flow => idle(condition, add, "direction", format!("{to:?}")),
        (Some(to), _) if to.iter().all(|x| *x == 0.0) => {
            add("direction", "0".into(), "not all of it 0", "nothing counts along it");
        }
        (None, "force_n" | "steady_force_percent") => {
            let allowed = "a direction, as [0, 0, 1]";
            add("direction", String::new(), allowed, "a force counts along a direction");
        }
        _ => {}
    }
    if let (Some(to), "turned_deg") = (until.direction, condition) {
        idle(condition, add, "direction", format!("{to:?}"));
    }
    if let (Some(window), "moved_mm" | "turned_deg") = (until.window_s, condition) {
        idle(condition, add, "window_s", window.to_string());
    }
}

/// A field that does not go with the condition.
fn idle(condition: &str, add: &mut Add, field: &str, found: String) {
    let message = format!("it means nothing with `{condition}`");
    add(field, found, "the field left out", &message);
}

/// Names of what is there.
fn check_names(parts: &Parts, until: &ConditionSpec, add: &mut Add) {
    let mut known = |field: &str, name: &Option<String>, there: Vec<&str>, message: &str| {
        if let Some(name) = name.as_deref().filter(|name| !there.contains(name)) {
            add(field, Value::from(name).to_string(), &there.join(", "), message);
        }
    };
    let Some(measures) = &parts.measures else { return };
    // A piece that cannot be read may have any name.
    if parts.pieces().count() == parts.pieces.len() {
        let groups = measures.groups.iter().map(|group| group.name.as_str());
        let pieces = parts.pieces().map(|(_, piece)| piece.name.as_str()).chain(groups);
        known("piece", &until.piece, pieces.collect(), "there is no such piece or group");
    }
    let openings = measures.openings.iter().map(|opening| opening.name.as_str());
    known("opening", &until.opening, openings.collect(), "there is no such opening");
}

/// What ends by its displacement must be able to move.
fn check_way(
    parts: &Parts,
    spec: &StageSpec,
    until: &ConditionSpec,
    pressed: &HashSet<&str>,
    add: &mut Add,
) {
    let way = until.moved_mm.or(until.turned_deg);
    let (Some(name), Some(_), Some(measures)) = (&until.piece, way, &parts.measures) else {
        return;
    };
    let group = measures.groups.iter().find(|group| group.name == *name);
    let names = group.map_or(std::slice::from_ref(name), |group| &group.pieces);
    let driven = |name: &String| match spec {
        StageSpec::Move { pieces, .. } => pieces.is_empty() || pieces.contains(name),
        _ => false,
    };
    let moves = |name: &String| driven(name) || pressed.contains(name.as_str());
    let there = |name: &String| parts.pieces().any(|(_, piece)| piece.name == *name);
    if names.iter().all(there) && !names.iter().any(moves) {
        let allowed = "a piece that is pressed or free, or moved by this stage";
        add("piece", Value::from(name.as_str()).to_string(), allowed, "the piece does not move");
    }
}
