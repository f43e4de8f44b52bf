//! Rows of all tests in a file: those of a test are written as soon as it ends, beside its figures.

use std::path::Path;

use pluvia::record::write_json;

use super::{relative, row::Row};

/// Puts the rows of a test in place of its earlier ones, with what follows from them, and writes
/// all to a file, in the order of their tests.
pub fn renew(
    all: &mut Vec<Row>,
    test: &str,
    found: &[Row],
    tests: &[String],
    file: &Path,
) -> Result<(), String> {
    all.retain(|row| row.test != test);
    all.extend(found.iter().cloned());
    write(all, tests, file)
}

/// Writes rows with what follows from them, in the order of their tests.
pub fn write(all: &mut Vec<Row>, tests: &[String], file: &Path) -> Result<(), String> {
    relative::derive(all);
    all.sort_by_key(|row| tests.iter().position(|test| *test == row.test));
    write_json(file, all).map_err(|e| e.to_string())
}
