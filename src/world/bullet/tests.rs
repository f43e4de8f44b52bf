//! What is Bullet's alone; laws that hold for every engine are in `world/parity_tests/`.

use std::sync::{PoisonError, RwLock, RwLockReadGuard, RwLockWriteGuard};

use super::*;
use crate::geometry::testing::near;
use crate::scenario::{ContactSolver, NativeSettings};
pub(super) use crate::world::testing::{
    GRAVITY, contacts, free_box, remembered, slab, snapshot, state, steps, uniform,
};

/// Bullet keeps the contact threshold once a process: tests with the default
/// one share the process, those with others have it for themselves.
static PROCESS: RwLock<()> = RwLock::new(());

/// For tests whose worlds have the default contact threshold and length scale.
pub(crate) fn shared_turn() -> RwLockReadGuard<'static, ()> {
    PROCESS.read().unwrap_or_else(PoisonError::into_inner)
}

/// For tests whose worlds have settings of the process of their own.
pub(crate) fn exclusive_turn() -> RwLockWriteGuard<'static, ()> {
    PROCESS.write().unwrap_or_else(PoisonError::into_inner)
}

const PATHS: [ContactSolver; 2] = [ContactSolver::Stock, ContactSolver::Native];

fn on(contact_solver: ContactSolver) -> EngineSettings {
    EngineSettings { contact_solver, ..Default::default() }
}

fn world(settings: &EngineSettings) -> BulletBackend {
    BulletBackend::new(settings, GRAVITY, &uniform(0.5, 0.0)).expect("a world")
}

/// A world with native contacts, under the gravity of the earth.
pub(super) fn native_world(
    native: NativeSettings,
    friction: f64,
    restitution: f64,
) -> BulletBackend {
    let settings = EngineSettings { native, ..Default::default() };
    BulletBackend::new(&settings, GRAVITY, &uniform(friction, restitution)).expect("a world")
}

/// How far single precision may stray where double is exact to rounding.
pub(super) fn precision(double: f64, single: f64) -> f64 {
    if constants::PLUVIA_SCALAR_BYTES == 8 { double } else { single }
}

#[test]
fn settings_are_read_back_from_the_engine() {
    let _turn = shared_turn();
    let settings = EngineSettings { rate_hz: 960.0, iterations: 37, ..on(ContactSolver::Stock) };
    let mut world = world(&settings);
    world.add(&free_box(Vector::repeat(0.01), Vector::zeros())).expect("added");
    let held = world.effective();
    for (name, expected) in
        [("iterations", 37.0), ("time_step_s", 1.0 / 960.0), ("collision_margin_m", 0.0)]
    {
        let got = held[name].as_f64().expect("a number");
        near(&format!("setting {name}"), got, expected, 1e-9);
    }
    let directions = |n| {
        let world = super::super::create(
            &EngineSettings { friction_directions: n, ..settings.clone() },
            GRAVITY,
            &uniform(0.5, 0.0),
        )
        .expect("a world");
        world.effective()["solver_mode"].as_f64().expect("a number") as u32
    };
    let bit = constants::SOLVER_USE_2_FRICTION_DIRECTIONS;
    assert_eq!(directions(2) & bit, bit, "two friction directions are on when asked for");
    assert_eq!(directions(1) & bit, 0, "and off when not");
}

/// Law: what is read back acts on the world; a native one reads no setting of Bullet's solver.
#[test]
fn native_worlds_read_back_no_setting_of_stock_contacts() {
    let _turn = shared_turn();
    let held = |path| {
        let native = NativeSettings { iterations: 5, ..Default::default() };
        let settings = EngineSettings { rate_hz: 960.0, gyroscopic: false, native, ..on(path) };
        let mut world = world(&settings);
        world.add(&free_box(Vector::repeat(0.01), Vector::zeros())).expect("added");
        world.effective()
    };
    let [stock, native] = PATHS.map(held);
    for name in [
        "iterations",
        "solver_mode",
        "erp2",
        "warm_starting_factor",
        "split_impulse",
        "restitution_velocity_threshold_m_per_s",
        "rigid_body_flags",
        "sleeping_speed_m_per_s",
    ] {
        assert!(stock.contains_key(name), "law: {name} acts on stock contacts, got {stock:?}");
        assert!(!native.contains_key(name), "law: {name} acts on nothing, got {native:?}");
    }
    let defaults = EngineSettings::default();
    for (name, expected) in [
        ("gyroscopic", 0.0),
        ("sleeping", 0.0),
        ("iterations_in_a_substep", 5.0),
        ("time_step_s", 1.0 / 960.0),
        ("collision_margin_m", 0.0),
        ("restitution_speed_m_per_s", defaults.restitution_velocity_threshold_m_per_s),
    ] {
        let got = native[name].as_f64().expect("a number");
        near(&format!("setting {name}"), got, expected, 1e-9);
    }
}

