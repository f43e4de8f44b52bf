//! Finished stages on disk, each under the hash of everything that determines it.

use std::sync::Arc;

use super::*;

/// Held by everybody who works in a store, together with others.
pub(super) const LOCK: &str = ".lock";

/// Held by whoever replaces a stage.
const REPLACING: &str = ".replacing.lock";

/// How the names of what is half written begin.
pub(super) const PART: &str = ".part-";

/// A folder of finished stages.
#[derive(Debug, Clone)]
pub struct StageStore {
    root: PathBuf,
    frames: bool,
    /// Held, shared with others, as long as somebody may be writing; none of who only reads.
    _lock: Option<Arc<File>>,
}

impl StageStore {
    /// A store in a folder, which is created when missing; leftovers of
    /// writers that were killed are removed, unless another program or store
    /// is at work there. While somebody else removes them, this waits.
    ///
    /// # Errors
    /// When the folder cannot be made.
    pub fn open(root: &Path) -> Result<Self, FileError> {
        create_folder(root)?;
        let lock = open_lock(root, LOCK)?;
        if ask_alone(&lock) == AtWork::Nobody {
            // Whoever works here holds the lock: what is half written is abandoned.
            for part in parts_in(root) {
                // A leftover that cannot be removed does no harm.
                let _ = fs::remove_dir_all(&part);
                let _ = fs::remove_file(&part);
            }
            let _ = lock.unlock();
        }
        wait_shared(&lock);
        remove_abandoned_in(root);
        Ok(Self { root: root.to_owned(), frames: false, _lock: Some(Arc::new(lock)) })
    }

    /// A store that is only to be read, there or not yet: nothing is made or removed.
    pub fn to_be_read(root: &Path) -> Self {
        Self { root: root.to_owned(), frames: false, _lock: None }
    }

    /// The same, keeping the frames of stages that are run, where that is
    /// wanted. A stage that is there already stays as it is.
    pub fn with_frames(self, frames: bool) -> Self {
        Self { frames, ..self }
    }

    /// Where the frames of a stage can be written while it is run; none where they are not kept.
    ///
    /// # Errors
    /// When the file cannot be made.
    pub fn frames(&self, grains: usize, pieces: usize) -> Result<Option<FrameWriter>, FileError> {
        self.frames.then(|| FrameWriter::new(&self.root, grains, pieces)).transpose()
    }

    /// The checkpoints of a stage that is to be run; none where another program is at it just now.
    ///
    /// # Errors
    /// When their folder cannot be made.
    pub fn checkpoints(&self, asked: &AskedStage) -> Result<Option<Checkpoints>, FileError> {
        Checkpoints::open(&self.root, asked)
    }

    /// Whether frames are kept of stages that are run.
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

    /// Reads a stage if it is there whole, unchanged and the one that is asked for. Another or a
    /// damaged one counts as missing: the second value says why, for a warning.
    pub fn load(&self, asked: &AskedStage) -> (Option<StoredStage>, Option<String>) {
        let folder = self.folder(&asked.identity.key);
        let mut fault = None;
        // One that was replaced while it was read is read again; one that is put there while it is
        // looked for is none.
        for _ in 0..2 {
            if is_vacant(&folder) {
                return (None, None);
            }
            match self.believed(&folder, asked) {
                Ok(stage) => {
                    Checkpoints::discard(&self.root, &asked.identity.key);
                    return (Some(stage), None);
                }
                Err(error) => {
                    fault = Some(format!("stored stage is damaged and done again: {error}"));
                }
            }
        }
        (None, fault)
    }

    /// Reads a stage and compares it with what is asked for.
    fn believed(&self, folder: &Path, asked: &AskedStage) -> Result<StoredStage, FileError> {
        let record = read_record(folder)?;
        let unfit = |why: String| FileError::unfit(&folder.join(RECORD_FILE), why);
        let Some(identity) = &record.identity else {
            return Err(unfit("it does not say which stage it is".to_owned()));
        };
        identity.is(asked.identity).map_err(unfit)?;
        if record.began_with_sha256.as_deref() != asked.began_with {
            return Err(unfit("it began with another specimen than the stage before has".into()));
        }
        let stage = read_stage(folder, record, self.frames)?;
        (asked.plausible)(&stage).map_err(|why| FileError::unfit(&folder.join(STATE_FILE), why))?;
        Ok(stage)
    }

