//! Reads a run folder back: its laboratory, its grains, and the specimen at the end of a stage.

use std::collections::BTreeMap;
use std::path::PathBuf;

use serde::de::DeserializeOwned;
use serde_json::Value;

use super::*;
use crate::plain::{counted, in_shell, plain_path};
use crate::record::{read_file, read_unchanged, refuse_without};
use crate::scenario::{self, MeantStage, StageSpec};

/// Why a run cannot be exported.
#[derive(Debug, thiserror::Error)]
pub enum ExportError {
    /// A file of the run could not be read.
    #[error(transparent)]
    File(#[from] FileError),
    /// No one stage of the run is meant.
    #[error("{}: {reason}", manifest.display())]
    Stage {
        /// The file that lists its stages.
        manifest: PathBuf,
        /// What there is.
        reason: String,
    },
    /// The scenario in the manifest makes no laboratory.
    #[error("{}: {reason}", manifest.display())]
    Apparatus {
        /// The file that holds the scenario.
        manifest: PathBuf,
        /// What is wrong.
        reason: ApparatusError,
    },
}

impl ExportError {
    /// The scenario in the manifest of a run folder makes no laboratory.
    pub fn apparatus(folder: &Path, reason: ApparatusError) -> Self {
        Self::Apparatus { manifest: folder.join(MANIFEST), reason }
    }
}

/// The file that says what a run folder holds.
const MANIFEST: &str = "manifest.json";

/// How the rest test after the last stage is asked for.
const REST_TEST: &str = "rest_test";

/// What exporting needs of `manifest.json`.
#[derive(Deserialize)]
pub(super) struct Manifest {
    pluvia: String,
    pub(super) scenario: Scenario,
    pub(super) stages: Vec<StageEntry>,
    rest_test: Option<StageEntry>,
    /// SHA-256 of the files beside it; none for those of older versions.
    #[serde(default)]
    files_sha256: BTreeMap<String, String>,
    /// The folder that it is of.
    #[serde(skip)]
    folder: PathBuf,
}

#[derive(Deserialize)]
pub(super) struct StageEntry {
    pub(super) stage: String,
    pub(super) key: String,
    /// SHA-256 of its specimen; none for those of older versions.
    #[serde(default)]
    pub(super) specimen_sha256: String,
}

/// A run as read back.
#[derive(Debug, Clone, PartialEq)]
pub struct Exported {
    /// The laboratory.
    pub setup: Setup,
    /// The specimen at the end of the stage.
    pub specimen: Specimen,
    /// What the scenario has the table do next, if that is a vibration.
    pub next_motion: Option<TableMotion>,
    /// Where it comes from.
    pub made_by: MadeBy,
}

impl Exported {
    /// In the exchange format.
    ///
    /// # Errors
    /// When the apparatus cannot be built.
    pub fn scene(&self) -> Result<Scene, ApparatusError> {
        Scene::of(&self.setup, &self.specimen, self.next_motion.as_ref(), self.made_by.clone())
    }
}

/// Reads a run folder as `pluvia run`, `reproduce` and `compare` write it.
/// `stage` is a stage's number from 0, its name, where one stage alone has it, or
/// `rest_test`; without it, the last stage is taken.
///
/// # Errors
/// [`ExportError`], naming the file or what was asked for.
pub fn read_run(folder: &Path, stage: Option<&str>) -> Result<Exported, ExportError> {
    let manifest = Manifest::of(folder)?;
    let setup = manifest.setup()?;
    let set = manifest.grains()?;
    let (number, name, state) = match stage {
        None => {
            let file = folder.join("specimen.json");
            let state: SpecimenState = manifest.read(&file)?;
            state.check(set.grains.len()).map_err(|reason| FileError::unfit(&file, reason))?;
            let name = manifest.stages.last().map_or_else(String::new, |s| s.stage.clone());
            (Some(manifest.stages.len().saturating_sub(1)), name, state)
        }
        Some(asked) => {
            let (number, name, entry) = manifest.find(asked)?;
            (number, name, manifest.state(entry, &set)?)
        }
    };
    let next_motion =
        number.and_then(|n| manifest.scenario.stages.get(n + 1)).and_then(StageSpec::motion);
    let made_by = MadeBy {
        program: format!("pluvia {}", manifest.pluvia),
        scenario: manifest.scenario.name,
        stage: name,
        time_s: state.time,
    };
    let specimen = Specimen { grains: Arc::new(set), state };
    Ok(Exported { setup, specimen, next_motion, made_by })
}

/// The run's specimen at rest: at the end of its rest test or, where it has none, of its
/// last stage. The run's own specimen must be as it was written either way.
///
/// # Errors
/// [`ExportError`], naming the file.
pub fn read_at_rest(folder: &Path) -> Result<Exported, ExportError> {
    let last = read_run(folder, None)?;
    stage_at_rest(folder)?.map_or(Ok(last), |asked| read_run(folder, Some(asked)))
}

/// How the stage is asked for at whose end a run's specimen is at rest, where that is not its last.
///
/// # Errors
/// [`ExportError`], naming the file.
pub fn stage_at_rest(folder: &Path) -> Result<Option<&'static str>, ExportError> {
    Ok(Manifest::of(folder)?.rest_test.is_some().then_some(REST_TEST))
}

