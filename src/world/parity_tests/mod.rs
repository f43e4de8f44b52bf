//! Laws that every engine has to keep: one body of code, run over all of them, operation by
//! operation. Here: pairs, adding and removing, refusals, determinism; in `motion`: how bodies move
//! and touch; in `spheres`: how spheres do; in `rounded`: rounded polyhedra.

mod motion;
mod rounded;
mod spheres;

use nalgebra::UnitQuaternion;

use super::testing::{GRAVITY, contacts, free, free_box, slab, snapshot, state, steps, uniform};
use super::*;
use crate::scenario::ContactSolver;

/// An engine under test.
struct Engine {
    backend: Backend,
    settings: EngineSettings,
}

/// Runs a test over all engines that are built in.
fn each(test: impl Fn(&Engine)) {
    // Bullet holds settings for the whole process: take a turn with those who use the defaults.
    let _turn = shared_turn();
    let native = EngineSettings::default();
    let bullets_own = EngineSettings { contact_solver: ContactSolver::Stock, ..native.clone() };
    let rapier = EngineSettings { backend: Backend::Rapier, ..native.clone() };
    for settings in [bullets_own, native, rapier] {
        if built_in().contains(&settings.backend) {
            test(&Engine { backend: settings.backend, settings });
        }
    }
}

impl Engine {
    fn world(&self, table: &PairTable) -> Box<dyn World + Send> {
        self.world_under(GRAVITY, table)
    }

    fn world_under(&self, gravity: Vector, table: &PairTable) -> Box<dyn World + Send> {
        create(&self.settings, gravity, table).expect("a world")
    }

    /// Stock Bullet contacts move bodies once a step, the others once a sub-step.
    fn moves_a_step(&self) -> u32 {
        match (self.backend, self.settings.contact_solver) {
            (Backend::Bullet, ContactSolver::Stock) => 1,
            (Backend::Bullet, ContactSolver::Native) => {
                self.settings.native.substeps(self.settings.rate_hz)
            }
            (Backend::Rapier, _) => self.settings.rapier.substeps,
        }
    }

    /// `double` where rounding is that of double precision, else `single`.
    fn precision(&self, double: f64, single: f64) -> f64 {
        if info(self.backend).precision == "double" { double } else { single }
    }

    /// Fails unless `got` is within `tolerance` of `expected`.
    fn expect(&self, law: &str, expected: f64, got: f64, tolerance: f64) {
        assert!(
            (got - expected).abs() <= tolerance,
            "{:?} {:?}, law: {law}: expected {expected}, got {got}, tolerance {tolerance}",
            self.backend,
            self.settings.contact_solver
        );
    }
}

fn mass(body: &Body) -> f64 {
    let Motion::Free { mass, .. } = body.motion else { panic!("a free body") };
    mass
}

#[test]
fn every_pair_has_the_coefficients_of_the_table() {
    use Material::{Grain, Plate, Wall};
    // No rule that combines one value of each body gives this table.
    let pairs = [
        (Grain, Grain, 0.793, 0.315),
        (Grain, Wall, 0.2, 0.9),
        (Grain, Plate, 0.6, 0.0),
        (Wall, Plate, 0.05, 0.55),
        (Plate, Plate, 1.3, 0.7),
        (Wall, Wall, 0.4, 0.2),
    ];
    let mut table = uniform(0.0, 0.0);
    for (a, b, friction, restitution) in pairs {
        table.set(a, b, PairCoefficients { friction, restitution });
    }
    each(|engine| {
        for touching in [false, true] {
            for (first, second, friction, restitution) in pairs {
                let mut world = engine.world_under(Vector::zeros(), &table);
                let mut add = |material, x: f64, is_fixed: bool| {
                    let mut body = free_box(Vector::repeat(0.01), Vector::new(x, 0.0, 0.0));
                    body.material = material;
                    body.motion = if is_fixed { Motion::Static } else { body.motion };
                    world.add(&body).expect("added")
                };
                let distance = if touching { 0.00999 } else { 1.0 };
                // Of two walls one is free: others never meet.
                let a = add(first, 0.0, first == Wall);
                let b = add(second, distance, second == Wall && first != Wall);
                world.step().expect("a step");
                let contacts = contacts(world.as_ref());
                assert_eq!(!contacts.is_empty(), touching, "{:?} finds contacts", engine.backend);
                // Rounding of an average of two numbers near one.
                let tolerance = engine.precision(1e-15, 1e-7);
                for (a, b) in [(a, b), (b, a)] {
                    let got = world.pair_coefficients(a, b).expect("both are there");
                    let law = |what| {
                        format!("{what} of {first:?} on {second:?}, touching: {touching}, is typed")
                    };
                    engine.expect(&law("friction"), friction, got.friction, tolerance);
                    engine.expect(&law("restitution"), restitution, got.restitution, tolerance);
                }
            }
        }
    });
}

