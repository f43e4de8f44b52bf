//! Conditions that end stages, recorded motions and meshes of pieces: what is answered where they
//! make no sense, and what a run leaves of them.

use std::{fs, path::Path};

use pluvia::grains::load_scenario;
use pluvia::scenario::{MoveSpec, StageSpec};
use serde_json::{Value, json};

use super::{
    program::{self, done, text},
    scenario::{assert_told, changed, told},
    small,
};

/// A box with a lid that is lowered and pressed.
fn sound() -> Value {
    json!({
        "name": "ends",
        "grains": small::fine(25.0),
        "pieces": [
            { "name": "box", "shape": { "box": { "inner_mm": [40, 40, 90] } } },
            { "name": "lid", "shape": { "plate": { "size_mm": [38, 38, 10] } }, "at_mm": [0, 0, 120] }
        ],
        "measures": {
            "openings": [{ "name": "mouth", "at_mm": [0, 0, 50], "diameter_mm": 80 }],
            "groups": [{ "name": "all", "pieces": ["box", "lid"] }]
        },
        "stages": [
            { "stage": "deposit", "at_mm": [0, 0, 70], "area_mm": [30, 30], "rate_g_per_s": 100 },
            { "stage": "move", "pieces": ["lid"], "velocity_mm_per_s": [0, 0, -100], "ramp_s": 0.02,
              "until": { "piece": "lid", "direction": [0, 0, 1], "force_n": 3, "window_s": 0.02 },
              "time_limit_s": 2 },
            { "stage": "press", "loads": [{ "piece": "lid", "force_n": 20 }],
              "until": [
                  { "piece": "lid", "direction": [0, 0, 1], "steady_force_percent": 30,
                    "window_s": 0.05 },
                  { "piece": "all", "direction": [0, 0, -1], "force_n": 1e6 }] }
        ],
        "rest_test_s": 0
    })
}

fn write(folder: &Path, value: &Value) -> std::path::PathBuf {
    program::write(folder, "scenario.json", value)
}

/// Paths and texts of the faults of a scenario's file in a folder.
fn faults_in(folder: &Path, value: &Value) -> Vec<(String, String)> {
    told(load_scenario(&write(folder, value), &[]))
}

#[track_caller]
fn expect(folder: &Path, value: &Value, path: &str, words: &str) {
    assert_told(&faults_in(folder, value), path, words);
}

/// Runs a scenario without figures.
fn run(scenario: &Path, out: &Path) {
    done(&["run", text(scenario), "--out", text(out), "--quiet", "--no-figures"]);
}

/// Law: a piece that an earlier run, or a stage that cannot be read, may have pressed may move: its
/// displacement may end a stage that does not name it.
#[test]
fn a_piece_that_was_pressed_before_may_move() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    let remove = json!({ "stage": "remove", "pieces": ["box"],
        "until": { "piece": "lid", "moved_mm": 1 } });
    let still = changed(sound(), "stages[2]", remove.clone());
    let still = changed(still, "stages[1]", json!({ "stage": "rest", "duration_s": 1 }));
    assert_told(&faults_in(folder, &still), "stages[2].until.piece", "does not move");
    let unread = changed(still, "stages[1]", json!({ "stage": "press", "loads": 1 }));
    let found = faults_in(folder, &unread);
    assert!(found.iter().all(|(at, _)| at.starts_with("stages[1]")), "law: alone, got {found:?}");
    // A run of which the manifest is enough here.
    let run = folder.join("run");
    fs::create_dir_all(run.join("stages")).expect("a folder");
    fs::write(run.join("grains.json"), "{}").expect("written");
    let stage = json!({ "stage": "press", "key": "a", "specimen_sha256": "b" });
    let manifest = json!({ "scenario": sound(), "stages": [stage] });
    fs::write(run.join("manifest.json"), manifest.to_string()).expect("written");
    let begun = json!({ "name": "begun", "begin": { "specimen": run }, "stages": [remove] });
    assert_eq!(faults_in(folder, &begun), [], "law: the run has pressed it");
}

