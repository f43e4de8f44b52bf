//! What passes openings, when stages count as settled, and what becomes of grains that lose what
//! carried them, in laboratories of pieces.

use serde_json::{Value, json};

use super::{
    program::{Folder, column, done},
    small,
};

/// What a run of thirty grams of grains in pieces leaves: a folder with `summary.json` and
/// `series.csv` in `out`.
fn run(pieces: Value, measures: Value, stages: Value) -> Folder {
    let folder = Folder::new();
    let scenario = json!({
        "name": "bookkeeping",
        "grains": small::fine(30.0),
        "pieces": pieces,
        "measures": measures,
        "stages": stages,
        "rest_test_s": 0
    });
    let file = folder.scenario("scenario.json", &scenario);
    done(&["run", &file, "--out", &folder.out("out"), "--quiet", "--no-figures"]);
    folder
}

/// Simulated time in s of a stage, by its number.
fn took(ran: &Folder, stage: f64) -> f64 {
    let [stages, times] = ["stage", "time_s"].map(|of| column(&ran.path("out/series.csv"), of));
    let of_stage = stages.iter().zip(times).filter(|(of, _)| **of == stage);
    let times: Vec<f64> = of_stage.map(|(_, time)| time).collect();
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
    let ran = run(json!([holder()]), measures, json!([rain(200.0)]));
    let summary = ran.json("out/summary.json");
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
    let ran = run(json!([holder(), lid()]), json!({}), stages);
    // So heavy a lid goes on swinging on so light a load.
    let [stages, forces] =
        ["stage", "lid_force_z_n"].map(|of| column(&ran.path("out/series.csv"), of));
    let at_rest = stages.iter().zip(forces).filter(|(of, _)| **of == 2.0).map(|(_, force)| force);
    let at_rest: Vec<f64> = at_rest.collect();
    let got = at_rest.iter().sum::<f64>() / at_rest.len() as f64;
    assert!(
        (got - 0.1).abs() < 0.02,
        "law: grains push up with 0.1 N in the mean, got {got}, tolerance 0.02"
    );
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
    let took = took(&run(pieces, json!({}), stages), 1.0);
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
    let ran = run(pieces, json!({}), stages);
    let grains = &ran.json("out/summary.json")["grains"];
    assert_eq!(grains["spilled"], grains["count"], "law: all of them, {grains}");
    let took = took(&ran, 1.0);
    assert!(took < 5.0, "law: where nothing is left to settle the stage ends, took {took} s");
}
