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
    /// Every force in N, or moment in N m, that was set on a body, in order; none moves it.
    pub pressed: Vec<(BodyId, f64)>,
    /// Parts with their wholes, in order: they are where these are.
    pub joined: Vec<(BodyId, BodyId)>,
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
            pressed: Vec::new(),
            joined: Vec::new(),
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

    fn press(&mut self, id: BodyId, force: f64) -> Result<(), WorldError> {
        match self.bodies.get(id.0 as usize) {
            Some(Some((Motion::Pressed { .. } | Motion::Turned { .. }, _))) => {
                self.pressed.push((id, force));
                Ok(())
            }
            Some(Some(_)) => Err(WorldError::NotPressed(id)),
            _ => Err(WorldError::NoSuchBody(id)),
        }
    }

    fn join(&mut self, part: BodyId, whole: BodyId) -> Result<(), WorldError> {
        for id in [part, whole] {
            self.read_body(id)?;
        }
        self.joined.push((part, whole));
        Ok(())
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
        for (part, whole) in &self.joined {
            if into[part.0 as usize].is_some() {
                into[part.0 as usize] = into[whole.0 as usize];
            }
        }
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

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::super::Material;
    use super::*;
    use crate::geometry::ConvexPolyhedron;

    /// Law: the double keeps what an engine is given, and refuses what an engine refuses: forces on
    /// bodies that are not pressed, and parts of what is not there.
    #[test]
    fn what_is_pressed_and_joined_is_kept() {
        let mut world = ScriptedWorld::falling(0.01, Vector::new(0.0, 0.0, -10.0));
        let cube = ConvexPolyhedron::cuboid(Vector::repeat(0.01)).expect("a cube");
        let cube = Arc::new(cube);
        let mut add = |motion: Motion| {
            let state = BodyState::at_rest(Pose::identity());
            let (shape, material) = (cube.clone(), Material::Grain);
            world.add(&Body { shape, motion, material, state }).expect("a body")
        };
        let free = Motion::Free { mass: 1.0, inertia: Vector::repeat(1.0) };
        let lid = add(Motion::Pressed { mass: 1.0, direction: -Vector::z() });
        let (whole, part) = (add(free), add(free));
        let nobody = BodyId(7);
        world.press(lid, 3.0).expect("law: it is pressed");
        world.press(lid, 4.0).expect("law: and again");
        assert_eq!(world.pressed, [(lid, 3.0), (lid, 4.0)], "law: in order");
        let not_pressed = world.press(whole, 3.0);
        assert!(matches!(not_pressed, Err(WorldError::NotPressed(id)) if id == whole));
        assert!(matches!(world.press(nobody, 3.0), Err(WorldError::NoSuchBody(_))));
        world.join(part, whole).expect("law: they are one");
        assert_eq!(world.joined, [(part, whole)], "law: as it was told");
        assert!(matches!(world.join(nobody, whole), Err(WorldError::NoSuchBody(_))));
        world.step().expect("a step");
        let [of_whole, of_part] = [whole, part].map(|id| world.read_body(id).expect("there"));
        assert_eq!(of_part, of_whole, "law: a part is where its whole is");
        assert!(of_part.pose.translation.z < 0.0, "law: it falls, got {of_part:?}");
    }
}
