//! A world with the few bodies of an experiment, seen in the laboratory's axes.

use std::sync::Arc;

use nalgebra::UnitQuaternion;

use super::VerifyError;
use crate::geometry::{ConvexPolyhedron, MassProperties, Pose, Vector};
use crate::grains::{Grain, GrainSet, generate};
use crate::scenario::{CellShape, SieveFraction, SievedGrains};
use crate::world::{
    Body, BodyId, BodyState, Contact, Material, Motion, PairCoefficients, PairTable,
    RememberedContact, Snapshot, World,
};

/// Density of the solids in kg/m³ (paper, section 3).
pub const DENSITY: f64 = 2673.9;

/// Gap in m with which bodies are set down. Faces that touch exactly are a
/// case of their own (`touches-exactly`).
pub const START_GAP: f64 = 1e-6;

/// A world in which positions and velocities are given and read in the
/// laboratory's axes, whichever way the laboratory is turned.
pub struct Scene {
    world: Box<dyn World + Send>,
    frame: UnitQuaternion<f64>,
    snapshot: Snapshot,
    steps: u64,
}

impl Scene {
    pub(super) fn new(world: Box<dyn World + Send>, frame: UnitQuaternion<f64>) -> Self {
        Self { world, frame, snapshot: Snapshot::new(), steps: 0 }
    }

    /// Adds a body given in laboratory axes.
    pub fn add(&mut self, body: &Body) -> Result<BodyId, VerifyError> {
        let mut turned = body.clone();
        turned.state = self.out(&body.state);
        Ok(self.world.add(&turned)?)
    }

    /// Drives a body to a pose at the end of the next step.
    pub fn drive(&mut self, id: BodyId, pose: &Pose) -> Result<(), VerifyError> {
        let pose = Pose::from_parts(
            (self.frame * pose.translation.vector).into(),
            self.frame * pose.rotation,
        );
        Ok(self.world.drive(id, &pose)?)
    }

    /// One step.
    pub fn step(&mut self) -> Result<(), VerifyError> {
        self.world.step()?;
        self.steps += 1;
        Ok(())
    }

    /// Steps for a time in s, rounded to whole steps.
    pub fn run(&mut self, duration: f64) -> Result<(), VerifyError> {
        for _ in 0..self.steps_in(duration) {
            self.step()?;
        }
        Ok(())
    }

    /// Whole steps in a time in s.
    pub fn steps_in(&self, duration: f64) -> u64 {
        (duration / self.world.time_step()).round() as u64
    }

    /// Simulated time in s.
    pub fn time(&self) -> f64 {
        self.steps as f64 * self.world.time_step()
    }

    /// Length of a step in s.
    pub fn time_step(&self) -> f64 {
        self.world.time_step()
    }

    /// Steps of integration inside one step of the engine, as it says itself;
    /// 1 for engines that integrate once a step.
    pub fn integration_substeps(&self) -> f64 {
        self.world.effective().get("substeps").and_then(serde_json::Value::as_f64).unwrap_or(1.0)
    }

    /// State of a body in laboratory axes.
    pub fn state(&mut self, id: BodyId) -> Result<BodyState, VerifyError> {
        self.world.read(&mut self.snapshot);
        let state = self.snapshot.get(id.0 as usize).copied().flatten();
        state.map(|s| self.back(&s)).ok_or(crate::world::WorldError::NoSuchBody(id).into())
    }

    /// States of several bodies in laboratory axes, read at once.
    pub fn states(&mut self, ids: &[BodyId]) -> Result<Vec<BodyState>, VerifyError> {
        self.world.read(&mut self.snapshot);
        ids.iter()
            .map(|id| {
                let state = self.snapshot.get(id.0 as usize).copied().flatten();
                state.map(|s| self.back(&s)).ok_or(crate::world::WorldError::NoSuchBody(*id).into())
            })
            .collect()
    }

    /// Contacts of the last step, in laboratory axes.
    pub fn contacts(&self) -> Vec<Contact> {
        let mut contacts = Vec::new();
        self.world.contacts(&mut contacts);
        let back = self.frame.inverse();
        for contact in &mut contacts {
            contact.point = back * contact.point;
            contact.normal = back * contact.normal;
            contact.impulse = back * contact.impulse;
        }
        contacts
    }

