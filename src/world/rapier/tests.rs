//! What is rapier's alone; laws that hold for every engine are in
//! `world/parity_tests.rs`.

use super::*;

#[test]
fn the_version_is_the_one_locked() {
    let lock = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/Cargo.lock"))
        .expect("Cargo.lock is there");
    let mut lines = lock.lines().skip_while(|line| *line != "name = \"rapier3d-f64\"");
    let locked = lines.nth(1).unwrap_or_default();
    assert_eq!(locked, format!("version = \"{VERSION}\""), "Cargo.lock (left), VERSION (right)");
}
