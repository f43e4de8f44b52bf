//! Whether a stored stage, or a checkpoint, can be what it says: compared with
//! its laboratory, its grains and the stage before it.

use super::stage_end::end_of;
use super::*;

/// Times that differ by a smaller share are the same: engines keep the length of
/// a step in single precision.
const ROUNDING: f64 = 1e-6;

/// Whether a stored stage can be that of a node, which went on from a state; says what is wrong.
pub(super) fn stage(
    node: &Node,
    before: &SpecimenState,
    stored: &StoredStage,
) -> Result<(), String> {
    let specimen = Specimen { grains: node.grains.clone(), state: stored.state.clone() };
    stored.state.check(node.grains.grains.len())?;
    plausible(&node.setup, &specimen, 0.0, table_peak(node))?;
    stands(&node.stage, before, &stored.state)?;
    times(&node.stage, before, stored)?;
    let recorded = stored.record.end.ok_or("it does not say how it ended")?;
    end_of(node.setup.gravity, &specimen).is(&recorded)
}

/// The same of a checkpoint of a node's stage.
pub(super) fn midway(node: &Node, before: &SpecimenState, midway: &Midway) -> Result<(), String> {
    let specimen = Specimen { grains: node.grains.clone(), state: midway.state.clone() };
    midway.check(node.grains.grains.len())?;
    if !midway.collar_m.is_finite() {
        return Err("its funnel's collar has no height".to_owned());
    }
    plausible(&node.setup, &specimen, midway.collar_m, table_peak(node))?;
    let began = began(&node.stage, before);
    let now = began + midway.steps as f64 / node.setup.engine.rate_hz;
    same_time("it began", midway.began_s, began)?;
    same_time("it is", midway.state.time, now)
}

/// Peak speed of the table in a node's stage, in m/s.
fn table_peak(node: &Node) -> f64 {
    let step = 1.0 / node.setup.engine.rate_hz;
    let table = node.stage.motion().map_or(0.0, |motion| motion.peak_speed_in_steps(step));
    let pieces = node.stage.piece_motion().map_or(0.0, |motion| {
        let farthest = node
            .setup
            .pieces
            .iter()
            .map(|piece| motion.from_axis(&piece.at.translation.vector.into()) + piece.radius);
        motion.peak_speed(farthest.fold(0.0, f64::max))
    });
    table.max(pieces)
}

/// When a stage began, in s; slow pluviation begins everything.
fn began(stage: &StageSpec, before: &SpecimenState) -> f64 {
    if matches!(stage, StageSpec::SlowPluviation { .. }) { 0.0 } else { before.time }
}

fn same_time(what: &str, found: f64, expected: f64) -> Result<(), String> {
    // Written so that what is no number differs.
    if (found - expected).abs() <= ROUNDING * (1.0 + expected.abs()) {
        return Ok(());
    }
    Err(format!("{what} at {found:.6} s, expected is {expected:.6} s"))
}

/// Whether the pieces of the apparatus stand that a stage leaves.
fn stands(stage: &StageSpec, before: &SpecimenState, after: &SpecimenState) -> Result<(), String> {
    let pieces = |s: &SpecimenState| {
        let closed = s.funnel.map(|f| f.lid);
        (closed, s.cylinder, s.top_plate.is_some(), s.base.is_some())
    };
    let (funnel, cylinder, plate, base) = pieces(before);
    let expected = match stage {
        StageSpec::FillFunnel { .. } => (Some(true), false, plate, base),
        StageSpec::SlowPluviation { .. } => (None, false, false, true),
        StageSpec::Pour { .. } => (None, true, plate, base),
        StageSpec::PlaceTopPlate { .. } => (funnel, cylinder, true, base),
        _ => (funnel, cylinder, plate, base),
    };
    if pieces(after) == expected {
        return Ok(());
    }
    Err("other pieces of the apparatus stand than its stage leaves".to_owned())
}

/// Whether it went on from the stage before, for as long as it says, and its series with it.
fn times(stage: &StageSpec, before: &SpecimenState, stored: &StoredStage) -> Result<(), String> {
    let end = began(stage, before) + stored.record.simulated_s;
    same_time("it ended", stored.state.time, end)?;
    let (first, last) = (stored.series.first(), stored.series.last());
    let (first, last) = first.zip(last).ok_or("its series has no rows")?;
    same_time("its series begins", first.time_s, before.time)?;
    same_time("its series ends", last.time_s, before.time + stored.record.simulated_s)
}

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
            None => Some(match &node.begun {
                Some(begun) => (begun.state.clone(), Some(begun.record.specimen_sha256.clone())),
                None => (SpecimenState::before_everything(node.grains.grains.len()), None),
            }),
            Some(parent) => {
                let end = &mut ends[parent];
                let end = if last_child[parent] == n { end.take() } else { end.clone() };
                end.map(|(state, sha256)| (state, Some(sha256)))
            }
        };
        let Some((before, began_with)) = before else { continue };
        let plausible = |stored: &StoredStage| stage(node, &before, stored);
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

#[cfg(test)]
#[path = "believed_tests.rs"]
mod tests;
