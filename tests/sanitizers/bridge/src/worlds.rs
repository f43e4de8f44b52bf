//! Worlds of boxes that fall on a shaken table or are pressed, and pairs of boxes by themselves.

use std::thread;

use crate::{
    BodyDefinition, BodyKind, BodyPose, BulletWorld, CrowdProbeBody, InertiaRule, PairValue,
    PressDefinition, ShapeDefinition, Tolerances, WorldDefinition, crowd_speeds, new_hull_probe,
    new_world,
};

/// Whether the contacts are Pluvia's own, threads, portable instructions,
/// contacts at once.
pub type Kind = (bool, i32, bool, u32);

/// Every contact solver, kernel and number of threads that takes a way of its own.
pub const KINDS: [Kind; 5] = [
    (true, 1, false, 8),
    (true, 2, false, 8),
    (true, 3, true, 8),
    (true, 2, false, 1),
    (false, 1, false, 8),
];

/// No rotation.
pub const STILL: [f64; 4] = [0.0, 0.0, 0.0, 1.0];

/// A pose without rotation.
pub fn at(position: [f64; 3]) -> BodyPose {
    BodyPose { position, rotation: STILL }
}

/// Lengths as the program has them for grains of 8 mm and more.
pub fn tolerances() -> Tolerances {
    Tolerances {
        contact_margin: 0.2e-3,
        closed_gap: 0.01e-3,
        unsolved_gap: 0.02e-3,
        hysteresis: 0.02e-3,
        hold: 0.02e-3,
        face_preference: 0.005e-3,
        match_distance: 1e-3,
        box_slack: 1e-3,
    }
}

/// Settings as the program has them.
pub fn definition((own_collision, threads, portable, contacts_at_once): Kind) -> WorldDefinition {
    WorldDefinition {
        length_scale: 100.0,
        time_step: 1.0 / 480.0,
        gravity: [0.0, 0.0, -9.81],
        iterations: 60,
        solver_mode: 4, // warm starting
        contact_threshold: 1e-3,
        broadphase_margin: 0.5e-3,
        tolerances: tolerances(),
        erp: 0.2,
        warm_start: 0.85,
        split_impulse: true,
        restitution_velocity_threshold: 0.05,
        linear_damping: 0.0,
        angular_damping: 0.0,
        gyroscopic: true,
        collision_margin: 0.0,
        inertia: InertiaRule::Exact,
        least_mass: 0.0,
        relative_contact_threshold: 0.0,
        sleeping: false,
        sleeping_speed: 0.0,
        sleeping_spin: 0.0,
        materials: 3,
        own_collision,
        contact_stiffness: 1e4,
        contact_damping_ratio: 1.0,
        max_depenetration_velocity: 0.3,
        substeps: 4,
        native_iterations: 5,
        solver_tolerance: 0.002,
        threads,
        portable,
        contacts_at_once,
    }
}

/// The same for every pair of three materials.
pub fn pairs() -> Vec<PairValue> {
    (0..9).map(|_| PairValue { friction: 0.6, restitution: 0.3 }).collect()
}

/// A box about the origin.
pub fn cuboid(sides: [f64; 3]) -> ShapeDefinition {
    let corner = |i: usize, k: usize| sides[k] / if i >> k & 1 == 1 { 2.0 } else { -2.0 };
    ShapeDefinition {
        radius: 0.0,
        coordinates: (0..24).map(|n| corner(n / 3, n % 3)).collect(),
        face_starts: vec![0, 4, 8, 12, 16, 20, 24],
        face_vertices: vec![0, 4, 6, 2, 1, 3, 7, 5, 0, 1, 5, 4, 2, 6, 7, 3, 0, 2, 3, 1, 4, 5, 7, 6],
    }
}

/// A body of the second material that turns.
pub fn body(
    shape: u32,
    kind: BodyKind,
    position: [f64; 3],
    mass: f64,
    rotation: [f64; 4],
) -> BodyDefinition {
    BodyDefinition {
        shape,
        kind,
        material: 1,
        mass,
        inertia: [mass * 1.7e-5; 3],
        position,
        rotation,
        linear_velocity: [0.0; 3],
        angular_velocity: [1.0, 2.0, 0.5],
    }
}

