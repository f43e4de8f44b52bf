//! Plans, the store and what happens when something goes wrong; and what tests of studies share.

use std::{
    fs,
    path::{Path, PathBuf},
    sync::{Arc, Mutex, atomic::AtomicBool},
};

use super::{
    RunOptions, StudyError,
    execute::Shop,
    plan::{Node, Plan, PlannedRun},
    summarise::summarise,
};
use crate::geometry::Vector;
use crate::grains::generate;
use crate::protocol::{Progress, Silent, WorldMaker};
use crate::record::{AskedStage, RunKind, StageStore, StoredStage};
use crate::scenario::{GrainsSpec, Scenario, StageSpec};
use crate::world::{BodyState, World, scripted::ScriptedWorld};

pub(super) fn scenario(falling_height_mm: f64) -> Scenario {
    serde_json::from_value(serde_json::json!({
        "name": "test",
        "grains": {
            "total_mass_g": 40, "density_kg_per_m3": 2673.9,
            "sieve_table": [{ "passing_mm": 12.5, "retained_mm": 10, "mass_percent": 100 }]
        },
        "engine": { "iterations": 10 },
        "rest_test_s": 0.2,
        "stages": [
            { "stage": "fill_funnel" },
            { "stage": "pour", "falling_height_mm": falling_height_mm },
        ]
    }))
    .expect("a scenario")
}

/// A scenario whose grains nobody makes.
pub(super) fn bare_scenario() -> Scenario {
    serde_json::from_value(serde_json::json!({
        "name": "s", "grains": { "file": "g.json" }, "stages": [{ "stage": "fill_funnel" }]
    }))
    .expect("a scenario")
}

/// Results go into a folder, and nobody listens.
pub(super) fn run_options(out: impl Into<PathBuf>) -> RunOptions {
    let (out, progress) = (out.into(), Arc::new(Silent));
    RunOptions { out, jobs: 2, frames: false, cancel: Arc::default(), progress }
}

/// Keeps what is said.
#[derive(Default)]
pub(super) struct Heard(Mutex<Vec<String>>);

impl Heard {
    /// What was said, in order.
    pub(super) fn told(self) -> Vec<String> {
        self.0.into_inner().expect("nobody panicked")
    }
}

impl Progress for Heard {
    fn message(&self, text: &str) {
        self.0.lock().expect("nobody panicked").push(text.to_owned());
    }
}

pub(super) fn planned(scenario: Scenario) -> PlannedRun {
    let GrainsSpec::Sieved(spec) = &scenario.grains else { panic!("sieved") };
    let grains = Arc::new(generate(spec, scenario.seed).expect("grains"));
    PlannedRun { name: "test".into(), kind: RunKind::Pluviation, scenario, grains, prepared: None }
}

fn plan(runs: &[PlannedRun]) -> Plan {
    Plan::new(runs).expect("a plan")
}

/// Works in a store on a number of cores, and cannot be stopped.
pub(super) fn shop<'a>(
    store: &'a StageStore,
    cores: usize,
    make_world: WorldMaker<'a>,
    progress: &'a dyn Progress,
) -> Shop<'a> {
    static CANCEL: AtomicBool = AtomicBool::new(false);
    Shop { store, make_world, cancel: &CANCEL, progress, cores }
}

type Done = Result<Vec<Arc<StoredStage>>, StudyError>;

fn carry_out(plan: &Plan, folder: &Path, jobs: usize) -> Done {
    let _turn = crate::world::shared_turn();
    let store = StageStore::open(folder).expect("a store");
    shop(&store, jobs, &crate::world::create, &Silent).execute(plan)
}

/// Notes whether stages were stored when it was said that they ended.
struct Announced<'a> {
    plan: &'a Plan,
    folder: &'a Path,
    stored: Mutex<Vec<bool>>,
}

