//! What tests of shapes and of what is made of them share.

use super::{ConvexPolyhedron, Point};

/// Fails unless `got` is within `tolerance` of `expected`.
#[track_caller]
pub(crate) fn near(law: &str, got: f64, expected: f64, tolerance: f64) {
    assert!(
        (got - expected).abs() <= tolerance,
        "law: {law}: expected {expected:e}, got {got:e}, tolerance {tolerance:e}"
    );
}

#[test]
fn the_helper_can_fail() {
    for off in [-0.2, 0.2] {
        assert!(std::panic::catch_unwind(|| near("", 1.0 + off, 1.0, 0.1)).is_err());
    }
    near("", 1.05, 1.0, 0.1);
}

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
