//! What is watched while a run goes on: every result says whether it passed.

use std::path::Path;

use serde_json::{Value, json};

use super::{
    interruption::finished,
    program::{self, Folder},
    segments::in_segments_timed,
    small,
};

fn summary(out: &Path) -> Value {
    program::json(&out.join("summary.json"))
}

/// Runs a scenario; its summary, and what was told on the way.
fn carried_out(scenario: &Value) -> (Value, String) {
    let folder = Folder::new();
    let (file, out) = (folder.scenario("scenario.json", scenario), folder.out("out"));
    let (code, _, told) = program::run(&["run", &file, "--out", &out, "--no-figures"]);
    assert_eq!(code, Some(0), "law: it is run, got {told}");
    (folder.json("out/summary.json"), told)
}

const ALL: [&str; 8] =
    ["finite", "lost", "through_walls", "speed", "energy", "overlap_mean", "overlap_p99", "creep"];

#[test]
fn a_sound_run_says_of_every_check_that_it_looked_and_what_it_found() {
    for out in [finished().to_owned(), in_segments_timed().0.path().join("out")] {
        let checks = &summary(&out)["checks"];
        for name in ALL {
            let check = &checks[name];
            let looks = check["looks"].as_u64().unwrap_or(0);
            assert!(looks > 0, "law: {name} looked, got {check}");
            let (worst, limit) = (check["worst"].as_f64(), check["limit"].as_f64());
            let (worst, limit) = (worst.expect("a value"), limit.expect("a limit"));
            assert_eq!(
                check["passed"],
                Value::Bool(worst <= limit),
                "law: {name} passed when the worst is within its limit, got {check}"
            );
        }
        let passed = ALL.iter().all(|name| checks[*name]["passed"] == true);
        assert_eq!(checks["passed"], Value::Bool(passed), "law: all or not, got {checks}");
        for name in ["finite", "lost", "through_walls", "speed", "energy"] {
            assert_eq!(checks[name]["passed"], true, "law: {name}, got {}", checks[name]);
        }
        let summary = summary(&out);
        let valid = summary["meets_standard"] == true && passed;
        assert_eq!(summary["valid"], Value::Bool(valid), "law: the standard met, nothing found");
        // Every 0.02 s of all that was simulated, rest test included.
        let simulated = summary["simulated_s"].as_f64().expect("a time");
        let checks = checks["finite"]["looks"].as_f64().expect("a count");
        let expected = simulated / 0.02;
        assert!(
            (0.98..1.3).contains(&(checks / expected)),
            "law: a look every 0.02 s and at every sample; expected about {expected:.0}, got {checks}"
        );
    }
}

#[test]
fn contacts_that_sink_into_each_other_are_told_at_once_and_in_the_summary() {
    let mut scenario = small::scenario(150.0, 2.0, 0.5);
    scenario["engine"] = json!({
        "contact_solver": "stock", "rate_hz": 60, "iterations": 10, "allow_coarse_steps": true
    });
    let (summary, told) = carried_out(&scenario);
    let checks = &summary["checks"];
    assert_eq!(checks["passed"], false, "law: stock Bullet contacts at 60 Hz fail, got {checks}");
    assert_eq!(summary["valid"], false, "law: a run whose checks found something is not valid");
    let overlap = &checks["overlap_mean"];
    assert_eq!(overlap["passed"], false, "got {overlap}");
    assert!(overlap["worst"].as_f64() > overlap["limit"].as_f64(), "got {overlap}");
    assert!(overlap["first_beyond_s"].as_f64() <= overlap["worst_at_s"].as_f64(), "got {overlap}");
    let warnings = summary["warnings"].as_array().expect("a list");
    let of_overlap: Vec<&str> = warnings
        .iter()
        .filter_map(Value::as_str)
        .filter(|w| w.starts_with("mean overlap of grains"))
        .collect();
    assert!(!of_overlap.is_empty(), "law: a line in the warnings, got {warnings:?}");
    assert!(of_overlap.iter().all(|w| !w.contains('\n')), "law: one line each");
    assert!(told.contains("grains overlap by"), "law: told as soon as it is seen, got {told}");
}

/// Law: a load seats the plate without grains through the floor, and what contacts held as springs
/// under it is explained when it is taken off.
#[test]
fn a_plate_is_seated_without_findings() {
    let mut scenario = small::scenario(60.0, 0.5, 0.0);
    scenario["stages"][2]["seating_load_n"] = json!(200);
    let (summary, told) = carried_out(&scenario);
    assert_eq!(summary["grains"]["escaped"], 0, "law: none is pressed through a wall: {told}");
    for name in ["through_walls", "speed", "energy"] {
        let check = &summary["checks"][name];
        assert_eq!(check["passed"], true, "law: {name} finds nothing, got {check}, told {told}");
    }
    assert!(!told.contains("contact_stiffness"), "law: no warning of what nobody typed: {told}");
}
