//! Cylinder, funnel, lid and top plate, and pieces of other laboratories, as pure geometry.
//!
//! Coordinates: the cylinder's axis is z, its floor lies at z = 0, gravity
//! acts along -z, the table shakes along x.

mod overlap;
mod pieces;
mod walls;

pub use overlap::{depth_in_others, overlapping, overlaps, stands_in};
pub use pieces::RigidPiece;
pub use walls::{Cylinder, Funnel, TopPlate, round_floor};

use std::sync::Arc;

use crate::geometry::{ConvexPolyhedron, PolyhedronError, Pose};

/// A solid convex piece of an apparatus, at its pose.
#[derive(Debug, Clone, PartialEq)]
pub struct Piece {
    /// Shape around the origin, in m.
    pub shape: Arc<ConvexPolyhedron>,
    /// Where the shape stands.
    pub pose: Pose,
}

/// Dimensions that make no apparatus.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("the {part} cannot be built: {reason}")]
pub struct ApparatusError {
    /// Which part.
    pub part: &'static str,
    /// What is wrong with it.
    pub reason: ApparatusFault,
}

/// What can be wrong with an apparatus.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ApparatusFault {
    /// A part is no convex solid.
    #[error(transparent)]
    Shape(#[from] PolyhedronError),
    /// Pieces stand within each other.
    #[error(
        "pieces overlap: {0} (allowed: pieces that touch or stand apart, or `may_cross` of one of them)"
    )]
    Overlap(String),
}
