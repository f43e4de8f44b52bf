//! `pluvia export`: what a run left, for other programs.

use std::{
    fs,
    path::{Path, PathBuf},
    process::Output,
    sync::OnceLock,
};

use pluvia::export::{Carrier, FramesRead, Scene, read_playback, read_run};
use pluvia::geometry::Pose;
use pluvia::grains::grain_name;
use serde_json::Value;
use tempfile::TempDir;

use super::{
    interruption::{copy, stored},
    near::near,
    program::{self, assert_holds, json, said, text, write},
    small,
};

/// Thirty grams of gravel poured, put under a plate and shaken for a moment, without figures, once
/// for all tests.
pub(super) fn small_run() -> &'static Path {
    static RUN: OnceLock<(TempDir, PathBuf)> = OnceLock::new();
    let (_, out) = RUN.get_or_init(|| {
        let folder = tempfile::tempdir().expect("a folder");
        let scenario = write(folder.path(), "small.json", &small::scenario(30.0, 0.25, 0.1));
        let out = folder.path().join("run");
        program::done(&["run", text(&scenario), "--quiet", "--no-figures", "--out", text(&out)]);
        (folder, out)
    });
    out
}

fn export(run: &Path, more: &[&str], out: &Path) -> Output {
    program::output(&[&["export", text(run), "--out", text(out)][..], more].concat())
}

