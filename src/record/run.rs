//! A finished run as claims and reports see it.

use super::*;

/// A file or folder that several runs of one command share: in the run's folder, or in the one
/// that holds `runs/`.
pub fn run_file(folder: &Path, name: &str) -> PathBuf {
    let own = folder.join(name);
    let shared = folder.join("../..").join(name);
    if !own.exists() && shared.exists() { shared } else { own }
}

/// What a run is in the paper's programme.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RunKind {
    /// Grains poured into the cylinder (paper, section 2, Figure 7).
    Pluviation,
    /// One period of vibration (paper, Figure 9).
    VibrationContinuous,
    /// Several periods of vibration with rests (paper, Figure 10).
    VibrationIntermittent,
    /// One period of vibration of a specimen under a plate that was laid on it anew.
    VibrationPlacement,
    /// A pile of grains on a rough base (paper, section 2, Figure 2).
    Repose,
}

impl RunKind {
    /// Whether it is one of the programme's own vibrations, not one more placement of the plate.
    pub fn is_vibration(self) -> bool {
        matches!(self, Self::VibrationContinuous | Self::VibrationIntermittent)
    }
}

/// One finished run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RunRecord {
    /// Name of its folder.
    pub name: String,
    /// What it is in the paper's programme.
    pub kind: RunKind,
    /// Which realisation, counted from 1.
    pub configuration: u32,
    /// Distance between funnel and cylinder in mm.
    pub falling_height_mm: f64,
    /// Its figures.
    pub summary: Summary,
    /// Its series, stage by stage.
    pub series: Vec<SeriesRow>,
    /// The rows of its rest test, the finished specimen left alone; empty where none was run.
    pub rest_test: Vec<SeriesRow>,
}
