//! Pressed bodies against laws of mechanics, with contacts eight at once and one by one.

use super::tests::{contacts, free_box, native_world, precision, shared_turn, slab, uniform};
use super::*;
use crate::geometry::testing::near;
use crate::scenario::{ContactSolver, NativeSettings};

const GRAVITY: f64 = 9.81;
/// Of the lid, in kg.
const MASS: f64 = 0.3;
/// Thickness of the lid in m.
const THICK: f64 = 0.01;
/// Side of the block in m.
const SIDE: f64 = 0.02;

/// As lanes, and one contact at a time.
pub(super) const AT_ONCE: [u32; 2] = [8, 1];

pub(super) fn world(contacts_at_once: u32, friction: f64, restitution: f64) -> BulletBackend {
    let native = NativeSettings { contacts_at_once, ..Default::default() };
    native_world(native, friction, restitution)
}

/// A lid whose lower side is at a height, pressed along a direction.
fn lid(height: f64, direction: Vector, speed: f64) -> Body {
    let at = Vector::new(0.0, 0.0, height + THICK / 2.0);
    let mut body = free_box(Vector::new(0.1, 0.1, THICK), at);
    body.motion = Motion::Pressed { mass: MASS, direction };
    body.state.linear_velocity = direction * speed;
    body
}

pub(super) fn steps(world: &mut BulletBackend, time: f64) {
    for _ in 0..(time / world.time_step()).round() as usize {
        world.step().expect("a step");
    }
}

/// Force on a body in the last step, and its moment about a point, both in SI.
pub(super) fn load(world: &BulletBackend, on: BodyId, about: Vector) -> (Vector, Vector) {
    let contacts = contacts(world);
    let signed = |c: &Contact| [(c.a, c.impulse, c.point), (c.b, -c.impulse, c.point)];
    let of = contacts.iter().flat_map(signed).filter(|(body, ..)| *body == on);
    of.fold((Vector::zeros(), Vector::zeros()), |(force, moment), (_, impulse, point)| {
        let on: Vector = impulse / world.time_step();
        (force + on, moment + (point - about).cross(&on))
    })
}

#[test]
fn a_force_accelerates_along_the_direction_alone() {
    let _turn = shared_turn();
    for direction in [-Vector::z(), Vector::x(), Vector::new(0.6, 0.0, -0.8)] {
        for at_once in AT_ONCE {
            let mut world = world(at_once, 0.5, 0.0);
            let lid = world.add(&lid(1.0, direction, 0.1)).expect("added");
            let began = world.read_body(lid).expect("there");
            world.press(lid, 0.6).expect("pressed");
            steps(&mut world, 0.25);
            let now = world.read_body(lid).expect("there");
            let speed = now.linear_velocity - direction * (0.1 + 0.6 / MASS * 0.25);
            near("no weight, a = F/m", speed.norm(), 0.0, precision(1e-12, 1e-5));
            let way = now.pose.translation.vector - began.pose.translation.vector;
            let aside = way - direction * direction.dot(&way);
            near("it does not go aside", aside.norm(), 0.0, precision(1e-15, 1e-6));
            // Half a sub-step's worth more, as of every fall.
            near("½ a t² + v t", direction.dot(&way), 0.1 * 0.25 + 0.0625, 4e-4);
            assert_eq!(now.angular_velocity, Vector::zeros(), "law: it does not turn");
        }
    }
}

/// A block of 20 mm on a floor beneath a lid with a force, at rest: the world, the block, the lid.
fn loaded(at_once: u32, friction: f64, force: f64) -> (BulletBackend, BodyId, BodyId) {
    loaded_in(world(at_once, friction, 0.0), force)
}

fn loaded_in(mut world: BulletBackend, force: f64) -> (BulletBackend, BodyId, BodyId) {
    world.add(&slab(Motion::Static)).expect("added");
    let at = Vector::new(0.005, -0.003, SIDE / 2.0);
    let block = world.add(&free_box(Vector::repeat(SIDE), at)).expect("added");
    let lid = world.add(&lid(SIDE, -Vector::z(), 0.0)).expect("added");
    world.press(lid, force).expect("pressed");
    steps(&mut world, 0.5);
    (world, block, lid)
}

