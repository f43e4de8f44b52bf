//! Sensitivity: how far each choice that the paper does not give moves the results, one at a time.

mod design;
mod effects;

pub(super) use design::{Designed, End, read as read_design};
pub use design::{Parameter, ParameterDesign, SensitivityDesign};
pub(super) use effects::rows as parameter_rows;

use super::{
    RunOptions, StudyError, StudyOptions,
    presets::DesignFile,
    realisations::Asked,
    told::tell_warnings,
    variations::{Varied, conclude_so_far, write_variations},
};
use crate::record::{RunRow, VariationRow};
use crate::report::{self, Sensitivity};

/// Where the built-in design stands under `scenarios/`.
const BUILT_IN: &str = "studies/sensitivity.json";

/// A sensitivity study that was read and checked, and not yet run.
#[derive(Debug)]
pub struct SensitivityStudy {
    quick: bool,
    parameters: Vec<Parameter>,
    /// The scenario and its variations.
    pub varied: Varied,
    /// Number of configurations.
    pub configurations: u32,
}

impl SensitivityStudy {
    /// Reads the design.
    ///
    /// # Errors
    /// [`StudyError::Faults`] with all its faults; [`StudyError::Scenario`] of realisations that are
    /// all the same run.
    pub fn read(options: &StudyOptions) -> Result<Self, StudyError> {
        let file = DesignFile::new(options.design.as_deref(), BUILT_IN)?;
        let Designed { chosen, parameters, varied } = design::read(&file.path, options.quick, &[])?;
        let configurations = options.configurations.unwrap_or(chosen.configurations);
        Asked::configurations(configurations).refuse_repeats(&varied)?;
        Ok(Self { quick: options.quick, parameters, varied, configurations })
    }

    /// Carries it out and writes `sensitivity.json`, `sensitivity.csv`, `sensitivity.md`,
    /// `figures/`, the tables of variations and `runs/<name>/`.
    ///
    /// # Errors
    /// [`StudyError`].
    pub fn carry_out(&self, options: &RunOptions) -> Result<Sensitivity, StudyError> {
        tell_warnings(self.varied.scenarios(), options.progress.as_ref());
        conclude_so_far(&self.varied, self.configurations, options, |rows| {
            let variations = write_variations(&options.out, rows)?;
            let sensitivity = self.found(rows, &variations);
            report::write_sensitivity(&options.out, &sensitivity)?;
            Ok(sensitivity)
        })
    }

    fn found(&self, runs: &[RunRow], variations: &[VariationRow]) -> Sensitivity {
        let default = variations.iter().find(|v| v.variation == design::DEFAULT).cloned();
        Sensitivity {
            scenario: self.varied.base.name.clone(),
            quick: self.quick,
            grains: runs.iter().find_map(|r| r.grains),
            configurations: runs.iter().map(|r| r.configuration).max().unwrap_or(0),
            default,
            parameters: effects::rows(&self.parameters, Parameter::variation, runs),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_built_in_design_is_sound() {
        let file = DesignFile::new(None, BUILT_IN).expect("unpacked");
        for quick in [false, true] {
            let design = design::read(&file.path, quick, &[])
                .unwrap_or_else(|e| panic!("quick {quick}: {e}"));
            assert!(
                design.chosen.configurations >= 2,
                "one configuration tells nothing of scatter"
            );
            let parameters = design.parameters.len();
            assert!(parameters >= 12, "every choice that is ours, found {parameters}");
            // A range that ends at the default needs one run, any other two.
            let ends = design
                .parameters
                .iter()
                .map(|p| usize::from(p.low != p.default) + usize::from(p.high != p.default));
            assert_eq!(design.varied.all.len(), 1 + ends.sum::<usize>(), "one run an end");
        }
    }
}
