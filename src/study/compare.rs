//! The same grains and protocol in several engines.
//!
//! Every engine runs the whole scenario from the same grains in the same places. Then the specimen
//! that the first engine made is handed to the others for what comes after: the vibration where
//! there is one, else the rest test. So differences of making and differences of carrying on are
//! told apart.

use super::{
    compared::{left_out, quantities, without_band},
    plan::Prepared,
    *,
};
use crate::scenario::{Loaded, StockSettings, check};

/// Checks a comparison of engines, makes its grains and builds its laboratories. It leaves
/// `compare.json`, `report.html`, `figures/` and `runs/<name>/`.
///
/// # Errors
/// [`StudyError::Faults`] where an engine cannot do the scenario: the first may run for hours
/// before the turn of one that cannot; [`StudyError`] where grains or a laboratory cannot be had.
pub fn compare(
    loaded: Loaded,
    changes: &[Override],
    backends: &[Backend],
) -> Result<Study<CompareRecord>, StudyError> {
    let Loaded { scenario, files, .. } = loaded;
    let each: Vec<Scenario> = backends.iter().map(|b| with(&scenario, *b)).collect();
    each.iter().try_for_each(|own| check_in(own, files.first(), changes))?;
    let question = json!({ "scenario": in_question(&scenario), "backends": backends });
    let grains = Arc::new(make_grains(&scenario)?);
    let is_vibration = |stage: &StageSpec| matches!(stage, StageSpec::Vibrate { .. });
    let handed_on = scenario.stages.iter().position(is_vibration).unwrap_or(scenario.stages.len());
    let runs = planned(&each, &grains, handed_on);
    // Two may have the same engine: their names tell them apart.
    let plan = Plan::named(&runs)?;
    Ok(Study {
        command: "compare",
        question,
        scenarios: each,
        conclude: Box::new(move |options| compared(&scenario, handed_on, &runs, &plan, options)),
    })
}

/// Runs a scenario in each engine, and compares the runs; `handed_on` is after how many stages the
/// specimen is handed on.
fn compared(
    scenario: &Scenario,
    handed_on: usize,
    runs: &[PlannedRun],
    plan: &Plan,
    options: &RunOptions,
) -> Result<CompareRecord, StudyError> {
    let folder = |run: &str| folder_of(&options.out, run);
    let (records, _) = carry_out(plan, runs, options, |run| folder(&run.name))?;
    for record in &records {
        report::run_figures(&folder(&record.name).join("figures"), record)?;
    }
    let compared = runs.iter().zip(records).map(|(run, record)| CompareRun {
        name: record.name,
        backend: name(run.scenario.engine.backend),
        specimen_by: run.prepared.as_ref().map(|p| name(p.engine.backend)),
        wall_s_per_simulated_s: record.summary.wall_s / record.summary.simulated_s,
        summary: record.summary,
        series: record.series,
    });
    let compared: Vec<CompareRun> = compared.collect();
    let quantities = quantities(&compared);
    let left_out = left_out(&compared);
    let within = quantities.iter().all(|q| q.within_band != Some(false));
    let as_expected = left_out.is_none() && within;
    let not_judged = left_out.or_else(|| without_band(&quantities));
    let own = runs.iter().filter(|run| run.prepared.is_none());
    let record = CompareRecord {
        scenario: scenario.name.clone(),
        backends: own.map(|run| crate::world::info(run.scenario.engine.backend)).collect(),
        handed_on_after_stages: handed_on,
        runs: compared,
        quantities,
        within_bands: not_judged.is_none().then_some(within),
        not_judged,
        as_expected,
        vibrated: handed_on < scenario.stages.len(),
        standard: standard(&scenario.scale()),
    };
    report::write_comparison(&options.out, &record)?;
    Ok(record)
}

fn name(backend: Backend) -> String {
    crate::world::info(backend).name
}

/// A scenario in an engine of the comparison, with the settings that this one has.
fn with(scenario: &Scenario, backend: Backend) -> Scenario {
    let mut own = scenario.clone();
    own.engine.backend = backend;
    if backend != scenario.engine.backend {
        own.engine.stock = StockSettings::default();
    }
    own
}

/// Checks a scenario in an engine of the comparison. What one engine cannot do another may, so that
/// faults name the engine, and the file of the scenario or the change that gave the value.
fn check_in(
    own: &Scenario,
    file: Option<&PathBuf>,
    changes: &[Override],
) -> Result<(), ScenarioErrors> {
    let engine = name(own.engine.backend);
    let placed = |fault: Fault| {
        let message = format!("in {engine}: {}", fault.message);
        let change = changes.iter().rev().find(|change| change.gives(&fault.path));
        let given = match (change, file) {
            (Some(change), _) => format!("--set {}", change.text()),
            (None, Some(file)) => file.display().to_string(),
            (None, None) => fault.file.clone(),
        };
        Fault { message, ..fault }.of(given)
    };
    check(own).map_err(|errors| errors.each(placed))
}

