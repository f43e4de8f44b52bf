//! One pair of hulls outside any world: what the native contact solver finds
//! for given poses, step after step.
//!
//! For tests, which compare it with exact references. And the memory that the process holds, and
//! what happens within the step of a world.

use super::{BulletBackend, body_pose, definition::tolerances, engine, ffi, flat};
use crate::geometry::{ConvexPolyhedron, Pose, Vector};
use crate::scale::Scale;
use crate::world::WorldError;

/// How a pair is probed.
#[derive(Debug, Clone, Copy)]
pub struct ProbeSettings {
    /// Engine length units in a metre.
    pub length_scale: f64,
    /// Gap in m up to which contact points are kept.
    pub speculative_margin: f64,
    /// Use the code that runs on every processor instead of the fastest.
    pub portable: bool,
}

impl Default for ProbeSettings {
    fn default() -> Self {
        Self { length_scale: 100.0, speculative_margin: 0.5e-3, portable: false }
    }
}

/// A contact point, all in SI units and world axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ProbePoint {
    /// Gap along the normal in m; negative where the bodies overlap.
    pub gap: f64,
    /// Unit normal pointing from B to A.
    pub normal: Vector,
    /// Point on A's surface in m.
    pub on_a: Vector,
    /// Point on B's surface in m.
    pub on_b: Vector,
    /// Name of the features that meet; the same from step to step.
    pub id: u32,
    /// Steps since the point appeared; 0 when it is new.
    pub age: i32,
    /// Normal impulse of the last step, carried over, in N s.
    pub impulse: f64,
    /// Friction impulse of the last step, carried over, in N s.
    pub friction: Vector,
}

/// The widest gap over all axes of the separating axis test.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ProbeGap {
    /// Gap in m, negative for overlap.
    pub gap: f64,
    /// Unit vector from A to B.
    pub axis: Vector,
}

/// Two hulls and what their pair remembers.
pub struct HullPair(cxx::UniquePtr<ffi::HullProbe>);

impl HullPair {
    /// Prepares two shapes.
    ///
    /// # Errors
    /// [`WorldError::Engine`] for a shape the engine cannot take.
    pub fn new(
        a: &ConvexPolyhedron,
        b: &ConvexPolyhedron,
        settings: ProbeSettings,
    ) -> Result<Self, WorldError> {
        ffi::new_hull_probe(
            settings.length_scale,
            &ffi::Tolerances {
                contact_margin: settings.speculative_margin,
                ..tolerances(&Scale::PAPER)
            },
            settings.portable,
            &flat(a),
            &flat(b),
        )
        .map(Self)
        .map_err(engine)
    }

    /// The contact at these poses, remembering the steps before.
    pub fn step(&mut self, a: &Pose, b: &Pose) -> Vec<ProbePoint> {
        self.0
            .pin_mut()
            .step(&body_pose(a), &body_pose(b))
            .into_iter()
            .map(|p| ProbePoint {
                gap: p.gap,
                normal: p.normal.into(),
                on_a: p.on_a.into(),
                on_b: p.on_b.into(),
                id: p.id,
                age: p.age,
                impulse: p.impulse,
                friction: p.friction.into(),
            })
            .collect()
    }

    /// Leaves impulses (N s) behind in a point as a solver does; `friction` in world axes.
    ///
    /// # Errors
    /// [`WorldError::Engine`] when there is no such point.
    pub fn set_impulse(
        &mut self,
        point: usize,
        normal: f64,
        friction: &Vector,
    ) -> Result<(), WorldError> {
        self.0.pin_mut().set_impulse(point, normal, &(*friction).into()).map_err(engine)
    }

    /// Forgets the steps before.
    pub fn forget(&mut self) {
        self.0.pin_mut().forget();
    }

    /// The widest gap; `all_edges` looks at every pair of edges, else only at those near the faces
    /// that are closest. Both agree wherever the bodies overlap.
    pub fn widest_gap(&mut self, a: &Pose, b: &Pose, all_edges: bool) -> ProbeGap {
        let found = self.0.pin_mut().widest_gap(&body_pose(a), &body_pose(b), all_edges);
        ProbeGap { gap: found.gap, axis: found.axis.into() }
    }
}

/// Bytes that the allocator has handed out to this process and not got back, to
/// C++ and Rust alike; `None` where it does not say.
pub fn bytes_handed_out() -> Option<i64> {
    let bytes = ffi::bytes_handed_out();
    (bytes >= 0).then_some(bytes)
}

impl BulletBackend {
    /// Finds the contacts where the bodies are without a step: with the impulses
    /// that the next step begins with.
    ///
    /// # Errors
    /// [`WorldError::Engine`], always with stock Bullet contacts.
    pub fn find_contacts(&mut self) -> Result<(), WorldError> {
        self.world.pin_mut().find_contacts().map_err(engine)
    }

    /// How each kinematic body went through the last step; empty with stock Bullet
    /// contacts, and once a body came or went.
    #[cfg(test)]
    pub(super) fn drives(&self) -> Vec<ffi::DriveRead> {
        let mut drives = Vec::new();
        self.world.read_drives(&mut drives);
        drives
    }
}
