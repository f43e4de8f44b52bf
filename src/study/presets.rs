//! The paper's scenarios, built into the program so that it needs no other file.

use super::StudyError;
use crate::record::{FileError, create_folder, write_file};
use crate::scenario::{Override, Scenario, load};

/// The files under `scenarios/` that `reproduce` uses.
const FILES: [(&str, &str); 5] = [
    ("paper/pluviation.json", include_str!("../../scenarios/paper/pluviation.json")),
    (
        "paper/vibration-continuous.json",
        include_str!("../../scenarios/paper/vibration-continuous.json"),
    ),
    (
        "paper/vibration-intermittent.json",
        include_str!("../../scenarios/paper/vibration-intermittent.json"),
    ),
    ("quick/pluviation.json", include_str!("../../scenarios/quick/pluviation.json")),
    ("quick/vibration.json", include_str!("../../scenarios/quick/vibration.json")),
];

/// Loads one of the built-in scenarios, by its path under `scenarios/`.
///
/// They are written to a temporary folder and read like any other, so that
/// `extends` and validation treat them alike; `changes` are laid over it.
///
/// # Errors
/// When the temporary folder cannot be used, or a change does not fit.
pub fn preset(name: &str, changes: &[Override]) -> Result<Scenario, StudyError> {
    let folder = tempfile::tempdir()
        .map_err(|e| FileError::new("create a temporary folder in", &std::env::temp_dir(), e))?;
    for (path, content) in FILES {
        let path = folder.path().join(path);
        if let Some(parent) = path.parent() {
            create_folder(parent)?;
        }
        write_file(&path, content.as_bytes())?;
    }
    Ok(load(&folder.path().join(name), changes)?.scenario)
}
