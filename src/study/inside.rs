//! What a specimen is inside: its contacts, its voids by height and by radius, and what became of
//! energy and orientations from stage to stage.

use super::laboratory::{balance, regions};
use super::*;
use crate::measure::{Region, Slice, layers, loaded_contacts, rings, rotations};
use crate::protocol::friction_between;
use crate::record::{ContactsSummary, CoreSummary, RotationSummary, StageEnergy, StageSummary};
use crate::specimen::{Other, Party, SavedContact};
use crate::units::to_mm3;

/// Layers and rings are at most this share of a median grain wide: voids order themselves along
/// walls grain by grain.
const SLICE: f64 = 0.5;

/// Layers and rings of a profile, at most.
const MOST_SLICES: usize = 400;

/// Distance in median grains from a wall, a floor or a surface within which grains lie otherwise than
/// inside.
const EDGE: f64 = 2.0;

/// The specimen with its contacts at rest: at the end of the rest test where one is run.
pub(super) struct AtRest {
    /// It.
    pub specimen: Specimen,
    /// Its loaded contacts.
    pub contacts: Vec<LoadedContact>,
}

impl AtRest {
    /// Of the state at the end of the last stage, and the rest test.
    pub(super) fn of(setup: &Setup, last: &Specimen, rest_test: Option<&StoredStage>) -> Self {
        let state = rest_test.map_or(&last.state, |stage| &stage.state);
        let state = state.on_level_table().into_owned();
        let contacts = loaded_contacts(&state.contacts, friction_between(setup, &state));
        Self { specimen: Specimen { grains: last.grains.clone(), state }, contacts }
    }

    /// None where the engine gave no contacts.
    pub(super) fn summary(&self, setup: &Setup) -> Option<ContactsSummary> {
        let state = &self.specimen.state;
        if state.contacts.is_empty() {
            return None;
        }
        let plate = state.top_plate.map_or(0.0, |_| setup.plate.mass);
        let grains = &self.specimen.grains.grains;
        let mass: f64 = self.specimen.present().map(|i| grains[i].mass).sum();
        let balance = balance((mass + plate) * setup.gravity, &force_on_apparatus(state));
        Some(ContactsSummary::of(&self.contacts, self.specimen.present().count(), balance))
    }
}

/// Force in N of grains and plate on all that stands.
fn force_on_apparatus(state: &SpecimenState) -> Vector {
    let stands = |party: &Party| matches!(party, Party::Other(other) if *other != Other::TopPlate);
    let on =
        |contact: &SavedContact| match (stands(&contact.between[0]), stands(&contact.between[1])) {
            (true, false) => contact.force_n,
            (false, true) => -contact.force_n,
            _ => Vector::zeros(),
        };
    state.contacts.iter().map(on).sum()
}

/// Void ratio by height and by radius of what lies in the built-in cylinder, up to its mean
/// surface in m; by height of the regions of a laboratory. Nothing of a pile.
pub(super) fn void_profile(
    setup: &Setup,
    specimen: &Specimen,
    container: &Container,
    surface: f64,
) -> Vec<ProfileRow> {
    let specimen = &*specimen.on_level_table();
    let grain = setup.scale.sizes.median;
    let count =
        |length: f64| ((length / (SLICE * grain)).ceil().max(1.0) as usize).min(MOST_SLICES);
    let rows = |of: &str, by: &'static str, slices: Vec<Slice>| -> Vec<ProfileRow> {
        let row = |slice: Slice| ProfileRow {
            of: of.to_owned(),
            by,
            from_mm: to_mm(slice.from),
            to_mm: to_mm(slice.to),
            middle_mm: to_mm(f64::midpoint(slice.from, slice.to)),
            void_ratio: slice.void_ratio(),
            solids_mm3: to_mm3(slice.solids),
        };
        slices.into_iter().map(row).collect()
    };
    if !setup.pieces.is_empty() {
        let named = setup.measures.regions.iter().zip(regions(setup));
        let of_region = named.flat_map(|(spec, region)| {
            let present: Vec<usize> = specimen.present().collect();
            let height = region.high.z - region.low.z;
            rows(&spec.name, "height", slices_of(specimen, &present, &region, count(height)))
        });
        return of_region.collect();
    }
    if specimen.state.base.is_some() || !(surface > 0.0) {
        return Vec::new();
    }
    let members = container.members(specimen);
    let by_height = layers(specimen, &members, container.area(), (0.0, surface), count(surface));
    // Floor and surface have voids of their own.
    let off = if surface > 4.0 * grain { grain } else { 0.0 };
    let axis = (container.centre_x, container.radius);
    let by_radius = rings(specimen, &members, axis, (off, surface - off), count(container.radius));
    [rows("specimen", "height", by_height), rows("specimen", "radius", by_radius)].concat()
}

