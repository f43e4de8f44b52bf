//! Rigid bodies of several parts against laws of mechanics, with contacts eight at once and one by
//! one.

use super::press_tests::{AT_ONCE, load, steps, world};
use super::tests::{contacts, free_box, precision, shared_turn, slab};
use super::*;
use crate::geometry::{Point, testing::near};

/// Side of a leg in m.
const SIDE: f64 = 0.02;

/// Mass in kg, and moments of inertia in kg m² about the axes of the body.
const MASS: f64 = 0.4;
const INERTIA: Vector = Vector::new(2e-4, 9e-4, 1e-3);

/// A part of a body whose frame is at a height: a block of a size with its middle at a place in
/// that frame.
fn part(size: Vector, place: Vector, height: f64, motion: Motion) -> Body {
    let block = ConvexPolyhedron::cuboid(size).expect("a block");
    let shape = Arc::new(block.transformed(&Pose::translation(place.x, place.y, place.z)));
    let state = BodyState::at_rest(Pose::translation(0.0, 0.0, height));
    Body { shape, motion, ..free_box(size, Vector::zeros()) }.at(state)
}

impl Body {
    fn at(self, state: BodyState) -> Self {
        Self { state, ..self }
    }
}

/// Two legs at x = −50 and 100 mm in the frame of the centre of mass.
fn legs(world: &mut BulletBackend, height: f64) -> [BodyId; 2] {
    let motion = Motion::Free { mass: MASS, inertia: INERTIA };
    let legs = [-0.05, 0.1].map(|x| {
        let leg = part(Vector::repeat(SIDE), Vector::new(x, 0.0, 0.0), height, motion);
        world.add(&leg).expect("added")
    });
    world.join(legs[1], legs[0]).expect("one body");
    legs
}

/// Law: two legs carry the weight by the lever rule, and the body rests.
#[test]
fn a_body_of_two_legs_stands_by_the_lever_rule() {
    let _turn = shared_turn();
    for at_once in AT_ONCE {
        let mut world = world(at_once, 0.5, 0.0);
        world.add(&slab(Motion::Static)).expect("added");
        let legs = legs(&mut world, SIDE / 2.0);
        steps(&mut world, 0.5);
        let weight = MASS * 9.81;
        for (leg, share) in legs.into_iter().zip([2.0 / 3.0, 1.0 / 3.0]) {
            let force = load(&world, leg, Vector::zeros()).0.z;
            // Springs below feet that are not points take 0.4 % of the moment.
            near("weight by the arms", force, weight * share, 6e-3 * weight);
        }
        let [a, b] = legs.map(|leg| world.read_body(leg).expect("there"));
        assert_eq!(a, b, "law: they are one body");
        near("at rest", a.linear_velocity.norm() + a.angular_velocity.norm(), 0.0, 1e-5);
        // Each leg sinks by its share of the weight on its four springs.
        let spring = crate::scenario::NativeSettings::default().contact_stiffness_n_per_m;
        let sunk = weight / (4.0 * spring) * (4.0 / 9.0 + 1.0 / 9.0);
        let moved = a.pose.translation.vector - Vector::z() * (SIDE / 2.0 - sunk);
        near("where it was put, on its springs", moved.norm(), 0.0, 3e-6);
    }
}

