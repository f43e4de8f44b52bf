//! Finished stages on disk, each under the hash of everything that determines it.

use std::{
    fs,
    path::{Path, PathBuf},
};

use serde::{Deserialize, Serialize};

use super::{
    FRAMES_FILE, FileError, FrameWriter, SeriesRow, create_folder, hash_bytes, read_file,
    read_json, series_from_csv, to_csv, write_file, write_json,
};
use crate::specimen::SpecimenState;
use crate::world::EffectiveSettings;

/// `stage.json`: what a finished stage says of itself.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StageRecord {
    /// Name of the stage as in the scenario.
    pub stage: String,
    /// Engine steps taken.
    pub steps: u64,
    /// Simulated time in s.
    pub simulated_s: f64,
    /// Wall time in s.
    pub wall_s: f64,
    /// The part of it spent inside the engine.
    pub engine_s: f64,
    /// Findings a reader must know.
    pub warnings: Vec<String>,
    /// Engine settings as read back.
    pub effective: EffectiveSettings,
    /// Smallest square opening in mm that each grain passes with the shape that
    /// the engine held at the end, in the order of the grain set; null for a
    /// grain that was not there; empty where the engine cannot be asked, or
    /// the stage was stored before this was recorded.
    #[serde(default)]
    pub sieved_mm: Vec<Option<f64>>,
    /// SHA-256 of `specimen.json`.
    pub specimen_sha256: String,
    /// SHA-256 of `series.csv`.
    pub series_sha256: String,
}

/// A finished stage read from the store.
#[derive(Debug, Clone, PartialEq)]
pub struct StoredStage {
    /// What it says of itself.
    pub record: StageRecord,
    /// The specimen's state at its end.
    pub state: SpecimenState,
    /// What was observed during it.
    pub series: Vec<SeriesRow>,
}

/// A folder of finished stages.
#[derive(Debug, Clone)]
pub struct StageStore {
    root: PathBuf,
    frames: bool,
}

impl StageStore {
    /// A store in a folder, which is created when missing; leftovers of
    /// writers that were killed are removed.
    ///
    /// # Errors
    /// When the folder cannot be made or listed.
    pub fn open(root: &Path) -> Result<Self, FileError> {
        create_folder(root)?;
        let entries = fs::read_dir(root).map_err(|e| FileError::new("list", root, e))?;
        for entry in entries.flatten() {
            if entry.file_name().to_string_lossy().starts_with(".part-") {
                // A leftover that cannot be removed does no harm.
                let _ = fs::remove_dir_all(entry.path());
                let _ = fs::remove_file(entry.path());
            }
        }
        Ok(Self { root: root.to_owned(), frames: false })
    }

    /// The same, keeping the frames of stages that are carried out, where that is
    /// wanted. A stage that is there already stays as it is.
    pub fn with_frames(self, frames: bool) -> Self {
        Self { frames, ..self }
    }

    /// Where the frames of a stage can be written while it is carried out; none
    /// where they are not kept.
    ///
    /// # Errors
    /// When the file cannot be made.
    pub fn frames(&self, grains: usize) -> Result<Option<FrameWriter>, FileError> {
        self.frames.then(|| FrameWriter::new(&self.root, grains)).transpose()
    }

    /// Folder of a stage.
    pub fn folder(&self, key: &str) -> PathBuf {
        Self::folder_in(&self.root, key)
    }

    /// Folder of a stage in a store that is only to be read.
    pub fn folder_in(root: &Path, key: &str) -> PathBuf {
        root.join(key.get(..24).unwrap_or(key))
    }

    /// Reads a stage if it is there whole and unchanged. A damaged one counts
    /// as missing: the second value says why, for a warning.
    pub fn load(&self, key: &str) -> (Option<StoredStage>, Option<String>) {
        let folder = self.folder(key);
        if !folder.is_dir() {
            return (None, None);
        }
        match Self::read(&folder) {
            Ok(stage) => (Some(stage), None),
            Err(error) => (None, Some(format!("stored stage is damaged and done again: {error}"))),
        }
    }

    fn read(folder: &Path) -> Result<StoredStage, FileError> {
        let record: StageRecord = read_json(&folder.join("stage.json"))?;
        let checked = |name: &str, expected: &str| {
            let path = folder.join(name);
            let content = read_file(&path)?;
            if hash_bytes(&content) != expected {
                return Err(FileError::new("use", &path, "its content is not what was written"));
            }
            Ok((path, content))
        };
        let (path, content) = checked("specimen.json", &record.specimen_sha256)?;
        let state =
            serde_json::from_slice(&content).map_err(|e| FileError::new("read", &path, e))?;
        let (path, content) = checked("series.csv", &record.series_sha256)?;
        let series = series_from_csv(&content).map_err(|e| FileError::new("read", &path, e))?;
        Ok(StoredStage { record, state, series })
    }

    /// Stores a stage: written into a folder of its own first, then renamed,
    /// so that it is there whole or not at all. Fills in the hashes, and
    /// gives back what a reader will find.
    ///
    /// # Errors
    /// When a file cannot be written.
    pub fn save(
        &self,
        key: &str,
        mut stage: StoredStage,
        frames: Option<FrameWriter>,
    ) -> Result<StoredStage, FileError> {
        let target = self.folder(key);
        let part = tempfile::Builder::new()
            .prefix(".part-")
            .tempdir_in(&self.root)
            .map_err(|e| FileError::new("create a folder in", &self.root, e))?;
        let specimen =
            serde_json::to_vec(&stage.state).map_err(|e| FileError::new("write", &target, e))?;
        let series = to_csv(&stage.series).map_err(|e| FileError::new("write", &target, e))?;
        stage.record.specimen_sha256 = hash_bytes(&specimen);
        stage.record.series_sha256 = hash_bytes(&series);
        write_file(&part.path().join("specimen.json"), &specimen)?;
        write_file(&part.path().join("series.csv"), &series)?;
        if let Some(frames) = frames {
            frames.keep(&part.path().join(FRAMES_FILE))?;
        }
        write_json(&part.path().join("stage.json"), &stage.record)?;
        if target.exists() {
            fs::remove_dir_all(&target).map_err(|e| FileError::new("replace", &target, e))?;
        }
        let part = part.keep();
        fs::rename(&part, &target).map_err(|e| FileError::new("create", &target, e))?;
        #[cfg(unix)]
        {
            use std::os::unix::fs::PermissionsExt;
            // Temporary folders are private to their owner; results are not.
            fs::set_permissions(&target, fs::Permissions::from_mode(0o755))
                .map_err(|e| FileError::new("open up", &target, e))?;
        }
        Self::read(&target)
    }

    /// Whether a stage is there; its hashes are checked when it is read.
    pub fn holds(&self, key: &str) -> bool {
        self.folder(key).join("stage.json").is_file()
    }

    /// Why a stage failed when it was last carried out; none where it did not.
    pub fn failure(&self, key: &str) -> Option<String> {
        let kept: serde_json::Value = read_json(&self.failed_file(key)).ok()?;
        kept.get("failure")?.as_str().map(str::to_owned)
    }

    fn failed_file(&self, key: &str) -> PathBuf {
        self.root.join(format!("failed-{}.json", key.get(..24).unwrap_or(key)))
    }

    /// Keeps the last good state of a stage that failed, and why; returns the file.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn keep_failed(
        &self,
        key: &str,
        state: &SpecimenState,
        why: &str,
    ) -> Result<PathBuf, FileError> {
        let path = self.failed_file(key);
        write_json(&path, &serde_json::json!({ "failure": why, "last_good": state }))?;
        Ok(path)
    }
}
