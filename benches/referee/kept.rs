//! What earlier runs finished: lines of JSON that are appended as parts end, so that
//! an interrupted run loses only what it was at.

use std::{
    collections::BTreeMap,
    fs::{File, OpenOptions},
    io::Write,
    path::{Path, PathBuf},
    sync::OnceLock,
};

use pluvia::record::hash_bytes;
use serde::{Serialize, de::DeserializeOwned};

/// A file of finished parts.
pub struct Kept {
    path: PathBuf,
    file: File,
}

impl Kept {
    /// Opens a file, and reads the parts in it that `is_current` accepts.
    pub fn open<T: DeserializeOwned>(
        path: &Path,
        is_current: impl Fn(&T) -> bool,
    ) -> Result<(Self, Vec<T>), String> {
        let told = |e: std::io::Error| format!("{}: {e}", path.display());
        let text = match std::fs::read(path) {
            Ok(bytes) => String::from_utf8_lossy(&bytes).into_owned(),
            Err(e) if e.kind() == std::io::ErrorKind::NotFound => String::new(),
            Err(e) => return Err(told(e)),
        };
        // The last line of a run that was killed may be unfinished: it is no part.
        let parts = text
            .lines()
            .filter_map(|line| serde_json::from_str(line).ok())
            .filter(is_current)
            .collect();
        let mut file = OpenOptions::new().create(true).append(true).open(path).map_err(told)?;
        if !text.is_empty() && !text.ends_with('\n') {
            file.write_all(b"\n").map_err(told)?;
        }
        Ok((Self { path: path.to_owned(), file }, parts))
    }

    /// Appends a part.
    pub fn keep(&mut self, part: &impl Serialize) -> Result<(), String> {
        let told = |e: &dyn std::fmt::Display| format!("{}: {e}", self.path.display());
        let line = serde_json::to_string(part).map_err(|e| told(&e))? + "\n";
        self.file.write_all(line.as_bytes()).map_err(|e| told(&e))
    }
}

/// Of parts with the same key the one that was kept last, by their keys: what was computed again
/// stands in the file twice.
pub fn last_of_each<T, K: Ord>(parts: Vec<T>, key: impl Fn(&T) -> K) -> Vec<T> {
    let last: BTreeMap<K, T> = parts.into_iter().map(|part| (key(&part), part)).collect();
    last.into_values().collect()
}

/// A short name of what determines a part.
pub fn fingerprint(parts: &[&[u8]]) -> String {
    // Lengths keep the parts apart.
    let mut all = Vec::new();
    for part in parts {
        all.extend_from_slice(&(part.len() as u64).to_le_bytes());
        all.extend_from_slice(part);
    }
    hash_bytes(&all)[..16].to_owned()
}

/// The fingerprint of what computes parts of a scenario: programs, by their own, and the scenario,
/// which is a file that changes without them.
pub fn computed_by(programs: &[&str], scenario: &impl Serialize) -> Result<String, String> {
    let scenario = serde_json::to_string(scenario).map_err(|e| e.to_string())?;
    let all = programs.iter().copied().chain([scenario.as_str()]);
    Ok(fingerprint(&all.map(str::as_bytes).collect::<Vec<_>>()))
}

/// The fingerprint of this program, as it was when this was first asked: a build may
/// replace its file.
pub fn own_identity() -> Result<String, String> {
    static OWN: OnceLock<Result<String, String>> = OnceLock::new();
    let find = || identity(&std::env::current_exe().map_err(|e| e.to_string())?);
    OWN.get_or_init(find).clone()
}

/// The fingerprint of a program: of its file.
pub fn identity(file: &Path) -> Result<String, String> {
    let bytes = std::fs::read(file).map_err(|e| format!("{}: {e}", file.display()))?;
    Ok(fingerprint(&[&bytes]))
}
