//! The same grains and protocol in several engines.
//!
//! Every engine runs the whole scenario from the same grains in the same places. Then the specimen
//! that the first engine made is handed to the others for what comes after: the vibration where
//! there is one, else the rest test. So differences of making and differences of carrying on are
//! told apart.

use super::{plan::Prepared, *};
use crate::record::{OpeningSummary, RegionSummary, left_out_with_reasons};
use crate::report::ComparedQuantity;
use crate::scenario::{Loaded, StockSettings, check};

/// Largest difference of standing height between two engines that is not a finding, as a fraction
/// of the height: pours of a few hundred grains differ by up to 4 % from one mixing to the next, of
/// 1456 grains by about 1 % (both measured), and 5 % is beyond both.
pub const HEIGHT_BAND: f64 = 0.05;

/// The same for the void ratio, which is height over the height of the solids
/// less one: 5 % of the height are 0.05 (1 + e), 0.1 for e near 0.95.
pub const VOID_RATIO_BAND: f64 = 0.1;

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
    let Loaded { scenario, files } = loaded;
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
    let not_judged = not_judged(&compared);
    let within = quantities.iter().all(|q| q.within_band != Some(false));
    let own = runs.iter().filter(|run| run.prepared.is_none());
    let record = CompareRecord {
        scenario: scenario.name.clone(),
        backends: own.map(|run| crate::world::info(run.scenario.engine.backend)).collect(),
        handed_on_after_stages: handed_on,
        runs: compared,
        quantities,
        within_bands: not_judged.is_none().then_some(within),
        not_judged,
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
    let faults = match check(own) {
        Err(ScenarioErrors::Faults(faults)) => faults,
        other => return other,
    };
    let engine = name(own.engine.backend);
    let placed = faults.into_iter().map(|fault| {
        let message = format!("in {engine}: {}", fault.message);
        let change = changes.iter().rev().find(|change| change.gives(&fault.path));
        let given = match (change, file) {
            (Some(change), _) => format!("--set {}", change.text()),
            (None, Some(file)) => file.display().to_string(),
            (None, None) => fault.file.clone(),
        };
        Fault { message, ..fault }.of(given)
    });
    Err(ScenarioErrors::Faults(placed.collect()))
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

/// What is compared: its name, its unit, its value of a run, and within which band of the first
/// engine's value the others agree with it, where one is asked for.
type Compared =
    (&'static str, &'static str, fn(&CompareRun) -> Option<f64>, fn(Option<f64>) -> Option<f64>);

const QUANTITIES: [Compared; 14] = [
    (
        "standing height after pouring, mean surface",
        "mm",
        |r| r.summary.poured_height_mm.unwrap_or(r.summary.standing_height_mm).mean(),
        |first| Some(HEIGHT_BAND * first?),
    ),
    (
        "void ratio after pouring",
        "",
        |r| r.summary.poured_void_ratio.or(r.summary.void_ratio),
        |_| Some(VOID_RATIO_BAND),
    ),
    (
        "standing height at the end, mean surface",
        "mm",
        |r| r.summary.standing_height_mm.mean(),
        |_| None,
    ),
    ("void ratio at the end", "", |r| r.summary.void_ratio, |_| None),
    (
        "settlement of the plate",
        "mm",
        |r| Some(r.summary.settlement_mm.as_ref()?.final_mm),
        |_| None,
    ),
    (
        "settlement of the surface",
        "mm",
        |r| Some(r.summary.surface_settlement_mm.as_ref()?.final_mm),
        |_| None,
    ),
    ("angle of repose", "°", |r| Some(r.summary.angle_of_repose.as_ref()?.degrees), |_| None),
    ("overlap, mean", "%", |r| Some(r.summary.overlap.known()?.mean_percent), |_| None),
    ("overlap, 99th percentile", "%", |r| Some(r.summary.overlap.known()?.p99_percent), |_| None),
    ("numerical creep at rest", "µm/s", |r| r.summary.creep_um_per_s, |_| None),
    (
        "coordination number",
        "",
        |r| Some(r.summary.coordination_number).filter(|number| number.is_finite()),
        |_| None,
    ),
    ("grains in the cylinder", "", |r| Some(r.summary.grains.in_cylinder as f64), |_| None),
    ("grains through a wall", "", |r| Some(r.summary.grains.escaped as f64), |_| None),
    ("wall time per simulated second", "s", |r| Some(r.wall_s_per_simulated_s), |_| None),
];

/// Why engines cannot be compared: a run from grains of its own that is not
/// valid, or lacks grains, shows its fault and not its engine. What is handed on decides no band.
fn not_judged(runs: &[CompareRun]) -> Option<String> {
    let own = runs.iter().filter(|r| r.specimen_by.is_none());
    let against = left_out_with_reasons(own.map(|r| (r.name.as_str(), &r.summary)));
    (!against.is_empty()).then(|| against.join(", "))
}

fn quantities(runs: &[CompareRun]) -> Vec<ComparedQuantity> {
    let judged = not_judged(runs).is_none();
    QUANTITIES
        .iter()
        .map(|(quantity, unit, value, band)| {
            let values: Vec<Option<f64>> = runs.iter().map(value).collect();
            // A band holds between engines that made their own specimen, where each has a value.
            let own = runs.iter().zip(&values).filter(|(r, _)| r.specimen_by.is_none());
            let own: Vec<Option<f64>> = own.map(|(_, v)| *v).collect();
            let band = band(own.first().copied().flatten());
            let all: Option<Vec<f64>> = own.into_iter().collect();
            let first = all.as_ref().and_then(|all| all.first());
            let within = band.filter(|_| judged).zip(first).map(|(band, first)| {
                all.iter().flatten().all(|other| (other - first).abs() <= band)
            });
            ComparedQuantity {
                quantity: (*quantity).to_owned(),
                unit: (*unit).to_owned(),
                values,
                band,
                within_band: within,
            }
        })
        .chain(of_parts(runs, openings, &OF_OPENINGS))
        .chain(of_parts(runs, regions, &OF_REGIONS))
        .collect()
}

/// What is measured of a part of a laboratory: its name, its unit, and its value.
type OfPart<P> = (&'static str, &'static str, fn(&P) -> Option<f64>);

const OF_OPENINGS: [OfPart<OpeningSummary>; 2] = [
    ("mass passed", "g", |opening| Some(opening.passed_g)),
    ("rate", "g/s", |opening| opening.rate_g_per_s),
];

const OF_REGIONS: [OfPart<RegionSummary>; 4] = [
    ("void ratio", "", |region| region.void_ratio),
    ("relative density", "", |region| region.relative_density),
    ("mean stress", "kPa", |region| Some(region.stress.as_ref()?.mean_kpa)),
    ("deviatoric stress", "kPa", |region| Some(region.stress.as_ref()?.deviatoric_kpa)),
];

/// Of every part of the runs' laboratories, each with its name, what any run has of it.
fn of_parts<P: 'static>(
    runs: &[CompareRun],
    parts: fn(&CompareRun) -> Vec<(&String, &P)>,
    measured: &[OfPart<P>],
) -> Vec<ComparedQuantity> {
    let named = runs.first().map_or_else(Vec::new, parts).into_iter().enumerate();
    let all = named.flat_map(|(n, (name, _))| measured.iter().map(move |what| (n, name, what)));
    all.filter_map(|(n, name, (what, unit, value))| {
        let of_run = |run: &CompareRun| parts(run).get(n).and_then(|(_, part)| value(part));
        let values: Vec<Option<f64>> = runs.iter().map(of_run).collect();
        values.iter().any(Option::is_some).then(|| ComparedQuantity {
            quantity: format!("{what}, {name}"),
            unit: (*unit).to_owned(),
            values,
            band: None,
            within_band: None,
        })
    })
    .collect()
}

