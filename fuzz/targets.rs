//! What reads bytes from outside, one function a reader. Any bytes are to be
//! read or refused; a panic, an endless loop and a result that is not sound are
//! faults. `fuzz_targets/` feeds them by libFuzzer, `tests/it/fuzz.rs` without.

use std::{fs, path::Path};

use pluvia::export;
use pluvia::grains::load_scenario;
use pluvia::grains::{self, GrainSet, ParticleSizeDistribution};
use pluvia::record::{
    FramesRead, StageRecord, StageStore, StoredState, check_store, hash_bytes, series_from_csv,
    to_csv,
};
use pluvia::scenario::{GrainsSpec, MeshGrains, SieveFraction, SievedGrains};
use pluvia::specimen::SpecimenState;
use pluvia::study::{StudyOptions, SweepPlan, SweepStudy, converge, sensitivity};
use pluvia::viewer::{Responder, RunData, Site};

/// In memory where the system has such a place: a million files need no disk.
fn folder() -> tempfile::TempDir {
    let made = tempfile::tempdir_in("/dev/shm").or_else(|_| tempfile::tempdir());
    made.expect("a temporary folder")
}

thread_local! {
    static FOLDER: tempfile::TempDir = folder();
    static RESPONDER: Responder = responder();
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

/// A scenario file; one that loads is written and read again as the same. Whether it loads.
pub fn reads_scenario(data: &[u8]) -> bool {
    let mut read = false;
    with_file("scenario.json", data, |path| {
        let Ok(loaded) = load_scenario(path, &[]) else { return };
        read = true;
        if matches!(loaded.scenario.grains, GrainsSpec::Sieved(_)) {
            fs::write(path, serde_json::json!(loaded.scenario).to_string()).expect("written");
            let again = load_scenario(path, &[]).expect("law: what was loaded can be loaded again");
            assert_eq!(again.scenario, loaded.scenario, "law: nothing is lost by writing");
        }
    });
    read
}

/// As [`reads_scenario`].
pub fn scenario(data: &[u8]) {
    reads_scenario(data);
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

/// A mesh; its first byte says of which format. Whether grains are made of it.
pub fn reads_mesh(data: &[u8]) -> bool {
    let Some((format, content)) = data.split_first() else { return false };
    let mut read = false;
    let name = ["mesh.obj", "mesh.stl", "mesh.ply"][usize::from(format % 3)];
    with_file(name, content, |path| {
        let spec = serde_json::json!({
            "meshes": [path], "mesh_unit": "mm", "density_kg_per_m3": 2650, "hull": format & 4 != 0,
            "split_surfaces": format & 8 != 0, "largest_vertex_count": 16
        });
        let spec: MeshGrains = serde_json::from_value(spec).expect("a specification");
        if let Ok(set) = grains::from_meshes(&spec, 1) {
            assert_sound(&set);
            read = true;
        }
    });
    read
}

/// As [`reads_mesh`].
pub fn mesh(data: &[u8]) {
    reads_mesh(data);
}

/// What a run leaves and reads again: a specimen, grains or frames; whether it is one of these.
pub fn reads_specimen(data: &[u8]) -> bool {
    let mut read = false;
    if let Ok(state) = serde_json::from_slice::<SpecimenState>(data) {
        let text = serde_json::to_vec(&state).expect("law: a state that was read can be written");
        let again: SpecimenState = serde_json::from_slice(&text).expect("law: and read again");
        assert_eq!(again, state, "law: nothing is lost by writing");
        read = true;
    }
    if let Ok(set) = grains::read_json(data) {
        assert_sound(&set);
        read = true;
    }
    with_file("stages/key/frames.bin", data, |path| {
        let record = r#"{ "stage": "rest", "steps": 1, "simulated_s": 1, "wall_s": 1, "engine_s": 1,
            "warnings": [], "effective": {}, "specimen_sha256": "", "series_sha256": "" }"#;
        fs::write(path.with_file_name("stage.json"), record).expect("written");
        let root = path.ancestors().nth(2).expect("a folder");
        if let Ok(Some((frames, _))) = StageStore::frames_in(root, "key", FramesRead::All) {
            let of_one = frames.first().map_or(0, |f| f.grains.len());
            assert!(frames.iter().all(|f| f.grains.len() == of_one), "law: frames of one length");
            read |= !frames.is_empty();
        }
    });
    read
}

/// As [`reads_specimen`].
pub fn specimen(data: &[u8]) {
    reads_specimen(data);
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
    let spec = SievedGrains {
        total_mass_g,
        density_kg_per_m3,
        sieve_table,
        shape: pluvia::scenario::SievedShape::default(),
        cells,
    };
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

/// The folder of a stage that says its key, so that it is looked at further.
fn key_in(data: &[u8]) -> String {
    let json = serde_json::from_slice::<serde_json::Value>(data).unwrap_or_default();
    let key = json["identity"]["key"].as_str().unwrap_or_default();
    let letters: String = key.chars().filter(char::is_ascii_hexdigit).take(24).collect();
    if letters.is_empty() { "0".to_owned() } else { letters }
}

/// What a stage says of itself, or its series; whether it was read.
pub fn reads_stage(data: &[u8]) -> bool {
    let record = serde_json::from_slice::<StageRecord>(data);
    if let Ok(record) = &record {
        let text = serde_json::to_vec(record).expect("law: what was read can be written");
        let again: StageRecord = serde_json::from_slice(&text).expect("law: and read again");
        assert_eq!(&again, record, "law: nothing is lost by writing");
    }
    let series = series_from_csv(data);
    if let Ok(rows) = &series {
        let text = to_csv(rows).expect("law: rows that were read can be written");
        let again = series_from_csv(&text).expect("law: and read again");
        assert_eq!(to_csv(&again).expect("written"), text, "law: nothing is lost by writing");
    }
    with_file(&format!("store/{}/stage.json", key_in(data)), data, |path| {
        let root = path.ancestors().nth(2).expect("a folder");
        let report = check_store(root).expect("law: a store is looked over whatever is in it");
        assert_eq!(report.stages.len(), 1, "law: what is there is reported");
        fs::remove_dir_all(root).expect("removed");
    });
    record.is_ok() || series.is_ok_and(|rows| !rows.is_empty())
}

/// As [`reads_stage`].
pub fn stage(data: &[u8]) {
    reads_stage(data);
}

/// A checkpoint with these bytes in it and their hash; whether it is whole.
pub fn reads_checkpoint(data: &[u8]) -> bool {
    let steps = serde_json::from_slice::<serde_json::Value>(data).ok();
    let steps = steps.and_then(|json| json["midway"]["steps"].as_u64()).unwrap_or(0);
    let head = format!("pluvia checkpoint 2 {}\n", hash_bytes(data));
    let mut whole = false;
    let name = format!("segments/.segments-{}/{steps:020}.segment", key_in(data));
    with_file(&name, &[head.as_bytes(), data].concat(), |path| {
        let root = path.ancestors().nth(2).expect("a folder");
        let report = check_store(root).expect("law: a store is looked over whatever is in it");
        assert_eq!(report.checkpoints.len(), 1, "law: what is there is reported");
        whole = report.checkpoints[0].state == StoredState::Whole;
        fs::remove_dir_all(root).expect("removed");
    });
    whole
}

/// As [`reads_checkpoint`].
pub fn checkpoint(data: &[u8]) {
    reads_checkpoint(data);
}

/// A run's manifest, beside grains and a specimen; whether the run is read.
pub fn reads_manifest(data: &[u8]) -> bool {
    let mut read = false;
    with_file("run/manifest.json", data, |path| {
        let folder = path.parent().expect("a folder");
        beside(folder, "grains.json", include_bytes!("beside/grains.json"));
        beside(folder, "specimen.json", include_bytes!("beside/specimen.json"));
        if let Ok(run) = export::read_run(folder, None) {
            assert_sound(&run.specimen.grains);
            read = true;
        }
        let _ = export::read_run(folder, Some("1"));
        let _ = export::read_playback(folder, FramesRead::All, None);
    });
    read
}

/// As [`reads_manifest`].
pub fn manifest(data: &[u8]) {
    reads_manifest(data);
}

/// Writes a file unless it is there.
fn beside(folder: &Path, name: &str, content: &[u8]) {
    let path = folder.join(name);
    if !path.exists() {
        fs::write(path, content).expect("written");
    }
}

/// The design of a convergence or sensitivity study; whether it is one.
pub fn reads_design(data: &[u8]) -> bool {
    let mut read = false;
    with_file("study/design.json", data, |path| {
        let folder = path.parent().expect("a folder");
        beside(folder, "scenario.json", include_bytes!("beside/scenario.json"));
        for quick in [false, true] {
            let options =
                StudyOptions { design: Some(path.to_owned()), quick, configurations: None };
            read |= converge(&options).is_ok();
            read |= sensitivity(&options).is_ok();
        }
    });
    read
}

/// As [`reads_design`].
pub fn design(data: &[u8]) {
    reads_design(data);
}

/// More points than these take too long.
const MOST_POINTS: usize = 50;

/// The plan of a sweep, beside its scenario; whether it can be run.
pub fn reads_plan(data: &[u8]) -> bool {
    let mut read = false;
    with_file("sweep/plan.json", data, |path| {
        let folder = path.parent().expect("a folder");
        beside(folder, "scenario.json", include_bytes!("beside/scenario.json"));
        let Ok(plan) = SweepPlan::read(folder) else { return };
        let text = serde_json::to_vec(&plan).expect("law: a plan that was read can be written");
        let again: SweepPlan = serde_json::from_slice(&text).expect("law: and read again");
        assert_eq!(again, plan, "law: nothing is lost by writing");
        let few = plan.samples.is_none_or(|samples| samples <= MOST_POINTS);
        if let Ok(options) = plan.options(folder) {
            let each = options.over.iter().map(|factor| factor.values.len().max(1));
            if few && each.fold(1, usize::saturating_mul) <= MOST_POINTS {
                read = SweepStudy::new(options).is_ok();
            }
        }
    });
    read
}

/// As [`reads_plan`].
pub fn plan(data: &[u8]) {
    reads_plan(data);
}

fn responder() -> Responder {
    let bytes = b"PLUVIEW1".to_vec();
    let run =
        RunData { scenario: "s".to_owned(), grains: 0, stages: 0, frames: 0, kept: true, bytes };
    Responder::new(Site::new(run), 4321).expect("random numbers")
}

/// The head of a request to the viewer, in which `TOKEN` stands for the token; whether it is
/// served a file.
pub fn reads_request(data: &[u8]) -> bool {
    RESPONDER.with(|responder| {
        let mut request = data.to_vec();
        let asked = b"TOKEN";
        while let Some(at) = request.windows(asked.len()).position(|w| w == asked) {
            request.splice(at..at + asked.len(), responder.path().into_bytes());
        }
        let path = responder.path();
        let knows = request.windows(path.len()).any(|w| w == path.as_bytes());
        let Some(answer) = responder.answer(&request) else { return false };
        assert!(answer.starts_with(b"HTTP/1.1 "), "law: an answer is one of HTTP");
        let served = answer.starts_with(b"HTTP/1.1 200 ");
        assert!(!served || knows, "law: nobody is served who does not know the token");
        served
    })
}

/// As [`reads_request`].
pub fn request(data: &[u8]) {
    reads_request(data);
}
