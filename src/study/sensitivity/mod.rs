//! Sensitivity: how far each choice that the paper does not give moves the results, one at a time.

mod design;
mod effects;

pub(super) use design::{Designed, End, read as read_design};
pub use design::{Parameter, ParameterDesign, SensitivityDesign};

use super::*;

/// Where the built-in design stands under `scenarios/`.
const BUILT_IN: &str = "studies/sensitivity.json";

/// Reads a sensitivity study, which leaves `sensitivity.json`, `sensitivity.csv`, `sensitivity.md`,
/// `figures/`, the tables of variations and `runs/<name>/`.
///
/// # Errors
/// [`StudyError::Faults`] with all its faults; [`StudyError::Scenario`] of realisations that are
/// all the same run, or belong to two variations.
pub fn sensitivity(options: &StudyOptions) -> Result<Study<Sensitivity>, StudyError> {
    let quick = options.quick;
    let read = |file: &Path| design::read(file, quick, &[]);
    let Designed { chosen, parameters, varied } =
        with_design(options.design.as_deref(), BUILT_IN, read)?;
    let configurations = options.configurations.unwrap_or(chosen.configurations);
    refuse_repeats(&varied, CONFIGURATIONS, configurations)?;
    refuse_shared(&varied, configurations)?;
    Ok(Study {
        command: "sensitivity",
        question: varied.question(configurations),
        scenarios: varied.scenarios().cloned().collect(),
        conclude: Box::new(move |run| {
            conclude_so_far(&varied, configurations, run, |rows| {
                write_variations(&run.out, rows)?;
                let of = Parameter::variation;
                let found = table(&varied.base, quick, &parameters, of, design::DEFAULT, rows);
                report::write_sensitivity(&run.out, &found)?;
                Ok(found)
            })
        }),
    })
}

/// What parameters of a scenario move that were varied one at a time. `variation` says what the
/// runs at an end of a parameter are called, `default` what those of the scenario itself.
pub(super) fn table(
    scenario: &Scenario,
    quick: bool,
    parameters: &[Parameter],
    variation: impl Fn(&Parameter, End) -> String,
    default: &str,
    runs: &[RunRow],
) -> Sensitivity {
    Sensitivity {
        scenario: scenario.name.clone(),
        quick,
        grains: runs.iter().find_map(|r| r.grains),
        configurations: runs.iter().map(|r| r.configuration).max().unwrap_or(0),
        with_result: runs.iter().filter(|r| r.failure.is_none()).count(),
        left_out: runs.iter().filter(|r| r.is_left_out()).count(),
        default: VariationRow::of(runs).into_iter().find(|v| v.variation == default),
        parameters: effects::rows(parameters, variation, runs),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Law: a run is counted once, also that of the default at the ends of several parameters.
    #[test]
    fn runs_are_counted_once() {
        let scenario = crate::study::tests::bare_scenario();
        let row = |variation: &str, valid| RunRow {
            valid: Some(valid),
            ..RunRow::of_scenario("r", variation, "g", &scenario)
        };
        let failed = RunRow { failure: Some("it broke".to_owned()), ..row("b-high", true) };
        let runs = [row(design::DEFAULT, false), row("a-high", true), failed];
        let parameters = ["a", "b"].map(|name| Parameter {
            name: name.to_owned(),
            high: 1.0,
            ..Parameter::default()
        });
        let of = Parameter::variation;
        let found = table(&scenario, false, &parameters, of, design::DEFAULT, &runs);
        let told = (found.with_result, found.left_out);
        assert_eq!(told, (2, 1), "law: three runs, of which one failed and one is left out");
    }

    #[test]
    fn the_built_in_design_is_sound() {
        for quick in [false, true] {
            let design = with_design(None, BUILT_IN, |file| design::read(file, quick, &[]))
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
