//! What a pair remembers from step to step: the feature that touches, the
//! names of its points, their impulses.

use nalgebra::UnitQuaternion;
use pluvia::{
    geometry::{ConvexPolyhedron, Pose, Vector},
    world::bullet::probe::{HullPair, ProbePoint, ProbeSettings},
};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use super::pairs::{box_of, direction};

fn pair(a: &ConvexPolyhedron, b: &ConvexPolyhedron) -> HullPair {
    HullPair::new(a, b, ProbeSettings::default()).expect("a pair")
}

/// A box of 10 mm in a slab's top by `depth` m, shifted and turned about z.
fn on_slab(depth: f64, x: f64, turn: f64) -> Pose {
    Pose::from_parts(
        Vector::new(x, 0.0, 0.015 - depth).into(),
        UnitQuaternion::from_axis_angle(&Vector::z_axis(), turn),
    )
}

fn slab_and_box() -> HullPair {
    pair(&box_of(0.4, 0.4, 0.02), &box_of(0.01, 0.01, 0.01))
}

fn ids(points: &[ProbePoint]) -> Vec<u32> {
    let mut ids: Vec<u32> = points.iter().map(|p| p.id).collect();
    ids.sort_unstable();
    ids
}

/// Law: a box on a slab rests on its four lower corners, all equally deep,
/// pushed straight up; a slab on a box the same the other way round.
#[test]
fn box_on_slab_has_four_points() {
    let slab = Pose::identity();
    for depth in [1e-3, 1e-5, 0.0, -1e-4, -4e-4] {
        for turn in [0.0, 0.3, 1.2] {
            let at = on_slab(depth, 0.03, turn);
            let points = slab_and_box().step(&slab, &at);
            assert_eq!(points.len(), 4, "law: four corners at depth {depth}, got {points:?}");
            let mut corners = vec![];
            for p in &points {
                assert!(
                    (p.gap + depth).abs() < 1e-8,
                    "law: gap of every corner, expected {}, got {}, tolerance 1e-8",
                    -depth,
                    p.gap
                );
                let up = (p.normal + Vector::z()).norm();
                assert!(up < 1e-6, "law: normal from box to slab is -z, got {:?}", p.normal);
                corners.push(at.inverse() * pluvia::geometry::Point::from(p.on_b));
            }
            for (x, y) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)] {
                let corner = pluvia::geometry::Point::new(x, y, -1.0) * 0.005;
                let near = corners.iter().map(|c| (c - corner).norm()).fold(1.0, f64::min);
                assert!(near < 1e-8, "law: a point at corner {corner}, nearest is {near} m away");
            }
            let mut turned_round = pair(&box_of(0.01, 0.01, 0.01), &box_of(0.4, 0.4, 0.02));
            let swapped = turned_round.step(&at, &slab);
            assert_eq!(swapped.len(), 4, "law: four points also with the box first");
        }
    }
}

/// Law: nothing beyond the reach; a box that overhangs touches where it lies.
#[test]
fn points_end_with_reach_and_edge() {
    let slab = Pose::identity();
    assert!(slab_and_box().step(&slab, &on_slab(-0.51e-3, 0.0, 0.1)).is_empty());
    let points = slab_and_box().step(&slab, &on_slab(1e-5, 0.2, 0.0));
    assert_eq!(points.len(), 4, "law: four points on an overhanging box");
    let farthest = points.iter().map(|p| p.on_a.x).fold(0.0, f64::max);
    assert!(
        (farthest - 0.2).abs() < 1e-7,
        "law: contact ends at the slab's edge 0.2, got {farthest}"
    );
}