impl Progress for Announced<'_> {
    fn end_stage(&self, id: u64) {
        let key = self.plan.nodes[id as usize].key();
        let record = StageStore::folder_in(self.folder, key).join("stage.json");
        self.stored.lock().expect("nobody panicked").push(record.is_file());
    }
    fn message(&self, _: &str) {}
}

/// Law: a stage has not ended before it is stored; with the power gone meanwhile it is lost.
#[test]
fn a_stage_is_said_to_have_ended_when_it_is_stored() {
    let _turn = crate::world::shared_turn();
    let plan = plan(&[planned(scenario(0.0))]);
    let folder = tempfile::tempdir().expect("a folder");
    let store = StageStore::open(folder.path()).expect("a store");
    let told = Announced { plan: &plan, folder: folder.path(), stored: Mutex::default() };
    shop(&store, 1, &crate::world::create, &told).execute(&plan).expect("done");
    let stored = told.stored.into_inner().expect("nobody panicked");
    assert_eq!(stored, vec![true; plan.nodes.len()], "law: each was stored when it was announced");
}

/// The parts of stored stages that must not depend on anything but the plan.
fn bits(done: &[Arc<StoredStage>]) -> Vec<(String, String)> {
    done.iter()
        .map(|s| (s.record.specimen_sha256.clone(), s.record.series_sha256.clone()))
        .collect()
}

#[test]
fn runs_share_the_stages_they_have_in_common_and_no_others() {
    let runs = [planned(scenario(0.0)), planned(scenario(50.0))];
    let plan = plan(&runs);
    // One filling; two pours; two rest tests.
    assert_eq!(plan.nodes.len(), 5);
    assert_eq!(plan.runs[0].stages[0], plan.runs[1].stages[0]);
    assert_ne!(plan.runs[0].stages[1], plan.runs[1].stages[1]);
    let first = |change: &dyn Fn(&mut Scenario)| {
        let mut other = scenario(0.0);
        change(&mut other);
        self::plan(&[planned(other)]).nodes[0].key().to_owned()
    };
    let same = first(&|s| {
        s.name = "another".into();
        s.notes = vec!["note".into()];
        s.sample_interval_s = Some(0.08);
        s.stages.pop();
    });
    assert_eq!(same, plan.nodes[0].key(), "names, notes and later stages do not act on a stage");
    let field = plan.nodes[0].identity.determined_by.get("sample_interval_s");
    assert_eq!(field, None, "law: keys of samples at the paper's interval stay as they were");
    let changes: [&dyn Fn(&mut Scenario); 7] = [
        &|s| s.seed = 2,
        &|s| s.configuration = 2,
        &|s| s.engine.rate_hz = 960.0,
        &|s| s.contact.restitution = 0.3,
        &|s| s.gravity_m_per_s2 = 9.8,
        &|s| s.sample_interval_s = Some(0.04),
        &|s| s.stages[0] = StageSpec::FillFunnel { time_limit_s: 3.0 },
    ];
    for (index, change) in changes.into_iter().enumerate() {
        assert_ne!(first(change), plan.nodes[0].key(), "change {index} must give another key");
    }
}