    /// What the world remembers of its contacts, in the world's own axes.
    pub(super) fn remember(&self) -> Vec<RememberedContact> {
        let mut contacts = Vec::new();
        self.world.remember(&mut contacts);
        contacts
    }

    /// Tells a new world of the same bodies what another remembered.
    pub(super) fn recall(&mut self, contacts: &[RememberedContact]) -> Result<(), VerifyError> {
        Ok(self.world.recall(contacts)?)
    }

    fn out(&self, state: &BodyState) -> BodyState {
        turned(&self.frame, state)
    }

    fn back(&self, state: &BodyState) -> BodyState {
        turned(&self.frame.inverse(), state)
    }
}

fn turned(by: &UnitQuaternion<f64>, state: &BodyState) -> BodyState {
    BodyState {
        pose: Pose::from_parts(
            (by * state.pose.translation.vector).into(),
            by * state.pose.rotation,
        ),
        linear_velocity: by * state.linear_velocity,
        angular_velocity: by * state.angular_velocity,
    }
}

/// The same friction and restitution for every pair.
pub fn uniform(friction: f64, restitution: f64) -> PairTable {
    PairTable::uniform(PairCoefficients { friction, restitution })
}

/// A box of grain material with given sides (m), upright, its centroid at a place (m).
pub fn block(sides: Vector, at: Vector) -> Result<Body, VerifyError> {
    let shape = ConvexPolyhedron::cuboid(sides).map_err(|e| VerifyError::Setup(e.to_string()))?;
    Ok(free(shape, at))
}

/// A free homogeneous body of a shape whose frame is central and principal.
fn free(shape: ConvexPolyhedron, at: Vector) -> Body {
    let properties = MassProperties::of(&shape);
    Body {
        motion: Motion::Free {
            mass: DENSITY * properties.volume,
            inertia: DENSITY * properties.inertia_per_density.diagonal(),
        },
        shape: Arc::new(shape),
        material: Material::Grain,
        state: BodyState::at_rest(Pose::translation(at.x, at.y, at.z)),
    }
}

/// A wall of given sides (m) with its centre at a place (m).
pub fn wall(sides: Vector, at: Vector, motion: Motion) -> Result<Body, VerifyError> {
    let mut body = block(sides, at)?;
    body.motion = motion;
    body.material = Material::Wall;
    Ok(body)
}

/// A floor of a half width (m) whose upper face lies at z = 0.
pub fn floor(half_width: f64, motion: Motion) -> Result<Body, VerifyError> {
    const THICKNESS: f64 = 0.02;
    let sides = Vector::new(2.0 * half_width, 2.0 * half_width, THICKNESS);
    wall(sides, Vector::new(0.0, 0.0, -THICKNESS / 2.0), motion)
}

/// Mass in kg and principal moments in kg m² of a free body.
pub fn mass_of(body: &Body) -> (f64, Vector) {
    match body.motion {
        Motion::Free { mass, inertia } => (mass, inertia),
        _ => (0.0, Vector::zeros()),
    }
}

/// Grains of 8 to 10 mm cut as the paper's are, a given number of them.
pub fn grains(count: usize, seed: u64) -> Result<GrainSet, VerifyError> {
    // A fraction has V / (π/6 d³) grains of its mean diameter 9 mm.
    let volume_mm3 = count as f64 * std::f64::consts::PI / 6.0 * 9.0_f64.powi(3);
    let spec = SievedGrains {
        total_mass_g: volume_mm3 * 1e-6 * DENSITY,
        density_kg_per_m3: DENSITY,
        sieve_table: vec![SieveFraction {
            passing_mm: 10.0,
            retained_mm: 8.0,
            mass_percent: 100.0,
        }],
        cells: CellShape::default(),
    };
    generate(&spec, seed).map_err(|e| VerifyError::Setup(e.to_string()))
}

/// A grain as a free body at rest at a pose.
pub fn grain_body(grain: &Grain, pose: Pose) -> Body {
    Body {
        shape: grain.shape.clone(),
        motion: Motion::Free { mass: grain.mass, inertia: grain.inertia },
        material: Material::Grain,
        state: BodyState::at_rest(pose),
    }
}

/// Height in m of the lowest vertex of a shape in an orientation, relative to its centroid.
pub fn lowest(shape: &ConvexPolyhedron, rotation: &UnitQuaternion<f64>) -> f64 {
    shape.vertices().iter().map(|v| (rotation * v).z).fold(f64::INFINITY, f64::min)
}