/// Law: under jitter smaller than the hysteresis, points keep their names and
/// grow old; without memory the features alternate.
#[test]
fn features_are_kept_under_jitter() {
    let mut rng = Pcg64Mcg::seed_from_u64(3);
    // A box lying askew on another's edge: face and edges of nearly equal depth.
    let cube = box_of(0.01, 0.01, 0.01);
    let mut distinct_without_memory = std::collections::HashSet::new();
    let mut kept = pair(&cube, &cube);
    let mut forgetful = pair(&cube, &cube);
    let base = Pose::from_parts(
        Vector::new(0.0098, 0.0098, 0.001).into(),
        UnitQuaternion::from_axis_angle(&Vector::z_axis(), 1e-4),
    );
    let first = ids(&kept.step(&Pose::identity(), &base));
    assert!(!first.is_empty(), "the boxes touch");
    for step in 1..200 {
        let jitter = direction(&mut rng) * rng.random_range(0.0..4e-6);
        let moved = Pose::from_parts((base.translation.vector + jitter).into(), base.rotation);
        let points = kept.step(&Pose::identity(), &moved);
        assert_eq!(ids(&points), first, "law: same names at step {step}");
        assert!(
            points.iter().all(|p| p.age == step),
            "law: points grow old, expected {step} steps, got {points:?}"
        );
        forgetful.forget();
        distinct_without_memory.insert(ids(&forgetful.step(&Pose::identity(), &moved)));
    }
    assert!(
        distinct_without_memory.len() > 1,
        "the pair is no test of memory: without it, the same points came at every step"
    );
}

/// Law: a point that goes on carries its normal and friction impulse; one
/// that vanished and came again starts from nothing.
#[test]
fn impulses_are_carried() {
    let mut pair = slab_and_box();
    let slab = Pose::identity();
    let first = pair.step(&slab, &on_slab(1e-5, 0.0, 0.2));
    let friction = Vector::new(0.3, -0.2, 0.0);
    for (i, p) in first.iter().enumerate() {
        assert_eq!((p.age, p.impulse), (0, 0.0), "law: new points begin at nothing");
        pair.set_impulse(i, 1.0 + i as f64, &friction).expect("a point");
    }
    let second = pair.step(&slab, &on_slab(1.2e-5, 2e-5, 0.2005));
    for (i, old) in first.iter().enumerate() {
        let p = second.iter().find(|p| p.id == old.id).expect("the same point");
        assert!(
            p.age == 1 && (p.impulse - (1.0 + i as f64)).abs() < 1e-6,
            "law: impulse goes on, expected {}, got {p:?}, tolerance 1e-6",
            1.0 + i as f64
        );
        assert!((p.friction - friction).norm() < 1e-6, "law: friction goes on, got {p:?}");
    }
    assert!(pair.step(&slab, &on_slab(-1e-3, 0.0, 0.2)).is_empty(), "lifted off");
    for p in pair.step(&slab, &on_slab(1e-5, 0.0, 0.2)) {
        assert_eq!((p.age, p.impulse), (0, 0.0), "law: after a flight a contact is new");
    }
}

/// Law: where the name of a point changes but not its place, the impulse is
/// found by distance; where the normal turns, the impulse as a vector is kept
/// as far as it pushes.
#[test]
fn impulses_are_found_by_distance_and_follow_the_normal() {
    // A wedge whose ridge lies along the slab's edge: the slab's top face and
    // its side push at right angles.
    let mut pair = slab_and_box();
    let slab = Pose::identity();
    // A corner of the box hangs over the slab's edge by 0.1 mm in x and lies 0.05 mm deep.
    let at = |x: f64, depth: f64| {
        Pose::from_parts(
            Vector::new(0.205 - x, 0.0, 0.015 - depth).into(),
            UnitQuaternion::identity(),
        )
    };
    let top = pair.step(&slab, &at(1e-4, 5e-5));
    assert!((top[0].normal + Vector::z()).norm() < 1e-6, "pushed up, got {:?}", top[0].normal);
    let push = Vector::new(0.5, 0.0, 1.0);
    for i in 0..top.len() {
        // On A, from B: down; friction along -x on A is +x on B.
        pair.set_impulse(i, push.z, &-Vector::new(push.x, 0.0, 0.0)).expect("a point");
    }
    let side = pair.step(&slab, &at(2e-5, 1e-4));
    assert!((side[0].normal + Vector::x()).norm() < 1e-6, "pushed aside, got {:?}", side[0].normal);
    let carried: Vec<_> = side.iter().filter(|p| p.age == 1).collect();
    assert!(!carried.is_empty(), "law: points within a tenth of a grain go on, got {side:?}");
    for p in carried {
        let whole = p.normal * p.impulse + p.friction;
        assert!(
            (whole + push).norm() < 1e-6 && (p.impulse - push.x).abs() < 1e-6,
            "law: the impulse as a vector goes on, expected {:?} with normal part {}, got {p:?}",
            -push,
            push.x
        );
    }
}

