//! Whether two folders of results hold the same.

use std::{
    collections::BTreeSet,
    fs,
    path::{Path, PathBuf},
};

use serde_json::Value;

/// What depends on the machine's speed, and the sum of a record that holds it.
const TIMINGS: [&str; 4] = ["wall_s", "engine_s", "peak_memory_mib", "record_sha256"];

/// The report tells how long it took.
const TELLS_TIME: [&str; 1] = ["report.html"];

/// A JSON value without what depends on the machine's speed.
fn timeless(value: &mut Value) {
    match value {
        Value::Object(fields) => {
            fields.retain(|name, _| !TIMINGS.contains(&name.as_str()));
            fields.values_mut().for_each(timeless);
        }
        Value::Array(values) => values.iter_mut().for_each(timeless),
        _ => {}
    }
}

/// Whether two files hold the same but for timings.
fn same_content(a: &Path, b: &Path) -> bool {
    let (Ok(one), Ok(two)) = (fs::read(a), fs::read(b)) else { return false };
    if one == two || TELLS_TIME.iter().any(|name| a.ends_with(name)) {
        return true;
    }
    let parsed = |bytes: &[u8]| {
        let mut value: Value = serde_json::from_slice(bytes).ok()?;
        timeless(&mut value);
        Some(value)
    };
    let is_json = a.extension().is_some_and(|e| e == "json");
    is_json && parsed(&one).is_some_and(|one| Some(one) == parsed(&two))
}

/// The files under a folder, relative to it, without those of a temporary name.
fn files(folder: &Path) -> BTreeSet<PathBuf> {
    let mut found = BTreeSet::new();
    let mut below = vec![PathBuf::new()];
    while let Some(at) = below.pop() {
        for entry in fs::read_dir(folder.join(&at)).into_iter().flatten().flatten() {
            let name = entry.file_name();
            if name.to_string_lossy().starts_with('.') {
                continue;
            }
            let path = at.join(name);
            if entry.path().is_dir() {
                below.push(path);
            } else {
                found.insert(path);
            }
        }
    }
    found
}

/// What is on its way under a folder, or was when its writer was killed: all
/// whose name begins with a dot, but locks.
pub fn half_written(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut below = vec![folder.to_owned()];
    while let Some(at) = below.pop() {
        for entry in fs::read_dir(at).into_iter().flatten().flatten() {
            let name = entry.file_name().to_string_lossy().into_owned();
            if name.starts_with('.') && !name.ends_with(".lock") {
                found.push(entry.path());
            } else if entry.path().is_dir() {
                below.push(entry.path());
            }
        }
    }
    found
}

/// What is in one folder and not, or not the same, in another.
fn differences(part: &Path, whole: &Path) -> Vec<PathBuf> {
    let differs = |f: &PathBuf| !same_content(&part.join(f), &whole.join(f));
    files(part).into_iter().filter(differs).collect()
}

/// Same files with the same bytes, but for timings.
pub fn assert_same_files(a: &Path, b: &Path, what: &str) {
    assert_eq!(files(a), files(b), "law: {what}: the same files");
    let differ = differences(a, b);
    assert!(differ.is_empty(), "law: {what}: the same bytes, got others in {differ:?}");
}

/// What is there is whole: the same bytes as in the finished folder.
pub fn assert_whole_files(part: &Path, finished: &Path, what: &str) {
    let differ = differences(part, finished);
    assert!(differ.is_empty(), "law: {what}: every file there is whole, not so {differ:?}");
}

#[test]
fn differences_are_found_and_timings_are_none() {
    let folder = tempfile::tempdir().expect("a folder");
    let [a, b] = ["a", "b"].map(|name| folder.path().join(name));
    for (out, wall, height) in [(&a, 1, 5), (&b, 2, 5)] {
        fs::create_dir_all(out.join("runs")).expect("a folder");
        let json = format!("{{\"x\": [{{\"wall_s\": {wall}, \"height\": {height}}}]}}");
        fs::write(out.join("runs/a.json"), json).expect("written");
        fs::write(out.join("b.csv"), "1,2").expect("written");
        fs::write(out.join(".part"), format!("{wall}")).expect("written");
    }
    assert_same_files(&a, &b, "but for timings");
    fs::write(b.join("b.csv"), "1,3").expect("written");
    assert_eq!(differences(&a, &b), [PathBuf::from("b.csv")], "law: a byte is seen");
    fs::write(b.join("runs/a.json"), "{\"x\": [{\"height\": 6}]}").expect("written");
    assert_eq!(differences(&a, &b).len(), 2, "law: a number is seen");
    fs::remove_file(a.join("b.csv")).expect("removed");
    assert_eq!(differences(&a, &b).len(), 1, "law: what is not there is not torn");
    assert_ne!(files(&a), files(&b), "law: a file that is missing is seen");
}
