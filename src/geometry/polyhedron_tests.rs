//! What a convex polyhedron must be, and what is refused.

use super::*;
use crate::geometry::testing::near;

fn cube() -> ConvexPolyhedron {
    ConvexPolyhedron::cuboid(Vector::repeat(2.0)).unwrap()
}

/// The fault of a unit cube after a change to its vertices and faces.
fn fault(change: impl Fn(&mut Vec<Point>, &mut Vec<Vec<u32>>)) -> PolyhedronError {
    let (mut vertices, mut faces) = (cube().vertices().to_vec(), cube().faces().to_vec());
    change(&mut vertices, &mut faces);
    ConvexPolyhedron::new(vertices, faces).expect_err("the change must be noticed")
}

#[test]
fn a_cube_is_as_it_should_be() {
    let cube = cube();
    cube.sanity_check().unwrap();
    let (v, e, f) = (cube.vertices().len(), cube.edges().len(), cube.faces().len());
    assert_eq!((v, e, f), (8, 12, 6), "vertices, edges and faces of a cube");
    near("volume of a cube of side 2", cube.signed_volume(), 8.0, 1e-14);
    near("half diagonal", cube.radius_about_origin(), 3.0_f64.sqrt(), 1e-15);
    let (low, high) = cube.bounding_box();
    assert_eq!((low, high), (Point::new(-1.0, -1.0, -1.0), Point::new(1.0, 1.0, 1.0)));
    let sphere = std::f64::consts::FRAC_PI_6 * cube.equivalent_diameter().powi(3);
    near("volume of the equivalent sphere", sphere, 8.0, 1e-13);
    for face in 0..f {
        let (normal, offset) = cube.plane(face).unwrap();
        near("normals are unit vectors", normal.norm(), 1.0, 1e-15);
        near("distance of a side from the centre", offset, 1.0, 1e-15);
    }
}

#[test]
fn too_small() {
    let e = fault(|vertices, _| vertices.truncate(3));
    assert_eq!(e, PolyhedronError::TooSmall { vertices: 3, faces: 6 });
    let e = fault(|_, faces| faces.truncate(3));
    assert_eq!(e, PolyhedronError::TooSmall { vertices: 8, faces: 3 });
}

#[test]
fn not_finite() {
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let e = fault(|vertices, _| vertices[5].y = bad);
        assert_eq!(e, PolyhedronError::NotFinite(5), "coordinate {bad}");
    }
}

#[test]
fn bad_face() {
    let is_face_2 = |e: &PolyhedronError| matches!(e, PolyhedronError::BadFace { face: 2, .. });
    let e = fault(|_, faces| faces[2].truncate(2));
    assert!(is_face_2(&e), "two corners: {e}");
    let e = fault(|_, faces| faces[2][1] = 8);
    assert!(is_face_2(&e), "a vertex that is not there: {e}");
    let e = fault(|_, faces| faces[2][1] = faces[2][3]);
    assert!(is_face_2(&e), "a corner twice: {e}");
    // All corners of one side fall together: its face has no area.
    let e = fault(|vertices, faces| {
        for &corner in &faces[0] {
            vertices[corner as usize] = Point::new(0.0, 0.0, -1.0);
        }
    });
    assert!(matches!(e, PolyhedronError::BadFace { face: 0, .. }), "no area: {e}");
}

/// Law: every vertex is in a face, wherever it lies.
#[test]
fn a_vertex_in_no_face() {
    for place in [Point::origin(), Point::new(1.0, 1.0, 1.0), Point::new(9.0, 0.0, 0.0)] {
        let e = fault(|vertices, _| vertices.push(place));
        assert_eq!(e, PolyhedronError::Unused(8), "at {place}");
        assert_eq!(e.to_string(), "vertex 8 is in no face");
    }
}

#[test]
fn not_closed() {
    let e = fault(|_, faces| drop(faces.pop()));
    assert!(matches!(e, PolyhedronError::NotClosed { .. }), "a side is missing: {e}");
    let e = fault(|_, faces| faces[3].reverse());
    assert!(matches!(e, PolyhedronError::NotClosed { .. }), "one side turned round: {e}");
    let e = fault(|_, faces| faces.push(faces[0].clone()));
    assert!(matches!(e, PolyhedronError::NotClosed { .. }), "a side twice: {e}");
}

