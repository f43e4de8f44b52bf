//! The one seam between the experiment and a physics engine.
//!
//! Everything crossing this trait is in SI units and double precision, whatever units and precision
//! the engine uses inside: length scaling and rounding are the backend's private business.

pub mod bullet;
mod error;
mod pairs;
#[cfg(test)]
mod parity_tests;
#[cfg(feature = "rapier")]
pub mod rapier;
mod run_time_check;
#[cfg(test)]
pub mod scripted;
#[cfg(test)]
mod testing;

#[cfg(test)]
pub(crate) use bullet::tests::{exclusive_turn, shared_turn};
pub use error::WorldError;
pub use pairs::{Material, PairCoefficients, PairTable};
pub use run_time_check::RunTimeCheck;

use std::sync::Arc;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::geometry::{ConvexPolyhedron, Pose, Vector};
use crate::scenario::{Backend, EngineSettings};
use error::{finite, positive, sound};

/// How a body moves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Motion {
    /// Never.
    Static,
    /// As [`World::drive`] says, unmoved by contacts.
    Kinematic,
    /// Along one direction, by the force on it ([`World::press`]) and by contacts alone; it
    /// neither turns nor goes aside, and its weight is part of the force.
    Pressed {
        /// Mass in kg.
        mass: f64,
        /// A unit vector.
        direction: Vector,
    },
    /// About one axis, by the moment on it ([`World::press`]) and by contacts alone; its weight is
    /// part of the moment.
    Turned {
        /// Moment of inertia about the axis in kg m².
        inertia: f64,
        /// A unit vector, about which it turns right-handed.
        axis: Vector,
        /// A point of the axis in m.
        about: Vector,
    },
    /// By gravity and contacts.
    Free {
        /// Mass in kg.
        mass: f64,
        /// Principal moments of inertia in kg m² about the body axes.
        inertia: Vector,
    },
}

/// A body to add to a world. For [`Motion::Free`] the shape's origin is the
/// centre of mass and its axes are the principal axes of inertia.
#[derive(Debug, Clone)]
pub struct Body {
    /// Shape in body coordinates, in metres; shared by bodies that look alike.
    pub shape: Arc<ConvexPolyhedron>,
    /// How it moves.
    pub motion: Motion,
    /// What it is made of.
    pub material: Material,
    /// Where it is.
    pub state: BodyState,
}

impl Body {
    /// Whether an engine may see it: numbers that are finite, masses that are positive.
    fn check(&self) -> Result<(), WorldError> {
        let state = &self.state;
        let finite = state.pose.translation.vector.iter().all(|x| x.is_finite())
            && state.pose.rotation.coords.iter().all(|x| x.is_finite())
            && state.linear_velocity.iter().all(|x| x.is_finite())
            && state.angular_velocity.iter().all(|x| x.is_finite());
        let refuse = |reason: String| Err(WorldError::BadBody(reason));
        if !finite {
            return refuse("its pose or velocity is not finite".into());
        }
        // A rounding of the frame that the sphere was brought to.
        if let Some(sphere) = self.shape.sphere()
            && sphere.centre.coords.norm() > 1e-9 * sphere.radius
        {
            return refuse("the centre of a sphere is not the body's origin".into());
        }
        if let Motion::Pressed { mass, .. } | Motion::Free { mass, .. } = self.motion
            && !(mass.is_finite() && mass > 0.0)
        {
            return refuse(format!("its mass {mass} kg is not positive"));
        }
        match self.motion {
            Motion::Pressed { direction, .. } if !((direction.norm() - 1.0).abs() < 1e-9) => {
                refuse(format!("its direction {direction:?} is not a unit vector"))
            }
            Motion::Turned { inertia, .. } if !(inertia.is_finite() && inertia > 0.0) => {
                refuse(format!("its moment of inertia {inertia} kg m² is not positive"))
            }
            Motion::Turned { axis, about, .. }
                if !((axis.norm() - 1.0).abs() < 1e-9 && about.norm().is_finite()) =>
            {
                refuse(format!("its axis {axis:?} through {about:?} m is none"))
            }
            Motion::Free { inertia, .. } if !inertia.iter().all(|i| i.is_finite() && *i > 0.0) => {
                refuse(format!("its moments of inertia {inertia:?} kg m² are not positive"))
            }
            _ => Ok(()),
        }
    }
}

