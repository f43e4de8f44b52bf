//! What runs of laboratories say of their specimen: of a surface that they do not have, and of
//! grains that are not there.

use serde_json::{Value, json};

use super::{
    program::{Folder, assert_holds, done},
    small,
};

/// Thirty grains that rain into a box, with more or other fields of the deposit; null takes one away.
fn boxed(deposit: &Value) -> Value {
    let mut stage = json!({ "stage": "deposit", "at_mm": [0, 0, 60], "area_mm": [50, 50],
        "rate_g_per_s": 150 });
    small::put(&mut stage, deposit);
    json!({
        "name": "boxed",
        "grains": small::fine(30.0),
        "pieces": [{ "name": "box", "shape": { "box": { "inner_mm": [60, 60, 60] } } }],
        "stages": [stage],
        "rest_test_s": 0.3
    })
}

/// Runs a scenario without figures; its summary, and what is printed of it.
fn ran(folder: &Folder, name: &str, scenario: &Value) -> (Value, String) {
    ran_with(folder, name, scenario, &["--no-figures"])
}

/// The same with options.
fn ran_with(folder: &Folder, name: &str, scenario: &Value, more: &[&str]) -> (Value, String) {
    let (file, out) = (folder.scenario(&format!("{name}.json"), scenario), folder.out(name));
    let args = ["run", &file, "--out", &out, "--jobs", "1"];
    let printed = done(&[&args[..], more].concat());
    (folder.json(&format!("{name}/summary.json")), printed)
}

/// Law: pieces have no floor of their own, and so no mean surface above it: what would be 0 in
/// every row is empty, null, and no curve.
#[test]
fn a_laboratory_has_no_mean_surface_over_time() {
    let folder = Folder::new();
    let (summary, _) = ran_with(&folder, "out", &boxed(&json!({})), &[]);
    let mut rows = csv::Reader::from_path(folder.path("out/series.csv")).expect("series.csv");
    let names = rows.headers().expect("names").clone();
    let column = names.iter().position(|name| name == "mean_surface_mm");
    let column = column.expect("law: the column stays");
    let cells: Vec<String> =
        rows.records().map(|row| row.expect("a row")[column].to_owned()).collect();
    assert!(!cells.is_empty() && cells.iter().all(String::is_empty), "law: empty, got {cells:?}");
    assert_eq!(summary["rest_test"]["mean_surface_drop_mm"], Value::Null, "law: no drop of it");
    let figure = folder.text("out/figures/heights.svg");
    assert!(!figure.contains("Mean surface"), "law: no curve of what is not measured");
    assert!(figure.contains("Mean height of the grains"), "law: what is measured is drawn");
    // The circle about the corners of the box has 57 cm², and the grains have 11.3 cm³.
    let height = summary["standing_height_mm"]["mean_surface"].as_f64().expect("a height");
    assert!(height > 2.0, "law: as high as their solids over the area at least, got {height} mm");
}

/// The warnings of a summary that contain some words.
fn warned<'a>(summary: &'a Value, words: &str) -> Vec<&'a str> {
    let warnings = summary["warnings"].as_array().expect("warnings").iter();
    let texts = warnings.map(|text| text.as_str().expect("a text"));
    texts.filter(|text| text.contains(words)).collect()
}

