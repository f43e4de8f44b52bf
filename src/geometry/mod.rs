//! Poses, convex polyhedra, rounded or not, and spheres, and their exact mass properties.
//!
//! Everything here is pure geometry in SI units: it knows nothing of grains,
//! apparatus or physics engines.

mod convex;
mod hull;
mod joined;
mod mass;
mod moments;
mod outline;
mod polyhedron;
#[cfg(test)]
mod rounded_tests;
mod rounding;
mod sphere;
#[cfg(test)]
pub(crate) mod testing;

pub(crate) use convex::{cut, edges_of, enclosed_volume, loop_of, used, volume_of_loops};
pub(crate) use hull::{Hull, ROUNDINGS, convex_hull, hull};
pub(crate) use joined::{FLATNESS, joined_polyhedron};
pub use mass::{MassProperties, PrincipalFrame};
pub use polyhedron::{ConvexPolyhedron, PolyhedronError, Rounded};
pub use rounding::{eroded, inner_radius, rounded_within};
pub use sphere::Sphere;

/// Position and orientation of a rigid body: maps body coordinates to world
/// coordinates, translation in metres.
pub type Pose = nalgebra::Isometry3<f64>;

/// A point in metres.
pub type Point = nalgebra::Point3<f64>;

/// A vector; its unit is that of the quantity it holds.
pub type Vector = nalgebra::Vector3<f64>;
