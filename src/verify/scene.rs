//! A world with the few bodies of an experiment, seen in the laboratory's axes.

use std::sync::Arc;

use nalgebra::UnitQuaternion;

use super::{VerifyError, view::View};
use crate::geometry::{ConvexPolyhedron, MassProperties, Pose, Vector};
use crate::grains::{Grain, GrainSet, generate};
use crate::protocol::free_grain;
use crate::scenario::{CellShape, SieveFraction, SievedGrains, SievedShape};
use crate::world::{
    Body, BodyId, BodyState, Contact, Material, Motion, PairCoefficients, PairTable,
    RememberedContact, Snapshot, World, WorldError,
};

/// Density of the solids in kg/m³ (paper, section 3).
pub const DENSITY: f64 = 2673.9;

/// Gap in m with which bodies are set down. Faces that touch exactly are a
/// case of their own (`touches-exactly`).
pub const START_GAP: f64 = 1e-6;

/// A world in which positions and velocities are given and read in the
/// laboratory's axes, however the laboratory stands in it, and however large it is there: in an
/// engine of the scale of bodies λ times as large (`EngineSettings::enlarged`) lengths are λ times
/// as large, times and speeds √λ, masses λ³, moments of inertia λ⁵, impulses λ³ √λ, while gravity
/// stays, and what is seen is the same (Froude's law, [`crate::scale`]).
pub struct Scene {
    world: Box<dyn World + Send>,
    view: View,
    /// λ.
    larger: f64,
    snapshot: Snapshot,
    steps: u64,
    /// Bodies given since the last step, which the world does not have yet:
    /// only then is it known which is the last.
    waiting: Vec<Body>,
    /// The world's numbers of the bodies, in the order in which they were given.
    ids: Vec<BodyId>,
    /// Where the laboratory moves: bodies fixed in it, with their poses there.
    carried: Vec<(BodyId, Pose)>,
}

impl Scene {
    pub(super) fn new(world: Box<dyn World + Send>, view: View, larger: f64) -> Self {
        Self {
            world,
            view,
            larger,
            snapshot: Snapshot::new(),
            steps: 0,
            waiting: Vec::new(),
            ids: Vec::new(),
            carried: Vec::new(),
        }
    }

    /// Adds a body given in laboratory axes. The scene numbers bodies in the
    /// order in which they are given, whatever the world does.
    pub fn add(&mut self, body: &Body) -> BodyId {
        let number = self.ids.len() + self.waiting.len();
        self.waiting.push(body.clone());
        BodyId(number as u32)
    }

    /// Hands the bodies that wait to the world.
    fn enter(&mut self) -> Result<(), VerifyError> {
        let waiting = std::mem::take(&mut self.waiting);
        let first = self.ids.len();
        self.ids.resize(first + waiting.len(), BodyId(0));
        let mut order: Vec<usize> = (0..waiting.len()).collect();
        if self.view.last_first {
            order.reverse();
        }
        for n in order {
            let mut body = self.view.body_out(&waiting[n], self.time())?;
            let fixed = !matches!(body.motion, Motion::Free { .. });
            if self.view.moves() && fixed {
                body.motion = Motion::Kinematic;
                body.state.linear_velocity = Vector::zeros();
                self.carried.push((BodyId((first + n) as u32), waiting[n].state.pose));
            }
            if self.larger != 1.0 {
                body = enlarged(&body, self.larger);
            }
            self.ids[first + n] = self.world.add(&body)?;
        }
        Ok(())
    }

    /// The world's number of a body.
    fn id(&self, id: BodyId) -> Result<BodyId, VerifyError> {
        let known = self.ids.get(id.0 as usize).copied();
        known.ok_or(WorldError::NoSuchBody(id).into())
    }

    /// The scene's number of a body that the world names.
    fn number(&self, id: BodyId) -> BodyId {
        // Numbers are the world's own unless the order was turned round.
        if !self.view.last_first {
            return id;
        }
        let at = self.ids.iter().position(|i| *i == id);
        at.map_or(id, |n| BodyId(n as u32))
    }