/// Law: a native body turns by its spin times the step, by more than an eighth of a turn, too.
#[test]
fn a_native_body_turns_as_far_as_its_spin_says() {
    let _turn = shared_turn();
    for (size, axis) in [
        (Vector::repeat(0.01), Vector::new(1.0, -2.0, 3.0).normalize()),
        (Vector::new(0.006, 0.009, 0.02), Vector::y()),
    ] {
        for speed in [300.0, 380.0, 1200.0] {
            let mut world = native_world(NativeSettings::default(), 0.5, 0.0);
            let mut body = free_box(size, Vector::z());
            body.state.angular_velocity = axis * speed;
            let id = world.add(&body).expect("added");
            steps(&mut world, 7);
            let now = state(&world, id);
            let angle = 7.0 * speed * world.time_step();
            let expected = UnitQuaternion::from_scaled_axis(axis * angle);
            let off = now.pose.rotation.angle_to(&expected);
            near(&format!("ω t at {speed} rad/s"), off, 0.0, precision(1e-9, 1e-4));
            let spin = now.angular_velocity - axis * speed;
            near(&format!("spin at {speed} rad/s"), spin.norm(), 0.0, precision(1e-9, 1e-3));
        }
    }
}

#[test]
fn free_fall_is_the_discrete_solution_at_every_length_scale() {
    let _turn = exclusive_turn();
    let cases = [1.0, 10.0, 100.0, 1000.0].map(|scale| PATHS.map(|path| (scale, path)));
    for (length_scale, path) in cases.into_iter().flatten() {
        let settings = EngineSettings { length_scale, ..on(path) };
        let moves = if path == ContactSolver::Stock {
            1
        } else {
            settings.native.substeps(settings.rate_hz)
        };
        let mut world = world(&settings);
        let id =
            world.add(&free_box(Vector::repeat(0.01), Vector::new(0.0, 0.0, 5.0))).expect("added");
        let n = 240;
        steps(&mut world, n);
        let dt = 1.0 / 480.0 / f64::from(moves);
        let n = n * moves;
        // Semi-implicit Euler: z = z0 - g dt² n(n+1)/2.
        let expected = 5.0 - 9.81 * dt * dt * f64::from(n * (n + 1)) / 2.0;
        let got = state(&world, id).pose.translation.z;
        let tolerance = precision(1e-12, 2e-5);
        near(&format!("z0 - g dt² n(n+1)/2 at scale {length_scale}"), got, expected, tolerance);
    }
}

/// Law: portable instructions are read back where they were asked for, however many contacts are
/// solved at once.
#[test]
fn portable_instructions_are_read_back() {
    let _turn = shared_turn();
    for contacts_at_once in [1, 8] {
        let native = NativeSettings { portable: true, contacts_at_once, ..Default::default() };
        let settings = EngineSettings { native, ..on(ContactSolver::Native) };
        let held = world(&settings).effective()["portable_instructions"].as_f64();
        assert_eq!(held, Some(1.0), "law: asked for with {contacts_at_once} at once");
    }
}

#[test]
fn worlds_with_different_process_wide_settings_do_not_live_together() {
    let _turn = exclusive_turn();
    let _first = world(&on(ContactSolver::Stock));
    let other = EngineSettings { contact_threshold_mm: 0.5, ..on(ContactSolver::Stock) };
    let second = BulletBackend::new(&other, GRAVITY, &uniform(0.5, 0.0)).map(|_| ());
    assert!(
        matches!(&second, Err(WorldError::Engine(text)) if text.contains("whole process")),
        "law: another contact threshold is refused while a world has one, got {second:?}"
    );
}

#[test]
fn native_contacts_hold_a_box_at_its_four_corners() {
    let _turn = shared_turn();
    let mut world = world(&on(ContactSolver::Native));
    let floor = world.add(&slab(Motion::Static)).expect("added");
    let grain =
        world.add(&free_box(Vector::repeat(0.01), Vector::new(0.0, 0.0, 0.005))).expect("added");
    for step in 0..200 {
        world.step().expect("a step");
        let contacts = contacts(&world);
        let pair = contacts
            .iter()
            .filter(|c| [c.a, c.b] == [grain, floor] || [c.a, c.b] == [floor, grain]);
        assert_eq!(pair.count(), 4, "law: a box lies on four corners, at step {step}");
    }
    world.remove(grain).expect("removed");
    world.step().expect("a step");
    let contacts = contacts(&world);
    assert!(contacts.is_empty(), "law: contacts go with their body, left are {contacts:?}");
    let held = world.effective();
    let speculative_margin = held["native_speculative_margin_m"].as_f64().expect("a number");
    near("speculative_margin", speculative_margin, 0.2e-3, 1e-9);
}
