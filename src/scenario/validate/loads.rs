//! Loads on pieces that are pressed, and pieces that are let go.

use std::collections::HashSet;

use super::Parts;
use crate::scenario::{Backend, ContactSolver, LoadSpec};

/// What computes the scenario, where that is not Bullet with native contacts.
fn not_native(parts: &Parts) -> Option<&'static str> {
    let engine = parts.engine.as_ref()?;
    match (engine.backend, engine.contact_solver) {
        (Backend::Rapier, _) => Some("rapier"),
        (Backend::Bullet, ContactSolver::Stock) => Some("Bullet with stock contacts"),
        (Backend::Bullet, ContactSolver::Native) => None,
    }
}

/// Checks the pieces that a stage lets go; whether they stand is checked with all others.
pub(super) fn check_release(
    parts: &Parts,
    names: &[String],
    add: &mut impl FnMut(&str, String, &str, &str),
) {
    if let Some(who) = not_native(parts) {
        add(
            "stage",
            "\"release\"".into(),
            "it on Bullet with native contacts",
            &format!("{who} moves no piece freely"),
        );
    }
    let mut seen = HashSet::new();
    for (k, name) in names.iter().enumerate() {
        let field = format!("pieces[{k}]");
        if !seen.insert(name) {
            add(&field, format!("{name:?}"), "each piece once", "the piece is named twice");
        }
        let piece = parts.pieces().find(|(_, piece)| piece.name == *name);
        if piece.is_some_and(|(_, piece)| piece.may_cross) {
            let message = "what moves freely feels the pieces that it would stand in";
            add(&field, format!("{name:?}"), "a piece without `may_cross`", message);
        }
    }
    let all = parts.pieces().all(|(_, piece)| names.contains(&piece.name));
    if all && parts.has_pieces() {
        let message = "nothing is left that could carry what moves freely";
        add("pieces", names.join(", "), "fewer than all pieces", message);
    }
}

/// Checks the loads of a stage; whether their pieces stand is checked with all others.
pub(super) fn check(
    parts: &Parts,
    loads: &[LoadSpec],
    add: &mut impl FnMut(&str, String, &str, &str),
) {
    if let Some(who) = not_native(parts) {
        add(
            "stage",
            "\"press\"".into(),
            "it on Bullet with native contacts",
            &format!("{who} cannot press a piece along one direction"),
        );
    }
    let mut seen = HashSet::new();
    for (k, load) in loads.iter().enumerate() {
        let mut add = |field: &str, found: String, allowed: &str, message: &str| {
            add(&format!("loads[{k}].{field}"), found, allowed, message);
        };
        if !seen.insert(&load.piece) {
            let name = format!("{:?}", load.piece);
            add("piece", name, "each piece once", "the piece has two loads");
        }
        if load.direction.iter().all(|x| *x == 0.0) {
            add("direction", "0".into(), "not all of it 0", "the load has no direction");
        }
        let none = |axis: [f64; 3]| axis.iter().all(|x| *x == 0.0);
        match (load.moment_n_m, load.axis) {
            (Some(_), None) => {
                add("axis", String::new(), "a direction, as [0, 0, 1]", "a moment needs its axis");
            }
            (Some(_), Some(axis)) if none(axis) => {
                add("axis", "0".into(), "not all of it 0", "the moment has no axis");
            }
            (None, Some(axis)) => {
                let message = "only a moment has an axis";
                add("axis", format!("{axis:?}"), "`moment_n_m` beside it", message);
            }
            _ => {}
        }
        if let (None, Some(about)) = (load.moment_n_m, load.about_mm) {
            let message = "only a moment has an axis";
            add("about_mm", format!("{about:?}"), "`moment_n_m` beside it", message);
        }
        let given = [
            ("force_n", load.force_n.is_some()),
            ("stress_kpa", load.stress_kpa.is_some()),
            ("moment_n_m", load.moment_n_m.is_some()),
            ("locked", load.locked),
        ];
        let given: Vec<&str> = given.iter().filter(|(_, is)| *is).map(|(name, _)| *name).collect();
        if given.len() != 1 {
            let found = given.join(", ");
            let allowed = "one of `force_n`, `stress_kpa`, `moment_n_m` and `locked`";
            add("force_n", found, allowed, "a load is a force, a stress, a moment or a lock");
        }
    }
}
