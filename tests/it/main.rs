//! Tests of the crate as a whole: its source, its documents, its files.

mod architecture;
mod asked;
mod begin;
mod bits;
mod bookkeeping;
mod calibrate;
mod checks;
mod cli;
mod collision;
mod compare;
mod crafted;
mod docs;
#[cfg(target_os = "linux")]
mod durable;
mod export;
mod faults;
mod files;
mod fuzz;
mod growth;
mod interpretations;
mod interruption;
#[cfg(unix)]
mod joint;
mod kept;
mod laboratory;
mod laboratory_ends;
mod laboratory_runs;
mod leaks;
#[cfg(target_os = "linux")]
mod limits;
mod load;
mod measures;
mod memory;
mod meshes;
mod motions;
#[path = "../../src/geometry/testing/near.rs"]
mod near;
#[cfg(unix)]
mod notices;
mod packages;
mod peers;
mod picture;
#[cfg(unix)]
mod pinned;
mod program;
mod python;
mod recipes;
mod referee;
mod repose;
mod reproduce;
mod results;
mod same;
mod sampling;
mod sanitizers;
mod scale;
mod scenario;
mod segments;
mod shapes;
mod shown;
#[cfg(unix)]
mod signals;
mod small;
mod soak;
mod standard_tests;
mod store;
mod studies;
mod sweep;
mod sweep_engines;
mod terminal;
mod verification;
mod viewer;
mod warned;
