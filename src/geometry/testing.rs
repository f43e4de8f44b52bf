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
