//! Rounded polyhedra have the volume, surface and moments that geometry gives them.

use std::f64::consts::PI;

use nalgebra::Matrix3;

use super::{
    ConvexPolyhedron, MassProperties, Point, PolyhedronError, Pose, ROUNDINGS, Rounded, Vector,
    eroded, hull, inner_radius, joined_polyhedron,
    outline::outline,
    rounded_within,
    testing::{flat_plate, near},
};

fn of(core: ConvexPolyhedron, radius: f64) -> ConvexPolyhedron {
    ConvexPolyhedron::of_rounded(core, radius).expect("a rounded polyhedron")
}

fn cuboid(x: f64, y: f64, z: f64) -> ConvexPolyhedron {
    ConvexPolyhedron::cuboid(Vector::new(x, y, z)).expect("a cuboid")
}

/// Hulls of points within a box of 2 × 1.4 × 1, from a linear congruential generator.
fn random_hulls(count: usize) -> Vec<ConvexPolyhedron> {
    let mut state = 7_u64;
    let mut next = move || {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    };
    let mut hulls = Vec::new();
    while hulls.len() < count {
        let points: Vec<Point> = (0..4 + 3 * hulls.len())
            .map(|_| Point::new(2.0 * next() + 0.3, 1.4 * next(), next()))
            .collect();
        let found = hull(&points, usize::MAX, ROUNDINGS[0]).expect("a hull");
        hulls.extend(joined_polyhedron(&found.vertices, &found.triangles));
    }
    hulls
}

#[test]
fn a_cube_s_properties_are_those_of_its_parts() {
    let (a, r): (f64, f64) = (0.8, 0.3);
    let rounded = of(cuboid(a, a, a), r);
    let volume = a.powi(3) + 6.0 * a * a * r + 3.0 * PI * a * r * r + 4.0 / 3.0 * PI * r.powi(3);
    near("volume of a rounded cube", rounded.signed_volume(), volume, 1e-14);
    let surface = 6.0 * a * a + 6.0 * PI * a * r + 4.0 * PI * r * r;
    near("its surface", rounded.rounded().expect("rounded").surface(), surface, 1e-14);
    // ∫x² over it by parts: with h = a/2 and E the mean over a quarter of a disc or an eighth
    // of a ball about a corner.
    let h = a / 2.0;
    let plates =
        2.0 * (((h + r).powi(3) - h.powi(3)) / 3.0) * a * a + 4.0 * (a.powi(3) / 12.0) * a * r;
    // Quarter discs of radius r: area πr²/4, first moment r³/3, second πr⁴/16.
    let (q0, q1, q2) = (PI * r * r / 4.0, r.powi(3) / 3.0, PI * r.powi(4) / 16.0);
    let along = 4.0 * (a.powi(3) / 12.0) * q0;
    let across = 8.0 * a * (h * h * q0 + 2.0 * h * q1 + q2);
    // Eighths of a ball: volume πr³/6, first moment πr⁴/16, second πr⁵/30.
    let (e0, e1, e2) = (PI * r.powi(3) / 6.0, PI * r.powi(4) / 16.0, PI * r.powi(5) / 30.0);
    let corners = 8.0 * (h * h * e0 + 2.0 * h * e1 + e2);
    let square = a.powi(5) / 12.0 + plates + along + across + corners;
    let got = MassProperties::of(&rounded);
    let off = got.inertia_per_density - Matrix3::identity() * (2.0 * square);
    near("moment of inertia 2 ∫x²", off.amax(), 0.0, 1e-14);
    near("centroid", got.centroid.coords.norm(), 0.0, 1e-15);
    // Little radius: the cube; little core: the sphere.
    let got = MassProperties::of(&of(cuboid(1.0, 1.0, 1.0), 1e-9));
    near("the cube's moment", got.inertia_per_density[(0, 0)], 1.0 / 6.0, 1e-8);
    let got = MassProperties::of(&of(cuboid(1e-9, 1e-9, 1e-9), 1.0));
    near("the sphere's volume", got.volume, 4.0 / 3.0 * PI, 1e-8);
    near("the sphere's moment", got.inertia_per_density[(1, 1)], 8.0 / 15.0 * PI, 1e-8);
}

