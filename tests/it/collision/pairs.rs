//! Pairs of bodies to collide: grains, boxes, tetrahedra, slivers, walls and
//! plate, deep in each other, touching and apart.

use std::sync::Arc;

use nalgebra::{Rotation3, Translation3, Unit, UnitQuaternion};
use pluvia::{
    apparatus::{Cylinder, Funnel, TopPlate},
    geometry::{ConvexPolyhedron, Point, Pose, Vector},
    grains::generate,
    measure::{WorldHull, separation},
    scenario::{
        CellShape, CylinderSpec, FunnelSpec, SieveFraction, SievedGrains, SievedShape, TopPlateSpec,
    },
};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

/// Two bodies and where they are.
pub struct Case {
    pub name: String,
    pub a: Arc<ConvexPolyhedron>,
    pub b: Arc<ConvexPolyhedron>,
    pub pose_a: Pose,
    pub pose_b: Pose,
}

/// Endless random pairs, the same for the same seed.
pub struct Cases {
    rng: Pcg64Mcg,
    seed: u64,
    number: u64,
    grains: Vec<Arc<ConvexPolyhedron>>,
    walls: Vec<Arc<ConvexPolyhedron>>,
}

pub fn box_of(x: f64, y: f64, z: f64) -> ConvexPolyhedron {
    ConvexPolyhedron::cuboid(Vector::new(x, y, z)).expect("a box")
}

pub fn direction(rng: &mut Pcg64Mcg) -> Vector {
    loop {
        let v = Vector::from_fn(|_, _| rng.random_range(-1.0..1.0));
        let length: f64 = v.norm();
        if length > 0.1 && length <= 1.0 {
            return v / length;
        }
    }
}

pub fn rotation(rng: &mut Pcg64Mcg) -> UnitQuaternion<f64> {
    let axis = Unit::new_normalize(direction(rng));
    UnitQuaternion::from_axis_angle(&axis, rng.random_range(0.0..std::f64::consts::TAU))
}

/// A shape with its axes stretched, each by its own factor.
fn stretched(shape: &ConvexPolyhedron, factors: &Vector) -> ConvexPolyhedron {
    let vertices = shape.vertices().iter().map(|v| v.coords.component_mul(factors).into());
    ConvexPolyhedron::new(vertices.collect(), shape.faces().to_vec()).expect("still convex")
}

fn tetrahedron(rng: &mut Pcg64Mcg, size: f64) -> ConvexPolyhedron {
    loop {
        let mut corners: Vec<Point> = (0..4).map(|_| Point::from(direction(rng) * size)).collect();
        let volume = (corners[1] - corners[0])
            .cross(&(corners[2] - corners[0]))
            .dot(&(corners[3] - corners[0]));
        if volume.abs() < 0.05 * size.powi(3) {
            continue;
        }
        if volume < 0.0 {
            corners.swap(2, 3);
        }
        let centre = corners.iter().map(|c| c.coords).sum::<Vector>() / 4.0;
        let corners = corners.iter().map(|c| c - centre).collect();
        let faces = vec![vec![0, 2, 1], vec![0, 1, 3], vec![1, 2, 3], vec![0, 3, 2]];
        return ConvexPolyhedron::new(corners, faces).expect("a tetrahedron");
    }
}

