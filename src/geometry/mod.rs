//! Poses, convex polyhedra and spheres, and their exact mass properties.
//!
//! Everything here is pure geometry in SI units: it knows nothing of grains,
//! apparatus or physics engines.

mod mass;
mod polyhedron;
mod sphere;

pub use mass::{MassProperties, PrincipalFrame};
pub use polyhedron::{ConvexPolyhedron, PolyhedronError};
pub use sphere::Sphere;

/// Position and orientation of a rigid body: maps body coordinates to world
/// coordinates, translation in metres.
pub type Pose = nalgebra::Isometry3<f64>;

/// A point in metres.
pub type Point = nalgebra::Point3<f64>;

/// A vector; its unit is that of the quantity it holds.
pub type Vector = nalgebra::Vector3<f64>;
