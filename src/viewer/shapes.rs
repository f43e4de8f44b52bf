//! Shapes as lists of numbers: polygons by their corners, a group of pieces as
//! one shape without the faces at which its pieces meet.

use std::collections::HashMap;

use crate::apparatus::Piece;
use crate::geometry::{ConvexPolyhedron, Point};

/// Corners closer than this (m) are the same where pieces meet; far below any
/// dimension of an apparatus, far above rounding.
const SAME_CORNER: f64 = 1e-7;

/// Polygons with shared vertices.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Shape {
    /// Vertices in m.
    pub vertices: Vec<Point>,
    /// Loops of vertex numbers, counter-clockwise seen from outside.
    pub faces: Vec<Vec<u32>>,
}

impl Shape {
    /// One polyhedron.
    pub fn of(polyhedron: &ConvexPolyhedron) -> Self {
        Self { vertices: polyhedron.vertices().to_vec(), faces: polyhedron.faces().to_vec() }
    }

    /// Pieces in their places as one shape. Where two pieces meet in the same polygon, neither face
    /// is kept: seen through a transparent wall they would look like spokes.
    pub fn of_pieces(pieces: &[Piece]) -> Self {
        let mut whole = Self::default();
        let mut meeting: HashMap<Vec<[i64; 3]>, u32> = HashMap::new();
        let mut keys = Vec::new();
        for piece in pieces {
            let first = whole.vertices.len() as u32;
            let placed = piece.shape.vertices().iter().map(|v| piece.pose * v);
            whole.vertices.extend(placed);
            for face in piece.shape.faces() {
                let face: Vec<u32> = face.iter().map(|corner| corner + first).collect();
                let key = corners(&whole.vertices, &face);
                *meeting.entry(key.clone()).or_default() += 1;
                keys.push(key);
                whole.faces.push(face);
            }
        }
        let mut key = keys.iter();
        whole.faces.retain(|_| key.next().is_some_and(|k| meeting.get(k) == Some(&1)));
        whole
    }
}

/// The corners of a face in an order of their own, rounded.
fn corners(vertices: &[Point], face: &[u32]) -> Vec<[i64; 3]> {
    let rounded = |x: f64| (x / SAME_CORNER).round() as i64;
    let mut found: Vec<[i64; 3]> = face
        .iter()
        .map(|&corner| {
            let v = vertices[corner as usize];
            [rounded(v.x), rounded(v.y), rounded(v.z)]
        })
        .collect();
    found.sort_unstable();
    found
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::apparatus::Cylinder;
    use crate::geometry::{Pose, Vector};
    use crate::scenario::CylinderSpec;

    #[test]
    fn blocks_side_by_side_lose_the_faces_between_them() {
        let block = Arc::new(ConvexPolyhedron::cuboid(Vector::repeat(0.1)).expect("a cube"));
        let at = |x: f64| Piece { shape: block.clone(), pose: Pose::translation(x, 0.0, 0.0) };
        for (apart, expected) in [(0.1, 10), (0.2, 12)] {
            let row = Shape::of_pieces(&[at(0.0), at(apart)]);
            assert_eq!(
                row.faces.len(),
                expected,
                "law: two cubes {apart} m apart show {expected} (right) faces, got left"
            );
        }
    }

    #[test]
    fn the_cylinder_is_a_tube_without_spokes() {
        let cylinder = Cylinder::new(&CylinderSpec::default()).expect("the paper's cylinder");
        let walls = cylinder.pieces.len() - 1;
        let tube = Shape::of_pieces(&cylinder.pieces[..walls]);
        assert_eq!(tube.faces.len(), 4 * walls, "law: inside, outside, top and bottom a piece");
    }
}