/// Pose and velocity of a body.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct BodyState {
    /// Position (m) and orientation of the body frame in the world.
    pub pose: Pose,
    /// Velocity of the body origin in m/s.
    pub linear_velocity: Vector,
    /// Angular velocity in rad/s, in world axes.
    pub angular_velocity: Vector,
}

impl BodyState {
    /// A body at rest at a pose.
    pub fn at_rest(pose: Pose) -> Self {
        Self { pose, linear_velocity: Vector::zeros(), angular_velocity: Vector::zeros() }
    }

    /// ½ ω · I ω in J, from principal moments of inertia in kg m² about the body axes.
    pub fn rotational_energy(&self, inertia: &Vector) -> f64 {
        // The moments are about body axes, the angular velocity is in world axes.
        let spin = self.pose.rotation.inverse() * self.angular_velocity;
        0.5 * inertia.dot(&spin.component_mul(&spin))
    }
}

/// Names a body in the world that returned it; bodies are numbered in the
/// order in which they were added, and numbers are never used again.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct BodyId(pub u32);

/// A shape as an engine holds it.
#[derive(Debug, Clone, PartialEq)]
pub struct HeldShape {
    /// Its corners in m and body coordinates; of a rounded polyhedron those of the core, of a
    /// sphere one point of its surface.
    pub corners: Vec<Vector>,
    /// Radius in m of the ball that sweeps the core; 0 where it is not rounded.
    pub rounding: f64,
}

/// One contact point between two bodies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contact {
    /// First body.
    pub a: BodyId,
    /// Second body.
    pub b: BodyId,
    /// Point midway between the surfaces, in m.
    pub point: Vector,
    /// Unit normal pointing from `b` to `a`.
    pub normal: Vector,
    /// Gap along the normal in m; negative where the bodies overlap.
    pub gap: f64,
    /// Impulse of the last step on `a` (opposite on `b`), in N s, world axes.
    pub impulse: Vector,
}

/// A loaded contact, as one world hands it to another that goes on from its state.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RememberedContact {
    /// First body.
    pub a: BodyId,
    /// Second body.
    pub b: BodyId,
    /// Point midway between the surfaces, in m.
    pub point: Vector,
    /// Unit normal pointing from `b` to `a`.
    pub normal: Vector,
    /// Mean force of the last step on `a` (opposite on `b`), in N, world axes.
    pub force: Vector,
    /// Share of that force with which the next step is warm-started; less than 1 after an
    /// impact, which says nothing about the force that follows.
    pub warm_start: f64,
    /// Which faces or edges touch, and which of their points this is, in the engine's own numbers.
    pub feature: [u32; 2],
}

/// The state of all bodies, in order of [`BodyId`]; `None` where a body was removed.
pub type Snapshot = Vec<Option<BodyState>>;

/// A setting as the engine holds it, read back after it was set.
pub type EffectiveSettings = std::collections::BTreeMap<String, serde_json::Value>;

/// Makes an empty world of settings, gravity (m/s²) and coefficients of pairs.
pub type WorldMaker<'a> = &'a (
        dyn Fn(&EngineSettings, Vector, &PairTable) -> Result<Box<dyn World + Send>, WorldError>
            + Sync
    );

/// A running simulation. Steps have a fixed length given at creation.
pub trait World {
    /// Adds a body; it takes part from the next step on.
    ///
    /// # Errors
    /// [`WorldError::BadBody`] for values no engine should see, and for what this one cannot take.
    fn add(&mut self, body: &Body) -> Result<BodyId, WorldError>;

    /// Removes a body with its contacts.
    ///
    /// # Errors
    /// [`WorldError::NoSuchBody`]; [`WorldError::BadBody`] while others are parts of it.
    fn remove(&mut self, id: BodyId) -> Result<(), WorldError>;

    /// Says where a kinematic body is at the end of the next step. It stays
    /// there until driven again; its contacts feel the velocity of the move.
    ///
    /// # Errors
    /// [`WorldError::NoSuchBody`], [`WorldError::NotKinematic`].
    fn drive(&mut self, id: BodyId, pose_at_end_of_step: &Pose) -> Result<(), WorldError>;

