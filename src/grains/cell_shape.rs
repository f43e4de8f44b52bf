//! Regularity and direction of Voronoi cells: Lloyd's relaxation, and cells
//! cut in a stretched space; which points can be tessellated at all.

use meshless_voronoi::integrals::VolumeCentroidIntegral;
use meshless_voronoi::{Dimensionality, VoronoiIntegrator};

use super::*;
use crate::caught::caught;

/// Least distance between two points, as a fraction of the cube's side. The
/// tessellation rounds coordinates to about 2⁻⁵⁰ of the side where it decides
/// close calls exactly, and panics on points that coincide.
const LEAST_DISTANCE: f64 = 1e-9;

/// Largest movement of a point in a step, as a fraction of the cube's side, at which relaxation has
/// arrived: further steps would change the cells by no more.
const ARRIVED: f64 = 1e-6;

/// Sides of the box in which a cube is tessellated so that its cells, mapped
/// back to the cube, are as long and as flat as asked for. The largest is 1.
///
/// A cell that is round in the box becomes, in the cube, as long along each
/// axis as the cube's side is over the box's: along x longest, along z
/// shortest. Convex cells stay convex, and their volumes keep their shares.
pub(super) fn box_sides(shape: &CellShape) -> Vector {
    Vector::new(1.0 / (shape.elongation * shape.flatness), 1.0 / shape.flatness, 1.0)
}

/// The points after a number of steps in each of which every point moves to the centroid of its
/// cell (Lloyd 1982, "Least squares quantization in PCM"). They are given and returned in units of
/// the cube's side, 0 to 1; the cells are those of a box of the given sides.
///
/// A few points may arrive in a symmetric arrangement, whose ties to the last bit make the
/// tessellation panic: then they stay where they were before.
///
/// # Errors
/// Points that no tessellation can be made from.
pub(super) fn relaxed(
    mut points: Vec<Vector>,
    sides: Vector,
    steps: u32,
) -> Result<Vec<Vector>, GrainsError> {
    // The points before the last step, once it has hardly moved them.
    let mut before = None;
    for _ in 0..steps {
        check_points(&points)?;
        let generators: Vec<_> =
            points.iter().map(|p| [p.x * sides.x, p.y * sides.y, p.z * sides.z].into()).collect();
        let cells = caught(|| {
            let tessellation = VoronoiIntegrator::build(
                &generators,
                None,
                [0.0; 3].into(),
                [sides.x, sides.y, sides.z].into(),
                Dimensionality::ThreeD,
                false,
            );
            tessellation.compute_cell_integrals::<VolumeCentroidIntegral>()
        });
        let cells = match cells {
            Ok(cells) => cells,
            Err(reason) => return before.ok_or(GrainsError::NoTessellation(reason)),
        };
        let earlier = points.clone();
        for (point, cell) in points.iter_mut().zip(&cells) {
            let at = Vector::new(cell.centroid.x, cell.centroid.y, cell.centroid.z);
            *point = at.component_div(&sides).map(|c| c.clamp(0.0, 1.0));
        }
        let moved = earlier.iter().zip(&points).map(|(a, b)| (b - a).norm()).fold(0.0, f64::max);
        before = (moved < ARRIVED).then_some(earlier);
    }
    Ok(points)
}

/// Guards the tessellation, which panics on points that are not finite or
/// coincide and silently accepts points outside the cube.
pub(super) fn check_points(points: &[Vector]) -> Result<(), GrainsError> {
    let fault = |point: usize, reason: &str| {
        Err(GrainsError::BadPoint { point, reason: reason.to_owned() })
    };
    if points.is_empty() {
        return Err(GrainsError::NoGrains);
    }
    if let Some(point) = points.iter().position(|p| !p.iter().all(|c| (0.0..=1.0).contains(c))) {
        return fault(point, "does not lie in the block");
    }
    let mut order: Vec<usize> = (0..points.len()).collect();
    order.sort_by(|&a, &b| points[a].x.total_cmp(&points[b].x));
    for (i, &a) in order.iter().enumerate() {
        for &b in &order[i + 1..] {
            if points[b].x - points[a].x > LEAST_DISTANCE {
                break;
            }
            if (points[a] - points[b]).norm() <= LEAST_DISTANCE {
                return fault(a.max(b), "coincides with another one");
            }
        }
    }
    Ok(())
}

#[cfg(test)]
#[path = "cell_shape_tests.rs"]
mod tests;
