//! What is measured of grains before anything is done with them, once a set.

use std::sync::Weak;

use super::*;
use crate::grains::{GrainShape, SieveAnalysis};
use crate::record::SecondarySieve;

/// Sieve sizes and shapes of a set of grains.
#[derive(Debug, PartialEq)]
pub struct Described {
    /// Every grain through the virtual sieve.
    pub sieved: SieveAnalysis,
    /// Every grain's shape.
    pub shapes: Vec<GrainShape>,
}

/// Sets that were described already, as long as they live: many runs share
/// one set, and sieving it exactly takes a second.
static KNOWN: Mutex<Vec<(Weak<GrainSet>, Arc<Described>)>> = Mutex::new(Vec::new());

/// Describes a set of grains, or takes what was found before.
pub fn described(set: &Arc<GrainSet>) -> Arc<Described> {
    let known = || KNOWN.lock().unwrap_or_else(PoisonError::into_inner);
    let this = Arc::downgrade(set);
    if let Some((_, found)) = known().iter().find(|(other, _)| other.ptr_eq(&this)) {
        return found.clone();
    }
    let new =
        Arc::new(Described { sieved: SieveAnalysis::of(set), shapes: GrainShape::of_all(set) });
    let mut known = known();
    known.retain(|(other, _)| other.strong_count() > 0);
    known.push((this, new.clone()));
    new
}

/// Sieves the grains anew at the end of a stage, as the engine held them;
/// `None` where it could not be asked.
pub fn secondary_sieve(
    before: &SieveAnalysis,
    state: &SpecimenState,
    stage: &StageRecord,
) -> Option<SecondarySieve> {
    if stage.sieved_mm.is_empty() {
        return None;
    }
    // What has no body, either, should have been there.
    let fate = |n: usize| state.bodies.get(n).map_or(Fate::Present, |body| body.fate);
    let found = stage.sieved_mm.iter().enumerate().map(|(n, size)| size.ok_or(fate(n)));
    Some(SecondarySieve::of(before.grains(), &found.collect::<Vec<_>>()))
}