fn slices_of(specimen: &Specimen, grains: &[usize], region: &Region, count: usize) -> Vec<Slice> {
    let edge = |n: usize| region.low.z + (region.high.z - region.low.z) * n as f64 / count as f64;
    let slice = |n: usize| {
        let (mut part, from, to) = (*region, edge(n), edge(n + 1));
        (part.low.z, part.high.z) = (from, to);
        let solid = |&i: &usize| {
            let pose = &specimen.state.bodies[i].body.pose;
            part.volume_of(&specimen.grains.grains[i].shape, pose)
        };
        Slice { from, to, volume: part.volume(), solids: grains.iter().map(solid).sum() }
    };
    (0..count).map(slice).collect()
}

/// The middle of what lies in the built-in cylinder: the largest box about its axis that keeps two
/// median grains off wall, floor and mean surface, in m. `None` where none is left that is as wide
/// and as high as one grain, and of anything else than a cylinder.
pub(super) fn core(
    setup: &Setup,
    at_rest: &AtRest,
    container: &Container,
    surface: f64,
) -> Option<CoreSummary> {
    let specimen = &at_rest.specimen;
    if !specimen.state.cylinder || specimen.state.base.is_some() || !setup.pieces.is_empty() {
        return None;
    }
    let grain = setup.scale.sizes.median;
    let off = EDGE * grain;
    let half = (container.radius - off) / 2f64.sqrt();
    if 2.0 * half < grain || surface - 2.0 * off < grain {
        return None;
    }
    let x = container.centre_x;
    let region =
        Region { low: [x - half, -half, off].into(), high: [x + half, half, surface - off].into() };
    let inside = contacts_of_grains_in(&at_rest.contacts, &region);
    Some(CoreSummary {
        low_mm: region.low.map(to_mm).into(),
        high_mm: region.high.map(to_mm).into(),
        void_ratio: void_ratio_in(specimen, &region),
        stress: stress_in(specimen, &region).map(|stress| StressSummary::of(&stress)),
        fabric: fabric(inside).map(|fabric| FabricSummary::of(&fabric)),
    })
}

/// Energy at every row of the series of stages; nothing of a stage that was stored before it was
/// recorded.
pub(super) fn energy_rows(stages: &[&StoredStage]) -> Vec<Option<EnergyRow>> {
    let of = |stage: &&StoredStage| -> Vec<Option<EnergyRow>> {
        let energy = &stage.record.energy;
        match energy.len() == stage.series.len() {
            true => energy.iter().copied().map(Some).collect(),
            false => vec![None; stage.series.len()],
        }
    };
    stages.iter().flat_map(of).collect()
}

/// What each stage was given and what became of it; `begun` is the specimen of another run that the
/// first one began with.
pub(super) fn stage_summaries(
    specs: &[StageSpec],
    stages: &[&StoredStage],
    begun: Option<&SpecimenState>,
    setup: &Setup,
) -> Vec<StageSummary> {
    let before = std::iter::once(begun).chain(stages.iter().map(|stage| Some(&stage.state)));
    let of = |((spec, stage), before): ((&StageSpec, &&StoredStage), Option<&SpecimenState>)| {
        let energy = stage.record.energy.last().zip(stage.series.last());
        let turned = before.map(|before| rotations(before, &stage.state)).unwrap_or_default();
        StageSummary {
            stage: stage.record.stage.clone(),
            duration_s: stage.record.simulated_s,
            energy: energy.map(|(energy, row)| StageEnergy {
                work_input_j: energy.work_input_j,
                dissipated_j: energy.dissipated_j,
                potential_energy_j: energy.potential_energy_j,
                kinetic_energy_j: row.kinetic_energy_j,
            }),
            rotation: RotationSummary::of(turned.into_iter().flatten()),
            until: stage.record.until.clone(),
            settling: stage.record.settling,
            fall: stage.record.fall,
            motion: motions::of_pieces(spec, setup),
        }
    };
    specs.iter().zip(stages).zip(before).map(of).collect()
}