#[test]
fn conditions_are_checked_with_what_they_need() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    assert_eq!(faults_in(folder, &sound()), [], "law: the sound one is sound");
    let until = |to: Value| changed(sound(), "stages[1].until", to);
    let up = json!([0, 0, 1]);
    for (condition, field, words) in [
        (json!({}), "until.force_n", "ends by one condition"),
        (
            json!({ "piece": "lid", "direction": up, "force_n": 1, "moved_mm": 1 }),
            "until.force_n",
            "ends by one condition",
        ),
        (json!({ "direction": up, "force_n": 1 }), "until.piece", "is that of one"),
        (json!({ "piece": "lid", "force_n": 1 }), "until.direction", "along a direction"),
        (
            json!({ "piece": "lid", "direction": [0, 0, 0], "force_n": 1 }),
            "until.direction",
            "nothing counts along it",
        ),
        (json!({ "piece": "door", "moved_mm": 1 }), "until.piece", "allowed: box, lid, all"),
        (json!({ "piece": "box", "moved_mm": 1 }), "until.piece", "does not move"),
        (
            json!({ "piece": "lid", "moved_mm": 1, "window_s": 1 }),
            "until.window_s",
            "means nothing with `moved_mm`",
        ),
        (json!({ "piece": "box", "turned_deg": 1 }), "until.piece", "does not move"),
        (
            json!({ "piece": "lid", "turned_deg": 1, "direction": up }),
            "until.direction",
            "means nothing with `turned_deg`",
        ),
        (json!({ "piece": "lid", "turned_deg": 181 }), "until.turned_deg", "allowed: at most 180"),
        (json!({ "flow_below_g_per_s": 1 }), "until.opening", "is that of one"),
        (json!({ "opening": "gap", "steady_flow_percent": 1 }), "until.opening", "allowed: mouth"),
        (
            json!({ "opening": "mouth", "piece": "lid", "flow_below_g_per_s": 1 }),
            "until.piece",
            "means nothing with `flow_below_g_per_s`",
        ),
        (json!({ "piece": "lid", "moved_mm": 0 }), "until.moved_mm", "out of range"),
        (json!({ "piece": "lid", "moved": 1 }), "until.moved", "there is no such field"),
    ] {
        expect(folder, &until(condition), &format!("stages[1].{field}"), words);
    }
    let mut unopened = until(json!({ "opening": "mouth", "steady_flow_percent": 1 }));
    unopened["measures"].as_object_mut().expect("measures").remove("openings");
    let none = "one of `measures.openings`, which has none";
    expect(folder, &unopened, "stages[1].until.opening", none);
    let turn = json!({ "stage": "press", "loads": [{ "piece": "lid", "moment_n_m": 1,
        "axis": [0, 0, 1] }], "until": { "piece": "lid", "turned_deg": 400 } });
    let turned = changed(sound(), "stages[2]", turn);
    assert_eq!(faults_in(folder, &turned), [], "law: of a moment the whole angle is known");
    // All at once.
    let many = until(json!({ "piece": "door", "opening": "gap", "force_n": 1 }));
    let found = faults_in(folder, &many);
    assert_eq!(found.len(), 4, "law: no piece, no opening, opening idle, no direction: {found:#?}");
    for (piece, fits) in [("all", true), ("lid", true)] {
        let moved = until(json!({ "piece": piece, "moved_mm": 1 }));
        assert_eq!(faults_in(folder, &moved).is_empty(), fits, "law: {piece} moves");
    }
    // The lid goes down by 100 mm/s for 2 s, of which it takes 0.02 s to grow and die away.
    for (condition, fits) in [
        (json!({ "piece": "lid", "moved_mm": 198 }), true),
        (json!({ "piece": "lid", "moved_mm": 198.1 }), false),
        (json!({ "piece": "lid", "moved_mm": 140, "direction": [0, 1, -1] }), true),
        (json!({ "piece": "lid", "moved_mm": 141, "direction": [0, 1, -1] }), false),
        (json!({ "piece": "lid", "moved_mm": 1, "direction": [0, 0, 1] }), false),
    ] {
        let value = until(condition.clone());
        match fits {
            true => assert_eq!(faults_in(folder, &value), [], "law: reached: {condition}"),
            false => expect(folder, &value, "stages[1].until.moved_mm", "does not carry"),
        }
    }
    // Several: each is checked where it stands.
    let good = json!({ "piece": "lid", "moved_mm": 1 });
    let bad = json!({ "piece": "door", "moved_mm": 1 });
    let odd = json!({ "piece": "lid", "moved_mm": "1", "force": 2 });
    for (several, faults) in [
        (json!([good, good]), vec![]),
        (json!({ "all_of": [good] }), vec![]),
        (json!([]), vec![("until", "too short")]),
        (json!({ "all_of": [] }), vec![("until.all_of", "too short")]),
        (json!([good, bad]), vec![("until[1].piece", "no such piece")]),
        (json!({ "all_of": [bad] }), vec![("until.all_of[0].piece", "no such piece")]),
        (
            json!([good, odd]),
            vec![("until[1].moved_mm", "wrong type"), ("until[1].force", "no such field")],
        ),
        (json!({ "all_of": [good], "piece": "lid" }), vec![("until.piece", "no such field")]),
        (json!("lid"), vec![("until", "wrong type")]),
    ] {
        let value = until(several);
        let found = faults_in(folder, &value);
        assert_eq!(found.len(), faults.len(), "law: these faults alone, got {found:#?}");
        for (field, words) in faults {
            expect(folder, &value, &format!("stages[1].{field}"), words);
        }
    }
    let mut value = sound();
    value["stages"][1].as_object_mut().expect("a stage").remove("time_limit_s");
    expect(folder, &value, "stages[1].time_limit_s", "for ever");
    let mut value = sound();
    value["stages"][1]["travel_mm"] = json!(5);
    expect(folder, &value, "stages[1].duration_s", "a motion has one end");
    let mut value = sound();
    value["stages"][1].as_object_mut().expect("a stage").remove("until");
    value["stages"][1]["duration_s"] = json!(0.1);
    expect(folder, &value, "stages[1].time_limit_s", "limit of a motion with `until`");
}