    /// Moves a kinematic body by a displacement (m) from a pose at the end of the next step.
    pub fn shift(&mut self, id: BodyId, from: &Pose, by: Vector) -> Result<(), VerifyError> {
        let at = from.translation.vector + by;
        self.drive(id, &Pose::from_parts(at.into(), from.rotation))
    }

    /// Moves a kinematic body to a pose at the end of the next step.
    pub fn drive(&mut self, id: BodyId, pose: &Pose) -> Result<(), VerifyError> {
        self.enter()?;
        if let Some((_, carried)) = self.carried.iter_mut().find(|(c, _)| *c == id) {
            *carried = *pose;
            return Ok(());
        }
        self.drive_out(id, pose, self.time() + self.time_step())
    }

    fn drive_out(&mut self, id: BodyId, pose: &Pose, time: f64) -> Result<(), VerifyError> {
        let pose = scaled_pose(&self.view.pose_out(pose, time), self.larger);
        Ok(self.world.drive(self.id(id)?, &pose)?)
    }

    /// One step.
    pub fn step(&mut self) -> Result<(), VerifyError> {
        self.enter()?;
        let end = self.time() + self.time_step();
        for n in 0..self.carried.len() {
            let (id, pose) = self.carried[n];
            self.drive_out(id, &pose, end)?;
        }
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

    /// Steps for a time in s, and shows the time and the state of a body after each step.
    pub fn follow(
        &mut self,
        id: BodyId,
        duration: f64,
        mut look: impl FnMut(f64, BodyState),
    ) -> Result<(), VerifyError> {
        for _ in 0..self.steps_in(duration) {
            self.step()?;
            let state = self.state(id)?;
            look(self.time(), state);
        }
        Ok(())
    }

    /// Steps for a time in s and samples a curve: about as many points as `samples`, the last step
    /// among them. `point` makes each from the scene and the number of the step.
    pub fn sampled(
        &mut self,
        duration: f64,
        samples: u64,
        mut point: impl FnMut(&mut Self, u64) -> Result<(f64, f64), VerifyError>,
    ) -> Result<Vec<(f64, f64)>, VerifyError> {
        let steps = self.steps_in(duration);
        let mut curve = Vec::new();
        for n in 1..=steps {
            self.step()?;
            if n % (steps / samples).max(1) == 0 || n == steps {
                curve.push(point(self, n)?);
            }
        }
        Ok(curve)
    }

    /// Whole steps in a time in s.
    pub fn steps_in(&self, duration: f64) -> u64 {
        (duration / self.time_step()).round() as u64
    }

    /// Simulated time in s.
    pub fn time(&self) -> f64 {
        self.steps as f64 * self.time_step()
    }

    /// Length of a step in s.
    pub fn time_step(&self) -> f64 {
        self.world.time_step() / self.larger.sqrt()
    }

    /// Steps of integration inside one step of the engine, as it says itself;
    /// 1 for engines that integrate once a step.
    pub fn integration_substeps(&self) -> f64 {
        self.world.effective().get("substeps").and_then(serde_json::Value::as_f64).unwrap_or(1.0)
    }

    /// Length in s of the steps in which the engine integrates.
    pub fn integration_step(&self) -> f64 {
        self.time_step() / self.integration_substeps()
    }

    /// State of a body in laboratory axes.
    pub fn state(&mut self, id: BodyId) -> Result<BodyState, VerifyError> {
        Ok(self.states(&[id])?[0])
    }

    /// States of several bodies in laboratory axes, read at once.
    pub fn states(&mut self, ids: &[BodyId]) -> Result<Vec<BodyState>, VerifyError> {
        self.enter()?;
        self.world.read(&mut self.snapshot);
        let time = self.time();
        ids.iter()
            .map(|id| {
                let state = self.snapshot.get(self.id(*id)?.0 as usize).copied().flatten();
                let state = state.ok_or(WorldError::NoSuchBody(*id))?;
                Ok(self.view.state_back(&scaled_state(&state, 1.0 / self.larger), time))
            })
            .collect()
    }

    /// Contacts of the last step, in laboratory axes.
    pub fn contacts(&self) -> Vec<Contact> {
        let mut contacts = Vec::new();
        self.world.contacts(&mut contacts);
        for contact in &mut contacts {
            contact.point /= self.larger;
            contact.gap /= self.larger;
            contact.impulse /= self.larger.powi(3) * self.larger.sqrt();
            contact.a = self.number(contact.a);
            contact.b = self.number(contact.b);
            contact.point = self.view.point_back(contact.point, self.time());
            contact.normal = self.view.vector_back(contact.normal);
            contact.impulse = self.view.vector_back(contact.impulse);
        }
        contacts
    }

    /// Sum of the impulses of the last step on a body, in laboratory axes.
    pub fn impulse_on(&self, id: BodyId) -> Vector {
        let signed = |c: Contact| match (c.a == id, c.b == id) {
            (true, _) => c.impulse,
            (_, true) => -c.impulse,
            _ => Vector::zeros(),
        };
        self.contacts().into_iter().map(signed).sum()
    }

    /// What the world remembers of its contacts, in the world's own axes and numbers.
    pub(super) fn remember(&self) -> Vec<RememberedContact> {
        let mut contacts = Vec::new();
        self.world.remember(&mut contacts);
        contacts
    }

    /// Tells a new world of the same bodies what another remembered.
    pub(super) fn recall(&mut self, contacts: &[RememberedContact]) -> Result<(), VerifyError> {
        self.enter()?;
        Ok(self.world.recall(contacts)?)
    }
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

/// A body λ times as large.
fn enlarged(body: &Body, by: f64) -> Body {
    let motion = match body.motion {
        Motion::Free { mass, inertia } => {
            Motion::Free { mass: mass * by.powi(3), inertia: inertia * by.powi(5) }
        }
        other => other,
    };
    let state = scaled_state(&body.state, by);
    Body { shape: Arc::new(body.shape.scaled(by)), motion, material: body.material, state }
}

/// The same friction and restitution for every pair.
pub fn uniform(friction: f64, restitution: f64) -> PairTable {
    PairTable::uniform(PairCoefficients { friction, restitution })
}

/// A table of pairs in which the plate has coefficients of its own with one material.
pub fn with_plate(
    mut pairs: PairTable,
    other: Material,
    friction: f64,
    restitution: f64,
) -> PairTable {
    pairs.set(other, Material::Plate, PairCoefficients { friction, restitution });
    pairs
}

/// A box of grain material with given sides (m), upright, its centroid at a place (m).
pub fn block(sides: Vector, at: Vector) -> Result<Body, VerifyError> {
    Ok(free(ConvexPolyhedron::cuboid(sides)?, at))
}

/// A free homogeneous body of a shape whose frame is central and principal.
pub fn free(shape: ConvexPolyhedron, at: Vector) -> Body {
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

/// A free homogeneous body of a shape (m) that stands where it is to be.
pub fn solid(shape: &ConvexPolyhedron) -> Body {
    let frame = MassProperties::of(shape).principal_frame();
    let mut body = free(shape.transformed(&frame.pose.inverse()), Vector::zeros());
    body.state.pose = frame.pose;
    body
}

/// A prism over a polygon of the x-z plane (corners counter-clockwise seen
/// against y, in m), from −depth/2 to depth/2 along y.
pub fn profile(polygon: &[(f64, f64)], depth: f64) -> Result<ConvexPolyhedron, VerifyError> {
    let prism = ConvexPolyhedron::prism(polygon, -depth / 2.0, depth / 2.0)?;
    // The prism stands on its polygon: its z becomes −y.
    let upright = UnitQuaternion::from_axis_angle(&Vector::x_axis(), std::f64::consts::FRAC_PI_2);
    Ok(prism.transformed(&Pose::from_parts(Vector::zeros().into(), upright)))
}

/// A wall of given sides (m) with its centre at a place (m).
pub fn wall(sides: Vector, at: Vector, motion: Motion) -> Result<Body, VerifyError> {
    Ok(Body { motion, material: Material::Wall, ..block(sides, at)? })
}

/// Thickness of floors in m.
const THICKNESS: f64 = 0.02;

/// A floor of a half width (m) whose upper face lies at z = 0.
pub fn floor(half_width: f64, motion: Motion) -> Result<Body, VerifyError> {
    let sides = Vector::new(2.0 * half_width, 2.0 * half_width, THICKNESS);
    wall(sides, Vector::new(0.0, 0.0, -THICKNESS / 2.0), motion)
}

/// A static piece of a floor from one place to another along x, of a width along y, its upper
/// face at a height; all in m.
pub fn piece(from: f64, to: f64, width: f64, top: f64) -> Result<Body, VerifyError> {
    let at = Vector::new(0.5 * (from + to), 0.0, top - THICKNESS / 2.0);
    wall(Vector::new(to - from, width, THICKNESS), at, Motion::Static)
}

/// Four walls around the z axis, which stand on z = 0 with their middles `off` the axis; sizes
/// in m.
pub fn walls_around(
    off: f64,
    thickness: f64,
    length: f64,
    height: f64,
    motion: Motion,
) -> Result<Vec<Body>, VerifyError> {
    let mut walls = Vec::new();
    for side in [-1.0, 1.0] {
        for (sides, at) in [
            (Vector::new(thickness, length, height), Vector::new(side * off, 0.0, height / 2.0)),
            (Vector::new(length, thickness, height), Vector::new(0.0, side * off, height / 2.0)),
        ] {
            walls.push(wall(sides, at, motion)?);
        }
    }
    Ok(walls)
}

/// Mass in kg and principal moments in kg m² of a free body.
pub fn mass_of(body: &Body) -> (f64, Vector) {
    match body.motion {
        Motion::Free { mass, inertia } => (mass, inertia),
        _ => (0.0, Vector::zeros()),
    }
}

/// About `count` grains of 8 to 10 mm, cut as the paper's are.
///
/// # Errors
/// [`VerifyError::Setup`] where they cannot be cut.
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
        shape: SievedShape::default(),
        cells: CellShape::default(),
    };
    generate(&spec, seed).map_err(|e| VerifyError::Setup(e.to_string()))
}

/// A grain as a free body at rest at a pose.
pub fn grain_body(grain: &Grain, pose: Pose) -> Body {
    free_grain(grain, BodyState::at_rest(pose))
}

/// Height in m of the lowest vertex of a shape in an orientation, relative to its centroid.
pub fn lowest(shape: &ConvexPolyhedron, rotation: &UnitQuaternion<f64>) -> f64 {
    shape.vertices().iter().map(|v| (rotation * v).z).fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_solid_stands_where_its_shape_was_given() {
        let wedge = profile(&[(0.03, 0.0), (0.05, 0.0), (0.04, 0.01)], 0.02).expect("a prism");
        let (low, high) = wedge.bounding_box();
        assert!((low.coords - Vector::new(0.03, -0.01, 0.0)).norm() < 1e-12, "got {low}");
        assert!((high.coords - Vector::new(0.05, 0.01, 0.01)).norm() < 1e-12, "got {high}");
        let body = solid(&wedge);
        let (mass, inertia) = mass_of(&body);
        assert!((mass / (DENSITY * 2e-6) - 1.0).abs() < 1e-9, "law: ρ V, got {mass} kg");
        assert!(inertia.min() > 0.0, "law: moments of a body, got {inertia}");
        let centroid = body.state.pose.translation.vector - Vector::new(0.04, 0.0, 0.01 / 3.0);
        assert!(centroid.norm() < 1e-12, "law: a third of the height, off by {centroid}");
        for corner in wedge.vertices() {
            let near = body.shape.vertices().iter().map(|v| (body.state.pose * v - corner).norm());
            let off = near.fold(f64::INFINITY, f64::min);
            assert!(off < 1e-12, "law: {corner} is a corner, off by {off:e}");
        }
    }
}