#[test]
fn not_convex() {
    let e = fault(|vertices, _| vertices[6] = Point::new(-0.5, -0.5, -0.5));
    assert!(matches!(e, PolyhedronError::NotConvex { .. }), "a dented corner: {e}");
    let e = fault(|_, faces| faces.iter_mut().for_each(|f| f.reverse()));
    assert!(matches!(e, PolyhedronError::NotConvex { .. }), "inside out: {e}");
    // The tolerance is 1e-5 of the radius √3: errors beyond it count, rounding does not.
    let e = fault(|vertices, _| vertices[6].z += 1e-4);
    assert!(matches!(e, PolyhedronError::NotConvex { .. }), "bent by 1e-4: {e}");
    let mut bent = cube();
    bent.vertices[6].z += 1e-6;
    bent.sanity_check().expect("a corner off by 1e-6 is rounding");
}

#[test]
fn no_volume() {
    // A flat two-sided square, each side cut into two: closed, nothing in
    // front of any face, but nothing inside either.
    let corners = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)];
    let vertices = corners.iter().map(|&(x, y)| Point::new(x, y, 0.0)).collect();
    let faces = vec![vec![0, 1, 2], vec![0, 2, 3], vec![0, 3, 1], vec![1, 3, 2]];
    let e = ConvexPolyhedron::new(vertices, faces).unwrap_err();
    assert_eq!(e, PolyhedronError::NoVolume(0.0));
}

#[test]
fn reading_a_file_checks_too() {
    let text = serde_json::to_string(&cube()).unwrap();
    let back: ConvexPolyhedron = serde_json::from_str(&text).unwrap();
    assert_eq!(back, cube(), "what is written can be read back");
    let open = text.replacen("[3,2,1,0],", "", 1);
    assert_ne!(open, text, "the test takes a side away");
    let error = serde_json::from_str::<ConvexPolyhedron>(&open).unwrap_err().to_string();
    assert!(error.contains("not closed"), "error names the fault: {error}");
}

#[test]
fn moving_and_scaling_change_the_volume_as_they_should() {
    let pose = Pose::from_parts(
        nalgebra::Translation3::new(5.0, -3.0, 1.0),
        nalgebra::UnitQuaternion::from_euler_angles(0.3, 1.0, -2.0),
    );
    let moved = cube().transformed(&pose);
    moved.sanity_check().unwrap();
    near("a motion keeps the volume", moved.signed_volume(), 8.0, 1e-12);
    let scaled = cube().scaled(0.5);
    scaled.sanity_check().unwrap();
    near("volume goes with the cube of lengths", scaled.signed_volume(), 1.0, 1e-14);
    for factor in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(std::panic::catch_unwind(|| cube().scaled(factor)).is_err(), "by {factor}");
    }
}

#[test]
fn prisms_need_a_convex_polygon_and_a_positive_height() {
    let hexagon: Vec<(f64, f64)> =
        (0..6).map(|k| (f64::from(k) * std::f64::consts::FRAC_PI_3).sin_cos()).collect();
    // sin first runs clockwise: inside out.
    assert!(ConvexPolyhedron::prism(&hexagon, 0.0, 1.0).is_err(), "clockwise polygon");
    let turned: Vec<(f64, f64)> = hexagon.iter().map(|&(s, c)| (c, s)).collect();
    let prism = ConvexPolyhedron::prism(&turned, 0.0, 2.0).unwrap();
    prism.sanity_check().unwrap();
    near("volume of a hexagonal prism", prism.signed_volume(), 3.0 * 3.0_f64.sqrt(), 1e-13);
    assert!(ConvexPolyhedron::prism(&turned, 1.0, 0.0).is_err(), "top below bottom");
    for side in [0.0, -1.0, f64::NAN] {
        let sides = Vector::new(1.0, side, 1.0);
        assert!(ConvexPolyhedron::cuboid(sides).is_err(), "a cuboid with a side of {side}");
    }
}
