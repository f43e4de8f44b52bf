//! Where the programs keep what a later run goes on with.

use std::path::{Path, PathBuf};

/// The folder beside a file of results: its name without the ending.
///
/// # Errors
/// Where it has no ending, as both would have one name.
pub fn folder_of(file: &Path) -> Result<PathBuf, String> {
    if file.extension().is_some() {
        return Ok(file.with_extension(""));
    }
    Err(format!(
        "--out {0}: a name with an ending is needed, as {0}.json: what a later run goes on with \
         lies in the folder {0}",
        file.display()
    ))
}
