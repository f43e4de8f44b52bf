//! Rounded polyhedra beside each other, sharp ones and spheres: the native contact solver's gaps
//! against those of `measure`, which finds the closest points in another way, and against the
//! supports of both bodies, which prove them.

use nalgebra::UnitQuaternion;
use pluvia::geometry::{ConvexPolyhedron, Point, Pose, Vector, rounded_within};
use pluvia::measure::{WorldHull, separation};
use pluvia::world::bullet::probe::{HullPair, ProbePoint, ProbeSettings};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use crate::near::near;

/// Vertices of hulls, and with them planes, are rounded to single precision; so are normals, gaps
/// and points where a pair keeps them.
const ROUNDING: f64 = 2e-8;
/// Where a face is nearer to the axis than 0.01 rad, gaps are those along its normal.
const FLAT: f64 = 5e-5;

fn uniform(rng: &mut Pcg64Mcg) -> f64 {
    rng.random_range(0.0..1.0)
}

fn rotation(rng: &mut Pcg64Mcg) -> UnitQuaternion<f64> {
    let [a, b, c] = [0, 1, 2].map(|_| std::f64::consts::TAU * uniform(rng));
    UnitQuaternion::from_euler_angles(a, b, c)
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
fn body(rng: &mut Pcg64Mcg, kind: usize) -> ConvexPolyhedron {
    let sides = [0, 1, 2].map(|_| 0.006 + 0.008 * uniform(rng));
    let skew = rotation(rng);
    let cut = ConvexPolyhedron::cuboid(Vector::from(sides)).expect("a cuboid");
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
            ConvexPolyhedron::of_rounded(found.core, found.radius).expect("a rounded body")
        }
    }
}

/// Law: the first contact to be found has the distance of the bodies for its gap. The points on
/// both bodies are the gap apart along the normal, and seen along the normal the bodies are
/// as far apart: no other points are nearer. Beside it are points that are no deeper.
#[test]
#[ignore = "slow: make test-all"]
fn gaps_normals_and_points_are_exact() {
    let mut rng = Pcg64Mcg::seed_from_u64(11);
    let (mut contacts, mut many, mut none, mut leaning) = (0, 0, 0, 0);
    for n in 0..6000 {
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
            let found = separation(&WorldHull::new(&a, &pose_a), &WorldHull::new(&b, &pose_b));
            pose_b.translation.vector -= found.axis * (found.gap - want);
        }
        let exact = separation(&WorldHull::new(&a, &pose_a), &WorldHull::new(&b, &pose_b));
        let settings = ProbeSettings { portable: n % 2 == 0, ..Default::default() };
        let mut pair = HullPair::new(&a, &b, settings).expect("a pair");
        let points: Vec<ProbePoint> = pair.step(&pose_a, &pose_b);
        let case = format!("case {n}");
        let margin = settings.speculative_margin;
        let (of_a, of_b) = (swept(&a, &pose_a), swept(&b, &pose_b));
        let flat = FLAT * (of_a.1 + of_b.1 + 1e-3);
        let Some(deepest) = points.iter().min_by(|p, q| p.gap.total_cmp(&q.gap)) else {
            none += 1;
            let gap = exact.gap;
            assert!(gap > margin - ROUNDING - flat, "{case}, law: a contact at {gap} m");
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
    assert!(leaning < contacts / 4, "law: few normals lean, {leaning} of {contacts}");
    assert!(contacts > 1500 && many > 150 && none > 300, "{contacts} {many} {none}");
}