/// The runs of a scenario that is given in each engine.
fn planned(each: &[Scenario], grains: &Arc<GrainSet>, handed_on: usize) -> Vec<PlannedRun> {
    let run = |name: String, scenario: &Scenario, prepared| PlannedRun {
        prepared,
        ..PlannedRun::new(name, scenario.clone(), grains.clone())
    };
    let name = |of: &Scenario| name(of.engine.backend);
    let mut runs: Vec<PlannedRun> = each.iter().map(|own| run(name(own), own, None)).collect();
    if let Some((first, others)) = each.split_first() {
        runs.extend(others.iter().map(|other| {
            let title = format!("{}-from-{}-specimen", name(other), name(first));
            let prepared = Prepared { stages: handed_on, engine: first.engine.clone() };
            run(title, other, Some(prepared))
        }));
    }
    runs
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Law: what one of the engines cannot do is refused before any of them runs, with its place;
    /// settings of one engine alone are nothing against the others.
    #[test]
    fn each_engine_is_asked_before_one_runs() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("compared.json");
        let scenario = |change: serde_json::Value| {
            let mut value = serde_json::json!({
                "name": "compared",
                "grains": { "total_mass_g": 20, "density_kg_per_m3": 2650, "sieve_table":
                    [{ "passing_mm": 10, "retained_mm": 8, "mass_percent": 100 }] },
                "stages": [{ "stage": "fill_funnel" }, { "stage": "pour", "falling_height_mm": 0 }]
            });
            for (field, to) in change.as_object().expect("fields") {
                value[field] = to.clone();
            }
            std::fs::write(&path, value.to_string()).expect("a scenario");
            crate::grains::load_scenario(&path, &[]).unwrap_or_else(|e| panic!("{e}"))
        };
        let check_each = |loaded: &Loaded, backends: &[Backend]| {
            compare(loaded.clone(), &[], backends).map(drop)
        };
        let both = [Backend::Bullet, Backend::Rapier];
        let poured = scenario(serde_json::json!({}));
        check_each(&poured, &both).expect("law: both can pour");
        let stock = serde_json::json!({
            "contact_solver": "stock", "stock": { "collision_margin_mm": 0.2 }
        });
        let stock = scenario(serde_json::json!({ "engine": stock }));
        check_each(&stock, &both).expect("law: settings of one engine are for that one");
        let pressed = scenario(serde_json::json!({
            "pieces": [
                { "name": "box", "shape": { "box": { "inner_mm": [50, 50, 50] } } },
                { "name": "lid", "shape": { "plate": { "size_mm": [48, 48, 5] } },
                    "at_mm": [0, 0, 100] }
            ],
            "stages": [
                { "stage": "deposit", "at_mm": [0, 0, 60], "area_mm": [40, 40], "rate_g_per_s": 50 },
                { "stage": "press", "loads": [{ "piece": "lid", "force_n": 5 }] }
            ]
        }));
        check_each(&pressed, &both[..1]).expect("law: one engine can press");
        let said = check_each(&pressed, &both).expect_err("law: the other cannot").to_string();
        let expected = format!("{}: stages[1].stage: in rapier: ", path.display());
        assert!(said.starts_with(&expected), "law: begins with `{expected}`, got {said}");
    }

    /// Law: a stage says of which run it is; the second engine's own and what it does with the
    /// specimen of the first are told apart.
    #[test]
    fn stages_are_named_after_their_runs() {
        let scenario = crate::study::tests::scenario(0.0);
        let grains = Arc::new(make_grains(&scenario).expect("grains"));
        let each = [Backend::Bullet, Backend::Rapier].map(|backend| with(&scenario, backend));
        let runs = planned(&each, &grains, 2);
        let plan = Plan::named(&runs).expect("a plan");
        let labels: Vec<&str> = plan.nodes.iter().map(|node| node.label.as_str()).collect();
        let expected = [
            "bullet, fill the funnel",
            "bullet, pour from 0 mm",
            "bullet, rest test, 0.2 s",
            "rapier, fill the funnel",
            "rapier, pour from 0 mm",
            "rapier, rest test, 0.2 s",
            "rapier-from-bullet-specimen, rest test, 0.2 s",
        ];
        assert_eq!(labels, expected, "law: the run's name, then the stage");
    }
}
