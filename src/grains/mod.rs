//! Grains: particle size distribution, Voronoi cells, realisations, `grains.json`.
//!
//! [`generate`] turns a sieve table into a [`GrainSet`]; [`mix`] and [`rain`]
//! put it into another order, other orientations and apart from each other,
//! ready to fall; [`read_json`] and [`write_json`] keep it in a file.

mod analysis;
mod cell_shape;
mod complex;
mod error;
mod fan;
mod file;
mod generate;
mod gradation;
mod mesh;
mod meshes;
pub mod psd;
mod realisation;
mod shape;
mod sieve;
mod sieve_memory;
mod sieve_table;
mod sizes;
mod spheres;
pub mod streams;
pub mod voronoi;

pub use analysis::{SieveAnalysis, Sieved};
pub use error::GrainsError;
pub use file::{
    BlockJson, CellJson, GrainsJson, SieveJson, from_json, read_json, to_json, write_json,
};
pub use generate::generate;
pub use gradation::Gradation;
pub use mesh::{obj_of, write_obj, write_ply, write_ply_of, write_stl, write_stl_of};
pub use meshes::{MeshRecord, from_meshes, meshes_csv, parts_of_piece};
pub use psd::{Fraction, ParticleSizeDistribution};
pub use realisation::{Realisation, mix, rain};
pub use shape::{GrainShape, ShapeRatio};
pub use sieve::{Passage, SIEVE_TOLERANCE};
pub use sieve_memory::{sieve_size, sieve_size_of};
pub use sieve_table::{sieve_csv, table_csv};
pub use sizes::{load_grains, load_scenario};

// What its parts are made of, too.
use std::collections::HashMap;
use std::sync::Arc;

use rand_pcg::Pcg64;

use crate::geometry::{
    ConvexPolyhedron, MassProperties, Point, PolyhedronError, Pose, Rounded, Vector, edges_of,
    enclosed_volume, loop_of, used, volume_of_loops,
};
use crate::scale::{self, Scale};
use crate::scenario::{CellShape, SievedGrains};
use crate::units::{from_mm, to_cm3, to_mm};
use {cell_shape::*, complex::*, fan::*, psd::*, streams::*, voronoi::*};

/// Name of a grain by its number, the same in every table, scene, message and page: `grain_00012`.
/// Where a format holds numbers alone (VTK, PLY, `specimen.json`), it is the number. A grain read
/// from a PLY file is named by the number there.
pub fn grain_name(number: usize) -> String {
    format!("grain_{number:05}")
}

/// The grains of an experiment, in the order in which the tessellation made them.
#[derive(Debug, Clone, PartialEq)]
pub struct GrainSet {
    /// The grains.
    pub grains: Vec<Grain>,
    /// The blocks they were cut from, for `grains.json`.
    pub blocks: Vec<Block>,
    /// Density of the solids in kg/m³.
    pub density: f64,
    /// What became of each mesh; none where the grains were not made from meshes.
    pub meshes: Vec<MeshRecord>,
}

/// One cube of a sieve fraction's solid volume and the points of its tessellation; or the grains of
/// a fraction side by side, without points, in a cube that holds them.
#[derive(Debug, Clone, PartialEq)]
pub struct Block {
    /// Opening of the sieve the fraction passes, in m.
    pub passing: f64,
    /// Opening of the sieve that retains the fraction, in m.
    pub retained: f64,
    /// Whether nobody specified these sieves, but grains that keep their own size lie between them.
    pub own_sizes: bool,
    /// Side of the cube in m.
    pub side: f64,
    /// Lowest corner of the cube in m.
    pub origin: Vector,
    /// Points of the tessellation, one a cell, in m.
    pub points: Vec<Vector>,
    /// Index of the block's first grain in the grain set.
    pub first_grain: usize,
    /// The cells in the coordinates of `origin` and `points`, in m, one a
    /// grain: what the grains are computed from and what files hold.
    pub cells: Vec<ConvexPolyhedron>,
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

impl GrainSet {
    /// No grains yet, of a density in kg/m³.
    fn empty(density: f64) -> Self {
        Self { grains: Vec::new(), blocks: Vec::new(), density, meshes: Vec::new() }
    }

    /// Whether a grain is of a sieve fraction between two openings in m, where there are any.
    pub fn is_between(&self, grain: usize, openings: Option<[f64; 2]>) -> bool {
        let block = &self.blocks[self.grains[grain].fraction];
        // Openings are typed in mm, and may be a rounding off in m.
        openings.is_none_or(|[low, high]| {
            block.retained >= low * (1.0 - 1e-9) && block.passing <= high * (1.0 + 1e-9)
        })
    }

    /// The distribution that the grains were made from: their sieve table. `None` of meshes that
    /// keep their own size, and of grains whose blocks are no sieve fractions.
    pub fn specified(&self) -> Option<ParticleSizeDistribution> {
        let own_sizes = self.blocks.iter().any(|block| block.own_sizes);
        if own_sizes { None } else { ParticleSizeDistribution::of(self).ok() }
    }

    /// Mass of all grains in kg.
    pub fn total_mass(&self) -> f64 {
        self.grains.iter().map(|g| g.mass).sum()
    }

    /// Solid volume of all grains in m³.
    pub fn total_volume(&self) -> f64 {
        self.grains.iter().map(|g| g.volume).sum()
    }

    /// Mean number of grains in 100 g (paper, section 3: 55 to 65); NaN without grains.
    pub fn grains_in_100_g(&self) -> f64 {
        self.grains.len() as f64 * 0.1 / self.total_mass()
    }

    /// Largest distance in m of any grain's vertex from its centroid; 0 without grains.
    pub fn largest_bounding_radius(&self) -> f64 {
        self.grains.iter().map(|g| g.shape.radius_about_origin()).fold(0.0, f64::max)
    }
}

#[cfg(test)]
mod tests;
