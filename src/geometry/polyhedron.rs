//! Closed convex polyhedra with explicit faces, some of which stand for rounded bodies.

// A rounded polyhedron has a polyhedron as its core, and a polyhedron may stand for it.
mod rounded;

use std::{collections::HashSet, sync::Arc};

use serde::{Deserialize, Serialize};

use super::{
    Point, Pose, Sphere, Vector, convex::mean, edges_of, enclosed_volume, sphere::unit_mesh,
};

pub use rounded::Rounded;
pub(super) use rounded::{angle, faces_about, normals};

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
    /// A coordinate of the vertex with this index is NaN or infinite.
    #[error("vertex {0} has a coordinate that is not a finite number")]
    NotFinite(usize),
    /// A face has fewer than three corners, repeats one, or names a vertex that is not there.
    #[error("face {face} is malformed: {reason}")]
    BadFace {
        /// Index of the face.
        face: usize,
        /// What is wrong with it.
        reason: String,
    },
    /// The vertex with this index is in no face.
    #[error("vertex {0} is in no face")]
    Unused(usize),
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
    /// The radius of a sphere is not a positive number, or its centre is not finite.
    #[error(
        "the radius of a sphere is {radius_m} m and its centre {centre_m:?} m: the radius must be \
         positive, all must be finite"
    )]
    BadSphere {
        /// Radius in metres.
        radius_m: f64,
        /// Centre in metres.
        centre_m: [f64; 3],
    },
    /// The ball that rounds a polyhedron has no positive radius (m), or its core is rounded itself.
    #[error("the radius of the ball is {0} m: it must be positive, its core have corners")]
    BadRounding(f64),
    /// No convex mesh of a rounded polyhedron's surface can be made in double precision.
    #[error("no mesh can be made of it: rounding errors fold its surface, or it is too large")]
    NoMesh,
    /// The enclosed signed volume (m³) is zero or negative.
    #[error("the enclosed volume is {0:e} m³, it must be positive")]
    NoVolume(f64),
}

/// A closed convex polyhedron: vertices in metres, faces as loops of vertex
/// indices, counter-clockwise seen from outside.
///
/// Every value of this type has passed [`ConvexPolyhedron::new`]'s checks:
/// closed surface, every vertex in a face, outward faces, convex within rounding, positive volume.
///
/// A polyhedron may stand for a [`Sphere`]: then its vertices lie on the sphere, lengths, volumes
/// and moments are the sphere's, and only vertices, faces and triangles are those of a mesh. The
/// same for a [`Rounded`] polyhedron.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Raw", into = "Raw")]
pub struct ConvexPolyhedron {
    vertices: Vec<Point>,
    faces: Arc<Vec<Vec<u32>>>,
    sphere: Option<Sphere>,
    rounded: Option<Arc<Rounded>>,
}

/// The unchecked form in which polyhedra are read from and written to files.
#[derive(Serialize, Deserialize)]
struct Raw {
    vertices_m: Vec<Point>,
    faces: Vec<Vec<u32>>,
    /// Centre and radius of a sphere, from which it is read; vertices and faces are for others.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    sphere_m: Option<(Point, f64)>,
    /// Core and radius of a rounded polyhedron; vertices and faces are those of its mesh.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    rounded_m: Option<(Box<Raw>, f64)>,
}

impl TryFrom<Raw> for ConvexPolyhedron {
    type Error = PolyhedronError;
    fn try_from(raw: Raw) -> Result<Self, PolyhedronError> {
        if let Some((centre, radius)) = raw.sphere_m {
            return Self::of_sphere(Sphere { centre, radius });
        }
        let mut polyhedron = Self::new(raw.vertices_m, raw.faces)?;
        if let Some((core, radius)) = raw.rounded_m {
            polyhedron.rounded = Some(Arc::new(checked(Self::try_from(*core)?, radius)?));
        }
        Ok(polyhedron)
    }
}

/// A rounded polyhedron with a radius in m, where it can be one.
pub(super) fn checked(core: ConvexPolyhedron, radius: f64) -> Result<Rounded, PolyhedronError> {
    let sharp = core.sphere.is_none() && core.rounded.is_none();
    let good = sharp && radius.is_finite() && radius > 0.0;
    let rounded = good.then_some(Rounded { core, radius });
    rounded.ok_or(PolyhedronError::BadRounding(radius))
}

impl From<ConvexPolyhedron> for Raw {
    fn from(p: ConvexPolyhedron) -> Self {
        Raw {
            vertices_m: p.vertices,
            faces: Arc::unwrap_or_clone(p.faces),
            sphere_m: p.sphere.map(|s| (s.centre, s.radius)),
            rounded_m: p.rounded.map(|r| (Box::new(r.core.clone().into()), r.radius)),
        }
    }
}

