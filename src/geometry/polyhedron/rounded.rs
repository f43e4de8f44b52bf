//! Rounded polyhedra: a convex core swept by a ball, with exact volume and surface.

use std::collections::HashMap;

use super::ConvexPolyhedron;
use crate::geometry::{Vector, convex::left_of_edges, edges_of};

/// A convex polyhedron, the core, swept by a ball: all points that are at most a radius away from
/// the core.
///
/// Its flat faces are those of the core moved outwards by the radius; along the edges lie parts of
/// cylinders, about the corners parts of spheres.
#[derive(Debug, Clone, PartialEq)]
pub struct Rounded {
    /// What the ball's centre goes through.
    pub core: ConvexPolyhedron,
    /// Radius of the ball in m.
    pub radius: f64,
}

/// Angle in rad between two directions.
pub(in crate::geometry) fn angle(a: &Vector, b: &Vector) -> f64 {
    a.cross(b).norm().atan2(a.dot(b))
}

/// An edge of the core: its ends and the outward normals of its faces, such that from `left` to
/// `right` is a right-handed turn about the direction from `from` to `to`.
pub(in crate::geometry) struct CoreEdge {
    pub(in crate::geometry) from: Vector,
    pub(in crate::geometry) to: Vector,
    pub(in crate::geometry) left: Vector,
    pub(in crate::geometry) right: Vector,
}

impl CoreEdge {
    /// Angle between the normals, in rad.
    pub(in crate::geometry) fn angle(&self) -> f64 {
        angle(&self.left, &self.right)
    }

    pub(in crate::geometry) fn length(&self) -> f64 {
        (self.to - self.from).norm()
    }
}

/// The outward unit normals of all faces.
pub(in crate::geometry) fn normals(core: &ConvexPolyhedron) -> Vec<Vector> {
    (0..core.faces().len())
        .map(|face| core.plane(face).map_or_else(Vector::zeros, |(normal, _)| normal))
        .collect()
}

/// The faces about each vertex, counter-clockwise seen from outside.
pub(in crate::geometry) fn faces_about(core: &ConvexPolyhedron) -> Vec<Vec<usize>> {
    let left = left_of_edges(core.faces());
    // Where a face came from.
    let mut before: HashMap<(u32, usize), u32> = HashMap::new();
    let mut first: Vec<Option<usize>> = vec![None; core.vertices().len()];
    for (face, corners) in core.faces().iter().enumerate() {
        for (a, b) in edges_of(corners) {
            before.insert((b, face), a);
            first[b as usize].get_or_insert(face);
        }
    }
    first
        .iter()
        .enumerate()
        .map(|(v, &first)| {
            let mut around = Vec::new();
            let mut next = first;
            while let Some(face) = next {
                around.push(face);
                let back = before.get(&(v as u32, face));
                next = back
                    .and_then(|&back| left.get(&(v as u32, back)).copied())
                    .filter(|face| Some(*face) != first && around.len() <= core.faces().len());
            }
            around
        })
        .collect()
}

impl Rounded {
    /// Volume in m³ by Steiner's formula: V + S r + M r² + 4/3 π r³, with the integral of mean
    /// curvature M = ½ Σ edge length times turn of the normal.
    pub fn volume(&self) -> f64 {
        let r = self.radius;
        let bends: f64 = self.edges().iter().map(|e| e.length() * e.angle()).sum();
        self.core.signed_volume()
            + self.core.surface() * r
            + bends / 2.0 * r * r
            + 4.0 / 3.0 * std::f64::consts::PI * r.powi(3)
    }

    /// Surface in m²: S + 2 M r + 4 π r².
    pub fn surface(&self) -> f64 {
        let r = self.radius;
        let bends: f64 = self.edges().iter().map(|e| e.length() * e.angle()).sum();
        self.core.surface() + bends * r + 4.0 * std::f64::consts::PI * r * r
    }

    pub(in crate::geometry) fn edges(&self) -> Vec<CoreEdge> {
        let core = &self.core;
        let normals = normals(core);
        let left = left_of_edges(core.faces());
        let at = |v: u32| core.vertices()[v as usize].coords;
        let edges = core.edges().into_iter().filter_map(|(a, b)| {
            let (l, r) = (left.get(&(a, b))?, left.get(&(b, a))?);
            Some(CoreEdge { from: at(a), to: at(b), left: normals[*l], right: normals[*r] })
        });
        edges.collect()
    }
}
