//! Engine settings for bodies of another size.

use super::{EngineSettings, NativeSettings, RapierSettings};
use crate::scale::{Law, Scale};

impl EngineSettings {
    /// The settings for the same bodies so many times as large, under the same gravity.
    pub fn enlarged(&self, larger: f64) -> Self {
        let paper = Scale::PAPER;
        let scale = Scale::of_smallest(paper.sizes.smallest * larger, paper.gravity);
        let by = |law: Law| law.factor(&scale);
        let (length, speed, rate) = (by(Law::Fine), by(Law::Speed), by(Law::Rate));
        let (native, rapier) = (&self.native, &self.rapier);
        Self {
            grain_size_mm: self.grain_size_mm * length,
            rate_hz: self.rate_hz * rate,
            length_scale: self.length_scale * by(Law::PerLength),
            contact_threshold_mm: self.contact_threshold_mm * length,
            restitution_velocity_threshold_m_per_s: self.restitution_velocity_threshold_m_per_s
                * speed,
            native: NativeSettings {
                substep_rate_hz: native.substep_rate_hz * rate,
                contact_stiffness_n_per_m: native.contact_stiffness_n_per_m * by(Law::Stiffness),
                max_depenetration_velocity_m_per_s: native.max_depenetration_velocity_m_per_s
                    * speed,
                ..native.clone()
            },
            rapier: RapierSettings {
                contact_frequency_hz: rapier.contact_frequency_hz * rate,
                wall_contact_frequency_hz: rapier.wall_contact_frequency_hz * rate,
                engine_unit_mm: rapier.engine_unit_mm * length,
                prediction_mm: rapier.prediction_mm * length,
                corrective_speed_m_per_s: rapier.corrective_speed_m_per_s * speed,
                recycling_distance_mm: rapier.recycling_distance_mm * length,
                ..rapier.clone()
            },
            ..self.clone()
        }
    }
}
