//! How grains cut from sieve data are shaped: regular or irregular, round or long.

use super::*;

/// What grains of a sieve table are.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum SievedShape {
    /// Voronoi cells.
    #[default]
    Cells,
    /// Spheres whose diameters lie between the sieves of their fraction.
    Spheres,
}

parts! {
/// Shape of the Voronoi cells that grains are cut into. The paper's text says only that
/// blocks were cut by Voronoi tessellation; the defaults are ours: cells of random points, as
/// they come, in no direction longer than in another but by chance.
#[derive(Copy)]
#[serde(default)]
pub struct CellShape {
    /// How often each point moves to the centroid of its cell before the cells
    /// are cut (Lloyd 1982). With every step cells become more alike in volume,
    /// rounder and less angular; with some tens of steps they are nearly regular.
    pub relaxation_steps: u32 = 0, from 0 to 1000;
    /// Longest over intermediate dimension that is given to all cells on top
    /// of what they have by chance. They are cut in a space stretched so.
    pub elongation: f64 = 1.0, from 1.0 to 10.0;
    /// Intermediate over shortest dimension, likewise.
    pub flatness: f64 = 1.0, from 1.0 to 10.0;
    /// Roundness: radius of corners and edges over that of the largest sphere inside the cell;
    /// 0, or 0.01 to 0.9. The planes of a cell move inwards by the radius, a ball of the radius
    /// sweeps what they leave, and the grain is enlarged to the cell's volume.
    pub rounding: f64 = 0.0, skip "is_default", from 0.0 to 0.9;
}
}

/// Least roundness other than 0: below, contacts of a core's corners would be deeper than the ball.
pub const LEAST_ROUNDING: f64 = 0.01;
