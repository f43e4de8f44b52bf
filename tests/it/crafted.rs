//! Runs whose files were made up, hashes and all: whatever reads them says what cannot be, and does
//! not fail itself.

use std::{
    fs,
    path::{Path, PathBuf},
    process::Output,
};

use pluvia::record::{hash_bytes, hash_json};
use serde_json::{Value, json};

use super::{
    export::small_run,
    interruption::copy,
    program::{json as read, pluvia, said, write},
};

/// Seals a record that holds a hash of itself, in a field of this name.
pub fn seal(record: &mut Value, name: &str) {
    let fields = record.as_object_mut().expect("fields");
    fields.shift_remove(name);
    let own = hash_json(&fields);
    fields.insert(name.to_owned(), json!(own));
}

/// A copy of a run of which something is made up before all hashes are made to fit: the state at
/// the end of its last stage, the stage's frames, or its manifest.
struct Craft {
    run: PathBuf,
    stage: PathBuf,
}

impl Craft {
    fn new(run: PathBuf) -> Self {
        copy(small_run(), &run);
        let manifest = read(&run.join("manifest.json"));
        let stages = manifest["stages"].as_array().expect("stages");
        let key = stages.last().expect("a stage")["key"].as_str().expect("a key");
        let stage = run.join("stages").join(&key[..24]);
        Self { run, stage }
    }

    fn state(&self, change: impl FnOnce(&mut Value)) {
        let mut state = read(&self.run.join("specimen.json"));
        change(&mut state);
        for folder in [&self.run, &self.stage] {
            write(folder, "specimen.json", &state);
        }
    }

    fn frames(&self, change: impl FnOnce(&mut Vec<u8>)) {
        let path = self.stage.join("frames.bin");
        let mut bytes = fs::read(&path).expect("frames");
        change(&mut bytes);
        fs::write(&path, bytes).expect("written");
    }

    fn manifest(&self, change: impl FnOnce(&mut Value)) {
        let mut manifest = read(&self.run.join("manifest.json"));
        change(&mut manifest);
        write(&self.run, "manifest.json", &manifest);
    }

    /// Makes every hash fit what the files hold.
    fn seal(&self) {
        let hash = |path: PathBuf| hash_bytes(&fs::read(path).expect("a file"));
        let [specimen, frames] =
            ["specimen.json", "frames.bin"].map(|name| hash(self.stage.join(name)));
        let of_run = hash(self.run.join("specimen.json"));
        let mut record = read(&self.stage.join("stage.json"));
        record["specimen_sha256"] = json!(specimen);
        record["frames_sha256"] = json!(frames);
        seal(&mut record, "record_sha256");
        write(&self.stage, "stage.json", &record);
        self.manifest(|manifest| {
            manifest["files_sha256"]["specimen.json"] = json!(of_run);
            if let Some(stage) = manifest["stages"].as_array_mut().and_then(|all| all.last_mut()) {
                stage["specimen_sha256"] = json!(specimen);
            }
        });
    }

    /// What everything that reads a run makes of it.
    fn read_by_all(&self, to: &Path) -> Vec<(&'static str, Output)> {
        let commands: [(&str, &str, &[&str]); 8] = [
            ("view", "--save", &["run.html"]),
            ("picture", "--out", &["run.png", "--width", "96"]),
            ("picture", "--animate", &["moving.png", "--width", "96"]),
            ("export", "--out", &["vtk", "--format", "vtk"]),
            ("export", "--out", &["glb", "--format", "glb", "--animate"]),
            ("export", "--out", &["obj", "--format", "obj"]),
            ("export", "--out", &["json", "--format", "json"]),
            ("export", "--out", &["csv", "--format", "csv"]),
        ];
        let outputs = commands.map(|(command, option, more)| {
            let to = to.join(more[0]);
            let mut program = pluvia();
            program.arg(command).arg(&self.run).arg(option).arg(&to).args(&more[1..]);
            let output = program.output().expect("it starts");
            let _ = fs::remove_file(&to);
            let _ = fs::remove_dir_all(&to);
            (more[0], output)
        });
        outputs.into()
    }
}

/// Asserts that nothing fails by itself, and that what is said to refuse does, with the words.
fn assert_refused(craft: &Craft, to: &Path, words: &[&str], by: &dyn Fn(&str) -> bool) {
    craft.seal();
    for (name, output) in craft.read_by_all(to) {
        let said = said(&output);
        let what = format!("{name} of a run crafted with {words:?}");
        for fault in ["panicked", "a fault of the program"] {
            assert!(!said.contains(fault), "law: {what}: an error, no panic, got {said}");
        }
        let expected = if by(name) { 2 } else { 0 };
        assert_eq!(output.status.code(), Some(expected), "law: {what}: the exit code, got {said}");
        let is_said = words.iter().all(|word| said.contains(word));
        assert!(expected == 0 || is_said, "law: {what}: it is said, got {said}");
    }
}

