//! What pages quote of tables of many runs, on made-up tables of known answer.

use std::fs;

use serde_json::json;

use super::{Results, list, tables};

/// The results of a tree with one file, made of these lines.
fn with(file: &str, text: &str) -> (tempfile::TempDir, Results) {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join(list::FOLDER).join(file);
    fs::create_dir_all(path.parent().expect("a folder")).expect("made");
    fs::write(path, text).expect("written");
    let results = Results::of(folder.path());
    (folder, results)
}

/// Law: the interval of a coefficient's angle is of the piles that have one and count.
#[test]
fn a_calibration_counts_the_piles_of_its_means() {
    let value = |value: f64, left_out: u32| {
        json!({ "value": value, "runs": 5, "failed": 1, "left_out": left_out, "mean": 41.7,
            "half_width_95": 1.5 })
    };
    let found = json!({ "values": [value(1.0, 0), value(1.5, 2)] });
    let (_folder, results) = with("calibration/calibrate.json", &found.to_string());
    let text = tables::named("calibration", &results).expect("a table");
    let ends: Vec<&str> = text.lines().skip(2).filter_map(|row| row.rsplit('°').next()).collect();
    assert_eq!(ends, [" | 4 |", " | 2 |"], "law: runs less failed less left out, got {text}");
}
