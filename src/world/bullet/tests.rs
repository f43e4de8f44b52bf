//! The backend against laws that hold in any engine.

use std::sync::{Arc, PoisonError, RwLock, RwLockReadGuard, RwLockWriteGuard};

use super::*;
use crate::geometry::MassProperties;
use crate::scenario::ContactSolver;
use crate::world::Material;

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

const GRAVITY: Vector = Vector::new(0.0, 0.0, -9.81);

fn pairs() -> PairTable {
    PairTable::uniform(PairCoefficients { friction: 0.5, restitution: 0.0 })
}

const PATHS: [ContactSolver; 2] = [ContactSolver::Stock, ContactSolver::Native];

fn on(contact_solver: ContactSolver) -> EngineSettings {
    EngineSettings { contact_solver, ..Default::default() }
}

fn world(settings: &EngineSettings) -> BulletBackend {
    BulletBackend::new(settings, GRAVITY, &pairs()).expect("a world")
}

pub(super) fn free_box(sides: Vector, at: Vector) -> Body {
    let shape = ConvexPolyhedron::cuboid(sides).expect("a box");
    let properties = MassProperties::of(&shape);
    let density = 2673.9;
    Body {
        shape: Arc::new(shape),
        motion: Motion::Free {
            mass: density * properties.volume,
            inertia: properties.inertia_per_density.diagonal() * density,
        },
        material: Material::Grain,
        state: BodyState::at_rest(Pose::from_parts(at.into(), UnitQuaternion::identity())),
    }
}

pub(super) fn slab(motion: Motion) -> Body {
    let shape = ConvexPolyhedron::cuboid(Vector::new(0.4, 0.4, 0.02)).expect("a slab");
    Body {
        shape: Arc::new(shape),
        motion,
        material: Material::Wall,
        state: BodyState::at_rest(Pose::translation(0.0, 0.0, -0.01)),
    }
}

fn state(world: &BulletBackend, id: BodyId) -> BodyState {
    let mut snapshot = Snapshot::new();
    world.read(&mut snapshot);
    snapshot[id.0 as usize].expect("a body")
}

/// How far single precision may stray where double is exact to rounding.
pub(super) fn precision(double: f64, single: f64) -> f64 {
    if constants::PLUVIA_SCALAR_BYTES == 8 { double } else { single }
}

#[test]
fn settings_are_read_back_from_the_engine() {
    let _turn = shared_turn();
    let settings = EngineSettings { rate_hz: 960.0, iterations: 37, ..Default::default() };
    let mut world = world(&settings);
    world.add(&free_box(Vector::repeat(0.01), Vector::zeros())).expect("added");
    let held = world.effective();
    for (name, expected) in
        [("iterations", 37.0), ("time_step_s", 1.0 / 960.0), ("collision_margin_m", 0.0)]
    {
        let got = held[name].as_f64().expect("a number");
        assert!(
            (got - expected).abs() < 1e-9,
            "setting {name}: expected {expected}, got {got}, tolerance 1e-9"
        );
    }
    let directions = |n| {
        let world = super::super::create(
            &EngineSettings { friction_directions: n, ..settings.clone() },
            GRAVITY,
            &pairs(),
        )
        .expect("a world");
        world.effective()["solver_mode"].as_f64().expect("a number") as u32
    };
    let bit = constants::SOLVER_USE_2_FRICTION_DIRECTIONS;
    assert_eq!(directions(2) & bit, bit, "two friction directions are on when asked for");
    assert_eq!(directions(1) & bit, 0, "and off when not");
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
        for _ in 0..n {
            world.step().expect("a step");
        }
        let dt = 1.0 / 480.0 / f64::from(moves);
        let n = n * moves;
        // Semi-implicit Euler: z = z0 - g dt² n(n+1)/2.
        let expected = 5.0 - 9.81 * dt * dt * f64::from(n * (n + 1)) / 2.0;
        let got = state(&world, id).pose.translation.z;
        let tolerance = precision(1e-12, 2e-5);
        assert!(
            (got - expected).abs() < tolerance,
            "law z0 - g dt² n(n+1)/2 at scale {length_scale}: expected {expected}, got {got}, \
             tolerance {tolerance}"
        );
    }
}

#[test]
fn torque_free_spin_keeps_the_given_inertia() {
    // An uneven box spinning freely keeps its angular momentum only if the
    // engine holds the inertia it was given, in the right axes.
    let _turn = shared_turn();
    let settings = EngineSettings { rate_hz: 1000.0, ..Default::default() };
    let mut world = BulletBackend::new(&settings, Vector::zeros(), &pairs()).expect("a world");
    let mut body = free_box(Vector::new(0.01, 0.014, 0.02), Vector::zeros());
    body.state.angular_velocity = Vector::new(5.0, 30.0, 3.0);
    let Motion::Free { inertia, .. } = body.motion else { panic!("free") };
    let momentum = |s: &BodyState| {
        s.pose.rotation * inertia.component_mul(&(s.pose.rotation.inverse() * s.angular_velocity))
    };
    let id = world.add(&body).expect("added");
    let before = momentum(&body.state);
    for _ in 0..500 {
        world.step().expect("a step");
    }
    let after = momentum(&state(&world, id));
    let drift = (after - before).norm() / before.norm();
    assert!(drift < 0.02, "law: L is constant, expected drift 0, got {drift}, tolerance 0.02");
}