/// Law: where every grain has missed the box there is no specimen: nothing is measured, and the run
/// is not valid.
#[test]
fn a_deposit_that_misses_its_box_is_no_specimen() {
    let folder = Folder::new();
    let (summary, printed) = ran(&folder, "beside", &boxed(&json!({ "at_mm": [120, 0, 30] })));
    assert_eq!(summary["grains"]["spilled"], summary["grains"]["count"], "law: all fell out");
    for field in ["meets_standard", "valid"] {
        assert_eq!(summary[field], false, "law: {field} of nothing");
    }
    assert_eq!(summary["creep_um_per_s"], Value::Null, "law: no numerical creep of nothing");
    let height = &summary["standing_height_mm"]["mean_surface"];
    assert_eq!(*height, Value::Null, "law: nothing stands");
    for path in [
        "/overlap/mean_percent",
        "/overlap/p99_percent",
        "/overlap/max_mm",
        "/coordination_number",
        "/rest_test/mean_grain_height_drop_mm",
    ] {
        assert_eq!(summary.pointer(path), Some(&Value::Null), "law: no {path} of no grains");
    }
    assert_eq!(summary["overlap"]["pairs"], 0, "law: there are none");
    let mut rows = csv::Reader::from_path(folder.path("beside/series.csv")).expect("series.csv");
    let names = rows.headers().expect("names").clone();
    let column = names.iter().position(|name| name == "mean_grain_height_mm").expect("a column");
    let last = rows.records().last().expect("rows").expect("a row");
    assert_eq!(&last[column], "", "law: no mean height of no grains, got {last:?}");
    for words in ["30 of 30 grains fell out during the deposit", "as no grain is left"] {
        assert_eq!(warned(&summary, words).len(), 1, "law: `{words}` in {}", summary["warnings"]);
    }
    assert!(!printed.contains("-0.000"), "law: no balance of −0.000 N: {printed}");
    assert!(printed.contains("NOT VALID"), "law: the last line says so: {printed}");
    let half = json!({ "how": "lattice", "rate_g_per_s": null, "at_mm": [40, 0, 62],
        "area_mm": [90, 40] });
    let (summary, _) = ran(&folder, "half", &boxed(&half));
    assert!(summary["grains"]["in_cylinder"].as_u64() > Some(0), "law: some are in the box");
    let fallen = &summary["grains"]["spilled"];
    let told = warned(&summary, &format!("{fallen} of 30 grains fell out"));
    assert_eq!(told.len(), 1, "law: those that missed it are counted: {}", summary["warnings"]);
    assert_eq!(summary["grains"]["missing"], *fallen, "law: the box is not full");
    let why = summary["left_out_of_means"].to_string();
    assert!(why.contains("fell out beside the container"), "law: left out of means, got {why}");
}

/// Law: grains that no deposit took are counted, and a mass that is not there is lacking.
#[test]
fn what_is_left_over_and_what_is_lacking_is_said() {
    let folder = Folder::new();
    let (summary, printed) = ran(&folder, "part", &boxed(&json!({ "mass_g": 10 })));
    let [inside, left] =
        ["in_cylinder", "left_in_funnel"].map(|field| summary["grains"][field].clone());
    assert!(left.as_u64() > Some(10), "law: 20 of 30 g wait, got {left}");
    let places = format!("{inside} in the laboratory, {left} left over, 0 fallen out of it");
    assert!(printed.contains(&places), "law: `{places}` in {printed}");
    assert_eq!(summary["valid"], true, "law: a part is a specimen: {}", summary["warnings"]);
    let (summary, _) = ran(&folder, "much", &boxed(&json!({ "mass_g": 300 })));
    let told = warned(&summary, "asks for 300 g of grains, and only 30 g were waiting");
    assert_eq!(told.len(), 1, "law: 270 g are lacking: {}", summary["warnings"]);
}

/// Thirty grains in a closed hopper, which run out into nothing.
fn hopper() -> Value {
    let mut scenario = boxed(&json!({ "at_mm": [0, 0, 180], "area_mm": [36, 36] }));
    scenario["pieces"] = json!([
        { "name": "hopper", "at_mm": [0, 0, 100], "shape": { "hopper": { "opening_diameter_mm": 50,
            "top_diameter_mm": 60, "half_angle_deg": 30, "collar_mm": 100 } } },
        { "name": "gate", "at_mm": [0, 0, 95], "shape": { "plate": { "size_mm": [100, 100, 10] } } }
    ]);
    let remove = json!({ "stage": "remove", "pieces": ["gate"] });
    scenario["stages"].as_array_mut().expect("stages").push(remove);
    scenario["measures"] = json!({
        "openings": [{ "name": "mouth", "at_mm": [0, 0, 85], "diameter_mm": 80 }]
    });
    // All run out within a tenth of a second: between two samples they would have no rate.
    scenario["sample_interval_s"] = json!(0.01);
    scenario
}

