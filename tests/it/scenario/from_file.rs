//! Grains from a file are checked as those of a sieve table are.

use std::fs;

use pluvia::{
    grains::{self, load_scenario},
    scenario::{GrainsSpec, Scenario, ScenarioErrors, check, warnings},
};
use serde_json::{Value, json};

use super::super::program::skipped;
use super::{assert_holds, sound};

/// A folder with the sound scenario's grains in `grains.json`.
fn folder() -> tempfile::TempDir {
    let scenario: Scenario = serde_json::from_value(sound()).expect("a scenario");
    let GrainsSpec::Sieved(sieved) = &scenario.grains else { panic!("sieved") };
    let set = grains::generate(sieved, 1).expect("grains");
    let folder = tempfile::tempdir().expect("a folder");
    let text = serde_json::to_string(&grains::to_json(&set)).expect("JSON");
    fs::write(folder.path().join("grains.json"), text).expect("written");
    folder
}

/// Faults, or else the scenario, of the same grains by their sieve table and from the file.
fn both(
    folder: &tempfile::TempDir,
    spoil: &dyn Fn(&mut Value),
) -> [Result<Scenario, Vec<String>>; 2] {
    let mut sieved = sound();
    spoil(&mut sieved);
    let mut from_file = sieved.clone();
    from_file["grains"] = json!({ "file": "grains.json" });
    [("sieved.json", sieved), ("file.json", from_file)].map(|(name, value)| {
        let path = folder.path().join(name);
        fs::write(&path, value.to_string()).expect("written");
        match load_scenario(&path, &[]) {
            Ok(loaded) => Ok(loaded.scenario),
            Err(ScenarioErrors::Faults(found)) => {
                Err(found.iter().map(|f| format!("{}: {}", f.path, f.message)).collect())
            }
            Err(other) => panic!("{other}"),
        }
    })
}

#[test]
fn impossible_apparatus_and_steps_are_refused() {
    let folder = folder();
    let [sieved, from_file] = both(&folder, &|_| ());
    sieved.expect("the scenario is sound");
    from_file.expect("law: and so it is with its grains from a file");
    type Spoil = fn(&mut Value);
    let spoilt: [(&str, Spoil); 6] = [
        ("apparatus.funnel.opening_diameter_mm", |s| {
            s["apparatus"] = json!({ "funnel": { "opening_diameter_mm": 15 } });
        }),
        ("apparatus.cylinder.inner_diameter_mm", |s| {
            s["apparatus"] = json!({ "cylinder": { "inner_diameter_mm": 30, "height_mm": 900 },
                "funnel": { "opening_diameter_mm": 28 } });
        }),
        ("apparatus.cylinder.height_mm", |s| {
            s["apparatus"] = json!({ "cylinder": { "height_mm": 15 } });
        }),
        ("engine.rate_hz", |s| s["engine"] = json!({ "rate_hz": 60 })),
        ("engine.contact_threshold_mm", |s| s["engine"] = json!({ "contact_threshold_mm": 8 })),
        ("stages[0].time_limit_s", |s| {
            s["stages"] = json!([{
                "stage": "slow_pluviation", "feed_rate_grains_per_s": 10, "base_diameter_mm": 400,
                "spout_diameter_mm": 60, "base": { "kind": "plane", "friction": 0.5 },
                "time_limit_s": 5
            }]);
        }),
    ];
    for (path, spoil) in spoilt {
        let [sieved, from_file] = both(&folder, &spoil);
        let sieved = sieved.expect_err("it is refused by the sieve table");
        assert!(sieved.iter().any(|f| f.starts_with(path)), "{path} is at fault: {sieved:?}");
        let from_file = from_file.expect_err("law: and from a file");
        assert_eq!(from_file, sieved, "law: grains from a file have the same faults");
    }
}

#[test]
fn unsuitable_values_are_warned_of() {
    let folder = folder();
    let spoil = |s: &mut Value| {
        s["engine"] = json!({ "native": { "contact_stiffness_n_per_m": 200 } });
        s["apparatus"] = json!({ "cylinder": { "height_mm": 36 },
            "funnel": { "opening_diameter_mm": 40 } });
    };
    let said = both(&folder, &spoil).map(|scenario| {
        let scenario = scenario.expect("it is sound");
        let said = warnings(&scenario);
        for words in ["contact_stiffness", "over the rim", "may jam"] {
            assert_eq!(said.iter().filter(|w| w.contains(words)).count(), 1, "{words}: {said:?}");
        }
        said.len()
    });
    assert_eq!(said, [3, 3], "law: load, cylinder and opening of both, nothing else");
}

#[test]
fn what_is_left_out_follows_from_the_file() {
    let folder = folder();
    // 5 m make 10 m/s, which need more than 480 steps a second.
    let fall = |s: &mut Value| s["stages"][1]["falling_height_mm"] = json!(5000);
    let rates = both(&folder, &fall).map(|s| s.expect("it is sound").engine.rate_hz);
    assert!(rates[0] > 1000.0, "law: the rate follows the fall, got {} Hz", rates[0]);
    assert_eq!(rates[1], rates[0], "law: and with grains from a file");
}

#[test]
fn what_was_found_is_kept_and_not_written() {
    let folder = folder();
    let [_, from_file] = both(&folder, &|_| ());
    let mut scenario = from_file.expect("sound");
    check(&scenario).expect("law: what was loaded is sound");
    let text = serde_json::json!(scenario).to_string();
    assert!(!text.contains("found"), "law: it is no part of what is written");
    scenario.engine.rate_hz = 60.0;
    check(&scenario).expect_err("law: a program's scenario is checked by the file's grains, too");
}

/// Law: a name of a file leads from a folder whose path is no text only where that is possible; the
/// scenario itself may lie there.
#[cfg(unix)]
#[test]
fn names_do_not_lead_from_a_folder_whose_path_is_no_text() {
    use std::{ffi::OsStr, os::unix::ffi::OsStrExt};
    let folder = folder();
    let odd = folder.path().join(OsStr::from_bytes(b"n\xff"));
    if fs::create_dir(&odd).is_err() {
        return skipped("a folder whose path is no text", "names of folders are UTF-8");
    }
    let load = |grains: Value| {
        let mut scenario = sound();
        scenario["grains"] = grains;
        let path = odd.join("s.json");
        fs::write(&path, scenario.to_string()).expect("written");
        load_scenario(&path, &[]).map(|loaded| loaded.scenario)
    };
    load(sound()["grains"].clone()).expect("law: nothing is named there");
    let named = folder.path().join("grains.json");
    load(json!({ "file": named })).expect("law: an absolute path leads from everywhere");
    let said = load(json!({ "file": "grains.json" })).expect_err("law: it leads nowhere");
    let words = ["grains.file", "not UTF-8", "found \"grains.json\"", "an absolute path"];
    assert_holds(&said.to_string(), &words);
}
