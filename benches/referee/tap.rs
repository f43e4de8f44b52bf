//! A world that hands over the contact problems of its sub-steps.

#[macro_use]
#[path = "../../src/world/testing/handed_on.rs"]
mod handed_on;

use std::{
    collections::BTreeSet,
    sync::{Arc, Mutex, MutexGuard, PoisonError},
};

use pluvia::{
    geometry::{Pose, Vector},
    scenario::EngineSettings,
    world::{
        Body, BodyId, BodyState, Contact, EffectiveSettings, HeldShape, PairCoefficients,
        PairTable, PhaseTimes, RememberedContact, Snapshot, World, WorldError,
        bullet::{BulletBackend, SubstepRecord},
    },
};

/// What is recorded of the worlds of a stage.
#[derive(Default)]
pub struct Tap {
    /// Steps of the stage whose last sub-step is wanted.
    pub due: BTreeSet<u64>,
    step: u64,
    /// Those that came.
    pub records: Vec<(u64, SubstepRecord)>,
}

/// A world that hands over its contact problem in the steps that are due.
pub struct Tapped {
    world: BulletBackend,
    tap: Arc<Mutex<Tap>>,
}

/// What others share of a tap; a thread that panicked leaves nothing half done there.
pub fn locked(tap: &Mutex<Tap>) -> MutexGuard<'_, Tap> {
    tap.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Tapped {
    /// Makes a world that hands over to `tap`, whichever world of the stage it is.
    pub fn make(
        settings: &EngineSettings,
        gravity: Vector,
        pairs: &PairTable,
        tap: &Arc<Mutex<Tap>>,
    ) -> Result<Box<dyn World + Send>, WorldError> {
        let mut world = BulletBackend::new(settings, gravity, pairs)?;
        if !locked(tap).due.is_empty() {
            world.record_substeps();
        }
        Ok(Box::new(Self { world, tap: tap.clone() }))
    }
}

impl World for Tapped {
    handed_on!(world:
        fn add(&mut self, body: &Body) -> Result<BodyId, WorldError>;
        fn remove(&mut self, id: BodyId) -> Result<(), WorldError>;
        fn drive(&mut self, id: BodyId, pose_at_end_of_step: &Pose) -> Result<(), WorldError>;
        fn recall_drive(&mut self, id: BodyId, ends: &[Pose; 3]) -> Result<(), WorldError>;
        fn press(&mut self, id: BodyId, force: f64) -> Result<(), WorldError>;
        fn read_body(&self, id: BodyId) -> Result<BodyState, WorldError>;
        fn time_step(&self) -> f64;
        fn read(&self, into: &mut Snapshot);
        fn contacts(&self, into: &mut Vec<Contact>);
        fn remember(&self, into: &mut Vec<RememberedContact>);
        fn join(&mut self, part: BodyId, whole: BodyId) -> Result<(), WorldError>;
        fn recall(&mut self, contacts: &[RememberedContact]) -> Result<(), WorldError>;
        fn corners(&self, into: &mut Vec<Option<HeldShape>>);
        fn phases(&self) -> Option<PhaseTimes>;
        fn solver_residual(&self) -> Option<f64>;
        fn pair_coefficients(&self, a: BodyId, b: BodyId) -> Result<PairCoefficients, WorldError>;
        fn effective(&self) -> EffectiveSettings;
    );

    fn step(&mut self) -> Result<(), WorldError> {
        self.world.step()?;
        let mut tap = locked(&self.tap);
        tap.step += 1;
        let step = tap.step;
        if tap.due.contains(&step) {
            tap.records.push((step, self.world.recorded_substep()));
        }
        Ok(())
    }
}
