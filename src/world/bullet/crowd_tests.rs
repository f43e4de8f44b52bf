//! The speeds of velocity-based AABB margins (`cpp/crowd.h`): no pair that may come within the
//! speculative margin in the step is missed, and bodies that move together have small margins.

use std::collections::BTreeMap;
use std::ops::Range;

use proptest::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use super::ffi::{CrowdProbeBody, crowd_speeds};
use super::tests::{free_box, shared_turn};
use super::*;

const STEP: f64 = 1.0 / 480.0;
const SPECULATIVE_MARGIN: f64 = 0.5e-3;

fn ball(centre: Vector, velocity: Vector, radius: f64) -> CrowdProbeBody {
    let (centre, velocity) = (centre.into(), velocity.into());
    CrowdProbeBody { centre, velocity, radius, turning: 0.0, free: true }
}

/// Pairs that may come within the speculative margin in the step though their boxes are not
/// made to overlap, and pairs that may at all.
fn missed(bodies: &[CrowdProbeBody], speeds: &[f64]) -> (Vec<String>, usize) {
    let (mut missed, mut pairs) = (Vec::new(), 0);
    for (i, a) in bodies.iter().enumerate() {
        for (j, b) in bodies.iter().enumerate().take(i) {
            let apart = |a: [f64; 3], b: [f64; 3]| (Vector::from(a) - Vector::from(b)).norm();
            let gap = apart(a.centre, b.centre) - a.radius - b.radius;
            let least = apart(a.velocity, b.velocity);
            if gap > STEP * (least + a.turning + b.turning) + SPECULATIVE_MARGIN {
                continue;
            }
            pairs += 1;
            let got = speeds[i] + speeds[j];
            if got < least * (1.0 - 1e-9) {
                missed.push(format!("{i} and {j}: at least {least} m/s together, got {got}"));
            }
        }
    }
    (missed, pairs)
}

prop_compose! {
    fn body()(
        centre in prop::array::uniform3(-0.05..0.05_f64),
        velocity in prop::array::uniform3(-5.0..5.0_f64),
        shared in 0..3_usize,
        radius in 0.002..0.008_f64,
        turning in 0.0..2.0_f64,
        kind in 0..20_u8,
    ) -> CrowdProbeBody {
        // Crowds that move alike, and some that do not; a wall now and then, a
        // large body, a fast one.
        let alike = [[0.0, 0.0, -3.0], [0.0, 0.0, 0.0], [2.0, 0.0, 0.5]][shared];
        let (alike, own) = (Vector::from(alike), Vector::from(velocity));
        let velocity = match kind {
            0 => 10.0 * own,
            1 | 2 => own,
            _ => alike + 0.05 * own,
        };
        let radius = if kind == 3 || kind == 4 { 20.0 * radius } else { radius };
        CrowdProbeBody { centre, velocity: velocity.into(), radius, turning, free: kind != 4 }
    }
}

proptest! {
    #[test]
    fn no_pair_that_may_meet_is_missed(
        bodies in prop::collection::vec(body(), 1..120),
        frame in prop::array::uniform3(-1.0..1.0_f64),
        spread in prop::sample::select(vec![1.0, 4.0, 30.0]),
    ) {
        let bodies: Vec<_> = bodies
            .into_iter()
            .map(|body| CrowdProbeBody { centre: body.centre.map(|x| spread * x), ..body })
            .collect();
        let speeds = crowd_speeds(&bodies, &frame, STEP, SPECULATIVE_MARGIN);
        if bodies.iter().all(|body| !body.free) {
            prop_assert!(speeds.is_empty(), "law: nothing to find without a free body");
            return Ok(());
        }
        prop_assert_eq!(speeds.len(), bodies.len(), "law: a speed for each body");
        let (missed, _) = missed(&bodies, &speeds);
        prop_assert!(missed.is_empty(), "law: boxes of pairs that may meet overlap: {:?}", missed);
    }
}

/// Balls on a lattice, which a crowd of them fills as grains do that fall.
fn lattice(velocity: impl Fn(Vector) -> Vector) -> Vec<CrowdProbeBody> {
    let mut bodies = Vec::new();
    for i in 0..1000_u32 {
        let at = Vector::new(f64::from(i % 10), f64::from(i / 10 % 10), f64::from(i / 100)) * 0.015;
        bodies.push(ball(at, velocity(at), 0.006));
    }
    bodies
}

#[test]
fn a_crowd_that_falls_together_stands_off_little() {
    let bodies = lattice(|at| Vector::new(0.0, 0.0, -3.0 - 0.2 * at.z));
    let speeds = crowd_speeds(&bodies, &[0.0; 3], STEP, SPECULATIVE_MARGIN);
    let most = speeds.iter().copied().fold(0.0, f64::max);
    assert!(most < 0.03, "law: by differences of speed, below 0.03 m/s, got {most} m/s of 3");
}

