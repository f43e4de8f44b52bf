//! Finished stages on disk, each under the hash of everything that determines it.

use std::{
    fs::{self, File},
    path::{Path, PathBuf},
    sync::Arc,
};

use serde::{Deserialize, Serialize};

use super::{
    Checkpoints, FRAMES_FILE, FileError, Frame, FrameWriter, SeriesRow, StageGuards,
    atomic::sync_folder,
    create_folder,
    frames::{read_frame_ends, read_frames},
    hash::hash_file,
    hash_bytes, hash_json, read_json, read_unchanged, series_from_csv, to_csv, write_file,
    write_json,
};
use crate::specimen::SpecimenState;
use crate::world::EffectiveSettings;

/// `stage.json`: what a finished stage says of itself.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
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
    /// What its guards found; none where the stage was stored before this was
    /// recorded.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub guards: Option<StageGuards>,
    /// Solver residuals, one a sample; empty of an engine that does not say.
    #[serde(default)]
    pub solver_residuals: Vec<f64>,
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
    /// SHA-256 of `frames.bin`; empty where no frames were kept, or the stage
    /// was stored before this was recorded.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub frames_sha256: String,
    /// SHA-256 of this record as JSON in one line without this field; empty
    /// where the stage was stored before this was recorded.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub record_sha256: String,
}

impl StageRecord {
    fn own_hash(&self) -> String {
        hash_json(&Self { record_sha256: String::new(), ..self.clone() })
    }
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
    /// Held, shared with others, as long as somebody may be writing.
    _lock: Arc<File>,
}

