//! A finished stage: what it says of itself, its files, and when it is believed.

use super::*;
use crate::world::EffectiveSettings;

pub(super) const RECORD_FILE: &str = "stage.json";
pub(super) const STATE_FILE: &str = "specimen.json";
pub(super) const SERIES_FILE: &str = "series.csv";

/// `stage.json`: what a finished stage says of itself.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StageRecord {
    /// Which stage it is; none where it was stored before this was recorded.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub identity: Option<StageIdentity>,
    /// SHA-256 of the `specimen.json` that it began with; none for the first stage of a run.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub began_with_sha256: Option<String>,
    /// Folder of the run with whose specimen it began, where that is another one; none of a stage
    /// that goes on from one of its own run, and where it was stored before this was recorded.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub begun_in: Option<String>,
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
    /// What its checks found; none where the stage was stored before this was recorded.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub checks: Option<StageChecks>,
    /// Solver residuals, one a look; empty of an engine that does not say.
    #[serde(default)]
    pub solver_residuals: Vec<f64>,
    /// Engine settings as read back.
    pub effective: EffectiveSettings,
    /// Smallest square opening in mm that each grain passes with the shape that the engine held at
    /// the end, in the order of the grain set; null for a grain that was not there; empty where the
    /// engine cannot be asked, or the stage was stored before this was recorded.
    #[serde(default)]
    pub sieved_mm: Vec<Option<f64>>,
    /// How a pour, a pile, a plate or a vibration came to rest; none of another stage, and of all
    /// but vibrations where the stage was stored before this was recorded.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub settling: Option<Settling>,
    /// How far grains sank that were let go above a surface; none of another stage.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fall: Option<Fall>,
    /// What came of the condition that was to end it; none of a stage without `until`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub until: Option<UntilFound>,
    /// Heights of the mean surface in mm when the first vibration began, and of the plate when the
    /// first began with one; none before.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub before_vibration_mm: Option<(Option<f64>, f64)>,
    /// How far grains sank in rests in which some left or came; empty where none did, and where the
    /// stage was stored before this was recorded.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub sunk: Vec<Sunk>,
    /// What was observed of a laboratory of pieces, beside the rows of the series.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub laboratory: Vec<LaboratoryRow>,
    /// Energy at the rows of the series; empty where the stage was stored before this was recorded.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub energy: Vec<EnergyRow>,
    /// What the specimen was at the end; none where it was stored before this was recorded.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub end: Option<StageEnd>,
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
    /// SHA-256 of the rest of it.
    pub(super) fn own_hash(&self) -> String {
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

/// Which stage is asked of the store, and what it must be to be believed.
#[derive(Clone, Copy)]
pub struct AskedStage<'a> {
    /// What it is.
    pub identity: &'a StageIdentity,
    /// SHA-256 of the specimen that it begins with, as the stage before was
    /// stored; none for the first of a run.
    pub began_with: Option<&'a str>,
    /// Whether what was found can be the end of this stage; why it cannot.
    pub plausible: &'a dyn Fn(&StoredStage) -> Result<(), String>,
}

/// What a stage says of itself, if that is as it was written.
pub(super) fn read_record(folder: &Path) -> Result<StageRecord, FileError> {
    let path = folder.join(RECORD_FILE);
    let record: StageRecord = read_json(&path)?;
    // Only stages of earlier versions say neither what they are nor what they hold.
    let noted = !record.record_sha256.is_empty() || record.identity.is_some();
    if noted && record.record_sha256 != record.own_hash() {
        return Err(FileError::changed(&path));
    }
    Ok(record)
}

/// The same of a stage that must be the one of a key. One of an earlier version does not say.
pub(super) fn read_record_of(folder: &Path, key: &str) -> Result<StageRecord, FileError> {
    let record = read_record(folder)?;
    if let Some(identity) = &record.identity {
        let own = if identity.key == key {
            identity.check()
        } else {
            Err(format!("it is another stage: its key is {}", short(&identity.key)))
        };
        own.map_err(|why| FileError::unfit(&folder.join(RECORD_FILE), why))?;
    }
    Ok(record)
}

/// The files that a record speaks of, if they are as they were written.
pub(super) fn read_stage(
    folder: &Path,
    record: StageRecord,
    frames: bool,
) -> Result<StoredStage, FileError> {
    let path = folder.join(SERIES_FILE);
    let content = read_unchanged(&path, &record.series_sha256)?;
    let series = series_from_csv(&content).map_err(|e| FileError::malformed(&path, e))?;
    let state = read_state(folder, &record)?;
    if frames && !record.frames_sha256.is_empty() {
        let path = folder.join(FRAMES_FILE);
        let found = hash_file(&path).map_err(|e| FileError::unread(&path, &e))?;
        if found != record.frames_sha256 {
            return Err(FileError::changed(&path));
        }
    }
    Ok(StoredStage { record, state, series })
}

/// The state at the end of a stage, which has as many bodies as it says.
pub(super) fn read_state(folder: &Path, record: &StageRecord) -> Result<SpecimenState, FileError> {
    let path = folder.join(STATE_FILE);
    let content = read_unchanged(&path, &record.specimen_sha256)?;
    let state: SpecimenState =
        serde_json::from_slice(&content).map_err(|e| FileError::malformed(&path, e))?;
    let found = state.bodies.len();
    match &record.identity {
        Some(identity) if identity.grains != found => {
            let (found, grains) = (counted(found, "body"), counted(identity.grains, "grain"));
            let why = format!("it has {found}, and the stage {grains}");
            Err(FileError::unfit(&path, why))
        }
        _ => Ok(state),
    }
}
