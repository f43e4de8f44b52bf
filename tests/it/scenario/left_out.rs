//! `--set path=null` leaves a field out.

use serde_json::json;

use super::{assert_told, load_text, sound, told};

/// Law: a field that is left out is as if no file gave it, also where none did.
#[test]
fn null_leaves_a_field_out() {
    let bare = load_text(&sound().to_string(), &[]).expect("it loads");
    let mut typed = sound();
    typed["engine"] = json!({ "rate_hz": 960, "native": { "iterations": 3 } });
    typed["seed"] = json!(7);
    typed["stages"][1]["time_limit_s"] = json!(8);
    let typed = typed.to_string();
    assert_ne!(load_text(&typed, &[]).as_ref(), Ok(&bare), "law: what is typed counts");
    let changes =
        ["engine.rate_hz=null", "engine.native=null", "seed=null", "stages.1.time_limit_s=null"];
    let got = load_text(&typed, &changes);
    assert_eq!(got.as_ref(), Ok(&bare), "law: each has its default again");
    let changes = ["engine=null", "engine.rate_hz=960", "engine.rate_hz=null"];
    let changes = [&changes[..], &["seed=1", "stages[1].time_limit_s=null"]].concat();
    let got = load_text(&typed, &changes);
    assert_eq!(got.as_ref(), Ok(&bare), "law: changes are made in their order");
    for change in [
        "engine.rate_hz=null",
        "engine.native.iterations=null",
        "begin.stage=null",
        "index_densities.e_max=null",
        "stages[1].time_limit_s=null",
    ] {
        let got = load_text(&sound().to_string(), &[change]);
        assert_eq!(got.as_ref(), Ok(&bare), "law: `{change}` of what no file gives");
    }
}

/// Law: a field that a scenario must have, or that none has, is refused, and so is an element of a
/// list: others would change their numbers.
#[test]
fn what_cannot_be_left_out_is_refused() {
    for (change, path, words) in [
        ("name=null", "name", "the field is missing (allowed: a text of 1 to 100 letters)"),
        ("grains=null", "grains", "the field is missing"),
        ("stages.1.falling_height_mm=null", "stages[1].falling_height_mm", "missing"),
        ("engine.ratehz=null", "engine.ratehz", "did you mean `rate_hz`?"),
        ("stages.1=null", "stages[1]", "an element of a list cannot be left out"),
        ("stages.7.time_limit_s=null", "stages", "the path leads nowhere"),
        ("engine={\"rate_hz\":null}", "engine.rate_hz", "the value has the wrong type"),
    ] {
        let found = told(load_text(&sound().to_string(), &[change]));
        assert_told(&found, path, words);
        let is_named = found[0].1.starts_with(&format!("--set {change}: "));
        assert!(is_named && found.len() == 1, "law: by its change alone, got {found:#?}");
    }
}
