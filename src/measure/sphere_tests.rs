//! Measures of specimens of spheres, against formulas.

use std::f64::consts::PI;

use super::testing::{assert_near, random, random_pose, specimen_of};
use super::*;
use crate::geometry::{ConvexPolyhedron, Pose, Vector};

const RADIUS: f64 = 0.004;
const VOLUME: f64 = 4.0 / 3.0 * PI * RADIUS * RADIUS * RADIUS;

/// Volume of a cap of a height.
fn cap(h: f64) -> f64 {
    PI * h * h * (RADIUS - h / 3.0)
}

/// Law: over every cell the map has the height of the highest sphere, exactly.
#[test]
fn the_surface_of_spheres_is_exact() {
    let mut rng = random(3);
    let cup = Container { centre_x: 0.0, radius: 0.03, height: 0.1 };
    let place = |rng: &mut _| {
        let mut pose = random_pose(rng, 0.03);
        pose.translation.vector.z = pose.translation.vector.z.abs() + RADIUS;
        pose
    };
    let spheres: Vec<_> = (0..60)
        .map(|n| (ConvexPolyhedron::ball(RADIUS * (0.5 + f64::from(n) / 120.0)), place(&mut rng)))
        .collect();
    let specimen = specimen_of(spheres.clone());
    let map = HeightMap::of(&specimen, &cup, 0.0007).expect("a map");
    let middle = (map.across() - 1) as f64 / 2.0;
    let held: Vec<_> = cup.members(&specimen);
    for j in 0..map.across() {
        for i in 0..map.across() {
            let Some(got) = map.height(i, j) else { continue };
            let (x, y) = ((i as f64 - middle) * 0.0007, (j as f64 - middle) * 0.0007);
            let top = |&n: &usize| {
                let (ball, pose) = &spheres[n];
                let (r, c) = (ball.sphere().expect("a sphere").radius, pose.translation.vector);
                let left = r * r - (x - c.x).powi(2) - (y - c.y).powi(2);
                (left >= 0.0).then(|| c.z + left.sqrt())
            };
            let expected = held.iter().filter_map(top).fold(0.0, f64::max);
            // At a sphere's rim a rounding of x is a height.
            assert_near("height over a cell, m", expected, got, 1e-9);
        }
    }
    let highest = held.iter().map(|&n| spheres[n].0.heights(&spheres[n].1).1).fold(0.0, f64::max);
    assert_near("highest point, m", highest, map.standing_height().highest, 1e-15);
}

/// Law: layers have the volume of the caps between their ends.
#[test]
fn layers_of_spheres_are_exact() {
    let at = Pose::translation(0.001, 0.002, 0.0045);
    let specimen = specimen_of(vec![(ConvexPolyhedron::ball(RADIUS), at)]);
    let got = layers(&specimen, &[0], 1e-4, (0.0, 0.01), 10);
    for slice in got {
        let up_to = |z: f64| cap((z - 0.0005).clamp(0.0, 2.0 * RADIUS));
        let expected = up_to(slice.to) - up_to(slice.from);
        assert_near("solids of a layer, m³", expected, slice.solids, 1e-9 * VOLUME);
    }
}

/// Law: what a cylinder about the centre takes of a sphere is its volume less that of a napkin
/// ring; 64 sides stand for the circle, and a mesh for the sphere: to 0.1 % of the sphere.
#[test]
fn rings_of_spheres_have_their_volume_to_a_tenth_of_a_percent() {
    for turn in [0.0, 0.4] {
        let at = Pose::rotation(Vector::new(0.3, 1.0, 0.2) * turn);
        let specimen = specimen_of(vec![(ConvexPolyhedron::ball(RADIUS), at)]);
        let got = rings(&specimen, &[0], (0.0, 0.005), (-0.01, 0.01), 5);
        for slice in &got {
            let beyond = |r: f64| 4.0 / 3.0 * PI * (RADIUS * RADIUS - r * r).max(0.0).powf(1.5);
            let expected = beyond(slice.from) - beyond(slice.to);
            assert_near("solids of a ring, m³", expected, slice.solids, 1e-3 * VOLUME);
        }
        let sum: f64 = got.iter().map(|s| s.solids).sum();
        assert_near("nothing is lost, m³", VOLUME, sum, 1e-9 * VOLUME);
    }
}

/// Law: a box has what it cuts off, to 0.1 % of the sphere.
#[test]
fn a_region_has_the_parts_of_spheres_that_lie_in_it() {
    let ball = ConvexPolyhedron::ball(RADIUS);
    let mut rng = random(11);
    for n in 0..60 {
        let mut pose = random_pose(&mut rng, 0.01);
        pose.translation.vector = Vector::new(0.0, 0.0, RADIUS * (f64::from(n % 20) / 10.0 - 1.0));
        let half = Region { low: Vector::new(-0.1, -0.1, -0.1), high: Vector::new(0.1, 0.1, 0.0) };
        let below = cap(RADIUS - pose.translation.vector.z);
        assert_near("below a plane, m³", below, half.volume_of(&ball, &pose), 1e-3 * VOLUME);
        let quarter = Region { low: Vector::new(0.0, -0.1, -0.1), ..half };
        assert_near("half of it, m³", below / 2.0, quarter.volume_of(&ball, &pose), 1e-3 * VOLUME);
    }
    let all = Region { low: Vector::repeat(-0.1), high: Vector::repeat(0.1) };
    assert_near("all, m³", VOLUME, all.volume_of(&ball, &Pose::identity()), 1e-15 * VOLUME);
}

/// Law: spheres that overlap by 1 % of their diameter do so.
#[test]
fn overlaps_of_spheres_are_exact() {
    let ball = || ConvexPolyhedron::ball(RADIUS);
    let at = |x: f64| Pose::translation(x, 0.0, 0.0);
    let specimen = specimen_of(vec![
        (ball(), at(0.0)),
        (ball(), at(1.98 * RADIUS)),
        (ball(), at(4.0 * RADIUS)),
    ]);
    let pairs = pairs_within(&specimen, &[0, 1, 2], 1e-4);
    assert_eq!(pairs.len(), 2, "law: two pairs touch");
    let got = overlap_statistics(&specimen, &pairs);
    assert_eq!(got.overlapping, 1, "law: one of them overlaps");
    assert_near("depth, m", 0.02 * RADIUS, got.max_depth, 1e-15);
    assert_near("share of the diameter", 0.01, got.max, 1e-12);
}
