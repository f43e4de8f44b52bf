//! What tests of shapes and of what is made of them share.

mod near;

use super::{ConvexPolyhedron, Point};

pub(crate) use near::near;

/// Of edge 2√2.
pub(crate) fn regular_tetrahedron() -> ConvexPolyhedron {
    ConvexPolyhedron::new(
        vec![
            Point::new(1.0, 1.0, 1.0),
            Point::new(1.0, -1.0, -1.0),
            Point::new(-1.0, 1.0, -1.0),
            Point::new(-1.0, -1.0, 1.0),
        ],
        vec![vec![0, 1, 2], vec![0, 3, 1], vec![0, 2, 3], vec![1, 3, 2]],
    )
    .unwrap()
}

/// Plate number `n` of 32: 28 mm wide, its thickness grows by 1 mm from one side to the other.
pub(crate) fn flat_plate(n: u32) -> ConvexPolyhedron {
    let thinnest = 1.5e-3 + f64::from(n) * 1e-3 / 32.0;
    let sides = [(0.0, 0.0), (0.028, 0.0), (0.028, 0.028), (0.008, 0.028)];
    let lower = sides.map(|(x, y)| Point::new(x, y, 0.0)).to_vec();
    let upper = sides.map(|(x, y)| Point::new(x, y, thinnest + x / 28.0)).to_vec();
    ConvexPolyhedron::frustum(lower, upper).unwrap()
}
