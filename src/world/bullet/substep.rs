//! The contact problem of a sub-step, for others to solve.

use super::BulletBackend;

/// The contact problem of one sub-step as the native solver had it, and what it
/// found, in the engine's unit of length.
///
/// Bodies turn in it by the root of their inertia times their spin, s = √I ω, so that kinetic
/// energy is ½ m v² + ½ s². Bodies that do not move have an inverse mass of 0.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SubstepRecord {
    /// [`SubstepRecord::BODY`] numbers a body: inverse mass (1/kg); v and s with
    /// everything but the impulses of contacts; v and s as found.
    pub bodies: Vec<f64>,
    /// [`SubstepRecord::CONTACT`] numbers a contact point: places of bodies A and B;
    /// for the normal (from B to A) and two tangents the direction d, and √I⁻¹ (r × d)
    /// of A and of B; friction coefficient, bias velocity b, softness γ; approach
    /// velocity, coefficient of restitution; the impulses λ found along the three.
    /// The law is v + γ λ − b ≥ 0 along the normal where λ > 0, and Coulomb's cone.
    pub contacts: Vec<f64>,
}

impl SubstepRecord {
    /// Numbers of a body.
    pub const BODY: usize = 13;
    /// Numbers of a contact point.
    pub const CONTACT: usize = 37;
}

impl BulletBackend {
    /// Has the contact problem of every step's last sub-step recorded from now on.
    pub fn record_substeps(&mut self) {
        self.world.pin_mut().record_substeps();
    }

    /// The contact problem of the last step's last sub-step, and its solution; see
    /// [`SubstepRecord`]. Empty with stock Bullet contacts.
    pub fn recorded_substep(&self) -> SubstepRecord {
        let (mut bodies, mut contacts) = (Vec::new(), Vec::new());
        self.world.read_substep(&mut bodies, &mut contacts);
        SubstepRecord { bodies, contacts }
    }
}
