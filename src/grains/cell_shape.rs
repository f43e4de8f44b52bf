//! Regularity and direction of Voronoi cells: Lloyd's relaxation, and cells
//! cut in a stretched space; which points can be tessellated at all.

use meshless_voronoi::integrals::VolumeCentroidIntegral;
use meshless_voronoi::{Dimensionality, VoronoiIntegrator};

use super::*;

/// Least distance between two points, as a fraction of the cube's side. The
/// tessellation rounds coordinates to about 2⁻⁵⁰ of the side where it decides
/// close calls exactly, and panics on points that coincide.
const LEAST_DISTANCE: f64 = 1e-9;

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
/// # Errors
/// Points that no tessellation can be made from.
pub(super) fn relaxed(
    mut points: Vec<Vector>,
    sides: Vector,
    steps: u32,
) -> Result<Vec<Vector>, GrainsError> {
    for _ in 0..steps {
        check_points(&points)?;
        let generators: Vec<_> =
            points.iter().map(|p| [p.x * sides.x, p.y * sides.y, p.z * sides.z].into()).collect();
        let tessellation = VoronoiIntegrator::build(
            &generators,
            None,
            [0.0; 3].into(),
            [sides.x, sides.y, sides.z].into(),
            Dimensionality::ThreeD,
            false,
        );
        let cells = tessellation.compute_cell_integrals::<VolumeCentroidIntegral>();
        for (point, cell) in points.iter_mut().zip(&cells) {
            let at = Vector::new(cell.centroid.x, cell.centroid.y, cell.centroid.z);
            *point = at.component_div(&sides).map(|c| c.clamp(0.0, 1.0));
        }
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