#[test]
fn same_bits_on_one_thread_or_two_and_when_resumed_in_the_middle() {
    let runs = [planned(scenario(0.0)), planned(scenario(50.0))];
    let plan = plan(&runs);
    let (one, two) = (tempfile::tempdir().expect("folder"), tempfile::tempdir().expect("folder"));
    let serial = bits(&carry_out(&plan, one.path(), 1).expect("done"));
    let parallel = bits(&carry_out(&plan, two.path(), 2).expect("done"));
    assert_eq!(serial, parallel, "law: same input, same bits, whatever the threads");

    // As if killed in the middle: a later stage missing, leftovers lying about.
    let store = StageStore::open(two.path()).expect("a store");
    let last = plan.runs[1].stages[1];
    fs::remove_dir_all(store.folder(plan.nodes[last].key())).expect("removed");
    fs::create_dir(two.path().join(".part-killed")).expect("a leftover");
    drop(store);
    let resumed = bits(&carry_out(&plan, two.path(), 2).expect("done"));
    assert_eq!(serial, resumed, "law: resumed, the same bits as uninterrupted");
    assert!(!two.path().join(".part-killed").exists(), "and leftovers are gone");

    // A damaged file is noticed and its stage done again.
    let store = StageStore::open(two.path()).expect("a store");
    let damaged = store.folder(plan.nodes[last].key()).join("specimen.json");
    let mut content = fs::read_to_string(&damaged).expect("read");
    content = content.replacen('1', "2", 1);
    fs::write(&damaged, content).expect("written");
    let before = plan.nodes[last].parent.expect("a pour goes on from a filling");
    let asked = AskedStage {
        identity: &plan.nodes[last].identity,
        began_with: Some(&serial[before].0),
        plausible: &|_| Ok(()),
    };
    assert!(store.load(&asked).1.is_some_and(|why| why.contains("specimen.json")));
    let again = bits(&carry_out(&plan, two.path(), 1).expect("done"));
    assert_eq!(serial, again);
}

#[test]
fn a_summary_tells_where_every_grain_is() {
    let run = planned(scenario(50.0));
    let plan = plan(std::slice::from_ref(&run));
    let folder = tempfile::tempdir().expect("folder");
    let done = carry_out(&plan, folder.path(), 2).expect("done");
    let setup = &plan.nodes[0].setup;
    let result = summarise(&run, setup, &plan.runs[0], &done).expect("measured");
    let s = &result.summary;
    let accounted =
        s.grains.in_cylinder + s.grains.escaped + s.grains.spilled + s.grains.left_in_funnel;
    assert_eq!(accounted, s.grains.count, "law: every grain is somewhere");
    assert_eq!(s.grains.escaped, 0, "law: nothing passes a wall: {:?}", s.warnings);
    // These grains cover the floor no more than once.
    assert_eq!((s.void_ratio, s.porosity), (None, None), "law: no layer, no void ratio");
    let why = s.withheld.iter().find(|w| w.field == "void_ratio");
    assert!(
        why.is_some_and(|w| w.reason.contains("below 3 median grains")),
        "law: with the reason"
    );
    assert!(s.rest_test.is_some() && s.creep_um_per_s.is_some());
    assert!(s.settlement_mm.is_none(), "nothing was shaken");
    assert_eq!(s.falling_height_mm, Some(50.0));
    let sieve = s.sieve_analysis.as_ref().expect("sieved");
    let secondary = sieve.secondary.as_ref().expect("sieved anew");
    assert!(secondary.unchanged, "law: rigid grains stay as they are: {secondary:?}");
    assert!(
        secondary.largest_change_percent.is_some_and(|change| change > 0.0),
        "what is compared went through the engine, which rounds: {secondary:?}"
    );
    let apart = secondary.spilled + secondary.left_in_funnel;
    assert_eq!(secondary.grains + apart, s.grains.count, "law: every grain is accounted for");
    let found: usize = sieve.fractions.iter().map(|f| f.grains).sum();
    assert_eq!(found, s.grains.count, "law: every grain is in one fraction: {sieve:?}");
    assert_eq!(result.series.last().map(|r| r.stage), Some(1), "the rest test is kept apart");
}

