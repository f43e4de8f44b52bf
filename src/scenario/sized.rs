//! Settings that go with the size of the grains, each by a law.

use super::*;

/// A number of the engine's settings, by its place in them.
type Setting = fn(&mut EngineSettings) -> &mut f64;

/// Settings of the engine that go with the size of the grains, each by a law. Of the rates of
/// steps and sub-steps, the stiffness and the speed at which overlaps are pushed apart, the scenario
/// may ask for more.
const OF_ENGINE: [(&str, Law, Setting); 14] = [
    ("engine.grain_size_mm", Law::Fine, |e| &mut e.grain_size_mm),
    (RATE, Law::Rate, |e| &mut e.rate_hz),
    ("engine.length_scale", Law::PerLength, |e| &mut e.length_scale),
    ("engine.contact_threshold_mm", Law::Fine, |e| &mut e.contact_threshold_mm),
    ("engine.restitution_velocity_threshold_m_per_s", Law::Speed, |e| {
        &mut e.restitution_velocity_threshold_m_per_s
    }),
    (SUBSTEPS, Law::Rate, |e| &mut e.native.substep_rate_hz),
    (STIFFNESS, Law::Stiffness, |e| &mut e.native.contact_stiffness_n_per_m),
    (DEPENETRATION, Law::Speed, |e| &mut e.native.max_depenetration_velocity_m_per_s),
    ("engine.rapier.contact_frequency_hz", Law::Rate, |e| &mut e.rapier.contact_frequency_hz),
    ("engine.rapier.wall_contact_frequency_hz", Law::Rate, |e| {
        &mut e.rapier.wall_contact_frequency_hz
    }),
    ("engine.rapier.engine_unit_mm", Law::Fine, |e| &mut e.rapier.engine_unit_mm),
    ("engine.rapier.prediction_mm", Law::Fine, |e| &mut e.rapier.prediction_mm),
    ("engine.rapier.corrective_speed_m_per_s", Law::Speed, |e| {
        &mut e.rapier.corrective_speed_m_per_s
    }),
    ("engine.rapier.recycling_distance_mm", Law::Fine, |e| &mut e.rapier.recycling_distance_mm),
];

/// Fields that go with the size of the grains by a law, with their defaults.
pub(super) fn fields() -> impl Iterator<Item = (&'static str, Law, f64)> {
    let settle = SettleSpec::default();
    let of_engine = OF_ENGINE
        .into_iter()
        .map(|(path, law, setting)| (path, law, *setting(&mut EngineSettings::default())));
    of_engine.chain([
        ("settle.rms_speed_mm_per_s", Law::Speed, settle.rms_speed_mm_per_s),
        ("settle.largest_speed_mm_per_s", Law::Speed, settle.largest_speed_mm_per_s),
        ("settle.hold_s", Law::Time, settle.hold_s),
    ])
}

impl EngineSettings {
    /// The settings for the same bodies so many times as large, under the same gravity.
    pub fn enlarged(&self, larger: f64) -> Self {
        let paper = Scale::PAPER;
        let scale = Scale::of_smallest(paper.sizes.smallest * larger, paper.gravity);
        let mut enlarged = self.clone();
        for (_, law, setting) in OF_ENGINE {
            *setting(&mut enlarged) *= law.factor(&scale);
        }
        enlarged
    }
}
