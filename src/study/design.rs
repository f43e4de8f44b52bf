//! What designs of studies have in common: the scenario they vary, and how
//! their faults are reported.

use std::path::{Path, PathBuf};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::scenario::{Fault, Override, ScenarioErrors};

/// The scenario that a study varies, and how often it is repeated.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SpecimenDesign {
    /// Path of the scenario, relative to the design's file.
    #[schemars(length(min = 1))]
    pub scenario: String,
    /// Changes that every run has, each `path=value` as after `--set`.
    #[serde(default)]
    pub changes: Vec<String>,
    /// Number of configurations, each the same grains mixed anew, unless the
    /// command says otherwise. One tells nothing of scatter.
    #[schemars(range(min = 1, max = 1000))]
    pub configurations: u32,
}

/// Collects the faults of a design.
pub(super) struct Faults<'a> {
    file: &'a Path,
    found: Vec<Fault>,
}

impl<'a> Faults<'a> {
    pub(super) fn of(file: &'a Path) -> Self {
        Self { file, found: Vec::new() }
    }

    /// Adds a fault at a dotted path of the design.
    pub(super) fn add(&mut self, path: &str, found: &str, allowed: &str, message: &str) {
        self.found.push(Fault {
            file: self.file.display().to_string(),
            path: path.to_owned(),
            found: found.to_owned(),
            allowed: allowed.to_owned(),
            message: message.to_owned(),
        });
    }

    /// Reads changes that stand at a path of the design.
    pub(super) fn changes(&mut self, path: &str, texts: &[String]) -> Vec<Override> {
        let mut changes = Vec::new();
        for (index, text) in texts.iter().enumerate() {
            match text.parse() {
                Ok(change) => changes.push(change),
                Err(_) => self.add(
                    &format!("{path}[{index}]"),
                    &format!("\"{text}\""),
                    "path=value, as engine.rate_hz=960",
                    "the change cannot be read",
                ),
            }
        }
        changes
    }

    /// Checks that a name can be part of a folder's, and is there once.
    pub(super) fn name<'n>(&mut self, path: &str, name: &'n str, known: &mut Vec<&'n str>) {
        let fits = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '.';
        if name.is_empty() || name.starts_with('.') || !name.chars().all(fits) {
            self.add(
                path,
                &format!("\"{name}\""),
                "letters, digits, dashes and dots, a dot not first",
                "the name becomes part of a folder's and does not fit",
            );
        }
        if known.contains(&name) {
            self.add(path, &format!("\"{name}\""), "", "the name is given twice");
        }
        known.push(name);
    }

    /// Adds the faults that a scenario or its variations have.
    pub(super) fn extend(&mut self, errors: ScenarioErrors) -> Result<(), ScenarioErrors> {
        match errors {
            ScenarioErrors::Faults(found) => {
                let design = self.file.display();
                self.found.extend(
                    found.into_iter().map(|f| Fault { file: format!("{design}: {}", f.file), ..f }),
                );
            }
            unreadable => return Err(unreadable),
        }
        Ok(())
    }

    /// Whether any was found.
    pub(super) fn any(&self) -> bool {
        !self.found.is_empty()
    }

    /// All faults as an error.
    pub(super) fn into_error(self) -> ScenarioErrors {
        ScenarioErrors::Faults(self.found)
    }

    /// A path given in the design's file, from here.
    pub(super) fn beside(&self, path: &str) -> PathBuf {
        self.file.parent().unwrap_or(Path::new("")).join(path)
    }
}
