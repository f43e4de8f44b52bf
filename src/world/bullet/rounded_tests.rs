//! Contacts of rounded polyhedra with each other, hulls and spheres: gaps, normals and points are
//! exact, a face holds what lies on it, and nothing depends on threads or instructions.

use super::probe::{HullPair, ProbePoint, ProbeSettings};
use super::tests::shared_turn;
use super::*;
use crate::geometry::{MassProperties, Point, rounded_within};
use crate::grains::streams::{rotation, stream, uniform};
use crate::scenario::NativeSettings;

/// Vertices of hulls, and with them planes, are rounded to single precision; so are normals, gaps
/// and points where a pair keeps them.
const ROUNDING: f64 = 2e-8;
/// Where a face is nearer to the axis than 0.01 rad, gaps are those along its normal.
const FLAT: f64 = 5e-5;

fn near(law: &str, got: f64, expected: f64, tolerance: f64) {
    assert!(
        (got - expected).abs() <= tolerance,
        "law: {law}: expected {expected:e}, got {got:e}, tolerance {tolerance:e}"
    );
}

#[test]
fn the_helper_can_fail() {
    for off in [-0.2, 0.2] {
        assert!(std::panic::catch_unwind(|| near("", 1.0 + off, 1.0, 0.1)).is_err());
    }
    near("", 1.05, 1.0, 0.1);
}

fn cuboid(sides: [f64; 3]) -> ConvexPolyhedron {
    ConvexPolyhedron::cuboid(Vector::from(sides)).expect("a cuboid")
}

fn rounded(core: &ConvexPolyhedron, radius: f64) -> ConvexPolyhedron {
    ConvexPolyhedron::of_rounded(core.clone(), radius).expect("a rounded body")
}

/// Vertices of the core at a pose, and the radius.
fn swept(body: &ConvexPolyhedron, pose: &Pose) -> (Vec<Point>, f64) {
    let (of, radius) = match (body.rounded(), body.sphere()) {
        (Some(r), _) => (r.core.vertices().to_vec(), r.radius),
        (None, Some(s)) => (vec![s.centre], s.radius),
        (None, None) => (body.vertices().to_vec(), 0.0),
    };
    (of.iter().map(|v| pose * v).collect(), radius)
}

/// The gap between two bodies as seen along a direction from A to B: never more than the distance.
fn seen(a: &(Vec<Point>, f64), b: &(Vec<Point>, f64), axis: &Vector) -> f64 {
    let low = b.0.iter().map(|p| axis.dot(&p.coords)).fold(f64::INFINITY, f64::min);
    let high = a.0.iter().map(|p| axis.dot(&p.coords)).fold(f64::NEG_INFINITY, f64::max);
    low - high - a.1 - b.1
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
    match kind % 7 {
        6 => ConvexPolyhedron::ball(0.004),
        5 => turned,
        n => {
            let found = rounded_within(&turned, 0.1 + 0.18 * n as f64).expect("a core");
            rounded(&found.core, found.radius)
        }
    }
}

