//! The Bullet backend: the only place that knows Bullet's names.
//!
//! Everything is validated here, in Rust, before it crosses to C++, and every
//! setting is read back from the engine ([`World::effective`]).
//!
//! What finds contacts and what solves them is chosen in one place, the constructor of
//! `BulletWorld::Impl` in `cpp/world.cpp`, by [`crate::scenario::ContactSolver`].

mod constants;
#[cfg(test)]
mod crowd_tests;
mod definition;
#[cfg(test)]
mod drive_tests;
mod ffi;
#[cfg(test)]
mod impact_tests;
#[cfg(test)]
mod landing_tests;
#[cfg(test)]
mod native_tests;
#[cfg(test)]
mod part_tests;
#[cfg(test)]
mod press_tests;
pub mod probe;
#[cfg(test)]
mod recall_tests;
#[cfg(test)]
mod rest_tests;
#[cfg(test)]
mod rounded_tests;
mod sharing;
#[cfg(test)]
mod shim_tests;
#[cfg(test)]
mod sphere_tests;
#[cfg(test)]
mod stock_tests;
mod substep;
#[cfg(test)]
pub(crate) mod tests;
#[cfg(test)]
mod tolerance_tests;
#[cfg(test)]
mod turn_tests;
#[cfg(test)]
mod warm_start_tests;

pub use substep::SubstepRecord;

use std::{collections::HashMap, sync::Arc, time::Instant};

use definition::definition;
use nalgebra::{Quaternion, UnitQuaternion};
use sharing::Sharing;

use super::{
    BackendInfo, Body, BodyId, BodyState, Contact, EffectiveSettings, HeldShape, Motion,
    PairCoefficients, PairTable, PhaseTimes, RememberedContact, Snapshot, World, WorldError,
};
use crate::geometry::{ConvexPolyhedron, Pose, Vector};
use crate::scenario::EngineSettings;

/// A Bullet world. See [`World`].
pub struct BulletBackend {
    world: cxx::UniquePtr<ffi::BulletWorld>,
    time_step: f64,
    /// Shapes already known to the engine, by address; the `Arc`s keep the
    /// addresses from being used again.
    shapes: HashMap<usize, (u32, Arc<ConvexPolyhedron>)>,
    /// By body: whether it may be driven.
    kinematic: Vec<bool>,
    pressed: Vec<BodyId>,
    sharing: Sharing,
}

/// Name, version and precision of the Bullet this program is linked with.
pub fn info() -> BackendInfo {
    let version = constants::PLUVIA_BULLET_VERSION;
    BackendInfo {
        name: "bullet".into(),
        version: format!("{}.{:02}", version / 100, version % 100),
        precision: if constants::PLUVIA_SCALAR_BYTES == 8 { "double" } else { "single" }.into(),
    }
}

impl BulletBackend {
    /// Makes an empty world.
    ///
    /// `gravity` in m/s². Settings are applied, and those of the solver compared with what the
    /// world then holds.
    ///
    /// # Errors
    /// [`WorldError::BadSetting`] for a value Bullet cannot take or did not keep;
    /// [`WorldError::Engine`] when another world in this process holds other process-wide settings.
    pub fn new(
        settings: &EngineSettings,
        gravity: Vector,
        pairs: &PairTable,
    ) -> Result<Self, WorldError> {
        let definition = definition(settings, gravity, pairs.materials().len())?;
        pairs.check()?;
        let pair_values: Vec<ffi::PairValue> = pairs
            .values()
            .iter()
            .map(|p| ffi::PairValue { friction: p.friction, restitution: p.restitution })
            .collect();
        let world = ffi::new_world(&definition, &pair_values).map_err(engine)?;
        let backend = Self {
            world,
            time_step: definition.time_step,
            shapes: HashMap::new(),
            kinematic: Vec::new(),
            pressed: Vec::new(),
            sharing: Sharing::new(settings.native.may_leave_threads),
        };
        backend.check_kept(&definition)?;
        Ok(backend)
    }

