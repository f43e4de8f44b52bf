//! What a pile stands on: how it is made, and the bodies it is made of.

use std::sync::Arc;

use super::*;
use crate::apparatus::round_floor;
use crate::grains::streams::{below, rotation};
use crate::scenario::{BaseKind, BaseSpec};
use crate::specimen::{Base, FixedGrain};

/// The base of a scenario, of the given radius in m.
///
/// Fixed grains stand on the points of a triangular lattice whose pitch is the mean equivalent
/// diameter, about as close as a layer of grains lies. Which grain it is and how it is turned are
/// random, by a stream of this configuration; the middle of its height lies at z = 0, so that it is
/// sunk into the floor by half. Neighbours may overlap: they are one solid.
pub(super) fn build(
    spec: &BaseSpec,
    radius: f64,
    grains: &GrainSet,
    seed: u64,
    configuration: u32,
) -> Base {
    let fixed_grains = match spec.kind {
        BaseKind::Plane => Vec::new(),
        BaseKind::FixedGrains => fixed_grains(radius, grains, seed, configuration),
    };
    Base { radius, friction: spec.friction, fixed_grains }
}

fn fixed_grains(radius: f64, set: &GrainSet, seed: u64, configuration: u32) -> Vec<FixedGrain> {
    let count = set.grains.len();
    let pitch = set.grains.iter().map(|g| g.equivalent_diameter).sum::<f64>() / count as f64;
    if !(pitch > 0.0) {
        return Vec::new();
    }
    let mut rng = stream(seed, &format!("fixed grains of the base of mixing {configuration}"));
    let row_pitch = pitch * 3f64.sqrt() / 2.0;
    let rows = (radius / row_pitch) as i32;
    let mut fixed = Vec::new();
    for row in -rows..=rows {
        let y = f64::from(row) * row_pitch;
        // Every second row is shifted by half a pitch.
        let shift = if row % 2 == 0 { 0.0 } else { pitch / 2.0 };
        let columns = (radius / pitch) as i32 + 1;
        for column in -columns..=columns {
            let x = f64::from(column) * pitch + shift;
            if x * x + y * y > radius * radius {
                continue;
            }
            let grain = below(&mut rng, count as u64) as usize;
            let turn = rotation(&mut rng);
            let turned = Pose::from_parts(nalgebra::Translation3::identity(), turn);
            let (low, high) = set.grains[grain].shape.heights(&turned);
            let z = -f64::midpoint(low, high);
            fixed.push(FixedGrain {
                grain,
                pose: Pose::from_parts(nalgebra::Translation3::new(x, y, z), turn),
            });
        }
    }
    fixed
}

/// The bodies of a pile's base, the floor last; none where there is no base.
///
/// # Errors
/// When the floor cannot be built.
pub fn base_pieces(
    grains: &GrainSet,
    base: Option<&Base>,
) -> Result<Vec<(Piece, Material)>, ApparatusError> {
    let Some(base) = base else { return Ok(Vec::new()) };
    let mut pieces: Vec<(Piece, Material)> = base
        .fixed_grains
        .iter()
        .map(|fixed| {
            let shape = Arc::clone(&grains.grains[fixed.grain].shape);
            (Piece { shape, pose: fixed.pose }, Material::Grain)
        })
        .collect();
    let material = if base.friction.is_some() { Material::Wall } else { Material::Grain };
    pieces.push((round_floor(base.radius, grains.of_size(&scale::FLOOR_THICKNESS))?, material));
    Ok(pieces)
}

/// Friction coefficient between two parties of a specimen's contacts.
pub fn friction_between(setup: &Setup, state: &SpecimenState) -> impl Fn(&[Party; 2]) -> f64 {
    let pairs = pairs(setup, state);
    let materials = setup.piece_materials.clone();
    let base = state.base.as_ref().map(|base| (base.fixed_grains.len(), base.friction.is_some()));
    let material = move |party: &Party| match party {
        Party::Grain(_) => Material::Grain,
        Party::Other(Other::TopPlate) => Material::Plate,
        Party::Other(Other::Cylinder(_) | Other::Funnel(_)) => Material::Wall,
        Party::Other(Other::Piece(n, _)) => materials.get(*n).copied().unwrap_or(Material::Wall),
        // As in [`base_pieces`]: the fixed grains, and the floor last.
        Party::Other(Other::Base(n)) => match base {
            Some((fixed, true)) if *n >= fixed => Material::Wall,
            _ => Material::Grain,
        },
    };
    move |between| pairs.get(material(&between[0]), material(&between[1])).friction
}

/// The pairs of a laboratory with what the specimen stands on: a plane base has
/// a friction of its own.
pub fn pairs(setup: &Setup, state: &SpecimenState) -> PairTable {
    let mut pairs = setup.pairs.clone();
    if let Some(friction) = state.base.as_ref().and_then(|base| base.friction) {
        let mut of_floor = pairs.get(Material::Grain, Material::Wall);
        of_floor.friction = friction;
        pairs.set(Material::Grain, Material::Wall, of_floor);
    }
    pairs
}
