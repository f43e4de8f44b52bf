//! What bears on three points or more comes to rest.

use super::recall_tests::bodies;
use super::tests::{contacts, free_box, native_world, remembered, shared_turn, slab};
use super::*;

fn world() -> BulletBackend {
    native_world(Default::default(), 0.8, 0.3)
}

/// Loaded contact points of each body.
fn loaded_points(world: &BulletBackend, bodies: usize) -> Vec<usize> {
    let contacts = remembered(world);
    let of = |body: usize| {
        let bears = |id: BodyId| id.0 as usize == body;
        contacts.iter().filter(|c| bears(c.a) || bears(c.b)).count()
    };
    (0..bodies).map(of).collect()
}

#[test]
fn a_heap_comes_to_rest() {
    let _turn = shared_turn();
    for seed in [1, 2, 3, 5] {
        let mut world = world();
        let bodies = bodies(seed);
        for body in &bodies {
            world.add(body).expect("added");
        }
        let mut states = Snapshot::new();
        let mut fastest = vec![0.0_f64; bodies.len()];
        for step in 0..6 * 480 {
            world.step().expect("a step");
            if step >= 5 * 480 {
                world.read(&mut states);
                for (fastest, state) in fastest.iter_mut().zip(&states) {
                    *fastest = fastest.max(state.expect("there").angular_velocity.norm());
                }
            }
        }
        // Between two points a grain swings like a pendulum: no friction of points resists it.
        let points = loaded_points(&world, bodies.len());
        let bearing = fastest.iter().zip(&points).enumerate().filter(|(_, (_, n))| **n >= 3);
        let (mut seen, mut worst) = (0, (0.0, 0));
        for (body, (spin, _)) in bearing {
            seen += 1;
            if *spin > worst.0 {
                worst = (*spin, body);
            }
        }
        assert!(seen > bodies.len() / 2, "the check sees most bodies, {seen}");
        assert!(worst.0 > 0.0, "and that they move at all");
        assert!(
            worst.0 < 5e-3,
            "law: a body on three points or more is at rest after 5 s; packing {seed}, body {}: \
             expected at most 0.005 rad/s, got {:.1e} rad/s",
            worst.1,
            worst.0
        );
    }
}

/// Contact points within reach of a plate that lies across the edge of a table, leaning
/// by angles (rad) along the edge and across it.
fn points(along: f64, across: f64) -> usize {
    let mut world = world();
    world.add(&slab(Motion::Static)).expect("added");
    let mut plate = free_box(Vector::new(0.03, 0.012, 0.004), Vector::zeros());
    let turn = UnitQuaternion::from_scaled_axis(Vector::new(along, across, 0.0));
    // Its lower face goes through the edge at x = 0.2 m, 0.003 mm below.
    plate.state.pose.rotation = turn;
    plate.state.pose.translation.vector =
        Vector::new(0.2, 0.0, -3e-6) + turn * Vector::new(0.004, 0.0, 0.002);
    world.add(&plate).expect("added");
    world.step().expect("a step");
    contacts(&world).len()
}

#[test]
fn edges_that_meet_almost_flat_have_the_points_of_a_face() {
    let _turn = shared_turn();
    for (along, across) in [(0.002, 0.002), (0.002, -0.002), (-0.004, 0.006)] {
        let got = points(along, across);
        assert!(
            got >= 3,
            "law: a plate that leans by {along} and {across} rad is held by three points or \
             more, got {got}"
        );
    }
    let got = points(0.3, 0.3);
    assert!(got <= 2, "law: steep edges meet in a point, got {got}");
}