#[test]
fn a_thin_core_makes_a_capsule() {
    let (l, r): (f64, f64) = (1.7, 0.4);
    let rounded = of(cuboid(1e-6, 1e-6, l), r);
    let got = MassProperties::of(&rounded);
    let (rod, ball) = (PI * r * r * l, 4.0 / 3.0 * PI * r.powi(3));
    near("volume", got.volume, rod + ball, 1e-5);
    let along = rod * r * r / 2.0 + ball * 0.4 * r * r;
    near("moment about the axis", got.inertia_per_density[(2, 2)], along, 1e-5);
    let across =
        rod * (l * l / 12.0 + r * r / 4.0) + ball * (0.4 * r * r + l * l / 4.0 + 3.0 / 8.0 * l * r);
    near("moment across", got.inertia_per_density[(0, 0)], across, 1e-5);
}

/// Law: meshes inscribed in a rounded body approach it with the square of their step, in volume,
/// centroid and moments.
#[test]
fn fine_meshes_have_the_properties_of_what_they_stand_for() {
    for (n, core) in random_hulls(6).into_iter().enumerate() {
        let r = 0.1 + 0.07 * n as f64;
        let exact = MassProperties::of(&of(core.clone(), r));
        let rounded = Rounded { core, radius: r };
        let errors = [0.1, 0.05].map(|step| {
            let mesh = outline(&rounded, step).expect("a mesh");
            let got = MassProperties::of(&mesh);
            [
                (exact.volume - got.volume) / exact.volume,
                (exact.centroid - got.centroid).norm(),
                (exact.inertia_per_density - got.inertia_per_density).amax()
                    / exact.inertia_per_density.amax(),
            ]
        });
        let [coarse, fine] = errors;
        near("volume of a mesh of 0.05 rad", fine[0], 0.0, 1e-3);
        assert!(fine[0] > 0.0, "law: it is inscribed");
        near("its centroid", fine[1], 0.0, 3e-4);
        near("its moments", fine[2], 0.0, 2e-3);
        assert!(fine[0] < 0.45 * coarse[0], "law: converges, {} then {}", coarse[0], fine[0]);
        assert!(fine[2] < 0.6 * coarse[2], "law: converges, {} then {}", coarse[2], fine[2]);
    }
}

/// Law (Steiner): the volume of what is swept by r is a polynomial in r, whose slope is the
/// surface.
#[test]
fn volumes_grow_by_the_surface() {
    for core in random_hulls(5) {
        let (r, d) = (0.3, 1e-4);
        let [low, high] =
            [r - d, r + d].map(|radius| Rounded { core: core.clone(), radius }.volume());
        let middle = Rounded { core: core.clone(), radius: r };
        near("dV/dr is the surface", (high - low) / (2.0 * d), middle.surface(), 1e-6);
        let summed = MassProperties::of(&of(core, r)).volume;
        near("corners fill a sphere", summed, middle.volume(), 1e-12);
    }
}

#[test]
fn the_mesh_lies_on_the_body_and_moves_with_it() {
    let turn = nalgebra::UnitQuaternion::from_euler_angles(0.7, -0.4, 2.1);
    let pose = Pose::from_parts(nalgebra::Translation3::new(0.3, -1.0, 2.0), turn);
    for core in random_hulls(5) {
        let body = of(core, 0.2);
        body.sanity_check().expect("a body");
        let moved = body.transformed(&pose).scaled(0.01);
        let (one, other) = (MassProperties::of(&body), MassProperties::of(&moved));
        near("volume", other.volume * 1e6, one.volume, 1e-12 * one.volume);
        let centroid = (pose * one.centroid).coords * 0.01;
        near("centroid", (other.centroid.coords - centroid).norm(), 0.0, 1e-15);
        let r = turn.to_rotation_matrix();
        let turned = r * one.inertia_per_density * r.transpose() * 1e-10;
        near("moments", (other.inertia_per_density - turned).amax(), 0.0, 1e-12 * turned.amax());
        let (low, high) = moved.bounding_box();
        let (mesh_low, mesh_high) = moved
            .vertices()
            .iter()
            .fold((moved.vertices()[0], moved.vertices()[0]), |(l, h), v| (l.inf(v), h.sup(v)));
        let slack = 0.002 * 0.04;
        for k in 0..3 {
            assert!(low[k] <= mesh_low[k] && high[k] >= mesh_high[k], "law: the box holds it");
            near("and is hardly wider", mesh_low[k], low[k], slack);
            near("and is hardly wider", mesh_high[k], high[k], slack);
        }
        let text = serde_json::to_string(&moved).expect("text");
        let back: ConvexPolyhedron = serde_json::from_str(&text).expect("a body");
        assert_eq!(back, moved, "law: it comes back from text to the bit");
    }
}