type World = cxx::UniquePtr<BulletWorld>;

fn add(world: &mut World, shape: &ShapeDefinition) -> u32 {
    world.pin_mut().add_shape(shape).expect("a shape")
}

fn with_table(kind: Kind) -> (World, u32, u32) {
    let mut world = new_world(&definition(kind), &pairs()).expect("a world");
    let slab = add(&mut world, &cuboid([0.4, 0.4, 0.02]));
    let table = table(&mut world, slab, BodyKind::Kinematic);
    (world, slab, table)
}

fn table(world: &mut World, slab: u32, kind: BodyKind) -> u32 {
    world.pin_mut().add_body(&body(slab, kind, [0.0, 0.0, -0.01], 0.0, STILL)).expect("a table")
}

fn grain(world: &mut World, number: u32, position: [f64; 3], rotation: [f64; 4]) -> u32 {
    let side = 0.008 + 0.0005 * f64::from(number % 7);
    // Spheres, rounded boxes and boxes by turns.
    let sides = [side, side * 0.8, side * 1.1];
    let shape = match number % 3 {
        2 => ShapeDefinition {
            radius: side / 2.0,
            coordinates: vec![],
            face_starts: vec![],
            face_vertices: vec![],
        },
        1 => ShapeDefinition { radius: side / 8.0, ..cuboid(sides.map(|s| s - side / 4.0)) },
        _ => cuboid(sides),
    };
    let shape = add(world, &shape);
    let mass = 2673.9 * 0.88 * side.powi(3);
    world
        .pin_mut()
        .add_body(&body(shape, BodyKind::Free, position, mass, rotation))
        .expect("a grain")
}

/// Whether one thread does a step of a world of several: worlds go from one to several and back.
fn alone(step: u32) -> bool {
    step.is_multiple_of(3)
}

/// A heap that falls on a table and is shaken; on the way everything is read, a
/// grain taken out, the table taken out and put back, the contacts remembered
/// and told to another world, which goes on. How many steps that were.
pub fn one(kind: Kind, grains: u32, steps: u32) -> u32 {
    let (mut world, slab, mut floor) = with_table(kind);
    let ids: Vec<u32> = (0..grains)
        .map(|i| {
            let (x, y, z) = (f64::from(i % 5), f64::from(i / 5 % 5), f64::from(i / 25));
            let turn = 0.3 * f64::from(i);
            let rotation = [turn.sin() * 0.6, turn.sin() * 0.8, 0.0, turn.cos()];
            let at = [0.013 * (x - 2.0), 0.013 * (y - 2.0), 0.01 + 0.014 * z];
            grain(&mut world, i, at, rotation)
        })
        .collect();
    let (mut bodies, mut contacts, mut remembered) = (vec![], vec![], vec![]);
    let (mut counts, mut corners, mut roundings) = (vec![], vec![], vec![]);
    let mut touched = 0;
    for step in 0..steps {
        let time = f64::from(step) / 480.0;
        if step < steps * 3 / 4 {
            let x = 0.01 * (18.8 * time).sin();
            world.pin_mut().drive_body(floor, &at([x, 0.0, -0.01])).expect("driven");
        }
        world.pin_mut().step(alone(step)).expect("a step");
        world.read_contacts(&mut contacts);
        touched += contacts.len();
        if step % 16 == 0 {
            world.read_bodies(&mut bodies);
            world.remember_contacts(&mut remembered);
            world.read_corners(&mut counts, &mut corners, &mut roundings);
            assert!(world.phases().collision >= 0.0 && !world.effective().is_empty());
            assert!(world.pair_value(floor, ids[0]).is_ok());
        }
        if step == steps / 2 {
            world.pin_mut().remove_body(ids[3]).expect("removed");
            assert!(world.pin_mut().remove_body(ids[3]).is_err(), "law: it is gone");
        }
        if step == steps * 3 / 4 {
            world.pin_mut().remove_body(floor).expect("removed");
            floor = table(&mut world, slab, BodyKind::Static);
        }
    }
    assert!(steps < 50 || touched > 0, "the check has contacts");
    world.read_bodies(&mut bodies);
    world.remember_contacts(&mut remembered);
    let (mut second, _, table) = with_table(kind);
    for (number, id) in (0..).zip(&ids) {
        let read = &bodies[*id as usize];
        if read.present {
            grain(&mut second, number, read.position, read.rotation);
        }
    }
    // Some of them of bodies that this world has not.
    second.pin_mut().recall_contacts(&remembered).expect("told");
    let found = second.pin_mut().find_contacts().is_ok();
    assert_eq!(found, kind.0, "law: native contacts alone are found without a step");
    let ends = [0.0, 1e-4, 3e-4].map(|x| at([x, 0.0, -0.01]));
    second.pin_mut().recall_drive(table, &ends).expect("told");
    assert!(second.pin_mut().recall_drive(table, &ends[..2]).is_err(), "law: three or none");
    assert!(second.pin_mut().recall_drive(table + 1, &ends).is_err(), "law: driven ones alone");
    let mut drives = vec![];
    for step in 0..5 {
        second.pin_mut().step(alone(step)).expect("a step");
        second.read_drives(&mut drives);
        assert_eq!(drives.len(), usize::from(kind.0), "the table");
    }
    steps + 5
}