#[test]
fn a_pair_gets_the_coefficients_of_its_materials() {
    let _turn = shared_turn();
    let mut table = pairs();
    let expected = PairCoefficients { friction: 0.793, restitution: 0.315 };
    table.set(Material::Grain, Material::Wall, expected);
    let mut world =
        BulletBackend::new(&EngineSettings::default(), GRAVITY, &table).expect("a world");
    let grain = world.add(&free_box(Vector::repeat(0.01), Vector::zeros())).expect("added");
    let wall = world.add(&slab(Motion::Static)).expect("added");
    for (a, b) in [(grain, wall), (wall, grain)] {
        let got = world.pair_coefficients(a, b).expect("both are there");
        let error = (got.friction - expected.friction)
            .abs()
            .max((got.restitution - expected.restitution).abs());
        assert!(error < precision(1e-15, 1e-7), "expected {expected:?}, got {got:?}");
    }
    let same = world.pair_coefficients(grain, grain).expect("there");
    assert_eq!(same.friction, 0.5, "and no other pair changes");
}

#[test]
fn a_kinematic_body_is_where_it_was_driven_and_carries_by_friction() {
    let _turn = shared_turn();
    for path in PATHS {
        let mut world = world(&on(path));
        let table = world.add(&slab(Motion::Kinematic)).expect("added");
        let grain = world
            .add(&free_box(Vector::new(0.02, 0.02, 0.01), Vector::new(0.0, 0.0, 0.005)))
            .expect("added");
        let dt = world.time_step();
        let speed = 0.1;
        for step in 1..=480 {
            let x = speed * dt * f64::from(step);
            world.drive(table, &Pose::translation(x, 0.0, -0.01)).expect("driven");
            world.step().expect("a step");
        }
        let got = state(&world, table).pose.translation.x;
        assert!((got - 0.1).abs() < precision(1e-12, 1e-6), "driven to 0.1 m, got {got}");
        let carried = state(&world, grain).linear_velocity.x;
        assert!(
            (carried - speed).abs() < 1e-3,
            "law: Coulomb friction brings the box to the table's speed, expected {speed}, got \
             {carried}, tolerance 1e-3"
        );
    }
}

#[test]
fn contacts_carry_the_weight() {
    let _turn = shared_turn();
    for path in PATHS {
        let mut world = world(&on(path));
        let floor = world.add(&slab(Motion::Static)).expect("added");
        let body = free_box(Vector::repeat(0.02), Vector::new(0.0, 0.0, 0.01));
        let Motion::Free { mass, .. } = body.motion else { panic!("free") };
        let grain = world.add(&body).expect("added");
        let (mut contacts, mut total, steps) = (Vec::new(), 0.0, 480);
        for step in 0..2 * steps {
            world.step().expect("a step");
            if step < steps {
                continue;
            }
            world.contacts(&mut contacts);
            for c in &contacts {
                assert!([c.a, c.b].contains(&floor) && [c.a, c.b].contains(&grain), "{c:?}");
                let upwards = if c.a == grain { c.impulse.z } else { -c.impulse.z };
                total += upwards;
                let outwards = if c.a == grain { c.normal.z } else { -c.normal.z };
                assert!(outwards > 0.99, "the normal points from b to a: {c:?}");
            }
        }
        let got = total / (f64::from(steps) * world.time_step());
        let expected = mass * 9.81;
        assert!(
            (got / expected - 1.0).abs() < 0.01,
            "law: floor force equals weight, expected {expected} N, got {got} N, tolerance 1 %"
        );
    }
}

#[test]
fn a_removed_body_is_gone_and_its_number_stays_unused() {
    let _turn = shared_turn();
    let mut world = world(&EngineSettings::default());
    let first = world.add(&free_box(Vector::repeat(0.01), Vector::zeros())).expect("added");
    world.remove(first).expect("removed");
    let second = world.add(&free_box(Vector::repeat(0.01), Vector::zeros())).expect("added");
    assert_ne!(first, second);
    let mut snapshot = Snapshot::new();
    world.read(&mut snapshot);
    assert!(snapshot[0].is_none() && snapshot[1].is_some());
    assert!(matches!(world.remove(first), Err(WorldError::NoSuchBody(id)) if id == first));
    let nowhere = Pose::identity();
    assert!(matches!(world.drive(second, &nowhere), Err(WorldError::NotKinematic(_))));
    assert!(matches!(world.drive(BodyId(9), &nowhere), Err(WorldError::NoSuchBody(_))));
    assert!(world.pair_coefficients(first, second).is_err());
}