impl Cases {
    pub fn new(seed: u64) -> Self {
        let row = |passing_mm, retained_mm, mass_percent| SieveFraction {
            passing_mm,
            retained_mm,
            mass_percent,
        };
        let table = SievedGrains {
            total_mass_g: 1000.0,
            density_kg_per_m3: 2673.9,
            sieve_table: vec![row(16.0, 10.0, 50.0), row(10.0, 8.0, 50.0)],
            shape: SievedShape::default(),
            cells: CellShape::default(),
        };
        let grains = generate(&table, seed).expect("grains").grains;
        let cylinder = Cylinder::new(&CylinderSpec::default()).expect("a cylinder");
        let funnel = Funnel::new(&FunnelSpec::default(), 0.25, 0.3).expect("a funnel");
        let plate = TopPlate::new(&TopPlateSpec::default()).expect("a plate");
        let mut walls = vec![plate.shape, funnel.lid.shape];
        for pieces in [cylinder.pieces, funnel.pieces] {
            walls.extend(pieces.iter().step_by(16).map(|p| Arc::clone(&p.shape)));
            walls.extend(pieces.last().map(|p| Arc::clone(&p.shape)));
        }
        Self {
            rng: Pcg64Mcg::seed_from_u64(seed),
            seed,
            number: 0,
            grains: grains.into_iter().map(|g| g.shape).collect(),
            walls,
        }
    }

    fn grain(&mut self) -> Arc<ConvexPolyhedron> {
        let i = self.rng.random_range(0..self.grains.len());
        Arc::clone(&self.grains[i])
    }

    fn wall(&mut self) -> Arc<ConvexPolyhedron> {
        let i = self.rng.random_range(0..self.walls.len());
        Arc::clone(&self.walls[i])
    }

    fn sliver(&mut self) -> Arc<ConvexPolyhedron> {
        let thin = 10f64.powf(self.rng.random_range(-2.0..0.0));
        let factors = if self.rng.random_bool(0.5) {
            Vector::new(1.0, 1.0, thin)
        } else {
            Vector::new(2.0, thin, thin)
        };
        Arc::new(stretched(&self.grain(), &factors))
    }

    fn simple(&mut self) -> Arc<ConvexPolyhedron> {
        let rng = &mut self.rng;
        let mut side = || rng.random_range(0.004..0.02);
        let (x, y, z) = (side(), side(), side());
        if self.rng.random_bool(0.5) {
            Arc::new(box_of(x, y, z))
        } else {
            Arc::new(tetrahedron(&mut self.rng, x))
        }
    }

    /// Gap to aim at in m: deep, slight, none, or a gap.
    fn gap(&mut self) -> f64 {
        let rng = &mut self.rng;
        let small = 10f64.powf(rng.random_range(-9.0..-3.5));
        match rng.random_range(0..8) {
            0 => -rng.random_range(0.0..0.004),
            1 | 2 => -rng.random_range(0.0..0.0003),
            3 | 4 => -small,
            5 => small,
            6 => 0.0,
            _ => rng.random_range(0.0..0.001),
        }
    }
}

/// The rotation that lays a face of B flat against a face of A at a given turn.
fn face_to_face(
    a: &ConvexPolyhedron,
    b: &ConvexPolyhedron,
    rng: &mut Pcg64Mcg,
) -> UnitQuaternion<f64> {
    let fa = rng.random_range(0..a.faces().len());
    let fb = rng.random_range(0..b.faces().len());
    let (Some((na, _)), Some((nb, _))) = (a.plane(fa), b.plane(fb)) else {
        return rotation(rng);
    };
    // Of opposite directions rotation_between takes the arc cosine of less than -1 by a rounding.
    let flat = if nb.dot(&na) > 1.0 - 1e-12 {
        let aside = if nb.x.abs() < 0.9 { Vector::x() } else { Vector::y() };
        let across = Unit::new_normalize(nb.cross(&aside));
        Rotation3::from_axis_angle(&across, std::f64::consts::PI)
    } else {
        Rotation3::rotation_between(&nb, &-na).expect("directions that are not opposite")
    };
    let spin = Rotation3::from_axis_angle(
        &Unit::new_normalize(na),
        // Often by nothing, so that edges are parallel too.
        if rng.random_bool(0.3) { 0.0 } else { rng.random_range(0.0..std::f64::consts::TAU) },
    );
    let off = 10f64.powf(rng.random_range(-9.0..-1.0));
    let tilt = Rotation3::from_axis_angle(
        &Unit::new_normalize(direction(rng)),
        if rng.random_bool(0.5) { 0.0 } else { off },
    );
    UnitQuaternion::from_rotation_matrix(&(tilt * spin * flat))
}