/// Thousands of boxes that fall together on a table that is driven up, so fast
/// that they stand off by the speed against those around, and one of them
/// is taken out; how many steps.
pub fn crowd(kind: Kind, steps: u32) -> u32 {
    let (mut world, _, floor) = with_table(kind);
    let shape = add(&mut world, &cuboid([0.009, 0.01, 0.011]));
    let mut ids = Vec::new();
    for i in 0..4200_u32 {
        let (x, y, z) = (f64::from(i % 20), f64::from(i / 20 % 21), f64::from(i / 420));
        let at = [0.013 * (x - 10.0), 0.013 * (y - 10.0), 0.012 + 0.014 * z];
        let mut body = body(shape, BodyKind::Free, at, 2e-3, STILL);
        body.linear_velocity = [0.1 * x.sin(), 0.1 * y.cos(), -3.0];
        ids.push(world.pin_mut().add_body(&body).expect("a box"));
    }
    let mut contacts = vec![];
    for step in 0..steps {
        let up = 1e-3 * f64::from(step);
        world.pin_mut().drive_body(floor, &at([0.0, 0.0, up - 0.01])).expect("driven");
        world.pin_mut().step(alone(step)).expect("a step");
        if step == steps / 2 {
            world.pin_mut().remove_body(ids[7]).expect("removed");
        }
    }
    world.read_contacts(&mut contacts);
    assert!(contacts.len() > 1000, "the check has contacts");
    steps
}

/// A lid of two parts that is pressed along a direction, or turned about an axis, above grains on a
/// table, with its sub-steps recorded; how many steps.
pub fn pressed(kind: Kind, turns: bool, steps: u32) -> u32 {
    let (mut world, ..) = with_table(kind);
    world.pin_mut().record_substeps();
    for i in 0..9 {
        let at = [0.013 * (f64::from(i % 3) - 1.0), 0.013 * (f64::from(i / 3) - 1.0), 0.006];
        grain(&mut world, i, at, STILL);
    }
    let [whole, part] = [[0.06, 0.03, 0.01], [0.03, 0.06, 0.01]].map(|sides| {
        let shape = add(&mut world, &cuboid(sides));
        let mut lid = body(shape, BodyKind::Kinematic, [0.0, 0.0, 0.02], 0.0, STILL);
        lid.angular_velocity = [0.0; 3];
        world.pin_mut().add_body(&lid).expect("a lid")
    });
    let definition = PressDefinition {
        turns,
        direction: if turns { [0.0, 1.0, 0.0] } else { [0.0, 0.0, -1.0] },
        about: [0.0, 0.0, 0.02],
        mass: if turns { 1e-4 } else { 0.1 },
        speed: 0.0,
    };
    world.pin_mut().press_body(whole, &definition).expect("pressed");
    world.pin_mut().set_force(whole, if turns { 1e-3 } else { 1.0 }).expect("a force");
    world.pin_mut().join_body(part, whole).expect("one body");
    let (mut bodies, mut contacts) = (vec![], vec![]);
    for step in 0..steps {
        world.pin_mut().step(alone(step)).expect("a step");
        world.read_substep(&mut bodies, &mut contacts);
        assert!(world.solver_residual() >= 0.0, "law: native worlds have a residual");
    }
    assert!(!bodies.is_empty() && !contacts.is_empty(), "the check has contacts");
    let [one, other] = [whole, part].map(|id| world.read_one_body(id).expect("a body"));
    assert_eq!(one.position, other.position, "law: parts move as one");
    steps
}