    /// What a stage of a store that is only to be read says of itself, the specimen's state at its
    /// end, and the file of that state. `sha256` is what a manifest noted of the file; an empty one
    /// was not noted.
    ///
    /// # Errors
    /// When it is not there, not as it was written, or another stage's.
    pub fn stage_in(
        root: &Path,
        key: &str,
        sha256: &str,
    ) -> Result<(StageRecord, SpecimenState, PathBuf), FileError> {
        let folder = Self::folder_in(root, key);
        let file = folder.join(STATE_FILE);
        let record = read_record_of(&folder, key)?;
        if !sha256.is_empty() && sha256 != record.specimen_sha256 {
            return Err(FileError::changed(&file));
        }
        let state = read_state(&folder, &record)?;
        Ok((record, state, file))
    }

    /// Frames of a stage of a store that is only to be read, and the file they stand in; none
    /// where none were kept, or where the file was removed to make room: no number depends on it.
    ///
    /// # Errors
    /// When they are not as they were written.
    pub fn frames_in(
        root: &Path,
        key: &str,
        which: FramesRead,
    ) -> Result<Option<(Vec<Frame>, PathBuf)>, FileError> {
        let folder = Self::folder_in(root, key);
        let path = folder.join(FRAMES_FILE);
        let record = read_record_of(&folder, key)?;
        let noted = record.frames_sha256;
        // Frames that the stage knows nothing of are not its own.
        let unknown = record.identity.is_some() && noted.is_empty();
        if unknown || !path.exists() {
            return Ok(None);
        }
        let frames = match which {
            FramesRead::All => read_frames(&path, &noted)?,
            FramesRead::Ends => read_frame_ends(&path, &noted)?,
        };
        Ok(Some((frames, path)))
    }

    /// Stores a stage: written into a folder of its own first, then renamed, so that it is there
    /// whole or not at all. Fills in what stage it is and the hashes, and gives back what a reader
    /// will find. Where another program has stored it meanwhile, that one stays and is given; the
    /// second value says so if its result is another.
    ///
    /// # Errors
    /// When a file cannot be written.
    pub fn save(
        &self,
        asked: &AskedStage,
        mut stage: StoredStage,
        frames: Option<FrameWriter>,
    ) -> Result<(StoredStage, Option<String>), FileError> {
        let target = self.folder(&asked.identity.key);
        let refused = |e| FileError::new("create", &target, e);
        let part = self.part()?;
        let specimen =
            serde_json::to_vec(&stage.state).map_err(|e| FileError::new("write", &target, e))?;
        let series = to_csv(&stage.series).map_err(|e| FileError::new("write", &target, e))?;
        stage.record.identity = Some(asked.identity.clone());
        stage.record.began_with_sha256 = asked.began_with.map(str::to_owned);
        stage.record.specimen_sha256 = hash_bytes(&specimen);
        stage.record.series_sha256 = hash_bytes(&series);
        // Whoever reads of an error knows where the file would have been.
        let in_place = |error: FileError| {
            let path = error.path.strip_prefix(part.path()).map(|name| target.join(name));
            FileError { path: path.unwrap_or_else(|_| error.path.clone()), ..error }
        };
        write_file(&part.path().join(STATE_FILE), &specimen).map_err(in_place)?;
        write_file(&part.path().join(SERIES_FILE), &series).map_err(in_place)?;
        if let Some(frames) = frames {
            let kept = frames.keep(&part.path().join(FRAMES_FILE)).map_err(in_place)?;
            stage.record.frames_sha256 = kept;
        }
        stage.record.record_sha256 = stage.record.own_hash();
        write_json(&part.path().join(RECORD_FILE), &stage.record).map_err(in_place)?;
        #[cfg(unix)]
        {
            use std::os::unix::fs::PermissionsExt;
            // Temporary folders are private to their owner; results are not.
            fs::set_permissions(part.path(), fs::Permissions::from_mode(0o755)).map_err(refused)?;
        }
        sync_folder(part.path()).map_err(refused)?;
        let first = self.publish(exchange, part.path(), &target, asked)?;
        // It failed before, perhaps for lack of memory, and does so no more.
        let _ = fs::remove_file(self.failed_file(&asked.identity.key));
        if let Some(first) = first {
            let differs = first.record.specimen_sha256 != stage.record.specimen_sha256;
            let note = differs.then(|| {
                format!(
                    "another program has stored another result of this stage, which is kept: {}",
                    target.display()
                )
            });
            return Ok((first, note));
        }
        sync_folder(&self.root).map_err(refused)?;
        let state = read_state(&target, &stage.record)?;
        Ok((StoredStage { state, ..stage }, None))
    }

    fn part(&self) -> Result<tempfile::TempDir, FileError> {
        let part = tempfile::Builder::new().prefix(PART).tempdir_in(&self.root);
        part.map_err(|error| {
            // Without the name that it would have had, which no reader knows.
            let said = error.to_string();
            let said = said.split(" at path ").next().unwrap_or_default();
            FileError::new("create a folder in", &self.root, said)
        })
    }

