//! Reads back how a run went: the frames of its stages.

use super::*;

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
    /// What was seen of it, by time; of a stage that was run without keeping frames, its end alone.
    pub frames: Vec<Frame>,
    /// Whether frames were kept.
    pub kept: bool,
}

/// Reads a run folder as `pluvia run` and `reproduce` write it, with these of its frames. Of whoever
/// asks for a stage, by the names and numbers of [`super::read_run`]: where it is the rest test, that
/// is the last of the stages.
///
/// # Errors
/// [`ExportError`], naming the file or the stages there are.
pub fn read_playback(
    folder: &Path,
    frames: FramesRead,
    asked: Option<&str>,
) -> Result<Playback, ExportError> {
    let manifest = Manifest::of(folder)?;
    let asked = asked.map(|asked| manifest.find(asked)).transpose()?;
    let rest_test = asked.filter(|(number, _, _)| number.is_none());
    let setup = manifest.setup()?;
    let grains = Arc::new(manifest.grains()?);
    let mut stages = Vec::new();
    let of_scenario = manifest.stages.iter().map(|entry| (entry.stage.clone(), entry));
    let rest_test = rest_test.into_iter().map(|(_, name, entry)| (name, entry));
    for (name, entry) in of_scenario.chain(rest_test) {
        let (end, found) = manifest.stage(entry, &grains, frames)?;
        let kept = found.is_some();
        let frames = found.unwrap_or_else(|| vec![Frame::of(&end)]);
        stages.push(PlayedStage { name, frames, kept });
    }
    Ok(Playback { scenario: manifest.scenario.name, setup, grains, stages })
}
