//! The pieces of the apparatus that stand around a specimen, with their names.

use super::*;

/// What a piece of the apparatus stands on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Carrier {
    /// It never moves.
    Fixed,
    /// It goes with the shaking table.
    Table,
    /// It moves as a stage of its laboratory prescribes.
    Kinematic,
}

/// A piece of the apparatus where it is now.
#[derive(Debug, Clone, PartialEq)]
pub struct StandingPiece {
    /// `cylinder_00` and so on, `floor`, `funnel_00` and so on, `lid`;
    /// `base_0000` and so on, the last of them the floor under a pile; of a piece of a
    /// laboratory its own with the number of the part.
    pub name: String,
    /// What carries it.
    pub carrier: Carrier,
    /// What it is made of.
    pub material: Material,
    /// Shape and pose, the displacement of the table included, in m.
    pub piece: Piece,
}

/// The pieces that stand in this state: cylinder with floor, funnel, lid, a pile's
/// base. The top plate is a free body and none of them; the collar that funnels have
/// while they are filled is left out.
///
/// # Errors
/// When the funnel's dimensions make no funnel.
pub fn standing(
    setup: &Setup,
    grains: &GrainSet,
    state: &SpecimenState,
) -> Result<Vec<StandingPiece>, ApparatusError> {
    let mut found = Vec::new();
    let mut add = |what: Other, carrier: Carrier, material: Material, piece: Piece| {
        let name = party_name(setup, Party::Other(what));
        found.push(StandingPiece { name, carrier, material, piece });
    };
    let base = base_pieces(grains, state.base.as_ref())?;
    for (n, (piece, material)) in base.into_iter().enumerate() {
        add(Other::Base(n), Carrier::Fixed, material, piece);
    }
    if state.cylinder {
        for (n, piece) in setup.cylinder.pieces.iter().enumerate() {
            let mut piece = piece.clone();
            piece.pose.translation.vector += state.table();
            add(Other::Cylinder(n), Carrier::Table, Material::Wall, piece);
        }
    }
    for (n, (piece, at)) in setup.pieces.iter().zip(&state.pieces).enumerate() {
        for (k, part) in piece.parts.iter().enumerate().filter(|_| at.present) {
            let placed = Piece { pose: at.pose * part.pose, ..part.clone() };
            add(Other::Piece(n, k), Carrier::Kinematic, setup.piece_materials[n], placed);
        }
    }
    if let Some(stands) = state.funnel {
        let funnel = Funnel::new(&setup.funnel, stands.opening_height, 0.0)?;
        for (n, piece) in funnel.pieces.into_iter().enumerate() {
            add(Other::Funnel(n), Carrier::Fixed, Material::Wall, piece);
        }
        if stands.lid {
            // Behind its walls and the collar.
            let lid = 2 * setup.funnel.wall_pieces as usize;
            add(Other::Funnel(lid), Carrier::Fixed, Material::Wall, funnel.lid);
        }
    }
    Ok(found)
}

/// Name of who takes part in a contact, as bodies are named in the files.
pub(super) fn party_name(setup: &Setup, party: Party) -> String {
    let walls = setup.cylinder.pieces.len().saturating_sub(1);
    // A funnel stands without its collar in what is exported; its pieces come
    // first, and the lid is the last.
    let funnel = setup.funnel.wall_pieces as usize;
    match party {
        Party::Grain(n) => grain_name(n),
        Party::Other(Other::TopPlate) => "top_plate".to_owned(),
        Party::Other(Other::Cylinder(n)) if n == walls => "floor".to_owned(),
        Party::Other(Other::Cylinder(n)) => format!("cylinder_{n:02}"),
        Party::Other(Other::Funnel(n)) if n < funnel => format!("funnel_{n:02}"),
        Party::Other(Other::Funnel(n)) if n < 2 * funnel => format!("collar_{:02}", n - funnel),
        Party::Other(Other::Funnel(_)) => "lid".to_owned(),
        Party::Other(Other::Base(n)) => format!("base_{n:04}"),
        Party::Other(Other::Piece(piece, part)) => match setup.pieces.get(piece) {
            Some(piece) => piece.part_name(part),
            None => format!("piece_{piece}_{part:02}"),
        },
    }
}