/// Law: a deposit with a speed of its own is carried out with that, all other stages with the
/// engine's.
#[test]
fn a_deposit_pushes_overlaps_apart_at_its_own_speed() {
    let speeds = |own: serde_json::Value| -> Vec<(f64, String)> {
        let mut value = serde_json::json!({
            "name": "calm",
            "grains": {
                "total_mass_g": 40, "density_kg_per_m3": 2673.9,
                "sieve_table": [{ "passing_mm": 12.5, "retained_mm": 10, "mass_percent": 100 }]
            },
            "pieces": [{ "name": "box", "shape": { "box": { "inner_mm": [36, 36, 80] } } }],
            "engine": { "native": { "max_depenetration_velocity_m_per_s": 3 } },
            "stages": [{ "stage": "deposit", "at_mm": [0, 0, 60], "area_mm": [12, 12], "rate_g_per_s": 80 },
                { "stage": "rest", "duration_s": 1 }]
        });
        value["stages"][0]["max_depenetration_velocity_m_per_s"] = own;
        let scenario = serde_json::from_value(value).expect("a scenario");
        let nodes = plan(&[planned(scenario)]).nodes;
        let of = |node: &Node| {
            let speed = node.setup.engine.native.max_depenetration_velocity_m_per_s;
            (speed, node.key().to_owned())
        };
        nodes.iter().map(of).collect()
    };
    let (calm, plain) = (speeds(serde_json::json!(0.2)), speeds(serde_json::Value::Null));
    assert_eq!((calm[0].0, calm[1].0), (0.2, 3.0), "law: its own, then the engine's");
    assert_eq!((plain[0].0, plain[1].0), (3.0, 3.0), "law: without one, the engine's");
    assert_ne!(calm[0].1, plain[0].1, "law: what is stored of one is not taken for the other");
}

/// Law: a grain that was pressed through the floor has escaped, and its run is not valid; heights
/// and void ratio of what was mostly spilled are withheld, with the reason.
#[test]
fn grains_below_the_floor_and_spilled_specimens_are_no_result() {
    let run = planned(scenario(50.0));
    let plan = plan(std::slice::from_ref(&run));
    let folder = tempfile::tempdir().expect("folder");
    let done = carry_out(&plan, folder.path(), 2).expect("done");
    let setup = &plan.nodes[0].setup;
    let with = |change: &dyn Fn(&mut crate::specimen::SpecimenState)| {
        let mut done = done.clone();
        for stage in &mut done[1..] {
            let mut changed = StoredStage::clone(stage);
            change(&mut changed.state);
            *stage = Arc::new(changed);
        }
        summarise(&run, setup, &plan.runs[0], &done).expect("measured").summary
    };
    let sum =
        |g: &crate::record::GrainsSummary| g.in_cylinder + g.left_in_funnel + g.spilled + g.escaped;
    let pressed = with(&|state| {
        for grain in &mut state.bodies[..2] {
            grain.body.pose.translation.vector = Vector::new(0.0, 0.0, -0.001);
        }
        // What was not fed counts as left.
        state.bodies[2].fate = crate::specimen::Fate::Waiting;
    });
    assert_eq!((pressed.grains.escaped, sum(&pressed.grains)), (2, pressed.grains.count));
    let checks = pressed.checks.as_ref().expect("checks");
    assert_eq!(checks.through_walls.worst, Some(2.0), "law: counted once in all stages");
    assert_eq!(checks.through_walls.passed, Some(false), "law: the check failed");
    assert!(!pressed.valid, "law: and the run is not valid");
    let told = pressed.warnings.iter().find(|w| w.contains("below the floor"));
    let when = "2 grains lay with the centroid below the floor or in a wall (2 at the end of stage \
                1, pour, 2 at the end of the rest test)";
    assert!(told.is_some_and(|w| w.starts_with(when)), "law: and when: {:?}", pressed.warnings);

    let spilled = with(&|state| {
        for grain in state.bodies.iter_mut().skip(3) {
            grain.fate = crate::specimen::Fate::Spilled;
        }
    });
    assert_eq!(sum(&spilled.grains), spilled.grains.count, "law: every grain is somewhere");
    assert_eq!((spilled.void_ratio, spilled.porosity), (None, None), "law: they make no sense");
    assert_eq!(spilled.standing_height_mm.mean(), None, "law: nor do heights");
    for field in ["standing_height_mm", "void_ratio", "porosity", "poured_void_ratio"] {
        let why = spilled.withheld.iter().find(|w| w.field == field);
        let why = why.unwrap_or_else(|| panic!("law: `{field}` is withheld: {spilled:?}"));
        assert!(why.reason.contains("only 3 of"), "law: with the reason, got {}", why.reason);
    }
    let told = spilled.warnings.iter().any(|w| w.contains("are missing in the specimen"));
    assert!(told, "law: and a warning says what is missing: {:?}", spilled.warnings);
}

