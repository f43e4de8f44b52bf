//! Under which key the store holds a stage: everything that determines its result, and nothing
//! else.

use serde::Serialize;

use crate::record::StageIdentity;
use crate::scale::{GrainSizes, Scale};
use crate::scenario::{
    ApparatusSpec, Backend, ContactSolver, ContactSpec, EngineSettings, MeasuresSpec,
    NativeSettings, PieceSpec, RapierSettings, SettleSpec, StageSpec, StockSettings,
};
use crate::world::BackendInfo;

/// Raised whenever the meaning of a stored stage or of its key changes, so that none of an older
/// meaning is ever taken for a new one.
const FORMAT: u32 = 19;

/// Everything that determines a stage's result. The grains are named by the parent of the first
/// stage; names, notes and the later stages of the scenario do not act on it.
#[derive(Serialize)]
pub(super) struct StageKey<'a> {
    #[serde(flatten)]
    pub made_by: MadeBy,
    pub backend: &'a BackendInfo,
    pub apparatus: &'a ApparatusSpec,
    pub contact: &'a ContactSpec,
    pub engine: EngineKey<'a>,
    pub settle: &'a SettleSpec,
    pub gravity_m_per_s2: f64,
    pub scale: (Scale, GrainSizes),
    pub seed: u64,
    pub configuration: u32,
    #[serde(skip_serializing_if = "<[_]>::is_empty")]
    pub pieces: &'a [PieceSpec],
    #[serde(skip_serializing_if = "MeasuresSpec::is_empty")]
    pub measures: &'a MeasuresSpec,
    /// Key of the stage before or, for the first, the hash of the grains.
    pub parent: &'a str,
    pub stage: &'a StageSpec,
    /// Steps of a segment; left out where the stage is over within one, whose bits
    /// do not depend on it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub segment_steps: Option<u64>,
}

/// The program that made a stage.
#[derive(Serialize)]
pub(super) struct MadeBy {
    format: u32,
    version: &'static str,
}

impl MadeBy {
    /// This program.
    pub const THIS: Self = Self { format: FORMAT, version: env!("CARGO_PKG_VERSION") };
}

impl StageKey<'_> {
    /// Names the stage of so many grains, whose hash is given, after the stage of a key.
    pub fn identity(&self, grains: (usize, &str), after: Option<&str>) -> StageIdentity {
        StageIdentity::new(self.stage.name(), grains, after, self)
    }
}

/// What all engines read, each setting once. A new one is named here, or the program does not
/// build.
macro_rules! engine_key {
    ($($setting:ident: $kind:ty,)*) => {
        /// The settings of the engine that act on a stage: what all engines read, and what the
        /// one that carries the grains asks for alone. Those of others change no key.
        #[derive(Serialize)]
        pub(super) struct EngineKey<'a> {
            $($setting: $kind,)*
            #[serde(flatten)]
            own: OwnSettings<'a>,
        }

        impl<'a> EngineKey<'a> {
            /// Of all settings those that act.
            pub fn of(settings: &'a EngineSettings) -> Self {
                let &EngineSettings { $($setting,)* ref stock, ref native, ref rapier } = settings;
                let own = match (settings.backend, settings.contact_solver) {
                    (Backend::Rapier, _) => OwnSettings::Rapier(rapier),
                    (Backend::Bullet, ContactSolver::Native) => OwnSettings::Native(native),
                    (Backend::Bullet, ContactSolver::Stock) => OwnSettings::Stock(stock),
                };
                Self { $($setting,)* own }
            }
        }
    };
}

engine_key! {
    backend: Backend,
    contact_solver: ContactSolver,
    grain_size_mm: f64,
    rate_hz: f64,
    iterations: u32,
    length_scale: f64,
    friction_directions: u32,
    contact_threshold_mm: f64,
    erp: f64,
    warm_start: f64,
    split_impulse: bool,
    restitution_velocity_threshold_m_per_s: f64,
    linear_damping: f64,
    angular_damping: f64,
    gyroscopic: bool,
    allow_coarse_steps: bool,
}

/// What one engine or solver asks for alone.
#[derive(Serialize)]
#[serde(rename_all = "snake_case")]
enum OwnSettings<'a> {
    Native(&'a NativeSettings),
    Stock(&'a StockSettings),
    Rapier(&'a RapierSettings),
}

#[cfg(test)]
mod tests {
    use super::*;

    fn key(settings: &EngineSettings) -> String {
        serde_json::to_string(&EngineKey::of(settings)).expect("a key has JSON")
    }

    /// Law: settings that act on a stage change its key, those of another engine do not.
    #[test]
    fn settings_change_a_key_where_they_are_read() {
        let of = |backend, contact_solver| EngineSettings {
            backend,
            contact_solver,
            ..EngineSettings::default()
        };
        let rapier = of(Backend::Rapier, ContactSolver::Native);
        let native = of(Backend::Bullet, ContactSolver::Native);
        let stock = of(Backend::Bullet, ContactSolver::Stock);
        let of_rapier = |of: &EngineSettings| EngineSettings {
            rapier: RapierSettings { substeps: 17, ..of.rapier },
            ..of.clone()
        };
        assert_ne!(key(&of_rapier(&rapier)), key(&rapier), "law: rapier reads its own");
        for others in [&native, &stock] {
            assert_eq!(key(&of_rapier(others)), key(others), "law: Bullet reads none of rapier's");
        }
        let faster = |of: &EngineSettings| EngineSettings { rate_hz: 481.0, ..of.clone() };
        for any in [&rapier, &native, &stock] {
            assert_ne!(key(&faster(any)), key(any), "law: all read the rate");
        }
        assert!(key(&native).contains("\"native\":{") && !key(&native).contains("\"stock\":{"));
        assert!(key(&stock).contains("\"stock\":{") && !key(&stock).contains("\"native\":{"));
    }
}