/// By which angle in rad each grain turned in the last of the stages, of which the first may have
/// begun with the specimen of another run; nothing where there is none before it.
pub(super) fn turned_in_last(
    stages: &[&StoredStage],
    begun: Option<&SpecimenState>,
) -> Vec<Option<f64>> {
    match (stages, begun) {
        ([.., before, last], _) => rotations(&before.state, &last.state),
        ([last], Some(before)) => rotations(before, &last.state),
        _ => Vec::new(),
    }
}

/// The grains with the state at the end of the last stage.
pub(super) fn at_end(grains: &Arc<GrainSet>, stages: &[&StoredStage]) -> Specimen {
    let state = stages.last().map_or_else(
        || SpecimenState::before_everything(grains.grains.len()),
        |stage| stage.state.clone(),
    );
    Specimen { grains: grains.clone(), state }
}

#[cfg(test)]
mod tests {
    use nalgebra::UnitQuaternion;

    use super::*;
    use crate::study::tests::scenario;

    /// Law: what stands is pressed by what does not, whichever of the two is named first; grains
    /// and plate among themselves press nothing that stands.
    #[test]
    fn the_apparatus_bears_what_presses_it() {
        let contact = |a: Party, b: Party, force: f64| SavedContact {
            between: [a, b],
            point_m: Vector::zeros(),
            normal: Vector::z(),
            force_n: Vector::z() * force,
            warm_start: 1.0,
            feature: [0, 0],
        };
        let other = Party::Other;
        let mut state = SpecimenState::before_everything(2);
        state.contacts = vec![
            contact(Party::Grain(0), other(Other::Cylinder(3)), 1.0),
            contact(other(Other::Base(0)), Party::Grain(1), -2.0),
            contact(other(Other::TopPlate), other(Other::Cylinder(1)), 4.0),
            contact(Party::Grain(0), Party::Grain(1), 8.0),
            contact(other(Other::TopPlate), Party::Grain(1), 16.0),
        ];
        assert_eq!(force_on_apparatus(&state), Vector::z() * -7.0);
    }

    /// Law: the first stage of a run that begins with a specimen turns its grains from how they lay
    /// in that; without one, nothing is known of how they lay.
    #[test]
    fn the_first_stage_turns_the_grains_of_a_begun_specimen() {
        let begun = SpecimenState::before_everything(2);
        let mut state = begun.clone();
        state.bodies[0].body.pose.rotation =
            UnitQuaternion::from_axis_angle(&Vector::z_axis(), 0.5);
        let series = Vec::new();
        let stage = StoredStage { record: StageRecord::default(), state, series };
        let scenario = scenario(50.0);
        let setup = Setup::new(&scenario).expect("a laboratory");
        for (begun, expected) in [(Some(&begun), Some(0.5_f64)), (None, None)] {
            let got = turned_in_last(&[&stage], begun);
            let got = got.first().map(|turn| turn.expect("law: it is present"));
            assert_eq!(got.is_some(), expected.is_some(), "law: an angle, or none");
            let off = got.zip(expected).map_or(0.0, |(got, expected)| (got - expected).abs());
            assert!(off < 1e-9, "law: 0.5 rad, got {got:?}, tolerance 1e-9 rad");
            let rest = [StageSpec::Rest { duration_s: 1.0 }];
            let of_stage = stage_summaries(&rest, &[&stage], begun, &setup).remove(0).rotation;
            let largest = of_stage.map(|of| of.max_deg.to_radians());
            let off = largest.zip(got).map_or(0.0, |(a, b): (f64, f64)| (a - b).abs());
            assert!(
                largest.is_some() == got.is_some() && off < 1e-12,
                "law: the same, {of_stage:?}"
            );
        }
    }
}
