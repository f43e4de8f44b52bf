//! `pluvia calibrate` on a few grains: what it finds, what it refuses, and that
//! it goes on from where it was.

use std::fs;

use serde_json::Value;

use super::{
    interruption::stored,
    program::{self, Folder, assert_holds, words},
    small,
};

/// A folder with `small.json`.
fn folder() -> Folder {
    let folder = Folder::new();
    folder.scenario("small.json", &small::layer(40.0));
    folder
}

/// Runs the command with results in `out`; gives its exit code, standard output and standard error.
fn calibrate(folder: &Folder, more: &[&str]) -> (Option<i32>, String, String) {
    let (scenario, out) = (folder.out("small.json"), folder.out("out"));
    let args = ["calibrate", "--quiet", "--json", &scenario, "--out", &out];
    program::run(&[&args[..], more].concat())
}

const FILES: [&str; 5] =
    ["calibrate.json", "calibrate.md", "report.html", "evaluations.csv", "figures/calibration.svg"];

fn bytes(folder: &Folder) -> Vec<Vec<u8>> {
    FILES.iter().map(|name| folder.bytes(&format!("out/{name}"))).collect()
}

#[test]
fn a_mass_is_found_for_a_height_and_the_same_command_gives_the_same_bytes() {
    let folder = folder();
    // Few grains, and masses that are not far from each other: few runs.
    let asked = words(
        "--target standing_height_mm.mean_surface=6 --unknown grains.total_mass_g \
         --between 30..60 --realisations 3 --tolerance 1",
    );
    let (code, printed, said) = calibrate(&folder, &asked);
    assert_eq!(code, Some(0), "{said}");
    let found: Value = serde_json::from_str(&printed).expect("JSON");
    let first = bytes(&folder);
    assert_eq!(found, serde_json::from_slice::<Value>(&first[0]).expect("JSON"), "as written");
    assert_eq!(found["ending"], "found", "{printed}");
    let number = |value: &Value| value.as_f64().expect("a number");
    let solution = &found["solution"];
    let (mass, interval) = (number(&solution["value"]), &solution["interval_95"]);
    assert!(number(&interval["low"]) < mass && mass < number(&interval["high"]), "{solution}");
    assert!(number(&solution["slope"]) > 0.0, "law: more grains stand higher: {solution}");
    // Height over mass is known without a simulation but for the void ratio,
    // which is that of angular grains: h = m (1 + e) / (ρ A).
    let area = std::f64::consts::PI / 4.0 * 7.5 * 7.5;
    let void_ratio = 0.6 * area * 2.6739 / mass - 1.0;
    assert!((0.3..1.5).contains(&void_ratio), "law: h = m(1 + e)/(ρA); got e {void_ratio}");
    // Every value was run in the same configurations.
    let runs = found["runs"].as_array().expect("runs");
    for value in found["values"].as_array().expect("values") {
        let configurations: Vec<u64> = runs
            .iter()
            .filter(|r| r["value"] == value["value"])
            .filter_map(|r| r["configuration"].as_u64())
            .collect();
        let expected: Vec<u64> = (1..=configurations.len() as u64).collect();
        assert_eq!(configurations, expected, "law: pairs, at {}", value["value"]);
        assert!(configurations.len() >= 3, "law: at least the realisations");
    }
    let rows = String::from_utf8(first[3].clone()).expect("UTF-8").lines().count();
    assert_eq!(rows, runs.len() + 1, "law: a row a run and a header");

    // Again, all of it from the store: wall times are those of the first time.
    let (code, _, said) = calibrate(&folder, &asked);
    assert_eq!(code, Some(0), "{said}");
    assert!(bytes(&folder) == first, "law: the same command gives the same bytes");
    // With stages lost, as when it was killed, it fills the gaps.
    for stage in stored(&folder.path("out")).iter().step_by(7) {
        fs::remove_dir_all(stage).expect("removed");
    }
    let (code, printed, said) = calibrate(&folder, &asked);
    assert_eq!(code, Some(0), "{said}");
    let again: Value = serde_json::from_str(&printed).expect("JSON");
    assert_eq!(again["solution"], found["solution"], "law: the same bits, but for wall times");
}

#[test]
fn what_cannot_be_is_told_with_what_was_measured() {
    let folder = folder();
    let asked = words(
        "--target standing_height_mm.mean_surface=70 --unknown grains.total_mass_g \
         --between 20..90 --realisations 2 --tolerance 1",
    );
    let (code, printed, said) = calibrate(&folder, &asked);
    assert_eq!(code, Some(1), "law: an expectation missed is 1: {said}");
    let found: Value = serde_json::from_str(&printed).expect("JSON");
    assert_eq!(found["ending"], "out_of_reach", "{printed}");
    let statement = found["statement"].as_str().expect("a statement");
    let said = ["no grains.total_mass_g in 20..90", "70 mm", "at 20 it is", "at 90 it is"];
    assert_holds(statement, &said);
    assert_eq!(found["values"].as_array().map(Vec::len), Some(4), "what was tried is kept");
    bytes(&folder);
}