#[test]
fn pairs_that_cannot_be_are_refused() {
    each(|engine| {
        for (friction, restitution) in [(-0.1, 0.0), (f64::NAN, 0.0), (0.5, 1.1), (0.5, -0.1)] {
            let made = create(&engine.settings, GRAVITY, &uniform(friction, restitution));
            assert!(
                matches!(made, Err(WorldError::BadSetting { .. })),
                "{:?} must refuse friction {friction}, restitution {restitution}",
                engine.backend
            );
        }
    });
}

#[test]
fn walls_do_not_meet_each_other() {
    each(|engine| {
        let mut world = engine.world(&uniform(0.5, 0.0));
        for motion in [Motion::Static, Motion::Kinematic, Motion::Static] {
            world.add(&slab(motion)).expect("added");
        }
        steps(world.as_mut(), 10);
        let contacts = contacts(world.as_ref());
        assert!(contacts.is_empty(), "{:?}: walls meet: {contacts:?}", engine.backend);
    });
}

#[test]
fn a_removed_body_is_gone_and_its_number_stays_unused() {
    each(|engine| {
        let mut world = engine.world(&uniform(0.5, 0.0));
        let floor = world.add(&slab(Motion::Static)).expect("added");
        let body = |z| free_box(Vector::repeat(0.01), Vector::new(0.0, 0.0, z));
        let first = world.add(&body(0.005)).expect("added");
        steps(world.as_mut(), 48);
        let high = state(world.as_ref(), first).pose.translation.z;
        engine.expect("the floor holds the body", 0.005, high, 1e-4);
        world.remove(floor).expect("removed");
        steps(world.as_mut(), 48);
        let fallen = state(world.as_ref(), first).pose.translation.z;
        // 0.1 s of free fall, plus or minus a step.
        engine.expect("without it the body falls by g t²/2", 0.005 - 0.049, fallen, 0.003);
        let contacts = contacts(world.as_ref());
        assert!(contacts.is_empty(), "{:?}: no contacts are left", engine.backend);

        let second = world.add(&body(0.1)).expect("added");
        assert_eq!(second, BodyId(2), "{:?}: numbers go on", engine.backend);
        let present: Vec<bool> = snapshot(world.as_ref()).iter().map(Option::is_some).collect();
        assert_eq!(present, [false, true, true], "{:?}", engine.backend);
        assert!(matches!(world.remove(floor), Err(WorldError::NoSuchBody(id)) if id == floor));
        let nowhere = Pose::identity();
        assert!(matches!(world.drive(second, &nowhere), Err(WorldError::NotKinematic(_))));
        assert!(matches!(world.drive(BodyId(9), &nowhere), Err(WorldError::NoSuchBody(_))));
        assert!(world.pair_coefficients(floor, second).is_err());
    });
}

