//! What designs of studies have in common: the scenario they vary, and how
//! their faults are reported.

use super::*;
use crate::scenario::NotAnOverride;

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
    /// Number of realisations, each a new random arrangement of the same grains,
    /// unless the command says otherwise. One gives no scatter.
    #[schemars(range(min = 1, max = 1000))]
    pub configurations: u32,
}

/// The scenario that a design varies this time.
#[derive(Debug)]
pub(super) struct Chosen {
    /// Its file.
    pub scenario: PathBuf,
    /// Changes that every run has.
    pub common: Vec<Override>,
    /// Number of configurations.
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
        let file = self.file.display();
        self.found.push(Fault::new(message, found, allowed).at(path).of(file));
    }

    /// Reads changes that stand at a path of the design.
    pub(super) fn changes(&mut self, path: &str, texts: &[String]) -> Vec<Override> {
        let mut changes = Vec::new();
        for (index, text) in texts.iter().enumerate() {
            match text.parse::<Override>() {
                Ok(change) => changes.push(change),
                Err(NotAnOverride::Twice(why)) => {
                    self.add(&format!("{path}[{index}]"), "", "", &why);
                }
                Err(deep @ NotAnOverride::Deep(_)) => {
                    self.add(&format!("{path}[{index}]"), "", "", &deep.to_string());
                }
                Err(NotAnOverride::Form(_)) => self.add(
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

    /// The scenario that is varied in full or with `--quick`; a fault where the design has none.
    pub(super) fn chosen(
        &mut self,
        full: &SpecimenDesign,
        quick: Option<&SpecimenDesign>,
        is_quick: bool,
    ) -> Option<Chosen> {
        let (part, specimen) = if is_quick { ("quick", quick) } else { ("full", Some(full)) };
        let Some(specimen) = specimen else {
            self.add(part, "", "a specimen, as in `full`", "the field is missing for --quick");
            return None;
        };
        Some(Chosen {
            scenario: self.file.parent().unwrap_or(Path::new("")).join(&specimen.scenario),
            common: self.changes(&format!("{part}.changes"), &specimen.changes),
            configurations: specimen.configurations,
        })
    }

    /// The variations of a design, or all its faults, or else all of the scenarios.
    pub(super) fn load(
        self,
        chosen: &Chosen,
        variations: Vec<Variation>,
    ) -> Result<Varied, ScenarioErrors> {
        if !self.found.is_empty() {
            return Err(self.into_error());
        }
        Varied::load(&chosen.scenario, &chosen.common, variations).map_err(|e| self.with(e))
    }

    /// All faults with those that a scenario has.
    pub(super) fn with(mut self, errors: ScenarioErrors) -> ScenarioErrors {
        let ScenarioErrors::Faults(found) = errors else { return errors };
        let design = self.file.display();
        let in_design = |f: Fault| Fault { file: format!("{design}: {}", f.file), ..f };
        self.found.extend(found.into_iter().map(in_design));
        self.into_error()
    }

    /// All faults as an error.
    pub(super) fn into_error(self) -> ScenarioErrors {
        ScenarioErrors::Faults(self.found)
    }
}

/// The ends of a range as a command has it, `low..high`.
pub(super) fn range(text: &str) -> Option<(f64, f64)> {
    let number = |text: &str| text.trim().parse().ok().filter(|v: &f64| v.is_finite());
    let (low, high) = text.split_once("..")?;
    Some((number(low)?, number(high)?))
}

/// What `quick` of a part of a design is where it is not given.
pub(super) fn yes() -> bool {
    true
}
