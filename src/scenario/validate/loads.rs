//! Loads on pieces that are pressed, and pieces that are let go.

use super::*;

/// What computes the scenario in place of Bullet with native contacts, where something does.
pub(super) fn other_solver(parts: &Parts) -> Option<&'static str> {
    let engine = parts.engine.as_ref().filter(|engine| !engine.is_native())?;
    Some(if engine.backend == Backend::Rapier { "rapier" } else { "Bullet with stock contacts" })
}

/// A stage that only Bullet with native contacts can do, and what others lack.
fn check_solver(parts: &Parts, stage: &str, lack: &str, faults: &mut Faults) {
    let Some(who) = other_solver(parts) else { return };
    let message = format!("{who} {lack}");
    faults.add("stage", format!("{stage:?}"), "it on Bullet with native contacts", message);
}

/// Checks the pieces that a stage lets go; whether they stand, each once, and what is left to carry
/// them is checked with all others.
pub(super) fn check_release(parts: &Parts, names: &[String], faults: &mut Faults) {
    check_solver(parts, "release", "moves no piece freely", faults);
    for (k, name) in names.iter().enumerate() {
        let (field, shown) = (format!("pieces[{k}]"), format!("{name:?}"));
        let piece = parts.pieces().find(|(_, piece)| piece.name == *name);
        let crosses = piece.is_some_and(|(_, piece)| piece.may_cross);
        let message = "a free piece collides with the pieces that it overlaps";
        faults.add_if(crosses, &field, shown, "a piece without `may_cross`", message);
    }
}

/// Checks the loads of a stage; whether their pieces stand is checked with all others.
pub(super) fn check(parts: &Parts, loads: &[LoadSpec], faults: &mut Faults) {
    check_solver(parts, "press", "cannot press a piece along one direction", faults);
    let mut seen = HashSet::new();
    for (k, load) in loads.iter().enumerate() {
        let mut faults = faults.at(format!("loads[{k}]"));
        let (twice, name) = (!seen.insert(&load.piece), format!("{:?}", load.piece));
        faults.add_if(twice, "piece", name, "each piece once", "the piece has two loads");
        faults.not_zero("direction", load.direction, "the load has no direction");
        match (load.moment_n_m, load.axis) {
            (Some(_), None) => {
                faults.add("axis", "", "a direction, as [0, 0, 1]", "a moment needs its axis");
            }
            (Some(_), Some(axis)) => faults.not_zero("axis", axis, "the moment has no axis"),
            (None, axis) => {
                for (field, found) in [("axis", axis), ("about_mm", load.about_mm)] {
                    if let Some(found) = found {
                        let (found, allowed) = (format!("{found:?}"), "`moment_n_m` beside it");
                        faults.add(field, found, allowed, "only a moment has an axis");
                    }
                }
            }
        }
        let given = given(&[
            ("force_n", load.force_n.is_some()),
            ("stress_kpa", load.stress_kpa.is_some()),
            ("moment_n_m", load.moment_n_m.is_some()),
            ("locked", load.locked),
        ]);
        let allowed = "one of `force_n`, `stress_kpa`, `moment_n_m` and `locked`";
        let why = "a load is a force, a stress, a moment or a lock";
        faults.add_if(given.len() != 1, "force_n", given.join(", "), allowed, why);
    }
}
