//! Recorded motions: what a scenario names as a file is put into it as rows, so that the rows
//! determine a stage, and a run folder holds what was done.

use super::*;
use crate::motion::{RowFault, rows_from_csv};

/// Largest file of a recorded motion in bytes: more than its rows can have.
const LARGEST: u64 = 16 << 20;

/// Reads the motion files that a document names, each relative to the file that names it, into
/// rows beside which nothing is left of the name; the faults of those that cannot be read.
pub(super) fn read(document: &mut Document) -> Vec<Fault> {
    let mut faults = Vec::new();
    let count = document.value["stages"].as_array().map_or(0, Vec::len);
    for i in 0..count {
        let path = format!("stages[{i}].motion_file");
        let stage = &document.value["stages"][i];
        let of_piece = stage["stage"] == "move";
        let is_recorded = of_piece || stage["stage"] == "vibrate" && stage["waveform"] == "file";
        // Both together are refused by the checks.
        let is_read = is_recorded && stage.get("motion_rows").is_none();
        let name = stage["motion_file"].as_str().filter(|name| is_read && !name.is_empty());
        let Some(name) = name else { continue };
        let file = document.folder(&path).join(name);
        match rows_of(&file, of_piece) {
            Ok(rows) => {
                if let Some(stage) = document.value["stages"][i].as_object_mut() {
                    stage.shift_remove("motion_file");
                    stage.insert("motion_rows".to_owned(), json!(rows));
                }
            }
            Err(found) => {
                faults.extend(found.into_iter().map(|f| document.with_origin(f.at(&path))));
            }
        }
    }
    faults
}

/// The rows of a file, of a piece's motion or a table's; or what is wrong with it.
fn rows_of(file: &Path, of_piece: bool) -> Result<Vec<[f64; 4]>, Vec<Fault>> {
    const COLUMNS: &str = "the columns time_s and x_mm, optionally y_mm and z_mm";
    let shown = file.display();
    let content = input::read(file, LARGEST).map_err(|error| {
        let message = format!("the recorded motion cannot be read: {error}");
        vec![Fault::new(message, &shown, "a CSV file")]
    })?;
    let of_table = |message| Fault::new(message, &shown, COLUMNS);
    let rows = rows_from_csv(&content)
        .map_err(|found| found.into_iter().map(of_table).collect::<Vec<Fault>>())?;
    // Here the faults can name the file.
    let of_row =
        |row: RowFault| Fault::new(format!("{shown}: {}", row.what), row.found, row.allowed);
    let motion = match of_piece {
        true => RecordedMotion::of_piece(&rows, Interpolation::Cubic),
        false => RecordedMotion::new(&rows, Interpolation::Cubic),
    };
    motion.map_err(|found| found.into_iter().map(of_row).collect::<Vec<Fault>>())?;
    Ok(rows)
}
