//! The hull–hull test of the native contact solver against the exact
//! separating axis test of `measure`, which shares no code with it.

mod memory;
mod pairs;
mod rounded;
mod spheres;

use std::sync::Arc;

use nalgebra::{Isometry3, UnitQuaternion};
use pluvia::{
    geometry::{ConvexPolyhedron, Pose, Vector},
    measure::{Separation, WorldHull, separation},
    world::bullet::probe::{HullPair, ProbeSettings},
};

use crate::near::near;
use pairs::{Case, Cases};

/// A pair whose points are kept up to [`REACH`].
fn hulls(a: &ConvexPolyhedron, b: &ConvexPolyhedron, portable: bool) -> HullPair {
    let settings = ProbeSettings { portable, speculative_margin: REACH, ..Default::default() };
    HullPair::new(a, b, settings).expect("a pair")
}

/// Rounding of the narrow phase: it works in single precision in the frame of
/// one of the bodies, so that errors are some 1e-7 of the larger body; ten
/// times that for axes of edges that are nearly parallel.
const ROUNDING: f64 = 1e-6;

/// A face is preferred to edges that are better by less than this, in m
/// (`FACE_PREFERENCE` in src/scale.rs).
const FACE_PREFERENCE: f64 = 5e-6;

/// Last step's feature is kept while no other is better by this, in m
/// (`HYSTERESIS` in src/scale.rs).
const HYSTERESIS: f64 = 20e-6;

/// While nothing has moved by more, points are held, in m (`HOLD` in src/scale.rs).
const HOLD: f64 = 20e-6;

/// Gap up to which points are kept, in m.
const REACH: f64 = 0.5e-3;

/// Edges nearer to parallel than this sine are left to the faces beside them
/// (`PARALLEL` in cpp/hull_axis_kernels.h).
const PARALLEL: f64 = 4e-4;

/// What is lost by that, as a share of the smaller body's radius.
const NARROW: f64 = 1e-4;

/// Whether an edge of A and one of B are nearly parallel.
fn nearly_parallel_edges(case: &Case) -> bool {
    let directions = |shape: &ConvexPolyhedron, pose: &Pose| -> Vec<Vector> {
        let v = shape.vertices();
        let edges = shape.edges().into_iter();
        edges
            .filter_map(|(i, j)| (pose * (v[j as usize] - v[i as usize])).try_normalize(0.0))
            .collect()
    };
    let of_b = directions(&case.b, &case.pose_b);
    directions(&case.a, &case.pose_a)
        .iter()
        .any(|e| of_b.iter().any(|f| (1e-9..PARALLEL).contains(&e.cross(f).norm())))
}

/// Lowest point of B minus highest point of A along an axis, in m.
fn gap_along(case: &Case, axis: &Vector) -> f64 {
    let along = |shape: &ConvexPolyhedron, pose: &Pose| {
        shape.vertices().iter().map(|v| (pose * v).coords.dot(axis)).collect::<Vec<_>>()
    };
    let low = along(&case.b, &case.pose_b).into_iter().fold(f64::INFINITY, f64::min);
    let high = along(&case.a, &case.pose_a).into_iter().fold(f64::NEG_INFINITY, f64::max);
    low - high
}

/// How far a point lies outside a body, in m; negative inside.
fn outside(shape: &ConvexPolyhedron, pose: &Isometry3<f64>, point: &Vector) -> f64 {
    let local = pose.inverse() * pluvia::geometry::Point::from(*point);
    (0..shape.faces().len())
        .filter_map(|f| shape.plane(f))
        .map(|(normal, offset)| normal.dot(&local.coords) - offset)
        .fold(f64::NEG_INFINITY, f64::max)
}

