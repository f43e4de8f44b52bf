//! A convex polyhedron, rounded or not, or a sphere in world coordinates, prepared for overlap tests.

use super::*;

/// Vertices, face normals and edges of one body in world coordinates.
#[derive(Debug, Clone)]
pub struct WorldHull {
    /// Vertices in m.
    pub(super) vertices: Vec<Vector>,
    /// Outward unit normal of each face, and the farthest that any vertex lies along it, in m.
    ///
    /// For exactly plane faces that is the face's own offset; taking the farthest vertex keeps the
    /// result right for the hull of the vertices when a face is plane only within rounding.
    pub(super) faces: Vec<(Vector, f64)>,
    pub(super) edges: Vec<Edge>,
    /// Corners of the bounding box in m.
    pub(super) low: Vector,
    pub(super) high: Vector,
    /// Radius in m of the ball that sweeps the polyhedron of vertices, faces and edges; 0 where
    /// these are the body itself. The bounding box is the body's.
    pub(super) rounding: f64,
    /// The sphere that it is, which has no vertices, faces and edges.
    pub(super) sphere: Option<Sphere>,
}

/// An edge with the normals of the faces that meet there.
#[derive(Debug, Clone, Copy)]
pub(super) struct Edge {
    /// A point of the edge, in m.
    pub point: Vector,
    /// Unit vector along it: the direction in which the left face's loop runs.
    pub direction: Vector,
    /// Its length from the point on, in m.
    pub length: f64,
    /// Outward normal of the face on the left, seen from outside.
    pub left: Vector,
    /// Outward normal of the face on the right.
    pub right: Vector,
}

impl WorldHull {
    /// Prepares a shape at a pose.
    pub fn new(shape: &ConvexPolyhedron, pose: &Pose) -> Self {
        if let Some(sphere) = shape.sphere() {
            let sphere = Sphere { centre: pose * sphere.centre, ..sphere };
            let reach = Vector::repeat(sphere.radius);
            let (low, high) = (sphere.centre.coords - reach, sphere.centre.coords + reach);
            let (vertices, faces, edges) = Default::default();
            return Self { vertices, faces, edges, low, high, rounding: 0.0, sphere: Some(sphere) };
        }
        let (shape, rounding) = shape.core();
        let vertices: Vec<Vector> = shape.vertices().iter().map(|v| (pose * v).coords).collect();
        let normals: Vec<Vector> = (0..shape.faces().len())
            .map(|f| {
                // Every face of a ConvexPolyhedron has an area; were one
                // degenerate all the same, a zero normal makes it count for nothing.
                shape.plane(f).map_or_else(Vector::zeros, |(n, _)| pose.rotation * n)
            })
            .collect();
        let edges = edges(shape, &vertices, &normals);
        let faces = normals
            .iter()
            .filter(|n| **n != Vector::zeros())
            .map(|n| (*n, highest_along(&vertices, n)))
            .collect();
        let (low, high) =
            vertices.iter().fold((vertices[0], vertices[0]), |(lo, hi), v| (lo.inf(v), hi.sup(v)));
        let reach = Vector::repeat(rounding);
        let (low, high) = (low - reach, high + reach);
        Self { vertices, faces, edges, low, high, rounding, sphere: None }
    }
}

/// Largest coordinate of any of the points along a direction.
pub(super) fn highest_along(points: &[Vector], direction: &Vector) -> f64 {
    points.iter().map(|p| p.dot(direction)).fold(f64::NEG_INFINITY, f64::max)
}

/// Smallest coordinate of any of the points along a direction.
pub(super) fn lowest_along(points: &[Vector], direction: &Vector) -> f64 {
    points.iter().map(|p| p.dot(direction)).fold(f64::INFINITY, f64::min)
}

/// Edges with both adjacent normals, each once.
fn edges(shape: &ConvexPolyhedron, vertices: &[Vector], normals: &[Vector]) -> Vec<Edge> {
    // (lower vertex, higher vertex, runs downwards, face): sorting brings the
    // two half edges of an edge together, the one running upwards first.
    let mut halves: Vec<(u32, u32, bool, usize)> = Vec::with_capacity(6 * vertices.len());
    for (face, corners) in shape.faces().iter().enumerate() {
        halves.extend(edges_of(corners).map(|(a, b)| (a.min(b), a.max(b), a > b, face)));
    }
    halves.sort_unstable();
    halves
        .chunks_exact(2)
        .filter_map(|pair| {
            let (from, to, _, left) = pair[0];
            let point = vertices[from as usize];
            // A zero-length edge has no direction; its neighbours cover its arc.
            let along = vertices[to as usize] - point;
            let (direction, length) = (along.try_normalize(0.0)?, along.norm());
            Some(Edge { point, direction, length, left: normals[left], right: normals[pair[1].3] })
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::super::testing::{assert_near, random, random_polyhedron, random_pose};
    use super::*;

    /// Law: V − E + F = 2; the edge runs along left × right; the bounding box
    /// is that of the transformed polyhedron.
    #[test]
    fn hull_is_consistent() {
        let mut rng = random(11);
        for _ in 0..50 {
            let shape = random_polyhedron(&mut rng, 0.01, 8);
            let pose = random_pose(&mut rng, 0.1);
            let hull = WorldHull::new(&shape, &pose);
            let euler =
                hull.vertices.len() as i64 - hull.edges.len() as i64 + hull.faces.len() as i64;
            assert_eq!(euler, 2, "Euler's formula");
            for e in &hull.edges {
                let cross = e.left.cross(&e.right);
                // Shallow edges lose digits in the cross product, not in the direction.
                assert_near("edge along left × right", cross.norm(), cross.dot(&e.direction), 1e-9);
                assert_near("edge in the left plane", 0.0, e.direction.dot(&e.left), 1e-9);
            }
            let moved = shape.transformed(&pose);
            let (low, high) = moved.bounding_box();
            assert_eq!((hull.low, hull.high), (low.coords, high.coords));
            for (f, (normal, offset)) in hull.faces.iter().enumerate() {
                let (n, d) = moved.plane(f).unwrap();
                assert_near("normal", 0.0, (n - normal).norm(), 1e-9);
                assert_near("offset", d, *offset, 1e-12);
            }
        }
    }
}
