//! What runs of laboratories say of their specimen: of a surface that they do not have, and of
//! grains that are not there.

use std::fs;

use serde_json::{Value, json};

use super::program::{Folder, done};

/// Thirty grains that rain into a box, with more or other fields of the deposit; null takes one away.
fn boxed(deposit: &Value) -> Value {
    let mut stage = json!({ "stage": "deposit", "at_mm": [0, 0, 60], "area_mm": [50, 50],
        "rate_g_per_s": 150 });
    for (field, value) in deposit.as_object().expect("fields") {
        stage[field] = value.clone();
    }
    stage.as_object_mut().expect("a stage").retain(|_, value| !value.is_null());
    json!({
        "name": "boxed",
        "grains": {
            "total_mass_g": 30, "density_kg_per_m3": 2650,
            "sieve_table": [{ "passing_mm": 10, "retained_mm": 8, "mass_percent": 100 }]
        },
        "pieces": [{ "name": "box", "shape": { "box": { "inner_mm": [60, 60, 60] } } }],
        "stages": [stage],
        "rest_test_s": 0.3
    })
}

/// Runs a scenario; its summary, and what is printed of it.
fn ran(folder: &Folder, name: &str, scenario: &Value) -> (Value, String) {
    let file = folder.scenario(&format!("{name}.json"), scenario);
    let printed = done(&["run", &file, "--out", &folder.out(name), "--jobs", "1"]);
    (folder.json(&format!("{name}/summary.json")), printed)
}

/// Law: pieces have no floor of their own, and so no mean surface above it: what would be 0 in
/// every row is empty, null, and no curve.
#[test]
fn a_laboratory_has_no_mean_surface_over_time() {
    let folder = Folder::new();
    let (summary, _) = ran(&folder, "out", &boxed(&json!({})));
    let mut rows = csv::Reader::from_path(folder.path("out/series.csv")).expect("series.csv");
    let names = rows.headers().expect("names").clone();
    let column = names.iter().position(|name| name == "mean_surface_mm");
    let column = column.expect("law: the column stays");
    let cells: Vec<String> =
        rows.records().map(|row| row.expect("a row")[column].to_owned()).collect();
    assert!(!cells.is_empty() && cells.iter().all(String::is_empty), "law: empty, got {cells:?}");
    assert_eq!(summary["rest_test"]["mean_surface_drop_mm"], Value::Null, "law: no drop of it");
    let figure = fs::read_to_string(folder.path("out/figures/heights.svg")).expect("a figure");
    assert!(!figure.contains("Mean surface"), "law: no curve of what is not measured");
    assert!(figure.contains("Mean height of the grains"), "law: what is measured is drawn");
    // The circle about the corners of the box has 57 cm², and the grains have 11.3 cm³.
    let height = summary["standing_height_mm"]["mean_surface"].as_f64().expect("a height");
    assert!(height > 2.0, "law: as high as their solids over the area at least, got {height} mm");
}
