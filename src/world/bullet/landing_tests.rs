//! What meets fast within a step is stopped at the surface, whichever corner lands, and
//! iterations go on until forces are found.

use super::tests::{free_box, shared_turn, slab, state, steps, uniform};
use super::*;
use crate::grains::{Grain, generate, streams};
use crate::scenario::{CellShape, NativeSettings, SieveFraction, SievedGrains, SievedShape};

fn world(gravity: f64, native: NativeSettings) -> BulletBackend {
    let settings = EngineSettings { native, ..Default::default() };
    let gravity = Vector::new(0.0, 0.0, -gravity);
    BulletBackend::new(&settings, gravity, &uniform(0.5, 0.3)).expect("a world")
}

/// How far in mm the deepest corner of a body is below the face of [`slab`], raised by
/// `height` (m); negative above it.
fn depth(world: &BulletBackend, id: BodyId, body: &Body, height: f64) -> f64 {
    let pose = state(world, id).pose;
    let lowest = body.shape.vertices().iter().map(|v| (pose * v).z).fold(f64::INFINITY, f64::min);
    1e3 * (height - lowest)
}

/// How deep in mm a box gets into a slab that starts at once with 0.47 m/s after both
/// have been at rest, two corners of the box on it and two higher by `lift` (mm).
fn started(lift: f64) -> f64 {
    const SPEED: f64 = 0.47;
    let mut world = world(0.0, NativeSettings::default());
    let table = world.add(&slab(Motion::Kinematic)).expect("added");
    let mut body = free_box(Vector::new(0.016, 0.008, 0.004), Vector::zeros());
    let lean = 1e-3 * lift / 0.016;
    body.state.pose.rotation = UnitQuaternion::from_scaled_axis(Vector::new(0.0, lean, 0.0));
    body.state.pose.translation.z = 0.008 * lean.sin() + 0.002 * lean.cos();
    let id = world.add(&body).expect("added");
    let mut deepest = f64::NEG_INFINITY;
    for step in 1..=20 {
        let height = SPEED * world.time_step() * f64::from((step - 5).max(0));
        world.drive(table, &Pose::translation(0.0, 0.0, height - 0.01)).expect("driven");
        world.step().expect("a step");
        deepest = deepest.max(depth(&world, id, &body, height));
    }
    deepest
}

#[test]
fn a_wall_that_starts_at_once_pushes_every_corner() {
    let _turn = shared_turn();
    // The wall goes 0.98 mm in a step; contacts are kept up to 0.2 mm at rest.
    for lift in [0.0, 0.1, 0.3, 0.6, 0.9] {
        let got = started(lift);
        assert!(
            got < 0.03,
            "law: no corner gets into a wall that starts at once; two corners {lift} mm off it: \
             expected at most 0.03 mm, got {got:.3} mm"
        );
        assert!(got > -2.0, "the check sees a box that is pushed, got {got:.3} mm");
    }
}

/// Grains of the paper's kind, of 8 to 10 mm.
fn grains() -> Vec<Grain> {
    let fraction = SieveFraction { passing_mm: 10.0, retained_mm: 8.0, mass_percent: 100.0 };
    let spec = SievedGrains {
        total_mass_g: 20.0,
        density_kg_per_m3: 2673.9,
        sieve_table: vec![fraction],
        shape: SievedShape::default(),
        cells: CellShape::default(),
    };
    generate(&spec, 5).expect("grains").grains
}

/// How deep in mm a tumbling grain gets into the floor at the worst of 0.2 s.
fn tumbled(grain: &Grain, number: u64) -> f64 {
    let mut draw = streams::stream(number, "tumbling");
    let mut world = world(9.81, NativeSettings::default());
    world.add(&slab(Motion::Static)).expect("added");
    let at = Pose::from_parts(Vector::new(0.0, 0.0, 0.009).into(), streams::rotation(&mut draw));
    let mut body = Body {
        shape: grain.shape.clone(),
        motion: Motion::Free { mass: grain.mass, inertia: grain.inertia },
        material: crate::world::Material::Grain,
        state: BodyState::at_rest(at),
    };
    body.state.angular_velocity = streams::rotation(&mut draw) * Vector::x() * 120.0;
    body.state.linear_velocity = Vector::new(0.0, 0.0, -0.5);
    let id = world.add(&body).expect("added");
    let mut deepest = f64::NEG_INFINITY;
    for _ in 0..96 {
        world.step().expect("a step");
        deepest = deepest.max(depth(&world, id, &body, 0.0));
    }
    deepest
}

#[test]
fn a_body_that_rolls_lands_on_the_corners_that_come_down() {
    let _turn = shared_turn();
    // They turn by 14 degrees in a step.
    let grains = grains();
    let cases = (0..200).map(|n| tumbled(&grains[n as usize % grains.len()], n));
    let deepest: Vec<f64> = cases.collect();
    let worst = deepest.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let mean = deepest.iter().sum::<f64>() / deepest.len() as f64;
    assert!(
        worst < 0.15 && mean < 0.02,
        "law: no corner gets into the floor: expected at most 0.15 mm, 0.02 mm on average, got \
         {worst:.3} mm and {mean:.3} mm"
    );
    assert!(worst > -0.1, "the check sees bodies that land, got {worst:.3} mm");
}

/// The solver's residual after sixteen piles of twenty boxes have rested for 10 ms.
fn residual(solver_tolerance: f64) -> f64 {
    let mut world = world(9.81, NativeSettings { solver_tolerance, ..Default::default() });
    world.record_substeps(); // every step is looked at
    world.add(&slab(Motion::Static)).expect("added");
    for n in 0..320 {
        let (x, y) = (f64::from(n / 20 % 4), f64::from(n / 80));
        let at = Vector::new(0.02 * x, 0.02 * y, 0.005 + 0.01 * f64::from(n % 20));
        world.add(&free_box(Vector::repeat(0.01), at)).expect("added");
    }
    steps(&mut world, 5);
    world.solver_residual().expect("the native solver says")
}

#[test]
fn iterations_go_on_until_the_tolerance_is_met() {
    let _turn = shared_turn();
    let [coarse, middle, fine] = [1e-3, 1e-4, 1e-5].map(residual);
    assert!(
        fine < middle && middle < coarse && fine < 0.05 * coarse,
        "law: a smaller tolerance, a smaller residual, by 0.05 and more from 0.001 to 0.00001: got \
         {coarse:.2e} at 0.001, {middle:.2e} at 0.0001, {fine:.2e} at 0.00001"
    );
}
