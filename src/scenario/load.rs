//! Reads a scenario and answers with every fault at once.

use std::path::{Path, PathBuf};

use serde_json::Value;

use super::{
    Fault, GrainsSpec, Override, Scenario, ScenarioErrors,
    source::{self, Document, Origin},
    structure, validate,
};

/// A scenario as loaded.
#[derive(Debug, Clone, PartialEq)]
pub struct Loaded {
    /// The scenario.
    pub scenario: Scenario,
    /// The files it was read from: its own first, then the one it extends, and so on.
    pub files: Vec<PathBuf>,
}

/// Loads a scenario: reads the file and those it extends, lays the overrides
/// over them, and checks everything, from spelling to whether the time step
/// can resolve the motion.
///
/// Relative paths in `extends` and `grains.file` begin at the file that gives
/// them, those of overrides at the working directory.
///
/// # Errors
/// [`ScenarioErrors::Unreadable`] for a file that cannot be read, and else
/// [`ScenarioErrors::Faults`] with all faults found.
pub fn load(path: &Path, overrides: &[Override]) -> Result<Loaded, ScenarioErrors> {
    let mut document = source::read(path)?;
    let mut faults = std::mem::take(&mut document.faults);
    for change in overrides {
        if let Err(fault) = change.apply(&mut document) {
            faults.push(fault);
        }
    }
    let checked = check_value(&document.value);
    let (scenario, found) = match checked {
        Ok(scenario) => (Some(scenario), Vec::new()),
        Err(found) => (None, found),
    };
    faults.extend(
        found
            .into_iter()
            .map(|fault| Fault { file: document.origin(&fault.path).to_string(), ..fault }),
    );
    match scenario {
        Some(mut scenario) if faults.is_empty() => {
            place_grains_file(&mut scenario, &document);
            Ok(Loaded { scenario, files: document.files })
        }
        _ => Err(ScenarioErrors::Faults(faults)),
    }
}

/// Checks a scenario that a program put together; the faults carry its name
/// in place of a file.
///
/// # Errors
/// [`ScenarioErrors::Faults`] with all faults found.
pub fn check(scenario: &Scenario) -> Result<(), ScenarioErrors> {
    let named = |fault: Fault| Fault { file: scenario.name.clone(), ..fault };
    let value = serde_json::to_value(scenario).map_err(|error| {
        ScenarioErrors::Faults(vec![named(Fault {
            message: format!("the scenario has no JSON form: {error}"),
            ..Fault::default()
        })])
    })?;
    match check_value(&value) {
        Ok(_) => Ok(()),
        Err(faults) => Err(ScenarioErrors::Faults(faults.into_iter().map(named).collect())),
    }
}

/// The scenario of a JSON value, or all its faults.
fn check_value(value: &Value) -> Result<Scenario, Vec<Fault>> {
    let structure::Checked { mut faults, cleaned } = structure::check(value);
    let sound = faults.is_empty();
    // A value that has a fault already needs no second one about its meaning.
    let meaning = validate::faults(&cleaned)
        .into_iter()
        .filter(|fault| !faults.iter().any(|known| known.path == fault.path))
        .collect::<Vec<_>>();
    faults.extend(meaning);
    if sound {
        match serde_path_to_error::deserialize::<_, Scenario>(value) {
            Ok(scenario) if faults.is_empty() => return Ok(scenario),
            Ok(_) => {}
            Err(error) => {
                let path = error.path().to_string();
                faults.push(Fault {
                    file: String::new(),
                    allowed: structure::allowed_at(value, &path),
                    path,
                    found: String::new(),
                    message: format!("the value cannot be used: {}", error.inner()),
                });
            }
        }
    }
    Err(faults)
}

/// Makes the path of a grains file, relative to the file that gives it, one
/// that can be opened from here.
fn place_grains_file(scenario: &mut Scenario, document: &Document) {
    let GrainsSpec::File(grains) = &mut scenario.grains else { return };
    let Origin::File(given_in) = document.origin("grains.file") else { return };
    let folder = given_in.parent().unwrap_or(Path::new(""));
    grains.file = folder.join(&grains.file).to_string_lossy().into_owned();
}