/// What a folder is that has no manifest.
fn without_manifest(folder: &Path) -> String {
    let grains = folder.join("grains.json");
    let what = match () {
        () if folder.join("unfinished.json").is_file() => {
            "its run is not finished; run the same command again to resume"
        }
        () if folder.join("runs").is_dir() => "it holds several runs; name one in its `runs`",
        () if grains.is_file() && !folder.join("specimen.json").exists() => {
            let file = plain_path(&grains);
            let file = in_shell(&file);
            return format!(
                "it holds grains alone, of which no run was made: `pluvia picture {file} --out \
                 grains.png` shows them, and `pluvia run` with their scenario makes a run"
            );
        }
        () => "it is no folder of a run: it has no manifest.json",
    };
    what.to_owned()
}

/// Refuses what is there and is no folder of a finished run.
///
/// # Errors
/// [`FileError`], refused, with what it is.
pub fn refuse_no_run(folder: &Path) -> Result<(), FileError> {
    refuse_without(folder, MANIFEST, &without_manifest(folder))
}

/// Why a manifest of this text cannot be read: an earlier version may have written it.
fn unreadable(path: &Path, text: &[u8], error: serde_json::Error) -> FileError {
    let value: Value = serde_json::from_slice(text).unwrap_or_default();
    match scenario::of_earlier_version(&value["scenario"]) {
        Some(why) => FileError::unfit(path, why),
        None => FileError::malformed(path, error),
    }
}

impl Manifest {
    /// That of a run folder. Its scenario is one that can be run:
    /// whoever reads it builds its laboratory.
    pub(super) fn of(folder: &Path) -> Result<Self, FileError> {
        refuse_no_run(folder)?;
        let path = folder.join(MANIFEST);
        let text = read_file(&path)?;
        let manifest: Result<Self, _> = serde_json::from_slice(&text);
        let manifest = manifest.map_err(|error| unreadable(&path, &text, error))?;
        if let Err(found) = scenario::check(&manifest.scenario) {
            let faults: Vec<String> = found.faults().iter().map(ToString::to_string).collect();
            return Err(FileError::unfit(&path, faults.join("; ")));
        }
        Ok(Self { folder: folder.to_owned(), ..manifest })
    }

    pub(super) fn setup(&self) -> Result<Setup, ExportError> {
        Setup::new(&self.scenario).map_err(|reason| ExportError::apparatus(&self.folder, reason))
    }

    /// A file or folder that runs of one command share.
    fn shared(&self, name: &str) -> Result<PathBuf, FileError> {
        let path = run_file(&self.folder, name);
        match path.try_exists() {
            Ok(false) => {
                let why = "it is not there; runs of a study have it beside their folder `runs`, \
                           and are read there alone";
                Err(FileError::new("read", &path, why))
            }
            _ => Ok(path),
        }
    }

