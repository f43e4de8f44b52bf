//! Pluvia simulates granular soil as rigid convex polyhedra on the Bullet
//! physics library: how grains pack, pour and settle.
//!
//! The house tour is in `ARCHITECTURE.md`; the user's guide in `README.md`.
//!
//! Grains from a sieve table, put through the virtual sieve:
//!
//! ```
//! use pluvia::{grains, scenario::SievedGrains};
//!
//! let gravel: SievedGrains = serde_json::from_str(
//!     r#"{ "total_mass_g": 100, "density_kg_per_m3": 2650,
//!          "sieve_table": [{ "passing_mm": 12.5, "retained_mm": 10, "mass_percent": 100 }] }"#,
//! )?;
//! let set = grains::generate(&gravel, 1)?;
//! let mass: f64 = set.grains.iter().map(|grain| grain.mass).sum();
//! assert!((mass - 0.1).abs() < 1e-9);
//!
//! let sieved = grains::SieveAnalysis::of(&set).gradation();
//! assert!((0.009..0.0135).contains(&sieved.d50));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

#![cfg_attr(not(test), warn(unused_crate_dependencies))]

pub mod apparatus;
pub mod caught;
pub mod cli;
pub mod export;
pub mod geometry;
pub mod grains;
mod in_order;
pub mod input;
pub mod measure;
pub mod motion;
pub mod paper;
pub mod picture;
pub mod plain;
pub mod protocol;
pub mod record;
pub mod report;
pub mod scale;
pub mod scenario;
pub mod specimen;
pub mod study;
pub mod units;
pub mod verify;
pub mod viewer;
pub mod world;
