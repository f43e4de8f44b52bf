//! The paper's scenarios, built into the program so that it needs no other file.

use super::StudyError;
use crate::record::{FileError, create_folder, write_file};
use crate::scenario::{Scenario, load};

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
/// `extends` and validation treat them alike.
///
/// # Errors
/// When the temporary folder cannot be used.
pub fn preset(name: &str) -> Result<Scenario, StudyError> {
    let folder = tempfile::tempdir()
        .map_err(|e| FileError::new("create a temporary folder in", &std::env::temp_dir(), e))?;
    for (path, content) in FILES {
        let path = folder.path().join(path);
        if let Some(parent) = path.parent() {
            create_folder(parent)?;
        }
        write_file(&path, content.as_bytes())?;
    }
    let loaded = load(&folder.path().join(name), &[])
        .map_err(|e| StudyError::Scenario(format!("built-in scenario {name}: {e}")))?;
    Ok(loaded.scenario)
}
