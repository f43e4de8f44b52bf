//! What a sub-step of the native contact solver begins with: the force that goes on, and
//! nothing of an impact.

use super::recall_tests::bodies;
use super::tests::{free_box, precision, remembered, shared_turn, slab, snapshot, steps, uniform};
use super::*;
use crate::scenario::NativeSettings;

const GRAVITY: f64 = 9.81;

/// `at_once`: 1 for double precision. `tolerance`: 1 ends iterations early.
fn world(rate_hz: f64, restitution: f64, at_once: u32, tolerance: f64) -> BulletBackend {
    let native = NativeSettings {
        contacts_at_once: at_once,
        solver_tolerance: tolerance,
        ..Default::default()
    };
    let settings = EngineSettings { native, rate_hz, ..Default::default() };
    let gravity = Vector::new(0.0, 0.0, -GRAVITY);
    BulletBackend::new(&settings, gravity, &uniform(0.8, restitution)).expect("a world")
}

fn states(world: &BulletBackend) -> Vec<BodyState> {
    snapshot(world).into_iter().map(|state| state.expect("none was removed")).collect()
}

/// Energy in J of the difference of two motions of a free body.
fn difference(body: &Body, one: &BodyState, other: &BodyState) -> f64 {
    let Motion::Free { mass, inertia } = body.motion else { return 0.0 };
    let apart = BodyState {
        pose: one.pose,
        linear_velocity: one.linear_velocity - other.linear_velocity,
        angular_velocity: one.angular_velocity - other.angular_velocity,
    };
    0.5 * mass * apart.linear_velocity.norm_squared() + apart.rotational_energy(&inertia)
}

#[test]
fn a_run_continued_after_an_impact_goes_on_as_in_line() {
    const STEPS: i32 = 8;
    let _turn = shared_turn();
    // Blocks above each other, a little apart, fall on each other all the time; on faces, so that
    // a world that is made anew finds the same contact points. Enough of them that there are no more
    // iterations than asked for: more would forget what they began with.
    let mut bodies = vec![slab(Motion::Static)];
    bodies.extend((0..144_u8).flat_map(|column| {
        let at = |row: u8| 0.02 * (f64::from(row) - 5.5);
        let apart = 0.0105 + 7e-6 * f64::from(column);
        (0..8_u8).map(move |n| {
            let height = 0.0055 + apart * f64::from(n);
            free_box(Vector::repeat(0.01), Vector::new(at(column % 12), at(column / 12), height))
        })
    }));
    let mut in_line = world(480.0, 0.3, 8, 1.0);
    for body in &bodies {
        in_line.add(body).expect("added");
    }
    steps(&mut in_line, 8);
    // Of every block with a contact just after an impact, in every step.
    let mut shares = Vec::new();
    for _ in 0..STEPS {
        let remembered = remembered(&in_line);
        let mut met = vec![false; bodies.len()];
        for contact in remembered.iter().filter(|c| c.warm_start < 0.1) {
            for id in [contact.a, contact.b] {
                met[id.0 as usize] = true;
            }
        }
        for (body, state) in bodies.iter_mut().zip(states(&in_line)) {
            body.state = state;
        }
        in_line.step().expect("a step");
        let after = states(&in_line);
        let continued = |contacts: &[RememberedContact]| {
            let mut other = world(480.0, 0.3, 8, 1.0);
            for body in &bodies {
                other.add(body).expect("added");
            }
            other.recall(contacts).expect("recalled");
            other.step().expect("a step");
            states(&other)
        };
        let with_impacts: Vec<_> =
            remembered.iter().map(|c| RememberedContact { warm_start: 1.0, ..*c }).collect();
        let (told, whole) = (continued(&remembered), continued(&with_impacts));
        for i in (1..bodies.len()).filter(|&i| met[i]) {
            let of = |others: &[BodyState]| difference(&bodies[i], &after[i], &others[i]);
            let (told, whole) = (of(&told), of(&whole));
            if whole > 0.0 {
                shares.push(told / whole);
            }
        }
    }
    assert!(shares.len() > 500, "law: whole forces make a difference, to {} blocks", shares.len());
    // Of shares a geometric mean: no single block decides. Less than 1e-9 is rounding: blocks move
    // at some 0.1 m/s, in single precision.
    let logs = shares.iter().map(|share| share.clamp(1e-9, 1e9).ln());
    let mean = (logs.sum::<f64>() / shares.len() as f64).exp();
    assert!(
        mean < 0.2,
        "law: a run that is continued goes on as one in line: of blocks just after an impact, the \
         energy of the difference after a step is at most a fifth of what it is where whole \
         forces begin the step; got {mean} in the mean"
    );
}