    /// Tells a new world, before its first step, where a kinematic body was at the ends of
    /// the last three steps in another world, the last one last: its velocity goes on
    /// changing as it did. Nothing for an engine that looks at one step alone.
    ///
    /// # Errors
    /// [`WorldError::NoSuchBody`], [`WorldError::NotKinematic`].
    fn recall_drive(&mut self, _id: BodyId, _ends: &[Pose; 3]) -> Result<(), WorldError> {
        Ok(())
    }

    /// Sets the force in N on a pressed body along its direction, or the moment in N m on a turned
    /// one about its axis, from the next step on; 0 in the beginning.
    ///
    /// # Errors
    /// [`WorldError::NoSuchBody`]; [`WorldError::NotPressed`].
    fn press(&mut self, id: BodyId, _force: f64) -> Result<(), WorldError> {
        Err(WorldError::NotPressed(id))
    }

    /// Makes a body a further part of another that was added before at the same pose: from the
    /// next step on they are one rigid body, with the motion, mass and inertia of the other, which
    /// all contacts of both act on. The part was added as kinematic where the other is pressed,
    /// turned or kinematic, and as free with the same values where it is free. Parts do not meet
    /// each other.
    ///
    /// # Errors
    /// [`WorldError::NoSuchBody`]; [`WorldError::BadBody`] where they cannot be one, and for an
    /// engine whose bodies have one part.
    fn join(&mut self, _part: BodyId, _whole: BodyId) -> Result<(), WorldError> {
        Err(WorldError::BadBody("this engine has no bodies of several parts".into()))
    }

    /// Reads the state of one body.
    ///
    /// # Errors
    /// [`WorldError::NoSuchBody`].
    fn read_body(&self, id: BodyId) -> Result<BodyState, WorldError> {
        let mut all = Vec::new();
        self.read(&mut all);
        all.get(id.0 as usize).copied().flatten().ok_or(WorldError::NoSuchBody(id))
    }

    /// Advances by one time step.
    ///
    /// # Errors
    /// [`WorldError::Engine`].
    fn step(&mut self) -> Result<(), WorldError>;

    /// Length of a step in s.
    fn time_step(&self) -> f64;

    /// Reads the state of all bodies into `into`, replacing its content.
    fn read(&self, into: &mut Snapshot);

    /// Reads all contact points into `into`, replacing its content.
    fn contacts(&self, into: &mut Vec<Contact>);

    /// Reads the loaded contacts into `into`, replacing its content: what a new world must know
    /// beside the bodies to go on without a jump. Empty for an engine that cannot be told.
    fn remember(&self, into: &mut Vec<RememberedContact>) {
        into.clear();
    }

    /// Tells a new world, before its first step, which contacts its bodies bring.
    /// Their order, that of the two bodies of each, and that in which the bodies were
    /// added do not matter: every contact is taken over with its impulse.
    ///
    /// # Errors
    /// [`WorldError::BadBody`] for values no engine should see.
    fn recall(&mut self, _contacts: &[RememberedContact]) -> Result<(), WorldError> {
        Ok(())
    }

    /// Reads the corners of the shape that each body has in the engine, without any collision
    /// margin, in m and body coordinates, in order of [`BodyId`] into `into`, replacing its
    /// content; `None` where a body was removed. Of a sphere one, on its surface; of a rounded
    /// polyhedron those of its core. Empty for an engine that cannot be asked.
    fn corners(&self, into: &mut Vec<Option<HeldShape>>) {
        into.clear();
    }

    /// Where the engine's time went since the world was made; `None` for an
    /// engine that does not say.
    fn phases(&self) -> Option<PhaseTimes> {
        None
    }

    /// How well the contacts were solved in a step of the last few: the natural
    /// map of the laws of contact and friction over the impulses found, both in
    /// the kinetic norm; 0 is exact, 0.01 is a hundredth of the impulses. `None`
    /// for an engine that does not say, and before the first step.
    fn solver_residual(&self) -> Option<f64> {
        None
    }

    /// The coefficients that a contact between these bodies gets.
    ///
    /// # Errors
    /// [`WorldError::NoSuchBody`].
    fn pair_coefficients(&self, a: BodyId, b: BodyId) -> Result<PairCoefficients, WorldError>;

