//! From what is in the laboratory to the bodies of a world.

use std::collections::HashMap;

use crate::apparatus::Piece;
use crate::grains::Grain;
use crate::specimen::{Party, SavedContact};
use crate::world::{Body, BodyId, BodyState, Material, Motion, RememberedContact};

/// Saved contacts in terms of a new world's bodies, without those of what is
/// not in it.
pub(super) fn remembered(
    contacts: &[SavedContact],
    parties: &HashMap<Party, BodyId>,
) -> Vec<RememberedContact> {
    let contacts = contacts.iter().filter_map(|c| {
        Some(RememberedContact {
            a: *parties.get(&c.between[0])?,
            b: *parties.get(&c.between[1])?,
            point: c.point_m,
            normal: c.normal,
            force: c.force_n,
            warm_start: c.warm_start,
            feature: c.feature,
        })
    });
    contacts.collect()
}

/// A grain that moves freely.
pub(super) fn free_grain(grain: &Grain, state: BodyState) -> Body {
    Body {
        shape: grain.shape.clone(),
        motion: Motion::Free { mass: grain.mass, inertia: grain.inertia },
        material: Material::Grain,
        state,
    }
}

/// A piece of the apparatus.
pub(super) fn wall_piece(piece: &Piece, motion: Motion) -> Body {
    Body {
        shape: piece.shape.clone(),
        motion,
        material: Material::Wall,
        state: BodyState::at_rest(piece.pose),
    }
}
