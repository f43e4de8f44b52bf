//! The mesh that stands for a rounded polyhedron where faces are needed.

use super::{
    ConvexPolyhedron, Point, PolyhedronError, Rounded, Vector, convex_hull, edges_of,
    polyhedron::{angle, checked, faces_about, normals},
};

/// Largest angle in rad between neighbouring normals of the mesh on a rounded edge.
const STEP: f64 = 0.35;

impl ConvexPolyhedron {
    /// A polyhedron swept by a ball with a radius in m.
    ///
    /// # Errors
    /// When the radius is not positive, the core is not a polyhedron of flat faces, or no mesh can
    /// be made of it.
    pub fn of_rounded(core: Self, radius: f64) -> Result<Self, PolyhedronError> {
        let rounded = checked(core, radius)?;
        Ok(outline(&rounded, STEP)?.standing_for(rounded))
    }
}

/// A convex mesh whose corners lie on the surface: flat faces whole, edges in strips, corners in
/// triangles. Neighbouring normals are at most `step` apart, in rad, along the sides of a corner.
pub(super) fn outline(rounded: &Rounded, step: f64) -> Result<ConvexPolyhedron, PolyhedronError> {
    let core = &rounded.core;
    let normals = normals(core);
    let mut points: Vec<Point> = Vec::new();
    for (corner, faces) in core.vertices().iter().zip(faces_about(core)) {
        let rim = rim(&faces.iter().map(|&f| normals[f]).collect::<Vec<_>>(), step);
        let middle = rim.iter().sum::<Vector>().try_normalize(0.0);
        let mut directions = rim.clone();
        if let Some(middle) = middle {
            let far = rim.iter().map(|d| middle.dot(d).clamp(-1.0, 1.0).acos()).fold(0.0, f64::max);
            let rings = (far / step).ceil() as usize;
            for ring in 1..rings {
                let share = ring as f64 / rings as f64;
                directions.extend(rim.iter().filter_map(|d| between(&middle, d, share)));
            }
            if far > step / 2.0 {
                directions.push(middle);
            }
        }
        // Those of a ring close about the middle nearly coincide.
        let mut kept: Vec<Vector> = Vec::new();
        for (i, d) in directions.into_iter().enumerate() {
            if i < rim.len() || kept.iter().all(|k| (k - d).norm() > step / 2.0) {
                kept.push(d);
            }
        }
        points.extend(kept.iter().map(|d| corner + d * rounded.radius));
    }
    convex_hull(&points).ok_or(PolyhedronError::NoMesh)
}

/// The sides of the spherical polygon between normals, in steps.
fn rim(normals: &[Vector], step: f64) -> Vec<Vector> {
    let mut rim = Vec::new();
    for (a, b) in edges_of(normals) {
        let angle = angle(&a, &b);
        let steps = (angle / step).ceil().max(1.0) as usize;
        rim.push(a);
        rim.extend((1..steps).filter_map(|k| between(&a, &b, k as f64 / steps as f64)));
    }
    rim
}

/// The unit vector at a share of the way from one to another.
fn between(a: &Vector, b: &Vector, share: f64) -> Option<Vector> {
    let angle = angle(a, b);
    (a * ((1.0 - share) * angle).sin() + b * (share * angle).sin()).try_normalize(0.0)
}