    /// Puts a written stage in its place, unless one is there that is to be
    /// believed, which is given then: it is never taken away, so that no reader
    /// misses it. What is not believed is replaced by one program at a time:
    /// `exchange` swaps two folders and says whether it could.
    fn publish(
        &self,
        exchange: fn(&Path, &Path) -> bool,
        part: &Path,
        target: &Path,
        asked: &AskedStage,
    ) -> Result<Option<StoredStage>, FileError> {
        // In place of nothing or of an empty folder.
        if fs::rename(part, target).is_ok() {
            return Ok(None);
        }
        let turn = open_lock(&self.root, REPLACING)?;
        wait_alone(&turn);
        loop {
            let Err(error) = fs::rename(part, target) else { return Ok(None) };
            if is_vacant(target) {
                return Err(FileError::new("create", target, error));
            }
            if let Ok(first) = self.believed(target, asked) {
                return Ok(Some(first));
            }
            // What is refused goes with the folder that the other was written in.
            if exchange(part, target) {
                return Ok(None);
            }
            // Where the system has no exchange, a reader may find nothing for a moment.
            let aside = self.part()?;
            fs::rename(target, aside.path().join("refused"))
                .map_err(|e| FileError::new("replace", target, e))?;
        }
    }

    /// An error with what is not lost by it.
    #[must_use]
    pub fn keeping(&self, error: FileError) -> FileError {
        let root = self.root.display();
        let finished = fs::read_dir(&self.root).map(|entries| {
            let whole = |e: &fs::DirEntry| e.path().join(RECORD_FILE).is_file();
            entries.flatten().filter(whole).count()
        });
        let kept = match finished {
            Ok(0) => "no stage had been finished".to_owned(),
            Ok(1) => format!(
                "the finished stage in {root} is kept; run the same command again to resume from it"
            ),
            Ok(n) => format!(
                "the {n} finished stages in {root} are kept; run the same command again to resume \
                 from them"
            ),
            Err(_) => format!("the finished stages in {root} are gone too"),
        };
        FileError { reason: format!("{} ({kept})", error.reason), ..error }
    }

    /// A stage that is there whole, unchanged and the one that is asked for; nothing else is done
    /// about one that is not.
    pub fn sound(&self, asked: &AskedStage) -> Option<StoredStage> {
        let folder = self.folder(&asked.identity.key);
        // One that was replaced while it was read is read again.
        self.believed(&folder, asked).or_else(|_| self.believed(&folder, asked)).ok()
    }

    /// Why a stage failed when it was last run; none where it did not.
    pub fn failure(&self, key: &str) -> Option<String> {
        let kept: serde_json::Value = read_json(&self.failed_file(key)).ok()?;
        let is_own = kept.get("key")?.as_str() == Some(key);
        kept.get("failure").filter(|_| is_own)?.as_str().map(str::to_owned)
    }

    fn failed_file(&self, key: &str) -> PathBuf {
        self.root.join(format!("failed-{}.json", key.get(..24).unwrap_or(key)))
    }

    /// Keeps the last good state of a stage that failed, why, and the warnings of before; returns the
    /// file.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn keep_failed(
        &self,
        key: &str,
        state: &SpecimenState,
        why: &str,
        warnings: &[String],
    ) -> Result<PathBuf, FileError> {
        let path = self.failed_file(key);
        let kept = serde_json::json!({
            "key": key, "failure": why, "warnings": warnings, "last_good": state,
        });
        write_json(&path, &kept)?;
        Ok(path)
    }
}

/// Opens a file of a folder that is there to be locked.
pub(super) fn open_lock(root: &Path, name: &str) -> Result<File, FileError> {
    let lock = File::options().create(true).append(true).open(root.join(name));
    lock.map_err(|e| FileError::new("open", root, e))
}

/// What is half written in a store, or was when its writer was killed.
pub(super) fn parts_in(root: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(root).into_iter().flatten().flatten();
    let parts = entries.filter(|e| e.file_name().to_string_lossy().starts_with(PART));
    parts.map(|e| e.path()).collect()
}

/// Whether there is nothing at a stage's place. Engines of workflows make the
/// folder of what they expect before it is there. What cannot be listed is something.
pub(super) fn is_vacant(folder: &Path) -> bool {
    match fs::read_dir(folder) {
        Ok(mut entries) => entries.next().is_none(),
        Err(error) => error.kind() == io::ErrorKind::NotFound,
    }
}

#[cfg(test)]
#[path = "store_tests.rs"]
mod tests;
