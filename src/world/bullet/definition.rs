//! From the settings of an engine to what the bridge takes, checked value by value.

use super::{constants, ffi};
use crate::geometry::Vector;
use crate::scale::{self, Scale};
use crate::scenario::{ContactSolver, EngineSettings, InertiaRule, StockSettings};
use crate::units::{from_g, from_mm};
use crate::world::{WorldError, finite, positive, sound};

/// Everything that is fixed when a world is made; gravity in m/s²,
/// and how many materials bodies are of.
///
/// # Errors
/// [`WorldError::BadSetting`] for a value that Bullet cannot take.
pub(super) fn definition(
    s: &EngineSettings,
    gravity: Vector,
    materials: usize,
) -> Result<ffi::WorldDefinition, WorldError> {
    let zero_or_more = |setting: &str, value: f64| {
        let is_sound = value.is_finite() && value >= 0.0;
        sound(setting, value, is_sound, "neither zero nor a positive number")
    };
    if s.contact_solver == ContactSolver::Native && s.stock != StockSettings::default() {
        let reason = "these are settings of stock Bullet contacts; the native contact solver \
                      asks for hulls without margin and bodies that never sleep";
        return Err(WorldError::bad_setting("stock", reason));
    }
    finite(&gravity)?;
    let size = from_mm(positive("grain_size_mm", s.grain_size_mm)?);
    let scale = Scale::of_smallest(size, Scale::PAPER.gravity);
    let mut solver_mode = constants::SOLVER_USE_WARMSTARTING;
    let is_sound = (1..=2).contains(&s.friction_directions);
    if sound("friction_directions", s.friction_directions, is_sound, "neither 1 nor 2")? == 2 {
        solver_mode |= constants::SOLVER_USE_2_FRICTION_DIRECTIONS;
    }
    Ok(ffi::WorldDefinition {
        length_scale: positive("length_scale", s.length_scale)?,
        time_step: 1.0 / positive("rate_hz", s.rate_hz)?,
        gravity: gravity.into(),
        iterations: i32::try_from(s.iterations.max(1)).unwrap_or(i32::MAX),
        solver_mode: i32::try_from(solver_mode).unwrap_or_default(),
        contact_threshold: from_mm(positive("contact_threshold_mm", s.contact_threshold_mm)?),
        broadphase_margin: scale::BROADPHASE_MARGIN.at(&scale),
        tolerances: tolerances(&scale),
        erp: s.erp,
        warm_start: s.warm_start,
        split_impulse: s.split_impulse,
        restitution_velocity_threshold: s.restitution_velocity_threshold_m_per_s,
        linear_damping: s.linear_damping,
        angular_damping: s.angular_damping,
        gyroscopic: s.gyroscopic,
        collision_margin: from_mm(zero_or_more(
            "stock.collision_margin_mm",
            s.stock.collision_margin_mm,
        )?),
        inertia: match s.stock.inertia {
            InertiaRule::Exact => ffi::InertiaRule::Exact,
            InertiaRule::BoundingBox => ffi::InertiaRule::BoundingBox,
            InertiaRule::BoundingBoxWithDefaultMargin => {
                ffi::InertiaRule::BoundingBoxWithDefaultMargin
            }
        },
        least_mass: from_g(zero_or_more("stock.least_mass_g", s.stock.least_mass_g)?),
        relative_contact_threshold: zero_or_more(
            "stock.relative_contact_threshold",
            s.stock.relative_contact_threshold,
        )?,
        sleeping: s.stock.sleeping,
        sleeping_speed: zero_or_more(
            "stock.sleeping_speed_m_per_s",
            s.stock.sleeping_speed_m_per_s,
        )?,
        sleeping_spin: zero_or_more(
            "stock.sleeping_spin_rad_per_s",
            s.stock.sleeping_spin_rad_per_s,
        )?,
        materials,
        own_collision: s.contact_solver == ContactSolver::Native,
        contact_stiffness: positive(
            "native.contact_stiffness_n_per_m",
            s.native.contact_stiffness_n_per_m,
        )?,
        contact_damping_ratio: s.native.contact_damping_ratio,
        max_depenetration_velocity: positive(
            "native.max_depenetration_velocity_m_per_s",
            s.native.max_depenetration_velocity_m_per_s,
        )?,
        substeps: i32::try_from(s.native.substeps(s.rate_hz)).unwrap_or(i32::MAX),
        native_iterations: i32::try_from(s.native.iterations.max(1)).unwrap_or(i32::MAX),
        solver_tolerance: zero_or_more("native.solver_tolerance", s.native.solver_tolerance)?,
        threads: i32::try_from(s.native.threads.unwrap_or(1).clamp(1, 1024)).unwrap_or(1),
        portable: s.native.portable,
        contacts_at_once: s.native.contacts_at_once,
    })
}

/// The lengths that belong to a scale.
pub(super) fn tolerances(scale: &Scale) -> ffi::Tolerances {
    ffi::Tolerances {
        contact_margin: scale::CONTACT_MARGIN.at(scale),
        closed_gap: scale::CLOSED_GAP.at(scale),
        unsolved_gap: scale::UNSOLVED_GAP.at(scale),
        hysteresis: scale::HYSTERESIS.at(scale),
        hold: scale::HOLD.at(scale),
        face_preference: scale::FACE_PREFERENCE.at(scale),
        match_distance: scale::MATCH_DISTANCE.at(scale),
        box_slack: scale::BOX_SLACK.at(scale),
    }
}