    pub(super) fn grains(&self) -> Result<GrainSet, FileError> {
        let path = self.shared("grains.json")?;
        let json = self.read(&path)?;
        grains::from_json(&json).map_err(|e| FileError::unfit(&path, e))
    }

    /// The state at the end of a stage, which has as many bodies as there are grains.
    pub(super) fn state(
        &self,
        entry: &StageEntry,
        grains: &GrainSet,
    ) -> Result<SpecimenState, FileError> {
        let root = self.shared("stages")?;
        let (_, state, path) = StageStore::stage_in(&root, &entry.key, &entry.specimen_sha256)?;
        state.check(grains.grains.len()).map_err(|reason| FileError::unfit(&path, reason))?;
        Ok(state)
    }

    /// The same, and the frames that were kept of the stage, none where none were. They have as
    /// many grains as there are.
    pub(super) fn stage(
        &self,
        entry: &StageEntry,
        grains: &GrainSet,
        read: FramesRead,
    ) -> Result<(SpecimenState, Option<Vec<Frame>>), FileError> {
        let end = self.state(entry, grains)?;
        let root = run_file(&self.folder, "stages");
        let kept = StageStore::frames_in(&root, &entry.key, read)?;
        let Some((mut frames, path)) = kept else { return Ok((end, None)) };
        let expected = grains.grains.len();
        if let Some(other) = frames.iter().find(|frame| frame.grains.len() != expected) {
            let found = counted(other.grains.len(), "grain");
            let reason = format!("it has {found}, and grains.json {expected}");
            return Err(FileError::unfit(&path, reason));
        }
        let base = end.base.clone().map(Arc::new);
        frames.iter_mut().for_each(|frame| frame.base.clone_from(&base));
        Ok((end, Some(frames)))
    }

    /// Reads a file of the run that must be as it was written.
    fn read<T: DeserializeOwned>(&self, path: &Path) -> Result<T, FileError> {
        let name = path.file_name().and_then(|n| n.to_str()).unwrap_or_default();
        let sha256 = self.files_sha256.get(name).map_or("", String::as_str);
        let content = read_unchanged(path, sha256)?;
        serde_json::from_slice(&content).map_err(|e| FileError::malformed(path, e))
    }

    /// The stage of a number or name: its number, which the rest test has none of, and its name.
    pub(super) fn find(
        &self,
        asked: &str,
    ) -> Result<(Option<usize>, String, &StageEntry), ExportError> {
        if let (REST_TEST, Some(entry)) = (asked, &self.rest_test) {
            return Ok((None, REST_TEST.to_owned(), entry));
        }
        let names = self.stages.iter().map(|s| s.stage.as_str());
        let also = self.rest_test.as_ref().map(|_| REST_TEST);
        let number = MeantStage::one(asked, names, also).map_err(|reason| {
            let manifest = self.folder.join(MANIFEST);
            ExportError::Stage { manifest, reason }
        })?;
        let entry = &self.stages[number];
        Ok((Some(number), entry.stage.clone(), entry))
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    /// Law: a manifest of an earlier version is refused with the names of today, another one that
    /// cannot be read with what its parser says.
    #[test]
    fn manifests_of_earlier_versions_are_known() {
        let folder = tempfile::tempdir().expect("a folder");
        for (engine, said) in [
            (json!({ "contact_path": "bullet" }), "now called `engine.contact_solver`"),
            (json!({ "contact_road": "bullet" }), "unknown field `contact_road`"),
        ] {
            let scenario = json!({
                "name": "a", "grains": { "file": "grains.json" }, "engine": engine,
                "stages": [{ "stage": "fill_funnel" }],
            });
            let manifest = json!({ "pluvia": "0.1.0", "scenario": scenario, "stages": [] });
            let path = folder.path().join(MANIFEST);
            std::fs::write(&path, manifest.to_string()).expect("written");
            let refused = read_run(folder.path(), None).expect_err("law: refused").to_string();
            assert!(refused.contains(said), "law: `{said}` is said, got `{refused}`");
        }
    }
}
