//! Faults of stages: their order, their times, and what the time step makes of them.

use pluvia::grains::load_scenario;
use serde_json::{Value, json};

use super::{expect_at, expect_one, faults, folder, sound};
use crate::small;

/// A vibration after the pour, with some fields of its own.
fn vibrated(fields: Value) -> impl FnOnce(&mut Value) {
    move |s| {
        with_stages(&["fill_funnel", "pour", "vibrate"])(s);
        small::put(&mut s["stages"][2], &fields);
    }
}

fn with_stages(stages: &[&str]) -> impl FnOnce(&mut Value) {
    let stages: Vec<Value> = stages
        .iter()
        .map(|name| match *name {
            "pour" => json!({ "stage": "pour", "falling_height_mm": 50 }),
            "rest" => json!({ "stage": "rest", "duration_s": 1 }),
            "vibrate" => json!({
                "stage": "vibrate", "frequency_hz": 3, "amplitude_mm": 25, "duration_s": 1
            }),
            name => json!({ "stage": name }),
        })
        .collect();
    move |s| s["stages"] = Value::Array(stages)
}

#[test]
fn stages_have_their_order() {
    let mut value = sound();
    let all =
        ["fill_funnel", "rest", "pour", "rest", "place_top_plate", "vibrate", "rest", "vibrate"];
    with_stages(&all)(&mut value);
    assert_eq!(faults(&value), [], "{all:?} is in order");
    let cases: [(&[&str], &str, &str); 6] = [
        (&["pour"], "stages[0].stage", "the first stage fills the funnel"),
        (&["fill_funnel", "fill_funnel"], "stages[1].stage", "twice"),
        (&["fill_funnel", "pour", "pour"], "stages[2].stage", "twice"),
        (&["fill_funnel", "vibrate", "pour"], "stages[1].stage", "before `pour`"),
        (&["fill_funnel", "place_top_plate", "pour"], "stages[1].stage", "before `pour`"),
        (
            &["fill_funnel", "pour", "place_top_plate", "place_top_plate"],
            "stages[3].stage",
            "twice",
        ),
    ];
    for (stages, path, words) in cases {
        expect_one(with_stages(stages), path, &[words]);
    }
    expect_at("stages", json!([]), &["too short"]);
}

/// Law: what a list lacks that replaces another is a fault of who gives the list, not of the file
/// whose list is gone.
#[test]
fn a_list_that_is_replaced_has_no_faults_any_more() {
    let stages = json!([{ "stage": "fill_funnel" }, { "stage": "pour" }]);
    let top = json!({ "extends": "base.json", "name": "top", "stages": stages });
    let folder = folder(&[("base.json", &sound().to_string()), ("top.json", &top.to_string())]);
    let change = r#"stages.1={"stage":"pour"}"#;
    for (name, changes, expected) in [
        ("top.json", vec![], "top.json: stages[1].falling_height_mm: the field is missing"),
        (
            "base.json",
            vec![change],
            "--set stages.1={\"stage\":\"pour\"}: stages[1].falling_height",
        ),
    ] {
        let changes: Vec<_> = changes.iter().map(|c| c.parse().expect("an override")).collect();
        let found = load_scenario(&folder.path().join(name), &changes).expect_err("law: refused");
        let said = found.to_string();
        assert!(
            said.contains(expected),
            "law: who gives the list is named, {expected}, got {said}"
        );
        assert_eq!(found.faults().len(), 1, "law: one fault, got {said}");
    }
}

/// Law: limits of a placement are refused where none is drawn, and judged where one is.
#[test]
fn a_plate_on_the_axis_takes_no_limits_of_a_placement() {
    let plate = |fields: &[(&str, Value)]| {
        let fields: Vec<(String, Value)> =
            fields.iter().map(|(name, value)| ((*name).to_owned(), value.clone())).collect();
        move |s: &mut Value| {
            with_stages(&["fill_funnel", "pour", "place_top_plate"])(s);
            for (name, value) in fields {
                s["stages"][2][name] = value;
            }
        }
    };
    let idle = "it means nothing with placement 0";
    for (field, found) in [("offset_mm", 0.5), ("rotation_deg", 90.0)] {
        let path = format!("stages[2].{field}");
        for placement in [None, Some(("placement", json!(0)))] {
            let fields: Vec<_> = placement.into_iter().chain([(field, json!(found))]).collect();
            let found = format!("found {found}");
            expect_one(plate(&fields), &path, &[idle, &found, "the field left out"]);
        }
        let mut drawn = sound();
        plate(&[("placement", json!(1)), (field, json!(found))])(&mut drawn);
        assert_eq!(faults(&drawn), [], "law: `{field}` is a limit of what is drawn");
    }
    let wide = [("placement", json!(1)), ("offset_mm", json!(50))];
    expect_one(plate(&wide), "stages[2].offset_mm", &["into the wall", "found 50"]);
    let mut as_ever = sound();
    plate(&[("placement", json!(0)), ("rotation_deg", json!(180))])(&mut as_ever);
    assert_eq!(faults(&as_ever), [], "law: the default is written by every run");
}