/// The speeds of crowds of every size, with walls and with what is no number; how
/// many.
pub fn speeds() -> usize {
    let mut found = 0;
    for i in 0..400_u32 {
        let bodies: Vec<_> = (0..i % 50)
            .map(|n| {
                let t = f64::from(i) + 0.37 * f64::from(n);
                let spread = 10.0_f64.powi((i % 9).cast_signed() - 4);
                CrowdProbeBody {
                    centre: [t.sin(), t.cos(), (1.7 * t).sin()].map(|x| spread * x),
                    velocity: [3.0 * t.cos(), -t.sin(), -3.0],
                    radius: if n % 7 == 3 { 5.0 } else { 0.006 },
                    turning: if i % 23 == 5 { f64::NAN } else { 0.1 },
                    free: n % 7 != 5,
                }
            })
            .collect();
        found += crowd_speeds(&bodies, &[0.1, 0.0, 0.0], 1.0 / 480.0, 0.5e-3).len();
    }
    found
}

/// Every kind of world; how many steps.
pub fn all() -> u32 {
    KINDS.iter().map(|&kind| one(kind, 90, 160)).sum::<u32>()
        + crowd((true, 1, false, 8), 12)
        + crowd((true, 2, true, 8), 12)
        + pressed((true, 2, false, 8), false, 60)
        + pressed((true, 1, false, 1), true, 60)
}

/// Two worlds in two threads, by each contact solver, then some with three
/// workers; how many steps.
pub fn in_threads() -> u32 {
    let mut steps = 0;
    for kind in [(true, 1, false, 8), (true, 2, false, 8), (false, 1, false, 8)] {
        let two = [0, 1].map(|_| thread::spawn(move || one(kind, 60, 80)));
        steps += two.map(|one| one.join().expect("no panic")).iter().sum::<u32>();
    }
    let three = (true, 3, false, 8);
    steps + one(three, 60, 80) + crowd(three, 8) + pressed(three, false, 40)
}

/// Pairs of boxes in two thousand poses, at two length scales, with the fastest
/// and the portable code; how many contact points.
pub fn probes() -> usize {
    let mut points = 0;
    for (portable, scale) in [(false, 1.0), (false, 100.0), (true, 1.0), (true, 100.0)] {
        let (a, b) = (cuboid([0.02, 0.03, 0.01]), cuboid([0.01, 0.012, 0.02]));
        let mut pair = new_hull_probe(scale, &tolerances(), portable, &a, &b).expect("a pair");
        let origin = at([0.0; 3]);
        for i in 0..2000_u32 {
            let t = 0.37 * f64::from(i);
            let turn = [t.sin() * 0.6, t.cos() * (t * 1.3).sin(), 0.3, t.cos()];
            let length = turn.iter().map(|x| x * x).sum::<f64>().sqrt();
            let place = BodyPose {
                position: [
                    0.012 * (t * 0.7).sin(),
                    0.016 * (t * 0.9).cos(),
                    0.012 * (t * 1.1).sin(),
                ],
                rotation: turn.map(|x| x / length),
            };
            let found = pair.pin_mut().step(&origin, &place);
            for point in 0..found.len() {
                pair.pin_mut().set_impulse(point, 0.1, &[0.01, 0.0, 0.0]).expect("set");
            }
            assert!(pair.pin_mut().set_impulse(found.len(), 0.1, &[0.0; 3]).is_err());
            pair.pin_mut().widest_gap(&origin, &place, i % 2 == 0);
            if i % 50 == 0 {
                pair.pin_mut().forget();
            }
            points += found.len();
        }
    }
    points
}