    /// Compares what was asked for with what the world holds.
    fn check_kept(&self, d: &ffi::WorldDefinition) -> Result<(), WorldError> {
        let held = self.effective();
        let single = constants::PLUVIA_SCALAR_BYTES == 4;
        let tolerance = if single { 1e-6 } else { 1e-12 };
        // One variable of Bullet's holds whichever of the two thresholds is used.
        let threshold = if d.relative_contact_threshold > 0.0 {
            ("relative_contact_threshold", d.relative_contact_threshold)
        } else {
            ("contact_breaking_threshold_m", d.contact_threshold)
        };
        let of_stock = [
            threshold,
            ("broadphase_margin_m", d.broadphase_margin),
            ("iterations", f64::from(d.iterations)),
            ("solver_mode", f64::from(d.solver_mode)),
            ("erp2", d.erp),
            ("warm_starting_factor", d.warm_start),
            ("split_impulse", f64::from(u8::from(d.split_impulse))),
            ("restitution_velocity_threshold_m_per_s", d.restitution_velocity_threshold),
        ];
        let of_native = [
            ("native_speculative_margin_m", d.contact_threshold.min(d.tolerances.contact_margin)),
            ("box_slack_m", d.tolerances.box_slack),
            ("gyroscopic", f64::from(u8::from(d.gyroscopic))),
            ("substeps", f64::from(d.substeps)),
            ("iterations_in_a_substep", f64::from(d.native_iterations)),
            ("solver_tolerance", d.solver_tolerance),
            ("restitution_speed_m_per_s", d.restitution_velocity_threshold),
        ];
        let of_both = [
            ("time_step_s", d.time_step),
            ("gravity_x_m_per_s2", d.gravity[0]),
            ("gravity_y_m_per_s2", d.gravity[1]),
            ("gravity_z_m_per_s2", d.gravity[2]),
        ];
        let own: &[(&str, f64)] = if d.own_collision { &of_native } else { &of_stock };
        for &(name, asked) in of_both.iter().chain(own) {
            let kept = held.get(name).and_then(serde_json::Value::as_f64);
            let good = kept.is_some_and(|k| (k - asked).abs() <= tolerance * asked.abs().max(1e-9));
            if !good {
                let reason = format!("asked for {asked}, the engine holds {kept:?}");
                return Err(WorldError::bad_setting(name, reason));
            }
        }
        Ok(())
    }

    fn check_kinematic(&self, id: BodyId) -> Result<(), WorldError> {
        match self.kinematic.get(id.0 as usize) {
            None => Err(WorldError::NoSuchBody(id)),
            Some(false) => Err(WorldError::NotKinematic(id)),
            Some(true) => Ok(()),
        }
    }

    fn shape(&mut self, shape: &Arc<ConvexPolyhedron>) -> Result<u32, WorldError> {
        let key = Arc::as_ptr(shape).addr();
        if let Some((index, _)) = self.shapes.get(&key) {
            return Ok(*index);
        }
        let index = self.world.pin_mut().add_shape(&flat(shape)).map_err(refused)?;
        self.shapes.insert(key, (index, Arc::clone(shape)));
        Ok(index)
    }
}

/// A polyhedron, the core of a rounded one, or a sphere as it crosses the bridge.
fn flat(shape: &ConvexPolyhedron) -> ffi::ShapeDefinition {
    if let Some(sphere) = shape.sphere() {
        return ffi::ShapeDefinition { radius: sphere.radius, ..Default::default() };
    }
    let (shape, radius) = shape.core();
    let mut face_starts = vec![0];
    let mut face_vertices = vec![];
    for face in shape.faces() {
        face_vertices.extend_from_slice(face);
        face_starts.push(face_vertices.len() as u32);
    }
    let coordinates = shape.vertices().iter().flat_map(|v| [v.x, v.y, v.z]).collect();
    ffi::ShapeDefinition { radius, coordinates, face_starts, face_vertices }
}

fn engine(error: cxx::Exception) -> WorldError {
    WorldError::Engine(error.what().to_owned())
}

fn refused(error: cxx::Exception) -> WorldError {
    WorldError::BadBody(error.what().to_owned())
}

fn body_pose(pose: &Pose) -> ffi::BodyPose {
    let q = pose.rotation.coords;
    ffi::BodyPose { position: pose.translation.vector.into(), rotation: [q.x, q.y, q.z, q.w] }
}

/// A state as it comes over the bridge.
fn state(read: &ffi::BodyRead) -> BodyState {
    let [x, y, z, w] = read.rotation;
    BodyState {
        pose: Pose::from_parts(
            Vector::from(read.position).into(),
            UnitQuaternion::new_normalize(Quaternion::new(w, x, y, z)),
        ),
        linear_velocity: read.linear_velocity.into(),
        angular_velocity: read.angular_velocity.into(),
    }
}

