//! Between SI in nalgebra's types and engine units in rapier's.

use std::sync::Arc;

use nalgebra::{Quaternion, UnitQuaternion};
use rapier3d_f64::{math, parry::transformation::try_convex_hull, prelude::SharedShape};

use crate::geometry::{ConvexPolyhedron, Pose, Vector};

/// The length of an engine unit. Mass stays in kg and time in s, so that
/// speed, acceleration and impulse scale like length, inertia like its square.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Units {
    /// Engine units in a metre.
    pub per_metre: f64,
}

impl Units {
    /// A length, or what scales like one, to engine units.
    pub(super) fn length(self, metres: &Vector) -> math::Vector {
        vector(&(metres * self.per_metre))
    }

    pub(super) fn inertia(self, si: &Vector) -> math::Vector {
        vector(&(si * (self.per_metre * self.per_metre)))
    }

    pub(super) fn pose(self, pose: &Pose) -> math::Pose {
        let q = pose.rotation.coords;
        math::Pose::from_parts(
            self.length(&pose.translation.vector),
            math::Rotation::from_xyzw(q.x, q.y, q.z, q.w),
        )
    }

    /// A length, or what scales like one, from engine units.
    pub(super) fn metres(self, units: math::Vector) -> Vector {
        plain(units) / self.per_metre
    }

    pub(super) fn metres_pose(self, pose: &math::Pose) -> Pose {
        let q = pose.rotation;
        Pose::from_parts(
            self.metres(pose.translation).into(),
            UnitQuaternion::new_normalize(Quaternion::new(q.w, q.x, q.y, q.z)),
        )
    }
}

/// A vector as it is, to rapier's type.
pub(super) fn vector(v: &Vector) -> math::Vector {
    math::Vector::new(v.x, v.y, v.z)
}

/// A vector as it is, from rapier's type.
pub(super) fn plain(v: math::Vector) -> Vector {
    Vector::new(v.x, v.y, v.z)
}

/// Shares of its size by which a polyhedron may be simplified before it is
/// refused: at most a hundredth of a millimetre for a grain of 10 mm.
const SIMPLIFIED_BY: [f64; 4] = [1e-6, 1e-5, 1e-4, 1e-3];

/// The polyhedron in engine units, with parry's border radius where it is rounded, rapier's ball for
/// a sphere; `None` where parry's own checks fail.
///
/// Its faces are given as fans of triangles, which parry joins again where their normals agree to
/// 1.7e-4 rad (`from_convex_mesh`, 0.31). Where joining leaves a vertex with fewer than two faces,
/// as it does beside edges of micrometres, parry refuses the mesh: then the hull of the vertices
/// stands in, those that lie closer together than a share of the size taken as one.
pub(super) fn shape(units: Units, polyhedron: &Arc<ConvexPolyhedron>) -> Option<SharedShape> {
    if let Some(sphere) = polyhedron.sphere() {
        return Some(SharedShape::ball(sphere.radius * units.per_metre));
    }
    let (polyhedron, radius) = polyhedron.core();
    let mesh = |points: Vec<_>, triangles: &[[u32; 3]]| match radius > 0.0 {
        true => SharedShape::round_convex_mesh(points, triangles, radius * units.per_metre),
        false => SharedShape::convex_mesh(points, triangles),
    };
    let points: Vec<_> = polyhedron.vertices().iter().map(|p| units.length(&p.coords)).collect();
    let triangles: Vec<[u32; 3]> = polyhedron
        .faces()
        .iter()
        .flat_map(|face| face[1..].windows(2).map(|pair| [face[0], pair[0], pair[1]]))
        .collect();
    let size = polyhedron.equivalent_diameter() * units.per_metre;
    mesh(points.clone(), &triangles).or_else(|| {
        SIMPLIFIED_BY.iter().find_map(|share| {
            let (points, triangles) = try_convex_hull(&apart(&points, share * size)).ok()?;
            mesh(points, &triangles)
        })
    })
}

/// The points without those that lie closer than a distance to an earlier one.
fn apart(points: &[math::Vector], distance: f64) -> Vec<math::Vector> {
    let mut kept: Vec<math::Vector> = Vec::with_capacity(points.len());
    for point in points {
        if kept.iter().all(|k| (*k - *point).length() > distance) {
            kept.push(*point);
        }
    }
    kept
}
