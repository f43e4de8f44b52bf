//! What `make bench-peers` refuses (`benches/peers/asked.rs`), hands from one process to another
//! (`benches/peers/handed.rs`), and says of the accuracy standard and the step rate
//! (`benches/peers/verdict.rs`).

use std::fs;

use pluvia::{
    scenario::{EngineSettings, NativeSettings},
    world::EffectiveSettings,
};
use serde_json::json;

#[path = "../../benches/peers/asked.rs"]
mod asked;
#[path = "../../benches/peers/handed.rs"]
mod handed;
#[path = "../../benches/peers/verdict.rs"]
mod verdict;

/// Law: the process that computes a row gets the settings of the row, the number of threads, which
/// files leave out, among them; a world that has another number is refused.
#[test]
fn threads_of_a_row_reach_its_world() {
    let pluvia = EngineSettings::default();
    let native = NativeSettings { threads: Some(2), ..pluvia.native.clone() };
    let two = EngineSettings { native, ..pluvia.clone() };
    for (asked, threads) in [(&pluvia, 1), (&two, 2)] {
        let [json, words] = handed::words(asked).expect("they can be written");
        let got = handed::settings(&json, &words).expect("they can be read");
        assert_eq!(got.native.threads, Some(threads), "law: of {words} threads");
        for held in [1, 2] {
            let world: EffectiveSettings =
                [("threads".to_owned(), json!(f64::from(held)))].into_iter().collect();
            let is_right = handed::check_threads(&got, &world).is_ok();
            assert_eq!(is_right, held == threads, "law: {threads} asked for, {held} there");
        }
        let silent = handed::check_threads(&got, &EffectiveSettings::new());
        assert_eq!(silent.is_ok(), threads == 1, "law: an engine that does not say has one");
    }
    assert!(handed::settings("{}", "two").is_err(), "law: no number is refused");
}

/// Law: an engine that loses grains misses the accuracy standard, however well the others lie.
#[test]
fn an_engine_that_loses_grains_misses_the_standard() {
    let cases = [
        (0, 0.01, Some(0.0), Some(true)),
        (0, 0.01, None, None),
        (0, 50.0, None, Some(false)),
        (1, 0.01, Some(0.0), Some(false)),
        (1, 0.01, None, Some(false)),
    ];
    for (lost, overlap, creep, expected) in cases {
        let got = verdict::meets_standard(lost, overlap, overlap, creep);
        assert_eq!(got, expected, "law: {lost} lost, overlap {overlap} %, creep {creep:?} µm/s");
    }
}

/// Law: a row has the step rate that was asked for, without the rounding of the simulated time, and
/// where the engine chose another, that one.
#[test]
fn the_step_rate_is_the_one_asked_for() {
    // 2 s as a sum of 1920 steps, a bit too long.
    let long = 2.0 * (1.0 + f64::EPSILON);
    for (asked, steps, time, expected) in [
        (960.0, 1920, long, 960.0),
        (960.0, 1920, 2.0, 960.0),
        (960.0, 1921, 2.0, 960.5),
        (0.0, 1920, 2.0, 960.0),
    ] {
        let got = verdict::rate_hz(asked, steps, time);
        assert_eq!(got, expected, "law: {steps} steps in {time} s, asked for {asked} Hz");
    }
}

/// Law: what nothing comes of is refused before it takes the place of results: times and rates that
/// are not above zero, and a place for results that no file can have.
#[test]
fn what_gives_no_results_is_refused_beforehand() {
    for (text, expected) in [
        ("0.5", Some(0.5)),
        ("60", Some(60.0)),
        ("0", None),
        ("-1", None),
        ("nan", None),
        ("inf", None),
        ("a minute", None),
    ] {
        let got = asked::positive(text).ok();
        assert_eq!(got, expected, "law: `{text}` as a time or rate");
    }
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("file"), "").expect("written");
    for (out, expected) in [("new/peers.json", true), ("file/peers.json", false), ("", false)] {
        let got = asked::prepare(&folder.path().join(out)).is_ok();
        assert_eq!(got, expected, "law: whether results can stand at `{out}`");
    }
    assert!(folder.path().join("new").is_dir(), "law: the folder of results is made");
}
