//! Closed convex polyhedra with explicit faces.

use std::collections::HashMap;

use serde::{Deserialize, Serialize};

use super::{Point, Pose, Vector};

/// Largest distance of a vertex from the plane of a face it should lie on or
/// behind, as a fraction of the polyhedron's bounding radius.
///
/// Voronoi cells are computed in double precision at coordinates of the size
/// of their block, about ten grain diameters, so that rounding leaves errors
/// near 1e-14; merging vertices (see `grains`) moves them by up to 1e-6.
const PLANARITY_TOLERANCE: f64 = 1e-5;

/// What is wrong with a would-be convex polyhedron.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PolyhedronError {
    /// Fewer vertices or faces than a tetrahedron has.
    #[error(
        "a polyhedron needs at least 4 vertices and 4 faces, this one has {vertices} and {faces}"
    )]
    TooSmall {
        /// Number of vertices given.
        vertices: usize,
        /// Number of faces given.
        faces: usize,
    },
    /// A coordinate is NaN or infinite.
    #[error("vertex {vertex} has a coordinate that is not a finite number")]
    NotFinite {
        /// Index of the vertex.
        vertex: usize,
    },
    /// A face has fewer than three corners, repeats one, or names a vertex that is not there.
    #[error("face {face} is malformed: {reason}")]
    BadFace {
        /// Index of the face.
        face: usize,
        /// What is wrong with it.
        reason: String,
    },
    /// An edge is not shared by exactly two faces running in opposite directions.
    #[error(
        "the surface is not closed: edge {from}-{to} of face {face} has no opposite edge in another face"
    )]
    NotClosed {
        /// Index of the face that holds the edge.
        face: usize,
        /// First vertex of the edge.
        from: u32,
        /// Second vertex of the edge.
        to: u32,
    },
    /// A vertex lies in front of the plane of a face.
    #[error(
        "not convex, or faces turned inside out: vertex {vertex} lies {distance_m:e} m in front of face {face}"
    )]
    NotConvex {
        /// Index of the face.
        face: usize,
        /// Index of the vertex.
        vertex: usize,
        /// Distance of the vertex in front of the face, in metres.
        distance_m: f64,
    },
    /// The enclosed volume is zero or negative.
    #[error("the enclosed volume is {volume_m3:e} m³, it must be positive")]
    NoVolume {
        /// Signed volume in cubic metres.
        volume_m3: f64,
    },
}

/// A closed convex polyhedron: vertices in metres, faces as loops of vertex
/// indices, counter-clockwise seen from outside.
///
/// Every value of this type has passed [`ConvexPolyhedron::new`]'s checks:
/// closed surface, outward faces, convex within rounding, positive volume.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Raw", into = "Raw")]
pub struct ConvexPolyhedron {
    vertices: Vec<Point>,
    faces: Vec<Vec<u32>>,
}

/// The unchecked form in which polyhedra are read from and written to files.
#[derive(Serialize, Deserialize)]
struct Raw {
    vertices_m: Vec<Point>,
    faces: Vec<Vec<u32>>,
}

impl TryFrom<Raw> for ConvexPolyhedron {
    type Error = PolyhedronError;
    fn try_from(raw: Raw) -> Result<Self, PolyhedronError> {
        Self::new(raw.vertices_m, raw.faces)
    }
}

impl From<ConvexPolyhedron> for Raw {
    fn from(p: ConvexPolyhedron) -> Self {
        Raw { vertices_m: p.vertices, faces: p.faces }
    }
}

impl ConvexPolyhedron {
    /// Builds a polyhedron from vertices (metres) and faces (vertex indices,
    /// counter-clockwise seen from outside), checking closedness, convexity
    /// and positive volume.
    ///
    /// # Errors
    /// The first fault found, as a [`PolyhedronError`].
    pub fn new(vertices: Vec<Point>, faces: Vec<Vec<u32>>) -> Result<Self, PolyhedronError> {
        let polyhedron = Self { vertices, faces };
        polyhedron.sanity_check()?;
        Ok(polyhedron)
    }

    /// Checks every invariant of the type; `new` calls it, tests call it
    /// again on what they made.
    ///
    /// # Errors
    /// The first fault found.
    pub fn sanity_check(&self) -> Result<(), PolyhedronError> {
        if self.vertices.len() < 4 || self.faces.len() < 4 {
            return Err(PolyhedronError::TooSmall {
                vertices: self.vertices.len(),
                faces: self.faces.len(),
            });
        }
        if let Some(vertex) =
            self.vertices.iter().position(|v| !v.coords.iter().all(|c| c.is_finite()))
        {
            return Err(PolyhedronError::NotFinite { vertex });
        }
        self.check_faces()?;
        self.check_closed()?;
        self.check_convex()?;
        let volume_m3 = self.signed_volume();
        if volume_m3 <= 0.0 {
            return Err(PolyhedronError::NoVolume { volume_m3 });
        }
        Ok(())
    }

