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
    /// Where it is not that of the paper: rows of the series are part of the result.
    #[serde(skip_serializing_if = "Option::is_none")]
    sample_interval_s: Option<f64>,
    /// The sieves of the grains, where the stage chooses grains by them: of grains from a file they
    /// do not follow from shapes, and a sieve of a table may be another without another grain.
    #[serde(skip_serializing_if = "Option::is_none")]
    sieves_sha256: Option<String>,
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
    let by_sieve = matches!(stage, StageSpec::Deposit(deposit) if deposit.sizes_mm.is_some());
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
        sample_interval_s: setup.sample_interval,
        sieves_sha256: by_sieve.then(|| sieves_hash(grains)),
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

/// Name of the sieves of a set of grains: the hash of the openings of every block, and of the block
/// of every grain.
fn sieves_hash(grains: &GrainSet) -> String {
    let openings: Vec<_> = grains.blocks.iter().map(|b| (b.passing, b.retained)).collect();
    let blocks: Vec<_> = grains.grains.iter().map(|g| g.fraction).collect();
    hash_json(&(openings, blocks))
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

    /// The identity of a first stage that deposits grains, all or those between two openings.
    fn deposited(grains: &GrainSet, sizes_mm: Option<[f64; 2]>) -> StageIdentity {
        let mut deposit = json!({ "stage": "deposit", "at_mm": [0, 0, 50], "area_mm": [50, 50],
            "rate_g_per_s": 20, "time_limit_s": 5 });
        if let Some(sizes) = sizes_mm {
            deposit["sizes_mm"] = json!(sizes);
        }
        let scenario: Scenario = serde_json::from_value(json!({
            "name": "s", "grains": { "file": "grains.json" }, "stages": [deposit],
            "pieces": [{ "name": "box", "shape": { "box": { "inner_mm": [60, 60, 60] } } }]
        }))
        .expect("a scenario");
        let setup = Setup::new(&scenario).expect("a laboratory");
        let hash = grains_hash(grains);
        identity(&scenario, &setup, (grains, hash.as_str()), None, &scenario.stages[0], None)
    }

    /// Law: who takes grains by their sieves is another stage where a sieve is another, also where no
    /// grain and no size that follows from the grains is; to other stages it makes no difference.
    #[test]
    fn a_deposit_by_sieves_is_another_one_with_other_sieves() {
        let sieved = json!({
            "total_mass_g": 100, "density_kg_per_m3": 2673.9,
            "sieve_table": [
                { "passing_mm": 12.5, "retained_mm": 10, "mass_percent": 10 },
                { "passing_mm": 10, "retained_mm": 8, "mass_percent": 10 },
                { "passing_mm": 8, "retained_mm": 6.3, "mass_percent": 80 }
            ]
        });
        let sieved = serde_json::from_value(sieved).expect("a sieve table");
        let set = grains::generate(&sieved, 1).expect("grains");
        let mut other = set.clone();
        other.blocks[0].retained = 0.0101;
        other.blocks[1].passing = 0.0101;
        assert_eq!(grains_hash(&other), grains_hash(&set), "law: the same grains");
        assert_eq!(other.sizes(), set.sizes(), "law: of the same sizes");
        let layer = Some([8.0, 10.0]);
        let [one, two] = [&set, &other].map(|set| deposited(set, layer).key);
        assert_ne!(one, two, "law: another layer, expected two keys, got one");
        let mut moved = set.clone();
        moved.grains[0].fraction = 1;
        let got = deposited(&moved, layer).key;
        assert_ne!(got, one, "law: a grain of another block, expected another key, got the same");
        let [one, two] = [&set, &other].map(|set| deposited(set, None));
        assert_eq!(one, two, "law: left and right the deposit of all grains");
        let field = one.determined_by.get("sieves_sha256");
        assert_eq!(field, None, "law: keys without a choice by sieves stay as they were");
    }
}