/// Law: a hopper that runs empty into nothing has a flow that counts: its grains met the standard
/// while they were in it, and there is nothing to judge afterwards.
#[test]
fn a_hopper_that_runs_empty_is_valid_and_its_flow_counts() {
    let folder = Folder::new();
    let (summary, printed) = ran(&folder, "hopper", &hopper());
    assert_eq!(summary["grains"]["in_cylinder"], 0, "law: it is empty");
    let opening = &summary["laboratory"]["openings"][0];
    assert!(opening["rate_g_per_s"].as_f64() > Some(0.0), "law: it flowed, got {opening}");
    assert_eq!(summary["meets_standard"], false, "law: nothing is measured at the end");
    assert_eq!(summary["valid"], true, "law: its flow counts: {}", summary["warnings"]);
    assert_eq!(summary["left_out_of_means"], json!([]));
    assert!(warned(&summary, "fell out during the deposit").is_empty(), "law: not in the deposit");
    assert!(!printed.contains("NOT VALID"), "{printed}");
}

/// Law: the table of a sweep has all numbers of a laboratory as its runs have them, its page the
/// flow, and targets find both.
#[test]
fn a_sweep_of_a_laboratory_has_its_results() {
    let folder = Folder::new();
    let file = folder.scenario("hopper.json", &hopper());
    let over = "pieces.0.shape.hopper.opening_diameter_mm=46,52";
    let out = folder.out("out");
    done(&["sweep", &file, "--over", over, "--configurations", "2", "--out", &out]);
    let mut table = csv::Reader::from_path(folder.path("out/sweep.csv")).expect("sweep.csv");
    let names = table.headers().expect("names").clone();
    let rows: Vec<csv::StringRecord> = table.records().map(|row| row.expect("a row")).collect();
    assert_eq!(rows.len(), 4, "law: two openings in two realisations");
    let rate = "laboratory.openings.0.rate_g_per_s";
    for path in [rate, "laboratory.openings.0.passed_g", "laboratory.pieces.0.force_n.2"] {
        let column = names.iter().position(|name| name == path);
        let column = column.unwrap_or_else(|| panic!("law: a column {path} among {names:?}"));
        for row in &rows {
            let summary = folder.json(&format!("out/runs/{}/summary.json", &row[0]));
            let own = summary.pointer(&format!("/{}", path.replace('.', "/")));
            let own = own.and_then(Value::as_f64).expect("a number of the run");
            assert_eq!(row[column].parse::<f64>(), Ok(own), "law: {path} as {} has it", &row[0]);
        }
    }
    // Points have the flow, and effects.
    let columns = ["| Rate through mouth (g/s) |", "opening_diameter_mm | Rate through mouth"];
    assert_holds(&folder.text("out/sweep.md"), &columns);
    let (runs, target) = (format!("h={out}"), format!("h:{rate}=1..100000"));
    let found = folder.out("targets");
    done(&["targets", "--runs", &runs, "--target", &target, "--out", &found]);
    let found = folder.json("targets/targets.json");
    assert_eq!(found["targets"][0]["runs_meeting"], 4, "law: every run flows, got {found}");
}

/// Law: grains that lie farther apart than a height map of usual cells reaches are measured all the
/// same: beads of 2 to 3 mm on a plate 2 m wide, where 4000 cells are 1 m.
#[test]
fn grains_that_lie_far_apart_are_measured() {
    let folder = Folder::new();
    let scenario = json!({
        "name": "wide",
        "grains": {
            "shape": "spheres", "total_mass_g": 1, "density_kg_per_m3": 2500,
            "sieve_table": [{ "passing_mm": 3, "retained_mm": 2, "mass_percent": 100 }]
        },
        "pieces": [{ "name": "plate", "shape": { "plate": { "size_mm": [2000, 2000, 10] } },
            "at_mm": [0, 0, -5] }],
        "stages": [{ "stage": "deposit", "at_mm": [0, 0, 5], "area_mm": [1900, 1900],
            "rate_g_per_s": 10, "time_limit_s": 0.5 }],
        "rest_test_s": 0.1
    });
    let (summary, _) = ran(&folder, "wide", &scenario);
    let highest = summary["standing_height_mm"]["highest"].as_f64().expect("law: a height");
    assert!((2.0..=3.1).contains(&highest), "law: one bead high, got {highest} mm");
}