/// Law: in the air it moves as a body of one part with its mass and inertia does, bit by bit.
#[test]
fn parts_change_nothing_of_a_free_flight() {
    let _turn = shared_turn();
    let mut state = BodyState::at_rest(Pose::translation(0.0, 0.0, 2.0));
    state.linear_velocity = Vector::new(0.3, -0.2, 1.0);
    state.angular_velocity = Vector::new(3.0, 5.0, -4.0);
    let motion = Motion::Free { mass: MASS, inertia: INERTIA };
    let fly = |parts: usize| {
        let mut world = world(8, 0.5, 0.0);
        let ids: Vec<BodyId> = (0..parts)
            .map(|k| {
                // They overlap: parts do not meet each other.
                let place = Vector::new(0.01 * k as f64, 0.0, 0.0);
                let one = part(Vector::repeat(SIDE), place, 0.0, motion).at(state);
                let id = world.add(&one).expect("added");
                if k > 0 {
                    world.join(id, BodyId(0)).expect("one body");
                }
                id
            })
            .collect();
        steps(&mut world, 0.2);
        let contacts = contacts(&world);
        assert!(contacts.is_empty(), "law: parts do not meet, {contacts:?}");
        ids.iter().map(|id| world.read_body(*id).expect("there")).collect::<Vec<_>>()
    };
    let alone = fly(1)[0];
    assert_ne!(alone, state, "it flies");
    assert_eq!(fly(3), vec![alone; 3], "law: as one of one part");
}

/// Law: an impulse on one part changes velocity and spin by the mass and inertia of all: what a
/// block at rest gets is what the body loses, in momentum and about its centre.
#[test]
fn an_impact_on_one_part_keeps_momentum_and_angular_momentum() {
    let _turn = shared_turn();
    for at_once in AT_ONCE {
        let mut world = world(at_once, 0.0, 0.0);
        let legs = legs(&mut world, 2.0);
        // Under the far leg, thrown upwards.
        let size = Vector::repeat(SIDE);
        let mut block = free_box(size, Vector::new(0.1, 0.0, 2.0 - 1.05 * SIDE));
        block.state.linear_velocity = Vector::z() * 0.8;
        let mass = 2673.9 * SIDE.powi(3);
        let block = world.add(&block).expect("added");
        let time = 4.0 * world.time_step();
        steps(&mut world, time);
        let whole = world.read_body(legs[0]).expect("there");
        let other = world.read_body(block).expect("there");
        let fallen = 9.81 * time;
        let momentum =
            MASS * (whole.linear_velocity.z + fallen) + mass * (other.linear_velocity.z + fallen);
        near("momentum", momentum, mass * 0.8, 2e-3 * mass * 0.8);
        // r × p about y of what goes up at x is −x p.
        let moment = |m: f64, x: f64, v: f64| -x * m * (v + fallen);
        let about = INERTIA.y * whole.angular_velocity.y
            + moment(mass, other.pose.translation.x, other.linear_velocity.z)
            + mass * SIDE * SIDE / 6.0 * other.angular_velocity.y
            + moment(MASS, whole.pose.translation.x, whole.linear_velocity.z);
        near("angular momentum", about, -0.1 * mass * 0.8, 1e-2 * 0.1 * mass * 0.8);
        assert!(whole.angular_velocity.y < -0.1, "law: they met, {:?}", whole.angular_velocity);
    }
}