#[test]
fn a_time_step_that_cannot_resolve_the_motion_is_refused() {
    // 250 mm of fall: v = √(2·9.81·0.25) = 2.215 m/s, 8 mm in a step at 276.8 Hz.
    expect_one(
        |s| s["engine"] = json!({ "contact_solver": "stock", "rate_hz": 276 }),
        "engine.rate_hz",
        &["cannot resolve the motion", "250 mm", "found 276", "at least 277 Hz"],
    );
    let mut enough = sound();
    enough["engine"] = json!({ "contact_solver": "stock", "rate_hz": 277 });
    assert_eq!(faults(&enough), [], "277 Hz resolve the fall");
    // What foresees contacts may take steps of twice the size.
    let words = ["cannot resolve the motion", "twice", "at least 139 Hz"];
    expect_at("engine.rate_hz", json!(138), &words);
    enough["engine"] = json!({ "rate_hz": 139 });
    assert_eq!(faults(&enough), [], "139 Hz are enough where contacts are foreseen");
    expect_one(
        |s| {
            vibrated(json!({ "frequency_hz": 15, "amplitude_mm": 1 }))(s);
            s["engine"] = json!({ "rate_hz": 480 });
        },
        "engine.rate_hz",
        &["15 Hz has 32 steps a cycle", "at least 600 Hz"],
    );
    // Where no step rate would do, the motion is at fault: 0.5 m at 1000 Hz, 100 000 steps a second.
    expect_one(
        vibrated(json!({ "frequency_hz": 1000, "amplitude_mm": 500 })),
        "stages[2]",
        &["no step rate resolves", "moves 31.42 mm in a step", "100000 Hz can resolve"],
    );
    // 6 Hz and 200 mm: 7.54 m/s, faster than the fall.
    expect_one(
        |s| {
            vibrated(json!({ "frequency_hz": 6, "amplitude_mm": 200 }))(s);
            s["engine"] = json!({ "contact_solver": "stock", "rate_hz": 480 });
        },
        "engine.rate_hz",
        &["the shaking table", "15.71 mm"],
    );
    expect_one(
        |s| {
            s["engine"] = json!({ "contact_solver": "stock" });
            s["apparatus"] = json!({ "cylinder": { "wall_thickness_mm": 5 } });
        },
        "apparatus.cylinder.wall_thickness_mm",
        &["through which grains can pass", "at least 9.229 mm"],
    );
    expect_at("engine.contact_threshold_mm", json!(8), &["longer than a grain", "8 mm"]);
}

#[test]
fn times_are_bounded() {
    expect_one(
        |s| {
            with_stages(&["fill_funnel", "pour", "rest"])(s);
            s["stages"][2]["duration_s"] = json!(3600);
        },
        "stages",
        &["too long", "3600 s"],
    );
    let words = ["before anything can count as settled", "0.25"];
    expect_at("stages[0].time_limit_s", json!(0.2), &words);
}

#[test]
fn a_ramp_is_a_cycle_at_least_and_half_a_period_at_most() {
    for (ramp_s, duration_s, allowed) in [
        (0.2, 5.0, "0, or from one cycle, 0.3334 s, to half of duration_s, 2.5 s"),
        (2.6, 5.0, "to half of duration_s, 2.5 s"),
        (0.4, 0.333_333_333, "too short for a ramp"),
    ] {
        expect_one(
            vibrated(json!({ "duration_s": duration_s, "ramp_s": ramp_s })),
            "stages[2].ramp_s",
            &["the amplitude can neither grow", allowed],
        );
    }
    let mut sound = sound();
    with_stages(&["fill_funnel", "pour", "vibrate"])(&mut sound);
    for ramp_s in [0.0, 0.334, 0.5] {
        sound["stages"][2]["ramp_s"] = json!(ramp_s);
        assert_eq!(faults(&sound), [], "a ramp of {ramp_s} s within a period of 1 s");
    }
}
