//! Rapier's integration parameters: every one set from the scenario or to a
//! stated value, and read back.

use rapier3d_f64::prelude::{
    FrictionModel, IntegrationParameters, PhysicsWorld, SoftBodiesSettings, SpringCoefficients,
};
use serde_json::{Value, json};

use super::super::{EffectiveSettings, WorldError, positive, sound};
use super::convert::Units;
use crate::scale::{self, Scale};
use crate::scenario::{self, EngineSettings};
use crate::units::from_mm;

/// The share of its length unit by which rapier lets leaves grow
/// (`CHANGE_DETECTION_FACTOR` in `broad_phase_bvh/mod.rs`, 0.36).
const MARGIN_OF_LENGTH_UNIT: f64 = 0.04;

fn within(setting: &str, value: f64, most: f64) -> Result<f64, WorldError> {
    sound(setting, value, (0.0..=most).contains(&value), &format!("not between 0 and {most}"))
}

fn count(setting: &str, value: u32, least: u32) -> Result<usize, WorldError> {
    Ok(sound(setting, value, value >= least, &format!("less than {least}"))? as usize)
}

pub(super) fn units(s: &EngineSettings) -> Result<Units, WorldError> {
    let metres = from_mm(positive("rapier.engine_unit_mm", s.rapier.engine_unit_mm)?);
    Ok(Units { per_metre: 1.0 / metres })
}

/// Rapier's damping c in 1/s, with velocities falling like exp(-c t), for the
/// fraction lost in a second.
pub(super) fn damping(setting: &str, lost_per_second: f64) -> Result<f64, WorldError> {
    let is_sound = (0.0..1.0).contains(&lost_per_second);
    sound(setting, lost_per_second, is_sound, "not at least 0 and below 1")?;
    Ok(-(-lost_per_second).ln_1p())
}

/// Every field of rapier's parameters; none is left to its default.
pub(super) fn integration_parameters(
    s: &EngineSettings,
    units: Units,
) -> Result<IntegrationParameters, WorldError> {
    let r = &s.rapier;
    let dt = 1.0 / positive("rate_hz", s.rate_hz)?;
    let size = from_mm(positive("grain_size_mm", s.grain_size_mm)?);
    let scale = Scale::of_smallest(size, Scale::PAPER.gravity);
    let margin = scale::BROADPHASE_MARGIN.at(&scale);
    let length_unit = margin / MARGIN_OF_LENGTH_UNIT * units.per_metre;
    // Rapier multiplies what it calls normalised by its length unit.
    let normalised = |metres: f64| metres * units.per_metre / length_unit;
    let spring = |name: &str, frequency: f64, ratio: f64| {
        Ok(SpringCoefficients {
            natural_frequency: positive(&format!("rapier.{name}_frequency_hz"), frequency)?,
            damping_ratio: within(&format!("rapier.{name}_damping_ratio"), ratio, 1000.0)?,
        })
    };
    let prediction = from_mm(positive("rapier.prediction_mm", r.prediction_mm)?);
    let correction = positive("rapier.corrective_speed_m_per_s", r.corrective_speed_m_per_s)?;
    let recycling = from_mm(positive("rapier.recycling_distance_mm", r.recycling_distance_mm)?);
    Ok(IntegrationParameters {
        dt,
        contact_softness: spring("contact", r.contact_frequency_hz, r.contact_damping_ratio)?,
        static_contact_softness: spring(
            "wall_contact",
            r.wall_contact_frequency_hz,
            r.wall_contact_damping_ratio,
        )?,
        warmstart_coefficient: within("rapier.warm_start", r.warm_start, 1.0)?,
        length_unit,
        normalized_max_corrective_velocity: normalised(correction),
        normalized_prediction_distance: normalised(prediction),
        // A limit of speed would be a force that is not there; the checks
        // stop a run that is too fast.
        normalized_max_linear_velocity: f64::MAX,
        num_solver_iterations: count("rapier.substeps", r.substeps, 1)?,
        num_internal_pgs_iterations: count("rapier.iterations", r.iterations, 1)?,
        num_internal_stabilization_iterations: count(
            "rapier.relaxing_iterations",
            r.relaxing_iterations,
            0,
        )?,
        contact_recycling: r.contact_recycling,
        normalized_contact_recycle_distance: normalised(recycling),
        friction_in_bias_pass: r.friction_while_correcting,
        friction_model: match r.friction_model {
            scenario::FrictionModel::Coulomb => FrictionModel::Coulomb,
            scenario::FrictionModel::Simplified => FrictionModel::Simplified,
        },
        // Continuous collision detection is off: its step and its slop
        // (`allowed_linear_error`, which nothing else reads) do nothing.
        max_ccd_substeps: 0,
        min_ccd_dt: dt,
        normalized_allowed_linear_error: 0.0,
        // For bodies of several shapes, joints and soft bodies: there are none.
        contact_clustering: false,
        warmstart_joints: false,
        soft_bodies: SoftBodiesSettings::default(),
    })
}