#[test]
fn an_impact_in_any_sub_step_does_not_warm_start_the_next_step() {
    let _turn = shared_turn();
    const SPEED: f64 = 0.5;
    let (mut impacts, mut late) = (0, 0);
    for number in 0..12 {
        let mut world = world(480.0, 0.5, 8, 0.002);
        world.add(&slab(Motion::Static)).expect("added");
        // Over 12 heights the impact comes at another place in the step: it goes 1.04 mm in one.
        let height = 2e-3 + 1.04e-3 * f64::from(number) / 12.0;
        let mut body = free_box(Vector::repeat(0.01), Vector::new(0.0, 0.0, 0.005 + height));
        body.state.linear_velocity.z = -SPEED;
        let id = world.add(&body).expect("added");
        let Motion::Free { mass, .. } = body.motion else { panic!("it is free") };
        for _ in 0..8 {
            world.step().expect("a step");
            let touching = remembered(&world);
            let of_step: f64 = touching.iter().map(|c| c.force.norm() / 480.0).sum();
            if of_step < 0.5 * mass * SPEED {
                continue;
            }
            impacts += 1;
            // What has not risen by a third of a step's displacement was hit in the last sub-step.
            let gap = states(&world)[id.0 as usize].pose.translation.z - 0.005;
            late += u32::from(gap < 0.3 * 0.5 * SPEED / 480.0);
            let begins: f64 = touching.iter().map(|c| c.warm_start * c.force.norm() / 480.0).sum();
            let weight = mass * GRAVITY / 480.0;
            assert!(
                begins < weight,
                "law: an impact of {of_step:.2e} N s says nothing of the force that follows; \
                 height {height} m: the next step begins with at most the weight's {weight:.1e} N \
                 s, got {begins:.1e} N s"
            );
        }
    }
    assert_eq!(impacts, 12, "the check sees one impact of each block");
    assert!(late >= 2, "the check sees impacts in the last sub-step, got {late}");
}

/// Over a pile that collapses and is shaken: the largest share of a step's impulses on a body by
/// which its momentum changed otherwise than its contacts report; and how many looks at bodies
/// with contacts there were.
fn unexplained(steps: u32) -> (f64, u32) {
    let mut world = world(480.0, 0.3, 1, 0.002);
    let bodies = bodies(2);
    for body in &bodies {
        world.add(body).expect("added");
    }
    let (mut worst, mut looks) = (0.0_f64, 0);
    let mut before = states(&world);
    let mut contacts = Vec::new();
    for step in 0..steps {
        let x = 2e-3 * (0.3 * f64::from(step)).sin();
        world.drive(BodyId(0), &Pose::translation(x, 0.0, -0.01)).expect("driven");
        world.step().expect("a step");
        let after = states(&world);
        world.contacts(&mut contacts);
        let mut impulses = vec![(Vector::zeros(), 0.0); bodies.len()];
        for c in &contacts {
            for (id, sign) in [(c.a, 1.0), (c.b, -1.0)] {
                let (sum, size) = &mut impulses[id.0 as usize];
                *sum += sign * c.impulse;
                *size += c.impulse.norm();
            }
        }
        for (n, body) in bodies.iter().enumerate() {
            let Motion::Free { mass, .. } = body.motion else { continue };
            let (sum, size) = impulses[n];
            // What weighs less than a share of the weight is rounding of the weight.
            if size < 0.1 * mass * GRAVITY / 480.0 {
                continue;
            }
            let weight = Vector::new(0.0, 0.0, -GRAVITY) * (mass / 480.0);
            let change = (after[n].linear_velocity - before[n].linear_velocity) * mass;
            worst = worst.max((change - weight - sum).norm() / size);
            looks += 1;
        }
        before = after;
    }
    (worst, looks)
}

/// A contact may end a sub-step with a friction impulse and no normal impulse. It is asleep in
/// the next one; when it is looked at, it must remove no more than was applied.
#[test]
fn a_body_changes_by_exactly_the_impulses_that_its_contacts_report() {
    let _turn = shared_turn();
    let (worst, looks) = unexplained(480);
    assert!(looks > 1000, "the check sees bodies with contacts, got {looks}");
    // Impulses are kept in single precision.
    let tolerance = precision(1e-5, 1e-3);
    assert!(
        worst < tolerance,
        "law: m Δv is the sum of all impulses; expected 0 of their sizes, got {worst:.1e}, \
         tolerance {tolerance}"
    );
}

/// Lowest place in m that a block reaches which comes with 8 mm/s, without gravity, at the ends
/// of its sub-steps.
fn turns_at(height: f64) -> f64 {
    // One sub-step a step, so that each is seen.
    let settings = EngineSettings { rate_hz: 2000.0, ..Default::default() };
    let pairs = uniform(0.5, 0.5);
    let mut world = BulletBackend::new(&settings, Vector::zeros(), &pairs).expect("a world");
    world.add(&slab(Motion::Static)).expect("added");
    let mut body = free_box(Vector::repeat(0.01), Vector::new(0.0, 0.0, 0.005 + height));
    body.state.linear_velocity.z = -8e-3;
    let id = world.add(&body).expect("added");
    let mut lowest = f64::INFINITY;
    for _ in 0..60 {
        world.step().expect("a step");
        lowest = lowest.min(states(&world)[id.0 as usize].pose.translation.z - 0.005);
    }
    let up = states(&world)[id.0 as usize].linear_velocity.z;
    assert!((up - 4e-3).abs() < 4e-5, "law: it leaves with e v, 4 mm/s, got {up} m/s");
    lowest
}

#[test]
fn a_slow_block_rebounds_from_the_surface_and_not_above_it() {
    let _turn = shared_turn();
    for number in 0..10 {
        let height = 50e-6 + 0.4e-6 * f64::from(number);
        let lowest = turns_at(height);
        // Without an impulse an impact is met up to half of what the threshold, 2 mm/s, goes in
        // a sub-step.
        let tolerance = 0.5e-6 + precision(0.1e-6, 0.5e-6);
        assert!(
            lowest.abs() < tolerance,
            "law: surfaces meet before they part; from {height} m: expected 0 m, got {lowest:.1e} \
             m, tolerance {tolerance}"
        );
    }
}