    /// Every engine setting as read back from the engine.
    fn effective(&self) -> EffectiveSettings;
}

/// Wall time of the parts of the steps taken, in s.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct PhaseTimes {
    /// Boxes around the bodies, and pairs of boxes that overlap.
    pub broadphase_s: f64,
    /// Contacts of these pairs.
    pub collision_s: f64,
    /// Impulses at the contacts.
    pub solver_s: f64,
    /// Forces before and motion after, and everything else.
    pub integration_s: f64,
    /// Of all four, what threads can share; on one thread, too, which shares it with nobody.
    /// 0 for an engine that does not say.
    pub shared_s: f64,
    /// Numbers of threads, and how long `shared_s` would take on each if waiting for each other
    /// cost nothing; measured on one thread, shorter on several.
    pub shared_on_s: [(u32, f64); 3],
}

/// Name, version and precision of an engine, as written into every result.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct BackendInfo {
    /// `bullet`, ...
    pub name: String,
    /// Version of the engine.
    pub version: String,
    /// `double` or `single`.
    pub precision: String,
}

/// Makes an empty world of the engine that the settings name; gravity in m/s².
///
/// # Errors
/// [`WorldError::BadSetting`] and [`WorldError::Engine`] as the engine has it;
/// [`WorldError::BadSetting`] also for an engine this program was built without.
///
/// A cube of 10 mm falls for a quarter of a second:
///
/// ```
/// use std::sync::Arc;
/// use pluvia::geometry::{ConvexPolyhedron, Pose, Vector};
/// use pluvia::scenario::EngineSettings;
/// use pluvia::world::{self, Body, BodyState, Material, Motion, PairCoefficients, PairTable};
///
/// let pairs = PairTable::uniform(PairCoefficients { friction: 0.5, restitution: 0.3 });
/// let down = Vector::new(0.0, 0.0, -9.81);
/// let mut world = world::create(&EngineSettings::default(), down, &pairs)?;
/// world.add(&Body {
///     shape: Arc::new(ConvexPolyhedron::cuboid(Vector::repeat(0.01))?),
///     motion: Motion::Free { mass: 2.65e-3, inertia: Vector::repeat(4.4e-8) },
///     material: Material::Grain,
///     state: BodyState::at_rest(Pose::translation(0.0, 0.0, 1.0)),
/// })?;
/// let steps = (0.25 / world.time_step()).round() as usize;
/// for _ in 0..steps {
///     world.step()?;
/// }
/// let mut states = Vec::new();
/// world.read(&mut states);
/// let height = states[0].expect("it is there").pose.translation.z;
/// // 1 m − g t²/2, to the error of a finite step.
/// assert!((height - 0.6934).abs() < 0.003);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn create(
    settings: &EngineSettings,
    gravity: Vector,
    pairs: &PairTable,
) -> Result<Box<dyn World + Send>, WorldError> {
    match settings.backend {
        Backend::Bullet => Ok(Box::new(bullet::BulletBackend::new(settings, gravity, pairs)?)),
        #[cfg(feature = "rapier")]
        Backend::Rapier => Ok(Box::new(rapier::RapierBackend::new(settings, gravity, pairs)?)),
        #[cfg(not(feature = "rapier"))]
        Backend::Rapier => Err(WorldError::bad_setting(
            "backend",
            "this program was built without rapier; build it with the feature of that name, which \
             is on by default: cargo build --release --features rapier",
        )),
    }
}

/// Name, version and precision of an engine.
pub fn info(backend: Backend) -> BackendInfo {
    match backend {
        Backend::Bullet => bullet::info(),
        #[cfg(feature = "rapier")]
        Backend::Rapier => rapier::info(),
        #[cfg(not(feature = "rapier"))]
        Backend::Rapier => BackendInfo {
            name: "rapier".into(),
            version: "not built in".into(),
            precision: "none".into(),
        },
    }
}

/// The engines this program was built with; the first is the default.
pub fn built_in() -> &'static [Backend] {
    #[cfg(feature = "rapier")]
    return &[Backend::Bullet, Backend::Rapier];
    #[cfg(not(feature = "rapier"))]
    &[Backend::Bullet]
}