#[test]
fn a_pressed_block_passes_the_force_on_and_yields_as_a_spring() {
    let _turn = shared_turn();
    let stiffness = NativeSettings::default().contact_stiffness_n_per_m;
    let force = 4.0;
    for at_once in AT_ONCE {
        let (world, block, lid) = loaded(at_once, 0.5, force);
        let weight = GRAVITY * 2673.9 * SIDE.powi(3);
        let on = |body: BodyId| load(&world, body, Vector::zeros()).0;
        near("the lid bears the force", on(lid).z, force, 1e-3 * force);
        near("the floor bears force and weight", -on(BodyId(0)).z, force + weight, 1e-3 * force);
        for (body, what) in [(lid, "nothing sideways at the lid"), (BodyId(0), "nor at the floor")]
        {
            near(what, on(body).xy().norm(), 0.0, 1e-3 * force);
        }
        let now = world.read_body(lid).expect("there");
        // Four corners at the floor under force and weight, four at the lid under the force.
        let yields = (force + weight) / (4.0 * stiffness) + force / (4.0 * stiffness);
        let sunk = SIDE + THICK / 2.0 - now.pose.translation.vector.z;
        near("overlap f/k of each of four corners", sunk, yields, 0.01 * yields);
        near("at rest", now.linear_velocity.norm(), 0.0, 1e-6);
        let block = world.read_body(block).expect("there");
        near("the block as well", block.linear_velocity.norm(), 0.0, 1e-6);
    }
}

/// Law: an overlap is pushed apart with at most a speed v, and so a contact bears at most
/// v (c + h k): 6 N at a corner with 0.3 m/s, ten times that with what loaded scenarios have. Under
/// 10 N a corner the lid sinks on and on with the one, and by f/k with the other.
#[test]
fn a_limit_of_the_speed_is_one_of_the_force() {
    let _turn = shared_turn();
    let force = 40.0;
    for contacts_at_once in AT_ONCE {
        let sunk = |speed: f64| {
            let native = NativeSettings {
                contacts_at_once,
                max_depenetration_velocity_m_per_s: speed,
                ..Default::default()
            };
            let (world, _, lid) = loaded_in(native_world(native, 0.5, 0.0), force);
            SIDE + THICK / 2.0 - world.read_body(lid).expect("there").pose.translation.vector.z
        };
        let stiffness = NativeSettings::default().contact_stiffness_n_per_m;
        let yields = 2.0 * force / (4.0 * stiffness);
        near("overlap f/k with 3 m/s", sunk(3.0), yields, 0.02 * yields);
        let sunk = sunk(0.3);
        assert!(
            sunk > 1.5 * yields,
            "law: sinks on with 0.3 m/s, beyond {yields:e} m, got {sunk:e}"
        );
    }
}

#[test]
fn a_block_between_floor_and_lid_is_slowed_by_the_friction_of_both() {
    let _turn = shared_turn();
    for at_once in AT_ONCE {
        let (force, friction, speed) = (0.1, 0.3, 0.5);
        let (mut world, block, lid) = loaded(at_once, friction, force);
        let mass = 2673.9 * SIDE.powi(3);
        // The block as it is, with a speed: in a world of its own, as bodies cannot be pushed.
        let mut state = world.read_body(block).expect("there");
        state.linear_velocity = Vector::new(speed, 0.0, 0.0);
        let lid_at = world.read_body(lid).expect("there");
        let mut other = self::world(at_once, friction, 0.0);
        other.add(&slab(Motion::Static)).expect("added");
        let body = free_box(Vector::repeat(SIDE), Vector::zeros());
        let block = other.add(&Body { state, ..body }).expect("added");
        let lid = other.add(&Body { state: lid_at, ..self::lid(SIDE, -Vector::z(), 0.0) });
        let lid = lid.expect("added");
        other.press(lid, force).expect("pressed");
        world = other;
        let slowed = friction * (2.0 * force + mass * GRAVITY) / mass;
        let expected = speed * speed / (2.0 * slowed);
        steps(&mut world, 2.0 * speed / slowed);
        let now = world.read_body(block).expect("there");
        let way = now.pose.translation.vector.x - state.pose.translation.vector.x;
        // The first of 1440 sub-steps a second is slowed as a whole: v h/2 less.
        near("v²/2a with a = μ (2 F + m g)/m", way, expected, 0.01 * expected);
        near("and stops", now.linear_velocity.norm(), 0.0, 1e-4);
        let aside = world.read_body(lid).expect("there").pose.translation.vector.xy().norm();
        near("the lid is not dragged along", aside, 0.0, 1e-12);
    }
}

