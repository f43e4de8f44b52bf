//! From a closed surface to a convex polyhedron.

use super::*;
use crate::geometry::{FLATNESS, Hull, ROUNDINGS, hull, joined_polyhedron};

/// Grains whose volume is at least this share of their hull's are taken as
/// their hulls without being asked: the roughness of a scan leaves them there.
pub(super) const NEARLY_CONVEX: f64 = 0.99;

/// A polyhedron, and what was done to make it.
type Made = (ConvexPolyhedron, MeshRecord);

/// The convex polyhedron of a surface: the surface itself where it is convex
/// and has few enough vertices, else its hull where that is near enough or
/// asked for. It is where the surface was; the record says what was done to it.
pub(super) fn convex(surface: &Surface, spec: &MeshGrains) -> Result<Made, Fault> {
    let most = spec.largest_vertex_count as usize;
    if let Some(shape) = small(&surface.vertices, &surface.faces, most) {
        return Ok((shape, made(1.0, false, 0.0)));
    }
    let grown = ROUNDINGS.into_iter().find_map(|rounding| of_hull(surface, spec, rounding));
    grown.unwrap_or_else(|| {
        Err(Fault::new(
            "no convex hull can be made of its vertices",
            counted(surface.vertices.len(), "vertex"),
            "fewer vertices that nearly share a plane; simplify the mesh",
        ))
    })
}

fn made(convexity: f64, hull: bool, left_out: f64) -> MeshRecord {
    MeshRecord { convexity, hull, left_out, ..MeshRecord::default() }
}

/// The polyhedron of closed faces where it has few enough vertices.
fn small(vertices: &[Point], faces: &[Vec<u32>], most: usize) -> Option<ConvexPolyhedron> {
    // Joining triangles may leave vertices amid a face, so count after it.
    let few = vertices.len() <= 8 * most;
    let shape = few.then(|| joined_polyhedron(vertices, faces)).flatten();
    shape.filter(|shape| shape.vertices().len() <= most)
}

/// The hull of a surface, or why the surface is no grain. `None` where rounding makes the hull no
/// convex polyhedron.
fn of_hull(surface: &Surface, spec: &MeshGrains, rounding: f64) -> Option<Result<Made, Fault>> {
    let most = spec.largest_vertex_count as usize;
    let whole = hull(&surface.vertices, usize::MAX, rounding)?;
    let convexity = (surface.volume / enclosed_volume(&whole.vertices, &whole.triangles)).min(1.0);
    if !(spec.hull || convexity >= NEARLY_CONVEX) {
        return Some(Err(Fault::new(
            format!(
                "the grain is not convex: its hull has {} % more volume",
                rounded(100.0 * (1.0 / convexity - 1.0))
            ),
            format!("a volume of {} % of the hull's", rounded(100.0 * convexity)),
            format!(
                "at least {} %; or `\"hull\": true`, which takes the hulls of all grains",
                100.0 * NEARLY_CONVEX
            ),
        )));
    }
    if whole.left_out > FLATNESS * extent(&surface.vertices) {
        return None;
    }
    if let Some(shape) = small(&whole.vertices, &whole.triangles, most) {
        return Some(Ok((shape, made(convexity, true, 0.0))));
    }
    let Hull { vertices, triangles, left_out } = hull(&whole.vertices, most, rounding)?;
    let shape = joined_polyhedron(&vertices, &triangles)?;
    Some(Ok((shape, made(convexity, true, left_out))))
}
