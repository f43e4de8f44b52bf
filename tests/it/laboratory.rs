//! Laboratories of pieces: the shipped scenarios, and what is answered where one makes no sense.

use std::path::Path;

use pluvia::grains::load_scenario;
use pluvia::protocol::Setup;
use pluvia::scenario::{Scenario, schema, warnings};
use serde_json::{Value, json};

use super::{
    program::json as read,
    scenario::{assert_one, assert_told, changed, told_of as faults},
    small,
};

fn sound() -> Value {
    json!({
        "name": "laboratory",
        "grains": small::fine(100.0),
        "pieces": [
            { "name": "box", "shape": { "box": { "inner_mm": [100, 100, 100] } } },
            { "name": "lid", "shape": { "plate": { "size_mm": [120, 120, 10] } }, "at_mm": [0, 0, 205] }
        ],
        "stages": [
            { "stage": "deposit", "at_mm": [0, 0, 90], "area_mm": [80, 80], "rate_g_per_s": 50 },
            { "stage": "move", "pieces": ["lid"], "velocity_mm_per_s": [0, 0, 20], "travel_mm": 10 },
            { "stage": "remove", "pieces": ["lid"] },
            { "stage": "rest", "duration_s": 1 }
        ]
    })
}

/// The engines that can neither press nor let go pieces, by their settings and names.
fn other_engines() -> [(Value, &'static str); 2] {
    [
        (json!({ "backend": "rapier" }), "rapier"),
        (json!({ "contact_solver": "stock" }), "stock contacts"),
    ]
}

#[test]
fn the_shipped_laboratories_load_can_be_built_and_are_short() {
    let scenarios = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios");
    let validator = jsonschema::validator_for(&schema()).expect("a sound schema");
    let mut found = [0, 0];
    for (n, folder) in ["laboratory", "validation"].iter().enumerate() {
        for entry in std::fs::read_dir(scenarios.join(folder)).expect("the folder") {
            let file = entry.expect("an entry").path();
            let scenario = load_scenario(&file, &[]).unwrap_or_else(|e| panic!("{e}")).scenario;
            Setup::new(&scenario).unwrap_or_else(|e| panic!("{}: {e}", file.display()));
            assert!(validator.is_valid(&read(&file)), "{file:?}");
            // Tests of flow go down to openings at which hoppers begin to jam.
            let unusual = *folder == "laboratory" && !warnings(&scenario).is_empty();
            assert!(!unusual, "law: nothing unusual in {file:?}");
            assert!(!scenario.notes.is_empty(), "law: {file:?} says its choices");
            let stem = file.file_stem().and_then(|s| s.to_str()).expect("a name");
            assert_eq!(scenario.name, stem, "law: a scenario has the name of its file");
            found[n] += 1;
        }
    }
    assert!(
        found[0] >= 11,
        "expected the eleven scenarios of scenarios/laboratory, found {found:?}"
    );
    assert!(found[1] >= 8, "expected those of the standard tests, found {found:?}");
}

#[test]
fn faults_name_the_field_and_what_is_allowed() {
    assert_eq!(faults(&sound()), [], "law: the sound one is sound");
    for (path, to, words) in [
        ("pieces[1].name", json!("box"), "two pieces"),
        ("pieces[1].name", json!("a b"), "letters, digits"),
        ("pieces[1].name", json!("table"), "not a piece's"),
        ("pieces[1].shape", json!({}), "one of `box`"),
        ("pieces[0].shape.box.inner_mm[0]", json!(0), "out of range"),
        ("pieces[1].at_mm", json!([0, 1e300, 0]), "at most 20000 mm from the origin"),
        ("stages[0].at_mm", json!([0, 20001, 90]), "at most 20000 mm from the origin"),
        ("stages[0].at_mm", json!([0, 0, -500]), "below all pieces"),
        ("stages[0].at_mm", json!([0, 0, -11]), "a height of more than -10 mm"),
        ("stages[0].rate_g_per_s", Value::Null, "type"),
        ("stages[0].area_mm", json!([0, 80]), "above 0"),
        ("stages[0].area_mm[1]", json!(1e160), "at most 10000"),
        ("stages[0].sizes_mm", json!([8, 9]), "[8, 10]"),
        ("stages[1].travel_mm", json!(0), "out of range"),
        ("stages[1].ramp_s", json!(0.6), "at most 0.5 s"),
        ("stages[1].velocity_mm_per_s", json!([0, 0, 0]), "nothing would move"),
        ("stages[1].velocity_mm_per_s[2]", json!(1e160), "at most 10000000"),
    ] {
        assert_told(&faults(&changed(sound(), path, to)), path, words);
    }
    let load = json!({ "piece": "lid", "force_n": 1 });
    let sudden = json!({ "stage": "press", "loads": [load], "ramp_s": 1e-320 });
    let press = json!({ "stage": "press", "loads": [load], "ramp_s": 2, "time_limit_s": 1 });
    let sine = json!({ "amplitude_mm": [0, 0, 1], "frequency_hz": 10 });
    let sine = json!({ "stage": "move", "sine": sine, "duration_s": 0.55 });
    let turn = json!({ "axis": [0, 1, 0], "deg_per_s": 10 });
    let turn = json!({ "stage": "move", "rotation": turn, "travel_mm": 5 });
    let endless = json!({ "axis": [0, 1, 0], "deg_per_s": 1e-310 });
    let endless = json!({ "stage": "move", "rotation": endless, "travel_deg": 1 });
    let remove = json!({ "stage": "remove", "pieces": ["lid"] });
    let none = json!({ "stage": "remove", "pieces": ["lid", "box"] });
    let fast = json!({ "stage": "move", "velocity_mm_per_s": [0, 0, 5000000], "duration_s": 1 });
    let three = json!(["lid", "box", "gate"]);
    for (place, to, path, words) in [
        ("pieces[1].shape", json!({ "cube": 1 }), "pieces[1].shape.cube", "there is no such field"),
        ("stages[0].rate_g_per_s", json!(0.01), "stages[0].time_limit_s", "take longer"),
        ("stages[1].pieces", json!(["door"]), "stages[1].pieces[0]", "no such piece"),
        ("stages[1]", fast, "stages[1]", "a piece at its fastest"),
        ("stages[1]", press, "stages[1].ramp_s", "at most 1 s"),
        ("stages[1]", sudden, "stages[1].ramp_s", "at least 0.000000001"),
        ("stages[1]", sine, "stages[1].duration_s", "whole number of cycles"),
        ("stages[1]", turn, "stages[1].travel_mm", "no end of this motion"),
        ("stages[1]", endless, "stages[1].travel_deg", "would never end"),
        ("stages[2].pieces", json!(["lid", "lid"]), "stages[2].pieces[1]", "named twice"),
        ("stages[2].pieces", three, "stages[2].pieces[2]", "allowed: box, lid"),
        ("stages[3]", remove, "stages[3].pieces[0]", "removed before"),
        ("stages[1]", none, "stages[2].pieces[0]", "allowed: none: all pieces are removed"),
        ("stages[3]", json!({ "stage": "fill_funnel" }), "stages[3].stage", "built-in"),
    ] {
        assert_told(&faults(&changed(sound(), place, to)), path, words);
    }
    let stopped = faults(&changed(sound(), "stages[0].rate_g_per_s", json!(0)));
    assert_eq!(stopped.len(), 1, "law: no second fault of how long that takes, {stopped:?}");
    let mut without = sound();
    without.as_object_mut().expect("an object").remove("pieces");
    let found = faults(&without);
    assert!(found.iter().any(|(path, _)| path == "stages[0].stage"), "law: no pieces, {found:?}");
}

/// Law: sizes of pieces are large enough for faces that have an area; a hopper needs no collar.
#[test]
fn sizes_of_pieces_have_a_floor() {
    let hopper = |collar_mm: f64| {
        json!({ "hopper": { "opening_diameter_mm": 20, "top_diameter_mm": 60,
            "half_angle_deg": 30, "collar_mm": collar_mm } })
    };
    for (shape, field) in [
        (json!({ "disc": { "diameter_mm": 20, "thickness_mm": 1e-10 } }), "disc.thickness_mm"),
        (json!({ "vane": { "diameter_mm": 20, "height_mm": 1e-10 } }), "vane.height_mm"),
        (
            json!({ "cylinder": { "inner_diameter_mm": 1e-10, "height_mm": 9 } }),
            "cylinder.inner_diameter_mm",
        ),
        (json!({ "drum": { "inner_diameter_mm": 20, "length_mm": 1e-10 } }), "drum.length_mm"),
        (hopper(1e-10), "hopper.collar_mm"),
    ] {
        let value = changed(sound(), "pieces[1].shape", shape);
        assert_told(&faults(&value), &format!("pieces[1].shape.{field}"), "at least 0.001");
    }
    let bare = changed(sound(), "pieces[1].shape", hopper(0.0));
    assert_eq!(faults(&bare), [], "law: a hopper without a collar is one");
}

/// Law: what is moved about, and where something is measured, lies near enough for numbers that are
/// finite.
#[test]
fn places_that_overflow_are_refused() {
    let turn = json!({ "axis": [0, 1, 0], "about_mm": [0, 1e19, 0], "deg_per_s": 10 });
    let turn = json!({ "stage": "move", "rotation": turn, "travel_deg": 5 });
    let load = json!({ "piece": "lid", "moment_n_m": 1, "axis": [0, 0, 1],
        "about_mm": [1e308, 0, 0] });
    let press = json!({ "stage": "press", "loads": [load] });
    let region = json!({ "name": "core", "low_mm": [0, 0, -1e308], "high_mm": [1, 1e308, 1] });
    let mouth = json!({ "name": "mouth", "at_mm": [-1e308, 0, 0], "diameter_mm": 80 });
    let measures = json!({ "regions": [region], "openings": [mouth] });
    for (place, to, paths) in [
        ("stages[1]", turn, &["stages[1].rotation.about_mm[1]"][..]),
        ("stages[1]", press, &["stages[1].loads[0].about_mm[0]"]),
        (
            "measures",
            measures,
            &[
                "measures.openings[0].at_mm[0]",
                "measures.regions[0].high_mm[1]",
                "measures.regions[0].low_mm[2]",
            ],
        ),
    ] {
        let found = faults(&changed(sound(), place, to));
        for path in paths {
            assert_told(&found, path, "at least -1000000 and at most 1000000");
        }
    }
}

/// Law: decimals of a fraction do for a whole number of cycles, as for a table; more is a stop away
/// from its place.
#[test]
fn cycles_of_pieces_are_whole_as_those_of_a_table() {
    for (duration_s, is_whole) in [(2.0 / 3.0, true), (0.6667, true), (0.68, false)] {
        let sine = json!({ "amplitude_mm": [0, 0, 1], "frequency_hz": 3 });
        let stage = json!({ "stage": "move", "sine": sine, "duration_s": duration_s });
        let found = faults(&changed(sound(), "stages[1]", stage));
        assert_eq!(found.is_empty(), is_whole, "law: {duration_s} s at 3 Hz, got {found:?}");
    }
}

/// Law: what earlier stages have made of pieces and grains is known before anything is run: which
/// pieces are free, gone or pressed, and that no grain waits any more.
#[test]
fn what_earlier_stages_leave_is_known_beforehand() {
    let after = |stages: &[Value]| {
        let mut value = sound();
        let all = value["stages"].as_array_mut().expect("stages");
        all.truncate(1);
        all.extend(stages.iter().cloned());
        value
    };
    let release = |name: &str| json!({ "stage": "release", "pieces": [name] });
    let remove = |name: &str| json!({ "stage": "remove", "pieces": [name] });
    let press = json!({ "stage": "press", "loads": [{ "piece": "lid", "force_n": 1 }] });
    let lower = json!({ "stage": "move", "velocity_mm_per_s": [0, 0, -1], "travel_mm": 1 });
    let lower_lid = changed(lower.clone(), "pieces", json!(["lid"]));
    let force = json!({ "piece": "lid", "direction": [0, 0, 1], "force_n": 1 });
    let until = changed(remove("box"), "until", force);
    for (stages, at) in [
        (vec![release("lid"), release("box")], "stages[2].pieces"),
        (vec![remove("lid"), release("box")], "stages[2].pieces"),
        (vec![remove("lid"), remove("box"), lower.clone()], "stages[3].pieces"),
        (vec![remove("box"), press.clone(), lower.clone()], "stages[3].pieces"),
        (vec![remove("lid"), until.clone()], "stages[2].until.piece"),
    ] {
        assert_one(&after(&stages), at, "");
    }
    for stages in [
        vec![release("lid"), release("lid")],
        vec![release("lid"), lower_lid, release("box")],
        vec![press, lower.clone()],
        vec![remove("lid"), lower],
    ] {
        assert_eq!(faults(&after(&stages)), [], "law: something is left after {stages:?}");
    }
    let layer = |fields: &Value| {
        let mut stage = json!({ "stage": "deposit", "at_mm": [0, 0, 20], "area_mm": [80, 80],
            "how": "lattice" });
        small::put(&mut stage, fields);
        stage
    };
    let mut value = sound();
    let rain = value["stages"][0].clone();
    for (first, is_sound) in [
        (layer(&json!({})), false),
        (layer(&json!({ "mass_g": 50 })), true),
        (layer(&json!({ "sizes_mm": [8, 10] })), true),
        (rain.clone(), true),
    ] {
        value["stages"] = json!([first, rain]);
        match is_sound {
            true => assert_eq!(faults(&value), [], "law: some may be left by {first}"),
            false => assert_one(&value, "stages[1].stage", "no grain waits any more"),
        }
    }
}

/// Law: a travel or a time that is out of range is one fault: nothing says how long a ramp may be in
/// less than no time.
#[test]
fn a_travel_or_a_time_below_zero_is_a_single_fault() {
    let lid = json!({ "stage": "move", "pieces": ["lid"], "velocity_mm_per_s": [0, 0, 20] });
    let press = json!({ "stage": "press", "loads": [{ "piece": "lid", "force_n": 1 }] });
    for (stage, field) in [(lid.clone(), "travel_mm"), (lid, "duration_s"), (press, "time_limit_s")]
    {
        let mut value = changed(sound(), "stages[1]", stage);
        value["stages"][1][field] = json!(-3);
        assert_one(&value, &format!("stages[1].{field}"), "out of range");
    }
}

/// Law: as many pieces move as there may be, and no more are looked up.
#[test]
fn a_move_of_more_pieces_than_there_may_be_is_refused() {
    let value = changed(sound(), "stages[1].pieces", json!(vec!["lid"; 101]));
    assert_one(&value, "stages[1].pieces", "too long");
}

/// Law: pieces that are no list, or too many, are the only fault; stages and measures may speak of
/// any.
#[test]
fn pieces_that_are_no_list_are_no_second_fault() {
    let mut value = sound();
    let mouth = json!({ "name": "mouth", "at_mm": [0, 0, 50], "diameter_mm": 80 });
    value["measures"] = json!({ "openings": [mouth] });
    assert_eq!(faults(&value), [], "law: the sound one is sound");
    for pieces in [value["pieces"][0].clone(), json!("box"), Value::Null] {
        assert_one(&changed(value.clone(), "pieces", pieces), "pieces", "");
    }
    let many = json!(vec![value["pieces"][0].clone(); 255]);
    let allowed = "a list of at most 100 elements";
    assert_one(&changed(value, "pieces", many), "pieces", allowed);
}

#[test]
fn loads_are_checked_all_at_once_and_refused_where_no_engine_can_press() {
    let with = |loads: Value| {
        let mut value = sound();
        let stages = value["stages"].as_array_mut().expect("stages");
        stages.push(json!({ "stage": "press", "loads": loads }));
        let lid = json!({ "name": "cover", "shape": { "plate": { "size_mm": [20, 20, 5] } },
            "at_mm": [0, 0, 500] });
        value["pieces"].as_array_mut().expect("pieces").push(lid);
        value
    };
    let stage = sound()["stages"].as_array().expect("stages").len();
    let good = with(json!([{ "piece": "cover", "stress_kpa": 5 }]));
    assert_eq!(faults(&good), [], "law: a good load");
    let bad = with(json!([
        { "piece": "cover", "stress_kpa": 5, "force_n": 2 },
        { "piece": "cover", "direction": [0, 0, 0] },
        { "piece": "box", "force_n": 2 },
        { "piece": "nobody", "locked": true, "axis": [0, 0, 1] },
        { "piece": "lid", "moment_n_m": 1 }
    ]));
    let found = faults(&bad);
    for (field, words) in [
        ("loads[0].force_n", "a force, a stress, a moment or a lock"),
        ("loads[1].piece", "two loads"),
        ("loads[1].direction", "no direction"),
        ("loads[1].force_n", "a force, a stress, a moment or a lock"),
        ("loads[3].piece", "no such piece"),
        ("loads[3].axis", "only a moment has an axis"),
        ("loads[4].axis", "a moment needs its axis"),
    ] {
        assert_told(&found, &format!("stages[{stage}].{field}"), words);
    }
    for (engine, name) in other_engines() {
        let mut value = good.clone();
        value["engine"] = engine;
        let path = format!("stages[{stage}].stage");
        assert_told(&faults(&value), &path, &format!("{name} cannot press"));
    }
}

/// A lid is lowered while a pressed cover keeps the mean stress, as `keep` has it.
fn kept(keep: Value) -> Value {
    let mut value = sound();
    let plate = |name: &str, z: f64| json!({ "name": name, "shape": { "plate": { "size_mm": [20, 20, 5] } }, "at_mm": [0, 0, z] });
    let pieces = value["pieces"].as_array_mut().expect("pieces");
    pieces.extend([plate("cover", 400.0), plate("vane", 450.0), plate("block", 500.0)]);
    value["measures"] = json!({ "regions": [
        { "name": "core", "low_mm": [-10, -10, 10], "high_mm": [10, 10, 20] }] });
    let stages = value["stages"].as_array_mut().expect("stages");
    let at = stages.len() - 2;
    stages.insert(
        at,
        json!({ "stage": "press", "loads": [{ "piece": "cover", "force_n": 5 },
        { "piece": "vane", "moment_n_m": 1, "axis": [0, 0, 1] }] }),
    );
    stages.insert(at + 1, json!({ "stage": "release", "pieces": ["block"] }));
    stages.insert(
        at + 2,
        json!({ "stage": "move", "pieces": ["lid"], "travel_mm": 1,
        "velocity_mm_per_s": [0, 0, -5], "keep_mean_stress": keep }),
    );
    value
}

#[test]
fn a_mean_stress_is_kept_by_pieces_that_a_force_presses_and_by_no_others() {
    let keep = |pieces: &[&str]| json!({ "region": "core", "pieces": pieces });
    let good = kept(keep(&["cover"]));
    assert_eq!(faults(&good), [], "law: a pressed cover can keep it");
    let with = good["stages"].as_array().expect("stages");
    let moves = |stage: &&Value| stage.get("keep_mean_stress").is_some();
    let at = with.iter().position(|stage| moves(&stage)).expect("it moves");
    let told = |value: &Value, field: &str, words: &str| {
        assert_told(&faults(value), &format!("stages[{at}].keep_mean_stress.{field}"), words);
    };
    // All at once.
    let names = ["nobody", "cover", "cover", "lid", "vane", "block", "box"];
    let mut bad = kept(json!({ "region": "rim", "pieces": names, "window_s": 0 }));
    told(&bad, "window_s", "out of range");
    bad["stages"][at]["keep_mean_stress"]["window_s"] = json!(0.1);
    for (field, words) in [
        ("region", "no such region (found \"rim\"; allowed: core)"),
        ("pieces[0]", "no such piece (found \"nobody\"; allowed: cover)"),
        ("pieces[2]", "named twice (found \"cover\"; allowed: each piece once)"),
        ("pieces[3]", "moved by this stage"),
        ("pieces[4]", "a moment turns the piece"),
        ("pieces[5]", "moves freely"),
        ("pieces[6]", "no force presses the piece"),
    ] {
        told(&bad, field, words);
    }
    told(&kept(keep(&[])), "pieces", "too short");
    told(
        &kept(json!({ "region": "core", "pieces": ["cover"], "gain": 1 })),
        "gain",
        "no such field",
    );
    let mut locked = kept(keep(&["cover"]));
    locked["stages"][at - 2]["loads"][0] = json!({ "piece": "cover", "locked": true });
    told(&locked, "pieces[0]", "no force presses the piece");
    for (engine, name) in other_engines() {
        let mut value = good.clone();
        value["engine"] = engine;
        told(&value, "pieces", &format!("{name} cannot press"));
    }
    let without: Scenario = serde_json::from_value(sound()).expect("a scenario");
    let text = serde_json::json!(without).to_string();
    assert!(!text.contains("keep_mean_stress"), "law: keys of other stages stay, {text}");
}

#[test]
fn pieces_that_are_let_go_are_checked_and_refused_where_no_engine_can() {
    let stage = sound()["stages"].as_array().expect("stages").len();
    let with = |names: &[&str]| {
        let mut value = sound();
        let stages = value["stages"].as_array_mut().expect("stages");
        stages.push(json!({ "stage": "release", "pieces": names, "mass_g": 50 }));
        let block = |name: &str, x: f64| {
            json!({ "name": name, "at_mm": [x, 0, 300],
                "shape": { "vane": { "diameter_mm": 20, "height_mm": 20 } } })
        };
        let mut cross = block("cross", 40.0);
        cross["may_cross"] = json!(true);
        value["pieces"].as_array_mut().expect("pieces").extend([block("block", 0.0), cross]);
        value
    };
    let good = with(&["block"]);
    assert_eq!(faults(&good), [], "law: a vane can be let go");
    let all = ["box", "lid", "block", "cross"];
    let mut thick = good.clone();
    let last = thick["pieces"].as_array().expect("pieces").len() - 1;
    thick["pieces"][last]["shape"]["vane"]["blade_mm"] = json!(25);
    let [rapier, stock] = other_engines().map(|(engine, _)| {
        let mut value = good.clone();
        value["engine"] = engine;
        value
    });
    for (value, field, words) in [
        (with(&["nobody"]), "pieces[0]", "no such piece"),
        (with(&["cross"]), "pieces[0]", "collides with the pieces"),
        (with(&all), "pieces", "nothing is left that could carry"),
        (with(&[]), "pieces", "too short"),
        (rapier, "stage", "rapier moves no piece freely"),
        (stock, "stage", "stock contacts moves no piece freely"),
    ] {
        assert_told(&faults(&value), &format!("stages[{stage}].{field}"), words);
    }
    let second = format!("stages[{stage}].pieces[1]");
    assert_one(&with(&["block", "block"]), &second, "named twice");
    // No blades are left.
    assert_told(&faults(&thick), &format!("pieces[{last}].shape.vane.blade_mm"), "");
}

/// Law: a hopper that no coarse grain can leave is refused as the funnel is, but not where it is turned
/// over, nor where deposits choose among sizes.
#[test]
fn a_hopper_narrower_than_a_grain_is_refused() {
    let hopper = |opening: f64| {
        json!({ "hopper": { "opening_diameter_mm": opening, "top_diameter_mm": 90,
            "half_angle_deg": 30 } })
    };
    let of = |opening: f64| changed(sound(), "pieces[1].shape", hopper(opening));
    let path = "pieces[1].shape.hopper.opening_diameter_mm";
    assert_one(&of(5.0), path, "leave the hopper (found 5; allowed: more than 10 mm, and 5 median");
    assert_eq!(faults(&of(40.0)), [], "law: one that they can leave is sound");
    let turned = changed(of(5.0), "pieces[1].rotation_deg", json!([180, 0, 0]));
    assert_eq!(faults(&turned), [], "law: of a roof nothing is said");
    let chosen = changed(of(5.0), "stages[0].sizes_mm", json!([0, 100]));
    assert_eq!(faults(&chosen), [], "law: the coarsest grains may not come to it");
}

#[test]
fn what_does_not_suit_is_reported_and_pieces_in_each_other_are_refused() {
    let of = |value: Value| -> Scenario { serde_json::from_value(value).expect("a scenario") };
    let narrow = changed(
        sound(),
        "pieces[1].shape",
        json!({ "hopper": { "opening_diameter_mm": 40, "top_diameter_mm": 90, "half_angle_deg": 30 } }),
    );
    let told = warnings(&of(narrow));
    assert!(told.iter().any(|text| text.contains("may jam")), "law: 40 mm < 5 × 9 mm, {told:?}");
    let heavy = changed(sound(), "grains.total_mass_g", json!(2000));
    let told = warnings(&of(heavy));
    assert!(
        told.iter().any(|text| text.contains("over the rims")),
        "law: 1.6 of 1 litre, {told:?}"
    );
    let within = changed(sound(), "pieces[1].at_mm", json!([0, 0, 100]));
    let error = Setup::new(&of(within)).expect_err("law: the lid is in the walls").to_string();
    assert!(error.contains("`box` and `lid`"), "{error}");
}

/// Law: pieces in each other are a fault of the file, at the place of the later one, beside all
/// others.
#[test]
fn pieces_in_each_other_are_faults_of_the_scenario() {
    let mut within = changed(sound(), "pieces[1].at_mm", json!([0, 0, 100]));
    let words = "overlap (found [0.0, 0.0, 100.0]; allowed: a place where they touch";
    assert_told(&faults(&within), "pieces[1].at_mm", &format!("`box` and `lid` {words}"));
    within["rest_test_s"] = json!(-1);
    within["pieces"][1]["name"] = json!("box");
    let found = faults(&within);
    assert_told(&found, "pieces[1].at_mm", words);
    assert_told(&found, "pieces[1].name", "two pieces have this name");
    assert_told(&found, "stages[1].pieces[0]", "no such piece");
    assert_told(&found, "rest_test_s", "out of range");
}