/// Law: flat plates with finely rounded edges have a mesh. With the first rounding alone the hulls
/// of about a third keep a facet that is turned round.
#[test]
fn flat_plates_with_little_rounding_have_a_mesh() {
    for plate in 0..32 {
        let body = ConvexPolyhedron::of_rounded(flat_plate(plate), 1e-5);
        let got = body.and_then(|body| body.sanity_check());
        assert_eq!(got, Ok(()), "law: plate {plate} has a mesh, expected Ok, got {got:?}");
    }
}

#[test]
fn spheres_inside_are_the_largest() {
    near("of a cuboid", inner_radius(&cuboid(1.0, 2.0, 0.6)), 0.3, 1e-12);
    near("of a rounded one", inner_radius(&of(cuboid(1.0, 2.0, 0.6), 0.1)), 0.4, 1e-12);
    near("of a ball", inner_radius(&ConvexPolyhedron::ball(0.7)), 0.7, 1e-15);
    for body in random_hulls(8) {
        let r = inner_radius(&body);
        // Smallest room that is left just below it, and none just above.
        assert!(eroded(&body, 0.98 * r).is_some(), "law: room for a smaller ball");
        let planes: Vec<_> = (0..body.faces().len()).filter_map(|f| body.plane(f)).collect();
        let inside = |p: &Vector| planes.iter().map(|(n, d)| d - n.dot(p)).fold(1e9, f64::min);
        let core = eroded(&body, 0.98 * r).expect("room");
        let middle = MassProperties::of(&core).centroid.coords;
        assert!(inside(&middle) >= 0.98 * r - 1e-9, "law: the ball fits");
        assert!(eroded(&body, 1.001 * r).is_none(), "law: no room for a larger one");
    }
}

#[test]
fn rounding_within_keeps_the_faces_and_the_inner_sphere() {
    let r = 0.25;
    let cube = rounded_within(&cuboid(1.0, 1.0, 1.0), 0.5).expect("a rounded cube");
    near("radius", cube.radius, r, 1e-12);
    near("roundness", cube.roundness(), 0.5, 1e-9);
    assert_eq!((cube.core.faces().len(), cube.core.vertices().len()), (6, 8), "law: a cube");
    for body in random_hulls(8) {
        for share in [0.02, 0.3, 0.6, 0.9] {
            let rounded = rounded_within(&body, share).expect("a core");
            near("roundness is what was asked for", rounded.roundness(), share, 1e-5);
            let planes: Vec<_> = (0..body.faces().len()).filter_map(|f| body.plane(f)).collect();
            let beyond = rounded
                .core
                .vertices()
                .iter()
                .flat_map(|v| {
                    planes.iter().map(move |(n, d)| n.dot(&v.coords) + rounded.radius - d)
                })
                .fold(f64::MIN, f64::max);
            near("it reaches the planes and no farther", beyond, 0.0, 1e-6);
            let whole = ConvexPolyhedron::of_rounded(rounded.core.clone(), rounded.radius);
            let smaller = whole.expect("a body").signed_volume() / body.signed_volume();
            assert!(smaller < 1.0 && smaller > 0.0, "law: within the body, {smaller}");
        }
    }
}

#[test]
fn what_is_no_rounded_polyhedron_is_refused() {
    let cube = cuboid(1.0, 1.0, 1.0);
    for radius in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let said = ConvexPolyhedron::of_rounded(cube.clone(), radius).expect_err("bad").to_string();
        assert!(said.contains("radius of the ball"), "law: it says so, got {said}");
    }
    // Squares of its coordinates are beyond all numbers.
    let got = ConvexPolyhedron::of_rounded(cube.clone(), 1e200);
    assert_eq!(got, Err(PolyhedronError::NoMesh), "law: no mesh, expected NoMesh, got {got:?}");
    assert!(ConvexPolyhedron::of_rounded(ConvexPolyhedron::ball(1.0), 0.1).is_err());
    assert!(ConvexPolyhedron::of_rounded(of(cube, 0.1), 0.1).is_err());
}
