//! A world that does what it was told beforehand: the double with which
//! protocols are tested without an engine.

use super::{
    Body, BodyId, BodyState, Contact, EffectiveSettings, HeldShape, Motion, PairCoefficients,
    Snapshot, World, WorldError,
};
use crate::geometry::{Pose, Vector};

/// What happens to a free body at each step: from its state, the step's
/// number (counted from 1) and the step's length in s, its next state.
pub type Script = Box<dyn Fn(BodyId, &BodyState, u64, f64) -> BodyState + Send>;

/// A world without contacts whose free bodies follow a script.
pub struct ScriptedWorld {
    time_step: f64,
    steps: u64,
    bodies: Vec<Option<(Motion, BodyState)>>,
    /// Corners of every body that was added.
    corners: Vec<HeldShape>,
    script: Script,
    /// Every pose that was driven, in order.
    pub driven: Vec<(BodyId, Pose)>,
    /// Bodies removed, in order.
    pub removed: Vec<BodyId>,
    /// Number of steps after which the last body is no longer read.
    pub forgets_after: u64,
}

impl ScriptedWorld {
    /// A world whose free bodies follow `script`.
    pub fn new(time_step: f64, script: Script) -> Self {
        Self {
            time_step,
            steps: 0,
            bodies: Vec::new(),
            corners: Vec::new(),
            script,
            driven: Vec::new(),
            removed: Vec::new(),
            forgets_after: u64::MAX,
        }
    }

    /// A world in which free bodies stay where they are.
    pub fn still(time_step: f64) -> Self {
        Self::new(time_step, Box::new(|_, state, _, _| BodyState::at_rest(state.pose)))
    }

    /// A world in which free bodies fall freely with `gravity` in m/s², by
    /// the semi-implicit Euler rule, which Bullet uses too.
    pub fn falling(time_step: f64, gravity: Vector) -> Self {
        Self::new(
            time_step,
            Box::new(move |_, state, _, dt| {
                let mut next = *state;
                next.linear_velocity += gravity * dt;
                next.pose.translation.vector += next.linear_velocity * dt;
                next
            }),
        )
    }
}

impl World for ScriptedWorld {
    fn add(&mut self, body: &Body) -> Result<BodyId, WorldError> {
        self.bodies.push(Some((body.motion, body.state)));
        let (of, rounding) = body.shape.core();
        let corners = of.vertices().iter().map(|v| v.coords).collect();
        self.corners.push(HeldShape { corners, rounding });
        Ok(BodyId(self.bodies.len() as u32 - 1))
    }

    fn remove(&mut self, id: BodyId) -> Result<(), WorldError> {
        let slot = self.bodies.get_mut(id.0 as usize).ok_or(WorldError::NoSuchBody(id))?;
        slot.take().ok_or(WorldError::NoSuchBody(id))?;
        self.removed.push(id);
        Ok(())
    }

    fn drive(&mut self, id: BodyId, pose: &Pose) -> Result<(), WorldError> {
        match self.bodies.get_mut(id.0 as usize) {
            Some(Some((Motion::Kinematic, state))) => {
                state.pose = *pose;
                self.driven.push((id, *pose));
                Ok(())
            }
            Some(Some(_)) => Err(WorldError::NotKinematic(id)),
            _ => Err(WorldError::NoSuchBody(id)),
        }
    }

    fn step(&mut self) -> Result<(), WorldError> {
        self.steps += 1;
        for (index, slot) in self.bodies.iter_mut().enumerate() {
            if let Some((Motion::Free { .. }, state)) = slot {
                *state = (self.script)(BodyId(index as u32), state, self.steps, self.time_step);
            }
        }
        Ok(())
    }

    fn time_step(&self) -> f64 {
        self.time_step
    }

    fn read(&self, into: &mut Snapshot) {
        into.clear();
        into.extend(self.bodies.iter().map(|slot| slot.as_ref().map(|(_, state)| *state)));
        if self.steps > self.forgets_after
            && let Some(last) = into.last_mut()
        {
            *last = None;
        }
    }

    fn contacts(&self, into: &mut Vec<Contact>) {
        into.clear();
    }

    fn corners(&self, into: &mut Vec<Option<HeldShape>>) {
        into.clear();
        let there = self.bodies.iter().map(Option::is_some);
        into.extend(there.zip(&self.corners).map(|(there, c)| there.then(|| c.clone())));
    }

    fn pair_coefficients(&self, _: BodyId, _: BodyId) -> Result<PairCoefficients, WorldError> {
        Ok(PairCoefficients { friction: 0.0, restitution: 0.0 })
    }

    fn effective(&self) -> EffectiveSettings {
        [("engine".to_string(), serde_json::Value::from("scripted"))].into()
    }
}