/// Everything that must hold for a pair seen for the first time.
fn judge(case: &Case) -> Result<Separation, String> {
    let exact =
        separation(&WorldHull::new(&case.a, &case.pose_a), &WorldHull::new(&case.b, &case.pose_b));
    let tolerance = ROUNDING * (case.a.radius_about_origin() + case.b.radius_about_origin());
    let fail = |law: &str, expected: f64, got: f64, tolerance: f64| {
        Err(format!(
            "{}: {law}: expected {expected:e} m, got {got:e} m, tolerance {tolerance:e} m",
            case.name
        ))
    };
    let mut pair = hulls(&case.a, &case.b, false);

    // The search over axes.
    let all = pair.widest_gap(&case.pose_a, &case.pose_b, true);
    let pruned = pair.widest_gap(&case.pose_a, &case.pose_b, false);
    let strict = |error: f64| {
        if error > tolerance && nearly_parallel_edges(case) {
            tolerance + NARROW * case.a.radius_about_origin().min(case.b.radius_about_origin())
        } else {
            tolerance
        }
    };
    for (law, got) in [("widest gap", all), ("widest gap, pruned", pruned)] {
        let error = (got.gap - exact.gap).abs();
        if exact.gap <= 0.0 && error > strict(error) {
            return fail(law, exact.gap, got.gap, strict(error));
        }
        // Apart, any axis that shows a gap is as true as another; the widest
        // is a lower bound of the distance that need not be the same. The pruned
        // search looks for edges no farther from each other than the reach.
        let in_sight = law == "widest gap" || exact.gap <= REACH;
        if exact.gap > 0.0 && in_sight && got.gap < -tolerance {
            return fail("no overlap where there is none", exact.gap, got.gap, tolerance);
        }
        let true_gap = gap_along(case, &got.axis);
        if (true_gap - got.gap).abs() > tolerance {
            return fail("gap along its own axis", true_gap, got.gap, tolerance);
        }
    }

    // The contact.
    let points = pair.step(&case.pose_a, &case.pose_b);
    let edges = points.iter().filter(|p| p.id >> 28 == 3).count();
    let far = points.iter().filter(|p| p.id >> 28 != 3 && p.gap > HOLD).count();
    if points.len() > 8 || far > 4 || edges > 1 {
        return Err(format!(
            "{}: law: at most 8 points, 4 of a face that do not touch, and one of edges, got {}, \
             {far} and {edges}",
            case.name,
            points.len()
        ));
    }
    let deepest = points.iter().map(|p| p.gap).fold(f64::INFINITY, f64::min);
    let bound = FACE_PREFERENCE + tolerance;
    if exact.gap > REACH + tolerance && !points.is_empty() {
        return fail("no contact beyond the reach", exact.gap, deepest, tolerance);
    }
    if exact.gap < -tolerance {
        if points.is_empty() {
            return Err(format!(
                "{}: law: nothing missed, expected overlap {:e} m, got no contact",
                case.name, -exact.gap
            ));
        }
        if (deepest - exact.gap).abs() > bound {
            return fail("depth", exact.gap, deepest, bound);
        }
    }
    for p in &points {
        let along = gap_along(case, &-p.normal);
        if (along - exact.gap).abs() > bound && exact.gap < 0.0 {
            return fail("moving by the depth along the normal parts", exact.gap, along, bound);
        }
        if p.gap < along - tolerance {
            return fail(
                "no point deeper than the bodies along the normal",
                along,
                p.gap,
                tolerance,
            );
        }
        if p.gap > REACH + tolerance {
            return fail("points within reach", REACH, p.gap, tolerance);
        }
        let between = p.normal.dot(&(p.on_a - p.on_b));
        if (between - p.gap).abs() > tolerance {
            return fail("gap between the points", between, p.gap, tolerance);
        }
        let across = (p.on_a - p.on_b - p.normal * between).norm();
        if across > tolerance {
            return fail("the two ends face each other", 0.0, across, tolerance);
        }
        for (body, shape, pose, point) in
            [("A", &case.a, &case.pose_a, &p.on_a), ("B", &case.b, &case.pose_b, &p.on_b)]
        {
            let out = outside(shape, pose, point);
            if out > bound {
                return fail(&format!("point on the surface of {body}"), 0.0, out, bound);
            }
        }
    }
    Ok(exact)
}

fn judge_many(count: usize, seed: u64) {
    let (mut overlapping, mut near, mut apart) = (0, 0, 0);
    let mut faults = vec![];
    for case in Cases::new(seed).take(count) {
        match judge(&case) {
            Ok(s) if s.gap < 0.0 => overlapping += 1,
            Ok(s) if s.gap < REACH => near += 1,
            Ok(_) => apart += 1,
            Err(fault) => faults.push(fault),
        }
    }
    println!("{overlapping} overlapping, {near} within reach, {apart} apart");
    assert!(
        faults.is_empty(),
        "{} of {count} pairs fail, among them:\n{}",
        faults.len(),
        faults.iter().take(20).cloned().collect::<Vec<_>>().join("\n")
    );
    assert!(
        overlapping > count / 4 && near > count / 10 && apart > count / 20,
        "expected pairs of every kind, got {overlapping} overlapping, {near} near, {apart} apart"
    );
}