/// Law: where one of several fields is to be given, a fault names those that are.
#[test]
fn fields_of_which_one_is_to_be_given_are_named() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    let plate = json!({ "plate": { "size_mm": [9, 9, 9] }, "disc": {
        "diameter_mm": 9, "thickness_mm": 9 } });
    let turn = json!({ "axis": [0, 0, 1], "deg_per_s": 9 });
    for (at, to, path, words) in [
        ("stages[1].duration_s", json!(1), "stages[1].duration_s", "found duration_s, until;"),
        (
            "stages[1].rotation",
            turn,
            "stages[1].velocity_mm_per_s",
            "found velocity_mm_per_s, rotation;",
        ),
        ("stages[0].diameter_mm", json!(9), "stages[0].area_mm", "found area_mm, diameter_mm;"),
        ("pieces[1].shape", plate, "pieces[1].shape", "found plate, disc;"),
    ] {
        expect(folder, &changed(sound(), at, to), path, words);
    }
}

#[test]
fn what_ended_a_stage_stands_in_the_summary() {
    let folder = tempfile::tempdir().expect("a folder");
    let scenario = write(folder.path(), &sound());
    let out = folder.path().join("out");
    run(&scenario, &out);
    let summary = program::json(&out.join("summary.json"));
    let of = |stage: usize| &summary["stages"][stage]["until"];
    assert_eq!(*of(0), Value::Null, "law: a deposit has no condition");
    let number = |value: &Value| value.as_f64().unwrap_or_else(|| panic!("a number, got {value}"));
    assert_eq!(of(1)["reached"], json!(true), "law: the lid meets grains, {}", of(1));
    let (force, at) = (number(&of(1)["force_n"]), number(&of(1)["at_s"]));
    assert!(force >= 3.0, "law: 3 N at least, got {force} N");
    let lasted = number(&summary["stages"][1]["duration_s"]);
    assert!((lasted - at - 0.02).abs() < 3e-3, "law: a ramp later it is over, {lasted} s");
    assert_eq!(of(2)["reached"], json!(true), "law: the force becomes steady, {}", of(2));
    let [steady, force] = &of(2)["conditions"].as_array().expect("two")[..] else {
        panic!("law: each is reported, {}", of(2));
    };
    assert!(number(&steady["change_percent"]) <= 30.0, "law: within 30 %, {steady}");
    assert_eq!((&steady["reached"], &force["reached"]), (&json!(true), &json!(false)));
    assert_eq!(steady["condition"], json!("`steady_force_percent` of `lid`"), "law: it is named");
}

