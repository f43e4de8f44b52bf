//! Settings of the rapier engine as a person types them.
//!
//! Rapier's own defaults are made for bodies of a metre: with them, grains of
//! 10 mm sink into each other. Every default here is set for such grains;
//! `docs/parameters.md` holds what was measured.

use super::*;

/// How rapier resists sliding.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum FrictionModel {
    /// Friction at every contact point (rapier's `Coulomb`). At points beside
    /// the line of motion it is turned away from it, so that less of it acts:
    /// a square block sliding parallel to its sides feels 0.44 where 0.5 was
    /// typed. See [`RapierSettings::friction_model`].
    Coulomb,
    /// One friction in the middle of the points that two bodies share, and one
    /// against twisting (rapier's `Simplified`, and its default).
    Simplified,
}

parts! {
/// What only rapier asks for. `rate_hz`, `gyroscopic` and the dampings of the
/// engine settings apply to it too; the other fields there are Bullet's, also
/// `iterations`, whose part `substeps` has.
///
/// The defaults are for grains of 10 mm at 480 steps per second. What is said of
/// them was measured on 364 grains poured from 5 cm and then left alone
/// (`docs/parameters.md`); the paper's standard is `docs/accuracy.md`.
#[serde(default)]
pub struct RapierSettings {
    /// Sub-steps into which the solver divides a step (rapier's
    /// `num_solver_iterations`); contacts are found once a step. Fewer:
    /// contacts give way, and springs stiffer than a quarter of the sub-steps'
    /// rate shake the packing; more: slower.
    pub substeps: u32 = 4, from 1 to 1000;
    /// Iterations over all contacts per sub-step that push overlaps apart
    /// (`num_internal_pgs_iterations`). One, because sub-steps do more for the
    /// same cost; more: slower.
    pub iterations: u32 = 1, from 1 to 1000;
    /// Iterations per sub-step that take the speed of that pushing away again and
    /// solve friction (`num_internal_stabilization_iterations`). 0: that speed
    /// stays; 1: the packing sinks by 10 µm/s, with 2 by 1 µm/s; more: slower.
    pub relaxing_iterations: u32 = 2, from 0 to 1000;
    /// Natural frequency of the spring in a contact, in Hz. Lower: bodies sink
    /// into each other by g/(2πf)² for each layer above (at 300 Hz overlaps
    /// are two and a half times those at 500); higher than about a quarter of
    /// the rate of the sub-steps: the packing jitters and sinks.
    pub contact_frequency_hz: f64 = 500.0,
        schemars(extend("exclusiveMinimum" = 0.0), range(max = 1e6));
    /// Damping ratio of that spring; 1 is critical. Lower: overlaps are pushed
    /// apart with speed left over; higher: they take longer to go. Between 1
    /// and 2 nothing measured differs.
    pub contact_damping_ratio: f64 = 1.0, from 0.0 to 1000.0;
    /// The natural frequency where one of the bodies is fixed for ever, in Hz:
    /// the funnel, and the base of a pile. (Cylinder and floor are kinematic, also
    /// where they rest, as are pieces of a laboratory.)
    pub wall_contact_frequency_hz: f64 = 500.0,
        schemars(extend("exclusiveMinimum" = 0.0), range(max = 1e6));
    /// The damping ratio there.
    pub wall_contact_damping_ratio: f64 = 1.0, from 0.0 to 1000.0;
    /// Share of the last step's impulses, of friction too, with which the
    /// solver starts. Below 1: each step forgets some of the forces of the
    /// last, which makes a packing creep numerically in other solvers; 1 is
    /// rapier's own.
    pub warm_start: f64 = 1.0, from 0.0 to 1.0;
    /// Length of one engine unit in mm. The collision library's tolerances are
    /// in engine units: it keeps contact points until they shift by more than
    /// a thousandth of a unit. Longer: stale contacts; shorter: contacts are
    /// needlessly recomputed. Units of 1, 10 and 100 mm differ little.
    pub engine_unit_mm: f64 = 10.0, from 0.01 to 100_000.0;
    /// Gap in mm up to which contacts are prepared in advance. Smaller: grains
    /// sink in before they are met; larger: contacts that bear nothing, which
    /// at 1 mm cost half as much again.
    pub prediction_mm: f64 = 0.3, schemars(extend("exclusiveMinimum" = 0.0), range(max = 1000.0));
    /// Largest speed in m/s at which an overlap is pushed apart. Lower:
    /// overlaps made by impacts last; higher: they burst.
    pub corrective_speed_m_per_s: f64 = 3.0,
        schemars(extend("exclusiveMinimum" = 0.0), range(max = 1000.0));
    /// How sliding is resisted. Both models solve the two directions of the
    /// contact plane together and then cut the impulse to its limit
    /// (`ContactConstraintTangentPart::solve`, 0.36), which turns it towards
    /// where the bodies give way most easily: with `coulomb` a block slides 4
    /// to 13 % too far and up to 13° aside, with `simplified` 0 to 1 % and 5°.
    pub friction_model: FrictionModel = FrictionModel::Simplified;
    /// Solve friction also while overlaps are pushed apart, not only in the
    /// relaxing iterations. Rapier's authors keep it `false` because friction
    /// against the speed of pushing topples tall stacks
    /// (`IntegrationParameters::friction_in_bias_pass`, 0.36).
    pub friction_while_correcting: bool = false;
    /// Clip contacts against the four corners that span a face. `false`, the
    /// collision library's own: against the first four it has stored, which
    /// leaves what lies on the rest of the face rocking on one point, and lets
    /// a packing at rest sink by 0.1 to 0.6 mm/s.
    pub spanned_faces: bool = true;
    /// Keep the contact points of pairs that hardly moved. `false`: they change
    /// for nothing; the packing sinks by 5 µm/s where it else sinks by 1, and
    /// a step costs more than half as much again.
    pub contact_recycling: bool = true;
    /// Relative movement in mm up to which they are kept. Smaller: more
    /// jitter, and slower; larger: contact normals are stale.
    pub recycling_distance_mm: f64 = 0.2,
        schemars(extend("exclusiveMinimum" = 0.0), range(max = 1000.0));
}
}
