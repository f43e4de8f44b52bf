//! Helpers of tests: comparison with a tolerance, random polyhedra, small specimens, and an
//! intersection of polyhedra that shares nothing with the measured code.

use std::collections::HashMap;
use std::sync::Arc;

use nalgebra::{Translation3, UnitQuaternion};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use super::*;
use crate::grains::{Block, Grain};
use crate::specimen::GrainState;

/// Density used by all test grains (paper, section 2), in kg/m³.
pub const DENSITY: f64 = 2673.9;

/// Says what is wrong when `got` is farther from `expected` than `tolerance`.
pub fn near(law: &str, expected: f64, got: f64, tolerance: f64) -> Result<(), String> {
    if (got - expected).abs() <= tolerance {
        Ok(())
    } else {
        Err(format!("{law}: expected {expected:e}, got {got:e}, tolerance {tolerance:e}"))
    }
}

/// [`near`] as an assertion.
#[track_caller]
pub fn assert_near(law: &str, expected: f64, got: f64, tolerance: f64) {
    if let Err(what) = near(law, expected, got, tolerance) {
        panic!("{what}");
    }
}

#[test]
fn the_helper_can_fail() {
    assert!(near("", 1.0, 1.1, 0.2).is_ok());
    for wrong in [0.7, 1.3, f64::NAN] {
        assert!(near("", 1.0, wrong, 0.2).is_err(), "{wrong} is not 1");
    }
}

pub fn random(seed: u64) -> Pcg64Mcg {
    Pcg64Mcg::seed_from_u64(seed)
}

pub fn cube(side: f64) -> ConvexPolyhedron {
    ConvexPolyhedron::cuboid(Vector::repeat(side)).unwrap()
}

pub fn random_direction(rng: &mut Pcg64Mcg) -> Vector {
    loop {
        let v = Vector::from_fn(|_, _| rng.random_range(-1.0..1.0));
        let length: f64 = v.norm();
        if length > 0.1 && length <= 1.0 {
            return v / length;
        }
    }
}

pub fn random_rotation(rng: &mut Pcg64Mcg) -> UnitQuaternion<f64> {
    let axis = nalgebra::Unit::new_normalize(random_direction(rng));
    UnitQuaternion::from_axis_angle(&axis, rng.random_range(0.0..std::f64::consts::TAU))
}

pub fn random_pose(rng: &mut Pcg64Mcg, reach: f64) -> Pose {
    let translation = random_direction(rng) * rng.random_range(0.0..reach);
    Pose::from_parts(Translation3::from(translation), random_rotation(rng))
}

/// A cube cut by random planes: like a Voronoi cell, it has plane faces of
/// many sizes, slivers among them, and about `2·cuts` vertices.
pub fn random_polyhedron(rng: &mut Pcg64Mcg, size: f64, cuts: usize) -> ConvexPolyhedron {
    let mut body = cube(size);
    for _ in 0..cuts {
        let normal = random_direction(rng);
        let offset = size * rng.random_range(0.3..0.65);
        if let Some(rest) = clip(&body, &normal, offset) {
            body = rest;
        }
    }
    body
}

/// The part of a polyhedron behind the plane `normal · x = offset`; `None`
/// when nothing, or nothing the type accepts, is left.
pub fn clip(body: &ConvexPolyhedron, normal: &Vector, offset: f64) -> Option<ConvexPolyhedron> {
    let side: Vec<f64> = body.vertices().iter().map(|v| normal.dot(&v.coords) - offset).collect();
    if side.iter().all(|&s| s <= 0.0) {
        return Some(body.clone());
    }
    let mut points: Vec<Point> = vec![];
    let mut kept: HashMap<(u32, u32), u32> = HashMap::new();
    let mut index = |a: u32, b: u32| {
        let key = (a.min(b), a.max(b));
        *kept.entry(key).or_insert_with(|| {
            let (p, q) = (body.vertices()[key.0 as usize], body.vertices()[key.1 as usize]);
            let (s, t) = (side[key.0 as usize], side[key.1 as usize]);
            points.push(if a == b { p } else { p + (q - p) * (s / (s - t)) });
            points.len() as u32 - 1
        })
    };
    let mut faces = vec![];
    let mut next_on_cap = HashMap::new();
    for face in body.faces() {
        let mut rest = vec![];
        let (mut leaves, mut enters) = (None, None);
        for (i, &a) in face.iter().enumerate() {
            let b = face[(i + 1) % face.len()];
            if side[a as usize] <= 0.0 {
                rest.push(index(a, a));
            }
            if (side[a as usize] <= 0.0) != (side[b as usize] <= 0.0) {
                let crossing = index(a, b);
                rest.push(crossing);
                if side[a as usize] <= 0.0 {
                    leaves = Some(crossing);
                } else {
                    enters = Some(crossing);
                }
            }
        }
        if let (Some(leaves), Some(enters)) = (leaves, enters) {
            next_on_cap.insert(enters, leaves);
        }
        if rest.len() >= 3 {
            faces.push(rest);
        }
    }
    let first = *next_on_cap.keys().min()?;
    let mut cap = vec![first];
    loop {
        let next = *next_on_cap.get(cap.last()?)?;
        if next == first {
            break;
        }
        cap.push(next);
        if cap.len() > next_on_cap.len() {
            return None;
        }
    }
    faces.push(cap);
    ConvexPolyhedron::new(points, faces).ok()
}