/// Law: the first contact to be found has the distance of the bodies for its gap. The points on
/// both bodies are the gap apart along the normal, and seen along the normal the bodies are
/// as far apart: no other points are nearer. Beside it are points that are no deeper.
#[test]
fn gaps_normals_and_points_are_exact() {
    let mut rng = stream(11, "rounded pairs");
    let (mut contacts, mut many, mut none, mut leaning) = (0, 0, 0, 0);
    for n in 0..3000 {
        let kind = n % 7;
        let a = body(&mut rng, if kind > 4 { n / 7 % 5 } else { kind });
        let b = body(&mut rng, n / 7);
        let pose_a = Pose::from_parts(Vector::new(0.3, -0.1, 0.05).into(), rotation(&mut rng));
        // Every fifth pair lies flat, or nearly: turned alike.
        let mut pose_b = Pose::from_parts(Vector::zeros().into(), rotation(&mut rng));
        if n % 5 == 0 {
            let lean = Vector::new(uniform(&mut rng), uniform(&mut rng), 0.0) * 0.02;
            pose_b.rotation = UnitQuaternion::from_scaled_axis(lean) * pose_a.rotation;
        }
        let way = rotation(&mut rng) * Vector::x();
        pose_b.translation.vector = pose_a.translation.vector + way * 0.03;
        // Brought to a gap from well inside the margin to outside.
        let want = -1e-4 + 8e-4 * uniform(&mut rng);
        for _ in 0..60 {
            let found = crate::measure::separation(
                &crate::measure::WorldHull::new(&a, &pose_a),
                &crate::measure::WorldHull::new(&b, &pose_b),
            );
            pose_b.translation.vector -= found.axis * (found.gap - want);
        }
        let exact = crate::measure::separation(
            &crate::measure::WorldHull::new(&a, &pose_a),
            &crate::measure::WorldHull::new(&b, &pose_b),
        );
        let settings = ProbeSettings { portable: n % 2 == 0, ..Default::default() };
        let mut pair = HullPair::new(&a, &b, settings).expect("a pair");
        let points: Vec<ProbePoint> = pair.step(&pose_a, &pose_b);
        let case = format!("case {n}");
        let margin = settings.speculative_margin;
        let (of_a, of_b) = (swept(&a, &pose_a), swept(&b, &pose_b));
        let flat = FLAT * (of_a.1 + of_b.1 + 1e-3);
        let Some(deepest) = points.iter().min_by(|p, q| p.gap.total_cmp(&q.gap)) else {
            none += 1;
            assert!(
                exact.gap > margin - ROUNDING - flat,
                "{case}, law: a contact at {} m",
                exact.gap
            );
            continue;
        };
        contacts += 1;
        many += i32::from(points.len() > 1);
        near(&format!("{case}: gap, m"), deepest.gap, exact.gap, ROUNDING + flat);
        let axis = -deepest.normal;
        near(&format!("{case}: unit normal"), axis.norm(), 1.0, 1e-6);
        // A face that touches stands for axes up to 0.01 rad from its normal; along it, what lies
        // beside the face is nearer by that share of the bodies' size.
        let lean = (axis - exact.axis).norm();
        assert!(lean < 0.0101, "{case}, law: the normal leans by {lean} rad");
        let slack = 4e-8 + flat + 0.02 * lean;
        near(&format!("{case}: seen along it, m"), seen(&of_a, &of_b, &axis), exact.gap, slack);
        leaning += i32::from(lean > 1e-5);
        for point in &points {
            assert!(point.gap >= deepest.gap, "law: none deeper");
            let between = (point.on_a - point.on_b).dot(&point.normal);
            near(&format!("{case}: the points are the gap apart, m"), between, point.gap, 4e-8);
            let across = (point.on_a - point.on_b) - point.normal * between;
            near(&format!("{case}: along the normal, m"), across.norm(), 0.0, 4e-8);
            // Points lie on the surfaces: a ball's radius from the cores, those of a face beside
            // the closest point by up to its lean beyond.
            for (at, (vertices, radius), out) in
                [(point.on_a, &of_a, axis), (point.on_b, &of_b, -axis)]
            {
                let high = vertices.iter().map(|p| out.dot(&p.coords)).fold(f64::MIN, f64::max);
                let above = out.dot(&at) - high - radius;
                let lean = if point.gap > deepest.gap + 1e-9 { 2e-3 } else { 5e-5 };
                assert!(
                    above <= 1e-7 + lean * 0.02,
                    "{case}, law: on the surface, {above} m above"
                );
            }
        }
    }
    println!("{contacts} contacts, {many} of several points, {none} without, {leaning} lean");
    assert!(leaning < contacts / 10, "law: few normals lean, {leaning} of {contacts}");
    assert!(contacts > 1500 && many > 150 && none > 300, "{contacts} {many} {none}");
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

fn world(pair: PairCoefficients, gravity: Vector, native: NativeSettings) -> BulletBackend {
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

fn floor() -> Body {
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
    let run = |threads: u32, portable: bool| {
        let native = NativeSettings {
            threads: Some(threads),
            may_leave_threads: false,
            portable,
            ..Default::default()
        };
        let pair = PairCoefficients { friction: 0.5, restitution: 0.3 };
        let mut world = world(pair, Vector::new(0.0, 0.0, -9.81), native);
        world.add(&floor()).expect("added");
        let mut rng = stream(5, "gravel");
        let mut masses = Vec::new();
        for n in 0..150 {
            let place = Vector::new(
                0.018 * f64::from(n % 5) + 1e-3 * uniform(&mut rng),
                0.018 * f64::from(n / 5 % 5) + 1e-3 * uniform(&mut rng),
                0.012 + 0.018 * f64::from(n / 25),
            );
            let shape = body(&mut rng, n as usize % 5);
            let grain = free(&shape, place, rotation(&mut rng));
            let Motion::Free { mass, .. } = grain.motion else { panic!("free") };
            masses.push(mass);
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
                    .zip(&masses)
                    .map(|(s, m)| {
                        let s = s.expect("a grain");
                        let speed = s.linear_velocity.norm_squared() / 2.0;
                        m * (9.81 * (s.pose.translation.z + 0.1) + speed)
                    })
                    .sum();
                assert!(now <= energy * (1.0 + 1e-6), "law: none is won, {energy} then {now} J");
                energy = now;
            }
        }
        states
    };
    let alone = run(1, false);
    let there = alone.iter().flatten().skip(1);
    assert!(there.clone().all(|s| s.pose.translation.z > 0.0), "law: the floor holds");
    let moving = there.filter(|s| s.linear_velocity.norm() > 0.01).count();
    assert!(moving < 5, "law: after two seconds they lie, {moving} move");
    assert!(alone == run(3, false), "law: threads change no bit");
    assert!(alone == run(2, true), "law: instructions change no bit");
}

/// Law: a world that goes on from another's has its contacts with their impulses.
#[test]
fn remembered_contacts_go_on() {
    let _turn = shared_turn();
    let pair = PairCoefficients { friction: 0.5, restitution: 0.0 };
    let new = || world(pair, Vector::new(1.0, 0.0, -9.81), NativeSettings::default());
    let shape = rounded(&cuboid([0.008, 0.006, 0.004]), 0.001);
    // On a face, and on an edge, about which it falls over.
    for (at, lean, points) in [(0.0, 0.0, 4), (0.1, 0.6, 2)] {
        let turn = UnitQuaternion::from_euler_angles(0.0, lean, 0.0);
        let mut probe = free(&shape, Vector::zeros(), turn);
        let low = probe.shape.heights(&probe.state.pose).0;
        probe.state.pose.translation.vector = Vector::new(at, 0.0, -low);
        let mut first = new();
        first.add(&floor()).expect("added");
        let id = first.add(&probe).expect("added");
        for _ in 0..10 {
            first.step().expect("a step");
        }
        let (mut contacts, state) = (Vec::new(), first.read_body(id).expect("it is there"));
        first.remember(&mut contacts);
        assert_eq!(contacts.len(), points, "law: points of a face, of an edge");
        let mut second = new();
        second.add(&floor()).expect("added");
        let again = second.add(&Body { state, ..probe.clone() }).expect("added");
        second.recall(&contacts).expect("recalled");
        for _ in 0..20 {
            first.step().expect("a step");
            second.step().expect("a step");
        }
        let one = first.read_body(id).expect("there").pose.translation.vector;
        let two = second.read_body(again).expect("there").pose.translation.vector;
        near("it goes on as if there were one world, m", (one - two).norm(), 0.0, 2e-8);
    }
}

#[test]
fn what_cannot_be_rounded_is_refused() {
    let _turn = shared_turn();
    let pair = PairCoefficients { friction: 0.5, restitution: 0.0 };
    let mut world = world(pair, Vector::zeros(), NativeSettings::default());
    let flat = flat(&cuboid([0.01; 3]));
    for radius in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let added = world.world.pin_mut().add_rounded(
            &flat.coordinates,
            &flat.face_starts,
            &flat.face_vertices,
            radius,
        );
        let said = added.expect_err("refused").what().to_owned();
        assert!(said.contains("radius of a rounded"), "law: it says so, got {said}");
    }
}
