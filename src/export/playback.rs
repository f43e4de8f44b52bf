//! Reads back how a run went: the frames of its stages.

use std::{path::Path, sync::Arc};

use super::run_folder::{ExportError, Manifest, beside, grains_of, setup_of};
use crate::grains::GrainSet;
use crate::protocol::Setup;
use crate::record::{FRAMES_FILE, FileError, Frame, StageStore, read_frames, read_json};
use crate::specimen::SpecimenState;

/// A run from its first stage to its last.
#[derive(Debug, Clone, PartialEq)]
pub struct Playback {
    /// Name of the scenario.
    pub scenario: String,
    /// The laboratory.
    pub setup: Setup,
    /// The grains, in the order of the frames' grains.
    pub grains: Arc<GrainSet>,
    /// The stages in their order.
    pub stages: Vec<PlayedStage>,
}

/// How a stage went.
#[derive(Debug, Clone, PartialEq)]
pub struct PlayedStage {
    /// Its name, as in the scenario.
    pub name: String,
    /// What was seen of it, by time; of a stage that was carried out without
    /// keeping frames, its end alone.
    pub frames: Vec<Frame>,
    /// Whether frames were kept.
    pub kept: bool,
}

/// Reads a run folder as `pluvia run` and `reproduce` write it.
///
/// # Errors
/// [`ExportError`], naming the file.
pub fn read_playback(folder: &Path) -> Result<Playback, ExportError> {
    let path = folder.join("manifest.json");
    let manifest: Manifest = read_json(&path)?;
    let setup = setup_of(&manifest, &path)?;
    let grains = Arc::new(grains_of(folder)?);
    let root = beside(folder, "stages");
    let mut stages = Vec::new();
    for entry in &manifest.stages {
        let stored = StageStore::folder_in(&root, &entry.key);
        let kept = stored.join(FRAMES_FILE);
        let is_kept = kept.exists();
        let end = stored.join("specimen.json");
        let end_frame = Frame::of(&read_json::<SpecimenState>(&end)?);
        let (frames, path) = if is_kept {
            let mut frames = read_frames(&kept)?;
            for frame in &mut frames {
                frame.base.clone_from(&end_frame.base);
            }
            (frames, kept)
        } else {
            (vec![end_frame], end)
        };
        let expected = grains.grains.len();
        if let Some(frame) = frames.iter().find(|frame| frame.grains.len() != expected) {
            let reason =
                format!("it has {} grains, and grains.json {expected}", frame.grains.len());
            return Err(FileError::new("use", &path, reason).into());
        }
        stages.push(PlayedStage { name: entry.stage.clone(), frames, kept: is_kept });
    }
    Ok(Playback { scenario: manifest.scenario.name, setup, grains, stages })
}
