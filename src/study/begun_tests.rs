//! What is said of runs that begin with a specimen that was poured before, and lacks grains.

use std::sync::Arc;

use crate::geometry::Pose;
use crate::protocol::{Settling, Setup};
use crate::record::{SeriesRow, StageChecks, StageRecord, StoredStage, Summary};
use crate::scenario::{BeginSpec, Scenario, StageSpec};
use crate::specimen::{Fate, SpecimenState};
use crate::study::{
    begin::Begun,
    plan::RunNodes,
    summarise::summarise,
    tests::{planned, scenario},
};

/// A pour that ended at its limit.
const MOVING: Settling = Settling { time_s: 4.0, limit_s: 4.0, settled: false };

/// A stage that a poured specimen is begun with for.
fn begins(stage: StageSpec) -> Scenario {
    let mut scenario = scenario(50.0);
    scenario.stages = vec![stage];
    scenario.begin = Some(BeginSpec {
        specimen: "run".to_owned(),
        stage: None,
        after: vec!["fill_funnel".to_owned(), "pour".to_owned()],
        key: None,
        specimen_sha256: None,
        taken_over: Vec::new(),
    });
    scenario
}

/// The summary of a run that begins with a poured specimen, changed, and rests.
fn rested(change: impl Fn(&mut SpecimenState)) -> Summary {
    let run = planned(begins(StageSpec::Rest { duration_s: 0.1 }));
    let setup = Setup::new(&run.scenario).expect("a laboratory");
    let mut state = SpecimenState::before_everything(run.grains.grains.len());
    state.cylinder = true;
    for (n, grain) in state.bodies.iter_mut().enumerate() {
        let side = |turned: bool| if turned { 0.012 } else { -0.012 };
        let height = 0.01 + 0.015 * (n / 4) as f64;
        grain.body.pose = Pose::translation(side(n % 2 == 1), side(n % 4 > 1), height);
    }
    change(&mut state);
    let poured = StageRecord { settling: Some(MOVING), ..StageRecord::default() };
    let (from, key) = Default::default();
    let begun = Begun { run: from, key, record: poured, state: state.clone() };
    let checks = Some(StageChecks { checks: 1, ..StageChecks::default() });
    let record = StageRecord { stage: "rest".to_owned(), checks, ..StageRecord::default() };
    let done = [Arc::new(StoredStage { record, state, series: Vec::new() })];
    let nodes = RunNodes { stages: vec![0], rest_test: None, begun: Some(Arc::new(begun)) };
    summarise(&run, &setup, &nodes, &done).expect("measured").summary
}

/// Law: grains that a pour has lost are missing in every later run of the specimen: they are
/// counted, a run that lacks more than 5 % of them is left out of means and says so, and of less
/// than half a specimen height and void ratio are withheld.
#[test]
fn a_begun_specimen_lacks_the_grains_that_its_pour_has_lost() {
    let count = rested(|_| ()).grains.count;
    assert!(count > 10, "expected some twenty grains, got {count}");
    let cases = [(0, false, false), (count / 5, true, false), (count - 3, true, true)];
    for (lost, left_out, withheld) in cases {
        let summary = rested(|state| {
            for grain in &mut state.bodies[..lost] {
                grain.fate = Fate::Spilled;
            }
        });
        let case = format!("{lost} of {count} grains spilled by the pour");
        assert_eq!(summary.grains.missing, Some(lost), "law: counted, {case}");
        let says = |all: &[String]| all.iter().any(|text| text.contains("are missing"));
        assert_eq!(says(&summary.left_out_of_means), left_out, "law: left out, {case}");
        assert_eq!(says(&summary.warnings), left_out, "law: and a warning, {case}");
        for field in ["standing_height_mm", "void_ratio"] {
            let why = summary.withheld.iter().find(|w| w.field == field);
            let of_few = why.is_some_and(|w| w.reason.contains("only 3 of"));
            assert_eq!(of_few, withheld, "law: {field}, {case}, got {:?}", summary.withheld);
        }
        assert_eq!(summary.void_ratio.filter(|_| withheld), None, "law: no void ratio, {case}");
    }
}

/// Law: a grain that had passed a wall before the run began is an engine failure of this specimen,
/// too.
#[test]
fn a_begun_specimen_with_a_grain_gone_through_a_wall_is_not_valid() {
    let summary = rested(|state| state.bodies[0].fate = Fate::ThroughWall);
    assert_eq!((summary.grains.escaped, summary.grains.missing), (1, Some(1)));
    let check = summary.checks.as_ref().map(|checks| checks.through_walls.worst);
    assert_eq!(check, Some(Some(1.0)), "law: its check counts it");
    assert!(!summary.valid, "law: and the run is not valid");
    assert_eq!(summary.begun_settling, Some(MOVING), "law: how its pour settled is kept");
    let told = summary.warnings.iter().any(|w| w.contains("before the run began"));
    assert!(told, "law: with a warning, got {:?}", summary.warnings);
}

/// Law: a specimen may be shaken before its plate is laid. The plate's settlement is then that of
/// the vibrations that began with it, here 99 − 95 mm in one period; the surface's is that of all,
/// 100 − 97 mm in two.
#[test]
fn a_vibration_before_the_plate_is_laid_is_none_of_the_plate() {
    let stage = |of: serde_json::Value| -> StageSpec { serde_json::from_value(of).expect("one") };
    let vibrate = serde_json::json!({
        "stage": "vibrate", "frequency_hz": 1, "amplitude_mm": 1, "duration_s": 2
    });
    let place = serde_json::json!({ "stage": "place_top_plate" });
    let mut scenario = begins(stage(vibrate.clone()));
    scenario.stages.extend([stage(place), stage(vibrate)]);
    let run = planned(scenario);
    let setup = Setup::new(&run.scenario).expect("a laboratory");
    let row = |(time_s, surface, plate_height_mm): (f64, f64, Option<f64>)| SeriesRow {
        time_s,
        plate_height_mm,
        mean_surface_mm: Some(surface),
        surface_settlement_mm: Some(100.0 - surface),
        ..SeriesRow::default()
    };
    let rows = [
        [(0.0, 100.0, None), (2.0, 98.0, None), (2.5, 98.0, None)],
        [(2.5, 98.0, Some(105.0)), (3.0, 98.0, Some(99.0)), (3.5, 98.0, Some(99.0))],
        [(3.5, 98.0, Some(99.0)), (5.5, 97.0, Some(94.0)), (6.0, 97.0, Some(95.0))],
    ];
    let mut state = SpecimenState::before_everything(run.grains.grains.len());
    state.cylinder = true;
    let done = rows.map(|rows| {
        let series = rows.map(row).to_vec();
        let record = StageRecord::default();
        Arc::new(StoredStage { record, state: state.clone(), series })
    });
    let nodes = RunNodes { stages: vec![0, 1, 2], rest_test: None, begun: None };
    let summary = summarise(&run, &setup, &nodes, &done).expect("law: it is measured").summary;
    for (what, of, expected, periods) in [
        ("plate", &summary.settlement_mm, 4.0, 1),
        ("surface", &summary.surface_settlement_mm, 3.0, 2),
    ] {
        let got = of.as_ref().expect("law: it settles");
        assert!(
            (got.final_mm - expected).abs() < 1e-9,
            "law: {what}, expected {expected} mm, got {} mm, tolerance 1e-9 mm",
            got.final_mm
        );
        assert_eq!(got.after_each_period.len(), periods, "law: its periods, {what}");
    }
    assert_eq!(summary.vibrations.len(), 2, "law: both are vibrations");
}