    fn check_faces(&self) -> Result<(), PolyhedronError> {
        for (face, corners) in self.faces.iter().enumerate() {
            let fault = |reason: String| Err(PolyhedronError::BadFace { face, reason });
            if corners.len() < 3 {
                return fault(format!("it has {} corners, at least 3 are needed", corners.len()));
            }
            if let Some(c) = corners.iter().find(|&&c| c as usize >= self.vertices.len()) {
                return fault(format!(
                    "it names vertex {c}, there are only {}",
                    self.vertices.len()
                ));
            }
            let mut sorted = corners.clone();
            sorted.sort_unstable();
            if sorted.windows(2).any(|w| w[0] == w[1]) {
                return fault("it visits a vertex twice".into());
            }
        }
        Ok(())
    }

    fn check_closed(&self) -> Result<(), PolyhedronError> {
        let mut seen: HashMap<(u32, u32), usize> = HashMap::new();
        for (face, from, to) in self.directed_edges() {
            if seen.insert((from, to), face).is_some() {
                return Err(PolyhedronError::NotClosed { face, from, to });
            }
        }
        for (face, from, to) in self.directed_edges() {
            if !seen.contains_key(&(to, from)) {
                return Err(PolyhedronError::NotClosed { face, from, to });
            }
        }
        Ok(())
    }

    fn check_convex(&self) -> Result<(), PolyhedronError> {
        let centre = self.vertex_average();
        let radius = self.vertices.iter().map(|v| (v - centre).norm()).fold(0.0, f64::max);
        let tolerance = PLANARITY_TOLERANCE * radius;
        for face in 0..self.faces.len() {
            let Some((normal, offset)) = self.plane(face) else {
                return Err(PolyhedronError::BadFace { face, reason: "it has no area".into() });
            };
            for (vertex, v) in self.vertices.iter().enumerate() {
                let distance_m = normal.dot(&v.coords) - offset;
                if distance_m > tolerance {
                    return Err(PolyhedronError::NotConvex { face, vertex, distance_m });
                }
            }
        }
        Ok(())
    }

