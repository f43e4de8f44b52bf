//! Mixing: orders and orientations of the same grains.

use nalgebra::UnitQuaternion;

use super::{GrainSet, GrainsError, streams::Stream};
use crate::geometry::{Pose, Vector};

/// An order and orientations of the grains of a set.
#[derive(Debug, Clone, PartialEq)]
pub struct Mixing {
    /// Grain indices in the order in which they are poured.
    pub order: Vec<usize>,
    /// Orientation of each grain, by grain index.
    pub orientations: Vec<UnitQuaternion<f64>>,
}

/// The mixing of a configuration, counted from 1; another number gives
/// another order and other orientations.
pub fn mix(grains: &GrainSet, seed: u64, configuration: u32) -> Mixing {
    let count = grains.grains.len();
    let mut orders = Stream::new(seed, &format!("mixing order {configuration}"));
    let mut turns = Stream::new(seed, &format!("mixing orientations {configuration}"));
    Mixing {
        order: orders.order(count),
        orientations: (0..count).map(|_| turns.rotation()).collect(),
    }
}

/// Gap in m between the bounding spheres of neighbours.
const CLEARANCE: f64 = 0.25e-3;

/// Places tried for each grain; the lowest is taken.
const TRIES: usize = 30;

/// Poses for the grains to fall from: in mixed order, each grain's bounding
/// sphere rests on those before it within a vertical cylinder of the given
/// radius that begins at height `bottom`, both in m. No two spheres overlap.
///
/// # Errors
/// [`GrainsError::TooNarrow`] when a grain does not fit into the cylinder.
pub fn rain(
    grains: &GrainSet,
    mixing: &Mixing,
    radius: f64,
    bottom: f64,
    seed: u64,
) -> Result<Vec<Pose>, GrainsError> {
    let mut places = Stream::new(seed, "rain");
    let mut poses = vec![Pose::identity(); grains.grains.len()];
    let mut placed: Vec<(Vector, f64)> = Vec::with_capacity(poses.len());
    for &grain in &mixing.order {
        let r = grains.grains[grain].shape.radius_about_origin() + CLEARANCE / 2.0;
        if r > radius {
            return Err(GrainsError::TooNarrow { grain, radius: r, room: radius });
        }
        let best = (0..TRIES)
            .map(|_| {
                let (distance, angle) = (
                    (radius - r) * places.uniform().sqrt(),
                    std::f64::consts::TAU * places.uniform(),
                );
                let (x, y) = (distance * angle.cos(), distance * angle.sin());
                let z = placed.iter().fold(bottom + r, |z, (at, other)| {
                    let apart = (at.x - x).powi(2) + (at.y - y).powi(2);
                    let touch = (r + other).powi(2);
                    if apart < touch { z.max(at.z + (touch - apart).sqrt()) } else { z }
                });
                Vector::new(x, y, z)
            })
            .min_by(|a, b| a.z.total_cmp(&b.z))
            .unwrap_or_default();
        placed.push((best, r));
        poses[grain] = Pose::from_parts(best.into(), mixing.orientations[grain]);
    }
    Ok(poses)
}
