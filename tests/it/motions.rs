//! A vibration ends at rest, whatever moves the table; plates are laid as the scenario says.

use std::{fs, path::Path};

use serde_json::{Value, json};

use super::{
    near::near,
    program::{done, json as read, text, write},
    small,
};

/// Runs the small scenario with a change of it; its summary.
fn carried_out(folder: &Path, name: &str, change: impl Fn(&mut Value)) -> Value {
    let mut scenario = small::scenario(90.0, 0.5, 0.2);
    change(&mut scenario);
    let file = write(folder, &format!("{name}.json"), &scenario);
    // One folder: what runs share is run once.
    let out = folder.join("out");
    let run = ["run", text(&file), "--out", text(&out)];
    done(&[&run[..], &["--quiet", "--no-figures", "--force"]].concat());
    for table in ["series.csv", "rest_test.csv", "manifest.json"] {
        fs::copy(out.join(table), folder.join(format!("{name}-{table}"))).expect("kept");
    }
    read(&out.join("summary.json"))
}

/// Rows of a table by column.
fn rows(folder: &Path, table: &str) -> Vec<Value> {
    let mut reader = csv::Reader::from_path(folder.join(table)).expect("a table");
    let head = reader.headers().expect("a head").clone();
    let row = |record: csv::StringRecord| {
        let cells = head.iter().zip(record.iter());
        let cell = |text: &str| text.parse::<f64>().map_or(Value::Null, |v| json!(v));
        Value::Object(cells.map(|(name, text)| (name.to_owned(), cell(text))).collect())
    };
    reader.records().map(|r| row(r.expect("a row"))).collect()
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("law: a number, got {value}"))
}

#[test]
#[ignore = "slow: make test-all"]
fn settlement_is_read_at_rest_and_goes_on_through_all_later_stages() {
    let folder = tempfile::tempdir().expect("a folder");
    let rest = json!({ "stage": "rest", "duration_s": 0.4 });
    let then_rest = |s: &mut Value| s["stages"].as_array_mut().expect("stages").push(rest.clone());
    let plain = carried_out(folder.path(), "plain", |_| ());
    let rested = carried_out(folder.path(), "rested", then_rest);
    let short =
        carried_out(folder.path(), "short", |s| s["stages"][3]["settle_limit_s"] = json!(0.3));

    let settling = &plain["vibrations"][0]["settling"];
    let (time, limit) = (number(&settling["time_s"]), number(&settling["limit_s"]));
    assert!(
        time > 0.25 && time <= limit + 1e-9,
        "law: held for 0.25 s, at most the limit: {settling}"
    );
    let [start, end] = [0, 1].map(|n| number(&plain["vibrations"][0]["periods_s"][0][n]));
    near("half a second of shaking", end - start, 0.5, 1e-9);

    let series = rows(folder.path(), "rested-series.csv");
    let later = series.iter().filter(|r| number(&r["stage"]) >= 3.0);
    assert!(later.clone().any(|r| number(&r["stage"]) == 4.0), "the rest has rows");
    let rest_test = rows(folder.path(), "rested-rest_test.csv");
    let begin = number(
        &series.iter().find(|r| number(&r["stage"]) == 3.0).expect("shaken")["plate_height_mm"],
    );
    for row in later.chain(&rest_test) {
        let (settled, height) = (number(&row["settlement_mm"]), number(&row["plate_height_mm"]));
        near("the drop since the vibration began", settled, begin - height, 1e-9);
    }
    assert!(
        series.iter().filter(|r| number(&r["stage"]) < 3.0).all(|r| r["settlement_mm"].is_null())
    );

    let of = |name: &str, at: f64| {
        let rows = rows(folder.path(), name);
        let row = rows.iter().rfind(|r| (number(&r["time_s"]) - at).abs() < 1e-6).expect("a row");
        number(&row["settlement_mm"])
    };
    let settlement = &plain["settlement_mm"];
    let last = series.iter().rfind(|r| number(&r["stage"]) == 3.0).expect("shaken");
    let at_rest = number(&last["settlement_mm"]);
    near("at rest", number(&settlement["final"]), at_rest, 1e-6);
    let moving = of("plain-series.csv", end);
    near("the row at the end of shaking", number(&settlement["end_of_shaking"]), moving, 1e-6);
    near("a rest changes nothing", number(&rested["settlement_mm"]["final"]), at_rest, 0.05);
    assert_eq!(rested["settlement_mm"]["end_of_shaking"], settlement["end_of_shaking"]);

    // What comes after the shaking does not act on what was before.
    let shaken = |name: &str| {
        let rows = rows(folder.path(), name).into_iter();
        rows.filter(|r| number(&r["time_s"]) <= end + 1e-6).collect::<Vec<_>>()
    };
    assert_eq!(
        shaken("plain-series.csv"),
        shaken("short-series.csv"),
        "law: the same to the last digit"
    );
    let limit = number(&short["vibrations"][0]["settling"]["time_s"]);
    assert!(limit <= 0.3 + 1.0 / 400.0, "law: settling is bounded, got {limit} s");
}

