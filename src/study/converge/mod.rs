//! Convergence: how results change as the engine's settings are refined, and
//! which setting is the cheapest that is fine enough.

mod design;
mod judge;
#[cfg(test)]
mod tests;

pub use design::{ConvergenceDesign, ConvergenceLimits, LadderDesign, RungDesign};

use super::variations::keep_and_read;
use super::*;
use crate::report::Convergence;
use design::Designed;

/// Where the built-in design stands under `scenarios/`.
const BUILT_IN: &str = "studies/convergence.json";

/// A study whose design is in a file.
pub struct StudyOptions {
    /// The design; `None` for the built-in one.
    pub design: Option<PathBuf>,
    /// Whether to take its smaller specimen.
    pub quick: bool,
    /// Number of configurations in place of the design's.
    pub configurations: Option<u32>,
}

/// Reads a convergence study, which leaves `convergence.json`, `convergence.csv`, `convergence.md`,
/// `figures/`, the tables of variations and `runs/<name>/`. Rows that a build in the other
/// precision left in the same folder of the same study are judged along.
///
/// # Errors
/// [`StudyError::Faults`] with all its faults; [`StudyError::Scenario`] of realisations that are
/// all the same run, or of rungs that share some.
pub fn converge(options: &StudyOptions) -> Result<Study<Convergence>, StudyError> {
    let read = |file: &Path| Designed::of_file(file, options.quick);
    let design = with_design(options.design.as_deref(), BUILT_IN, read)?;
    let configurations = options.configurations.unwrap_or(design.configurations);
    refuse_repeats(&design.varied, CONFIGURATIONS, configurations)?;
    refuse_shared(&design.varied, configurations)?;
    let mut question = design.varied.question(configurations);
    question["limits"] = json!(design.limits);
    question["reference"] = design.reference.as_str().into();
    Ok(Study {
        command: "converge",
        question,
        scenarios: design.varied.scenarios().cloned().collect(),
        conclude: Box::new(move |run| {
            let programme = design.varied.programme(configurations);
            conclude_so_far(&design.varied, configurations, run, |rows| {
                let (all, left_out) = keep_and_read(&run.out, &programme, rows)?;
                left_out.iter().for_each(|said| run.progress.message(said));
                write_variations(&run.out, &all)?;
                let convergence = design.judged(&all);
                report::write_convergence(&run.out, &convergence)?;
                Ok(convergence)
            })
        }),
    })
}

impl Designed {
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
