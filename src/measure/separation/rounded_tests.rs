//! Rounded polyhedra: distances and depths are exact, proved by the gap along the axis that comes
//! with them. `tests/it/collision` compares the native contact solver's.

use super::super::testing::{
    assert_near, random, random_direction, random_polyhedron, random_pose,
};
use super::*;
use crate::geometry::{ConvexPolyhedron, Pose, rounded_within};

fn rounded(core: &ConvexPolyhedron, radius: f64) -> ConvexPolyhedron {
    ConvexPolyhedron::of_rounded(core.clone(), radius).expect("a rounded polyhedron")
}

#[test]
fn distances_of_rounded_cubes_are_exact() {
    let cube = ConvexPolyhedron::cuboid(Vector::repeat(2.0)).expect("a cube");
    let at = |x: f64, y: f64, z: f64| Pose::translation(x, y, z);
    let one = WorldHull::new(&rounded(&cube, 0.25), &Pose::identity());
    for (what, pose, gap) in [
        ("faces", at(0.3, 0.1, 3.0), 1.0 - 0.75),
        ("faces, overlapping", at(0.3, 0.1, 2.6), 0.6 - 0.75),
        ("cores overlap", at(0.3, 0.1, 1.9), -0.1 - 0.75),
        ("edges", at(2.0 + 3.0, 0.2, 2.0 + 4.0), 5.0 - 0.75),
        ("corners", at(2.0 + 2.0, 2.0 + 3.0, 2.0 + 6.0), 7.0 - 0.75),
    ] {
        let two = WorldHull::new(&rounded(&cube, 0.5), &pose);
        let [there, back] = [separation(&one, &two), separation(&two, &one)];
        assert_near(what, gap, there.gap, 1e-12);
        assert_near(what, gap, back.gap, 1e-12);
        assert_near("axes are opposite", 0.0, (there.axis + back.axis).norm(), 1e-12);
    }
    let ball = |pose| WorldHull::new(&ConvexPolyhedron::ball(0.5), &pose);
    let corner = separation(&one, &ball(at(1.0 + 2.0, 1.0 + 3.0, 1.0 + 6.0)));
    assert_near("a sphere and a corner", 7.0 - 0.75, corner.gap, 1e-12);
    let flat = WorldHull::new(&cube, &at(0.0, 0.0, 2.1));
    assert_near("a rounded cube on a cube", 0.1 - 0.25, separation(&one, &flat).gap, 1e-12);
}

/// Law: no axis shows a wider gap than the distance, and along the axis of the distance the gap is
/// as wide: both bodies touch two parallel planes that are the distance apart.
#[test]
fn the_gap_along_the_axis_is_the_distance() {
    let mut rng = random(23);
    let (mut corners, mut overlaps) = (0, 0);
    for n in 0..400 {
        let shape = |rng: &mut _, share: f64| {
            let body = random_polyhedron(rng, 1.0, 8);
            let rounded = rounded_within(&body, share).expect("a core");
            ConvexPolyhedron::of_rounded(rounded.core, rounded.radius).expect("a body")
        };
        let a = shape(&mut rng, 0.1 + 0.1 * f64::from(n % 8));
        let b = if n % 3 == 0 { random_polyhedron(&mut rng, 1.0, 8) } else { shape(&mut rng, 0.3) };
        let (pose_a, pose_b) = (random_pose(&mut rng, 0.1), random_pose(&mut rng, 1.6));
        let (hull_a, hull_b) = (WorldHull::new(&a, &pose_a), WorldHull::new(&b, &pose_b));
        let found = separation(&hull_a, &hull_b);
        let radii = hull_a.rounding + hull_b.rounding;
        let seen = |axis: &Vector| {
            lowest_along(&hull_b.vertices, axis) - highest_along(&hull_a.vertices, axis) - radii
        };
        assert_near("unit axis", 1.0, found.axis.norm(), 1e-12);
        assert_near("the gap along the axis", found.gap, seen(&found.axis), 1e-9);
        for _ in 0..50 {
            let axis = random_direction(&mut rng);
            assert!(seen(&axis) <= found.gap + 1e-9, "law: no wider gap, case {n}");
        }
        corners += i32::from(found.gap > 0.0);
        overlaps += i32::from(found.gap < 0.0);
        let enough = separation_within(&hull_a, &hull_b, 0.05);
        assert_eq!(enough.is_some(), found.gap <= 0.05, "law: within 0.05, case {n}");
    }
    assert!(corners > 100 && overlaps > 100, "law: both, {corners} and {overlaps}");
}
