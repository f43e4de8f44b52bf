//! The rapier backend: the only place that knows rapier's names.
//!
//! Rapier 0.36 in double precision. Its solver divides a step into sub-steps; in each it starts
//! from the impulses of the one before, pushes overlaps apart through a damped spring, moves the
//! bodies, and takes the speed of that pushing away again. Contacts are found once a step by the
//! collision library parry: GJK and EPA give the normal, and the faces most against it are clipped,
//! by four corners each that `manifolds` chooses.
//!
//! Bodies do not sleep, nothing is damped unless asked for, there is no continuous collision
//! detection, and rotation is as fast as it comes. The gyroscopic term is rapier's: one explicit
//! step of -ω × Iω a sub-step, after which the angular momentum is scaled back to its length.

mod contacts;
mod convert;
mod manifolds;
mod pairs;
mod settings;
#[cfg(test)]
mod tests;

use std::{collections::HashMap, sync::Arc};

use rapier3d_f64::prelude::{
    ColliderBuilder, ColliderHandle, Group, InteractionGroups, InteractionTestMode, MassProperties,
    NarrowPhase, PhysicsWorld, RigidBody, RigidBodyBuilder, RigidBodyHandle, SharedShape,
};

use super::{
    BackendInfo, Body, BodyId, BodyState, Contact, EffectiveSettings, HeldShape, Motion,
    PairCoefficients, PairTable, Snapshot, World, WorldError,
};
use crate::geometry::{ConvexPolyhedron, Pose, Vector};
use crate::scenario::EngineSettings;
use convert::Units;

/// Version of the crate `rapier3d-f64`, which does not tell its own; a test
/// compares it with `Cargo.lock`.
const VERSION: &str = "0.36.1";

/// What can move freely, and what cannot: walls never meet each other.
const FREE: Group = Group::GROUP_1;
const WALL: Group = Group::GROUP_2;

struct Present {
    body: RigidBodyHandle,
    collider: ColliderHandle,
    driven: bool,
}

/// A rapier world. See [`World`].
pub struct RapierBackend {
    world: PhysicsWorld,
    units: Units,
    pairs: PairTable,
    /// By [`BodyId`]; `None` where a body was removed.
    bodies: Vec<Option<Present>>,
    /// Shapes already known to the engine, by address; the `Arc`s keep the
    /// addresses from being used again.
    shapes: HashMap<usize, (SharedShape, Arc<ConvexPolyhedron>)>,
    /// Which dispatcher the world was given; rapier cannot be asked.
    spanned_faces: bool,
    gyroscopic: bool,
    /// Damping of velocity and of angular velocity, in 1/s.
    damping: (f64, f64),
}

/// Name, version and precision of the rapier this program is linked with.
pub fn info() -> BackendInfo {
    BackendInfo { name: "rapier".into(), version: VERSION.into(), precision: "double".into() }
}

impl RapierBackend {
    /// Makes an empty world; `gravity` in m/s².
    ///
    /// # Errors
    /// [`WorldError::BadSetting`] for a value rapier cannot take.
    pub fn new(
        settings: &EngineSettings,
        gravity: Vector,
        pairs: &PairTable,
    ) -> Result<Self, WorldError> {
        let units = settings::units(settings)?;
        super::finite(&gravity)?;
        let world = PhysicsWorld {
            gravity: units.length(&gravity),
            integration_parameters: settings::integration_parameters(settings, units)?,
            narrow_phase: if settings.rapier.spanned_faces {
                NarrowPhase::with_query_dispatcher(manifolds::spanned_faces())
            } else {
                NarrowPhase::new()
            },
            ..PhysicsWorld::new()
        };
        pairs.check()?;
        Ok(Self {
            world,
            units,
            pairs: pairs.clone(),
            bodies: Vec::new(),
            shapes: HashMap::new(),
            spanned_faces: settings.rapier.spanned_faces,
            gyroscopic: settings.gyroscopic,
            damping: (
                settings::damping("linear_damping", settings.linear_damping)?,
                settings::damping("angular_damping", settings.angular_damping)?,
            ),
        })
    }

    fn present(&self, id: BodyId) -> Result<&Present, WorldError> {
        self.bodies.get(id.0 as usize).and_then(Option::as_ref).ok_or(WorldError::NoSuchBody(id))
    }

    fn shape(&mut self, shape: &Arc<ConvexPolyhedron>) -> Result<SharedShape, WorldError> {
        let key = Arc::as_ptr(shape).addr();
        if let Some((known, _)) = self.shapes.get(&key) {
            return Ok(known.clone());
        }
        let made = convert::shape(self.units, shape).ok_or_else(|| {
            WorldError::BadBody("rapier can make no convex polyhedron of its shape".into())
        })?;
        self.shapes.insert(key, (made.clone(), Arc::clone(shape)));
        Ok(made)
    }

