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

/// Keeps where a stage could go on.
#[derive(Default)]
pub(super) struct Seams(pub Vec<Midway>);

impl Observer for Seams {
    fn observe(&mut self, _: &Specimen, _: Moment) {}

    fn seam(&mut self, midway: &Midway) -> ControlFlow<()> {
        self.0.push(midway.clone());
        ControlFlow::Continue(())
    }
}

/// A checkpoint as a file keeps it.
pub(super) fn stored(midway: &Midway) -> Midway {
    let text = serde_json::to_string(midway).expect("JSON");
    serde_json::from_str(&text).expect("a checkpoint")
}