/// Law: two arms turned by one moment press two blocks, and the moments of both add up to it.
#[test]
fn a_moment_on_a_body_of_two_arms_is_borne_by_both() {
    let _turn = shared_turn();
    let moment = 0.12;
    for at_once in AT_ONCE {
        let mut world = world(at_once, 0.5, 0.0);
        world.add(&slab(Motion::Static)).expect("added");
        let height = 2.0 * SIDE + 0.005;
        // Turned about y, right-handed: one arm goes down at x > 0, the other up at x < 0.
        let size = Vector::new(0.08, 0.02, 0.01);
        let turned =
            Motion::Turned { inertia: 4e-4, axis: Vector::y(), about: Vector::z() * height };
        let right = part(size, Vector::new(0.06, 0.0, 0.0), height, turned);
        let right = world.add(&right).expect("added");
        // Lower, so that its upper side meets what is fixed as high as the block is on the right.
        let left = part(size, Vector::new(-0.06, 0.0, 0.0), height, Motion::Kinematic);
        let left = world.add(&left).expect("added");
        world.join(left, right).expect("one body");
        let free = |x: f64, z: f64| {
            let mut block = free_box(Vector::repeat(SIDE), Vector::new(x, 0.001, z));
            block.state.pose.translation.z = z;
            block
        };
        // A pillar of two blocks on the floor, and one that hangs under nothing: the left arm lifts.
        let low = world.add(&free(0.08, SIDE / 2.0)).expect("added");
        world.add(&free(0.08, 1.5 * SIDE)).expect("added");
        let heavy = world.add(&free(-0.08, height + 0.005 + SIDE / 2.0)).expect("added");
        world.press(right, moment).expect("turned");
        steps(&mut world, 0.6);
        let axis = Vector::z() * height;
        let on_right = load(&world, right, axis).1.y;
        let (lifted, on_left) = load(&world, left, axis);
        let on_left = on_left.y;
        let weight = 2673.9 * SIDE.powi(3) * 9.81;
        near("the block on the left weighs on it", -lifted.z, weight, 5e-3 * weight);
        near("both resist the moment", -(on_right + on_left), moment, 2e-3 * moment);
        assert!(on_right < 0.0, "law: the pillar resists it, {on_right}");
        let states = [right, left, low, heavy].map(|id| world.read_body(id).expect("there"));
        assert_eq!(states[0], states[1], "law: they are one body");
        for state in states {
            near("at rest", state.linear_velocity.norm(), 0.0, 2e-5);
        }
        let end = states[1].pose * Point::origin() - Point::from(axis);
        near("its origin stays on the axis", end.norm(), 0.0, precision(1e-7, 1e-6));
    }
}

/// Law: a force on a body of two feet is passed on by both.
#[test]
fn a_pressed_body_of_two_parts_presses_with_both() {
    let _turn = shared_turn();
    for at_once in AT_ONCE {
        let mut world = world(at_once, 0.5, 0.0);
        world.add(&slab(Motion::Static)).expect("added");
        for x in [-0.05, 0.05] {
            let at = Vector::new(x, 0.0, SIDE / 2.0);
            world.add(&free_box(Vector::repeat(SIDE), at)).expect("added");
        }
        let pressed = Motion::Pressed { mass: MASS, direction: -Vector::z() };
        let foot = |x: f64, motion| {
            part(Vector::repeat(SIDE), Vector::new(x, 0.0, 0.0), 1.5 * SIDE, motion)
        };
        let one = world.add(&foot(-0.05, pressed)).expect("added");
        let two = world.add(&foot(0.05, Motion::Kinematic)).expect("added");
        world.join(two, one).expect("one body");
        world.press(one, 6.0).expect("pressed");
        steps(&mut world, 0.5);
        let forces = [one, two].map(|foot| load(&world, foot, Vector::zeros()).0.z);
        for force in forces {
            near("half of the force", force, 3.0, 6e-2);
        }
        let sum = forces[0] + forces[1];
        near("all of the force", sum, 6.0, 6e-3);
    }
}

/// Law: parts of a kinematic body are where it is at the end of each step.
#[test]
fn parts_of_a_kinematic_body_go_with_it() {
    let _turn = shared_turn();
    let mut world = world(8, 0.5, 0.0);
    let [whole, other] = [0.0, 0.1].map(|x| {
        let one = part(Vector::repeat(SIDE), Vector::x() * x, 1.0, Motion::Kinematic);
        world.add(&one).expect("added")
    });
    world.join(other, whole).expect("one body");
    for step in 1..=3 {
        let end = Pose::translation(0.0, 0.0, 1.0 + 1e-3 * f64::from(step));
        world.drive(whole, &end).expect("driven");
        world.step().expect("a step");
        let [a, b] = [whole, other].map(|id| world.read_body(id).expect("there"));
        assert_eq!(a, b, "law: they are one body, step {step}");
    }
}

