//! `grains.json`: grains as plain data, in the coordinates of their blocks.

use serde::{Deserialize, Serialize};

use super::{Block, GrainSet, GrainsError, make::grain};
use crate::geometry::{ConvexPolyhedron, Point, Vector};
use crate::units::{from_mm, to_mm};

/// Largest relative difference between a stated volume or mass and the one
/// that the vertices give.
const AGREEMENT: f64 = 1e-6;

/// The content of `grains.json`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct GrainsJson {
    /// Density of the solids in kg/m³.
    pub density_kg_per_m3: f64,
    /// One block a sieve fraction.
    pub blocks: Vec<BlockJson>,
}

/// One block: a cube of a fraction's solid volume and the cells it was cut into.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BlockJson {
    /// The fraction's sieves.
    pub sieve: SieveJson,
    /// Side of the cube in m.
    pub side_m: f64,
    /// Its lowest corner in m.
    pub origin_m: [f64; 3],
    /// Points of the tessellation in m, one a cell.
    pub points_m: Vec<[f64; 3]>,
    /// The grains.
    pub cells: Vec<CellJson>,
}

/// The two sieves of a fraction.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct SieveJson {
    /// Opening of the sieve it passes, in mm.
    pub passing_mm: f64,
    /// Opening of the sieve that retains it, in mm.
    pub retained_mm: f64,
}

/// One grain.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CellJson {
    /// Corners in m, in the block's coordinates.
    pub vertices_m: Vec<[f64; 3]>,
    /// Faces as loops of vertex indices, counter-clockwise seen from outside.
    pub faces: Vec<Vec<u32>>,
    /// Volume in m³.
    pub volume_m3: f64,
    /// Centroid in m, in the block's coordinates.
    pub centroid_m: [f64; 3],
    /// Mass in kg.
    pub mass_kg: f64,
    /// Inertia tensor about the centroid along the block's axes, in kg m².
    pub inertia_kg_m2: [[f64; 3]; 3],
    /// Mean of the openings of its fraction's sieves in mm.
    pub sieve_size_mm: f64,
}

/// Grains as plain data.
pub fn to_json(set: &GrainSet) -> GrainsJson {
    let ends = set.blocks.iter().skip(1).map(|b| b.first_grain).chain([set.grains.len()]);
    let blocks = set
        .blocks
        .iter()
        .zip(ends)
        .map(|(block, end)| {
            let sieve_size_mm = to_mm((block.passing + block.retained) / 2.0);
            let cells = set.grains[block.first_grain..end]
                .iter()
                .map(|g| {
                    let axes = g.pose_in_block.rotation.to_rotation_matrix().into_inner();
                    let inertia =
                        axes * nalgebra::Matrix3::from_diagonal(&g.inertia) * axes.transpose();
                    CellJson {
                        vertices_m: g.cell.vertices().iter().map(|v| [v.x, v.y, v.z]).collect(),
                        faces: g.cell.faces().to_vec(),
                        volume_m3: g.volume,
                        centroid_m: g.pose_in_block.translation.vector.into(),
                        mass_kg: g.mass,
                        inertia_kg_m2: std::array::from_fn(|i| {
                            std::array::from_fn(|j| inertia[(i, j)])
                        }),
                        sieve_size_mm,
                    }
                })
                .collect();
            BlockJson {
                sieve: SieveJson {
                    passing_mm: to_mm(block.passing),
                    retained_mm: to_mm(block.retained),
                },
                side_m: block.side,
                origin_m: block.origin.into(),
                points_m: block.points.iter().map(|&p| p.into()).collect(),
                cells,
            }
        })
        .collect();
    GrainsJson { density_kg_per_m3: set.density, blocks }
}

/// Grains from plain data. Mass properties are computed from the vertices;
/// stated volumes and masses must agree with them.
///
/// # Errors
/// [`GrainsError::File`] naming block, cell and what is wrong with it.
pub fn from_json(json: &GrainsJson) -> Result<GrainSet, GrainsError> {
    let density = json.density_kg_per_m3;
    if !(density.is_finite() && density > 0.0) {
        return Err(fault("density_kg_per_m3", format!("{density} is not a positive number")));
    }
    let mut set = GrainSet { grains: Vec::new(), blocks: Vec::new(), density };
    for (b, block) in json.blocks.iter().enumerate() {
        let numbers = [block.side_m, block.sieve.passing_mm, block.sieve.retained_mm];
        if !numbers.iter().all(|n| n.is_finite() && *n > 0.0) {
            return Err(fault(
                &format!("blocks[{b}]"),
                "side_m and the sieve's openings must be positive numbers".into(),
            ));
        }
        set.blocks.push(Block {
            passing: from_mm(block.sieve.passing_mm),
            retained: from_mm(block.sieve.retained_mm),
            side: block.side_m,
            origin: block.origin_m.into(),
            points: block.points_m.iter().map(|&p| Vector::from(p)).collect(),
            first_grain: set.grains.len(),
        });
        for (c, cell) in block.cells.iter().enumerate() {
            let at = format!("blocks[{b}].cells[{c}]");
            let vertices = cell.vertices_m.iter().map(|&v| Point::from(v)).collect();
            let polyhedron = ConvexPolyhedron::new(vertices, cell.faces.clone())
                .map_err(|reason| fault(&at, reason.to_string()))?;
            let made = grain(polyhedron, density, b);
            for (name, stated, computed) in
                [("volume_m3", cell.volume_m3, made.volume), ("mass_kg", cell.mass_kg, made.mass)]
            {
                if !((stated / computed - 1.0).abs() <= AGREEMENT) {
                    return Err(fault(
                        &format!("{at}.{name}"),
                        format!("{stated} is stated, the vertices give {computed}"),
                    ));
                }
            }
            set.grains.push(made);
        }
    }
    if set.grains.is_empty() {
        return Err(fault("blocks", "there is no grain in it".into()));
    }
    Ok(set)
}

fn fault(path: &str, reason: String) -> GrainsError {
    GrainsError::File { path: path.to_owned(), reason }
}
