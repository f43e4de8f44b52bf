//! Under which key the store holds a stage: everything that determines its result, and nothing
//! else.

use super::engine_key::EngineKey;
use super::*;
use crate::scale::GrainSizes;
use crate::scenario::{ApparatusSpec, ContactSpec, MeasuresSpec, PieceSpec, SettleSpec};
use crate::world::BackendInfo;

/// Raised whenever the meaning of a stored stage or of its key changes, so that none of an older
/// meaning is ever taken for a new one.
pub const FORMAT: u32 = 21;

/// Everything that determines a stage's result. The grains are named by the parent of the first
/// stage; names, notes and the later stages of the scenario do not act on it. Apparatus, contact,
/// settling, pieces, measures and stage stand in it as a scenario is written, backend
/// ([`BackendInfo`]) and scale ([`Scale`], [`GrainSizes`]) as their types are: who renames or moves
/// one of their fields raises [`FORMAT`].
#[derive(Serialize)]
struct StageKey<'a> {
    format: u32,
    /// Of this program.
    version: &'static str,
    backend: BackendInfo,
    apparatus: &'a ApparatusSpec,
    contact: &'a ContactSpec,
    engine: EngineKey,
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
        engine: EngineKey::of(&setup.engine),
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Law: stages that are stored are found: the bytes of these parts of a key stay.
    #[test]
    fn backend_and_scale_stand_in_a_key_as_they_were_stored() {
        let [name, version, precision] = ["a", "b", "c"].map(str::to_owned);
        let backend = BackendInfo { name, version, precision };
        let got = serde_json::to_string(&backend).expect("it has JSON");
        let expected = "{\"name\":\"a\",\"version\":\"b\",\"precision\":\"c\"}";
        assert_eq!(got, expected, "law: left what it is, right what was stored");
        let sizes = GrainSizes { smallest: 1.0, median: 2.0, largest: 3.0 };
        let scale = Scale { sizes, density: 4.0, gravity: 5.0 };
        let got = serde_json::to_string(&(scale, sizes)).expect("it has JSON");
        let of_sizes = "{\"smallest\":1.0,\"median\":2.0,\"largest\":3.0}";
        let expected =
            format!("[{{\"sizes\":{of_sizes},\"density\":4.0,\"gravity\":5.0}},{of_sizes}]");
        assert_eq!(got, expected, "law: left what it is, right what was stored");
    }
}
