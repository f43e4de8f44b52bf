//! The native contact solver: the same bits whoever computes them, and a restart that goes on.

use std::{cell::Cell, collections::BTreeSet};

use super::press_tests::load;
use super::tests::{free_box, native_world, remembered, shared_turn, slab, snapshot, state, steps};
use super::*;
use crate::geometry::testing::near;
use crate::scenario::NativeSettings;

fn world(native: NativeSettings) -> BulletBackend {
    native_world(native, 0.8, 0.3)
}

/// A table with a packing of boxes of several sizes, turned every which way.
fn packing(world: &mut BulletBackend) -> BodyId {
    heap_at(world, 0.0)
}

/// The same at a place along x.
fn heap_at(world: &mut BulletBackend, place: f64) -> BodyId {
    let mut table = slab(Motion::Kinematic);
    table.state.pose.translation.vector.x += place;
    let table = world.add(&table).expect("added");
    for i in 0..120_u32 {
        let (x, y, z) = (f64::from(i % 5), f64::from(i / 5 % 5), f64::from(i / 25));
        let side = 0.008 + 0.0005 * f64::from(i % 7);
        let at = Vector::new(place + 0.013 * (x - 2.0), 0.013 * (y - 2.0), 0.01 + 0.014 * z);
        let mut body = free_box(Vector::new(side, side * 0.8, side * 1.1), at);
        let turn = Vector::new(x + 0.3 * z, 0.7 * y, 1.1 * z + 0.2 * x);
        body.state.pose.rotation = UnitQuaternion::from_scaled_axis(turn);
        world.add(&body).expect("added");
    }
    table
}

/// Falls for half a second, is shaken for another.
fn shaken(world: &mut BulletBackend, table: BodyId) -> Snapshot {
    for step in 0..480 {
        let time = f64::from(step - 240) * world.time_step();
        if time > 0.0 {
            let x = 0.01 * (std::f64::consts::TAU * 3.0 * time).sin();
            world.drive(table, &Pose::translation(x, 0.0, -0.01)).expect("driven");
        }
        world.step().expect("a step");
    }
    snapshot(world)
}

fn run(native: NativeSettings) -> Snapshot {
    let mut world = world(native);
    let table = packing(&mut world);
    // Packings far apart, so that threads have bodies that do not touch.
    heap_at(&mut world, 3.0);
    heap_at(&mut world, 6.0);
    shaken(&mut world, table)
}

/// Law: other numbers of threads, and for some of them portable instructions, change no bit of a
/// run, whose end is returned.
pub(super) fn same_bits<const N: usize>(
    run: impl Fn(NativeSettings) -> Snapshot,
    others: [(u32, bool); N],
) -> Snapshot {
    let reference = run(NativeSettings::default());
    for (threads, portable) in others {
        let got = run(NativeSettings { threads: Some(threads), portable, ..Default::default() });
        let same = reference == got;
        assert!(same, "law: {threads} threads, portable {portable}: the same bits as one");
    }
    reference
}

#[test]
fn threads_and_instructions_change_no_bit() {
    let _turn = shared_turn();
    // For time, each number of threads with one kind of instructions.
    let reference = same_bits(run, [(1, true), (2, false), (3, true), (4, false)]);
    // The comparison can fail: another tolerance is another result.
    let other = NativeSettings { solver_tolerance: 0.02, ..Default::default() };
    assert!(reference != run(other), "law: other settings, other bits");
}

/// A plate that has come to rest on 81 boxes: the world's state, and on how many it bears.
fn plate_on_boxes(native: NativeSettings) -> (Snapshot, usize) {
    let mut world = world(native);
    world.add(&slab(Motion::Static)).expect("added");
    for n in 0..81_u32 {
        let (x, y) = (f64::from(n % 9) - 4.0, f64::from(n / 9) - 4.0);
        let at = Vector::new(0.013 * x, 0.013 * y, 0.005);
        world.add(&free_box(Vector::repeat(0.01), at)).expect("added");
    }
    let above = Vector::new(0.0, 0.0, 0.0125);
    let plate = world.add(&free_box(Vector::new(0.12, 0.12, 0.004), above)).expect("added");
    steps(&mut world, 240);
    let contacts = remembered(&world);
    let with_plate = contacts.iter().filter(|c| c.a == plate || c.b == plate);
    let bears: BTreeSet<u32> =
        with_plate.map(|c| if c.a == plate { c.b.0 } else { c.a.0 }).collect();
    (snapshot(&world), bears.len())
}