impl World for BulletBackend {
    fn add(&mut self, body: &Body) -> Result<BodyId, WorldError> {
        body.check()?;
        let shape = self.shape(&body.shape)?;
        let (kind, mass, inertia) = match body.motion {
            Motion::Static => (ffi::BodyKind::Static, 0.0, Vector::zeros()),
            Motion::Kinematic | Motion::Pressed { .. } | Motion::Turned { .. } => {
                (ffi::BodyKind::Kinematic, 0.0, Vector::zeros())
            }
            Motion::Free { mass, inertia } => (ffi::BodyKind::Free, mass, inertia),
        };
        let ffi::BodyPose { position, rotation } = body_pose(&body.state.pose);
        let id = self
            .world
            .pin_mut()
            .add_body(&ffi::BodyDefinition {
                shape,
                kind,
                material: body.material.index() as u32,
                mass,
                inertia: inertia.into(),
                position,
                rotation,
                linear_velocity: body.state.linear_velocity.into(),
                angular_velocity: body.state.angular_velocity.into(),
            })
            .map_err(engine)?;
        self.kinematic.push(matches!(body.motion, Motion::Kinematic));
        let definition = match body.motion {
            Motion::Pressed { mass, direction } => ffi::PressDefinition {
                turns: false,
                direction: direction.into(),
                about: [0.0; 3],
                mass,
                speed: direction.dot(&body.state.linear_velocity),
            },
            Motion::Turned { inertia, axis, about } => ffi::PressDefinition {
                turns: true,
                direction: axis.into(),
                about: about.into(),
                mass: inertia,
                speed: axis.dot(&body.state.angular_velocity),
            },
            _ => return Ok(BodyId(id)),
        };
        if let Err(error) = self.world.pin_mut().press_body(id, &definition) {
            self.world.pin_mut().remove_body(id).map_err(engine)?;
            return Err(refused(error));
        }
        self.pressed.push(BodyId(id));
        Ok(BodyId(id))
    }

    fn remove(&mut self, id: BodyId) -> Result<(), WorldError> {
        self.read_body(id)?;
        self.world.pin_mut().remove_body(id.0).map_err(refused)
    }

    fn drive(&mut self, id: BodyId, pose: &Pose) -> Result<(), WorldError> {
        self.check_kinematic(id)?;
        let end = body_pose(pose);
        self.world.pin_mut().drive_body(id.0, &end).map_err(|_| WorldError::NoSuchBody(id))
    }

    fn recall_drive(&mut self, id: BodyId, ends: &[Pose; 3]) -> Result<(), WorldError> {
        self.check_kinematic(id)?;
        let ends = ends.map(|pose| body_pose(&pose));
        self.world.pin_mut().recall_drive(id.0, &ends).map_err(|_| WorldError::NoSuchBody(id))
    }

    fn press(&mut self, id: BodyId, force: f64) -> Result<(), WorldError> {
        if !self.pressed.contains(&id) {
            return Err(WorldError::NotPressed(id));
        }
        self.world.pin_mut().set_force(id.0, force).map_err(|_| WorldError::NoSuchBody(id))
    }

    fn join(&mut self, part: BodyId, whole: BodyId) -> Result<(), WorldError> {
        let (a, b) = (self.read_body(part)?, self.read_body(whole)?);
        if a.pose != b.pose {
            return Err(WorldError::BadBody("its parts differ in pose".into()));
        }
        self.world.pin_mut().join_body(part.0, whole.0).map_err(refused)?;
        self.kinematic[part.0 as usize] = false;
        Ok(())
    }

    fn read_body(&self, id: BodyId) -> Result<BodyState, WorldError> {
        self.world.read_one_body(id.0).map(|b| state(&b)).map_err(|_| WorldError::NoSuchBody(id))
    }

    fn step(&mut self) -> Result<(), WorldError> {
        let began = Instant::now();
        self.world.pin_mut().step(self.sharing.alone()).map_err(engine)?;
        self.sharing.took(began.elapsed());
        Ok(())
    }

    fn time_step(&self) -> f64 {
        self.time_step
    }