#[test]
fn a_recorded_motion_moves_pieces_and_is_checked_beforehand() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    let recorded = |file: &str| {
        let mut value = sound();
        value["stages"] = json!([value["stages"][0],
            { "stage": "move", "pieces": ["lid"], "motion_file": file, "interpolation": "linear" }]);
        value
    };
    fs::write(folder.join("down.csv"), "time_s,x_mm,z_mm\n5,0,0\n5.5,0,-10\n6,2,-10\n")
        .expect("csv");
    let loaded = load_scenario(&write(folder, &recorded("down.csv")), &[]);
    let scenario = loaded.unwrap_or_else(|e| panic!("{e}")).scenario;
    let motion = scenario.stages[1].piece_motion().expect("a motion");
    assert_eq!(motion.duration, 1.0, "law: from the first row to the last");
    let at = motion.displacement(1.0).translation.vector * 1e3;
    assert!((at.x - 2.0).abs() + (at.z + 10.0).abs() < 1e-12, "law: its last row, got {at}");
    let StageSpec::Move(MoveSpec { motion_file: None, motion_rows: Some(rows), .. }) =
        &scenario.stages[1]
    else {
        panic!("law: rows stand in place of the file, {:?}", scenario.stages[1]);
    };
    assert_eq!(rows.len(), 3);
    fs::write(folder.join("fast.csv"), "time_s,x_mm\n0,0\n0.001,9000\n").expect("csv");
    expect(folder, &recorded("fast.csv"), "stages[1]", "a piece at its fastest");
    fs::write(folder.join("still.csv"), "time_s,x_mm\n0,1\n1,1\n").expect("csv");
    expect(folder, &recorded("still.csv"), "stages[1].motion_rows", "nothing would move");
    fs::write(folder.join("back.csv"), "time_s,x_mm\n0,1\n0,2\n").expect("csv");
    expect(folder, &recorded("back.csv"), "stages[1].motion_file", "does not grow");
    expect(folder, &recorded("none.csv"), "stages[1].motion_file", "cannot be read");
    let mut value = recorded("down.csv");
    value["stages"][1]["duration_s"] = json!(1);
    value["stages"][1]["ramp_s"] = json!(0.1);
    expect(folder, &value, "stages[1].duration_s", "ends with its last");
    expect(folder, &value, "stages[1].ramp_s", "ends with its last");
    value["stages"][1]["velocity_mm_per_s"] = json!([0, 0, 1]);
    expect(folder, &value, "stages[1].velocity_mm_per_s", "a `move` has one motion");
    // Ended early, within a ramp.
    let mut value = recorded("down.csv");
    value["stages"][1]["ramp_s"] = json!(0.1);
    value["stages"][1]["until"] = json!([{ "piece": "lid", "moved_mm": 4 }]);
    assert_eq!(faults_in(folder, &value), [], "law: a recorded motion takes a condition");
    value["stages"][1]["time_limit_s"] = json!(1);
    expect(folder, &value, "stages[1].time_limit_s", "with its last row at the latest");
    let moved = json!({ "piece": "lid", "moved_mm": 1 });
    let mut value = changed(sound(), "stages[1].until", moved);
    value["stages"][1]["interpolation"] = json!("linear");
    expect(folder, &value, "stages[1].interpolation", "has rows to join");
}

/// Two blocks of a unit cube each, 3 apart along x, as one object; unit: cm.
fn two_blocks(high: f64) -> String {
    let mut text = "o blocks\n".to_owned();
    for (n, from) in [0.0, 3.0].into_iter().enumerate() {
        for corner in 0..8 {
            let at = |axis: usize| f64::from(corner >> axis & 1);
            text += &format!("v {} {} {}\n", from + at(0), at(1), high * at(2));
        }
        for face in
            [[1, 3, 4, 2], [5, 6, 8, 7], [1, 2, 6, 5], [3, 7, 8, 4], [1, 5, 7, 3], [2, 4, 8, 6]]
        {
            let [a, b, c, d] = face.map(|corner| corner + 8 * n);
            text += &format!("f {a} {b} {c} {d}\n");
        }
    }
    text
}

