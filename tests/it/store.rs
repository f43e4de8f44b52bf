//! The store of stages as a user meets it: what is in it is what it says, and
//! nothing half written stays.

use std::{
    fs::{self, File},
    path::{Path, PathBuf},
};

use serde_json::Value;

use super::{
    interruption::{copy, finished, stored_as, with_results},
    program::{assert_holds, done, refused, run, text, write},
    same::assert_same_files,
    small,
};

fn check(folder: &Path) -> (Option<i32>, Value, String) {
    let (code, printed, said) = run(&["store", "check", text(folder), "--json"]);
    (code, serde_json::from_str(&printed).unwrap_or_default(), said)
}

#[test]
fn a_check_says_what_is_whole_and_what_is_damaged() {
    let (folder, _, out) = with_results();
    for place in [out.clone(), out.join("stages")] {
        let (code, report, said) = check(&place);
        assert_eq!((code, &report["damaged"]), (Some(0), &0.into()), "law: whole, got {said}");
        assert_eq!(report["stages"].as_array().map(Vec::len), Some(5), "law: with the rest test");
    }
    let words = ["fill_funnel", "vibrate", "whole", "5 of 5 stages whole, nothing is damaged"];
    assert_holds(&done(&["store", "check", text(&out)]), &words);
    let pour = stored_as(&out, "pour");
    fs::write(pour.join("specimen.json"), "{}").expect("damaged");
    let (code, report, _) = check(&out);
    assert_eq!((code, &report["damaged"]), (Some(1), &1.into()), "law: exit code 1 for damage");
    assert_holds(&run(&["store", "check", text(&out)]).1, &["DAMAGED", "specimen.json"]);
    let (code, _, said) = check(folder.path());
    assert_eq!(code, Some(2), "law: exit code 2 where there is no store, got {said}");
    let (code, _, said) = check(&folder.path().join("nowhere"));
    assert_eq!(code, Some(4), "law: exit code 4 for what cannot be read, got {said}");
    // A link to itself leads nowhere, whoever asks.
    std::os::unix::fs::symlink(".lock", folder.path().join(".lock")).expect("a link");
    let (code, _, said) = check(folder.path());
    assert_eq!(code, Some(4), "law: exit code 4 for what cannot be looked into, got {said}");
}

#[test]
fn a_stage_in_the_place_of_another_is_reported_and_done_again() {
    let (folder, scenario, out) = with_results();
    let (pour, shaken) = (stored_as(&out, "pour"), stored_as(&out, "vibrate"));
    fs::remove_dir_all(&pour).expect("removed");
    copy(&shaken, &pour);
    let (code, report, _) = check(&out);
    assert_eq!((code, &report["damaged"]), (Some(1), &1.into()), "law: a check finds it");
    let exported = folder.path().join("exported");
    let export = ["export", text(&out), "--stage", "pour", "--format", "csv"];
    refused(&[&export[..], &["--out", text(&exported)]].concat(), 2, &["another stage"]);
    let (code, _, said) = run(&["run", text(&scenario), "--out", text(&out), "--no-figures"]);
    assert_eq!(code, Some(0), "law: it does not end a run, got {said}");
    assert_eq!(said.matches("damaged and done again").count(), 1, "law: reported once, got {said}");
    assert!(said.contains("another stage"), "law: and reported what it is, got {said}");
    assert_same_files(finished(), &out, "a stage in the place of another");
    assert_eq!(check(&out).0, Some(0), "law: the store is whole again");
}

#[test]
#[ignore = "slow: make test-all"]
fn the_next_command_removes_what_a_killed_one_left_and_nothing_else() {
    let (_folder, scenario, out) = with_results();
    let folders = ["", "figures", "runs/a", "runs/a/figures", "stages"];
    let mut left = Vec::new();
    for place in folders.map(|name| out.join(name)) {
        fs::create_dir_all(&place).expect("a folder");
        left.extend([".pluvia-Ab12cd.part", ".Ab12cd.part"].map(|name| place.join(name)));
    }
    left.push(out.join("stages/.part-Ab12cd/specimen.json"));
    for path in &left {
        fs::create_dir_all(path.parent().expect("a folder")).expect("made");
        fs::write(path, "half").expect("a leftover");
    }
    // Somebody is writing this one.
    let held = out.join("figures/.pluvia-living.part");
    let writer = File::create(&held).expect("a file");
    writer.lock().expect("held");
    // They are not in the way.
    let again = ["run", text(&scenario), "--out", text(&out), "--quiet"];
    done(&again);
    let there: Vec<&PathBuf> = left.iter().filter(|path| path.exists()).collect();
    assert!(there.is_empty(), "law: leftovers of the dead go, got {there:?}");
    assert!(held.exists(), "law: what somebody is writing stays");
    drop(writer);
    done(&again);
    assert!(!held.exists(), "law: the next command removes it when its writer is gone");
    // A run's folder holds the run alone.
    refused(&["grains", text(&scenario), "--out", text(&out), "--quiet"], 2, &[]);
}

/// Law: `view --save` and `stage` remove what the dead left where they write, too.
#[test]
fn a_saved_page_and_a_stage_remove_what_killed_ones_left() {
    let folder = tempfile::tempdir().expect("a folder");
    let leftover = |name: &str| {
        let path = folder.path().join(name);
        fs::create_dir_all(path.parent().expect("a folder")).expect("made");
        fs::write(&path, "half").expect("a leftover");
        path
    };
    let left = leftover("saved/.pluvia-Ab12cd.part");
    let held = leftover("saved/.pluvia-living.part");
    let writer = File::options().write(true).open(&held).expect("a file");
    writer.lock().expect("held");
    let file = folder.path().join("saved/run.html");
    done(&["view", text(finished()), "--save", text(&file)]);
    assert!(!left.exists() && held.exists(), "law: leftovers of the dead alone go");

    let scenario = write(folder.path(), "layer.json", &small::layer(30.0));
    let out = folder.path().join("sweep");
    let over = ["--over", "seed=1,2", "--plan-only", "--out", text(&out)];
    done(&[&["sweep", text(&scenario)][..], &over].concat());
    let left = ["sweep/.pluvia-Ab12cd.part", "sweep/stages/.pluvia-Ab12cd.part"].map(leftover);
    done(&["stage", text(&out), "--level", "0", "--task", "0", "--quiet"]);
    assert!(!left.iter().any(|path| path.exists()), "law: nothing of the dead stays");
}