    fn directed_edges(&self) -> impl Iterator<Item = (usize, u32, u32)> + '_ {
        self.faces.iter().enumerate().flat_map(|(face, corners)| {
            (0..corners.len()).map(move |i| (face, corners[i], corners[(i + 1) % corners.len()]))
        })
    }

    /// Vertices in metres.
    pub fn vertices(&self) -> &[Point] {
        &self.vertices
    }

    /// Faces as loops of vertex indices, counter-clockwise seen from outside.
    pub fn faces(&self) -> &[Vec<u32>] {
        &self.faces
    }

    /// Undirected edges as pairs of vertex indices, lower index first, in the
    /// order in which the faces first meet them.
    pub fn edges(&self) -> Vec<(u32, u32)> {
        self.directed_edges().filter(|(_, a, b)| a < b).map(|(_, a, b)| (a, b)).collect()
    }

    /// Plane of a face as (outward unit normal, offset in metres) such that
    /// `normal · x = offset` on the face; `None` for a face without area.
    ///
    /// The normal is Newell's, an area-weighted mean over all corners, which
    /// is insensitive to a pair of corners that nearly coincide (Sutherland,
    /// Sproull and Schumacker 1974, "A characterization of ten hidden-surface
    /// algorithms").
    pub fn plane(&self, face: usize) -> Option<(Vector, f64)> {
        let corners = &self.faces[face];
        let origin = self.vertices[corners[0] as usize];
        let mut normal = Vector::zeros();
        let mut mean = Vector::zeros();
        for (i, &c) in corners.iter().enumerate() {
            let a = self.vertices[c as usize] - origin;
            let b = self.vertices[corners[(i + 1) % corners.len()] as usize] - origin;
            normal += a.cross(&b);
            mean += a;
        }
        let length = normal.norm();
        if !(length > 0.0) {
            return None;
        }
        let normal = normal / length;
        let mean = origin + mean / corners.len() as f64;
        Some((normal, normal.dot(&mean.coords)))
    }

    /// Signed volume in cubic metres by the divergence theorem; positive for
    /// outward faces.
    pub fn signed_volume(&self) -> f64 {
        let centre = self.vertex_average();
        self.triangles()
            .map(|[a, b, c]| (a - centre).dot(&(b - centre).cross(&(c - centre))) / 6.0)
            .sum()
    }

    /// Surface triangles, each face cut as a fan, counter-clockwise seen from outside.
    pub fn triangles(&self) -> impl Iterator<Item = [Point; 3]> + '_ {
        self.faces.iter().flat_map(move |corners| {
            (1..corners.len() - 1).map(move |i| {
                [corners[0], corners[i], corners[i + 1]].map(|c| self.vertices[c as usize])
            })
        })
    }

    fn vertex_average(&self) -> Point {
        let sum: Vector = self.vertices.iter().map(|v| v.coords).sum();
        Point::from(sum / self.vertices.len() as f64)
    }

    /// Radius in metres of the smallest sphere about the body origin that holds the polyhedron.
    pub fn radius_about_origin(&self) -> f64 {
        self.vertices.iter().map(|v| v.coords.norm()).fold(0.0, f64::max)
    }

    /// Lowest and highest corner of the axis-aligned bounding box, in metres.
    pub fn bounding_box(&self) -> (Point, Point) {
        let first = self.vertices[0];
        self.vertices.iter().fold((first, first), |(lo, hi), v| (lo.inf(v), hi.sup(v)))
    }

    /// Diameter in metres of the sphere of the same volume.
    pub fn equivalent_diameter(&self) -> f64 {
        (6.0 * self.signed_volume() / std::f64::consts::PI).cbrt()
    }

    /// The same polyhedron moved by a pose.
    pub fn transformed(&self, pose: &Pose) -> Self {
        Self {
            vertices: self.vertices.iter().map(|v| pose * v).collect(),
            faces: self.faces.clone(),
        }
    }

    /// The same polyhedron with all lengths about the origin multiplied by a positive factor.
    ///
    /// # Panics
    /// When the factor is not positive and finite.
    pub fn scaled(&self, factor: f64) -> Self {
        assert!(factor.is_finite() && factor > 0.0, "scale factor {factor} must be positive");
        Self {
            vertices: self.vertices.iter().map(|v| v * factor).collect(),
            faces: self.faces.clone(),
        }
    }

    /// A box with the given full side lengths in metres, centred on the origin.
    ///
    /// # Errors
    /// When a side is not a positive finite number.
    pub fn cuboid(sides: Vector) -> Result<Self, PolyhedronError> {
        let h = sides / 2.0;
        Self::prism(&[(-h.x, -h.y), (h.x, -h.y), (h.x, h.y), (-h.x, h.y)], -h.z, h.z)
    }

    /// A right prism over a convex polygon (corners counter-clockwise seen
    /// from above, metres) between the heights `bottom` and `top` in metres.
    ///
    /// # Errors
    /// When the result is no convex polyhedron.
    pub fn prism(polygon: &[(f64, f64)], bottom: f64, top: f64) -> Result<Self, PolyhedronError> {
        let lower = polygon.iter().map(|&(x, y)| Point::new(x, y, bottom)).collect::<Vec<_>>();
        let upper = polygon.iter().map(|&(x, y)| Point::new(x, y, top)).collect::<Vec<_>>();
        Self::frustum(lower, upper)
    }

    /// The polyhedron between two parallel polygons with equally many
    /// corners, both counter-clockwise seen from the side of `upper`: prisms,
    /// frusta and the wedge pieces of funnels and cylinders.
    ///
    /// # Errors
    /// When the result is no convex polyhedron with plane faces.
    pub fn frustum(lower: Vec<Point>, upper: Vec<Point>) -> Result<Self, PolyhedronError> {
        let n = lower.len() as u32;
        let mut faces = vec![(0..n).rev().collect::<Vec<u32>>(), (n..2 * n).collect()];
        for i in 0..n {
            let j = (i + 1) % n;
            faces.push(vec![i, j, n + j, n + i]);
        }
        Self::new(lower.into_iter().chain(upper).collect(), faces)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(law: &str, got: f64, expected: f64, tolerance: f64) {
        assert!(
            (got - expected).abs() <= tolerance,
            "{law}: expected {expected}, got {got}, tolerance {tolerance}"
        );
    }

    #[test]
    fn the_helper_can_fail() {
        for off in [-0.2, 0.2] {
            assert!(std::panic::catch_unwind(|| near("", 1.0 + off, 1.0, 0.1)).is_err());
        }
        near("", 1.05, 1.0, 0.1);
    }

    fn cube() -> ConvexPolyhedron {
        ConvexPolyhedron::cuboid(Vector::repeat(2.0)).unwrap()
    }

    /// The fault of a unit cube after a change to its vertices and faces.
    fn fault(change: impl Fn(&mut Vec<Point>, &mut Vec<Vec<u32>>)) -> PolyhedronError {
        let ConvexPolyhedron { mut vertices, mut faces } = cube();
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
            assert_eq!(e, PolyhedronError::NotFinite { vertex: 5 }, "coordinate {bad}");
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
        assert_eq!(e, PolyhedronError::NoVolume { volume_m3: 0.0 });
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
}