#[test]
fn a_mesh_is_a_piece_of_its_convex_parts_and_shows_in_pictures() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    fs::write(folder.join("blocks.obj"), two_blocks(2.0)).expect("written");
    let of = |file: &str| {
        let mut value = sound();
        // The upper side of the first is the floor.
        let mesh = json!({ "name": "blocks", "at_mm": [-50, -50, -200],
            "shape": { "mesh": { "file": file, "scale_to_mm": 100 } } });
        value["pieces"] = json!([mesh]);
        value["measures"] = json!({});
        value["stages"] = json!([value["stages"][0]]);
        value
    };
    let scenario = write(folder, &of("blocks.obj"));
    let loaded = load_scenario(&scenario, &[]).unwrap_or_else(|e| panic!("{e}")).scenario;
    let mesh = loaded.pieces[0].shape.mesh.as_ref().expect("a mesh");
    assert_eq!((mesh.file.as_ref(), mesh.parts().len()), (None, 2), "law: parts, and no file");
    let told = |of: &pluvia::scenario::Scenario| {
        pluvia::scenario::warnings(of).iter().any(|w| w.to_string().contains("in metres"))
    };
    assert!(!told(&loaded), "law: 245 mm from corner to corner are no grain's");
    let mut in_metres = of("blocks.obj");
    in_metres["pieces"][0]["shape"]["mesh"]["scale_to_mm"] = json!(1);
    let small = load_scenario(&write(folder, &in_metres), &[]).unwrap_or_else(|e| panic!("{e}"));
    assert!(told(&small.scenario), "law: 2.4 mm are less than a grain");
    let setup = pluvia::protocol::Setup::new(&loaded).expect("a laboratory");
    let volume = setup.pieces[0].volume() * 1e9;
    assert!((volume - 4e6).abs() < 1e-3, "law: two of 100 × 100 × 200 mm, got {volume} mm³");
    // Without its file the scenario of a run folder means the same.
    let kept = serde_json::to_value(&loaded).expect("JSON");
    let again = load_scenario(&write(&folder.join("."), &kept), &[]);
    assert_eq!(again.unwrap_or_else(|e| panic!("{e}")).scenario.pieces, loaded.pieces);

    let scenario = write(folder, &of("blocks.obj"));
    let out = folder.join("out");
    run(&scenario, &out);
    let shown = |walls: &str| {
        let picture = folder.join(format!("{walls}.png"));
        let look = ["--width", "160", "--height", "120", "--no-key", "--cylinder", walls];
        let args = ["picture", text(&out), "--out", text(&picture)];
        done(&[&args[..], &look].concat());
        fs::read(picture).expect("a picture")
    };
    assert_ne!(shown("transparent"), shown("hidden"), "law: a mesh, the only piece, is drawn");

    let mut both = of("blocks.obj");
    both["pieces"][0]["shape"]["mesh"]["parts"] = json!([]);
    expect(folder, &both, "pieces[0].shape.mesh.file", "one source");
    expect(folder, &of("none.obj"), "pieces[0].shape.mesh.file", "cannot be read");
    fs::write(folder.join("open.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").expect("written");
    expect(folder, &of("open.obj"), "pieces[0].shape.mesh.file", "open.obj");
    let inside_out = json!([{ "vertices_mm": [[0, 0, 0], [9, 0, 0], [0, 9, 0], [0, 0, 9]],
        "faces": [[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]] }]);
    let mut value = of("blocks.obj");
    value["pieces"][0]["shape"]["mesh"] = json!({ "parts": inside_out });
    expect(folder, &value, "pieces[0].shape.mesh.parts[0]", "closed convex surface");
    // Several parts are pressed as one body.
    let mut value = of("blocks.obj");
    let press = json!({ "stage": "press", "loads": [{ "piece": "blocks", "force_n": 1 }] });
    value["stages"].as_array_mut().expect("stages").push(press);
    assert_eq!(faults_in(folder, &value), [], "law: a mesh of two parts can be pressed");
}