#[test]
fn a_result_that_is_not_measured_is_told_with_what_is() {
    let folder = folder();
    let restitution = "--unknown contact.restitution --between 0..1";
    let misspelt = format!("--target settlement_mm.finel=3 {restitution}");
    let (code, _, said) = calibrate(&folder, &words(&misspelt));
    assert_eq!(code, Some(2), "law: a misspelt result is refused: {said}");
    assert!(said.contains("did you mean `settlement_mm.final`"), "law: with what is meant: {said}");
    assert!(!folder.path("out").exists(), "law: before anything runs");
    for (target, said, ran) in [
        ("slope.degrees=3", ["slope.degrees", "standing_height_mm.mean_surface"], false),
        ("settlement_mm.final=3", ["does not measure it", "a stage `vibrate`"], false),
        // Cells have corners, of whose roundness nobody speaks: known from the first run alone.
        ("shape.roundness.p50=0.3", ["has no number at", "coordination_number"], true),
    ] {
        let (code, printed, err) =
            calibrate(&folder, &words(&format!("--target {target} {restitution}")));
        assert_eq!(code, Some(2), "{err}");
        assert!(printed.is_empty(), "nothing is printed as a result: {printed}");
        let is_made = folder.path("out").exists();
        assert_eq!(is_made, ran, "law: what can be known before is refused before: {err}");
        assert_holds(&err, &said);
    }
    let runs = fs::read_dir(folder.path("out/runs")).expect("runs").count();
    assert_eq!(runs, 1, "law: one run is enough to tell");
}

#[test]
fn all_that_is_wrong_with_a_calibration_is_told_at_once() {
    let folder = folder();
    let asked = "--target slope.degrees=3 --unknown contact.grain --between 0..1 --most-runs 1";
    let (code, printed, err) = calibrate(&folder, &words(asked));
    assert_eq!(code, Some(2), "{err}");
    assert_holds(&err, &["--target slope.degrees", "--unknown contact.grain", "--most-runs 1"]);
    let nothing = printed.is_empty() && !folder.path("out").exists();
    assert!(nothing, "law: before anything runs, got `{printed}`");
}

/// Law: the settlement after five seconds is refused before anything runs where the table shakes for
/// two, with the stage, its duration and the times that exist.
#[test]
fn a_time_that_the_vibration_does_not_reach_is_refused_before_anything_runs() {
    let folder = Folder::new();
    folder.scenario("small.json", &small::scenario(40.0, 2.0, 0.2));
    let asked = "--unknown contact.restitution --between 0..1";
    for target in ["settlement_mm.after_5_s", "surface_settlement_mm.share_after_5_s"] {
        let (code, printed, err) =
            calibrate(&folder, &words(&format!("--target {target}=3 {asked}")));
        assert_eq!(code, Some(2), "{err}");
        assert!(printed.is_empty() && !folder.path("out").exists(), "law: nothing is run: {err}");
        let said = [target, "needs 5 s of vibration", "stages[3] (`vibrate`) for 2 s", "final"];
        assert_holds(&err, &said);
    }
}

#[test]
fn wrong_usage_is_told_before_anything_runs() {
    let folder = folder();
    let height = "--target standing_height_mm.mean_surface=40";
    let friction = format!("{height} --unknown contact.grain_grain_friction");
    let between = "--between 0.2..1.2";
    for (more, said) in [
        (String::new(), "--angle-of-repose"),
        (format!("{height} --angle-of-repose 38"), "cannot be used with"),
        ("--angle-of-repose 95".to_owned(), "between 0 and 90"),
        ("--angle-of-repose -5".to_owned(), "between 0 and 90"),
        (friction.clone(), "--between"),
        (format!("{height} {between}"), "--unknown"),
        ("--target height".to_owned(), "not field=number"),
        (format!("{friction} --between 1.2..0.2"), "reversed"),
        (format!("{friction} --between -1..0.2"), "--between contact.grain_grain_friction=-1: "),
        (format!("{height} --unknown contact.colour {between}"), "no such field"),
        (format!("{height} --unknown name {between}"), "no number there"),
        (format!("{height} --unknown seed {between}"), "samples"),
        (format!("{friction} {between} --realisations 1"), "--realisations"),
        (format!("{friction} {between} --most-runs 7"), "at least 30 runs"),
        // Without a rest test no run is valid.
        (format!("{friction} {between} --set rest_test_s=0"), "rest_test_s is 0"),
    ] {
        let (code, printed, err) = calibrate(&folder, &words(&more));
        assert_eq!(code, Some(2), "{more}: {err}");
        assert_holds(&err, &[said]);
        let is_written = folder.path("out").exists();
        assert!(printed.is_empty() && !is_written, "nothing is printed or written: {more}");
    }
    // All that is wrong is said at once.
    let both =
        format!("--target settlement_mm.final=3 --unknown contact.grain_grain_friction {between}");
    let (_, _, err) = calibrate(&folder, &words(&format!("{both} --set rest_test_s=0")));
    assert_holds(&err, &["does not measure it", "rest_test_s is 0"]);
}