impl ConvexPolyhedron {
    /// Builds a polyhedron from vertices (metres) and faces (vertex indices, counter-clockwise seen
    /// from outside), checking closedness, convexity and positive volume.
    ///
    /// # Errors
    /// The first fault found, as a [`PolyhedronError`].
    pub fn new(vertices: Vec<Point>, faces: Vec<Vec<u32>>) -> Result<Self, PolyhedronError> {
        let polyhedron = Self { vertices, faces: Arc::new(faces), sphere: None, rounded: None };
        polyhedron.sanity_check()?;
        Ok(polyhedron)
    }

    /// A sphere.
    ///
    /// # Errors
    /// When its centre is not finite or its radius not positive.
    pub fn of_sphere(sphere: Sphere) -> Result<Self, PolyhedronError> {
        let Sphere { centre, radius } = sphere;
        if !(radius.is_finite() && radius > 0.0 && centre.iter().all(|c| c.is_finite())) {
            let centre_m = centre.coords.into();
            return Err(PolyhedronError::BadSphere { radius_m: radius, centre_m });
        }
        let (vertices, faces) = unit_mesh();
        let vertices = vertices.iter().map(|v| centre + v.coords * radius).collect();
        Ok(Self { vertices, faces: Arc::clone(faces), sphere: Some(sphere), rounded: None })
    }

    /// A sphere about the origin.
    ///
    /// # Panics
    /// When the radius in m is not positive and finite.
    pub fn ball(radius: f64) -> Self {
        let ball = Self::of_sphere(Sphere { centre: Point::origin(), radius });
        ball.unwrap_or_else(|error| panic!("{error}"))
    }

    /// The sphere that the polyhedron stands for, if any.
    pub fn sphere(&self) -> Option<Sphere> {
        self.sphere
    }

    /// The same mesh, standing for a rounded polyhedron.
    pub(super) fn standing_for(self, rounded: Rounded) -> Self {
        Self { rounded: Some(Arc::new(rounded)), ..self }
    }

    /// The rounded polyhedron that the polyhedron stands for, if any.
    pub fn rounded(&self) -> Option<&Rounded> {
        self.rounded.as_deref()
    }

    /// The core of a rounded polyhedron, and the radius in m of the ball that sweeps it; otherwise
    /// the polyhedron itself, and 0.
    pub fn core(&self) -> (&Self, f64) {
        self.rounded().map_or((self, 0.0), |rounded| (&rounded.core, rounded.radius))
    }

