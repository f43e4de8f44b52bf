//! How kinematic bodies go through a step: their velocity changes steadily, in a new
//! world that recalls the steps before as well, and a new body begins anew.

use super::tests::{free_box, native_world, precision, remembered, shared_turn, slab};
use super::*;

fn world() -> BulletBackend {
    native_world(Default::default(), 0.8, 0.0)
}

/// Where a shaken and turning table is at the end of a step; at rest before the first.
fn table_at(step: i32) -> Pose {
    let time = f64::from(step.max(0)) / 480.0;
    let x = 0.005 * (std::f64::consts::TAU * 3.0 * time).sin();
    let turn = Vector::new(0.0, 0.02 * (std::f64::consts::TAU * 2.0 * time).sin(), 0.0);
    Pose::new(Vector::new(0.01 + x, 0.0, -0.01), turn)
}

fn drive(world: &mut BulletBackend, id: BodyId, pose: &Pose) {
    world.drive(id, pose).expect("driven");
    world.step().expect("a step");
}

/// A kinematic slab somewhere.
fn table(pose: Pose) -> Body {
    let mut body = slab(Motion::Kinematic);
    body.state.pose = pose;
    body
}

#[test]
fn a_table_goes_on_to_the_bit_in_a_world_that_is_told_of_it() {
    let _turn = shared_turn();
    let mut whole = world();
    let id = whole.add(&table(table_at(0))).expect("added");
    let mut seen = vec![Vec::new()];
    for step in 1..=200 {
        drive(&mut whole, id, &table_at(step));
        seen.push(whole.drives());
    }
    let changing = |d: &&ffi::DriveRead| d.acceleration[0] != 0.0 && d.spin_up[1] != 0.0;
    let changes = seen.iter().flatten().filter(changing);
    assert!(changes.count() > 150, "the check has velocities that change");
    for seam in [1, 2, 3, 77, 150] {
        let mut told = world();
        let mut untold = world();
        for world in [&mut told, &mut untold] {
            world.add(&table(table_at(seam))).expect("added");
        }
        let ends = [2, 1, 0].map(|ago| table_at(seam - ago));
        told.recall_drive(id, &ends).expect("told");
        for step in seam + 1..=seam + 10 {
            for world in [&mut told, &mut untold] {
                drive(world, id, &table_at(step));
            }
            let expected = &seen[step as usize];
            assert_eq!(&told.drives(), expected, "law: the same bits, step {step} from {seam}");
            // Without it, the first two steps have no history; the third does.
            let bare = untold.drives() == *expected;
            if seam > 3 {
                let late = step > seam + 2;
                assert_eq!(bare, late, "the check sees a history, step {step} from {seam}");
            }
        }
    }
}

/// Steps of a block that is carried by friction, from one of them on in a new
/// world where there is one.
fn carried(seam: Option<(i32, bool)>) -> Vec<f64> {
    let mut here = world();
    let mut id = here.add(&table(table_at(0))).expect("added");
    let block = Vector::new(0.04, 0.04, 0.01);
    let mut block = free_box(block, Vector::new(0.01, 0.0, 0.005));
    let mut on = here.add(&block).expect("added");
    let mut speeds = Vec::new();
    let mut states = Snapshot::new();
    for step in 1..=200 {
        drive(&mut here, id, &table_at(step));
        here.read(&mut states);
        speeds.push(states[on.0 as usize].expect("there").linear_velocity.x);
        let Some((_, told)) = seam.filter(|(at, _)| *at == step) else { continue };
        let mut contacts = remembered(&here);
        block.state = states[on.0 as usize].expect("there");
        let mut next = world();
        let (was, was_on) = (id, on);
        // The block first: the other way round than before.
        on = next.add(&block).expect("added");
        id = next.add(&table(table_at(step))).expect("added");
        for c in &mut contacts {
            let of = |body| if body == was { id } else { on };
            assert!([was, was_on].contains(&c.a) && [was, was_on].contains(&c.b));
            (c.a, c.b) = (of(c.a), of(c.b));
        }
        next.recall(&contacts).expect("told");
        if told {
            next.recall_drive(id, &[2, 1, 0].map(|ago| table_at(step - ago))).expect("told");
        }
        here = next;
    }
    speeds
}

#[test]
fn a_block_on_a_table_goes_on_in_another_world_as_it_would_have() {
    let _turn = shared_turn();
    let whole = carried(None);
    let largest = |speeds: &[f64]| {
        let differences = whole.iter().zip(speeds).map(|(a, b)| (a - b).abs());
        differences.fold(0.0, f64::max)
    };
    let (told, untold) =
        (largest(&carried(Some((100, true)))), largest(&carried(Some((100, false)))));
    let tolerance = precision(1e-6, 1e-5);
    assert!(
        told < tolerance,
        "law: velocities as in one world to {tolerance} m/s, got a difference of {told} m/s"
    );
    assert!(untold > 100.0 * told, "the check sees a table without history: {untold} m/s");
}

#[test]
fn a_new_body_has_no_history_whatever_its_address() {
    let _turn = shared_turn();
    let mut world = world();
    let mut last = world.add(&table(Pose::identity())).expect("added");
    for n in 1..=10 {
        for step in 1..=4 {
            let x = f64::from(n * step * step) * 1e-4;
            drive(&mut world, last, &Pose::translation(x, 0.0, 0.0));
        }
        let [old] = &world.drives()[..] else { panic!("one body") };
        assert!(old.acceleration[0] > 0.0, "the check has a body whose velocity changes: {old:?}");
        // Its room is the next one's.
        world.remove(last).expect("removed");
        last = world.add(&table(Pose::identity())).expect("added");
        drive(&mut world, last, &Pose::translation(f64::from(n) * 1e-2, 0.0, 0.0));
        let [new] = &world.drives()[..] else { panic!("one body") };
        assert!(new.id == last.0 && new.velocity[0] > 0.0, "the new one moves: {new:?}");
        assert!(
            new.acceleration == [0.0; 3] && new.spin_up == [0.0; 3],
            "law: a body without steps before jumps to its velocity, got {new:?}"
        );
    }
}

#[test]
fn only_kinematic_bodies_have_been_driven() {
    let _turn = shared_turn();
    let mut world = world();
    let table = world.add(&table(Pose::identity())).expect("added");
    let free = world.add(&free_box(Vector::repeat(0.01), Vector::z())).expect("added");
    let ends = [Pose::identity(); 3];
    assert!(world.recall_drive(table, &ends).is_ok());
    assert!(
        matches!(world.recall_drive(free, &ends), Err(WorldError::NotKinematic(id)) if id == free)
    );
    let gone = BodyId(7);
    assert!(
        matches!(world.recall_drive(gone, &ends), Err(WorldError::NoSuchBody(id)) if id == gone)
    );
}
