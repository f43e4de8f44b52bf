//! Under which key the store holds a stage: everything that determines its result, and nothing
//! else.

use serde::{Serializer, ser::Error};

use super::*;
use crate::scale::GrainSizes;
use crate::scenario::{ApparatusSpec, ContactSpec, MeasuresSpec, PieceSpec, SettleSpec};
use crate::world::BackendInfo;

/// Raised whenever the meaning of a stored stage or of its key changes, so that none of an older
/// meaning is ever taken for a new one.
pub const FORMAT: u32 = 19;

/// Everything that determines a stage's result. The grains are named by the parent of the first
/// stage; names, notes and the later stages of the scenario do not act on it.
#[derive(Serialize)]
struct StageKey<'a> {
    format: u32,
    /// Of this program.
    version: &'static str,
    backend: BackendInfo,
    apparatus: &'a ApparatusSpec,
    contact: &'a ContactSpec,
    engine: EngineKey<'a>,
    settle: &'a SettleSpec,
    gravity_m_per_s2: f64,
    scale: (Scale, GrainSizes),
    seed: u64,
    configuration: u32,
    #[serde(skip_serializing_if = "<[_]>::is_empty")]
    pieces: &'a [PieceSpec],
    #[serde(skip_serializing_if = "MeasuresSpec::is_empty")]
    measures: &'a MeasuresSpec,
    /// Key of the stage before or, for the first, the hash of the grains.
    parent: &'a str,
    stage: &'a StageSpec,
    /// Steps of a segment; left out where the stage is over within one, whose bits
    /// do not depend on it.
    #[serde(skip_serializing_if = "Option::is_none")]
    segment_steps: Option<u64>,
}

/// Names a stage of a scenario in a laboratory, whose engine may be another than the scenario's;
/// of grains with their hash, after the stage of a key.
pub(super) fn identity(
    scenario: &Scenario,
    setup: &Setup,
    (grains, grains_sha256): (&GrainSet, &str),
    after: Option<&str>,
    stage: &StageSpec,
    segment_steps: Option<u64>,
) -> StageIdentity {
    let key = StageKey {
        format: FORMAT,
        version: env!("CARGO_PKG_VERSION"),
        backend: crate::world::info(setup.engine.backend),
        apparatus: &scenario.apparatus,
        contact: &scenario.contact,
        engine: EngineKey(&setup.engine),
        settle: &scenario.settle,
        gravity_m_per_s2: scenario.gravity_m_per_s2,
        scale: (setup.scale, grains.sizes()),
        seed: scenario.seed,
        configuration: scenario.configuration,
        pieces: &scenario.pieces,
        measures: &scenario.measures,
        parent: after.unwrap_or(grains_sha256),
        stage,
        segment_steps,
    };
    StageIdentity::new(stage.name(), (grains.grains.len(), grains_sha256), after, &key)
}

/// Name of a set of grains: the hash of every vertex.
pub(super) fn grains_hash(grains: &GrainSet) -> String {
    let cells: Vec<_> =
        grains.grains.iter().map(|g| (&g.shape, &g.pose_in_block, g.mass, g.inertia)).collect();
    hash_json(&cells)
}

/// The settings of the engine that act on a stage: what all engines read, and what the one that
/// carries the grains asks for alone, in the order in which they are declared: who changes it
/// changes every key. Those of others change no key.
struct EngineKey<'a>(&'a EngineSettings);

impl Serialize for EngineKey<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        // The derived function, which writes defaults as well.
        let all = EngineSettings::serialize(self.0, serde_json::value::Serializer);
        let mut acting = all.map_err(S::Error::custom)?;
        if let Some(fields) = acting.as_object_mut() {
            for group in ["stock", "native", "rapier"] {
                if group != self.0.solver_name() {
                    fields.shift_remove(group);
                }
            }
        }
        acting.serialize(serializer)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenario::{Backend, ContactSolver, NativeSettings, RapierSettings};

    fn key(settings: &EngineSettings) -> String {
        serde_json::to_string(&EngineKey(settings)).expect("a key has JSON")
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
        let threads = NativeSettings { threads: Some(3), portable: true, ..native.native.clone() };
        let threads = EngineSettings { native: threads, ..native.clone() };
        assert_eq!(key(&threads), key(&native), "law: threads change no result, and no key");
        assert!(key(&native).contains("\"native\":{") && !key(&native).contains("\"stock\":{"));
        assert!(key(&stock).contains("\"stock\":{") && !key(&stock).contains("\"native\":{"));
    }
}
