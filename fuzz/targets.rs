//! What reads bytes from outside, one function a reader. Any bytes are to be
//! read or refused; a panic, an endless loop and a result that is not sound are
//! faults. `fuzz_targets/` feeds them by libFuzzer, `tests/it/fuzz.rs` without.

use std::{fs, path::Path};

use pluvia::grains::load_scenario;
use pluvia::grains::{self, GrainSet, ParticleSizeDistribution};
use pluvia::record::StageStore;
use pluvia::scenario::{GrainsSpec, MeshGrains, SieveFraction, SievedGrains};
use pluvia::specimen::SpecimenState;

thread_local! {
    static FOLDER: tempfile::TempDir = tempfile::tempdir().expect("a temporary folder");
}

/// Hands a file of that content to `read`.
fn with_file(name: &str, data: &[u8], read: impl FnOnce(&Path)) {
    FOLDER.with(|folder| {
        let path = folder.path().join(name);
        if let Some(parent) = path.parent() {
            fs::create_dir_all(parent).expect("a folder");
        }
        fs::write(&path, data).expect("written");
        read(&path);
    });
}

/// A scenario file; one that loads is written and read again as the same.
pub fn scenario(data: &[u8]) {
    with_file("scenario.json", data, |path| {
        let Ok(loaded) = load_scenario(path, &[]) else { return };
        if matches!(loaded.scenario.grains, GrainsSpec::Sieved(_)) {
            fs::write(path, loaded.scenario.canonical_json()).expect("written");
            let again = load_scenario(path, &[]).expect("law: what was loaded can be loaded again");
            assert_eq!(again.scenario, loaded.scenario, "law: nothing is lost by writing");
        }
    });
}

/// Grains that can be simulated.
fn assert_sound(set: &GrainSet) {
    for grain in &set.grains {
        assert!(grain.mass > 0.0 && grain.mass.is_finite(), "law: a mass, got {}", grain.mass);
        let inertia = grain.inertia;
        assert!(inertia.iter().all(|i| *i > 0.0 && i.is_finite()), "law: inertia, got {inertia:?}");
        assert!(grain.shape.vertices().len() >= 4, "law: a solid");
    }
}

/// A mesh; its first byte says of which format.
pub fn mesh(data: &[u8]) {
    let Some((format, content)) = data.split_first() else { return };
    let name = ["mesh.obj", "mesh.stl", "mesh.ply"][usize::from(format % 3)];
    with_file(name, content, |path| {
        let spec = serde_json::json!({
            "meshes": [path], "mesh_unit": "mm", "density_kg_per_m3": 2650, "hull": format & 4 != 0,
            "split_surfaces": format & 8 != 0, "largest_vertex_count": 16
        });
        let spec: MeshGrains = serde_json::from_value(spec).expect("a specification");
        if let Ok(set) = grains::from_meshes(&spec, 1) {
            assert_sound(&set);
        }
    });
}

/// What a run leaves and reads again: a specimen, grains or frames.
pub fn specimen(data: &[u8]) {
    if let Ok(state) = serde_json::from_slice::<SpecimenState>(data) {
        let text = serde_json::to_vec(&state).expect("law: a state that was read can be written");
        let again: SpecimenState = serde_json::from_slice(&text).expect("law: and read again");
        assert_eq!(again, state, "law: nothing is lost by writing");
    }
    if let Ok(set) = grains::read_json(data) {
        assert_sound(&set);
    }
    with_file("stages/key/frames.bin", data, |path| {
        let record = r#"{ "stage": "rest", "steps": 1, "simulated_s": 1, "wall_s": 1, "engine_s": 1,
            "warnings": [], "effective": {}, "specimen_sha256": "", "series_sha256": "" }"#;
        fs::write(path.with_file_name("stage.json"), record).expect("written");
        let root = path.ancestors().nth(2).expect("a folder");
        if let Ok(Some((frames, _))) = StageStore::frames_in(root, "key") {
            let of_one = frames.first().map_or(0, |f| f.grains.len());
            assert!(frames.iter().all(|f| f.grains.len() == of_one), "law: frames of one length");
        }
    });
}

/// More grains than these take too long.
const MOST_GRAINS: usize = 120;

/// A sieve analysis made of bytes, from which grains are cut.
pub fn grains(data: &[u8]) {
    let mut numbers = data.chunks_exact(4).map(|b| {
        let bits = u32::from_le_bytes([b[0], b[1], b[2], b[3]]);
        // Most are about one; every 16th is as its bits say.
        if bits % 16 == 0 { f64::from(f32::from_bits(bits)) } else { f64::from(bits) / 2e9 }
    });
    let mut next = || numbers.next().unwrap_or(0.5);
    let seed = (next() * 1e6) as u64;
    let (total_mass_g, density_kg_per_m3) = (next() * 20.0, next() * 3000.0);
    let mut passing_mm = 4.0 + next() * 20.0;
    let mut sieve_table = Vec::new();
    let fractions = 1 + data.first().map_or(0, |b| usize::from(b % 3));
    for _ in 0..fractions {
        let retained_mm = passing_mm * (1.0 - next() / 2.5);
        let mass_percent = 100.0 / fractions as f64;
        sieve_table.push(SieveFraction { passing_mm, retained_mm, mass_percent });
        passing_mm = retained_mm;
    }
    let cells = pluvia::scenario::CellShape::default();
    let spec = SievedGrains { total_mass_g, density_kg_per_m3, sieve_table, cells };
    let Ok(psd) = ParticleSizeDistribution::new(&spec) else { return };
    let count = psd.fractions.iter().map(|f| f.grains).fold(0, usize::saturating_add);
    if count > MOST_GRAINS {
        return;
    }
    if let Ok(set) = grains::generate(&spec, seed) {
        assert_sound(&set);
        assert_eq!(set.grains.len(), count, "law: as many grains as were counted");
    }
}