    fn read(&self, into: &mut Snapshot) {
        let mut bodies = Vec::new();
        self.world.read_bodies(&mut bodies);
        into.clear();
        into.extend(bodies.iter().map(|b| b.present.then(|| state(b))));
    }

    fn corners(&self, into: &mut Vec<Option<HeldShape>>) {
        let (mut counts, mut coordinates, mut roundings) = (Vec::new(), Vec::new(), Vec::new());
        self.world.read_corners(&mut counts, &mut coordinates, &mut roundings);
        let mut corners = coordinates.chunks_exact(3).map(Vector::from_column_slice);
        into.clear();
        into.extend(counts.iter().zip(&roundings).map(|(&count, &rounding)| {
            let corners = corners.by_ref().take(count as usize).collect();
            (count > 0).then_some(HeldShape { corners, rounding })
        }));
    }

    fn contacts(&self, into: &mut Vec<Contact>) {
        let mut contacts = Vec::new();
        self.world.read_contacts(&mut contacts);
        into.clear();
        into.extend(contacts.iter().map(|c| Contact {
            a: BodyId(c.a),
            b: BodyId(c.b),
            point: c.point.into(),
            normal: c.normal.into(),
            gap: c.gap,
            impulse: c.impulse.into(),
        }));
    }

    fn remember(&self, into: &mut Vec<RememberedContact>) {
        let mut contacts = Vec::new();
        self.world.remember_contacts(&mut contacts);
        into.clear();
        into.extend(contacts.iter().map(|c| RememberedContact {
            a: BodyId(c.a),
            b: BodyId(c.b),
            point: c.point.into(),
            normal: c.normal.into(),
            force: Vector::from(c.impulse) / self.time_step,
            warm_start: c.warm_start,
            feature: [c.feature, c.id],
        }));
    }

    fn recall(&mut self, contacts: &[RememberedContact]) -> Result<(), WorldError> {
        let finite = |c: &RememberedContact| {
            [c.point, c.normal, c.force].iter().all(|v| v.iter().all(|x| x.is_finite()))
                && c.warm_start.is_finite()
        };
        let refuse = |how: String| Err(WorldError::BadBody(format!("a remembered contact {how}")));
        if let Some(bad) = contacts.iter().find(|c| !finite(c)) {
            return refuse(format!("is not finite: {bad:?}"));
        }
        if let Some(bad) = contacts.iter().find(|c| c.warm_start < 0.0) {
            return refuse(format!("would pull: warm start below 0: {bad:?}"));
        }
        let contacts: Vec<ffi::ContactRead> = contacts
            .iter()
            .map(|c| ffi::ContactRead {
                a: c.a.0,
                b: c.b.0,
                point: c.point.into(),
                normal: c.normal.into(),
                gap: 0.0,
                impulse: (c.force * self.time_step).into(),
                warm_start: c.warm_start,
                feature: c.feature[0],
                id: c.feature[1],
            })
            .collect();
        self.world.pin_mut().recall_contacts(&contacts).map_err(engine)
    }

    fn pair_coefficients(&self, a: BodyId, b: BodyId) -> Result<PairCoefficients, WorldError> {
        // Which of the two is missing: asked one by one.
        for id in [a, b] {
            self.world.pair_value(id.0, id.0).map_err(|_| WorldError::NoSuchBody(id))?;
        }
        let value = self.world.pair_value(a.0, b.0).map_err(engine)?;
        Ok(PairCoefficients { friction: value.friction, restitution: value.restitution })
    }

    fn phases(&self) -> Option<PhaseTimes> {
        let p = self.world.phases();
        Some(PhaseTimes {
            broadphase_s: p.broadphase,
            collision_s: p.collision,
            solver_s: p.solver,
            integration_s: p.integration,
            shared_s: p.shared,
            shared_on_s: std::array::from_fn(|n| (p.threads[n], p.shared_on[n])),
        })
    }

    fn solver_residual(&self) -> Option<f64> {
        Some(self.world.solver_residual()).filter(|r| *r >= 0.0)
    }

    fn effective(&self) -> EffectiveSettings {
        let mut settings: EffectiveSettings = self
            .world
            .effective()
            .into_iter()
            .map(|s| (s.name, serde_json::json!(s.value)))
            .collect();
        let info = info();
        settings.insert("engine".into(), info.name.into());
        settings.insert("engine_version".into(), info.version.into());
        settings.insert("engine_precision".into(), info.precision.into());
        settings
    }
}