impl StageStore {
    /// A store in a folder, which is created when missing; leftovers of
    /// writers that were killed are removed, unless another program or store
    /// is at work there.
    ///
    /// # Errors
    /// When the folder cannot be made or listed.
    pub fn open(root: &Path) -> Result<Self, FileError> {
        create_folder(root)?;
        let refused = |e| FileError::new("open", root, e);
        let lock = root.join(".lock");
        let lock = File::options().create(true).append(true).open(lock).map_err(refused)?;
        if lock.try_lock().is_ok() {
            // Nobody else works here, so that what is half written is of the dead.
            let entries = fs::read_dir(root).map_err(|e| FileError::new("list", root, e))?;
            for entry in entries.flatten() {
                if entry.file_name().to_string_lossy().starts_with(".part-") {
                    // A leftover that cannot be removed does no harm.
                    let _ = fs::remove_dir_all(entry.path());
                    let _ = fs::remove_file(entry.path());
                }
            }
        }
        // A file system without locks keeps leftovers of others from nobody.
        let _ = lock.unlock();
        let _ = lock.try_lock_shared();
        Ok(Self { root: root.to_owned(), frames: false, _lock: Arc::new(lock) })
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

    /// The checkpoints of a stage that is to be carried out; none where another
    /// program is at it just now.
    ///
    /// # Errors
    /// When their folder cannot be made.
    pub fn checkpoints(&self, key: &str) -> Result<Option<Checkpoints>, FileError> {
        Checkpoints::open(&self.root, key)
    }

    /// Whether frames are kept of stages that are carried out.
    pub fn keeps_frames(&self) -> bool {
        self.frames
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
        // Engines of workflows make the folder of what they expect before it is there.
        if fs::read_dir(&folder).map_or(true, |mut entries| entries.next().is_none()) {
            return (None, None);
        }
        match self.read(&folder) {
            Ok(stage) => {
                Checkpoints::discard(&self.root, key);
                (Some(stage), None)
            }
            Err(error) => (None, Some(format!("stored stage is damaged and done again: {error}"))),
        }
    }

    fn read(&self, folder: &Path) -> Result<StoredStage, FileError> {
        let record = read_record(folder)?;
        let path = folder.join("series.csv");
        let content = read_unchanged(&path, &record.series_sha256)?;
        let series = series_from_csv(&content).map_err(|e| FileError::new("read", &path, e))?;
        let state = read_state(folder, &record)?;
        if self.frames && !record.frames_sha256.is_empty() {
            let path = folder.join(FRAMES_FILE);
            let found = hash_file(&path).map_err(|e| FileError::new("read", &path, e))?;
            if found != record.frames_sha256 {
                return Err(FileError::changed(&path));
            }
        }
        Ok(StoredStage { record, state, series })
    }

    /// The specimen's state at the end of a stage of a store that is only to be
    /// read, and the file it stands in.
    ///
    /// # Errors
    /// When it is not there, or not as it was written.
    pub fn state_in(root: &Path, key: &str) -> Result<(SpecimenState, PathBuf), FileError> {
        let folder = Self::folder_in(root, key);
        let state = read_state(&folder, &read_record(&folder)?)?;
        Ok((state, folder.join("specimen.json")))
    }

    /// The frames of a stage of a store that is only to be read, and the file
    /// they stand in; none where none were kept, or where the file was removed to
    /// make room: no number hangs on it.
    ///
    /// # Errors
    /// When they are not as they were written.
    pub fn frames_in(root: &Path, key: &str) -> Result<Option<(Vec<Frame>, PathBuf)>, FileError> {
        Self::read_frames_in(root, key, read_frames)
    }

    /// The first of these frames and the last two, without holding the others
    /// in memory.
    ///
    /// # Errors
    /// As [`Self::frames_in`].
    pub fn frame_ends_in(
        root: &Path,
        key: &str,
    ) -> Result<Option<(Vec<Frame>, PathBuf)>, FileError> {
        Self::read_frames_in(root, key, read_frame_ends)
    }

    fn read_frames_in(
        root: &Path,
        key: &str,
        read: fn(&Path, &str) -> Result<Vec<Frame>, FileError>,
    ) -> Result<Option<(Vec<Frame>, PathBuf)>, FileError> {
        let folder = Self::folder_in(root, key);
        let path = folder.join(FRAMES_FILE);
        let noted = read_record(&folder)?.frames_sha256;
        if !path.exists() {
            return Ok(None);
        }
        Ok(Some((read(&path, &noted)?, path)))
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
        let refused = |e| FileError::new("create", &target, e);
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
            stage.record.frames_sha256 = frames.keep(&part.path().join(FRAMES_FILE))?;
        }
        stage.record.record_sha256 = stage.record.own_hash();
        write_json(&part.path().join("stage.json"), &stage.record)?;
        #[cfg(unix)]
        {
            use std::os::unix::fs::PermissionsExt;
            // Temporary folders are private to their owner; results are not.
            fs::set_permissions(part.path(), fs::Permissions::from_mode(0o755)).map_err(refused)?;
        }
        sync_folder(part.path()).map_err(refused)?;
        if target.exists() {
            fs::remove_dir_all(&target).map_err(|e| FileError::new("replace", &target, e))?;
        }
        // Whoever else works here may have stored the same just now, to the bit.
        if let Err(error) = fs::rename(part.path(), &target)
            && !target.exists()
        {
            return Err(refused(error));
        }
        sync_folder(&self.root).map_err(refused)?;
        let state = read_state(&target, &stage.record)?;
        Ok(StoredStage { state, ..stage })
    }

    /// An error with what is not lost by it.
    #[must_use]
    pub fn keeping(&self, error: FileError) -> FileError {
        let root = self.root.display();
        let finished = fs::read_dir(&self.root).map(|entries| {
            let whole = |e: &fs::DirEntry| e.path().join("stage.json").is_file();
            entries.flatten().filter(whole).count()
        });
        let kept = match finished {
            Ok(0) => "no stage had been finished".to_owned(),
            Ok(1) => {
                format!("the finished stage in {root} is kept; the same command goes on from it")
            }
            Ok(n) => format!(
                "the {n} finished stages in {root} are kept; the same command goes on from them"
            ),
            Err(_) => format!("the finished stages in {root} are gone too"),
        };
        FileError { reason: format!("{} ({kept})", error.reason), ..error }
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

/// What a stage says of itself, if that is as it was written.
fn read_record(folder: &Path) -> Result<StageRecord, FileError> {
    let path = folder.join("stage.json");
    let record: StageRecord = read_json(&path)?;
    if !record.record_sha256.is_empty() && record.record_sha256 != record.own_hash() {
        return Err(FileError::changed(&path));
    }
    Ok(record)
}

fn read_state(folder: &Path, record: &StageRecord) -> Result<SpecimenState, FileError> {
    let path = folder.join("specimen.json");
    let content = read_unchanged(&path, &record.specimen_sha256)?;
    serde_json::from_slice(&content).map_err(|e| FileError::new("read", &path, e))
}

#[cfg(test)]
#[path = "store_tests.rs"]
mod tests;