/// Moves B in small and large steps, and back to where it touches A.
pub struct Motion {
    rng: Pcg64Mcg,
    stride: f64,
}

impl Motion {
    /// From a micrometre to some millimetres a step, by number.
    pub fn new(number: u64) -> Self {
        let stride = [1e-6, 1e-5, 1e-4, 1e-3, 3e-3][(number % 5) as usize];
        Self { rng: Pcg64Mcg::seed_from_u64(number), stride }
    }

    pub fn advance(&mut self, case: &mut Case, hull_a: &WorldHull) {
        let rng = &mut self.rng;
        let radius = case.b.radius_about_origin().min(0.02);
        let turn = UnitQuaternion::from_axis_angle(
            &Unit::new_normalize(direction(rng)),
            rng.random_range(0.0..1.0) * self.stride / radius,
        );
        let step = direction(rng) * self.stride;
        let place = case.pose_b.translation.vector + step;
        case.pose_b = Pose::from_parts(place.into(), turn * case.pose_b.rotation);
        let found = separation(hull_a, &WorldHull::new(&case.b, &case.pose_b));
        // Neither far apart nor deeper than grains ever are.
        if found.gap > 3.0 * self.stride || found.gap < -3.0 * self.stride {
            let wanted = -self.stride * rng.random_range(0.0..1.0);
            case.pose_b.translation.vector += found.axis * (wanted - found.gap);
        }
    }
}

impl Iterator for Cases {
    type Item = Case;

    fn next(&mut self) -> Option<Case> {
        let (seed, number) = (self.seed, self.number);
        self.number += 1;
        let kind = self.rng.random_range(0..12);
        let (what, a, b) = match kind {
            0..=3 => ("grains", self.grain(), self.grain()),
            4 => ("grain on simple body", self.grain(), self.simple()),
            5 => ("simple bodies", self.simple(), self.simple()),
            6 | 7 => ("wall and grain", self.wall(), self.grain()),
            8 => ("grain and wall", self.grain(), self.wall()),
            9 => ("sliver", self.sliver(), self.sliver()),
            10 => {
                let a = self.grain();
                let factor = 10f64.powf(self.rng.random_range(-1.0..0.5));
                let b = Arc::new(a.scaled(factor));
                ("scaled copy", a, b)
            }
            _ => {
                let a = self.grain();
                ("copy", Arc::clone(&a), a)
            }
        };
        let rng = &mut self.rng;
        let flat = rng.random_bool(0.4);
        let turn_b = if flat { face_to_face(&a, &b, rng) } else { rotation(rng) };
        let reach = a.radius_about_origin() + b.radius_about_origin();
        let mut place = direction(rng) * (reach * rng.random_range(0.0..1.0));
        let gap = self.gap();
        // Along the axis of the widest gap to the gap that is wanted.
        for _ in 0..3 {
            let pose = Pose::from_parts(Translation3::from(place), turn_b);
            let found =
                separation(&WorldHull::new(&a, &Pose::identity()), &WorldHull::new(&b, &pose));
            place += found.axis * (gap - found.gap);
        }
        // The pair as a whole lies and turns anywhere near.
        let rng = &mut self.rng;
        let whole = Pose::from_parts(
            Translation3::from(direction(rng) * rng.random_range(0.0..0.1)),
            rotation(rng),
        );
        let flat = if flat { ", face to face" } else { "" };
        let name = format!("seed {seed}, pair {number}, {what}{flat}");
        let pose_b = whole * Pose::from_parts(Translation3::from(place), turn_b);
        assert!(pose_b.to_homogeneous().iter().all(|x| x.is_finite()), "{name}: has a place");
        Some(Case { name, pose_a: whole, pose_b, a, b })
    }
}
