//! Bodies that turn about one axis by a moment, against laws of mechanics, with contacts eight at
//! once and one by one.

use super::press_tests::{AT_ONCE, load, steps, world};
use super::tests::{free_box, precision, shared_turn, slab};
use super::*;
use crate::geometry::{MassProperties, Point, testing::near};

/// Side of the block in m.
const SIDE: f64 = 0.02;

/// Moment of inertia about the axis in kg m².
const INERTIA: f64 = 4e-4;

/// A bar of 200 mm along x whose left end lies on an axis along y, `height` above the floor.
fn bar(height: f64, speed: f64) -> Body {
    let size = Vector::new(0.2, 0.02, 0.01);
    let mut body = free_box(size, Vector::new(0.1, 0.0, height));
    let about = Vector::new(0.0, 0.3, height);
    body.motion = Motion::Turned { inertia: INERTIA, axis: Vector::y(), about };
    body.state.angular_velocity = Vector::y() * speed;
    body
}

#[test]
fn a_moment_turns_about_the_axis_alone() {
    let _turn = shared_turn();
    for at_once in AT_ONCE {
        let mut world = world(at_once, 0.5, 0.0);
        let bar = world.add(&bar(1.0, 0.4)).expect("added");
        world.press(bar, 2e-3).expect("turned");
        steps(&mut world, 0.25);
        let now = world.read_body(bar).expect("there");
        let speed = 0.4 + 2e-3 / INERTIA * 0.25;
        let spin = now.angular_velocity;
        near("no weight, α = M/I", spin.y, speed, precision(1e-12, 1e-5) * speed);
        near("about no other axis", spin.x.hypot(spin.z), 0.0, precision(1e-15, 1e-6));
        // Half a sub-step's worth more, as of every fall; right-handed about y takes x down.
        let angle = 0.4 * 0.25 + 0.5 * 5.0 * 0.0625;
        let at = now.pose.translation.vector - Vector::new(0.0, 0.0, 1.0);
        near("½ α t² + ω t", (-at.z).atan2(at.x), angle, 1.5e-3);
        near("its distance from the axis", at.norm(), 0.1, precision(1e-9, 1e-6));
        let along = now.pose * Vector::x() * 0.1;
        near("turned as it went", (along - at).norm(), 0.0, precision(1e-9, 1e-6));
        let velocity = now.linear_velocity - spin.cross(&at);
        near("v = ω × r", velocity.norm(), 0.0, precision(1e-12, 1e-5));
    }
}

/// Law: at rest the moments about the axis of all forces on a lever cancel, and what it presses
/// passes the force on.
#[test]
fn a_lever_presses_a_block_by_moment_over_arm() {
    let _turn = shared_turn();
    let moment = 0.12;
    for at_once in AT_ONCE {
        let mut world = world(at_once, 0.5, 0.0);
        world.add(&slab(Motion::Static)).expect("added");
        let at = Vector::new(0.06, 0.002, SIDE / 2.0);
        let block = free_box(Vector::repeat(SIDE), at);
        let mass = 2673.9 * MassProperties::of(&block.shape).volume;
        let block = world.add(&block).expect("added");
        let height = SIDE + 0.005;
        let lever = world.add(&bar(height, 0.0)).expect("added");
        world.press(lever, moment).expect("turned");
        steps(&mut world, 0.5);
        let axis = Vector::new(0.0, 0.0, height);
        let (force, about) = load(&world, lever, axis);
        near("the block resists the moment", -about.y, moment, 1e-3 * moment);
        // Its upper side is from 50 to 70 mm off the axis.
        let force = force.z;
        assert!((moment / 0.07..moment / 0.05).contains(&force), "law: M/r, got {force} N");
        let (floor, _) = load(&world, BodyId(0), axis);
        near("the floor bears it and the block", -floor.z, force + mass * 9.81, 2e-3 * force);
        let (block, lever) = (world.read_body(block), world.read_body(lever));
        let (block, lever) = (block.expect("there"), lever.expect("there"));
        near("at rest", lever.angular_velocity.norm(), 0.0, 1e-5);
        near("the block as well", block.linear_velocity.norm(), 0.0, 1e-5);
        let end = lever.pose * Point::new(-0.1, 0.0, 0.0) - Point::from(axis);
        near("its end stays on the axis", end.norm(), 0.0, precision(1e-7, 1e-6));
    }
}

/// Law: a lever that turns into a block at rest gives it angular momentum about its axis, and
/// keeps of the relative speed the restitution.
#[test]
fn a_lever_that_hits_a_block_keeps_the_angular_momentum() {
    let _turn = shared_turn();
    for (at_once, restitution) in [(8, 0.0), (1, 0.0), (8, 0.5), (1, 0.5)] {
        let mut world = world(at_once, 0.0, restitution);
        // It flies: nothing holds it, and gravity takes both, the lever not at all.
        let at = Vector::new(0.15, 0.0, 1.0 - SIDE / 2.0 - 0.005 - 1e-4);
        let block = free_box(Vector::repeat(SIDE), at);
        let mass = 2673.9 * MassProperties::of(&block.shape).volume;
        let block = world.add(&block).expect("added");
        let lever = world.add(&bar(1.0, 2.0)).expect("added");
        let time = 5.0 * world.time_step();
        steps(&mut world, time);
        let lever = world.read_body(lever).expect("there").angular_velocity.y;
        let now = world.read_body(block).expect("there");
        let arm = now.pose.translation.vector - Vector::new(0.0, 0.0, 1.0);
        let own = mass * SIDE * SIDE / 6.0 * now.angular_velocity.y;
        let fallen = mass * 9.81 * time * 0.15;
        let momentum = INERTIA * lever + mass * arm.cross(&now.linear_velocity).y + own - fallen;
        near("angular momentum about the axis", momentum, INERTIA * 2.0, 2e-3 * INERTIA * 2.0);
        assert!(lever < 1.9, "law: they met, the lever has {lever} rad/s");
    }
}

#[test]
fn what_is_no_axis_is_refused() {
    let _turn = shared_turn();
    let mut world = world(8, 0.5, 0.0);
    let mut crooked = bar(1.0, 0.0);
    let about = Vector::zeros();
    crooked.motion = Motion::Turned { inertia: INERTIA, axis: Vector::new(0.0, 2.0, 0.0), about };
    let refused = world.add(&crooked).expect_err("no unit vector").to_string();
    assert!(refused.contains("axis"), "law: the reason is reported, got {refused}");
    crooked.motion = Motion::Turned { inertia: 0.0, axis: Vector::y(), about };
    let refused = world.add(&crooked).expect_err("no inertia").to_string();
    assert!(refused.contains("moment of inertia"), "law: the reason is reported, got {refused}");
}
