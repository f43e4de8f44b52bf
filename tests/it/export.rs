//! `pluvia export`: what a run left, for other programs.

use std::{
    fs,
    path::{Path, PathBuf},
    process::{Command, Output},
    sync::OnceLock,
};

use pluvia::export::{Carrier, Scene, read_playback, read_run};
use pluvia::geometry::Pose;
use tempfile::TempDir;

use super::small;

/// Thirty grams of gravel poured and shaken for a moment, once for all tests.
pub fn small_run() -> &'static Path {
    static RUN: OnceLock<(TempDir, PathBuf)> = OnceLock::new();
    let (_, out) = RUN.get_or_init(|| {
        let folder = tempfile::tempdir().expect("a folder");
        let scenario = folder.path().join("small.json");
        let content = small::scenario(30.0, 0.25, 0.1);
        fs::write(&scenario, content.to_string()).expect("a scenario file");
        let out = folder.path().join("run");
        let args = ["run", "--quiet", "--out"];
        let mut command = Command::new(env!("CARGO_BIN_EXE_pluvia"));
        let output = command.args(args).arg(&out).arg(&scenario).output().expect("it starts");
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        (folder, out)
    });
    out
}

fn export(run: &Path, more: &[&str], out: &Path) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_pluvia"));
    command.arg("export").arg(run).args(more).arg("--out").arg(out);
    command.output().expect("it starts")
}

fn done(run: &Path, more: &[&str], out: &Path) {
    let output = export(run, more, out);
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{more:?}: {said}");
}

fn scene(out: &Path) -> Scene {
    let text = fs::read(out.join("scene.json")).expect("scene.json");
    let scene: Scene = serde_json::from_slice(&text).expect("a scene");
    scene.check().expect("its format and version");
    scene
}

#[test]
fn the_scene_is_the_specimen() {
    let folder = tempfile::tempdir().expect("a folder");
    done(small_run(), &["--format", "json"], folder.path());
    let got = scene(folder.path());
    let run = read_run(small_run(), None).expect("the run can be read");
    assert_eq!(got, run.scene().expect("a scene"), "law: the file holds every bit");
    assert_eq!(got.made_by.stage, "vibrate", "law: the last stage is taken");
    assert!(got.table.motion.is_none(), "law: nothing follows the last stage");
    assert_eq!(got.apparatus.len(), 49, "48 walls and the floor; the funnel is gone");
    assert!(got.apparatus.iter().all(|p| p.motion == Carrier::Table), "law: they shake");
    let plate = got.top_plate.as_ref().expect("the plate lies on the grains");
    assert!((plate.mass_kg - 0.104).abs() < 1e-12, "the plate weighs 104 g, got {}", plate.mass_kg);
    for (grain, state) in got.grains.iter().zip(run.specimen.present()) {
        assert_eq!(grain.grain, state, "law: grains carry their numbers");
        let volume = grain.shape.signed_volume();
        assert!(
            (volume / grain.volume_m3 - 1.0).abs() < 1e-9,
            "law: the faces enclose the volume, expected {}, got {volume}",
            grain.volume_m3
        );
        assert!(
            (grain.mass_kg / grain.volume_m3 / 2673.9 - 1.0).abs() < 1e-9,
            "law: mass = density · volume, got {}",
            grain.mass_kg
        );
    }
    // In equilibrium but for what still moves, contacts carry the weight of the plate.
    let carried: f64 = got
        .contacts
        .iter()
        .map(|c| match (c.between[0].as_str(), c.between[1].as_str()) {
            ("top_plate", _) => c.force_n.z,
            (_, "top_plate") => -c.force_n.z,
            _ => 0.0,
        })
        .sum();
    assert!(carried >= 0.0, "law: what is under the plate pushes it up, got {carried} N");
}

#[test]
fn an_earlier_stage_can_be_chosen_and_carries_what_follows() {
    let folder = tempfile::tempdir().expect("a folder");
    done(small_run(), &["--format", "json", "--stage", "place_top_plate"], folder.path());
    let named = scene(folder.path());
    let law = named.table.motion.expect("law: the vibration that follows");
    assert_eq!((law.amplitude_m, law.frequency_hz, law.duration_s), (0.01, 4.0, 0.25));
    done(small_run(), &["--format", "json", "--stage", "2"], folder.path());
    assert_eq!(scene(folder.path()), named, "law: number and name say the same");
    done(small_run(), &["--format", "json", "--stage", "fill_funnel"], folder.path());
    let filled = scene(folder.path());
    assert_eq!(filled.apparatus.len(), 33, "32 funnel pieces and the lid, no cylinder yet");
    assert!(filled.apparatus.iter().all(|p| p.motion == Carrier::Fixed));
    done(small_run(), &["--format", "json", "--stage", "control"], folder.path());
    assert_eq!(scene(folder.path()).made_by.stage, "control");
}

#[test]
fn a_run_of_many_shares_grains_and_stages_with_the_others() {
    let folder = tempfile::tempdir().expect("a folder");
    let run = folder.path().join("runs/one");
    fs::create_dir_all(&run).expect("a folder");
    for file in ["manifest.json", "specimen.json"] {
        fs::copy(small_run().join(file), run.join(file)).expect("a copy");
    }
    fs::copy(small_run().join("grains.json"), folder.path().join("grains.json")).expect("a copy");
    std::os::unix::fs::symlink(small_run().join("stages"), folder.path().join("stages"))
        .expect("a link");
    for stage in [None, Some("pour")] {
        let expected = read_run(small_run(), stage).expect("the run itself");
        let got = read_run(&run, stage).expect("a run below `runs`");
        assert_eq!(got, expected, "law: the same run, stage {stage:?}");
    }
}

