//! From what is in the laboratory to the bodies of a world.

use super::*;
use crate::world::RememberedContact;

/// Saved contacts in terms of a new world's bodies, without those of what is not in it.
pub fn remembered(
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

/// What a reader knows a body as, by what it is.
pub(super) fn name_of(party: &Party, setup: &Setup) -> String {
    match *party {
        Party::Grain(n) => grain_name(n),
        Party::Other(Other::TopPlate) => "the top plate".to_owned(),
        Party::Other(Other::Cylinder(_)) => "the cylinder".to_owned(),
        Party::Other(Other::Funnel(_)) => "the funnel".to_owned(),
        Party::Other(Other::Base(_)) => "the base".to_owned(),
        Party::Other(Other::Piece(n, _)) => match setup.pieces.get(n) {
            Some(piece) => format!("`{}`", piece.name),
            None => format!("piece {n}"),
        },
    }
}

/// A grain as a free body.
pub fn free_grain(grain: &Grain, state: BodyState) -> Body {
    Body {
        shape: grain.shape.clone(),
        motion: Motion::Free { mass: grain.mass, inertia: grain.inertia },
        material: Material::Grain,
        state,
    }
}

/// A piece of walls as a body.
pub fn wall_piece(piece: &Piece, motion: Motion) -> Body {
    Body {
        shape: piece.shape.clone(),
        motion,
        material: Material::Wall,
        state: BodyState::at_rest(piece.pose),
    }
}

/// Where a piece is that stands on the table, at a displacement in m.
pub(super) fn moved(at_rest: &Pose, by: &Vector) -> Pose {
    let mut pose = *at_rest;
    pose.translation.vector += by;
    pose
}

/// A place as it is above a table that is off along x alone.
pub(super) fn level(place: Vector, state: &SpecimenState) -> Vector {
    place - Vector::new(0.0, state.table_y, state.table_z)
}

/// Energy in J that loaded contacts hold as springs, ½ f²/k of each normal force; 0 for engines
/// whose contacts are none.
pub fn spring_energy(contacts: &[SavedContact], engine: &EngineSettings) -> f64 {
    let stiffness = engine.native.contact_stiffness_n_per_m;
    contacts.iter().map(|c| c.force_n.dot(&c.normal).powi(2)).sum::<f64>() / (2.0 * stiffness)
}
