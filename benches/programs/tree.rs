//! Where the programs find scenarios, scripts and results.

use std::path::Path;

/// The root of the tree that a program was built from: its manifest lies two folders below.
pub fn root() -> &'static Path {
    let programs = Path::new(env!("CARGO_MANIFEST_DIR"));
    programs.ancestors().nth(2).expect("benches/programs/ is in the tree")
}