#[test]
fn tables_have_a_row_each_and_meshes_lie_in_the_cylinder() {
    let folder = tempfile::tempdir().expect("a folder");
    done(small_run(), &["--format", "csv"], folder.path());
    let run = read_run(small_run(), None).expect("the run can be read");
    let rows = |name: &str| -> Vec<String> {
        let text = fs::read_to_string(folder.path().join(name)).expect(name);
        text.lines().map(str::to_owned).collect()
    };
    let grains = rows("grains.csv");
    assert!(grains[0].contains("mass_kg,volume_m3"), "{}", grains[0]);
    assert_eq!(grains.len() - 1, run.specimen.grains.grains.len(), "law: a row a grain");
    assert_eq!(rows("contacts.csv").len() - 1, run.specimen.state.contacts.len());
    assert!(rows("pairs.csv")[0].ends_with("gap_m,overlap_percent"));

    done(small_run(), &["--format", "obj"], folder.path());
    let mesh = rows("grains.obj");
    let objects = mesh.iter().filter(|l| l.starts_with("o grain_")).count();
    assert_eq!(objects, run.specimen.present().count(), "law: an object a grain");
    for line in mesh.iter().filter(|l| l.starts_with("v ")) {
        let v: Vec<f64> = line.split(' ').skip(1).map(|n| n.parse().expect("a number")).collect();
        let inside = v[0].hypot(v[1]) < 0.059 && v[2] > -0.001 && v[2] < 0.2;
        assert!(inside, "law: vertices lie in the cylinder, got {line}");
    }
    let walls = rows("apparatus.obj");
    for name in ["o floor", "o cylinder_00", "o top_plate"] {
        assert!(walls.iter().any(|l| l == name), "`{name}` is missing");
    }
}

#[test]
fn frames_lead_from_the_first_stage_to_the_last_specimen() {
    let played = read_playback(small_run()).expect("the run can be read");
    let names: Vec<&str> = played.stages.iter().map(|s| s.name.as_str()).collect();
    assert_eq!(names, ["fill_funnel", "pour", "place_top_plate", "vibrate"]);
    assert!(played.stages.iter().all(|s| s.kept), "law: `run` keeps the frames of every stage");
    let times: Vec<f64> =
        played.stages.iter().flat_map(|s| s.frames.iter().map(|f| f.time)).collect();
    assert!(times.windows(2).all(|t| t[0] <= t[1]), "law: time does not run back, got {times:?}");
    let gap = times.windows(2).map(|t| t[1] - t[0]).fold(0.0, f64::max);
    assert!(gap < 0.0851, "law: a frame every 0.08 s, got {gap} s between two, tolerance a step");

    let run = read_run(small_run(), None).expect("the run can be read");
    let last = played.stages.last().and_then(|s| s.frames.last()).expect("a frame");
    let end = &run.specimen.state;
    let off = |seen: &Pose, is: &Pose| (seen.translation.vector - is.translation.vector).norm();
    let plates = (last.top_plate.expect("a plate"), end.top_plate.expect("a plate").pose);
    let worst = last
        .grains
        .iter()
        .zip(&end.bodies)
        .map(|(seen, is)| (seen.expect("nothing was spilled"), is.body.pose))
        .chain([plates])
        .map(|(seen, is)| off(&seen, &is))
        .fold(0.0, f64::max);
    assert!(worst < 1e-7, "law: the last frame is the end, off by {worst} m, tolerance 1e-7");

    // Kept without frames, its stages are seen at their ends.
    let bare = tempfile::tempdir().expect("a folder");
    for file in ["manifest.json", "grains.json"] {
        fs::copy(small_run().join(file), bare.path().join(file)).expect("a copy");
    }
    for stage in fs::read_dir(small_run().join("stages")).expect("stages").flatten() {
        let to = bare.path().join("stages").join(stage.file_name());
        fs::create_dir_all(&to).expect("a folder");
        fs::copy(stage.path().join("specimen.json"), to.join("specimen.json")).expect("a copy");
    }
    let bare = read_playback(bare.path()).expect("the run can be read");
    let frames: Vec<usize> = bare.stages.iter().map(|s| s.frames.len()).collect();
    assert_eq!(frames, [1, 1, 1, 1], "law: without frames, the end of every stage");
    assert!(bare.stages.iter().all(|s| !s.kept));
}

#[test]
fn what_cannot_be_exported_is_said_in_one_line() {
    let folder = tempfile::tempdir().expect("a folder");
    let refused = |run: &Path, more: &[&str], code: i32, words: &[&str]| {
        let out = folder.path().join("out");
        let output = export(run, more, &out);
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(code), "{more:?}: {said}");
        for word in words {
            assert!(said.contains(word), "`{word}` is missing in: {said}");
        }
        assert!(!out.exists(), "nothing is written: {more:?}");
    };
    let run = small_run();
    refused(run, &["--format", "json", "--stage", "melt"], 2, &["melt", "1 pour", "control"]);
    for not_yet in ["vtk", "glb"] {
        refused(run, &["--format", not_yet], 2, &[not_yet]);
    }
    refused(&folder.path().join("none"), &["--format", "csv"], 4, &["none", "manifest.json"]);

    let damaged = folder.path().join("damaged");
    fs::create_dir(&damaged).expect("a folder");
    for file in ["manifest.json", "grains.json"] {
        fs::copy(run.join(file), damaged.join(file)).expect("a copy");
    }
    refused(&damaged, &["--format", "csv"], 4, &["specimen.json"]);
    let state = fs::read_to_string(run.join("specimen.json")).expect("a specimen");
    let state = state.replace("\"table_x\"", "\"table_y\"");
    fs::write(damaged.join("specimen.json"), state).expect("a damaged specimen");
    refused(&damaged, &["--format", "csv"], 4, &["specimen.json", "table_x"]);
}
