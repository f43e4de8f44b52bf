//! Grains: particle size distribution, Voronoi cells, mixing, `grains.json`.

mod file;
mod gradation;
mod make;
pub mod mesh;
mod mixing;
mod psd;
mod streams;
#[cfg(test)]
mod tests;
mod voronoi;

pub use file::{BlockJson, CellJson, GrainsJson, SieveJson, from_json, to_json};
pub use gradation::{Gradation, SieveRow};
pub use make::generate;
pub use mixing::{Mixing, mix, rain};
pub use psd::{Fraction, ParticleSizeDistribution};

use std::sync::Arc;

use crate::geometry::{ConvexPolyhedron, PolyhedronError, Pose, Vector};

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
    /// The same in the block's coordinates, as it was cut.
    pub cell: Arc<ConvexPolyhedron>,
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

/// Why grains could not be made, read or placed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum GrainsError {
    /// A fraction's mass makes no whole grain of its size.
    #[error(
        "the fraction {passing_mm}-{retained_mm} mm does not hold a single grain of its mean size"
    )]
    EmptyFraction {
        /// Opening of the sieve it passes, in mm.
        passing_mm: f64,
        /// Opening of the sieve that retains it, in mm.
        retained_mm: f64,
    },
    /// A point of the tessellation cannot be used.
    #[error("tessellation point {index}: {reason}")]
    Points {
        /// Index of the point.
        index: usize,
        /// Why.
        reason: &'static str,
    },
    /// A cell is no sound polyhedron.
    #[error("cell {cell}: {reason}")]
    Cell {
        /// Index of the cell in its block.
        cell: usize,
        /// What is wrong with it.
        reason: PolyhedronError,
    },
    /// Grains in a file are not sound.
    #[error("{path}: {reason}")]
    File {
        /// Path of the value in the file.
        path: String,
        /// What is wrong with it.
        reason: String,
    },
    /// A grain does not fit where it should be placed.
    #[error("grain {grain} with a bounding radius of {radius} m does not fit into {room} m")]
    TooNarrow {
        /// Index of the grain.
        grain: usize,
        /// Its bounding radius in m.
        radius: f64,
        /// The room there is, in m.
        room: f64,
    },
}

impl GrainSet {
    /// Mass of all grains in kg.
    pub fn mass(&self) -> f64 {
        self.grains.iter().map(|g| g.mass).sum()
    }

    /// Volume of all grains in m³.
    pub fn volume(&self) -> f64 {
        self.grains.iter().map(|g| g.volume).sum()
    }

    /// Mean number of grains in 100 g.
    pub fn grains_in_100_g(&self) -> f64 {
        self.grains.len() as f64 * 0.1 / self.mass()
    }
}