/// Runs a run whose engine is given other grains than those of the run, and sieves them anew.
fn sieved_anew(
    tamper: impl Fn(&mut crate::grains::GrainSet),
    damage: impl Fn(&mut StoredStage),
) -> (crate::record::SecondarySieve, Vec<String>) {
    let run = planned(scenario(50.0));
    let mut other = run.clone();
    tamper(Arc::make_mut(&mut other.grains));
    let plan = plan(std::slice::from_ref(&other));
    let folder = tempfile::tempdir().expect("folder");
    let mut done = carry_out(&plan, folder.path(), 2).expect("done");
    let last = plan.runs[0].stages[1];
    damage(Arc::make_mut(&mut done[last]));
    let setup = &plan.nodes[0].setup;
    let summary = summarise(&run, setup, &plan.runs[0], &done).expect("measured").summary;
    let sieve = summary.sieve_analysis.expect("sieved");
    (sieve.secondary.expect("sieved anew"), summary.warnings)
}

#[test]
fn the_secondary_sieve_notices_grains_that_were_tampered_with() {
    let told = |warnings: &[String]| warnings.iter().any(|w| w.contains("secondary sieve"));
    let (secondary, warnings) = sieved_anew(|_| (), |_| ());
    assert!(secondary.unchanged && !told(&warnings), "nothing was done to them: {secondary:?}");
    let (secondary, warnings) = sieved_anew(
        |grains| {
            let shape = &mut grains.grains[4].shape;
            *shape = Arc::new(shape.scaled(0.999));
        },
        |_| (),
    );
    assert!(!secondary.unchanged && told(&warnings), "one is smaller: {secondary:?}");
    assert_eq!((secondary.changed, secondary.lost), (1, 0), "{secondary:?}");
    let change = secondary.largest_change_percent.expect("a number");
    assert!((change - 0.1).abs() < 1e-3, "changed by 0.1 %, got {change} %");
    let (secondary, warnings) = sieved_anew(|_| (), |stage| stage.record.sieved_mm[4] = None);
    assert!(!secondary.unchanged && told(&warnings), "one is not in the engine: {secondary:?}");
    assert_eq!((secondary.changed, secondary.lost), (0, 1), "{secondary:?}");
    let (secondary, _) = sieved_anew(
        |_| (),
        |stage| {
            stage.record.sieved_mm[4] = None;
            stage.state.bodies[4].fate = crate::specimen::Fate::ThroughWall;
        },
    );
    assert_eq!(secondary.lost, 1, "one passed a wall: {secondary:?}");
    let (secondary, _) = sieved_anew(
        |_| (),
        |stage| {
            stage.record.sieved_mm[4] = None;
            stage.state.bodies[4].fate = crate::specimen::Fate::Spilled;
        },
    );
    assert!(secondary.unchanged && secondary.spilled == 1, "one spilled: {secondary:?}");
}