#[test]
fn refuses_what_no_engine_should_see() {
    let _turn = shared_turn();
    let mut world = world(&EngineSettings::default());
    let mut bad = free_box(Vector::repeat(0.01), Vector::zeros());
    bad.state.linear_velocity.x = f64::NAN;
    assert!(matches!(world.add(&bad), Err(WorldError::BadBody { .. })));
    let mut bad = free_box(Vector::repeat(0.01), Vector::zeros());
    bad.motion = Motion::Free { mass: 0.0, inertia: Vector::repeat(1.0) };
    assert!(matches!(world.add(&bad), Err(WorldError::BadBody { .. })));
    for settings in [
        EngineSettings { rate_hz: 0.0, ..Default::default() },
        EngineSettings { length_scale: f64::NAN, ..Default::default() },
        EngineSettings { friction_directions: 3, ..Default::default() },
    ] {
        let made = BulletBackend::new(&settings, GRAVITY, &pairs());
        assert!(matches!(made, Err(WorldError::BadSetting { .. })), "{settings:?}");
    }
}

#[test]
fn worlds_with_different_process_wide_settings_do_not_live_together() {
    let _turn = exclusive_turn();
    let first = world(&on(ContactSolver::Stock));
    let other = EngineSettings { contact_threshold_mm: 0.5, ..on(ContactSolver::Stock) };
    assert!(matches!(
        BulletBackend::new(&other, GRAVITY, &pairs()),
        Err(WorldError::Engine(text)) if text.contains("whole process")
    ));
    let native = EngineSettings { contact_threshold_mm: 0.5, ..Default::default() };
    assert!(
        BulletBackend::new(&native, GRAVITY, &pairs()).is_ok(),
        "law: the native contact solver does not read the threshold"
    );
    drop(first);
    assert!(BulletBackend::new(&other, GRAVITY, &pairs()).is_ok());
}

#[test]
fn two_worlds_in_two_threads_give_the_bits_of_one() {
    let _turn = shared_turn();
    let tumble = |path| {
        let mut world = world(&on(path));
        world.add(&slab(Motion::Static)).expect("added");
        let ids: Vec<_> = (0..8)
            .map(|i| {
                let height = 0.03 + 0.025 * f64::from(i);
                let mut body = free_box(
                    Vector::new(0.01, 0.013, 0.016),
                    Vector::new(0.001 * f64::from(i), 0.0, height),
                );
                body.state.angular_velocity = Vector::new(3.0, f64::from(i), 1.0);
                world.add(&body).expect("added")
            })
            .collect();
        for _ in 0..480 {
            world.step().expect("a step");
        }
        ids.into_iter().map(|id| state(&world, id)).collect::<Vec<_>>()
    };
    for path in PATHS {
        let alone = tumble(path);
        let (one, two) = std::thread::scope(|scope| {
            let (one, two) = (scope.spawn(|| tumble(path)), scope.spawn(|| tumble(path)));
            (one.join().expect("no panic"), two.join().expect("no panic"))
        });
        assert!(alone == one && alone == two, "law: same input, same bits, on any thread");
        assert!(alone.iter().all(|s| s.pose.translation.z > 0.0), "and the slab holds them all");
    }
}

#[test]
fn the_manifold_path_holds_a_box_at_its_four_corners() {
    let _turn = shared_turn();
    let mut world = world(&on(ContactSolver::Native));
    let floor = world.add(&slab(Motion::Static)).expect("added");
    let grain =
        world.add(&free_box(Vector::repeat(0.01), Vector::new(0.0, 0.0, 0.005))).expect("added");
    for step in 0..200 {
        world.step().expect("a step");
        let mut contacts = Vec::new();
        world.contacts(&mut contacts);
        let pair = contacts
            .iter()
            .filter(|c| [c.a, c.b] == [grain, floor] || [c.a, c.b] == [floor, grain]);
        assert_eq!(pair.count(), 4, "law: a box lies on four corners, at step {step}");
    }
    world.remove(grain).expect("removed");
    world.step().expect("a step");
    let mut contacts = Vec::new();
    world.contacts(&mut contacts);
    assert!(contacts.is_empty(), "law: contacts go with their body, left are {contacts:?}");
    let held = world.effective();
    let speculative_margin = held["native_speculative_margin_m"].as_f64().expect("a number");
    assert!(
        (speculative_margin - 0.2e-3).abs() < 1e-9,
        "speculative_margin: expected 0.2e-3 m, got {speculative_margin}"
    );
}