fn done(run: &Path, more: &[&str], out: &Path) {
    let output = export(run, more, out);
    assert_eq!(output.status.code(), Some(0), "{more:?}: {}", said(&output));
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
    let run = read_run(small_run(), Some("rest_test")).expect("the run can be read");
    assert_eq!(got, run.scene().expect("a scene"), "law: the file holds every bit");
    assert_eq!(got.made_by.stage, "rest_test", "law: the specimen at rest is taken");
    assert!(got.table.motion.is_none(), "law: nothing follows it");
    assert_eq!(got.apparatus.len(), 49, "48 walls and the floor; the funnel is gone");
    assert!(got.apparatus.iter().all(|p| p.motion == Carrier::Table), "law: they shake");
    let plate = got.top_plate.as_ref().expect("the plate lies on the grains");
    // 104 g times (12.5 / 16)³ to four digits: the grains are smaller than the paper's.
    assert!((plate.mass_kg - 0.04959).abs() < 1e-12, "expected 49.59 g, got {}", plate.mass_kg);
    for (grain, state) in got.grains.iter().zip(run.specimen.present()) {
        assert_eq!(grain.grain, state, "law: grains carry their numbers");
        assert_eq!(grain.name, grain_name(state), "law: and the names of all other files");
        let (volume, expected) = (grain.shape.signed_volume(), grain.volume_m3);
        near("the faces enclose the volume", volume, expected, 1e-9 * expected);
        let mass = 2673.9 * expected;
        near("mass = density · volume", grain.mass_kg, mass, 1e-9 * mass);
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
    let earlier = ["--format", "json", "--stage", "fill_funnel"];
    let refused = export(small_run(), &earlier, folder.path());
    let said = said(&refused);
    assert_eq!(refused.status.code(), Some(2), "law: another scene is not written over: {said}");
    assert!(said.contains("--force"), "law: with the way out: {said}");
    done(small_run(), &[&earlier[..], &["--force"]].concat(), folder.path());
    let filled = scene(folder.path());
    assert_eq!(filled.apparatus.len(), 33, "32 funnel pieces and the lid, no cylinder yet");
    assert!(filled.apparatus.iter().all(|p| p.motion == Carrier::Fixed));
    done(small_run(), &["--force", "--format", "json", "--stage", "rest_test"], folder.path());
    assert_eq!(scene(folder.path()).made_by.stage, "rest_test");
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
    let run = read_run(small_run(), Some("rest_test")).expect("the run can be read");
    let rows = |name: &str| -> Vec<String> {
        let text = fs::read_to_string(folder.path().join(name)).expect(name);
        text.lines().map(str::to_owned).collect()
    };
    let grains = rows("grains.csv");
    assert!(grains[0].contains("mass_g,volume_mm3"), "{}", grains[0]);
    // One name for a grain, and one unit for a quantity, in all tables of a run.
    let own = fs::read_to_string(small_run().join("grains.csv")).expect("grains.csv");
    let own: Vec<&str> = own.lines().collect();
    for table in [&grains[1], own[1]] {
        assert!(table.starts_with("grain_00000,"), "law: grains go by their names, got {table}");
    }
    for column in ["mass_g", "volume_mm3", "equivalent_diameter_mm", "x_mm", "rotation_w"] {
        for header in [&*grains[0], own[0]] {
            assert!(header.split(',').any(|c| c == column), "law: `{column}` in {header}");
        }
    }
    for row in &rows("pairs.csv")[1..] {
        let named = row.split(',').take(2).all(|name| name.starts_with("grain_"));
        assert!(named, "law: pairs name their grains as contacts do, got {row}");
    }
    assert_eq!(grains.len() - 1, run.specimen.grains.grains.len(), "law: a row a grain");
    assert_eq!(rows("contacts.csv").len() - 1, run.specimen.state.contacts.len());
    assert!(rows("pairs.csv")[0].ends_with("gap_mm,overlap_percent"));

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
    let played = read_playback(small_run(), FramesRead::All, None).expect("the run can be read");
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
    for stage in stored(small_run()) {
        let to = bare.path().join("stages").join(stage.file_name().expect("a name"));
        fs::create_dir_all(&to).expect("a folder");
        fs::copy(stage.join("specimen.json"), to.join("specimen.json")).expect("a copy");
        let mut record = json(&stage.join("stage.json"));
        let fields = record.as_object_mut().expect("an object");
        for sum in ["frames_sha256", "record_sha256", "identity"] {
            assert!(fields.remove(sum).is_some(), "law: a record has {sum}");
        }
        write(&to, "stage.json", &record);
    }
    let bare = read_playback(bare.path(), FramesRead::All, None).expect("the run can be read");
    let frames: Vec<usize> = bare.stages.iter().map(|s| s.frames.len()).collect();
    assert_eq!(frames, [1, 1, 1, 1], "law: without frames, the end of every stage");
    assert!(bare.stages.iter().all(|s| !s.kept));
}

#[test]
fn frames_for_paraview_are_listed_and_counted() {
    let folder = tempfile::tempdir().expect("a folder");
    let output =
        export(small_run(), &["--format", "vtk", "--every", "0.08", "--json"], folder.path());
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    let told: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let lists: Vec<&str> =
        told["files"].as_array().expect("a list").iter().filter_map(Value::as_str).collect();
    let mut found = 0;
    let mut bytes = 0;
    for list in &lists {
        let text = fs::read_to_string(list).expect("a list");
        bytes += text.len() as u64;
        for file in text.split("file=\"").skip(1).filter_map(|rest| rest.split('"').next()) {
            let path = folder.path().join(file);
            let content = fs::read(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
            assert!(content.starts_with(b"<?xml"), "{} is XML", path.display());
            bytes += content.len() as u64;
            found += 1;
        }
    }
    assert_eq!(lists.len(), 4, "grains, apparatus, contacts, force chains: {lists:?}");
    assert_eq!(told["more_files"], found, "law: as many files as told");
    assert_eq!(told["bytes"], bytes, "law: as many bytes as told");
    let moments = told["moments"].as_u64().expect("a number");
    // Both kinds of files a moment, both kinds at the ends of four stages.
    assert_eq!(2 * moments + 8, found, "law: files are complete");
    assert!(moments > 8, "law: frames between the ends, got {moments}");

    let one = folder.path().join("one");
    done(small_run(), &["--format", "vtk", "--stage", "rest_test"], &one);
    let text = fs::read_to_string(one.join("contacts.pvd")).expect("a list");
    assert_eq!(text.matches("<DataSet").count(), 1, "law: the end of one stage");
}

#[test]
fn a_scene_for_blender_stands_still_or_moves() {
    let folder = tempfile::tempdir().expect("a folder");
    let read = |more: &[&str]| {
        done(small_run(), &[&["--format", "glb", "--force"], more].concat(), folder.path());
        let bytes = fs::read(folder.path().join("specimen.glb")).expect("a file");
        gltf::Gltf::from_slice(&bytes).expect("a sound glTF file")
    };
    let run = read_run(small_run(), None).expect("the run can be read");
    let grains = |file: &gltf::Gltf| {
        file.nodes().filter(|n| n.name().is_some_and(|n| n.starts_with("grain_"))).count()
    };
    let still = read(&[]);
    assert_eq!((grains(&still), still.animations().count()), (run.specimen.present().count(), 0));
    let moving = read(&["--animate", "--every", "0.1"]);
    assert_eq!(moving.animations().count(), 1, "law: with --animate it moves");
    let has = |file: &gltf::Gltf, name| file.nodes().any(|n| n.name() == Some(name));
    assert!(has(&moving, "funnel") && !has(&still, "funnel"), "law: the funnel was there before");
    assert!(has(&read(&["--stage", "fill_funnel"]), "lid"), "law: the stage that is asked for");
}

#[test]
fn solids_lie_where_the_grains_lie() {
    let folder = tempfile::tempdir().expect("a folder");
    let run = read_run(small_run(), Some("rest_test")).expect("the run can be read");
    let present: Vec<usize> = run.specimen.present().collect();
    let grains = &run.specimen.grains.grains;
    done(small_run(), &["--format", "ply"], folder.path());
    let text = fs::read_to_string(folder.path().join("grains.ply")).expect("PLY");
    let vertices: usize = present.iter().map(|&n| grains[n].shape.vertices().len()).sum();
    assert!(text.contains(&format!("element vertex {vertices}\n")), "law: every corner");
    let body = text.split_once("end_header\n").expect("a header").1;
    let first = body.lines().next().expect("a corner");
    let got: Vec<f64> = first.split(' ').map(|n| n.parse().expect("a number")).collect();
    let n = present[0];
    let expected = run.specimen.state.bodies[n].body.pose * grains[n].shape.vertices()[0];
    assert_eq!(got, [expected.x, expected.y, expected.z], "law: where the grain is");
    let last: usize =
        body.lines().last().and_then(|l| l.rsplit(' ').next()?.parse().ok()).expect("a number");
    assert_eq!(last, *present.last().expect("grains"), "law: faces carry their grain's number");

    done(small_run(), &["--format", "stl"], folder.path());
    let bytes = fs::read(folder.path().join("grains.stl")).expect("STL");
    let triangles: usize = present.iter().map(|&n| grains[n].shape.triangles().count()).sum();
    assert_eq!(bytes.len(), 84 + 50 * triangles, "law: 84 bytes and 50 a triangle");
}

#[test]
fn what_cannot_be_exported_is_said_in_one_line() {
    let folder = tempfile::tempdir().expect("a folder");
    let refused = |run: &Path, more: &[&str], code: i32, words: &[&str]| {
        let out = folder.path().join("out");
        let output = export(run, more, &out);
        let said = said(&output);
        assert_eq!(output.status.code(), Some(code), "{more:?}: {said}");
        assert_holds(&said, words);
        assert!(!out.exists(), "nothing is written: {more:?}");
    };
    let run = small_run();
    refused(run, &["--format", "json", "--stage", "melt"], 2, &["melt", "1 pour", "rest_test"]);
    let words = ["control", "now called `rest_test`"];
    refused(run, &["--format", "json", "--stage", "control"], 2, &words);
    for format in ["vtk", "glb"] {
        let words = ["melt", "1 pour", "rest_test"];
        refused(run, &["--format", format, "--stage", "melt"], 2, &words);
    }
    refused(run, &["--format", "dwg"], 2, &["dwg", "vtk", "glb"]);
    refused(run, &["--format", "vtk", "--animate"], 2, &["--animate", "glb"]);
    refused(run, &["--format", "glb", "--every", "0.1"], 2, &["--every", "--animate"]);
    for every in ["0", "-1", "soon"] {
        let every = format!("--every={every}");
        refused(run, &["--format", "vtk", &every], 2, &["--every", "above 0"]);
    }
    refused(&folder.path().join("none"), &["--format", "csv"], 4, &["none", "manifest.json"]);
    // What a folder without a manifest may be.
    let other = folder.path().join("other");
    fs::create_dir(&other).expect("a folder");
    refused(&other, &["--format", "csv"], 2, &["other", "no folder of a run"]);
    fs::create_dir(other.join("runs")).expect("a folder");
    refused(&other, &["--format", "csv"], 2, &["other", "several runs"]);
    fs::write(other.join("unfinished.json"), "{}").expect("written");
    refused(&other, &["--format", "csv"], 2, &["other", "not finished", "resume"]);

    let damaged = folder.path().join("damaged");
    fs::create_dir(&damaged).expect("a folder");
    fs::copy(run.join("manifest.json"), damaged.join("manifest.json")).expect("a copy");
    // As a run of a study that is copied without the study.
    let words = ["damaged/grains.json", "runs of a study have it beside their folder `runs`"];
    refused(&damaged, &["--format", "csv"], 4, &words);
    fs::copy(run.join("grains.json"), damaged.join("grains.json")).expect("a copy");
    for (format, missing) in [("csv", "specimen.json"), ("vtk", "stages"), ("glb", "stages")] {
        refused(&damaged, &["--format", format], 4, &[missing]);
    }
    fs::copy(run.join("specimen.json"), damaged.join("specimen.json")).expect("a copy");
    copy(&run.join("stages"), &damaged.join("stages"));
    done(&damaged, &["--format", "csv"], &folder.path().join("whole"));
    let grains = fs::read_to_string(run.join("grains.json")).expect("grains");
    fs::write(damaged.join("grains.json"), grains.replacen("0.0", "0.5", 1)).expect("changed");
    refused(&damaged, &["--format", "csv"], 2, &["grains.json", "not what was written"]);
    fs::write(damaged.join("grains.json"), grains).expect("as it was");
    let state = fs::read_to_string(run.join("specimen.json")).expect("a specimen");
    let state = state.replace("\"table_x\"", "\"table_y\"");
    fs::write(damaged.join("specimen.json"), state).expect("a damaged specimen");
    refused(&damaged, &["--format", "csv"], 2, &["specimen.json", "not what was written"]);
    // Older versions noted no sums.
    let mut manifest = json(&run.join("manifest.json"));
    assert!(manifest["files_sha256"].take().is_object(), "law: a manifest notes sums");
    manifest["files_sha256"] = serde_json::json!({});
    write(&damaged, "manifest.json", &manifest);
    refused(&damaged, &["--format", "csv"], 2, &["specimen.json", "table_x"]);
    // Of two stages of a name none is meant.
    manifest["stages"][2]["stage"] = serde_json::json!("pour");
    write(&damaged, "manifest.json", &manifest);
    for format in ["json", "vtk", "glb"] {
        refused(&damaged, &["--format", format, "--stage", "pour"], 2, &["`pour`", "1 or 2"]);
    }
}