#[test]
fn a_blown_up_simulation_names_the_stage_and_keeps_the_last_good_specimen() {
    let run = planned(scenario(0.0));
    let plan = plan(std::slice::from_ref(&run));
    let folder = tempfile::tempdir().expect("folder");
    let store = StageStore::open(folder.path()).expect("a store");
    let exploding = ScriptedWorld::new;
    let make_world: WorldMaker = &|_, _, _| {
        let script = |_, state: &BodyState, step, _| BodyState {
            linear_velocity: Vector::new(if step < 20 { 1.0 } else { 1e9 }, 0.0, 0.0),
            ..*state
        };
        Ok(Box::new(exploding(1.0 / 240.0, Box::new(script))) as Box<dyn World + Send>)
    };
    let done = shop(&store, 2, make_world, &Silent).execute(&plan);
    let error = done.expect_err("1e9 m/s must not pass");
    let StudyError::Simulation { stage, what, kept } = error else { panic!("{error}") };
    assert!(stage.contains("fill the funnel") && what.contains("speed"), "{stage}: {what}");
    let content = fs::read_to_string(&kept).expect("kept");
    assert!(content.contains("last_good"), "{}", kept.display());
    let content: serde_json::Value = serde_json::from_str(&content).expect("JSON");
    let warned = content["warnings"][0].as_str().unwrap_or_default();
    let words = "unexplained energy gain";
    assert!(warned.contains(words), "law: what was said before, got {}", content["warnings"]);
}

#[test]
fn what_fails_does_not_stop_the_rest() {
    let [good, mut bad] = [planned(scenario(0.0)), planned(scenario(0.0))];
    bad.scenario.engine.iterations = 11;
    let plan = plan(&[good, bad]);
    let folder = tempfile::tempdir().expect("folder");
    let store = StageStore::open(folder.path()).expect("a store");
    let resting = |settings: &crate::scenario::EngineSettings, _, _: &_| {
        if settings.iterations == 11 {
            return Err(crate::world::WorldError::Engine("refused".into()));
        }
        let script = |_, state: &BodyState, _, _| *state;
        Ok(Box::new(ScriptedWorld::new(1.0 / 240.0, Box::new(script))) as Box<dyn World + Send>)
    };
    let executed = shop(&store, 2, &resting, &Silent).execute_each(&plan);
    let done = |run: usize| plan.runs[run].stages.iter().all(|n| executed.done[*n].is_some());
    assert!(done(0) && !done(1), "law: the run that can be run is");
    let [(node, StudyError::Simulation { what, .. })] = executed.failed.as_slice() else {
        panic!("expected one failure, got {:?}", executed.failed)
    };
    assert_eq!(*node, plan.runs[1].stages[0], "law: the failure names its stage");
    assert!(what.contains("refused") && !executed.cancelled, "{what}");
}

/// Law: a panic in one stage is an error of that stage; what does not need it is
/// finished, and whoever waits for it is not left waiting.
#[test]
fn a_panic_in_a_stage_ends_that_stage_alone() {
    let [good, mut bad] = [planned(scenario(0.0)), planned(scenario(0.0))];
    bad.scenario.engine.iterations = 11;
    let plan = plan(&[good, bad]);
    let (ended, end) = std::sync::mpsc::channel();
    let of_thread = plan.clone();
    std::thread::spawn(move || {
        let plan = of_thread;
        let folder = tempfile::tempdir().expect("folder");
        let store = StageStore::open(folder.path()).expect("a store");
        let failing = |settings: &crate::scenario::EngineSettings, _, _: &_| {
            assert!(settings.iterations != 11, "a fault made on purpose");
            let script = |_, state: &BodyState, _, _| *state;
            Ok(Box::new(ScriptedWorld::new(1.0 / 240.0, Box::new(script))) as Box<dyn World + Send>)
        };
        let executed = shop(&store, 2, &failing, &Silent).execute_each(&plan);
        let _ = ended.send(executed);
    });
    let executed = end
        .recv_timeout(std::time::Duration::from_secs(120))
        .expect("law: it ends; expected within seconds, got nothing in 120 s");
    let done = |run: usize| plan.runs[run].stages.iter().all(|n| executed.done[*n].is_some());
    assert!(done(0) && !done(1), "law: the run without the fault is finished");
    let [(node, StudyError::Fault { stage, what })] = executed.failed.as_slice() else {
        panic!("expected one failure, got {:?}", executed.failed)
    };
    assert_eq!(*node, plan.runs[1].stages[0], "law: the failure names its stage");
    assert!(what.contains("made on purpose") && stage.contains("funnel"), "{stage}: {what}");
}