#[test]
fn random_pairs_agree_with_the_exact_test() {
    judge_many(4000, 1);
}

#[test]
#[ignore = "slow: make test-all"]
fn a_quarter_of_a_million_random_pairs_agree_with_the_exact_test() {
    std::thread::scope(|scope| {
        for seed in 2..4 {
            scope.spawn(move || judge_many(125_000, seed));
        }
    });
}

/// Law: a pair that remembers says the same as one that sees the bodies for
/// the first time, within the hysteresis: slow and fast, sliding, turning,
/// leaving and coming back.
#[test]
fn moving_pairs_agree_with_the_exact_test() {
    let (mut touching, mut apart) = (0, 0);
    for (number, case) in Cases::new(7).take(150).enumerate() {
        let mut pair = hulls(&case.a, &case.b, false);
        let mut motion = pairs::Motion::new(number as u64);
        let mut now = Case {
            name: case.name.clone(),
            a: Arc::clone(&case.a),
            b: Arc::clone(&case.b),
            ..case
        };
        let hull_a = WorldHull::new(&now.a, &now.pose_a);
        let tolerance = ROUNDING * (now.a.radius_about_origin() + now.b.radius_about_origin());
        let bound = HYSTERESIS + FACE_PREFERENCE + tolerance;
        for step in 0..40 {
            motion.advance(&mut now, &hull_a);
            let exact = separation(&hull_a, &WorldHull::new(&now.b, &now.pose_b));
            let points = pair.step(&now.pose_a, &now.pose_b);
            let deepest = points.iter().map(|p| p.gap).fold(f64::INFINITY, f64::min);
            if exact.gap < -bound {
                touching += 1;
                near(&format!("{}, step {step}: depth, m", now.name), deepest, exact.gap, bound);
            } else if exact.gap > 0.0 {
                apart += 1;
                assert!(
                    deepest >= -bound,
                    "{}, step {step}: law: no overlap, expected {:e} m, got {deepest:e} m, tolerance {bound:e} m",
                    now.name,
                    exact.gap
                );
            }
        }
    }
    assert!(touching > 1000 && apart > 200, "expected both kinds, got {touching} and {apart}");
}

/// Law: the code for wide vectors and the one that runs everywhere give the same bits.
#[test]
fn portable_code_gives_the_same_bits() {
    for case in Cases::new(5).take(500) {
        let of = |portable| {
            let mut pair = hulls(&case.a, &case.b, portable);
            let gap = pair.widest_gap(&case.pose_a, &case.pose_b, true);
            (gap, pair.step(&case.pose_a, &case.pose_b))
        };
        assert_eq!(of(true), of(false), "{}: portable left, fastest right", case.name);
    }
}

/// Law: where nothing but a pair of edges parts two bodies, a pair seen for the
/// first time has no contact beyond the reach, and the edges' gap within. The
/// pruned search saw such needles overlap; beyond the reach nobody asks it.
#[test]
fn crossed_needles_are_parted_by_their_edges() {
    let needle = |axis: Vector| {
        // Stands on an edge.
        let turn = UnitQuaternion::from_scaled_axis(axis * std::f64::consts::FRAC_PI_4);
        let size = axis * 28e-3 + (Vector::repeat(1.0) - axis) * 0.3e-3;
        (Arc::new(pairs::box_of(size.x, size.y, size.z)), turn)
    };
    let (a, turn_a) = needle(Vector::x());
    let (b, turn_b) = needle(Vector::y());
    let half_diagonals = 0.3e-3 * std::f64::consts::SQRT_2;
    for gap in [0.63e-3, 0.3e-3, -0.1e-3] {
        let case = Case {
            name: format!("needles, gap {gap:e} m"),
            a: Arc::clone(&a),
            b: Arc::clone(&b),
            pose_a: Pose::from_parts(Vector::zeros().into(), turn_a),
            pose_b: Pose::from_parts((Vector::z() * (half_diagonals + gap)).into(), turn_b),
        };
        let exact = judge(&case).unwrap_or_else(|fault| panic!("{fault}"));
        near(&format!("{}: edge over edge, m", case.name), exact.gap, gap, 1e-9);
        let points = hulls(&case.a, &case.b, false).step(&case.pose_a, &case.pose_b).len();
        let expected = usize::from(gap < REACH);
        assert_eq!(points, expected, "{}: law: points of a pair of edges", case.name);
    }
}
