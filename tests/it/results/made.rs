//! Results are kept as they were made, whole and with their build.

use std::{fs, iter::once, path::Path};

use clap::Parser;
use pluvia::study::STAGE_FORMAT;

use super::{super::program::script, Maker, builds, kept, list, make, pictures::PICTURES};
use options::Options;

#[allow(dead_code)] // only whether they go together is asked
#[path = "../../../benches/results/options.rs"]
mod options;

/// Law: a result whose files are not there is of no build.
#[test]
fn a_missing_file_has_no_build() {
    let folder = kept(&[("bench", "13")]);
    let file = folder.path().join(list::FOLDER).join("bench.json");
    fs::remove_file(file).expect("removed");
    let refused = make::built(folder.path(), &["bench".to_owned()]);
    let why = refused.expect_err("law: nothing is recorded of a file that is missing");
    assert!(why.contains("bench.json"), "law: `bench.json` is named, got: {why}");
    let builds = builds::read(folder.path()).expect("builds");
    let build = builds::of(&builds, "bench").expect("it has a row");
    assert_eq!(build.format, "13", "law: its row stays");
}

/// Law: of a result that was not made whole no file is kept, and its build stays: its files are of
/// one build.
#[cfg(unix)]
#[test]
fn a_result_is_kept_whole_or_not_at_all() {
    let folder = kept(&[("calibration", "13")]);
    let root = folder.path();
    let out = root.join(format!("out/results/format-{STAGE_FORMAT}/calibration"));
    fs::create_dir_all(&out).expect("made");
    fs::write(out.join("calibrate.json"), "of today").expect("written");
    // A program that makes no other file.
    let maker = Maker { root, out: Path::new("out/results"), program: Path::new("/bin/echo") };
    let of = list::KEPT.iter().find(|of| of.name == "calibration").expect("it is listed");
    let why = maker.make(of).expect_err("law: what is not whole is not made");
    assert!(why.contains("evaluations.csv"), "law: `evaluations.csv` is named, got: {why}");
    let file = root.join(list::FOLDER).join("calibration/calibrate.json");
    let got = fs::read_to_string(file).expect("it is there");
    assert_eq!(got, "", "law: the file of the earlier build stays");
    let builds = builds::read(root).expect("builds");
    let build = builds::of(&builds, "calibration").expect("it has a row");
    assert_eq!(build.format, "13", "law: its row stays");
}

/// Law: a picture that fails keeps none of the others from being drawn, and is named.
#[cfg(unix)]
#[test]
fn a_picture_that_fails_keeps_no_other_from_being_drawn() {
    let folder = tempfile::tempdir().expect("a folder");
    let root = folder.path();
    // A program that draws all but the first, and says what.
    let text =
        "#!/bin/sh\ncase \"$*\" in *grains.png*) exit 3;; *.png*) echo \"$*\" >>drawn;; esac\n";
    script(&root.join("program"), text);
    let maker = Maker { root, out: Path::new("out"), program: Path::new("program") };
    let why = maker.pictures().expect_err("law: one is not drawn");
    assert_eq!(why, "not drawn: grains.png", "law: that one is named");
    let drawn = fs::read_to_string(root.join("drawn")).expect("law: the others are drawn");
    let (got, expected) = (drawn.lines().count(), PICTURES.len() - 1);
    assert_eq!(got, expected, "law: all others are drawn, got {drawn}");
}

/// Law: options of which one would leave another without effect are refused together.
#[test]
fn options_without_effect_are_refused() {
    for (text, expected) in [
        ("--check --fill", false),
        ("--fill --only grains", false),
        ("--fill --older", false),
        ("--fill --targets", false),
        ("--fill --pictures", false),
        ("--list --fill", false),
        ("--list --only grains", false),
        ("--list --older", false),
        ("--list --targets", false),
        ("--list --pictures", false),
        ("--check", true),
        ("--fill", true),
        ("--fill --built grains", true),
        ("--list", true),
        ("--only grains --pictures", true),
        ("--older --targets --pictures", true),
    ] {
        let words = once("results").chain(text.split_whitespace());
        let got = Options::try_parse_from(words).is_ok();
        assert_eq!(got, expected, "law: whether `{text}` is taken");
    }
}
