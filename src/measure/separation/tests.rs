//! Tests of the separating axis test against its definition.

use super::super::testing::{
    assert_near, common_volume, cube, near, random, random_direction, random_polyhedron,
    random_pose, random_rotation,
};
use super::*;
use crate::geometry::{ConvexPolyhedron, Pose};
use nalgebra::UnitQuaternion;

fn hull(shape: &ConvexPolyhedron) -> WorldHull {
    WorldHull::new(shape, &Pose::identity())
}

/// s(n) from the definition.
fn gap_along(a: &ConvexPolyhedron, b: &ConvexPolyhedron, n: &Vector) -> f64 {
    let low = b.vertices().iter().map(|v| v.coords.dot(n)).fold(f64::INFINITY, f64::min);
    let high = a.vertices().iter().map(|v| v.coords.dot(n)).fold(f64::NEG_INFINITY, f64::max);
    low - high
}

/// The widest gap over every face normal and every product of two edges,
/// both ways round, with true supports: no pruning, nothing prepared.
fn brute_force(a: &ConvexPolyhedron, b: &ConvexPolyhedron) -> f64 {
    let mut axes = vec![];
    for shape in [a, b] {
        axes.extend((0..shape.faces().len()).map(|f| shape.plane(f).unwrap().0));
    }
    let directions = |s: &ConvexPolyhedron| {
        let v = s.vertices().to_vec();
        s.edges().iter().map(|&(i, j)| v[j as usize] - v[i as usize]).collect::<Vec<_>>()
    };
    for e in directions(a) {
        for f in directions(b) {
            axes.extend(e.normalize().cross(&f.normalize()).try_normalize(1e-9));
        }
    }
    axes.iter()
        .flat_map(|n| [gap_along(a, b, n), gap_along(a, b, &-n)])
        .fold(f64::NEG_INFINITY, f64::max)
}

/// All that must hold for one pair, scaled to bodies of about 1.
fn judge(a: &ConvexPolyhedron, b: &ConvexPolyhedron) -> Result<f64, String> {
    let (ha, hb) = (hull(a), hull(b));
    let got = separation(&ha, &hb);
    let widest = brute_force(a, b);
    if widest < 0.0 {
        near("widest gap against all axes", widest, got.gap, 1e-12)?;
    } else if !(-1e-12..=widest + 1e-12).contains(&got.gap) {
        // Apart, axes that belong to no face of A − B may see a wider gap.
        return Err(format!("bodies {widest} apart, got {}", got.gap));
    }
    near("gap along its own axis", gap_along(a, b, &got.axis), got.gap, 1e-13)?;
    let back = separation(&hb, &ha);
    near("gap of B from A", got.gap, back.gap, 1e-13)?;
    near("axis has unit length", 1.0, got.axis.norm(), 1e-12)?;
    for most in [-0.1, 0.0, 0.05] {
        let within = separation_within(&ha, &hb, most);
        if within != (got.gap <= most).then_some(got) {
            return Err(format!("{got:?} within {most}: {within:?}"));
        }
    }
    Ok(got.gap)
}

fn at(shape: &ConvexPolyhedron, x: f64, y: f64, z: f64) -> ConvexPolyhedron {
    shape.transformed(&Pose::translation(x, y, z))
}

fn turned(shape: &ConvexPolyhedron, axis: Vector, angle: f64) -> ConvexPolyhedron {
    let rotation = UnitQuaternion::from_axis_angle(&nalgebra::Unit::new_normalize(axis), angle);
    shape.transformed(&Pose::from_parts(Vector::zeros().into(), rotation))
}

/// Law: for two axis-parallel cubes the depth is the smallest of the three
/// overlaps of their intervals; apart, the gap is the largest interval gap.
#[test]
fn parallel_cubes() {
    let a = cube(1.0);
    for (x, y, z) in [
        (0.9, 0.0, 0.0),
        (0.9, 0.5, 0.2),
        (0.0, -0.3, 0.0),
        (0.0, 0.0, 0.0),
        (1.0, 0.2, 0.0),
        (1.5, 0.0, 0.3),
        (-0.7, 0.8, -0.75),
    ] {
        let expected = [x, y, z].map(|d: f64| d.abs() - 1.0).into_iter().fold(-9.0, f64::max);
        let got = judge(&a, &at(&a, x, y, z)).unwrap();
        assert_near("interval overlap of cubes", expected, got, 1e-15);
    }
}