/// The openings of a run; none without a laboratory.
fn openings(of: &CompareRun) -> Vec<(&String, &OpeningSummary)> {
    let all = of.summary.laboratory.iter().flat_map(|laboratory| &laboratory.openings);
    all.map(|opening| (&opening.name, opening)).collect()
}

/// Its regions, likewise.
fn regions(of: &CompareRun) -> Vec<(&String, &RegionSummary)> {
    let all = of.summary.laboratory.iter().flat_map(|laboratory| &laboratory.regions);
    all.map(|region| (&region.name, region)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::{Balance, LaboratorySummary, canned};

    /// Two engines' own runs, and one from the first's specimen.
    fn three() -> Vec<CompareRun> {
        let record = canned::valid_runs()[0].clone();
        let run = |backend: &str, by: Option<&str>| CompareRun {
            backend: backend.to_owned(),
            specimen_by: by.map(str::to_owned),
            name: backend.to_owned(),
            wall_s_per_simulated_s: 1.0,
            summary: record.summary.clone(),
            series: Vec::new(),
        };
        vec![run("bullet", None), run("rapier", None), run("rapier-from-bullet", Some("bullet"))]
    }

    fn verdicts(runs: &[CompareRun]) -> Vec<bool> {
        quantities(runs).iter().filter_map(|q| q.within_band).collect()
    }

    /// Law: no band is judged by a single value, as where the other one's is withheld, and what no
    /// grain has is no number.
    #[test]
    fn a_band_is_judged_where_every_engine_has_a_value() {
        for lacks in 0..2 {
            let mut runs = three();
            let summary = &mut runs[lacks].summary;
            (summary.poured_void_ratio, summary.void_ratio) = (None, None);
            (summary.overlap, summary.coordination_number) = (Overlap::of_none(), f64::NAN);
            let found = quantities(&runs);
            let of = |name: &str| found.iter().find(|q| q.quantity == name).expect("a row");
            let voids = of("void ratio after pouring");
            assert_eq!(voids.within_band, None, "law: run {lacks} has none: {voids:?}");
            let height = of("standing height after pouring, mean surface");
            assert_eq!(height.within_band, Some(true), "law: both have a height: {height:?}");
            for name in ["overlap, mean", "overlap, 99th percentile", "coordination number"] {
                let lacking = of(name).values.iter().map(Option::is_none);
                let expected = (0..3).map(|n| n == lacks);
                assert!(lacking.eq(expected), "law: {name} of run {lacks}: {:?}", of(name));
            }
        }
    }

    /// Law: piles are compared by their angles of repose.
    #[test]
    fn piles_are_compared_by_their_angles() {
        let mut runs = three();
        runs[1].summary = canned::pile(1, Some(38.4)).summary;
        let found = quantities(&runs);
        let angle = found.iter().find(|q| q.quantity == "angle of repose").expect("a row");
        assert_eq!(angle.values, [None, Some(38.4), None], "law: of the run with a pile");
    }

    /// Law: what runs measure of openings and regions is compared by their names, of each what any
    /// run has.
    #[test]
    fn openings_and_regions_are_compared_by_their_names() {
        let mut runs = three();
        let rows = |runs: &[CompareRun]| quantities(runs).split_off(QUANTITIES.len());
        assert!(rows(&runs).is_empty(), "law: without a laboratory there is no region");
        let stress = |mean_kpa| StressSummary {
            tensor_kpa: [[0.0; 3]; 3],
            mean_kpa,
            deviatoric_kpa: 2.0 * mean_kpa,
            asymmetry_percent: 0.0,
        };
        let region = |name: &str, void_ratio, stress| RegionSummary {
            name: name.to_owned(),
            void_ratio,
            stress,
            fabric: None,
            relative_density: None,
        };
        for (run, e) in runs.iter_mut().zip([0.8, 0.7, 0.6]) {
            let regions = vec![
                region("low", Some(e), Some(stress(10.0 * e)).filter(|_| e > 0.65)),
                region("top", None, None),
            ];
            let balance = Balance {
                weight_n: 0.0,
                carried_n: 0.0,
                sideways_n: 0.0,
                difference_percent: None,
            };
            let mouth = |rate_g_per_s| OpeningSummary {
                name: "mouth".to_owned(),
                passed_g: 100.0 * e,
                rate_g_per_s,
            };
            let openings = vec![mouth(Some(50.0).filter(|_| e < 0.75))];
            let (pieces, groups) = Default::default();
            let laboratory = LaboratorySummary { pieces, groups, balance, openings, regions };
            run.summary.laboratory = Some(laboratory);
        }
        let found = rows(&runs);
        let told: Vec<(&str, &str, &[Option<f64>])> =
            found.iter().map(|q| (q.quantity.as_str(), q.unit.as_str(), &q.values[..])).collect();
        let expected: [(&str, &str, &[Option<f64>]); 5] = [
            ("mass passed, mouth", "g", &[Some(80.0), Some(70.0), Some(60.0)]),
            ("rate, mouth", "g/s", &[None, Some(50.0), Some(50.0)]),
            ("void ratio, low", "", &[Some(0.8), Some(0.7), Some(0.6)]),
            ("mean stress, low", "kPa", &[Some(8.0), Some(7.0), None]),
            ("deviatoric stress, low", "kPa", &[Some(16.0), Some(14.0), None]),
        ];
        assert_eq!(told, expected, "law: nothing of a region that no run has");
        assert!(found.iter().all(|q| q.band.is_none()), "law: shown only, as the end is");
    }

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

    /// Law: bands are judged between runs that count, in both directions; with a run that lacks
    /// grains, or is not valid, they are not.
    #[test]
    fn bands_are_judged_between_runs_that_count() {
        let mut runs = three();
        assert_eq!(not_judged(&runs), None);
        let same = verdicts(&runs);
        assert!(!same.is_empty() && same.iter().all(|within| *within), "law: the same agree");
        let mut higher = runs[1].summary.standing_height_mm;
        higher.mean_surface *= 2.0;
        runs[1].summary.poured_height_mm = Some(higher);
        assert!(verdicts(&runs).contains(&false), "law: twice the height does not agree");

        // Handed on: no band is judged by it.
        runs[2].summary.grains.missing = Some(1000);
        assert!(verdicts(&runs).contains(&false) && not_judged(&runs).is_none());

        runs[1].summary.grains.missing = Some(1000);
        assert!(verdicts(&runs).is_empty(), "law: nothing is judged by a jammed run");
        let why = not_judged(&runs).expect("law: and it says why");
        assert!(why.starts_with("rapier (1000 of "), "law: with the run named: {why}");
    }
}
