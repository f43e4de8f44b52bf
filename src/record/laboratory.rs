//! What is recorded of a laboratory of pieces: loads, flows, void ratios.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// One moment of a laboratory, beside a row of the series.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LaboratoryRow {
    /// Of each piece, in the order of the scenario; null for one that is removed.
    pub pieces: Vec<Option<PieceRow>>,
    /// Mass in g that went through each opening since the row before.
    pub passed_g: Vec<f64>,
    /// Void ratio in each region; null where no grain is.
    pub void_ratios: Vec<Option<f64>>,
}

/// A piece at a moment.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct PieceRow {
    /// Where the origin of its frame is, in mm.
    pub at_mm: [f64; 3],
    /// Force of the grains on it in N, mean since the row before.
    pub force_n: [f64; 3],
    /// Moment of that force about the origin of its frame in N m.
    pub moment_n_m: [f64; 3],
}

/// Rows of a stage so far, and what has passed since the last of them.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct LaboratorySeries {
    /// The rows.
    pub rows: Vec<LaboratoryRow>,
    /// Mass in g through each opening since the last row.
    pub pending_g: Vec<f64>,
}

impl LaboratorySeries {
    /// Whether it holds nothing.
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }
}

/// `laboratory` in `summary.json`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct LaboratorySummary {
    /// The pieces, in the order of the scenario.
    pub pieces: Vec<PieceSummary>,
    /// All that the pieces carry against all that the grains weigh.
    pub balance: Balance,
    /// Flow through openings.
    pub openings: Vec<OpeningSummary>,
    /// Void ratios of regions at the end.
    pub regions: Vec<RegionSummary>,
}

/// A piece at the end.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PieceSummary {
    /// Its name.
    pub name: String,
    /// Whether it still stands.
    pub present: bool,
    /// Force of the grains on it in N: mean of the second half of the rest at the end where
    /// one is run, or else of the last sample interval.
    pub force_n: [f64; 3],
    /// Moment about the origin of its frame in N m, likewise.
    pub moment_n_m: [f64; 3],
    /// Where the origin of its frame is, in mm.
    pub at_mm: [f64; 3],
}

/// Whether forces are complete: at rest the pieces carry the weight of the grains.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Balance {
    /// Weight of the grains that are present, in N.
    pub weight_n: f64,
    /// Downward force on all pieces together, in N.
    pub carried_n: f64,
    /// Horizontal force on all pieces together, in N: 0 at rest.
    pub sideways_n: f64,
    /// Carried over weight less 1, in percent; null without grains.
    pub difference_percent: Option<f64>,
}

/// Flow through an opening.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct OpeningSummary {
    /// Its name.
    pub name: String,
    /// Mass that went through in its direction, less what came back, in g.
    pub passed_g: f64,
    /// Mean rate between the moments at which a tenth and nine tenths had passed, in g/s;
    /// null where nothing did.
    pub rate_g_per_s: Option<f64>,
}

/// A region at the end.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct RegionSummary {
    /// Its name.
    pub name: String,
    /// Its void ratio; null where no grain is.
    pub void_ratio: Option<f64>,
    /// Its relative density, 0 of the loosest and 1 of the densest state, where the scenario
    /// gives `index_densities`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub relative_density: Option<f64>,
}

/// Adds the columns of a laboratory to a table that has a row for each of its rows: of every
/// piece place, force and moment, of every opening what passed since the row before, and of
/// every region the void ratio.
///
/// # Errors
/// The reader's and the writer's; there are none of what this program wrote.
pub fn with_laboratory(
    table: &[u8],
    names: [&[String]; 3],
    rows: &[LaboratoryRow],
) -> Result<Vec<u8>, csv::Error> {
    let [pieces, openings, regions] = names;
    let mut reader = csv::Reader::from_reader(table);
    let mut writer = csv::Writer::from_writer(Vec::new());
    let mut header = reader.headers()?.clone();
    for name in pieces {
        let of = |quantity: &str, unit: &str| {
            ["x", "y", "z"].map(|k| format!("{name}{quantity}_{k}_{unit}"))
        };
        for column in of("", "mm").into_iter().chain(of("_force", "n")).chain(of("_moment", "n_m"))
        {
            header.push_field(&column);
        }
    }
    openings.iter().for_each(|name| header.push_field(&format!("{name}_passed_g")));
    regions.iter().for_each(|name| header.push_field(&format!("{name}_void_ratio")));
    writer.write_record(&header)?;
    for (n, record) in reader.records().enumerate() {
        let mut record = record?;
        let row = rows.get(n);
        for k in 0..pieces.len() {
            let piece = row.and_then(|row| row.pieces.get(k).copied().flatten());
            let numbers = piece.map(|p| [p.at_mm, p.force_n, p.moment_n_m]);
            for k in 0..9 {
                let number = numbers.map(|n| n[k / 3][k % 3].to_string());
                record.push_field(&number.unwrap_or_default());
            }
        }
        for k in 0..openings.len() {
            let passed = row.and_then(|row| row.passed_g.get(k));
            record.push_field(&passed.map(f64::to_string).unwrap_or_default());
        }
        for k in 0..regions.len() {
            let ratio = row.and_then(|row| row.void_ratios.get(k).copied().flatten());
            record.push_field(&ratio.map(|e| e.to_string()).unwrap_or_default());
        }
        writer.write_record(&record)?;
    }
    writer.into_inner().map_err(|e| e.into_error().into())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Pose;
    use crate::record::{FrameWriter, frames::read_frames};
    use crate::specimen::{PieceState, SpecimenState};

    #[test]
    fn frames_hold_pieces_after_the_grains() {
        let folder = tempfile::tempdir().expect("a folder");
        let mut frames = FrameWriter::new(folder.path(), 3, 2).expect("a file");
        let mut state = SpecimenState::before_everything(3);
        let piece = PieceState::standing(Pose::translation(0.25, 0.0, -0.5));
        state.pieces = vec![piece, PieceState { present: false, ..piece }];
        frames.add(&state, 1.5);
        frames.add(&state, 2.5);
        let path = folder.path().join("frames.bin");
        let hash = frames.keep(&path).expect("kept");
        let read = read_frames(&path, &hash).expect("read");
        assert_eq!(read.len(), 2, "law: as many as written");
        assert_eq!((read[1].grains.len(), read[1].time), (3, 2.5));
        assert_eq!(read[1].pieces, [Some(piece.pose), None], "law: where it is; one was removed");
    }

    #[test]
    fn columns_are_added_row_by_row_and_what_is_missing_is_empty() {
        let piece =
            PieceRow { at_mm: [1.0, 2.0, 3.0], force_n: [0.0, 0.0, -5.5], moment_n_m: [0.0; 3] };
        let row = |there: bool| LaboratoryRow {
            pieces: vec![there.then_some(piece)],
            passed_g: vec![2.5],
            void_ratios: vec![None],
        };
        let names = [vec!["box".to_owned()], vec!["mouth".to_owned()], vec!["core".to_owned()]];
        let names = [&names[0][..], &names[1], &names[2]];
        let got = with_laboratory(b"time_s\n0\n1\n", names, &[row(true), row(false)]).expect("CSV");
        let expected = "time_s,box_x_mm,box_y_mm,box_z_mm,box_force_x_n,box_force_y_n,box_force_z_n,\
             box_moment_x_n_m,box_moment_y_n_m,box_moment_z_n_m,mouth_passed_g,core_void_ratio\n\
             0,1,2,3,0,0,-5.5,0,0,0,2.5,\n1,,,,,,,,,,2.5,\n";
        assert_eq!(String::from_utf8(got).expect("text"), expected);
    }
}
