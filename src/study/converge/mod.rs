//! Convergence: how results change as the engine's settings are refined, and
//! which setting is the cheapest that is fine enough.

mod design;
mod judge;
#[cfg(test)]
mod tests;

pub use design::{
    ConvergenceDesign, ConvergenceLimits, ConvergenceStudy, LadderDesign, RungDesign,
};

use super::variations::keep_and_read;
use super::*;
use crate::report::Convergence;

/// Where the built-in design stands under `scenarios/`.
const BUILT_IN: &str = "studies/convergence.json";

/// How to run a study whose design is in a file.
pub struct StudyOptions {
    /// The design; `None` for the built-in one.
    pub design: Option<PathBuf>,
    /// Whether to take its smaller specimen.
    pub quick: bool,
    /// Number of configurations in place of the design's.
    pub configurations: Option<u32>,
    /// Where to, how many at a time, whom to tell.
    pub run: RunOptions,
}

impl ConvergenceStudy {
    /// Reads the design.
    ///
    /// # Errors
    /// [`StudyError::Faults`] with all its faults; [`StudyError::Scenario`] of realisations that are
    /// all the same run.
    pub fn read(options: &StudyOptions) -> Result<Self, StudyError> {
        let file = DesignFile::new(options.design.as_deref(), BUILT_IN)?;
        let mut study = Self::of_file(&file.path, options.quick)?;
        study.configurations = options.configurations.unwrap_or(study.configurations);
        refuse_repeats(&study.varied, CONFIGURATIONS, study.configurations)?;
        Ok(study)
    }

    /// Carries it out and writes `convergence.json`, `convergence.csv`, `convergence.md`,
    /// `figures/`, the tables of variations and `runs/<name>/`. Rows that a build in the other
    /// precision left in the same folder of the same study are judged along.
    ///
    /// # Errors
    /// [`StudyError`].
    pub fn carry_out(&self, options: &RunOptions) -> Result<Convergence, StudyError> {
        let varied = &self.varied;
        tell_warnings(varied.scenarios(), options.progress.as_ref());
        let programme = varied.programme(self.configurations);
        conclude_so_far(varied, self.configurations, options, |rows| {
            let (all, left_out) = keep_and_read(&options.out, &programme, rows)?;
            left_out.iter().for_each(|said| options.progress.message(said));
            write_variations(&options.out, &all)?;
            let convergence = self.judged(&all);
            report::write_convergence(&options.out, &convergence)?;
            Ok(convergence)
        })
    }

    fn judged(&self, runs: &[RunRow]) -> Convergence {
        let Self { limits, reference, ladders, varied, .. } = self;
        let standard = standard(&varied.base.scale());
        let rows = judge::judge(runs, ladders, reference, *limits, &standard);
        let cheapest = judge::cheapest(&rows, &standard);
        Convergence {
            scenario: varied.base.name.clone(),
            quick: self.quick,
            grains: runs.iter().find_map(|r| r.grains),
            standard,
            height_limit_percent: limits.height_percent,
            settlement_limit_percent: limits.settlement_percent,
            reference: reference.clone(),
            rows,
            cheapest,
        }
    }
}
