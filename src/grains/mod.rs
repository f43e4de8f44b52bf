//! Grains: particle size distribution, Voronoi cells, mixing, `grains.json`.

use std::sync::Arc;

use crate::geometry::{ConvexPolyhedron, Pose, Vector};

/// The grains of an experiment, in the order in which the tessellation made them.
#[derive(Debug, Clone, PartialEq)]
pub struct GrainSet {
    /// The grains.
    pub grains: Vec<Grain>,
    /// The blocks they were cut from, for `grains.json`.
    pub blocks: Vec<Block>,
    /// Density of the solids in kg/m³.
    pub density: f64,
}

/// One cube of a sieve fraction's solid volume and the points of its tessellation.
#[derive(Debug, Clone, PartialEq)]
pub struct Block {
    /// Opening of the sieve the fraction passes, in m.
    pub passing: f64,
    /// Opening of the sieve that retains the fraction, in m.
    pub retained: f64,
    /// Side of the cube in m.
    pub side: f64,
    /// Lowest corner of the cube in m.
    pub origin: Vector,
    /// Points of the tessellation, one a cell, in m.
    pub points: Vec<Vector>,
    /// Index of the block's first grain in the grain set.
    pub first_grain: usize,
}

/// One grain: a rigid homogeneous convex polyhedron.
#[derive(Debug, Clone, PartialEq)]
pub struct Grain {
    /// Shape with the centroid at the origin and the principal axes of
    /// inertia along x, y, z, in m; moments ascending.
    pub shape: Arc<ConvexPolyhedron>,
    /// Maps the principal frame to the block's coordinates.
    pub pose_in_block: Pose,
    /// Volume in m³.
    pub volume: f64,
    /// Mass in kg.
    pub mass: f64,
    /// Principal moments of inertia in kg m².
    pub inertia: Vector,
    /// Diameter of the sphere of the same volume, in m.
    pub equivalent_diameter: f64,
    /// Index of the sieve fraction (block) it belongs to.
    pub fraction: usize,
}

pub struct Mixing {
    pub order: Vec<usize>,
    pub orientations: Vec<nalgebra::UnitQuaternion<f64>>,
}
pub fn mix(_: &GrainSet, _: u64, _: u32) -> Mixing {
    unimplemented!()
}
pub fn rain(_: &GrainSet, _: &Mixing, _: f64, _: f64, _: u64) -> Result<Vec<Pose>, String> {
    unimplemented!()
}
