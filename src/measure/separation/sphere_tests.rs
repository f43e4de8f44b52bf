//! Spheres: their distances are exact. `tests/it/collision` compares the native contact solver's.

use super::super::testing::assert_near;
use super::*;
use crate::geometry::{ConvexPolyhedron, Pose};

fn at(x: f64, y: f64, z: f64) -> Pose {
    Pose::translation(x, y, z)
}

/// Law: exact beside faces, edges and corners, within, and between spheres, in either order.
#[test]
fn distances_of_spheres_are_exact() {
    let cube = WorldHull::new(
        &ConvexPolyhedron::cuboid(Vector::repeat(2.0)).expect("a cube"),
        &Pose::identity(),
    );
    let ball = |pose: &Pose| WorldHull::new(&ConvexPolyhedron::ball(0.5), pose);
    for (what, place, gap) in [
        ("face", at(0.3, 0.9, 2.0), 0.5),
        ("in the face", at(0.3, 0.9, 1.25), -0.25),
        ("edge", at(1.0 + 3.0, 0.2, 1.0 + 4.0), 4.5),
        ("corner", at(1.0 + 2.0, 1.0 + 3.0, 1.0 + 6.0), 6.5),
        ("centre inside", at(0.1, 0.2, 0.75), -0.75),
    ] {
        let [one, other] = [separation(&cube, &ball(&place)), separation(&ball(&place), &cube)];
        assert_near(what, gap, one.gap, 1e-12);
        assert_near(what, gap, other.gap, 1e-12);
        assert_near("axes are opposite", 0.0, (one.axis + other.axis).norm(), 1e-12);
    }
    let two = separation(&ball(&at(0.0, 0.0, 0.0)), &ball(&at(0.0, 3.0, 4.0)));
    assert_near("two spheres", 4.0, two.gap, 1e-12);
    assert_near("from A to B", 0.0, (two.axis - Vector::new(0.0, 0.6, 0.8)).norm(), 1e-12);
}