#[test]
#[ignore = "slow: make test-all"]
fn every_motion_drives_a_stage_and_says_what_it_is() {
    let folder = tempfile::tempdir().expect("a folder");
    let table: String = std::iter::once("time_s,x_mm,y_mm\n".to_owned())
        .chain((0..=100).map(|n| {
            let t = f64::from(n) / 200.0;
            // At rest, and without acceleration, at either end.
            let x = 2.5 * (1.0 - (8.0 * std::f64::consts::PI * t).cos()).powi(2);
            format!("{t},{x},{}\n", x / 2.0)
        }))
        .collect();
    fs::write(folder.path().join("table.csv"), table).expect("written");
    let a = 0.010 * (8.0 * std::f64::consts::PI).powi(2);
    for (name, fields, acceleration, words) in [
        ("sine", json!({}), a, "sine from the middle"),
        ("turning", json!({ "start": "turning_point" }), a, "from the turning point"),
        ("crank", json!({ "waveform": "slider_crank", "crank_to_rod": 0.3 }), 1.3 * a, "r/l 0.3"),
        ("vertical", json!({ "vertical": { "amplitude_mm": 1 } }), 1.01_f64.sqrt() * a, "vertical"),
        ("frames", json!({ "video_frames": { "frames_per_s": 50 } }), a, "one pose a video frame"),
        (
            "file",
            json!({
                "waveform": "file", "motion_file": "table.csv", "frequency_hz": null,
                "amplitude_mm": null, "duration_s": null
            }),
            1.25_f64.sqrt() * a,
            "recorded, 101 rows",
        ),
    ] {
        let with = |s: &mut Value| small::put(&mut s["stages"][3], &fields);
        let summary = carried_out(folder.path(), name, with);
        let motion = &summary["vibrations"][0]["motion"];
        let got = number(&motion["peak_acceleration_m_per_s2"]);
        near(&format!("peak acceleration of {name}"), got, acceleration, 0.01 * acceleration);
        assert!(motion["waveform"].as_str().is_some_and(|w| w.contains(words)), "{name}: {motion}");
        let manifest = read(&folder.path().join(format!("{name}-manifest.json")));
        assert_eq!(&manifest["vibrations"][0]["motion"], motion, "law: both say the same");
        assert_eq!(summary["grains"]["escaped"], 0, "law: nothing passes a wall, {name}");
        let series = rows(folder.path(), &format!("{name}-series.csv"));
        let last = series.last().expect("rows");
        assert_eq!(number(&last["table_x_mm"]), 0.0, "law: it ends at rest at its place, {name}");
        let off = |column: &str| {
            series.iter().filter_map(|r| r[column].as_f64()).map(f64::abs).fold(0.0, f64::max)
        };
        match name {
            "vertical" => {
                assert!(off("table_z_mm") > 0.5, "law: it moves along z");
                // Heights are above the floor that moves along.
                let plate = series.iter().filter(|r| number(&r["stage"]) == 3.0);
                let heights: Vec<f64> = plate.map(|r| number(&r["mean_grain_height_mm"])).collect();
                let (least, most) =
                    heights.iter().fold((f64::MAX, 0.0_f64), |(l, h), z| (l.min(*z), h.max(*z)));
                assert!(
                    most - least < 8.0,
                    "law: grains stay about where they are, {least} to {most} mm"
                );
            }
            "file" => {
                assert!(off("table_y_mm") > 2.0, "law: it moves along y, got {}", off("table_y_mm"))
            }
            _ => assert!(series[0].get("table_z_mm").is_none(), "law: no column without motion"),
        }
    }
}

#[test]
#[ignore = "slow: make test-all"]
fn plates_are_laid_anew_on_the_same_specimen_and_seated_on_demand() {
    let folder = tempfile::tempdir().expect("a folder");
    let placed = |name: &str, fields: Value| {
        let with = |s: &mut Value| small::put(&mut s["stages"][2], &fields);
        let summary = carried_out(folder.path(), name, with);
        let series = rows(folder.path(), &format!("{name}-series.csv"));
        let plate = series.into_iter().rfind(|r| number(&r["stage"]) == 2.0).expect("a plate");
        let manifest = read(&folder.path().join(format!("{name}-manifest.json")));
        (summary, number(&plate["plate_height_mm"]), manifest["stages"].clone())
    };
    let (_, axis, first) = placed("axis", json!({}));
    let (_, drawn, second) = placed("drawn", json!({ "placement": 1 }));
    let (_, other, third) = placed("other", json!({ "placement": 2 }));
    let (seated_run, seated, _) = placed("seated", json!({ "seating_load_n": 20 }));
    for stages in [&second, &third] {
        assert_eq!(stages[1]["key"], first[1]["key"], "law: the poured stage is shared");
        assert_ne!(
            stages[2]["specimen_sha256"], first[2]["specimen_sha256"],
            "law: the plate is not"
        );
    }
    assert!(axis != drawn && drawn != other, "law: placements differ: {axis}, {drawn}, {other} mm");
    assert!(
        seated < axis,
        "law: a weight of 20 N presses the plate down, from {axis} to {seated} mm"
    );
    let warnings = seated_run["warnings"].to_string();
    assert!(
        !warnings.contains("energy"),
        "law: the weight is no unexplained energy gain, {warnings}"
    );
}
