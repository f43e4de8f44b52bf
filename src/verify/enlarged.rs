//! A world in which everything is larger than whoever uses it sees.
//!
//! Lengths are λ times as large, times and speeds √λ, masses λ³, moments of inertia λ⁵,
//! impulses λ³ √λ, while gravity stays: with an engine of that scale
//! (`EngineSettings::enlarged`) what is seen is the same (Froude's law, [`crate::scale`]).

use std::sync::Arc;

use crate::geometry::Pose;
use crate::world::{
    Body, BodyId, BodyState, Contact, EffectiveSettings, HeldShape, Motion, PairCoefficients,
    RememberedContact, Snapshot, World, WorldError,
};

/// See the module's text.
pub(super) struct Enlarged {
    inner: Box<dyn World + Send>,
    /// λ.
    larger: f64,
}

fn scaled_pose(pose: &Pose, by: f64) -> Pose {
    Pose::from_parts((pose.translation.vector * by).into(), pose.rotation)
}

fn scaled_state(state: &BodyState, by: f64) -> BodyState {
    BodyState {
        pose: scaled_pose(&state.pose, by),
        linear_velocity: state.linear_velocity * by.sqrt(),
        angular_velocity: state.angular_velocity / by.sqrt(),
    }
}

impl Enlarged {
    /// A world whose engine has the scale of bodies λ times as large.
    pub(super) fn new(inner: Box<dyn World + Send>, larger: f64) -> Self {
        Self { inner, larger }
    }
}

impl World for Enlarged {
    fn add(&mut self, body: &Body) -> Result<BodyId, WorldError> {
        let larger = self.larger;
        let motion = match body.motion {
            Motion::Free { mass, inertia } => {
                Motion::Free { mass: mass * larger.powi(3), inertia: inertia * larger.powi(5) }
            }
            other => other,
        };
        self.inner.add(&Body {
            shape: Arc::new(body.shape.scaled(larger)),
            motion,
            material: body.material,
            state: scaled_state(&body.state, larger),
        })
    }

    fn remove(&mut self, id: BodyId) -> Result<(), WorldError> {
        self.inner.remove(id)
    }

    fn drive(&mut self, id: BodyId, pose: &Pose) -> Result<(), WorldError> {
        self.inner.drive(id, &scaled_pose(pose, self.larger))
    }

    fn step(&mut self) -> Result<(), WorldError> {
        self.inner.step()
    }

    fn time_step(&self) -> f64 {
        self.inner.time_step() / self.larger.sqrt()
    }

    fn read(&self, into: &mut Snapshot) {
        self.inner.read(into);
        for state in into.iter_mut().flatten() {
            *state = scaled_state(state, 1.0 / self.larger);
        }
    }

    fn contacts(&self, into: &mut Vec<Contact>) {
        self.inner.contacts(into);
        for contact in into.iter_mut() {
            contact.point /= self.larger;
            contact.gap /= self.larger;
            contact.impulse /= self.larger.powi(3) * self.larger.sqrt();
        }
    }

    // In the inner world's units: only another world of the same size recalls it.
    fn remember(&self, into: &mut Vec<RememberedContact>) {
        self.inner.remember(into);
    }

    fn recall(&mut self, contacts: &[RememberedContact]) -> Result<(), WorldError> {
        self.inner.recall(contacts)
    }

    fn recall_drive(&mut self, id: BodyId, ends: &[Pose; 3]) -> Result<(), WorldError> {
        self.inner.recall_drive(id, &ends.map(|pose| scaled_pose(&pose, self.larger)))
    }

    fn corners(&self, into: &mut Vec<Option<HeldShape>>) {
        self.inner.corners(into);
        for held in into.iter_mut().flatten() {
            held.rounding /= self.larger;
            for corner in &mut held.corners {
                *corner /= self.larger;
            }
        }
    }

    fn solver_residual(&self) -> Option<f64> {
        self.inner.solver_residual()
    }

    fn pair_coefficients(&self, a: BodyId, b: BodyId) -> Result<PairCoefficients, WorldError> {
        self.inner.pair_coefficients(a, b)
    }

    fn effective(&self) -> EffectiveSettings {
        self.inner.effective()
    }
}
