//! Scenarios and designs of studies that are built into the program, so that it needs no other file.

use tempfile::TempDir;

use super::*;

macro_rules! files {
    ($($name:literal),* $(,)?) => {
        [$(($name, include_str!(concat!("../../scenarios/", $name)))),*]
    };
}

/// The files under `scenarios/` that `reproduce` and the studies use.
const FILES: [(&str, &str); 9] = files![
    "paper/pluviation.json",
    "paper/vibration-continuous.json",
    "paper/vibration-intermittent.json",
    "paper/repose.json",
    "quick/pluviation.json",
    "quick/vibration.json",
    "quick/repose.json",
    "studies/convergence.json",
    "studies/sensitivity.json",
];

/// Loads one of the built-in scenarios, by its path under `scenarios/`.
///
/// They are written to a temporary folder and read like any other, so that
/// `extends` and validation treat them alike; `changes` are laid over it.
///
/// # Errors
/// When the temporary folder cannot be used, or a change does not fit.
pub fn preset(name: &str, changes: &[Override]) -> Result<Scenario, StudyError> {
    let folder = unpack()?;
    Ok(load_scenario(&folder.path().join(name), changes)?.scenario)
}

/// Writes the built-in files to a temporary folder, which lasts as long as what is returned.
fn unpack() -> Result<TempDir, StudyError> {
    let folder = tempfile::tempdir()
        .map_err(|e| FileError::new("create a temporary folder in", &std::env::temp_dir(), e))?;
    for (path, content) in FILES {
        let path = folder.path().join(path);
        if let Some(parent) = path.parent() {
            create_folder(parent)?;
        }
        write_file(&path, content.as_bytes())?;
    }
    Ok(folder)
}

/// The design of a study: a file that was given, or a built-in one by its path under `scenarios/`.
pub(super) struct DesignFile {
    /// Where to read it.
    pub path: PathBuf,
    _unpacked: Option<TempDir>,
}

impl DesignFile {
    /// Finds a design; a built-in one is there as long as this is.
    pub(super) fn new(given: Option<&Path>, built_in: &str) -> Result<Self, StudyError> {
        if let Some(path) = given {
            return Ok(Self { path: path.to_owned(), _unpacked: None });
        }
        let folder = unpack()?;
        Ok(Self { path: folder.path().join(built_in), _unpacked: Some(folder) })
    }
}