#[test]
fn shapes_are_read_back_as_the_engine_holds_them() {
    each(|engine| {
        let mut world = engine.world(&uniform(0.5, 0.0));
        let mut bodies = [[0.01, 0.013, 0.016], [0.02, 0.01, 0.01], [0.01, 0.013, 0.0161]]
            .map(|sides| free_box(Vector::from(sides), Vector::zeros()));
        for (n, body) in bodies.iter_mut().enumerate() {
            body.state.pose.translation.vector.x = 0.1 * n as f64;
        }
        let ids = bodies.each_ref().map(|body| world.add(body).expect("added"));
        steps(world.as_mut(), 2);
        world.remove(ids[1]).expect("removed");
        let mut corners = Vec::new();
        world.corners(&mut corners);
        assert_eq!(corners.len(), 3, "{:?}: an entry a body", engine.backend);
        assert!(corners[1].is_none(), "{:?}: what was removed has no corners", engine.backend);
        for n in [0, 2] {
            let mut held = corners[n].clone().expect("corners").corners;
            assert_eq!(held.len(), 8, "{:?}: a box has eight corners", engine.backend);
            for given in bodies[n].shape.vertices() {
                let distance = |p: &Vector| (p - given.coords).norm();
                held.sort_by(|a, b| distance(a).total_cmp(&distance(b)));
                // In single precision a corner is rounded by 6e-8 of its place.
                engine.expect("each corner is held, m", 0.0, distance(&held[0]), 2e-9);
            }
        }
    });
}

#[test]
fn bad_bodies_and_settings_are_refused() {
    each(|engine| {
        let mut world = engine.world(&uniform(0.5, 0.0));
        type Change = fn(&mut Body);
        let changes: [Change; 5] = [
            |b| b.state.linear_velocity.x = f64::NAN,
            |b| b.state.pose.translation.vector.y = f64::INFINITY,
            |b| b.motion = Motion::Free { mass: 0.0, inertia: Vector::repeat(1.0) },
            |b| b.motion = Motion::Free { mass: f64::NAN, inertia: Vector::repeat(1.0) },
            |b| b.motion = Motion::Free { mass: 1.0, inertia: Vector::new(1.0, 0.0, 1.0) },
        ];
        for (number, change) in changes.iter().enumerate() {
            let mut bad = free_box(Vector::repeat(0.01), Vector::zeros());
            change(&mut bad);
            assert!(
                matches!(world.add(&bad), Err(WorldError::BadBody(_))),
                "{:?} must refuse bad body {number}",
                engine.backend
            );
        }
        let good = world.add(&free_box(Vector::repeat(0.01), Vector::zeros())).expect("added");
        assert_eq!(good, BodyId(0), "{:?}: a refused body takes no number", engine.backend);
        let bad = EngineSettings { rate_hz: 0.0, ..engine.settings.clone() };
        let made = create(&bad, GRAVITY, &uniform(0.5, 0.0));
        assert!(matches!(made, Err(WorldError::BadSetting { .. })), "{:?}", engine.backend);
        let sideways = Vector::new(f64::NAN, 0.0, 0.0);
        let made = create(&engine.settings, sideways, &uniform(0.5, 0.0));
        assert!(matches!(made, Err(WorldError::BadSetting { .. })), "{:?}", engine.backend);
    });
}

#[test]
fn the_same_input_gives_the_same_bits_on_any_thread() {
    each(|engine| {
        let tumble = || {
            let mut world = engine.world(&uniform(0.5, 0.3));
            world.add(&slab(Motion::Static)).expect("added");
            let ids: Vec<_> = (0..8)
                .map(|i| {
                    let i = f64::from(i);
                    let at = Vector::new(0.001 * i, 0.0, 0.03 + 0.025 * i);
                    let mut body = free_box(Vector::new(0.01, 0.013, 0.016), at);
                    body.state.angular_velocity = Vector::new(3.0, i, 1.0);
                    world.add(&body).expect("added")
                })
                .collect();
            steps(world.as_mut(), 480);
            ids.into_iter().map(|id| state(world.as_ref(), id)).collect::<Vec<_>>()
        };
        let alone = tumble();
        let (one, two) = std::thread::scope(|scope| {
            let (one, two) = (scope.spawn(tumble), scope.spawn(tumble));
            (one.join().expect("no panic"), two.join().expect("no panic"))
        });
        assert!(alone == one && alone == two, "{:?}: same input, same bits", engine.backend);
        assert!(
            alone.iter().all(|s| s.pose.translation.z > 0.0),
            "{:?}: the slab holds them all",
            engine.backend
        );
    });
}
