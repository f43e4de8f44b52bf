//! Faults of the table's motion: fields that a waveform needs or has no use for, and recorded
//! motions that are none.

use std::fs;

use pluvia::grains::load_scenario;
use pluvia::motion::Waveform;
use pluvia::scenario::{Fault, Override, ScenarioErrors};
use serde_json::{Value, json};

use super::{expect_one, faults, sound};
use crate::small;

/// The sound scenario, shaken: fields of the stage replaced, those that are null left out.
fn shaken(fields: Value) -> Value {
    let mut value = sound();
    let mut stage = json!({
        "stage": "vibrate", "frequency_hz": 3, "amplitude_mm": 10, "duration_s": 2
    });
    small::put(&mut stage, &fields);
    value["stages"].as_array_mut().expect("stages").push(stage);
    value
}

/// A recorded motion in place of the sine.
fn recorded(fields: Value) -> Value {
    let mut all = json!({
        "waveform": "file", "frequency_hz": null, "amplitude_mm": null, "duration_s": null
    });
    for (name, field) in fields.as_object().expect("fields") {
        all[name] = field.clone();
    }
    shaken(all)
}

#[test]
fn every_waveform_can_be_told() {
    let rows = json!([[0, 0, 0, 0], [0.5, 4, 0, 1], [1, 0, 0, 0]]);
    for fields in [
        json!({}),
        json!({ "start": "turning_point", "ramp_s": 0.5 }),
        json!({ "waveform": "slider_crank", "crank_to_rod": 0.25 }),
        json!({ "waveform": "slider_crank", "crank_to_rod": 0.5, "start": "turning_point" }),
        json!({ "vertical": { "amplitude_mm": 2 } }),
        json!({ "vertical": { "amplitude_mm": 2, "frequency_hz": 7.5, "phase_deg": 90 } }),
        json!({ "video_frames": { "frames_per_s": 100 } }),
    ] {
        assert_eq!(faults(&shaken(fields.clone())), [], "law: {fields} is sound");
    }
    for fields in [
        json!({ "motion_rows": rows }),
        json!({ "motion_rows": rows, "interpolation": "linear", "periods": 3, "rest_s": 1 }),
    ] {
        assert_eq!(faults(&recorded(fields.clone())), [], "law: {fields} is sound");
    }
}

#[test]
fn fields_that_a_waveform_needs_or_has_no_use_for_are_named() {
    let cases: [(Value, &str, &[&str]); 15] = [
        (json!({ "frequency_hz": null }), "frequency_hz", &["`sine` needs it"]),
        (json!({ "amplitude_mm": null }), "amplitude_mm", &["needs it", "at most 1000"]),
        (json!({ "duration_s": null }), "duration_s", &["needs it", "3600"]),
        (
            json!({ "waveform": "slider_crank" }),
            "crank_to_rod",
            &["`slider_crank` needs it", "0.5"],
        ),
        (json!({ "crank_to_rod": 0.2 }), "crank_to_rod", &["means nothing", "found 0.2"]),
        (json!({ "motion_file": "a.csv" }), "motion_file", &["only `file` is recorded"]),
        (json!({ "interpolation": "cubic" }), "interpolation", &["means nothing"]),
        (json!({ "waveform": "square" }), "waveform", &["no such choice", "slider_crank"]),
        (json!({ "start": "top" }), "start", &["no such choice", "turning_point"]),
        (json!({ "vertical": {} }), "vertical.amplitude_mm", &["missing"]),
        (
            json!({ "vertical": { "amplitude_mm": 1, "frequency_hz": 3.3 } }),
            "vertical.frequency_hz",
            &["also along z", "found 3.3", "as 3.5 Hz"],
        ),
        (json!({ "video_frames": {} }), "video_frames.frames_per_s", &["missing"]),
        (
            json!({ "video_frames": { "frames_per_s": 20 } }),
            "video_frames.frames_per_s",
            &["set by up to 9.425 mm", "at least 24 frames"],
        ),
        (json!({ "settle_limit_s": 0.2 }), "settle_limit_s", &["can count as settled", "0.25"]),
        (json!({ "crank_to_rod": 0.7, "waveform": "slider_crank" }), "crank_to_rod", &["0.5"]),
    ];
    for (fields, field, words) in cases {
        expect_one(|s| *s = shaken(fields), &format!("stages[2].{field}"), words);
    }
    let all = faults(&recorded(json!({
        "frequency_hz": 3, "amplitude_mm": 1, "duration_s": 1, "ramp_s": 0.5,
        "stroke": "full_stroke", "start": "turning_point", "vertical": { "amplitude_mm": 1 }
    })));
    let paths: Vec<&str> = all.iter().map(|f| f.path.as_str()).collect();
    assert_eq!(all.len(), 8, "law: every idle field at once, and what is missing, got {paths:?}");
}