/// Law: a cube stood on its corner dips below its centre by half the space
/// diagonal; corner in face gives that depth, whatever the turn.
#[test]
fn corner_in_face() {
    let upright = turned(&cube(1.0), Vector::new(1.0, -1.0, 0.0), (1.0f64 / 3.0).sqrt().acos());
    let lowest = upright.vertices().iter().map(|v| v.z).fold(0.0, f64::min);
    assert_near("corner straight below", -0.75f64.sqrt(), lowest, 1e-15);
    for turn in [0.0, 0.1, 1.0, 2.5] {
        for gap in [-0.1, -1e-6, 0.0, 1e-6, 0.1] {
            let corner = turned(&upright, Vector::z(), turn);
            let above = at(&corner, 0.1, -0.05, 0.5 + 0.75f64.sqrt() + gap);
            let got = judge(&cube(1.0), &above).unwrap();
            assert_near("corner against face", gap, got, 1e-14);
        }
    }
}

/// Law: two cubes crossed edge to edge, each dipping half its face
/// diagonal: the depth is √2 minus the distance of their centres.
#[test]
fn edge_on_edge() {
    let lower = turned(&cube(1.0), Vector::x(), std::f64::consts::FRAC_PI_4);
    let upper = turned(&cube(1.0), Vector::y(), std::f64::consts::FRAC_PI_4);
    for gap in [-0.2, -1e-6, 0.0, 1e-6, 0.3] {
        let got = judge(&lower, &at(&upper, 0.1, 0.1, 2.0f64.sqrt() + gap)).unwrap();
        assert_near("edge across edge", gap, got, 1e-14);
    }
    // Parallel edges, one above the other: no product of edges exists for
    // that axis, and the smallest translation is along a face normal.
    let other = turned(&cube(1.0), Vector::x(), std::f64::consts::FRAC_PI_4);
    let got = judge(&lower, &at(&other, 0.3, 0.0, 2.0f64.sqrt() - 0.1)).unwrap();
    assert_near("ridge on ridge", -0.1 / 2.0f64.sqrt(), got, 1e-14);
}

/// Law: apart, the gap found never exceeds the true distance; for two
/// cubes corner to corner the distance is √3 times the gap.
#[test]
fn gap_is_a_lower_bound_of_distance() {
    let got = judge(&cube(1.0), &at(&cube(1.0), 1.1, 1.1, 1.1)).unwrap();
    assert_near("corner to corner", 0.1, got, 1e-15);
}

/// Thousands of random pairs from deep to apart, of like and unlike size.
#[test]
fn random_pairs_agree_with_brute_force() {
    let mut rng = random(21);
    let (mut overlapping, mut apart) = (0, 0);
    for i in 0..2500 {
        let cuts = i % 9;
        let a = random_polyhedron(&mut rng, 1.0, cuts);
        let scale = [1.0, 0.3, 0.05, 1.7][i % 4];
        let b = random_polyhedron(&mut rng, scale, 9 - cuts);
        let b = b.transformed(&random_pose(&mut rng, 1.2));
        match judge(&a, &b) {
            Ok(gap) if gap < 0.0 => overlapping += 1,
            Ok(_) => apart += 1,
            Err(what) => panic!("pair {i}: {what}"),
        }
    }
    assert!(overlapping > 800 && apart > 500, "{overlapping} overlapping, {apart} apart");
}

/// Copies of one polyhedron, moved, turned a little or scaled: parallel
/// faces and edges everywhere, which is where the arc test degenerates.
#[test]
fn copies_agree_with_brute_force() {
    let mut rng = random(22);
    for i in 0..600 {
        let a = random_polyhedron(&mut rng, 1.0, i % 7);
        let mut b = match i % 3 {
            0 => a.clone(),
            1 => a.scaled(0.5),
            _ => a.transformed(&Pose::rotation(Vector::repeat(std::f64::consts::PI))),
        };
        let twist = [0.0, 1e-12, 1e-9, 1e-6, 1e-4, 1e-2][i % 6];
        b = b.transformed(&Pose::rotation(random_direction(&mut rng) * twist));
        let place = random_direction(&mut rng) * [0.0, 1e-9, 0.1, 0.6, 0.9][i % 5];
        let b = b.transformed(&Pose::translation(place.x, place.y, place.z));
        judge(&a, &b).unwrap_or_else(|what| panic!("copy {i}: {what}"));
    }
}

