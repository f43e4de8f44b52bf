//! Checkpoints: where a stage is at the ends of its legs, on disk until it is
//! finished.
//!
//! A folder `.legs-<key>` beside the stages holds, while a stage with legs is
//! carried out, one file a leg (the last two are kept) and the frames so far.
//! A checkpoint file has one line with the SHA-256 of all that follows, which is
//! JSON. One that is damaged is passed over for the one before it.

use std::{
    fs::{self, File},
    path::{Path, PathBuf},
};

use serde::{Deserialize, Serialize};

use super::{
    FRAMES_FILE, FileError, FrameWriter, OverlapWatch, SeriesRow, create_folder,
    frames::FramesSoFar, hash_bytes, read_file, series_from_csv, to_csv, write_file,
};
use crate::protocol::Midway;

/// How a checkpoint begins; the number is that of its format.
const HEAD: &str = "pluvia checkpoint 1 ";

/// How many are kept: the last, and one in case that is damaged.
const KEPT: usize = 2;

/// What is observed of a stage so far.
#[derive(Debug, Clone, PartialEq)]
pub struct Observed {
    /// The rows of its series.
    pub rows: Vec<SeriesRow>,
    /// What settlement is counted from.
    pub reference: Reference,
    /// What was seen of the overlap of grains.
    pub overlap: OverlapWatch,
    /// Wall time in s.
    pub wall_s: f64,
}

/// What settlement and height of a pile are counted from, once measured.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Reference {
    /// Heights of the plate, where there is one, and of the mean surface in mm
    /// when vibration began.
    pub before_vibration_mm: Option<(Option<f64>, f64)>,
    /// Mean height of a pile's base in m.
    pub base_level_m: Option<f64>,
}

#[derive(Serialize, Deserialize)]
struct Stored {
    midway: Midway,
    series_csv: String,
    reference: Reference,
    /// Not in a checkpoint of before this was recorded.
    #[serde(default)]
    overlap: OverlapWatch,
    frames: Option<FramesSoFar>,
    wall_s: f64,
}

/// Where a stage can go on.
#[derive(Debug)]
pub struct Resumed {
    /// The stage.
    pub midway: Midway,
    /// What was observed.
    pub observed: Observed,
    /// The file of frames, where they are kept.
    pub frames: Option<FrameWriter>,
}

/// The checkpoints of one stage, which nobody else writes meanwhile.
#[derive(Debug)]
pub struct Checkpoints {
    folder: PathBuf,
    _lock: File,
}

impl Checkpoints {
    /// Those of a stage in a store's folder; none where another program is just
    /// carrying out that stage.
    pub(super) fn open(root: &Path, key: &str) -> Result<Option<Self>, FileError> {
        let folder = folder(root, key);
        create_folder(&folder)?;
        let path = folder.join("lock");
        let refused = |e| FileError::new("create", &path, e);
        let lock = File::options().create(true).append(true).open(&path).map_err(refused)?;
        // A file system without locks has one program at a time, we hope.
        match lock.try_lock() {
            Err(fs::TryLockError::WouldBlock) => Ok(None),
            _ => Ok(Some(Self { folder, _lock: lock })),
        }
    }

    /// Removes what a finished stage may have left.
    pub(super) fn discard(root: &Path, key: &str) {
        if folder(root, key).is_dir()
            && let Ok(Some(leftover)) = Self::open(root, key)
        {
            leftover.remove();
        }
    }

    /// Begins the file of frames.
    ///
    /// # Errors
    /// When it cannot be made.
    pub fn frames(&self, grains: usize) -> Result<FrameWriter, FileError> {
        FrameWriter::staying(&self.folder.join(FRAMES_FILE), grains)
    }

    /// The last checkpoint that is sound and of so many grains, with its frames
    /// where they are wanted; and what is wrong with later ones, which are removed.
    pub fn last(&self, grains: usize, frames: bool) -> (Option<Resumed>, Vec<FileError>) {
        let mut damaged = Vec::new();
        for path in self.files().into_iter().rev() {
            match self.read(&path, grains, frames) {
                Ok(resumed) => return (resumed, damaged),
                Err(error) => {
                    damaged.push(error);
                    let _ = fs::remove_file(&path);
                }
            }
        }
        (None, damaged)
    }

    /// None where it has no frames and they are wanted.
    fn read(&self, path: &Path, grains: usize, frames: bool) -> Result<Option<Resumed>, FileError> {
        let content = read_file(path)?;
        let line = content.iter().position(|b| *b == b'\n').unwrap_or(content.len());
        let (head, body) = content.split_at(line);
        let body = body.get(1..).unwrap_or_default();
        if head != format!("{HEAD}{}", hash_bytes(body)).as_bytes() {
            return Err(FileError::changed(path));
        }
        let unread = |e: String| FileError::new("read", path, e);
        let stored: Stored = serde_json::from_slice(body).map_err(|e| unread(e.to_string()))?;
        stored.midway.check(grains).map_err(unread)?;
        let rows = series_from_csv(stored.series_csv.as_bytes());
        let frames = match (frames, &stored.frames) {
            (false, _) => None,
            (true, None) => return Ok(None),
            (true, Some(so_far)) => {
                Some(FrameWriter::going_on(&self.folder.join(FRAMES_FILE), so_far)?)
            }
        };
        Ok(Some(Resumed {
            midway: stored.midway,
            observed: Observed {
                rows: rows.map_err(|e| unread(e.to_string()))?,
                reference: stored.reference,
                overlap: stored.overlap,
                wall_s: stored.wall_s,
            },
            frames,
        }))
    }

    /// Stores where a stage is, with what was observed and its frames so far.
    ///
    /// # Errors
    /// When it cannot be written; the checkpoints before are still there.
    pub fn keep(
        &self,
        midway: &Midway,
        observed: &Observed,
        frames: Option<&mut FrameWriter>,
    ) -> Result<(), FileError> {
        let path = self.folder.join(format!("{:020}.leg", midway.steps));
        let refused = |e: String| FileError::new("write", &path, e);
        let series = to_csv(&observed.rows).map_err(|e| refused(e.to_string()))?;
        let stored = Stored {
            midway: midway.clone(),
            series_csv: String::from_utf8(series).map_err(|e| refused(e.to_string()))?,
            reference: observed.reference,
            overlap: observed.overlap,
            frames: frames.map(FrameWriter::so_far).transpose()?,
            wall_s: observed.wall_s,
        };
        let body = serde_json::to_vec(&stored).map_err(|e| refused(e.to_string()))?;
        let mut content = format!("{HEAD}{}\n", hash_bytes(&body)).into_bytes();
        content.extend(body);
        write_file(&path, &content)?;
        let files = self.files();
        for old in files.iter().take(files.len().saturating_sub(KEPT)) {
            // One too many does no harm.
            let _ = fs::remove_file(old);
        }
        Ok(())
    }

    /// Removes them, the stage being finished. What cannot be removed does no
    /// harm.
    pub fn remove(self) {
        let _ = fs::remove_dir_all(&self.folder);
    }

    /// Checkpoint files from the earliest to the latest.
    fn files(&self) -> Vec<PathBuf> {
        let entries = fs::read_dir(&self.folder).into_iter().flatten().flatten();
        let mut files: Vec<PathBuf> = entries
            .map(|entry| entry.path())
            .filter(|path| path.extension().is_some_and(|e| e == "leg"))
            .collect();
        files.sort();
        files
    }
}

fn folder(root: &Path, key: &str) -> PathBuf {
    root.join(format!(".legs-{}", key.get(..24).unwrap_or(key)))
}
