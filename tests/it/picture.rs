//! `pluvia picture`: pictures and animations of what a run left.

use std::{
    fs,
    path::{Path, PathBuf},
    process::Command,
};

use super::{
    export::small_run,
    interruption::finished,
    program::{self, assert_holds, said},
};

const SMALL: [&str; 4] = ["--width", "240", "--height", "160"];

fn pluvia(subject: &Path, more: &[&str]) -> Command {
    let mut command = program::pluvia();
    command.arg("picture").arg(subject).args(SMALL).args(more);
    command
}

/// Makes a picture and gives its file.
fn done(subject: &Path, more: &[&str], out: &Path) -> Vec<u8> {
    let mut command = pluvia(subject, more);
    let output = command.arg("--force").arg("--out").arg(out).output().expect("it starts");
    assert_eq!(output.status.code(), Some(0), "{more:?}: {}", said(&output));
    fs::read(out).expect("the picture")
}

/// Pixels of a file, which must have the size asked for.
fn pixels(file: &[u8]) -> Vec<u8> {
    let mut reader = png::Decoder::new(std::io::Cursor::new(file)).read_info().expect("a PNG");
    assert_eq!((reader.info().width, reader.info().height), (240, 160), "law: the size asked for");
    let mut bytes = vec![0; reader.output_buffer_size().expect("a size")];
    reader.next_frame(&mut bytes).expect("pixels");
    bytes
}

#[test]
fn every_moment_and_manner_makes_another_picture() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("new/folder/a.png");
    let mut all: Vec<Vec<u8>> = Vec::new();
    for more in [
        &[][..],
        &["--stage", "fill_funnel"],
        &["--stage", "vibrate", "--colour-by", "speed"],
        &["--stage", "3", "--colour-by", "displacement", "--cylinder", "hidden"],
        &["--colour-by", "coordination", "--cylinder", "cut"],
        &["--colour-by", "plain", "--no-key", "--azimuth", "-30", "--elevation", "60"],
        &["--stage", "rest_test"],
        &["--time", "0.1"],
        &["--grains"],
    ] {
        let bytes = pixels(&done(small_run(), more, &out));
        let seen = bytes.chunks(3).filter(|p| p.iter().any(|&c| c < 200)).count();
        assert!(seen > 300, "{more:?}: something is seen, got {seen} pixels");
        assert!(!all.contains(&bytes), "{more:?}: unlike the others");
        all.push(bytes);
    }
    let clear = pixels(&done(small_run(), &["--background", "transparent"], &out));
    assert_eq!(clear.len(), 4 * 240 * 160, "law: with alpha");
    let nothing = clear.chunks(4).filter(|p| p[3] == 0).count();
    assert!(nothing > 1000, "law: nothing lies behind, got {nothing} clear pixels");
}

/// Law: a time since the run began may be one of the rest test, which a refusal lists, too.
#[test]
fn a_time_may_be_one_of_the_rest_test() {
    let folder = tempfile::tempdir().expect("a folder");
    let end = folder.path().join("end.png");
    let more = ["--stage", "rest_test", "--json", "--quiet", "--out"];
    let output = pluvia(small_run(), &more).arg(&end).output().expect("it starts");
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    let made: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let time = made["time_s"].as_f64().expect("a time").to_string();
    let found = done(small_run(), &["--time", &time], &folder.path().join("found.png"));
    let expected = fs::read(&end).expect("the picture");
    assert!(found == expected, "law: {time} s is the end of the rest test, as it is by its name");
    let output = pluvia(small_run(), &["--time", "900", "--out"]).arg(&end).output();
    let said = said(&output.expect("it starts"));
    assert!(said.contains("rest_test: "), "law: its times are listed, got `{said}`");
}

#[test]
fn grains_are_shown_by_themselves_from_run_and_file() {
    let folder = tempfile::tempdir().expect("a folder");
    let from_run = done(small_run(), &["--grains"], &folder.path().join("a.png"));
    let file = small_run().join("grains.json");
    let from_file = done(&file, &[], &folder.path().join("b.png"));
    assert!(from_run == from_file, "law: the same grains, the same picture");
}

