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
    let loaded = load_scenario(&folder.path().join(name), changes);
    // The folder is gone when somebody reads of its files.
    let named = |fault: Fault| {
        let file = Path::new(&fault.file).strip_prefix(folder.path()).ok();
        let name = file.map(|file| format!("built-in scenarios/{}", file.display()));
        match name {
            Some(name) => fault.of(name),
            None => fault,
        }
    };
    Ok(loaded.map_err(|errors| errors.each(named))?.scenario)
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

/// Reads the design of a study: a file that was given, or a built-in one by its path under
/// `scenarios/`.
pub(super) fn with_design<T>(
    given: Option<&Path>,
    built_in: &str,
    read: impl FnOnce(&Path) -> Result<T, ScenarioErrors>,
) -> Result<T, StudyError> {
    Ok(match given {
        Some(file) => read(file)?,
        None => read(&unpack()?.path().join(built_in))?,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Law: a fault names the built-in file, or the change, and no temporary folder.
    #[test]
    fn faults_of_built_in_scenarios_name_them() {
        let narrow: Override = "apparatus.cylinder.inner_diameter_mm=50".parse().expect("a change");
        let slow: Override = "engine.rate_hz=1".parse().expect("a change");
        for (change, file) in
            [(narrow, "built-in scenarios/quick/pluviation.json"), (slow, "--set engine.rate_hz=1")]
        {
            let told = preset("quick/pluviation.json", &[change]).expect_err("a fault").to_string();
            assert!(told.contains(&format!("{file}: ")), "law: `{file}` is named, got {told}");
            let folder = std::env::temp_dir().display().to_string();
            assert!(!told.contains(&folder), "law: what is gone is not named, got {told}");
        }
    }
}
