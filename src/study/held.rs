//! Which stages of a plan a store holds, checked as they are when they are used.

use super::{believed, plan::Plan};
use crate::record::{AskedStage, StageStore, StoredStage};
use crate::specimen::SpecimenState;

/// Whether each stage of a plan is stored, whole, unchanged and the one that is asked for, and
/// everything that it goes on from as well: what would be used, and nothing would be run anew.
pub(super) fn held(plan: &Plan, store: &StageStore) -> Vec<bool> {
    let mut held = vec![false; plan.nodes.len()];
    // What later stages go on from, as long as there are any.
    let mut ends: Vec<Option<(SpecimenState, String)>> = vec![None; plan.nodes.len()];
    let mut last_child = vec![0; plan.nodes.len()];
    for (n, node) in plan.nodes.iter().enumerate() {
        node.parent.into_iter().for_each(|parent| last_child[parent] = n);
    }
    // Parents come before children.
    for (n, node) in plan.nodes.iter().enumerate() {
        let before = match node.parent {
            None => Some((SpecimenState::before_everything(node.grains.grains.len()), None)),
            Some(parent) => {
                let end = &mut ends[parent];
                let end = if last_child[parent] == n { end.take() } else { end.clone() };
                end.map(|(state, sha256)| (state, Some(sha256)))
            }
        };
        let Some((before, began_with)) = before else { continue };
        let plausible = |stored: &StoredStage| believed::stage(node, &before, stored);
        let asked = AskedStage {
            identity: &node.identity,
            began_with: began_with.as_deref(),
            plausible: &plausible,
        };
        if let Some(stored) = store.sound(&asked) {
            held[n] = true;
            ends[n] = (last_child[n] > n).then_some((stored.state, stored.record.specimen_sha256));
        }
    }
    held
}
