//! A world that hands over the contact problems of its sub-steps.

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
    fn add(&mut self, body: &Body) -> Result<BodyId, WorldError> {
        self.world.add(body)
    }
    fn remove(&mut self, id: BodyId) -> Result<(), WorldError> {
        self.world.remove(id)
    }
    fn drive(&mut self, id: BodyId, pose_at_end_of_step: &Pose) -> Result<(), WorldError> {
        self.world.drive(id, pose_at_end_of_step)
    }
    fn recall_drive(&mut self, id: BodyId, ends: &[Pose; 3]) -> Result<(), WorldError> {
        self.world.recall_drive(id, ends)
    }
    fn press(&mut self, id: BodyId, force: f64) -> Result<(), WorldError> {
        self.world.press(id, force)
    }
    fn read_body(&self, id: BodyId) -> Result<BodyState, WorldError> {
        self.world.read_body(id)
    }
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
    fn time_step(&self) -> f64 {
        self.world.time_step()
    }
    fn read(&self, into: &mut Snapshot) {
        self.world.read(into);
    }
    fn contacts(&self, into: &mut Vec<Contact>) {
        self.world.contacts(into);
    }
    fn remember(&self, into: &mut Vec<RememberedContact>) {
        self.world.remember(into);
    }
    fn join(&mut self, part: BodyId, whole: BodyId) -> Result<(), WorldError> {
        self.world.join(part, whole)
    }
    fn recall(&mut self, contacts: &[RememberedContact]) -> Result<(), WorldError> {
        self.world.recall(contacts)
    }
    fn corners(&self, into: &mut Vec<Option<HeldShape>>) {
        self.world.corners(into);
    }
    fn phases(&self) -> Option<PhaseTimes> {
        self.world.phases()
    }
    fn solver_residual(&self) -> Option<f64> {
        self.world.solver_residual()
    }
    fn pair_coefficients(&self, a: BodyId, b: BodyId) -> Result<PairCoefficients, WorldError> {
        self.world.pair_coefficients(a, b)
    }
    fn effective(&self) -> EffectiveSettings {
        self.world.effective()
    }
}