#[test]
fn a_body_with_more_pairs_than_colours_rests_on_all_of_them() {
    let _turn = shared_turn();
    let bears = Cell::new(0);
    let settled = |native| {
        let (state, on) = plate_on_boxes(native);
        bears.set(on);
        state
    };
    let state = same_bits(settled, [(2, false), (3, true)]);
    let bears = bears.get();
    assert!(bears > 63, "the check sees more pairs than colours, {bears}");
    let plate = state.last().expect("bodies").expect("a plate");
    let height = 1e3 * plate.pose.translation.z;
    near("the plate lies on the boxes, at 12 mm to 0.01 mm", height, 12.0, 0.01);
    let speed = 1e3 * plate.linear_velocity.norm();
    assert!(speed < 0.1, "law: at rest after half a second, to 0.1 mm/s, got {speed:.4} mm/s");
}

#[test]
fn a_world_told_of_its_contacts_goes_on_without_a_jump() {
    let _turn = shared_turn();
    // Iterations that go on until forces are found need not be told of them.
    let settings = || NativeSettings { solver_tolerance: 1.0, ..Default::default() };
    let mut first = world(settings());
    let table = packing(&mut first);
    // Shaken together, then left at rest.
    shaken(&mut first, table);
    steps(&mut first, 864);
    // Iterations that end early leave some of it to the next step: the mean of many counts.
    let mut weight = 0.0;
    for _ in 0..96 {
        first.step().expect("a step");
        let of_step = remembered(&first).into_iter().filter(|c| c.a == table);
        weight += of_step.map(|c| -c.force.z).sum::<f64>() / 96.0;
    }
    let at_rest = snapshot(&first);
    let remembered = remembered(&first);
    // The middle one of all speeds: single boxes may move in any case where iterations end early.
    let moves = |world: &mut BulletBackend| {
        let (mut most, mut bodies) = (0.0_f64, Vec::new());
        for _ in 0..5 {
            world.step().expect("a step");
            world.read(&mut bodies);
            let mut speeds: Vec<f64> =
                bodies.iter().flatten().map(|b| b.linear_velocity.norm()).collect();
            speeds.sort_by(f64::total_cmp);
            most = most.max(speeds[speeds.len() / 2]);
        }
        1e3 * most
    };
    let went_on = moves(&mut first);
    let restarted = |told: bool| {
        let mut world = world(settings());
        world.add(&slab(Motion::Kinematic)).expect("added");
        for (i, state) in at_rest.iter().enumerate().skip(1) {
            let side = 0.008 + 0.0005 * f64::from((i as u32 - 1) % 7);
            let mut body = free_box(Vector::new(side, side * 0.8, side * 1.1), Vector::zeros());
            body.state = state.expect("a body");
            world.add(&body).expect("added");
        }
        if told {
            world.recall(&remembered).expect("recalled");
        }
        moves(&mut world)
    };
    let (told, untold) = (restarted(true), restarted(false));
    assert!(
        told < went_on + 1.0,
        "law: a restart goes on as it would have, at most {went_on} mm/s, got {told} mm/s"
    );
    assert!(
        untold > 2.0 * told,
        "law: without its contacts it jumps: expected more than twice {told} mm/s, got {untold}"
    );
    let side = |i: u32| 0.008 + 0.0005 * f64::from(i % 7);
    let packing = (0..120).map(|i| 9.81 * 2673.9 * 0.88 * side(i).powi(3)).sum::<f64>();
    assert!(
        (weight / packing - 1.0).abs() < 0.02,
        "law: the table carries the packing's weight to 2 %, {packing} N, got {weight} N"
    );
}

/// How far in mm a block comes that slides at 0.6 m/s from one floor piece to another
/// which begins `ahead` (mm) of it and lies higher by `step` (mm); nothing rebounds.
fn slid_over_a_joint(ahead: f64, step: f64) -> f64 {
    let mut world = native_world(Default::default(), 0.8, 0.0);
    for (x, raised) in [(-0.2, 0.0), (0.2, 1e-3 * step)] {
        let mut piece = slab(Motion::Static);
        piece.state.pose.translation.vector += Vector::new(x, 0.0, raised);
        world.add(&piece).expect("added");
    }
    let start = -0.01 - 1e-3 * ahead;
    let mut block = free_box(Vector::new(0.02, 0.02, 0.005), Vector::new(start, 0.0, 0.0025));
    block.state.linear_velocity.x = 0.6;
    let id = world.add(&block).expect("added");
    steps(&mut world, 96);
    1e3 * (state(&world, id).pose.translation.x - start)
}

#[test]
fn a_joint_is_not_felt_and_a_step_is() {
    let _turn = shared_turn();
    let (free, joint) = (slid_over_a_joint(50.0, 0.0), slid_over_a_joint(10.0, 0.0));
    assert!(free > 20.0, "the check slides past the joint: 20 mm and more, got {free:.2} mm");
    assert!(
        (joint - free).abs() < 0.02,
        "law: as far over a joint as over one floor, {free:.3} mm to 0.02 mm, got {joint:.3} mm"
    );
    for step in [0.05, 0.2, 1.0] {
        let got = slid_over_a_joint(10.0, step);
        near(&format!("a step of {step} mm stops it at 10 mm to 0.05 mm"), got, 10.0, 0.05);
    }
}

