//! Stored stages that were crafted, with every hash as it should be, are reported
//! and made anew; the run ends with the same bits.

use std::{fs, path::Path, sync::Arc};

#[path = "crafts_tests.rs"]
mod crafts;

use crafts::{craft, crafts};

use crate::geometry::Pose;
use crate::record::{
    StageRecord, StageStore, StoredStage, hash_bytes, hash_json, read_json, to_csv, write_file,
    write_json,
};
use crate::scenario::StageSpec;
use crate::specimen::{Base, Fate, FixedGrain};
use crate::study::{
    begin::Begun,
    believed::held,
    plan::Plan,
    tests::{Heard, planned, scenario, shop},
};

/// Runs a plan; gives its stages, and what was reported of stored ones.
fn run(plan: &Plan, folder: &Path) -> (Vec<Arc<StoredStage>>, Vec<String>) {
    let _turn = crate::world::shared_turn();
    let store = StageStore::open(folder).expect("a store");
    let heard = Heard::default();
    let done = shop(&store, 2, &crate::world::create, &heard).execute(plan).expect("done");
    let mut reported = heard.told();
    reported.retain(|text| text.contains("stored"));
    (done, reported)
}

#[test]
fn crafted_states_with_their_hashes_are_made_anew() {
    let (own, mut other) = (scenario(50.0), scenario(50.0));
    other.contact.grain_grain_friction = 0.2;
    let [plan, slippery] = [own, other].map(|s| Plan::new(&[planned(s)]).expect("a plan"));
    let folder = tempfile::tempdir().expect("a folder");
    let (done, reported) = run(&plan, folder.path());
    assert!(reported.is_empty(), "law: nothing is wrong with what is new, got {reported:?}");
    let (again, reported) = run(&plan, folder.path());
    assert!(reported.is_empty() && again == done, "law: sound stages are used, got {reported:?}");
    let (others, _) = run(&slippery, folder.path());

    let [fill, pour] = [plan.runs[0].stages[0], plan.runs[0].stages[1]];
    let mut all = crafts(&done[pour], &done[fill]);
    all.push(("another friction's pour", others[pour].as_ref().clone()));
    assert_eq!(all.len(), 12, "law: every craft is tried");
    for (what, stage) in all {
        let place = StageStore::folder_in(folder.path(), plan.nodes[pour].key());
        craft(&place, &stage);
        let (again, reported) = run(&plan, folder.path());
        let made_anew = reported.iter().filter(|t| t.contains("damaged and done again")).count();
        assert_eq!(made_anew, 1, "law: {what} is reported once, got {reported:?}");
        let same = again[pour].state == done[pour].state && again[pour].series == done[pour].series;
        assert!(same, "law: {what} is not used");
        let (_, reported) = run(&plan, folder.path());
        assert!(reported.is_empty(), "law: after {what} it is sound again, got {reported:?}");
    }
}

/// Law: what jobs of a cluster, workflows and collecting believe to be stored is what would be used: its
/// files and hashes, too, not its record alone.
#[test]
fn what_is_held_is_what_would_be_used() {
    let plan = Plan::new(&[planned(scenario(50.0))]).expect("a plan");
    let folder = tempfile::tempdir().expect("a folder");
    let (done, _) = run(&plan, folder.path());
    let held = || {
        let store = StageStore::open(folder.path()).expect("a store");
        held(&plan, &store)
    };
    let all = vec![true; plan.nodes.len()];
    assert_eq!(held(), all, "law: sound stages are held");
    let [fill, pour] = [plan.runs[0].stages[0], plan.runs[0].stages[1]];
    let place = |node: usize| StageStore::folder_in(folder.path(), plan.nodes[node].key());
    for name in ["specimen.json", "series.csv", "stage.json"] {
        let path = place(pour).join(name);
        let whole = fs::read(&path).expect("a file");
        let mut hurt = whole.clone();
        let middle = hurt.len() / 2;
        hurt[middle] ^= 1;
        fs::write(&path, hurt).expect("damaged");
        let found = held();
        assert!(found[fill] && !found[pour], "law: a byte of {name} is seen, got {found:?}");
        fs::write(&path, whole).expect("as it was");
    }
    let mut lifted = StoredStage::clone(&done[pour]);
    lifted.state.bodies.iter_mut().for_each(|g| g.body.pose.translation.vector.z += 1e-3);
    craft(&place(pour), &lifted);
    assert!(!held()[pour], "law: a crafted state with its hashes is none");
    craft(&place(pour), &done[pour]);
    assert_eq!(held(), all, "law: put back it is held");
    fs::remove_dir_all(place(fill)).expect("removed");
    let found = held();
    assert!(!found[fill] && !found[pour], "law: nothing without what it goes on from, {found:?}");
}

/// Law: of a run that begins with the specimen of another its stored stages are held, too.
#[test]
fn stages_of_a_begun_run_are_held() {
    let poured = Plan::new(&[planned(scenario(50.0))]).expect("a plan");
    let folder = tempfile::tempdir().expect("a folder");
    let (done, _) = run(&poured, folder.path());
    let pour = done[poured.runs[0].stages[1]].as_ref().clone();
    let mut rests = scenario(50.0);
    rests.stages = vec![StageSpec::Rest { duration_s: 0.1 }];
    let mut plan = Plan::new(&[planned(rests)]).expect("a plan");
    let (folder_of, key) = Default::default();
    let begun = Begun { run: folder_of, key, record: pour.record, state: pour.state };
    plan.nodes[0].begun = Some(Arc::new(begun));
    let held = || held(&plan, &StageStore::open(folder.path()).expect("a store"));
    assert_eq!(held(), [false, false], "law: nothing is stored yet");
    run(&plan, folder.path());
    assert_eq!(held(), [true, true], "law: the rest and the rest test are");
}
