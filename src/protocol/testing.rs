//! What the tests of stages share: few grains, who watches, and worlds that follow a script.

use std::sync::{Arc, atomic::AtomicBool};

pub(super) use serde_json::{Value, json};

use super::*;
pub(super) use crate::geometry::testing::near;
use crate::grains::generate;
use crate::scenario::{GrainsSpec, Scenario};
use crate::world::{World, scripted::ScriptedWorld};

/// Length of a step in s at the default rate.
pub(super) const STEP: f64 = 1.0 / 480.0;

/// A scenario of some fields; without a sieve table its grains are of 10 to 12.5 mm.
pub(super) fn scenario_of(mut fields: Value) -> Scenario {
    let table = &mut fields["grains"]["sieve_table"];
    if table.is_null() {
        *table = json!([{ "passing_mm": 12.5, "retained_mm": 10, "mass_percent": 100 }]);
    }
    fields["name"] = "test".into();
    fields["stages"] = json!([]);
    serde_json::from_value(fields).expect("a scenario")
}

/// The grains of a scenario before its first stage.
pub(super) fn specimen_of(scenario: &Scenario, seed: u64) -> Specimen {
    let GrainsSpec::Sieved(spec) = &scenario.grains else { panic!("sieved") };
    let grains = Arc::new(generate(spec, seed).expect("grains"));
    let state = SpecimenState::before_everything(grains.grains.len());
    Specimen { grains, state }
}

pub(super) fn stage(value: Value) -> StageSpec {
    serde_json::from_value(value).expect("a stage")
}

/// Runs a stage in the laboratory of a scenario, from where it was interrupted.
pub(super) fn run_stage(
    scenario: &Scenario,
    make_world: WorldMaker,
    specimen: Specimen,
    stage: &StageSpec,
    midway: Option<Midway>,
    observer: &mut dyn Observer,
) -> Result<StageOutcome, StageError> {
    let setup = Setup::new(scenario).expect("a laboratory");
    let never = AtomicBool::new(false);
    run(&setup, make_world, specimen, stage, midway, observer, &never)
}

/// Makes worlds that follow a script.
pub(super) fn scripted_worlds(
    make: impl Fn() -> ScriptedWorld + Sync,
) -> impl Fn(&EngineSettings, Vector, &PairTable) -> Result<Box<dyn World + Send>, WorldError> + Sync
{
    move |_, _, _| Ok(Box::new(make()) as Box<dyn World + Send>)
}

/// A world in which nothing moves until the speeds of free bodies are no numbers, from step 100 on.
pub(super) fn exploding() -> ScriptedWorld {
    let script = |_, state: &BodyState, step: u64, _| {
        let speed = if step < 100 { 0.0 } else { f64::NAN };
        BodyState { linear_velocity: Vector::new(speed, 0.0, 0.0), ..*state }
    };
    ScriptedWorld::new(STEP, Box::new(script))
}

/// Keeps where a stage could go on.
#[derive(Default)]
struct Seams(Vec<Midway>);

impl Observer for Seams {
    fn observe(&mut self, _: &Specimen, _: Moment) {}

    fn seam(&mut self, midway: &Midway) -> ControlFlow<()> {
        self.0.push(midway.clone());
        ControlFlow::Continue(())
    }
}

/// What a stage leaves in the engine, and its seams; it leaves the same bits where it goes on from
/// these of them or from the last two, as files keep them.
pub(super) fn same_from_seams(
    scenario: &Scenario,
    before: &Specimen,
    stage: &StageSpec,
    also_from: &[usize],
) -> (StageOutcome, Vec<Midway>) {
    let go = |midway: Option<Midway>| {
        let (make, mut seams) = (&crate::world::create, Seams::default());
        let outcome = run_stage(scenario, make, before.clone(), stage, midway, &mut seams);
        (outcome.expect("it runs"), seams.0)
    };
    let (whole, seams) = go(None);
    let count = seams.len();
    assert!(count >= 2, "the check sees segments, {count}");
    for n in also_from.iter().copied().chain([count - 2, count - 1]) {
        let text = serde_json::to_string(&seams[n]).expect("JSON");
        let midway: Midway = serde_json::from_str(&text).expect("a checkpoint");
        midway.check(before.grains.grains.len()).expect("a sound checkpoint");
        assert_eq!(midway.state.pieces, seams[n].state.pieces, "law: a file keeps every bit");
        let (got, _) = go(Some(midway));
        assert_eq!(got.steps, whole.steps, "law: the same end from seam {n}");
        assert_eq!(got.specimen.state, whole.specimen.state, "law: the same from seam {n}");
        assert_eq!(got.until, whole.until, "law: told alike from seam {n}");
        assert_eq!(got.fall, whole.fall, "law: the same fall from seam {n}");
    }
    (whole, seams)
}