#[test]
#[ignore = "slow: make test-all"]
fn states_that_cannot_be_are_refused_by_all_that_read_them() {
    let folder = tempfile::tempdir().expect("a folder");
    type Change = fn(&mut Value);
    let changes: [(&str, Change); 16] = [
        ("bodies", |s| s["bodies"] = json!([])),
        ("bodies", |s| {
            let bodies = s["bodies"].as_array_mut().expect("a list");
            bodies.extend(bodies.clone());
        }),
        ("a contact is of grain", |s| touch(s, json!(1_000_000))),
        ("a contact is of grain", |s| touch(s, json!(u64::MAX))),
        ("a piece of the base", |s| {
            stand(s, 0.1, 0);
            touch(s, json!({ "base": 2 }));
        }),
        ("fixed_grains[0].grain", |s| stand(s, 0.1, 1_000_000)),
        ("base.radius", |s| stand(s, -1.0, 0)),
        ("base.radius", |s| stand(s, 1e300, 0)),
        ("quaternion", |s| s["bodies"][0]["pose"]["rotation"] = json!([0.0, 0.0, 0.0, 0.0])),
        ("a body is at", |s| s["bodies"][0]["pose"]["translation"][0] = json!(1e300)),
        ("1e300", |s| s["bodies"][0]["linear_velocity"][2] = json!(1e300)),
        ("1e300", |s| s["table_x"] = json!(1e300)),
        ("1e300", |s| s["time"] = json!(-1e300)),
        ("1e300", |s| s["funnel"] = json!({ "opening_height": 1e300, "lid": true })),
        ("specimen.json", |s| s["bodies"][0]["pose"] = json!(null)),
        ("specimen.json", |s| s["contacts"] = json!({})),
    ];
    for (n, (words, change)) in changes.into_iter().enumerate() {
        let craft = Craft::new(folder.path().join(n.to_string()));
        craft.state(change);
        assert_refused(&craft, folder.path(), &["specimen.json", words], &|_| true);
    }
}

/// Adds a contact of the first grain.
fn touch(state: &mut Value, party: Value) {
    let zero = json!([0.0, 0.0, 0.0]);
    let contact = json!({
        "between": [0, party], "point_m": zero, "normal": zero, "force_n": zero, "feature": [0, 0]
    });
    state["contacts"].as_array_mut().expect("contacts").push(contact);
}

/// Puts the base of a pile below.
fn stand(state: &mut Value, radius: f64, grain: usize) {
    let pose = state["bodies"][0]["pose"].clone();
    let fixed = json!([{ "grain": grain, "pose": pose }]);
    state["base"] = json!({ "radius": radius, "friction": null, "fixed_grains": fixed });
}

/// Law: numbers of pieces, which are names alone, may be any.
#[test]
fn pieces_of_walls_of_any_number_are_only_names() {
    let folder = tempfile::tempdir().expect("a folder");
    for (n, piece) in ["cylinder", "funnel"].into_iter().enumerate() {
        let craft = Craft::new(folder.path().join(n.to_string()));
        craft.state(|state| touch(state, json!({ piece: u64::MAX })));
        assert_refused(&craft, folder.path(), &[], &|_| false);
    }
}

#[test]
fn frames_that_cannot_be_are_refused_by_all_that_read_them() {
    let folder = tempfile::tempdir().expect("a folder");
    type Change = fn(&mut Vec<u8>);
    let changes: [(&str, Change); 6] = [
        ("cut off", |bytes| bytes[8..12].copy_from_slice(&u32::MAX.to_le_bytes())),
        ("grains", |bytes| {
            // Three frames of no grains.
            bytes[8..12].copy_from_slice(&0_u32.to_le_bytes());
            bytes.truncate(12);
            bytes.extend([0; 3 * 40]);
        }),
        ("cut off", |bytes| bytes.truncate(bytes.len() - 7)),
        ("does not begin as frames do", |bytes| bytes.truncate(5)),
        ("a place or time in a frame", |bytes| {
            bytes[12..20].copy_from_slice(&f64::INFINITY.to_le_bytes());
        }),
        ("a place or time in a frame", |bytes| {
            bytes[52..56].copy_from_slice(&1e30_f32.to_le_bytes());
        }),
    ];
    for (n, (words, change)) in changes.into_iter().enumerate() {
        let craft = Craft::new(folder.path().join(n.to_string()));
        craft.frames(change);
        // The end of a stage alone has no frames.
        let reads_frames = |name: &str| !["obj", "json", "csv"].contains(&name);
        assert_refused(&craft, folder.path(), &["frames.bin", words], &reads_frames);
    }
}

#[test]
fn manifests_that_cannot_be_are_refused_by_all_that_read_them() {
    let folder = tempfile::tempdir().expect("a folder");
    type Change = fn(&mut Value);
    let changes: [(&str, Change); 6] = [
        ("inner_diameter_mm", |m| {
            m["scenario"]["apparatus"]["cylinder"]["inner_diameter_mm"] = json!(1e308);
        }),
        ("wall_pieces", |m| {
            m["scenario"]["apparatus"]["cylinder"]["wall_pieces"] = json!(u32::MAX);
        }),
        ("name", |m| m["scenario"]["name"] = json!("\u{1b}[31ma\u{202e}b")),
        ("stages", |m| m["scenario"]["stages"] = json!([])),
        ("manifest.json", |m| m["stages"] = json!(7)),
        ("manifest.json", |m| *m = json!([])),
    ];
    for (n, (words, change)) in changes.into_iter().enumerate() {
        let craft = Craft::new(folder.path().join(n.to_string()));
        craft.seal();
        craft.manifest(change);
        for (name, output) in craft.read_by_all(folder.path()) {
            let said = said(&output);
            assert_eq!(output.status.code(), Some(2), "law: {name} refuses {words}, got {said}");
            let is_plain = !said.contains(['\u{1b}', '\u{202e}']);
            assert!(is_plain && said.contains(words), "law: {name}: it is said, got {said:?}");
        }
    }
}