/// Law: however little or far a body moves, the gaps of its points are those
/// of its corners where they are now; points that are held (up to 0.02 mm) as
/// well as points found anew, without a jump between them.
#[test]
fn gaps_follow_the_bodies_held_or_not() {
    let slab = Pose::identity();
    let mut pair = slab_and_box();
    let first = ids(&pair.step(&slab, &on_slab(1e-5, 0.0, 0.0)));
    for step in 1..60 {
        let by = f64::from(step) * 1e-6;
        // Sideways, up, and tilted about y by as much at its edges.
        let tilt = UnitQuaternion::from_axis_angle(&Vector::y_axis(), 0.2 * by / 0.005);
        let at = Pose::from_parts(Vector::new(by, 0.0, 0.015 - 1e-5 + 0.3 * by).into(), tilt);
        let points = pair.step(&slab, &at);
        assert_eq!(ids(&points), first, "law: the same four points at {by:e} m");
        for p in &points {
            let on_box = at.inverse() * pluvia::geometry::Point::from(p.on_b);
            let corner = on_box.map(|x| x.signum() * 0.005);
            let expected = (at * corner).z - 0.01;
            assert!(
                (on_box - corner).norm() < 1e-8 && (p.gap - expected).abs() < 1e-8,
                "law: gap of a corner at {by:e} m, expected {expected:e}, got {p:?}, tolerance 1e-8"
            );
        }
    }
}

/// Law: whatever corner is below a face is a point of the contact, whichever of its faces a body
/// was on before: one with a keel that rocks from side to side, by little and by more than points
/// are held for. The face of the last step was kept while another corner was up to 0.02 mm lower;
/// a loaded grain that rocked was pushed up each time it came over, and never came to rest.
#[test]
fn a_body_that_rocks_over_its_keel_has_points_on_both_sides() {
    // A cube of 10 mm whose lower face has a ridge along z, 0.01 mm high.
    let (half, side) = (0.005, 0.00499);
    let profile = [(0.0, -half), (half, -side), (half, half), (-half, half), (-half, -side)];
    let keeled = ConvexPolyhedron::prism(&profile, -half, half).expect("a prism");
    let slab = Pose::translation(0.0, -0.01, 0.0);
    for step in [0.1e-3, 0.7e-3, 3e-3] {
        let mut pair = pair(&box_of(0.4, 0.02, 0.4), &keeled);
        let mut angle: f64 = 0.0;
        let mut by = step;
        for n in 0..400 {
            angle += by;
            if angle.abs() > 4e-3 {
                by = -step * angle.signum();
            }
            let turn = UnitQuaternion::from_axis_angle(&Vector::z_axis(), angle);
            let at = Pose::from_parts(Vector::new(0.0, half - 2e-6, 0.0).into(), turn);
            let points = pair.step(&slab, &at);
            for corner in keeled.vertices() {
                let gap = (at * corner).y;
                let is_it = |p: &ProbePoint| {
                    (p.gap - gap).abs() < 1e-8 && (p.on_b - (at * corner).coords).norm() < 1e-7
                };
                assert!(
                    gap > -1e-7 || points.iter().any(is_it),
                    "law: corner {corner} is a point in step {n} of {step} rad, at {angle} rad, \
                     expected gap {gap:e} m, tolerance 1e-8, got {points:?}"
                );
            }
        }
    }
}
