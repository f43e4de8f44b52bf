//! Wrong physics, put between the experiments and the engine.

#[macro_use]
#[path = "../../../src/world/testing/handed_on.rs"]
mod handed_on;

use pluvia::geometry::{Pose, Vector};
use pluvia::scenario::EngineSettings;
use pluvia::world::{
    Body, BodyId, BodyState, Contact, EffectiveSettings, HeldShape, Motion, PairCoefficients,
    PairTable, PhaseTimes, RememberedContact, Snapshot, World, WorldError, create,
};

/// What is wrong.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Defect {
    /// Free bodies get the inertia of their bounding box, as engines made for
    /// games give it.
    BoundingBoxInertia,
    /// The coefficients of a pair are multiplied with themselves.
    ProductRule,
    /// Friction acts along one direction of the contact plane only.
    OneFrictionDirection,
    /// Every free body seems to sink, ever so slowly.
    Drift,
    /// Nothing ever rebounds.
    NoRebound,
}

/// Apparent sinking in m/s: 0.2 mm in 20 s, twice what a packing is allowed.
const DRIFT: f64 = 2e-4 / 20.0;

/// A maker of worlds with a defect.
pub fn made_with(
    defect: Defect,
) -> impl Fn(&EngineSettings, Vector, &PairTable) -> Result<Box<dyn World + Send>, WorldError> + Sync
{
    move |settings, gravity, pairs| {
        let (mut settings, mut pairs) = (settings.clone(), pairs.clone());
        if [Defect::ProductRule, Defect::NoRebound].contains(&defect) {
            let all = pairs.materials();
            for (n, a) in all.iter().enumerate() {
                for b in &all[n..] {
                    let mut pair = pairs.get(*a, *b);
                    if defect == Defect::NoRebound {
                        pair.restitution = 0.0;
                    } else {
                        pair.friction *= pair.friction;
                        pair.restitution *= pair.restitution;
                    }
                    pairs.set(*a, *b, pair);
                }
            }
        }
        if defect == Defect::OneFrictionDirection {
            settings.friction_directions = 1;
        }
        let down = gravity.normalize();
        let inner = create(&settings, gravity, &pairs)?;
        Ok(Box::new(Defective { inner, defect, down, steps: 0, free: Vec::new() }))
    }
}

struct Defective {
    inner: Box<dyn World + Send>,
    defect: Defect,
    down: Vector,
    steps: u32,
    free: Vec<bool>,
}

impl Defective {
    /// How far free bodies seem to have sunk, in m.
    fn sunk(&self) -> Vector {
        let drift = if self.defect == Defect::Drift { DRIFT } else { 0.0 };
        self.down * (drift * f64::from(self.steps) * self.inner.time_step())
    }
}

impl World for Defective {
    handed_on!(inner:
        fn remove(&mut self, id: BodyId) -> Result<(), WorldError>;
        fn drive(&mut self, id: BodyId, pose: &Pose) -> Result<(), WorldError>;
        fn recall_drive(&mut self, id: BodyId, ends: &[Pose; 3]) -> Result<(), WorldError>;
        fn press(&mut self, id: BodyId, force: f64) -> Result<(), WorldError>;
        fn join(&mut self, part: BodyId, whole: BodyId) -> Result<(), WorldError>;
        fn time_step(&self) -> f64;
        fn contacts(&self, into: &mut Vec<Contact>);
        fn remember(&self, into: &mut Vec<RememberedContact>);
        fn recall(&mut self, contacts: &[RememberedContact]) -> Result<(), WorldError>;
        fn corners(&self, into: &mut Vec<Option<HeldShape>>);
        fn phases(&self) -> Option<PhaseTimes>;
        fn solver_residual(&self) -> Option<f64>;
        fn pair_coefficients(&self, a: BodyId, b: BodyId) -> Result<PairCoefficients, WorldError>;
        fn effective(&self) -> EffectiveSettings;
    );

    fn add(&mut self, body: &Body) -> Result<BodyId, WorldError> {
        let mut body = body.clone();
        if let (Defect::BoundingBoxInertia, Motion::Free { mass, inertia }) =
            (self.defect, &mut body.motion)
        {
            let (low, high) = body.shape.bounding_box();
            let s = (high - low).component_mul(&(high - low));
            *inertia = *mass / 12.0 * Vector::new(s.y + s.z, s.x + s.z, s.x + s.y);
        }
        self.free.push(matches!(body.motion, Motion::Free { .. }));
        self.inner.add(&body)
    }

    fn read_body(&self, id: BodyId) -> Result<BodyState, WorldError> {
        let mut state = self.inner.read_body(id)?;
        if self.free[id.0 as usize] {
            state.pose.translation.vector += self.sunk();
        }
        Ok(state)
    }

    fn step(&mut self) -> Result<(), WorldError> {
        self.steps += 1;
        self.inner.step()
    }

    fn read(&self, into: &mut Snapshot) {
        self.inner.read(into);
        if self.defect == Defect::Drift {
            let sunk = self.sunk();
            for (body, free) in into.iter_mut().zip(&self.free) {
                if let (Some(state), true) = (body, free) {
                    state.pose.translation.vector += sunk;
                }
            }
        }
    }
}
