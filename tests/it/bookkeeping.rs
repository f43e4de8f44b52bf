//! What passes openings, when stages count as settled, and what becomes of grains that lose what
//! carried them, in laboratories of pieces.

use std::process::Command;

use serde_json::{Value, json};

/// Runs a scenario of grains of 8 to 10 mm in pieces; its `summary.json` and the last row of a
/// column of `series.csv`.
fn run(mass_g: f64, pieces: Value, measures: Value, stages: Value) -> (Value, Vec<Vec<String>>) {
    let folder = tempfile::tempdir().expect("a folder");
    let scenario = json!({
        "name": "bookkeeping",
        "grains": {
            "total_mass_g": mass_g,
            "density_kg_per_m3": 2650,
            "sieve_table": [{ "passing_mm": 10, "retained_mm": 8, "mass_percent": 100 }]
        },
        "pieces": pieces,
        "measures": measures,
        "stages": stages,
        "rest_test_s": 0
    });
    let file = folder.path().join("scenario.json");
    std::fs::write(&file, scenario.to_string()).expect("a scenario");
    let out = folder.path().join("out");
    let mut command = Command::new(env!("CARGO_BIN_EXE_pluvia"));
    command.arg("run").arg(&file).arg("--out").arg(&out).args(["--quiet", "--no-figures"]);
    let ended = command.output().expect("it starts");
    assert!(ended.status.success(), "{}", String::from_utf8_lossy(&ended.stderr));
    let summary = std::fs::read(out.join("summary.json")).expect("a summary");
    let series = csv::Reader::from_path(out.join("series.csv")).expect("a series");
    let rows = |mut series: csv::Reader<std::fs::File>| -> Vec<Vec<String>> {
        let head = series.headers().expect("a head").clone();
        let all = std::iter::once(head).chain(series.records().map(|r| r.expect("a row")));
        all.map(|r| r.iter().map(str::to_owned).collect()).collect()
    };
    (serde_json::from_slice(&summary).expect("JSON"), rows(series))
}

/// A number of a column in the last row.
fn last(rows: &[Vec<String>], column: &str) -> f64 {
    let place = rows[0].iter().position(|name| name == column);
    let place = place.unwrap_or_else(|| panic!("no column {column} in {:?}", rows[0]));
    rows[rows.len() - 1][place].parse().unwrap_or(f64::NAN)
}

/// Simulated time in s of a stage, by its number.
fn took(rows: &[Vec<String>], stage: usize) -> f64 {
    let place = |column: &str| rows[0].iter().position(|name| name == column).expect("a column");
    let (time, of) = (place("time_s"), place("stage"));
    let times = rows[1..].iter().filter(|row| row[of] == stage.to_string());
    let times: Vec<f64> = times.map(|row| row[time].parse().expect("a time")).collect();
    times.last().zip(times.first()).map_or(f64::NAN, |(last, first)| last - first)
}

fn holder() -> Value {
    json!({ "name": "box", "shape": { "box": { "inner_mm": [50, 50, 100] } } })
}

fn lid() -> Value {
    json!({ "name": "lid", "shape": { "plate": { "size_mm": [48, 48, 10] } }, "at_mm": [0, 0, 130] })
}

fn rain(rate: f64) -> Value {
    json!({ "stage": "deposit", "at_mm": [0, 0, 90], "area_mm": [40, 40], "rate_g_per_s": rate })
}

/// Law: all grains that fall through an opening are counted, also where they were let go so near
/// it that they pass before the next look.
#[test]
fn openings_near_the_rain_count_every_grain() {
    let opening =
        |z: f64| json!({ "name": format!("z{z}"), "at_mm": [0, 0, z], "diameter_mm": 80 });
    let measures = json!({ "openings": [opening(89.0), opening(85.0), opening(60.0)] });
    let (summary, _) = run(30.0, json!([holder()]), measures, json!([rain(200.0)]));
    for opening in summary["laboratory"]["openings"].as_array().expect("openings") {
        let got = opening["passed_g"].as_f64().expect("a mass");
        let expected = summary["grains"]["mass_g"].as_f64().expect("a mass");
        let name = &opening["name"];
        assert!((got / expected - 1.0).abs() < 1e-9, "law: {name}: expected {expected}, got {got}");
    }
}

/// Law: a stage that presses ends when grains bear the piece, be the force ever so small for its
/// mass.
#[test]
fn a_press_ends_when_grains_bear_the_piece() {
    let press =
        json!({ "stage": "press", "loads": [{ "piece": "lid", "force_n": 0.1, "mass_g": 1000 }] });
    let stages = json!([rain(400.0), press, { "stage": "rest", "duration_s": 0.5 }]);
    let (_, rows) = run(30.0, json!([holder(), lid()]), json!({}), stages);
    let got = last(&rows, "lid_force_z_n");
    assert!((got - 0.1).abs() < 0.02, "law: grains push up with 0.1 N, got {got}, tolerance 0.02");
}

/// Law: nothing has settled while a released piece slides, however many grains lie still.
#[test]
fn a_piece_that_slides_has_not_settled() {
    let (angle, half) = (20.0_f64.to_radians(), 150.0);
    let height = 2.0 * half * angle.tan();
    // Its lower face lies on the slope.
    let middle = [half - 50.0, 0.0, height - 50.0 * angle.tan()];
    let at = [middle[0] - 5.3 * angle.sin(), 0.0, middle[2] + 5.3 * angle.cos()];
    let pieces = json!([
        { "name": "wedge", "friction": 0.3,
          "shape": { "wedge": { "size_mm": [2.0 * half, 60, height] } } },
        { "name": "block", "shape": { "plate": { "size_mm": [40, 40, 10] } },
          "rotation_deg": [0, -20, 0], "at_mm": at },
        { "name": "bin", "shape": { "box": { "inner_mm": [50, 50, 60] } }, "at_mm": [0, 200, -20] }
    ]);
    let stages = json!([
        { "stage": "deposit", "at_mm": [0, 200, 60], "area_mm": [30, 30], "rate_g_per_s": 400 },
        { "stage": "release", "pieces": ["block"], "time_limit_s": 1.0 }
    ]);
    let (_, rows) = run(30.0, pieces, json!({}), stages);
    let took = took(&rows, 1);
    assert!(took > 0.5, "law: it slides for longer than 0.5 s, took {took} s");
}

/// Law: grains whose lowest support is taken away fall out, and are counted.
#[test]
fn grains_of_a_tray_that_is_gone_have_fallen_out() {
    let pieces = json!([
        { "name": "hopper", "at_mm": [0, 0, 150], "shape": { "hopper": {
            "opening_diameter_mm": 60, "top_diameter_mm": 100, "half_angle_deg": 20, "collar_mm": 30
        } } },
        { "name": "tray", "shape": { "box": { "inner_mm": [120, 120, 40] } } }
    ]);
    let stages = json!([
        { "stage": "deposit", "at_mm": [0, 0, 240], "diameter_mm": 80, "rate_g_per_s": 400 },
        { "stage": "remove", "pieces": ["tray"] }
    ]);
    let (summary, rows) = run(30.0, pieces, json!({}), stages);
    let grains = &summary["grains"];
    assert_eq!(grains["spilled"], grains["count"], "law: all of them, {grains}");
    let took = took(&rows, 1);
    assert!(took < 5.0, "law: where nothing is left to settle the stage ends, took {took} s");
}