/// What rapier holds, in SI.
pub(super) fn effective(
    world: &PhysicsWorld,
    units: Units,
    spanned_faces: bool,
) -> EffectiveSettings {
    let p = &world.integration_parameters;
    let gravity = units.metres(world.gravity);
    let metres = |length: f64| length / units.per_metre;
    let info = super::info();
    let mut settings: Vec<(&str, Value)> = vec![
        ("engine", info.name.into()),
        ("engine_version", info.version.into()),
        ("engine_precision", info.precision.into()),
        ("length_scale_units_per_m", json!(units.per_metre)),
        ("time_step_s", json!(p.dt)),
        ("gravity_x_m_per_s2", json!(gravity.x)),
        ("gravity_y_m_per_s2", json!(gravity.y)),
        ("gravity_z_m_per_s2", json!(gravity.z)),
        ("substeps", json!(p.num_solver_iterations)),
        ("iterations", json!(p.num_internal_pgs_iterations)),
        ("relaxing_iterations", json!(p.num_internal_stabilization_iterations)),
        ("contact_frequency_hz", json!(p.contact_softness.natural_frequency)),
        ("contact_damping_ratio", json!(p.contact_softness.damping_ratio)),
        ("wall_contact_frequency_hz", json!(p.static_contact_softness.natural_frequency)),
        ("wall_contact_damping_ratio", json!(p.static_contact_softness.damping_ratio)),
        ("warm_start", json!(p.warmstart_coefficient)),
        ("length_unit_m", json!(metres(p.length_unit))),
        ("broadphase_margin_m", json!(metres(p.length_unit * MARGIN_OF_LENGTH_UNIT))),
        ("allowed_linear_error_m", json!(metres(p.allowed_linear_error()))),
        ("corrective_speed_m_per_s", json!(metres(p.max_corrective_velocity()))),
        ("prediction_m", json!(metres(p.prediction_distance()))),
        ("speed_limit", json!(p.max_linear_velocity() != f64::MAX)),
        ("continuous_collision_substeps", json!(p.max_ccd_substeps)),
        ("continuous_collision_shortest_step_s", json!(p.min_ccd_dt)),
        ("spanned_faces", json!(spanned_faces)),
        ("contact_clustering", json!(p.contact_clustering)),
        ("contact_recycling", json!(p.contact_recycling)),
        ("recycling_distance_m", json!(metres(p.contact_recycle_distance()))),
        ("friction_while_correcting", json!(p.friction_in_bias_pass)),
        ("friction_model", format!("{:?}", p.friction_model).to_lowercase().into()),
        ("warm_start_of_joints", json!(p.warmstart_joints)),
    ];
    // Every free body is made alike; the first one speaks for all.
    if let Some((_, body)) = world.bodies.iter().find(|(_, body)| body.is_dynamic()) {
        settings.extend([
            ("linear_damping_per_s", json!(body.linear_damping())),
            ("angular_damping_per_s", json!(body.angular_damping())),
            ("gyroscopic", json!(body.gyroscopic_forces_enabled())),
            ("sleeping", json!(body.activation().normalized_linear_threshold >= 0.0)),
            ("fast_rotation", json!(body.is_fast_rotation_allowed())),
        ]);
    }
    settings.into_iter().map(|(name, value)| (name.to_owned(), value)).collect()
}
