//! Loads on pieces that are pressed.

use std::collections::HashSet;

use super::Parts;
use crate::scenario::{Backend, ContactSolver, LoadSpec};

/// Checks the loads of a stage; whether their pieces stand is checked with all others.
pub(super) fn check(
    parts: &Parts,
    loads: &[LoadSpec],
    add: &mut impl FnMut(&str, String, &str, &str),
) {
    if let Some(engine) = &parts.engine {
        let who = match (engine.backend, engine.contact_solver) {
            (Backend::Rapier, _) => Some("rapier"),
            (Backend::Bullet, ContactSolver::Stock) => Some("Bullet with stock contacts"),
            (Backend::Bullet, ContactSolver::Native) => None,
        };
        if let Some(who) = who {
            add(
                "stage",
                "\"press\"".into(),
                "it on Bullet with native contacts",
                &format!("{who} cannot press a piece along one direction"),
            );
        }
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
        let piece = parts.pieces().find(|(_, piece)| piece.name == load.piece);
        if let Some((_, piece)) = piece
            && piece.shape.shows_mm2([0.0, 0.0, 1.0]).is_none()
        {
            let kind = piece.shape.kinds().join(", ");
            let message = "only solid pieces can be pressed";
            add("piece", kind, "a `plate`, a `disc`, a `wedge` or a `mesh` of one part", message);
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
