//! Spheres beside grains and walls: the native contact solver's gaps against those of `measure`,
//! which finds the closest point in another way.

use pluvia::geometry::{ConvexPolyhedron, Vector};
use pluvia::measure::{WorldHull, separation};

use super::{REACH, ROUNDING, hulls, pairs::Cases};
use crate::near::near;

#[test]
fn gaps_of_spheres_are_exact() {
    let mut cases = Cases::new(5);
    let (mut contacts, mut inside) = (0, 0);
    for n in 0..3000 {
        let case = cases.next().expect("endless");
        let radius = case.b.radius_about_origin().min(0.02) * (0.2 + 0.1 * f64::from(n % 8));
        let ball = ConvexPolyhedron::ball(radius);
        let hull = WorldHull::new(&case.a, &case.pose_a);
        let mut place = case.pose_b;
        // From where the other body was to the surface: most spheres then touch.
        let first = separation(&hull, &WorldHull::new(&ball, &place));
        let push = REACH * (f64::from(n % 11) - 8.0) - first.gap;
        place.translation.vector += first.axis * push;
        let exact = separation(&hull, &WorldHull::new(&ball, &place));
        let points = hulls(&case.a, &ball, false).step(&case.pose_a, &place);
        let tolerance = ROUNDING * (case.a.radius_about_origin() + radius);
        let case = format!("case {n}, {}", case.name);
        let [point] = &points[..] else {
            assert!(points.is_empty(), "{case}, law: at most one point, got {}", points.len());
            assert!(exact.gap > REACH - tolerance, "{case}, law: a contact at {} m", exact.gap);
            continue;
        };
        contacts += 1;
        inside += i32::from(exact.gap < -radius);
        let off = (point.gap - exact.gap).abs();
        assert!(
            off <= tolerance,
            "{case}, law: gap {} m, got {} m, tolerance {tolerance:e} m",
            exact.gap,
            point.gap
        );
        // Near the centre a rounding of the distance turns the direction; and where two faces are
        // equally deep, either may be found.
        if exact.gap > 1e-3 * radius - radius {
            let axis: Vector = point.normal + exact.axis;
            assert!(
                axis.norm() < 2e-3,
                "{case}, law: normal {:?}, got {:?}",
                -exact.axis,
                point.normal
            );
        }
        let between = (point.on_a - point.on_b).dot(&point.normal);
        near(&format!("{case}: the points are the gap apart"), between, point.gap, tolerance);
    }
    assert!(contacts > 2000 && inside > 20, "law: spheres touch, {contacts}, {inside} inside");
}