    fn rigid_body(&self, body: &Body) -> RigidBodyBuilder {
        let builder = match body.motion {
            Motion::Static => RigidBodyBuilder::fixed(),
            Motion::Kinematic | Motion::Pressed { .. } | Motion::Turned { .. } => {
                RigidBodyBuilder::kinematic_position_based()
            }
            Motion::Free { mass, inertia } => RigidBodyBuilder::dynamic()
                .additional_mass_properties(MassProperties::new(
                    convert::vector(&Vector::zeros()),
                    mass,
                    self.units.inertia(&inertia),
                ))
                .linvel(self.units.length(&body.state.linear_velocity))
                .angvel(convert::vector(&body.state.angular_velocity)),
        };
        builder
            .pose(self.units.pose(&body.state.pose))
            .gravity_scale(1.0)
            .linear_damping(self.damping.0)
            .angular_damping(self.damping.1)
            .gyroscopic_forces_enabled(self.gyroscopic)
            .can_sleep(false)
            .ccd_enabled(false)
            .soft_ccd_prediction(0.0)
            // Without it rapier holds rotation to 45° a step.
            .allow_fast_rotation(true)
            .additional_solver_iterations(0)
            .dominance_group(0)
            .user_data(self.bodies.len() as u128)
    }

    /// The number of a body, which rapier carries as the body's user data.
    fn id(body: &RigidBody) -> BodyId {
        BodyId(u32::try_from(body.user_data).unwrap_or(u32::MAX))
    }
}

impl World for RapierBackend {
    fn add(&mut self, body: &Body) -> Result<BodyId, WorldError> {
        body.check()?;
        let shape = self.shape(&body.shape)?;
        let (own, meets) = match body.motion {
            Motion::Free { .. } => (FREE, FREE | WALL),
            Motion::Static | Motion::Kinematic => (WALL, FREE),
            Motion::Pressed { .. } | Motion::Turned { .. } => {
                let reason = "rapier cannot press it along one direction".to_owned();
                return Err(WorldError::BadBody(reason));
            }
        };
        // The mass is the body's, given exactly: the collider adds none.
        let bare = ColliderBuilder::new(shape).density(0.0).contact_skin(0.0);
        let collider = self
            .pairs
            .apply(bare, body.material, own == FREE)
            .collision_groups(InteractionGroups::new(own, meets, InteractionTestMode::And));
        let id = BodyId(u32::try_from(self.bodies.len()).unwrap_or(u32::MAX));
        let (body_handle, collider) = self.world.insert(self.rigid_body(body), collider);
        let driven = matches!(body.motion, Motion::Kinematic);
        self.bodies.push(Some(Present { body: body_handle, collider, driven }));
        Ok(id)
    }

    fn remove(&mut self, id: BodyId) -> Result<(), WorldError> {
        let handle = self.present(id)?.body;
        self.world.remove_body(handle);
        self.bodies[id.0 as usize] = None;
        Ok(())
    }

    fn drive(&mut self, id: BodyId, pose: &Pose) -> Result<(), WorldError> {
        let present = self.present(id)?;
        if !present.driven {
            return Err(WorldError::NotKinematic(id));
        }
        let (handle, pose) = (present.body, self.units.pose(pose));
        // Rapier takes the velocity that contacts feel from the difference to
        // the pose it has (`interpolate_kinematic_velocities`, 0.36).
        self.world
            .bodies
            .get_mut(handle)
            .ok_or(WorldError::NoSuchBody(id))?
            .set_next_kinematic_position(pose);
        Ok(())
    }

    fn step(&mut self) -> Result<(), WorldError> {
        self.world.step_with_events(&self.pairs, &());
        let quarantine = self.world.quarantine();
        if quarantine.is_empty() {
            return Ok(());
        }
        let stopped: Vec<String> = quarantine
            .bodies()
            .iter()
            .filter_map(|handle| self.world.bodies.get(*handle))
            .map(|body| Self::id(body).0.to_string())
            .collect();
        Err(WorldError::Engine(format!(
            "positions or velocities that are not finite: {} shapes, bodies [{}]",
            quarantine.colliders().len(),
            stopped.join(", ")
        )))
    }

    fn time_step(&self) -> f64 {
        self.world.integration_parameters.dt
    }

    fn read(&self, into: &mut Snapshot) {
        into.clear();
        into.extend(self.bodies.iter().map(|present| {
            let body = self.world.bodies.get(present.as_ref()?.body)?;
            Some(BodyState {
                pose: self.units.metres_pose(body.position()),
                linear_velocity: self.units.metres(body.linvel()),
                angular_velocity: convert::plain(body.angvel()),
            })
        }));
    }

    fn corners(&self, into: &mut Vec<Option<HeldShape>>) {
        into.clear();
        into.extend(self.bodies.iter().map(|present| {
            let collider = self.world.colliders.get(present.as_ref()?.collider)?;
            if let Some(ball) = collider.shape().as_ball() {
                let on = Vector::new(ball.radius / self.units.per_metre, 0.0, 0.0);
                return Some(HeldShape { corners: vec![on], rounding: 0.0 });
            }
            let (hull, radius) = manifolds::polyhedron(collider.shape())?;
            let corners = hull.points().iter().map(|p| self.units.metres(*p)).collect();
            Some(HeldShape { corners, rounding: radius / self.units.per_metre })
        }));
    }

    fn contacts(&self, into: &mut Vec<Contact>) {
        contacts::read(&self.world, self.units, into);
    }

    fn pair_coefficients(&self, a: BodyId, b: BodyId) -> Result<PairCoefficients, WorldError> {
        let (a, b) = (self.present(a)?.collider, self.present(b)?.collider);
        Ok(self.pairs.held(&self.world, a, b))
    }

    fn effective(&self) -> EffectiveSettings {
        settings::effective(&self.world, self.units, self.spanned_faces)
    }
}
