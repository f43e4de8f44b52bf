//! Pluvia simulates granular soil as rigid convex polyhedra on the Bullet
//! physics library: how grains pack, pour and settle.
//!
//! The house tour is in `ARCHITECTURE.md`; the user's guide in `README.md`.

pub mod apparatus;
pub mod cli;
pub mod export;
pub mod geometry;
pub mod grains;
pub mod measure;
pub mod paper;
pub mod picture;
pub mod protocol;
pub mod record;
pub mod report;
pub mod scenario;
pub mod specimen;
pub mod study;
pub mod units;
pub mod verify;
pub mod viewer;
pub mod world;
