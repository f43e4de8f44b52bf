//! Hulls hold all points, have the volumes geometry gives them, and lose
//! little where they are made simpler.

use crate::{
    geometry::{ConvexPolyhedron, Hull, Point, ROUNDINGS, Vector, enclosed_volume},
    grains::{
        generate,
        streams::{rotation, stream, uniform},
        tests::{few_grains, near},
    },
};

fn hull(points: &[Point], most_vertices: usize) -> Option<Hull> {
    crate::geometry::hull(points, most_vertices, ROUNDINGS[0])
}

fn volume_of(hull: &Hull) -> f64 {
    enclosed_volume(&hull.vertices, &hull.triangles)
}

/// Closed, by Euler's formula and by edges, and outside of every point.
fn check(hull: &Hull, points: &[Point], tolerance: f64) {
    let shape = ConvexPolyhedron::new(hull.vertices.clone(), hull.triangles.clone())
        .unwrap_or_else(|e| panic!("a hull is a convex polyhedron: {e}"));
    let euler =
        shape.vertices().len() as i64 - shape.edges().len() as i64 + shape.faces().len() as i64;
    assert_eq!(euler, 2, "Euler's formula: vertices - edges + faces");
    for face in 0..shape.faces().len() {
        let (normal, offset) = shape.plane(face).unwrap();
        for (i, point) in points.iter().enumerate() {
            let out = normal.dot(&point.coords) - offset;
            assert!(out <= tolerance, "point {i} is {out:e} m outside of face {face}");
        }
    }
}

fn on_sphere(count: usize, seed: u64) -> Vec<Point> {
    let mut rng = stream(seed, "sphere");
    (0..count).map(|_| Point::from(rotation(&mut rng) * Vector::x() * 0.01)).collect()
}

#[test]
fn a_cube_of_many_points_is_a_cube() {
    // A grid: most points lie on faces, on edges, on lines with each other.
    let n = 7;
    let points: Vec<Point> = (0..n * n * n)
        .map(|i| Point::new((i % n) as f64, (i / n % n) as f64, (i / n / n) as f64) * 0.002)
        .collect();
    let hull = hull(&points, usize::MAX).unwrap();
    check(&hull, &points, 1e-12);
    assert_eq!(hull.vertices.len(), 8, "a cube has 8 vertices: {:?}", hull.vertices);
    near("volume of the cube, m³", volume_of(&hull), 0.012_f64.powi(3), 1e-18);
    assert_eq!(hull.left_out, 0.0, "no point is left out");
}

#[test]
fn hulls_of_grains_are_the_grains() {
    for (i, grain) in generate(&few_grains(), 3).unwrap().grains.iter().enumerate() {
        let points = grain.shape.vertices();
        let hull = hull(points, usize::MAX).unwrap();
        check(&hull, points, 1e-8);
        let law = format!("volume of the hull of grain {i}, m³");
        near(&law, volume_of(&hull), grain.volume, 2e-6 * grain.volume);
    }
}

#[test]
fn random_points_are_held_whatever_they_are() {
    let mut rng = stream(8, "points");
    for count in [4, 5, 8, 30, 300, 3000] {
        // Flattened and coarsely rounded: many coincide or share planes.
        let points: Vec<Point> = (0..count)
            .map(|_| {
                let p = Vector::from_fn(|_, _| (uniform(&mut rng) * 40.0).floor());
                Point::new(p.x, p.y, p.z * 0.1)
            })
            .collect();
        let Some(hull) = hull(&points, usize::MAX) else {
            assert!(count < 8, "{count} points have a hull");
            continue;
        };
        check(&hull, &points, 3e-6);
    }
}

#[test]
fn fewer_vertices_leave_out_little_and_say_how_much() {
    let points = on_sphere(4000, 1);
    let whole = hull(&points, usize::MAX).unwrap();
    // Ten times what counts as on a face: a sliver's plane is less certain.
    check(&whole, &points, 1e-8);
    assert_eq!(whole.vertices.len(), 4000, "every point of a sphere is on the hull");
    let ball = 4.0 / 3.0 * std::f64::consts::PI * 1e-6;
    near("volume of a sphere of many points, m³", volume_of(&whole), ball, 0.005 * ball);
    let mut before = 0.0;
    for most in [12, 24, 64, 128] {
        let fewer = hull(&points, most).unwrap();
        assert!(fewer.vertices.len() <= most, "{} of {most} vertices", fewer.vertices.len());
        // Faces of close points are slivers: their planes are sure to a millionth of the radius.
        check(&fewer, &points, fewer.left_out + 1e-8);
        let share = volume_of(&fewer) / volume_of(&whole);
        assert!(share > before && share < 1.0, "{most} vertices hold {share} of the volume");
        before = share;
        if most == 64 {
            // A sphere's inscribed polyhedron of 64 vertices at best has 91 %.
            assert!(share > 0.85, "64 vertices hold {share} of a sphere");
            assert!(fewer.left_out < 0.0015, "1.5 mm of 10 mm, got {} m", fewer.left_out);
        }
    }
}

#[test]
fn flat_sets_and_too_few_points_have_no_hull() {
    let flat: Vec<Point> = on_sphere(50, 2).iter().map(|p| Point::new(p.x, p.y, 0.003)).collect();
    assert_eq!(hull(&flat, usize::MAX), None, "points of one plane");
    let line: Vec<Point> = (0..9).map(|i| Point::new(f64::from(i), 1.0, 2.0)).collect();
    assert_eq!(hull(&line, usize::MAX), None, "points of one line");
    assert_eq!(hull(&[Point::origin(); 5], usize::MAX), None, "one point, repeated");
    assert_eq!(hull(&[], usize::MAX), None, "no points");
    let wild = [Point::origin(), Point::new(f64::NAN, 0.0, 0.0)];
    assert_eq!(hull(&wild, usize::MAX), None, "no numbers");
}

/// Law: where no hull can be made, the message says what to change of the mesh; how thick a grain
/// must be is judged before.
#[test]
fn a_surface_without_a_hull_is_to_be_simplified() {
    let flat: Vec<Point> = on_sphere(50, 2).iter().map(|p| Point::new(p.x, p.y, 0.003)).collect();
    let surface = super::Surface { vertices: flat, faces: Vec::new(), volume: 1e-9 };
    let spec = super::MeshGrains {
        meshes: Vec::new(),
        mesh_unit: super::MeshUnit::M,
        density_kg_per_m3: 2650.0,
        hull: true,
        split_surfaces: false,
        largest_vertex_count: 64,
        total_mass_g: None,
        sieve_table: Vec::new(),
        count: None,
    };
    let fault = super::shape::convex(&surface, &spec).expect_err("law: points of one plane");
    let got = (fault.message.as_str(), fault.found.as_str(), fault.allowed.as_str());
    let expected = (
        "no convex hull can be made of its vertices",
        "50 vertices",
        "fewer vertices that nearly share a plane; simplify the mesh",
    );
    assert_eq!(got, expected, "law: expected {expected:?}, got {got:?}");
}