#[test]
fn crowds_that_meet_stand_off_by_their_speeds() {
    let towards = |at: Vector| Vector::new(if at.x < 0.07 { 3.0 } else { -3.0 }, 0.0, 0.0);
    let bodies = lattice(towards);
    let speeds = crowd_speeds(&bodies, &[0.0; 3], STEP, SPECULATIVE_MARGIN);
    let (none, pairs) = missed(&bodies, &speeds);
    assert!(none.is_empty() && pairs > 400, "law: no pair is missed of {pairs}, got {none:?}");
    // The check can fail: these speeds are what each has against its own crowd.
    let (some, _) = missed(&bodies, &vec![0.0; bodies.len()]);
    assert!(!some.is_empty(), "law: the check finds pairs that are missed");
}

#[test]
fn what_is_no_number_is_not_sorted_into_a_grid() {
    for spoilt in [f64::NAN, f64::INFINITY, 1e308] {
        for place in 0..3 {
            let mut bodies = lattice(|_| Vector::zeros());
            match place {
                0 => bodies[7].centre[1] = spoilt,
                1 => bodies[7].velocity[1] = spoilt,
                _ => bodies[7].turning = spoilt,
            }
            let speeds = crowd_speeds(&bodies, &[0.0; 3], STEP, SPECULATIVE_MARGIN);
            assert!(
                speeds.is_empty() || speeds.iter().all(|speed| !speed.is_nan()),
                "law: no speed, or one that is a number, for {spoilt} in place {place}"
            );
        }
    }
}

/// Boxes in pairs, far from all others, of which one overtakes the other or
/// meets it after some steps, while both fly along with any speed. Of them, `wanted` are added.
fn pairs_on_a_course(world: &mut BulletBackend, wanted: &Range<u32>) {
    let mut random = Pcg64::seed_from_u64(5);
    let mut any = |size: f64| Vector::from_fn(|_, _| random.random_range(-size..size));
    for number in 0..wanted.end {
        let place = Vector::new(f64::from(number % 50), f64::from(number / 50), 0.0) * 0.5;
        let (velocity, course) = (any(4.0), any(2.0));
        for (side, along) in [(0.010, 0.0), (0.008, 1.0)] {
            // They would be in one place after ten steps.
            let at = place - 10.0 * STEP * course * along + any(0.002) * along;
            let mut body = free_box(Vector::new(side, 0.8 * side, 1.1 * side), at);
            body.state.linear_velocity = velocity + course * along;
            body.state.angular_velocity = any(20.0);
            body.state.pose.rotation = UnitQuaternion::from_scaled_axis(any(3.0));
            if wanted.contains(&number) {
                world.add(&body).expect("added");
            }
        }
    }
}

/// When each of these pairs, of the first two hundred, first had a contact with a force, and the
/// smallest gap of its points then, in m. All is free flight before; later the order comes in, in which a world
/// solves its contacts. Without a force there may be some for bodies that do not
/// meet in the step, of which the boxes need not overlap.
fn met(pairs: Range<u32>) -> BTreeMap<u32, (usize, f64)> {
    let table = PairTable::uniform(PairCoefficients { friction: 0.8, restitution: 0.3 });
    let mut world =
        BulletBackend::new(&EngineSettings::default(), Vector::zeros(), &table).expect("a world");
    pairs_on_a_course(&mut world, &pairs);
    let (mut contacts, mut first) = (Vec::new(), BTreeMap::new());
    for step in 0..20 {
        world.step().expect("a step");
        world.contacts(&mut contacts);
        for contact in contacts.iter().filter(|contact| contact.a.0 < 400) {
            assert_eq!(contact.a.0 / 2, contact.b.0 / 2, "law: pairs are far from each other");
            if contact.impulse.norm() > 0.0 {
                // Which of a pair's points bear the force depends on when iterations end.
                let of_pair = contacts.iter().filter(|other| other.a == contact.a);
                let gap = of_pair.map(|other| other.gap).fold(f64::INFINITY, f64::min);
                first.entry(pairs.start + contact.a.0 / 2).or_insert((step, gap));
            }
        }
    }
    first
}

#[test]
fn a_pair_among_thousands_meets_when_it_does_alone() {
    let _turn = shared_turn();
    let (alone, many): (BTreeMap<_, _>, _) =
        ((0..200).flat_map(|pair| met(pair..pair + 1)).collect(), met(0..2100));
    let late = alone.values().filter(|(step, _)| *step > 1).count();
    assert!(late > 100, "law: pairs meet while the grid is in use, got {late} of {}", alone.len());
    assert_eq!(many.len(), alone.len(), "law: the same pairs meet");
    for (pair, (step, gap)) in &alone {
        let got = many.get(pair).copied().unwrap_or_default();
        assert!(
            got.0 == *step && (got.1 - gap).abs() < 1e-6,
            "law: pair {pair} meets in step {step} at {gap} m, to 1e-6 m, got {got:?}"
        );
    }
}
