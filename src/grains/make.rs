//! From sieve data to grains.

use std::sync::Arc;

use super::{
    Block, Grain, GrainSet, GrainsError, ParticleSizeDistribution, streams::Stream, voronoi,
};
use crate::geometry::{ConvexPolyhedron, MassProperties, Vector};
use crate::scenario::SievedGrains;

/// Gap in m between the blocks, which stand side by side along x.
const BLOCK_GAP: f64 = 0.02;

/// Cuts grains from sieve data (paper, section 3): for every fraction a cube of
/// its solid volume, cut by Voronoi tessellation of uniformly random points
/// into as many cells as grains of the mean size make up that volume.
///
/// # Errors
/// [`GrainsError`].
pub fn generate(spec: &SievedGrains, seed: u64) -> Result<GrainSet, GrainsError> {
    let distribution = ParticleSizeDistribution::new(spec)?;
    let mut set =
        GrainSet { grains: Vec::new(), blocks: Vec::new(), density: distribution.density };
    let density = set.density;
    let mut x = 0.0;
    for (index, fraction) in distribution.fractions.iter().enumerate() {
        let side = fraction.volume.cbrt();
        let origin = Vector::new(x, 0.0, 0.0);
        let mut stream = Stream::new(seed, &format!("tessellation of fraction {index}"));
        let local: Vec<Vector> = (0..fraction.grains)
            .map(|_| side * Vector::new(inner(&mut stream), inner(&mut stream), inner(&mut stream)))
            .collect();
        let cells = voronoi::cells(side, &local)?;
        set.blocks.push(Block {
            passing: fraction.passing,
            retained: fraction.retained,
            side,
            origin,
            points: local.iter().map(|p| p + origin).collect(),
            first_grain: set.grains.len(),
        });
        let to_block = crate::geometry::Pose::translation(x, 0.0, 0.0);
        set.grains.extend(cells.iter().map(|c| grain(c.transformed(&to_block), density, index)));
        x += side + BLOCK_GAP;
    }
    Ok(set)
}

/// Uniform in (0, 1): the tessellation's points lie inside the cube.
fn inner(stream: &mut Stream) -> f64 {
    loop {
        let u = stream.uniform();
        if u > 0.0 {
            return u;
        }
    }
}

/// A grain of a cell in block coordinates.
pub(super) fn grain(cell: ConvexPolyhedron, density: f64, fraction: usize) -> Grain {
    let properties = MassProperties::of(&cell);
    let frame = properties.principal_frame();
    let shape = cell.transformed(&frame.pose.inverse());
    Grain {
        equivalent_diameter: (6.0 * properties.volume / std::f64::consts::PI).cbrt(),
        shape: Arc::new(shape),
        cell: Arc::new(cell),
        pose_in_block: frame.pose,
        volume: properties.volume,
        mass: density * properties.volume,
        inertia: density * frame.moments_per_density,
        fraction,
    }
}