#[test]
fn a_stage_is_animated() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("moving.png");
    let more = ["--stage", "vibrate", "--json", "--quiet", "--animate"];
    let output = pluvia(small_run(), &more).arg(&out).output().expect("it starts");
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    let made: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let frames = made["frames"].as_u64().expect("a number of frames");
    let file = fs::read(&out).expect("the animation");
    let reader = png::Decoder::new(std::io::Cursor::new(file)).read_info().expect("a PNG");
    let control = reader.info().animation_control().expect("animated");
    assert_eq!(u64::from(control.num_frames), frames, "law: as many as said");
    assert!(frames >= 4, "law: 0.25 s in frames of 0.08 s, got {frames}");
}

#[test]
fn what_cannot_be_shown_is_said_in_one_line() {
    let folder = tempfile::tempdir().expect("a folder");
    let picture = folder.path().join("a.png");
    fs::write(folder.path().join("file"), "").expect("a file");
    let refused = |subject: &Path, more: &[&str], out: &Path, code: i32, words: &[&str]| {
        let output = pluvia(subject, more).arg(out).output().expect("it starts");
        let said = said(&output);
        assert_eq!(output.status.code(), Some(code), "{more:?}: {said}");
        assert_holds(&said, words);
        assert!(!out.is_file(), "nothing is written: {more:?}");
    };
    let run = small_run();
    let to = |more: &[&'static str]| -> Vec<&'static str> { [more, &["--out"]].concat() };
    refused(
        run,
        &to(&["--stage", "melt"]),
        &picture,
        2,
        &["melt", "0 fill_funnel, 1 pour", "rest_test"],
    );
    refused(run, &to(&["--time", "-1"]), &picture, 2, &["-1 s", "vibrate"]);
    refused(run, &to(&["--time", "900"]), &picture, 2, &["900 s", "fill_funnel"]);
    refused(run, &to(&["--elevation", "120"]), &picture, 2, &["elevation", "120", "-89 to 89"]);
    refused(run, &to(&["--grains", "--stage", "pour"]), &picture, 2, &["--stage"]);
    refused(run, &to(&["--grains", "--colour-by", "speed"]), &picture, 2, &["speed"]);
    refused(run, &to(&[]), &folder.path().join("a.jpg"), 2, &["a.jpg", ".png"]);
    refused(run, &["--animate"], &folder.path().join("a.mp4"), 2, &["a.mp4", ".png"]);
    let tiny = ["--limit-mb", "0.0001", "--animate"];
    refused(run, &tiny, &picture, 2, &["--every", "--width"]);
    let below_a_file: PathBuf = folder.path().join("file/a.png");
    refused(run, &to(&[]), &below_a_file, 4, &["file"]);
    refused(&folder.path().join("none"), &to(&[]), &picture, 4, &["none", "manifest.json"]);
    refused(&run.join("summary.json"), &to(&[]), &picture, 2, &["summary.json"]);
    let scenario = program::root().join("scenarios/quick/pluviation.json");
    let words = ["it is a scenario", "`pluvia grains`", "`pluvia run`"];
    refused(&scenario, &to(&[]), &picture, 2, &words);
}

/// Law: a picture that is there is kept, unless `--force` replaces it.
#[test]
fn a_picture_that_is_there_is_kept() {
    let folder = tempfile::tempdir().expect("a folder");
    for option in ["--out", "--animate"] {
        let file = folder.path().join(format!("{option}.png"));
        fs::write(&file, "mine").expect("a file");
        let make = |more: &[&str]| {
            let mut command = pluvia(small_run(), &[&["--stage", "vibrate"], more].concat());
            command.arg(option).arg(&file).output().expect("it starts")
        };
        let output = make(&[]);
        let said = said(&output);
        assert_eq!(output.status.code(), Some(2), "law: {option} is refused, got {said}");
        assert!(said.contains("--force"), "law: and says how to go on, got {said}");
        assert_eq!(fs::read(&file).expect("a file"), b"mine", "law: it is as it was");
        assert_eq!(make(&["--force"]).status.code(), Some(0), "law: --force replaces it");
        assert_ne!(fs::read(&file).expect("a file"), b"mine", "law: it is another");
    }
}

#[test]
fn a_run_leaves_its_pictures() {
    for name in ["picture-grains", "picture-funnel", "picture-vibration"] {
        let path = finished().join(format!("figures/{name}.png"));
        let size = fs::metadata(&path).map(|m| m.len()).unwrap_or(0);
        assert!(size > 10_000, "{}: expected a picture, got {size} bytes", path.display());
    }
}