/// Law: a plate that slides over two edges weighs on each by the lever rule: they stay where they
/// are while it moves on within the step, by its place at the beginning of each sub-step.
#[test]
fn what_slides_over_edges_is_borne_by_them_where_they_are() {
    let _turn = shared_turn();
    for contacts_at_once in [8, 1] {
        let native = NativeSettings { contacts_at_once, ..Default::default() };
        let substeps = f64::from(native.substeps(EngineSettings::default().rate_hz));
        let mut world = native_world(native, 0.0, 0.0);
        let wedge = [(-0.01, -0.02), (0.01, -0.02), (0.0, 0.0)];
        let wedge = ConvexPolyhedron::prism(&wedge, -0.005, 0.005).expect("a wedge");
        let up = UnitQuaternion::from_axis_angle(&Vector::x_axis(), std::f64::consts::FRAC_PI_2);
        let edges = [-0.02, 0.02].map(|x| {
            let mut edge = slab(Motion::Static);
            edge.shape = Arc::new(wedge.clone());
            edge.state.pose = Pose::from_parts(Vector::new(x, 0.0, 0.0).into(), up);
            world.add(&edge).expect("added")
        });
        let mut plate = free_box(Vector::new(0.07, 0.02, 0.002), Vector::new(-0.006, 0.0, 0.001));
        plate.state.linear_velocity.x = 0.5;
        let plate = world.add(&plate).expect("added");
        let mut compared = 0;
        for step in 0..12 {
            let before = state(&world, plate).pose.translation.x;
            world.step().expect("a step");
            let gone = state(&world, plate).pose.translation.x - before;
            let mean = before + gone * (substeps - 1.0) / (2.0 * substeps);
            let on = edges.map(|edge| load(&world, edge, Vector::zeros()).0.z);
            if step >= 4 {
                let share = on[1] / (on[0] + on[1]);
                near(&format!("lever rule, step {step}"), share, 0.5 + mean / 0.04, 1e-3);
                compared += 1;
            }
        }
        assert_eq!(compared, 8, "law: steps are compared");
    }
}

/// The largest velocity that the impulses of a sub-step do not explain, as a share of the largest
/// velocity.
fn unexplained(record: &SubstepRecord) -> f64 {
    const BODY: usize = SubstepRecord::BODY;
    let mut given = vec![[0.0; 6]; record.bodies.len() / BODY];
    for c in record.contacts.chunks_exact(SubstepRecord::CONTACT) {
        for (side, sign) in [(0, 1.0), (1, -1.0)] {
            let body = c[side] as usize;
            let inverse_mass = record.bodies[BODY * body];
            for along in 0..3 {
                let impulse = sign * c[34 + along];
                for k in 0..3 {
                    given[body][k] += inverse_mass * impulse * c[2 + 9 * along + k];
                    given[body][3 + k] += impulse * c[5 + 9 * along + 3 * side + k];
                }
            }
        }
    }
    let (mut worst, mut largest) = (0.0_f64, 0.0_f64);
    for (body, given) in record.bodies.chunks_exact(BODY).zip(&given) {
        if body[0] > 0.0 {
            for k in 0..6 {
                worst = worst.max((body[7 + k] - body[1 + k] - given[k]).abs());
                largest = largest.max(body[7 + k].abs());
            }
        }
    }
    worst / largest
}

#[test]
fn impulses_explain_velocities_also_where_iterations_run_out() {
    let _turn = shared_turn();
    let mut faults = Vec::new();
    // Rounding of a body's few impulses in single precision, and in double precision.
    let single = 1e-5;
    let usual = NativeSettings::default().solver_tolerance;
    for (solver_tolerance, contacts_at_once, tolerance) in
        [(usual, 8, single), (usual, 1, 1e-9), (1e-6, 1, 1e-9)]
    {
        let settings = NativeSettings { solver_tolerance, contacts_at_once, ..Default::default() };
        let mut world = world(settings);
        let table = packing(&mut world);
        world.record_substeps();
        let mut worst = 0.0_f64;
        for step in 0..120 {
            let x = 0.01 * (std::f64::consts::TAU * 3.0 * f64::from(step) / 480.0).sin();
            world.drive(table, &Pose::translation(x, 0.0, -0.01)).expect("driven");
            world.step().expect("a step");
            let record = world.recorded_substep();
            if !record.contacts.is_empty() {
                worst = worst.max(unexplained(&record));
            }
        }
        if worst >= tolerance {
            faults.push(format!(
                "solver_tolerance {solver_tolerance}: expected 0, got {worst} of the largest \
                 velocity, tolerance {tolerance}"
            ));
        }
        // The comparison can fail.
        let mut record = world.recorded_substep();
        record.contacts[34] += 0.01;
        assert!(unexplained(&record) > 10.0 * single, "law: an impulse that was not given is seen");
    }
    assert!(faults.is_empty(), "law: what a sub-step changes are its impulses; {faults:?}");
}
