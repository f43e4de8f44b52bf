//! Pieces whose forces keep a mean stress, and what stages make of pieces.

use std::collections::HashMap;

use super::*;

/// What holds a piece.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Hold {
    /// A force presses it.
    Force,
    /// A moment turns it.
    Moment,
    /// Nothing, or it is locked or moved as prescribed.
    Held,
    /// It moves freely.
    Free,
    /// It does not stand any more.
    Removed,
}

impl Hold {
    /// Whether the piece moves by what the grains do.
    pub fn gives_way(self) -> bool {
        matches!(self, Self::Force | Self::Moment | Self::Free)
    }
}

/// What holds the pieces that stages have named so far.
pub(super) type Holds<'a> = HashMap<&'a str, Hold>;

pub(super) fn check(parts: &Parts, faults: &mut Faults) {
    // What earlier stages have made of the pieces, of which one may not be readable.
    let mut holds = Holds::new();
    let mut all_known = parts.begun_after.is_none();
    for (i, stage) in parts.stages.iter().enumerate() {
        let Some(spec) = &stage.spec else {
            all_known = false;
            continue;
        };
        if let StageSpec::Move(MoveSpec { pieces: moved, keep_mean_stress: Some(keep), .. }) = spec
        {
            let mut faults = faults.at(format!("stages[{i}].keep_mean_stress"));
            check_region(parts, keep, &mut faults);
            check_pieces(parts, keep, moved, (&holds, all_known), &mut faults);
        }
        follow(spec, &mut holds);
    }
}

/// What a stage makes of the pieces that it names.
pub(super) fn follow<'a>(spec: &'a StageSpec, holds: &mut Holds<'a>) {
    let (pieces, hold) = match spec {
        StageSpec::Press(PressSpec { loads, .. }) => {
            holds.extend(loads.iter().map(|load| {
                let hold = match () {
                    () if load.locked => Hold::Held,
                    () if load.moment_n_m.is_some() => Hold::Moment,
                    () => Hold::Force,
                };
                (load.piece.as_str(), hold)
            }));
            return;
        }
        StageSpec::Move(stage) => (&stage.pieces, Hold::Held),
        StageSpec::Release(stage) => (&stage.pieces, Hold::Free),
        StageSpec::Remove(stage) => (&stage.pieces, Hold::Removed),
        _ => return,
    };
    holds.extend(pieces.iter().map(|piece| (piece.as_str(), hold)));
}

/// The region, and who can keep its mean stress.
fn check_region(parts: &Parts, keep: &KeepMeanStressSpec, faults: &mut Faults) {
    if let Some(who) = loads::other_solver(parts) {
        let allowed = "the field left out, or Bullet with native contacts";
        let message = format!("{who} cannot press a piece along one direction");
        faults.add("pieces", keep.pieces.join(", "), allowed, message);
    }
    let there = parts.measures.as_ref().filter(|_| !parts.begins_with_unknown());
    let Some(measures) = there else { return };
    let known: Vec<&str> = measures.regions.iter().map(|region| region.name.as_str()).collect();
    let allowed = any_of(&known, "one of `measures.regions`, which has none");
    let region = keep.region.as_str();
    let wrong = !known.contains(&region);
    faults.add_if(wrong, "region", Value::from(region), allowed, "there is no such region");
}

/// Names of which any is allowed, or what is said where there is none.
pub(super) fn any_of(names: &[&str], none: &str) -> String {
    if names.is_empty() { none.to_owned() } else { names.join(", ") }
}

/// The pieces: there, each once, pressed by a force, and not moved at the same time.
fn check_pieces(
    parts: &Parts,
    keep: &KeepMeanStressSpec,
    moved: &[String],
    (holds, all_known): (&Holds, bool),
    faults: &mut Faults,
) {
    let Some(known) = parts.names_of_pieces().filter(|_| parts.has_pieces()) else { return };
    let can = |name: &&str| {
        let held = holds.get(*name).is_none_or(|hold| *hold == Hold::Force);
        held && (!all_known || holds.contains_key(*name)) && !moved.iter().any(|m| m == *name)
    };
    let allowed: Vec<&str> = known.iter().copied().filter(can).collect();
    let none = "a piece that a force presses in an earlier stage; there is none";
    let allowed = any_of(&allowed, none);
    for (k, name) in keep.pieces.iter().enumerate() {
        let field = format!("pieces[{k}]");
        let message = match holds.get(name.as_str()) {
            _ if !known.contains(&name.as_str()) => "there is no such piece",
            _ if keep.pieces[..k].contains(name) => {
                let found = Value::from(name.as_str());
                faults.add(&field, found, "each piece once", "the piece is named twice");
                continue;
            }
            _ if moved.contains(name) => "the piece is moved by this stage",
            Some(Hold::Force) => continue,
            Some(Hold::Moment) => "a moment turns the piece, no force presses it",
            Some(Hold::Free) => "the piece moves freely, no force presses it",
            Some(Hold::Removed) => "the piece was removed before",
            // What a specimen of another run has been through is seen when the stage begins.
            None if !all_known => continue,
            Some(Hold::Held) | None => "no force presses the piece when the stage begins",
        };
        faults.add(&field, Value::from(name.as_str()), &allowed, message);
    }
}
