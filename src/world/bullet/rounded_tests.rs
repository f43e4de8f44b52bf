//! Contacts of rounded polyhedra with each other, hulls and spheres: gaps, normals and points are
//! exact, a face holds what lies on it, and nothing depends on threads or instructions.

use super::native_tests::same_bits;
use super::probe::{HullPair, ProbeSettings};
use super::tests::{native_world, remembered, shared_turn, steps};
use super::*;
use crate::geometry::{MassProperties, Point, rounded_within, testing::near};
use crate::grains::streams::{rotation, stream, uniform};
use crate::scenario::NativeSettings;

/// Vertices of hulls, and with them planes, are rounded to single precision; so are normals, gaps
/// and points where a pair keeps them.
const ROUNDING: f64 = 2e-8;

fn cuboid(sides: [f64; 3]) -> ConvexPolyhedron {
    ConvexPolyhedron::cuboid(Vector::from(sides)).expect("a cuboid")
}

fn rounded(core: &ConvexPolyhedron, radius: f64) -> ConvexPolyhedron {
    ConvexPolyhedron::of_rounded(core.clone(), radius).expect("a rounded body")
}

/// A grain-like body of some 10 mm, of sharpness by turns.
fn body(rng: &mut rand_pcg::Pcg64, kind: usize) -> ConvexPolyhedron {
    let sides = [0, 1, 2].map(|_| 0.006 + 0.008 * uniform(rng));
    let skew = rotation(rng);
    let cut = cuboid(sides);
    // An octahedron-like hull within: corners in all directions.
    let core = match kind % 3 {
        0 => cut,
        1 => ConvexPolyhedron::frustum(
            [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
                .map(|(x, y)| Point::new(0.004 * x, 0.005 * y, -0.004))
                .to_vec(),
            [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
                .map(|(x, y)| Point::new(0.002 * x, 0.0025 * y, 0.004))
                .to_vec(),
        )
        .expect("a frustum"),
        _ => ConvexPolyhedron::prism(
            &[(-0.004, -0.003), (0.005, -0.002), (0.0, 0.006)],
            -0.003,
            0.004,
        )
        .expect("a prism"),
    };
    let turned = core.transformed(&Pose::from_parts(Vector::zeros().into(), skew));
    let found = rounded_within(&turned, 0.1 + 0.18 * (kind % 5) as f64).expect("a core");
    rounded(&found.core, found.radius)
}

/// Law: corners and edges of rounded cubes meet as balls and cylinders do.
#[test]
fn corners_and_edges_meet_as_balls_and_cylinders() {
    let (cube, r) = (rounded(&cuboid([0.016; 3]), 0.002), 0.002);
    let turn = UnitQuaternion::from_euler_angles(0.3, 0.5, 0.7);
    let v = Vector::new;
    for gap in [3e-4, 0.0, -5e-4] {
        for (what, corner, n) in [
            ("corners", v(0.008, 0.008, 0.008), v(1.0, 2.0, 1.5).normalize()),
            ("a corner and an edge", v(0.008, 0.001, 0.008), v(1.0, 0.0, 1.4).normalize()),
        ] {
            // B's corner that looks most against n.
            let far = -(turn.inverse() * n);
            let own = v(far.x.signum(), far.y.signum(), far.z.signum()) * 0.008;
            let place = corner + n * (2.0 * r + gap) - turn * own;
            let pose = Pose::from_parts(place.into(), turn);
            let mut pair = HullPair::new(&cube, &cube, ProbeSettings::default()).expect("a pair");
            let points = pair.step(&Pose::identity(), &pose);
            assert_eq!(points.len(), 1, "law: {what} meet in one point");
            near(&format!("{what}: gap, m"), points[0].gap, gap, ROUNDING);
            near(&format!("{what}: normal"), (points[0].normal + n).norm(), 0.0, 1e-5);
            let on = corner + n * r;
            near(&format!("{what}: point, m"), (points[0].on_a - on).norm(), 0.0, 5e-8);
        }
    }
}

/// Law: a rounded block on a face has its four corners for contact points, at the same places and
/// with the same names, while it is moved by micrometres and turned by a few thousandths.
#[test]
fn a_block_on_its_face_keeps_four_points() {
    let slab = cuboid([0.1, 0.1, 0.02]);
    let block = rounded(&cuboid([0.016, 0.012, 0.008]), 0.002);
    let mut rng = stream(2, "block");
    for swapped in [false, true] {
        let (a, b) = if swapped { (&block, &slab) } else { (&slab, &block) };
        let mut pair = HullPair::new(a, b, ProbeSettings::default()).expect("a pair");
        let mut ids = Vec::new();
        for step in 0..60 {
            let off = Vector::from([0, 1, 2].map(|_| 2e-6 * (uniform(&mut rng) - 0.5)));
            let lean = Vector::from([0, 1, 2].map(|_| 2e-3 * (uniform(&mut rng) - 0.5)));
            let place = Vector::new(0.003, -0.002, 0.01 + 0.006) + off;
            let pose = Pose::from_parts(place.into(), UnitQuaternion::from_scaled_axis(lean));
            let still = Pose::identity();
            let points = if swapped { pair.step(&pose, &still) } else { pair.step(&still, &pose) };
            assert_eq!(points.len(), 4, "law: four corners, step {step}");
            let mut now: Vec<u32> = points.iter().map(|p| p.id).collect();
            now.sort_unstable();
            if step == 0 {
                ids.clone_from(&now);
            }
            assert_eq!(now, ids, "law: the same points, step {step}, swapped {swapped}");
            for point in &points {
                assert_eq!(point.age, step, "law: each is as old as the contact");
                let on = if swapped { point.on_a } else { point.on_b };
                let corner = pose.inverse() * Point::from(on);
                near("a corner of the face, x, m", corner.x.abs(), 0.008, 2e-5);
                near("a corner of the face, y, m", corner.y.abs(), 0.006, 2e-5);
            }
        }
    }
}

pub(super) fn world(
    pair: PairCoefficients,
    gravity: Vector,
    native: NativeSettings,
) -> BulletBackend {
    let settings = EngineSettings { native, ..Default::default() };
    BulletBackend::new(&settings, gravity, &PairTable::uniform(pair)).expect("a world")
}

fn free(shape: &ConvexPolyhedron, at: Vector, turn: UnitQuaternion<f64>) -> Body {
    let found = MassProperties::of(shape);
    let frame = found.principal_frame();
    let shape = Arc::new(shape.transformed(&frame.pose.inverse()));
    let motion =
        Motion::Free { mass: 2500.0 * found.volume, inertia: frame.moments_per_density * 2500.0 };
    let state = BodyState::at_rest(Pose::from_parts(at.into(), turn));
    Body { shape, motion, material: crate::world::Material::Grain, state }
}

pub(super) fn floor() -> Body {
    Body {
        shape: Arc::new(cuboid([0.8, 0.8, 0.02])),
        motion: Motion::Static,
        material: crate::world::Material::Wall,
        state: BodyState::at_rest(Pose::translation(0.0, 0.0, -0.01)),
    }
}

/// Law: no number of threads and no instructions change a bit; energy is not won, and what has
/// settled lies still.
#[test]
fn a_heap_settles_and_threads_and_instructions_change_no_bit() {
    let _turn = shared_turn();
    let run = |native| {
        let mut world = native_world(native, 0.5, 0.3);
        world.add(&floor()).expect("added");
        let mut rng = stream(5, "gravel");
        let mut inertias = Vec::new();
        for n in 0..150 {
            let place = Vector::new(
                0.018 * f64::from(n % 5) + 1e-3 * uniform(&mut rng),
                0.018 * f64::from(n / 5 % 5) + 1e-3 * uniform(&mut rng),
                0.012 + 0.018 * f64::from(n / 25),
            );
            let shape = body(&mut rng, n as usize % 5);
            let grain = free(&shape, place, rotation(&mut rng));
            let Motion::Free { mass, inertia } = grain.motion else { panic!("free") };
            inertias.push((mass, inertia));
            world.add(&grain).expect("added");
        }
        let mut energy = f64::INFINITY;
        let mut states = Snapshot::new();
        for step in 0..960 {
            world.step().expect("a step");
            if step % 40 == 39 {
                world.read(&mut states);
                let now: f64 = states[1..]
                    .iter()
                    .zip(&inertias)
                    .map(|(s, (mass, inertia))| {
                        let s = s.expect("a grain");
                        let speed = s.linear_velocity.norm_squared() / 2.0;
                        let moves = mass * (9.81 * (s.pose.translation.z + 0.1) + speed);
                        // What spins may roll on: friction makes speed of spin.
                        moves + s.rotational_energy(inertia)
                    })
                    .sum();
                assert!(now <= energy * (1.0 + 1e-6), "law: none is won, {energy} then {now} J");
                energy = now;
            }
        }
        states
    };
    let alone = same_bits(run, [(3, false), (2, true)]);
    let there = alone.iter().flatten().skip(1);
    assert!(there.clone().all(|s| s.pose.translation.z > 0.0), "law: the floor holds");
    let moving = there.filter(|s| s.linear_velocity.norm() > 0.01).count();
    assert!(moving < 5, "law: after two seconds they lie, {moving} move");
}

/// Law: on a smooth floor nothing makes a body spin faster, however small its core is.
#[test]
fn a_nearly_round_body_that_spins_on_the_floor_wins_nothing() {
    let _turn = shared_turn();
    for core in [1e-4, 2e-4, 5e-4] {
        let pair = PairCoefficients { friction: 0.0, restitution: 0.0 };
        let mut world = world(pair, -Vector::z() * 9.81, NativeSettings::default());
        world.add(&floor()).expect("added");
        let shape = rounded(&cuboid([2.0 * core; 3]), 5e-3 - core);
        let mut body = free(&shape, Vector::z() * 5e-3, UnitQuaternion::identity());
        body.state.angular_velocity = Vector::y() * 5.0;
        let id = world.add(&body).expect("added");
        for _ in 0..480 {
            world.step().expect("a step");
            let now = world.read_body(id).expect("there").angular_velocity.norm();
            // It falls by what its corners stand out, from one face to the next.
            assert!(
                now < 5.5,
                "law: a core of {core} m, spin expected at most 5.5, got {now} rad/s"
            );
        }
    }
}

/// The contacts of a body on the floor, which is pulled aside, and its state after some steps; and
/// how far in m it is twenty steps later from where it is in a world that recalls them.
pub(super) fn recalled(body: &Body, count: u32) -> (Vec<RememberedContact>, BodyState, f64) {
    let new = |body: &Body| {
        let pair = PairCoefficients { friction: 0.5, restitution: 0.0 };
        let mut world = world(pair, Vector::new(1.0, 0.0, -9.81), NativeSettings::default());
        world.add(&floor()).expect("added");
        let id = world.add(body).expect("added");
        (world, id)
    };
    let (mut first, id) = new(body);
    steps(&mut first, count);
    let (contacts, state) = (remembered(&first), first.read_body(id).expect("it is there"));
    let (mut second, again) = new(&Body { state, ..body.clone() });
    second.recall(&contacts).expect("recalled");
    let ends = [(&mut first, id), (&mut second, again)].map(|(world, id)| {
        steps(world, 20);
        world.read_body(id).expect("there").pose.translation.vector
    });
    (contacts, state, (ends[0] - ends[1]).norm())
}

/// Law: a world that goes on from another's has its contacts with their impulses.
#[test]
fn remembered_contacts_go_on() {
    let _turn = shared_turn();
    let shape = rounded(&cuboid([0.008, 0.006, 0.004]), 0.001);
    // On a face, and on an edge, about which it falls over.
    for (at, lean, points) in [(0.0, 0.0, 4), (0.1, 0.6, 2)] {
        let turn = UnitQuaternion::from_euler_angles(0.0, lean, 0.0);
        let mut probe = free(&shape, Vector::zeros(), turn);
        let low = probe.shape.heights(&probe.state.pose).0;
        probe.state.pose.translation.vector = Vector::new(at, 0.0, -low);
        let (contacts, _, off) = recalled(&probe, 10);
        assert_eq!(contacts.len(), points, "law: points of a face, of an edge");
        near("it goes on as if there were one world, m", off, 0.0, 2e-8);
    }
}

#[test]
fn what_cannot_be_rounded_is_refused() {
    let _turn = shared_turn();
    let pair = PairCoefficients { friction: 0.5, restitution: 0.0 };
    let mut world = world(pair, Vector::zeros(), NativeSettings::default());
    for radius in [-1.0, f64::NAN, f64::INFINITY] {
        let definition = ffi::ShapeDefinition { radius, ..flat(&cuboid([0.01; 3])) };
        let added = world.world.pin_mut().add_shape(&definition);
        let said = added.expect_err("refused").what().to_owned();
        assert!(said.contains("radius of a rounded"), "law: it says so, got {said}");
    }
}