    /// Checks every invariant of the type; `new` calls it, tests call it again on what they made.
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
            return Err(PolyhedronError::NotFinite(vertex));
        }
        self.check_faces()?;
        self.check_closed()?;
        self.check_convex()?;
        let volume = self.signed_volume();
        if volume <= 0.0 { Err(PolyhedronError::NoVolume(volume)) } else { Ok(()) }
    }

    fn check_faces(&self) -> Result<(), PolyhedronError> {
        let mut in_a_face = vec![false; self.vertices.len()];
        for (face, corners) in self.faces.iter().enumerate() {
            let fault = |reason: String| Err(PolyhedronError::BadFace { face, reason });
            if corners.len() < 3 {
                return fault(format!("it needs at least 3 corners, and has {}", corners.len()));
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
            corners.iter().for_each(|&c| in_a_face[c as usize] = true);
        }
        match in_a_face.iter().position(|used| !used) {
            Some(vertex) => Err(PolyhedronError::Unused(vertex)),
            None => Ok(()),
        }
    }

    fn check_closed(&self) -> Result<(), PolyhedronError> {
        let mut seen = HashSet::new();
        let twice = self.directed_edges().find(|&(_, from, to)| !seen.insert((from, to)));
        let open = || self.directed_edges().find(|&(_, from, to)| !seen.contains(&(to, from)));
        match twice.or_else(open) {
            Some((face, from, to)) => Err(PolyhedronError::NotClosed { face, from, to }),
            None => Ok(()),
        }
    }

    fn check_convex(&self) -> Result<(), PolyhedronError> {
        let centre = mean(&self.vertices);
        let radius = self.vertices.iter().map(|v| (v.coords - centre).norm()).fold(0.0, f64::max);
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
        let faces = self.faces.iter().enumerate();
        faces.flat_map(|(face, corners)| edges_of(corners).map(move |(a, b)| (face, a, b)))
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
    /// order of the faces that run along them from the lower to the higher.
    pub fn edges(&self) -> Vec<(u32, u32)> {
        self.directed_edges().filter(|(_, a, b)| a < b).map(|(_, a, b)| (a, b)).collect()
    }

    /// Plane of a face as (outward unit normal, offset in metres) such that
    /// `normal · x = offset` on the face; `None` for a face without area.
    ///
    /// The normal is Newell's, an area-weighted mean over all corners, which is insensitive to a
    /// pair of corners that nearly coincide (Sutherland, Sproull and Schumacker 1974, "A
    /// characterization of ten hidden-surface algorithms").
    pub fn plane(&self, face: usize) -> Option<(Vector, f64)> {
        let corners = &self.faces[face];
        let origin = self.vertices[corners[0] as usize];
        let mut normal = Vector::zeros();
        let mut mean = Vector::zeros();
        for (a, b) in edges_of(corners) {
            let [a, b] = [a, b].map(|c| self.vertices[c as usize] - origin);
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
    /// outward faces. Of a sphere or a rounded polyhedron its volume.
    pub fn signed_volume(&self) -> f64 {
        if let Some(sphere) = self.sphere {
            return sphere.volume();
        }
        if let Some(rounded) = &self.rounded {
            return rounded.volume();
        }
        enclosed_volume(&self.vertices, &self.faces)
    }

    /// Surface in m²; of a sphere or a rounded polyhedron its own.
    pub fn surface(&self) -> f64 {
        if let Some(sphere) = self.sphere {
            return sphere.surface();
        }
        if let Some(rounded) = &self.rounded {
            return rounded.surface();
        }
        self.triangles().map(|[a, b, c]| (b - a).cross(&(c - a)).norm() / 2.0).sum()
    }

    /// Surface triangles, each face cut as a fan, counter-clockwise seen from outside.
    pub fn triangles(&self) -> impl Iterator<Item = [Point; 3]> + '_ {
        self.faces.iter().flat_map(move |corners| {
            (1..corners.len() - 1).map(move |i| {
                [corners[0], corners[i], corners[i + 1]].map(|c| self.vertices[c as usize])
            })
        })
    }

    /// Radius in metres of the smallest sphere about the body origin that holds the polyhedron.
    pub fn radius_about_origin(&self) -> f64 {
        if let Some(sphere) = self.sphere {
            return sphere.centre.coords.norm() + sphere.radius;
        }
        let (core, ball) = self.core();
        core.vertices.iter().map(|v| v.coords.norm()).fold(0.0, f64::max) + ball
    }

    /// Lowest and highest corner of the axis-aligned bounding box, in metres.
    pub fn bounding_box(&self) -> (Point, Point) {
        if let Some(Sphere { centre, radius }) = self.sphere {
            return (centre - Vector::repeat(radius), centre + Vector::repeat(radius));
        }
        if let Some(rounded) = &self.rounded {
            let (low, high) = rounded.core.bounding_box();
            let reach = Vector::repeat(rounded.radius);
            return (low - reach, high + reach);
        }
        let first = self.vertices[0];
        self.vertices.iter().fold((first, first), |(lo, hi), v| (lo.inf(v), hi.sup(v)))
    }

    /// Lowest and highest point along z at a pose, in metres.
    pub fn heights(&self, pose: &Pose) -> (f64, f64) {
        if let Some(Sphere { centre, radius }) = self.sphere {
            let z = (pose * centre).z;
            return (z - radius, z + radius);
        }
        if let Some(rounded) = &self.rounded {
            let (low, high) = rounded.core.heights(pose);
            return (low - rounded.radius, high + rounded.radius);
        }
        let heights = self.vertices.iter().map(|v| (pose * v).z);
        heights.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), z| (low.min(z), high.max(z)))
    }

    /// Diameter in metres of the sphere of the same volume.
    pub fn equivalent_diameter(&self) -> f64 {
        if let Some(sphere) = self.sphere {
            return 2.0 * sphere.radius;
        }
        (6.0 * self.signed_volume() / std::f64::consts::PI).cbrt()
    }

    /// The same polyhedron moved by a pose.
    pub fn transformed(&self, pose: &Pose) -> Self {
        self.mapped(&|point: Point| pose * point, 1.0)
    }

    /// The same polyhedron with all lengths about the origin multiplied by a positive factor.
    ///
    /// # Panics
    /// When the factor is not positive and finite.
    pub fn scaled(&self, factor: f64) -> Self {
        assert!(factor.is_finite() && factor > 0.0, "scale factor {factor} must be positive");
        self.mapped(&|point: Point| point * factor, factor)
    }

    /// The same polyhedron with every point mapped, and radii multiplied by a factor.
    fn mapped(&self, to: &impl Fn(Point) -> Point, factor: f64) -> Self {
        let swept =
            |r: &Rounded| Rounded { core: r.core.mapped(to, factor), radius: r.radius * factor };
        let ball = |s: Sphere| Sphere { centre: to(s.centre), radius: s.radius * factor };
        Self {
            vertices: self.vertices.iter().map(|v| to(*v)).collect(),
            faces: Arc::clone(&self.faces),
            sphere: self.sphere.map(ball),
            rounded: self.rounded().map(|r| Arc::new(swept(r))),
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
#[path = "polyhedron_tests.rs"]
mod tests;