/// Law: a kinematic body that begins to move pushes what lies before any of its parts at once, from
/// farther than contacts are looked for between bodies at rest.
#[test]
fn parts_of_a_kinematic_body_push_in_its_first_step() {
    let _turn = shared_turn();
    for at_once in AT_ONCE {
        let mut world = world(at_once, 0.5, 0.0);
        let [whole, other] = [0.0, 0.1].map(|x| {
            let one = part(Vector::repeat(SIDE), Vector::x() * x, 1.0, Motion::Kinematic);
            world.add(&one).expect("added")
        });
        world.join(other, whole).expect("one body");
        let blocks = [0.0, 0.1].map(|x| {
            let at = Vector::new(x, 0.0, 1.0 + SIDE + 1e-3);
            world.add(&free_box(Vector::repeat(SIDE), at)).expect("added")
        });
        world.drive(whole, &Pose::translation(0.0, 0.0, 1.0 + 2e-3)).expect("driven");
        world.step().expect("a step");
        let speed = 2e-3 / world.time_step();
        for block in blocks {
            let up = world.read_body(block).expect("there").linear_velocity.z;
            near("as fast as what pushes it", up, speed, 2e-2 * speed);
        }
    }
}

/// Law: what a pressed body runs into with one of its parts, it meets in the first step of a world,
/// too, from farther than contacts are looked for between bodies at rest.
#[test]
fn parts_of_a_pressed_body_meet_in_the_first_step_of_a_world() {
    let _turn = shared_turn();
    for at_once in AT_ONCE {
        let mut world = world(at_once, 0.5, 0.0);
        let speed = 2e-3 / world.time_step();
        let [whole, other] = [0.0, 0.1].map(|x| {
            let motion = if x > 0.0 {
                Motion::Kinematic
            } else {
                Motion::Pressed { mass: 1e3, direction: Vector::z() }
            };
            let mut one = part(Vector::repeat(SIDE), Vector::x() * x, 1.0, motion);
            one.state.linear_velocity = Vector::z() * if x > 0.0 { 0.0 } else { speed };
            world.add(&one).expect("added")
        });
        world.join(other, whole).expect("one body");
        let at = Vector::new(0.1, 0.0, 1.0 + SIDE + 1e-3);
        let block = world.add(&free_box(Vector::repeat(SIDE), at)).expect("added");
        world.step().expect("a step");
        let up = world.read_body(block).expect("there").linear_velocity.z;
        near("as fast as what pushes it", up, speed, 2e-2 * speed);
    }
}

#[test]
fn what_cannot_be_one_body_is_refused() {
    let _turn = shared_turn();
    let mut world = world(8, 0.5, 0.0);
    let motion = Motion::Free { mass: MASS, inertia: INERTIA };
    let size = Vector::repeat(SIDE);
    let mut add = |height: f64, motion| {
        world.add(&part(size, Vector::zeros(), height, motion)).expect("added")
    };
    let (a, b, above) = (add(1.0, motion), add(1.0, motion), add(1.1, motion));
    let fixed = add(1.0, Motion::Static);
    let refused = |got: Result<(), WorldError>| matches!(got, Err(WorldError::BadBody(_)));
    assert!(refused(world.join(above, a)), "law: one pose");
    assert!(refused(world.join(fixed, a)), "law: one motion");
    assert!(refused(world.join(a, a)), "law: another body");
    world.join(b, a).expect("one body");
    let c = world.add(&part(size, Vector::zeros(), 1.0, motion)).expect("added");
    assert!(refused(world.join(c, b)), "law: a part has no parts");
    assert!(matches!(world.join(c, BodyId(99)), Err(WorldError::NoSuchBody(_))));
    assert!(refused(world.join(a, c)), "law: what has parts is none");
    let removed = world.remove(a);
    assert!(
        matches!(&removed, Err(WorldError::BadBody(why)) if why.contains("leave first")),
        "law: parts leave first, got {removed:?}"
    );
    for id in [b, a] {
        world.remove(id).expect("removed");
    }
    world.step().expect("law: the others go on");
}