#[test]
fn rows_are_told_by_their_numbers() {
    let of = |rows: Value| recorded(json!({ "motion_rows": rows }));
    for (rows, path, words) in [
        (json!([[0, 0, 0, 0]]), "stages[2].motion_rows", "too short"),
        (
            json!([[0, 0, 0, 0], [0, 1, 0, 0], [1, 0, 0, 0]]),
            "stages[2].motion_rows[1]",
            "does not grow",
        ),
        (json!([[0, 0, 0, 0], [1, 5, 0, 0], [2, 3, 0, 0]]), "stages[2].motion_rows[2]", "ends far"),
    ] {
        expect_one(|s| *s = of(rows), path, &[words]);
    }
    assert!(!faults(&of(json!([[0, 0, 0], [1, 0, 0]]))).is_empty(), "law: four numbers a row");
}

/// The faults of loading a file.
fn of_file(path: &std::path::Path, changes: &[Override]) -> Vec<Fault> {
    match load_scenario(path, changes) {
        Err(ScenarioErrors::Faults(faults)) => faults,
        other => panic!("law: faults are reported, got {other:?}"),
    }
}

#[test]
fn a_recorded_motion_is_read_beside_its_scenario_and_kept_as_rows() {
    let folder = tempfile::tempdir().expect("a folder");
    let table = "time_s,x_mm,z_mm\n0,1,0\n0.5,5,1\n1,1,0\n";
    fs::create_dir(folder.path().join("data")).expect("a folder");
    fs::write(folder.path().join("data/table.csv"), table).expect("written");
    let scenario = folder.path().join("s.json");
    let write =
        |fields: Value| fs::write(&scenario, recorded(fields).to_string()).expect("written");
    write(json!({ "motion_file": "data/table.csv" }));
    let loaded = load_scenario(&scenario, &[]).expect("it loads").scenario;
    let motion = loaded.motion().expect("it vibrates");
    assert!(matches!(motion.waveform, Waveform::Recorded(_)));
    let at = motion.displacement(0.5);
    assert!(
        (at.x - 4e-3).abs() < 1e-15 && (at.z - 1e-3).abs() < 1e-15,
        "law: from the first row, {at}"
    );
    let again: pluvia::scenario::Scenario =
        serde_json::from_value(serde_json::json!(loaded)).expect("it is a scenario");
    assert_eq!(again.motion(), Some(motion), "law: a scenario holds its rows, not only a name");

    let bad = |content: &[u8]| {
        fs::write(folder.path().join("data/table.csv"), content).expect("written");
        let all = of_file(&scenario, &[]);
        assert_eq!(
            all.iter().filter(|f| f.path == "stages[2].motion_file").count(),
            all.len(),
            "{all:?}"
        );
        all.iter().map(ToString::to_string).collect::<Vec<_>>().join("; ")
    };
    for (content, words) in [
        (&b""[..], "no column"),
        (&b"time_s,x_mm\n0,0\n"[..], "too few"),
        (&b"time_s,x_mm\n0,0\n1,nan\n2,0\n"[..], "row 2 holds what is no finite number"),
        (&b"time_s,x_mm\n0,0\n2,1\n1,0\n"[..], "the time of row 3 does not grow"),
        (&b"time_s,x_mm\n0,0\n1,1\n"[..], "ends far"),
        (&b"\xff\xfe\x00"[..], "utf-8"),
    ] {
        let said = bad(content);
        assert!(said.contains(words), "law: {words}, got {said}");
        assert!(said.contains("table.csv"), "law: the file is named, got {said}");
    }
    write(json!({ "motion_file": "missing.csv", "rest_s": -1 }));
    let all = of_file(&scenario, &[]);
    let paths: Vec<&str> = all.iter().map(|f| f.path.as_str()).collect();
    assert_eq!(paths, ["stages[2].rest_s", "stages[2].motion_file"], "law: all faults at once");
    for special in ["/dev/zero", "/", "."] {
        write(json!({ "motion_file": special }));
        let said = of_file(&scenario, &[])[0].to_string();
        assert!(said.contains("cannot be read"), "law: {special} is refused, got {said}");
    }
}
