//! Pieces that move freely, and pieces of several parts that are one body of a world.

use super::*;
use crate::specimen::FreeState;
use crate::world::World;

/// A piece that moves freely: its number and its body.
#[derive(Debug, Clone, Copy)]
pub(super) struct Free {
    piece: usize,
    body: BodyId,
    /// Where its centre of mass and its principal axes are in the frame of the piece.
    frame: Pose,
    /// Principal moments of inertia in kg m².
    inertia: Vector,
}

impl Free {
    /// A piece that is in a world as a body, with the state that it is in.
    pub(super) fn new(n: usize, piece: &RigidPiece, free: &FreeState, body: BodyId) -> Self {
        let (frame, moments) = piece.principal_frame();
        Self { piece: n, body, frame, inertia: moments * free.mass_kg }
    }

    /// Reads where the last step left it.
    pub(super) fn read(
        &self,
        world: &dyn World,
        state: &mut SpecimenState,
    ) -> Result<(), WorldError> {
        let piece = &mut state.pieces[self.piece];
        if let Some(free) = &mut piece.free {
            free.body = world.read_body(self.body)?;
            piece.pose = free.body.pose * self.frame.inverse();
        }
        Ok(())
    }

    /// Its mass in kg, principal moments of inertia in kg m² and motion.
    pub(super) fn moving<'a>(
        &'a self,
        state: &'a SpecimenState,
    ) -> Option<(f64, &'a Vector, &'a BodyState)> {
        let free = state.pieces[self.piece].free.as_ref()?;
        Some((free.mass_kg, &self.inertia, &free.body))
    }

    /// Why it cannot go on from here, by the names of pieces: nothing carries it above a height in
    /// m, or its centre of mass is within another piece.
    pub(super) fn lost(
        &self,
        setup: &Setup,
        solids: &Solids,
        lowest: f64,
        state: &SpecimenState,
    ) -> Option<String> {
        let centre = state.pieces[self.piece].free.as_ref()?.body.pose.translation.vector;
        let piece = &setup.pieces[self.piece];
        if centre.z + 2.0 * piece.radius < lowest {
            return Some(format!("`{}` fell below all other pieces", piece.name));
        }
        let inside = solids.holding(&centre, state).find(|n| *n != self.piece)?;
        Some(format!("`{}` got into `{}`", piece.name, setup.pieces[inside].name))
    }
}

/// How a piece begins to move freely, with a mass in kg, where it is.
pub(super) fn released(piece: &RigidPiece, state: &PieceState, mass_kg: f64) -> FreeState {
    let (frame, _) = piece.principal_frame();
    FreeState { mass_kg, body: BodyState::at_rest(state.pose * frame) }
}

/// How deep in m a piece may be in another that carries it, or that it leans on, by the springs of
/// their contacts: within the margin of contacts, or as far as all its load presses one point; in
/// kg, what weighs on it.
pub(super) fn sunk_at_rest(setup: &Setup, load_kg: f64) -> f64 {
    let by_load = load_kg * setup.gravity / setup.engine.native.contact_stiffness_n_per_m;
    scale::CONTACT_MARGIN.at(&setup.scale).max(by_load)
}

/// Puts a piece into a world as one body: each part in the frame of the whole, which a free piece
/// has in its centre of mass. Gives the parts' bodies, that of the whole first.
pub(super) fn add_whole(
    world: &mut dyn World,
    piece: &RigidPiece,
    material: Material,
    at: &PieceState,
    motion: Motion,
    velocity: [Vector; 2],
) -> Result<Vec<BodyId>, WorldError> {
    let (frame, motion, state) = match at.free {
        Some(free) => {
            let (frame, moments) = piece.principal_frame();
            let inertia = moments * free.mass_kg;
            (frame, Motion::Free { mass: free.mass_kg, inertia }, free.body)
        }
        None => {
            let [linear_velocity, angular_velocity] = velocity;
            let state =
                BodyState { linear_velocity, angular_velocity, ..BodyState::at_rest(at.pose) };
            (Pose::identity(), motion, state)
        }
    };
    let mut bodies: Vec<BodyId> = Vec::new();
    for part in &piece.parts {
        let shape = part.shape.transformed(&(frame.inverse() * part.pose)).into();
        let of_part = match (bodies.first(), motion) {
            (None, motion) | (Some(_), motion @ Motion::Free { .. }) => motion,
            _ => Motion::Kinematic,
        };
        let body = Body { shape, material, state, ..wall_piece(part, of_part) };
        let id = world.add(&body)?;
        if let Some(whole) = bodies.first() {
            world.join(id, *whole)?;
        }
        bodies.push(id);
    }
    Ok(bodies)
}

/// The height in m below which nothing reaches that does not fall, or nothing at all where all
/// pieces fall.
pub(super) fn lowest_of(reach: impl Iterator<Item = (bool, f64)>) -> f64 {
    let (still, free) =
        reach.fold((f64::INFINITY, f64::INFINITY), |(still, free), (falls, low)| {
            if falls { (still, low.min(free)) } else { (low.min(still), free) }
        });
    if still.is_finite() { still } else { free }
}