#[test]
fn an_impact_of_a_lid_keeps_momentum_and_rebounds_as_typed() {
    let _turn = shared_turn();
    for at_once in AT_ONCE {
        let restitution = 0.5;
        let pairs = uniform(0.0, restitution);
        let native = NativeSettings { contacts_at_once: at_once, ..Default::default() };
        let settings = EngineSettings { native, ..Default::default() };
        let mut world = BulletBackend::new(&settings, Vector::zeros(), &pairs).expect("a world");
        let block = free_box(Vector::repeat(SIDE), Vector::new(0.0, 0.0, SIDE / 2.0));
        let block = world.add(&block).expect("added");
        let lid = world.add(&lid(SIDE + 0.003, -Vector::z(), 0.4)).expect("added");
        steps(&mut world, 0.05);
        let mass = 2673.9 * SIDE.powi(3);
        let all = MASS + mass;
        let lid = world.read_body(lid).expect("there").linear_velocity.z;
        let block = world.read_body(block).expect("there").linear_velocity.z;
        let momentum = MASS * 0.4;
        near("momentum", -(MASS * lid + mass * block), momentum, 1e-5 * momentum);
        near("of the lid", -lid, (momentum - mass * restitution * 0.4) / all, 1e-3);
        near("of the block", -block, (momentum + MASS * restitution * 0.4) / all, 1e-3);
    }
}

/// Law: what a force drives from a small distance is stopped at the surface, though it moves on by
/// more than contacts are looked for within the step.
#[test]
fn a_lid_that_a_force_drives_is_stopped_at_the_surface() {
    let _turn = shared_turn();
    let force = 400.0 * MASS;
    for at_once in AT_ONCE {
        for gap in [2.2e-4, 3e-4, 5e-4] {
            let native = NativeSettings {
                contacts_at_once: at_once,
                contact_stiffness_n_per_m: 1e6,
                max_depenetration_velocity_m_per_s: 3.0,
                ..Default::default()
            };
            let mut world = native_world(native, 0.5, 0.0);
            world.add(&slab(Motion::Static)).expect("added");
            let at = Vector::new(0.0, 0.0, SIDE / 2.0);
            world.add(&free_box(Vector::repeat(SIDE), at)).expect("added");
            let lid = world.add(&lid(SIDE + gap, -Vector::z(), 0.0)).expect("added");
            world.press(lid, force).expect("pressed");
            let mut deepest = 0.0_f64;
            for _ in 0..24 {
                world.step().expect("a step");
                let height = world.read_body(lid).expect("there").pose.translation.z;
                deepest = deepest.max(SIDE + THICK / 2.0 - height);
            }
            // Four corners above and four below, pressed by no more than twice the force.
            let springs = 2.0 * 2.0 * force / 4e6;
            let case = format!("overlap in m from {gap} m");
            assert!(
                deepest < springs + 2e-5,
                "law: {case}: expected at most {springs}, got {deepest}, tolerance 2e-5"
            );
        }
    }
}

/// Law: the same of a body that falls, with steps in which it falls farther than that.
#[test]
fn a_body_let_go_above_a_floor_is_stopped_there_at_low_rates() {
    let _turn = shared_turn();
    for rate_hz in [60.0, 120.0, 240.0] {
        for gap in [2.2e-4, 5e-4, 1e-3] {
            let settings = EngineSettings { rate_hz, ..Default::default() };
            let pairs = uniform(0.5, 0.0);
            let mut world =
                BulletBackend::new(&settings, -Vector::z() * GRAVITY, &pairs).expect("a world");
            world.add(&slab(Motion::Static)).expect("added");
            let at = Vector::new(0.0, 0.0, 0.005 + gap);
            let block = world.add(&free_box(Vector::repeat(0.01), at)).expect("added");
            let mut deepest = 0.0_f64;
            for _ in 0..12 {
                world.step().expect("a step");
                let height = world.read_body(block).expect("there").pose.translation.z;
                deepest = deepest.max(0.005 - height);
            }
            near(&format!("overlap in m from {gap} m at {rate_hz} Hz"), deepest, 0.0, 1e-5);
        }
    }
}

#[test]
fn only_pressed_bodies_have_a_force_and_only_native_contacts_press() {
    let _turn = shared_turn();
    let mut world = world(8, 0.5, 0.0);
    let floor = world.add(&slab(Motion::Static)).expect("added");
    assert!(matches!(world.press(floor, 1.0), Err(WorldError::NotPressed(_))), "law: a floor");
    let mut crooked = lid(0.1, -Vector::z(), 0.0);
    crooked.motion = Motion::Pressed { mass: MASS, direction: Vector::new(0.0, 0.0, 2.0) };
    let refused = world.add(&crooked).expect_err("no unit vector").to_string();
    assert!(refused.contains("unit vector"), "law: the reason is reported, got {refused}");
    let pairs = uniform(0.5, 0.0);
    let stock = EngineSettings { contact_solver: ContactSolver::Stock, ..Default::default() };
    let mut stock = BulletBackend::new(&stock, Vector::zeros(), &pairs).expect("a world");
    let refused = stock.add(&lid(0.1, -Vector::z(), 0.0)).expect_err("stock cannot").to_string();
    assert!(refused.contains("native contacts"), "law: who can is named, got {refused}");
}