/// Volume common to two polyhedra, by clipping one with every face of the other.
pub fn common_volume(a: &ConvexPolyhedron, b: &ConvexPolyhedron) -> f64 {
    let mut rest = a.clone();
    for face in 0..b.faces().len() {
        let (normal, offset) = b.plane(face).unwrap();
        match clip(&rest, &normal, offset) {
            Some(r) => rest = r,
            None => return 0.0,
        }
    }
    rest.signed_volume()
}

/// A grain of the given shape, moved into its principal frame, and the pose
/// that puts it back where the shape was.
pub fn grain(shape: &ConvexPolyhedron) -> (Grain, Pose) {
    let properties = MassProperties::of(shape);
    let frame = properties.principal_frame();
    let grain = Grain {
        shape: Arc::new(shape.transformed(&frame.pose.inverse())),
        pose_in_block: Pose::identity(),
        volume: properties.volume,
        mass: properties.volume * DENSITY,
        inertia: frame.moments_per_density * DENSITY,
        equivalent_diameter: shape.equivalent_diameter(),
        fraction: 0,
    };
    (grain, frame.pose)
}

/// A contact that bears a force in N on the first of two, along its own normal.
pub fn contact(between: [Party; 2], point: Vector, force: Vector) -> SavedContact {
    SavedContact {
        between,
        point_m: point,
        normal: force.normalize(),
        force_n: force,
        warm_start: 1.0,
        feature: [0, 0],
    }
}

/// A block whose sieves are the paper's finest and coarsest.
fn of_the_papers_sizes() -> Block {
    Block {
        passing: 0.016,
        retained: 0.008,
        own_sizes: false,
        side: 0.1,
        origin: Vector::zeros(),
        points: vec![],
        first_grain: 0,
        cells: vec![],
    }
}

/// A specimen at rest: every shape at its pose.
pub fn specimen_of(parts: Vec<(ConvexPolyhedron, Pose)>) -> Specimen {
    let mut grains = vec![];
    let mut bodies = vec![];
    for (shape, pose) in parts {
        let (grain, frame) = grain(&shape);
        grains.push(grain);
        bodies.push(GrainState { body: BodyState::at_rest(pose * frame), fate: Fate::Present });
    }
    Specimen {
        grains: Arc::new(GrainSet {
            grains,
            blocks: vec![of_the_papers_sizes()],
            density: DENSITY,
            meshes: vec![],
        }),
        state: SpecimenState { bodies, cylinder: true, ..SpecimenState::default() },
    }
}

/// A bed of `count` random grains of about 10.5 mm equivalent diameter in a cylinder of 57.5 mm
/// radius, dense enough that neighbours overlap: as much work to measure as the paper's specimen.
pub fn dense_bed(count: usize) -> Specimen {
    let mut rng = random(7);
    let pitch = 0.0102;
    let mut parts = vec![];
    let mut layer = 0;
    while parts.len() < count {
        for i in -6..=6 {
            for j in -6..=6 {
                let (x, y) = (f64::from(i) * pitch, f64::from(j) * pitch);
                if x.hypot(y) > 0.055 || parts.len() == count {
                    continue;
                }
                let shape = random_polyhedron(&mut rng, 0.0112, 9);
                let z = 0.006 + f64::from(layer) * pitch;
                let place = Vector::new(x, y, z) + random_direction(&mut rng) * 0.0015;
                parts.push((shape, Pose::from_parts(place.into(), random_rotation(&mut rng))));
            }
        }
        layer += 1;
    }
    specimen_of(parts)
}

/// Law: a plane through the centre of a cube halves it; the parts on either
/// side of any plane add up to the whole.
#[test]
fn clipping_conserves_volume() {
    let mut rng = random(1);
    for _ in 0..200 {
        let body = random_polyhedron(&mut rng, 1.0, 6);
        let normal = random_direction(&mut rng);
        let below = clip(&body, &normal, 0.05).map_or(0.0, |b| b.signed_volume());
        let above = clip(&body, &-normal, -0.05).map_or(0.0, |b| b.signed_volume());
        assert_near("volume of both parts", body.signed_volume(), below + above, 1e-12);
    }
    let half = common_volume(&cube(1.0), &cube(1.0).transformed(&Pose::translation(0.5, 0.0, 0.0)));
    assert_near("half a cube", 0.5, half, 1e-12);
}