/// Triangulated faces: edges between coplanar faces have arcs of no
/// length, and slivers have normals of few digits.
#[test]
fn coplanar_faces_agree_with_brute_force() {
    let mut rng = random(23);
    let triangulated = |shape: &ConvexPolyhedron| {
        let faces = shape.faces().iter();
        let fans = faces.flat_map(|c| (1..c.len() - 1).map(|i| vec![c[0], c[i], c[i + 1]]));
        ConvexPolyhedron::new(shape.vertices().to_vec(), fans.collect()).unwrap()
    };
    for i in 0..300 {
        let a = random_polyhedron(&mut rng, 1.0, i % 6);
        let b = random_polyhedron(&mut rng, 1.0, 3).transformed(&random_pose(&mut rng, 1.0));
        let plain = judge(&a, &b).unwrap();
        // The products of two coplanar diagonals give brute force axes
        // of no meaning but of true supports, so it still is a bound.
        let got = judge(&triangulated(&a), &triangulated(&b));
        let got = got.unwrap_or_else(|what| panic!("triangulated pair {i}: {what}"));
        assert_near("triangulation changes nothing", plain, got, 1e-12);
    }
}

/// Law: moved apart by a hair more than the depth along the axis, the two have no volume in common;
/// by a hair less, they have. And no direction whatever separates them with less.
#[test]
fn depth_is_the_smallest_separating_translation() {
    let mut rng = random(24);
    let mut judged = 0;
    for _ in 0..400 {
        let a = random_polyhedron(&mut rng, 1.0, 6);
        let b = random_polyhedron(&mut rng, 1.0, 6).transformed(&random_pose(&mut rng, 0.9));
        let found = separation(&hull(&a), &hull(&b));
        if found.gap > -1e-3 {
            let common = common_volume(&a, &b);
            assert!(found.gap <= 0.0 || common < 1e-9, "{found:?}, yet {common} in common");
            continue;
        }
        judged += 1;
        let moved = |share: f64| {
            let way = found.axis * (-found.gap * share);
            common_volume(&a, &b.transformed(&Pose::translation(way.x, way.y, way.z)))
        };
        assert_near("common volume after the translation", 0.0, moved(1.0 + 1e-6), 0.0);
        // A corner that dips in by 5 % of the depth may hold very little.
        assert!(moved(0.95) > 0.0, "{found:?}: nothing in common after 95 % of the way");
        for _ in 0..500 {
            let gap = gap_along(&a, &b, &random_direction(&mut rng));
            assert!(gap <= found.gap + 1e-12, "{found:?}, yet another way leaves only {gap}");
        }
    }
    assert!(judged > 100, "only {judged} pairs overlapped");
}

/// Law: depth scales with the bodies and does not depend on where they are.
#[test]
fn depth_scales_and_moves() {
    let mut rng = random(25);
    for _ in 0..100 {
        let a = random_polyhedron(&mut rng, 1.0, 6);
        let b = random_polyhedron(&mut rng, 1.0, 6).transformed(&random_pose(&mut rng, 0.7));
        let gap = separation(&hull(&a), &hull(&b)).gap;
        let small = separation(&hull(&a.scaled(0.01)), &hull(&b.scaled(0.01))).gap;
        assert_near("hundredth of the size", gap * 0.01, small, 1e-14);
        let pose = Pose::from_parts(Vector::repeat(3.0).into(), random_rotation(&mut rng));
        let moved = separation(&WorldHull::new(&a, &pose), &WorldHull::new(&b, &pose)).gap;
        assert_near("moved and turned together", gap, moved, 1e-13);
    }
}

/// The judge must be able to fail: a hull with an edge too few.
#[test]
fn brute_force_notices_a_missing_edge() {
    let lower = turned(&cube(1.0), Vector::x(), std::f64::consts::FRAC_PI_4);
    let upper = turned(&cube(1.0), Vector::y(), std::f64::consts::FRAC_PI_4);
    let upper = at(&upper, 0.1, 0.1, 2.0f64.sqrt() - 0.1);
    let mut maimed = hull(&lower);
    maimed.edges.clear();
    let got = separation(&maimed, &hull(&upper)).gap;
    let expected = brute_force(&lower, &upper);
    assert!(near("gap without edges", expected, got, 1e-3).is_err(), "{expected} {got}");
}
