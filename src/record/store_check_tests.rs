//! A check of a store finds whatever would not be used, and changes nothing.

use super::*;
use crate::record::{AskedStage, StageEnd, StageRecord, hash_bytes, write_json};
use crate::specimen::SpecimenState;

fn named(stage: &str, parent: Option<&str>) -> StageIdentity {
    let determinants = serde_json::json!({ "stage": stage, "parent": parent.unwrap_or("g") });
    StageIdentity::new(stage, (2, "g"), parent, &determinants)
}

/// A filling and a pour that goes on from it.
fn store_two(root: &Path) -> [StageIdentity; 2] {
    let store = StageStore::open(root).expect("a store");
    let fill = named("fill_funnel", None);
    let pour = named("pour", Some(&fill.key));
    let save = |identity: &StageIdentity, began_with: Option<&str>, time: f64| {
        let asked = AskedStage { identity, began_with, plausible: &|_| Ok(()) };
        let end = Some(StageEnd::default());
        let record = StageRecord { stage: identity.stage.clone(), end, ..StageRecord::default() };
        let mut state = SpecimenState::before_everything(2);
        state.time = time;
        let stage = StoredStage { record, state, series: Vec::new() };
        store.save(&asked, stage, None).expect("it is stored").0.record.specimen_sha256
    };
    let began_with = save(&fill, None, 1.0);
    save(&pour, Some(&began_with), 2.0);
    [fill, pour]
}

fn states(report: &StoreReport) -> Vec<StoredState> {
    report.stages.iter().map(|item| item.state).collect()
}

/// Notes of the stages that are damaged.
fn damage(root: &Path) -> String {
    let report = check_store(root).expect("law: damage does not end a check");
    let damaged = report.stages.iter().filter(|i| i.state == StoredState::Damaged);
    let notes: Vec<String> = damaged.filter_map(|i| i.note.clone()).collect();
    assert_eq!(notes.len(), report.damaged, "law: what is damaged is counted, and reported why");
    notes.join("; ")
}

#[test]
fn a_store_that_is_whole_is_found_to_be() {
    let root = tempfile::tempdir().expect("a folder");
    let [fill, pour] = store_two(root.path());
    fs::create_dir(root.path().join("0".repeat(24))).expect("as an engine of workflows makes");
    fs::create_dir(root.path().join(".part-left")).expect("a leftover");
    let report = check_store(root.path()).expect("checked");
    assert_eq!(report.damaged, 0, "{report:?}");
    let whole = report.stages.iter().filter(|i| i.state == StoredState::Whole).count();
    assert_eq!((whole, report.stages.len()), (2, 3), "law: what is expected is no damage");
    assert_eq!(report.unfinished[0].state, StoredState::Abandoned, "law: nobody is here");
    let found = report.stages.iter().find(|i| i.stage.as_deref() == Some("pour"));
    let found = found.expect("it says its name");
    assert_eq!((found.grains, found.parent.as_ref()), (Some(2), Some(&fill.key)));
    let open = StageStore::open(root.path()).expect("somebody");
    fs::create_dir(root.path().join(".part-now")).expect("written now");
    let report = check_store(root.path()).expect("checked");
    assert_eq!(report.unfinished[0].state, StoredState::BeingWritten, "law: somebody is here");
    drop(open);
    // Without the stage before, a stage is whole.
    fs::remove_dir_all(StageStore::folder_in(root.path(), &fill.key)).expect("removed");
    let report = check_store(root.path()).expect("checked");
    assert_eq!(report.damaged, 0, "{report:?}");
    let item = report.stages.iter().find(|i| pour.key.starts_with(&i.name)).expect("there");
    assert!(item.note.as_ref().is_some_and(|n| n.contains("not there")), "{item:?}");
}

#[test]
fn every_kind_of_damage_is_found() {
    let found = |hurt: &dyn Fn(&Path, &Path)| {
        let root = tempfile::tempdir().expect("a folder");
        let folders = store_two(root.path()).map(|i| StageStore::folder_in(root.path(), &i.key));
        hurt(&folders[0], &folders[1]);
        damage(root.path())
    };
    let record = |folder: &Path| read_record(folder).expect("a record");
    let forge = |folder: &Path, mut record: StageRecord| {
        record.record_sha256 = record.own_hash();
        write_json(&folder.join(RECORD_FILE), &record).expect("written");
    };
    let said = found(&|_, pour| fs::remove_file(pour.join("series.csv")).expect("removed"));
    assert!(said.contains("series.csv"), "{said}");
    let said = found(&|_, pour| fs::write(pour.join("specimen.json"), "{}").expect("written"));
    assert!(said.contains("specimen.json"), "{said}");
    let said = found(&|fill, pour| {
        // Two stages of one run, swapped.
        let aside = fill.with_file_name("aside");
        for (from, to) in [(fill, aside.as_path()), (pour, fill), (aside.as_path(), pour)] {
            fs::rename(from, to).expect("moved");
        }
    });
    assert_eq!(said.matches("holds another stage").count(), 2, "{said}");
    let said = found(&|_, pour| {
        let mut other = record(pour);
        other.identity.as_mut().expect("named").determined_by["stage"] = "rest".into();
        forge(pour, other);
    });
    assert!(said.contains("not that of what determined it"), "{said}");
    let said = found(&|fill, _| {
        // Another filling with all its hashes, but not the one that was poured.
        let mut state = SpecimenState::before_everything(2);
        state.time = 1.5;
        let content = serde_json::to_vec(&state).expect("JSON");
        fs::write(fill.join("specimen.json"), &content).expect("written");
        forge(fill, StageRecord { specimen_sha256: hash_bytes(&content), ..record(fill) });
    });
    assert!(said.contains("began with another specimen"), "{said}");
    let said = found(&|_, pour| forge(pour, StageRecord { stage: "rest".into(), ..record(pour) }));
    assert!(said.contains("it is named pour and rest"), "{said}");
    let said = found(&|_, pour| forge(pour, StageRecord { end: None, ..record(pour) }));
    assert!(said.contains("does not say how it ended"), "{said}");
    let said =
        found(&|_, pour| forge(pour, StageRecord { began_with_sha256: None, ..record(pour) }));
    assert!(said.contains("does not say which specimen"), "{said}");
    let said = found(&|_, pour| {
        let mut other = record(pour);
        other.identity.as_mut().expect("named").grains_sha256 = "h".into();
        forge(pour, other);
    });
    assert!(said.contains("other grains"), "{said}");
}

/// Law: what a stage began with is looked for in the store of the run that it is of: there it is
/// known, elsewhere it is said where it was to be, and another one is damage.
#[test]
fn the_specimen_of_another_run_is_known() {
    let folder = tempfile::tempdir().expect("a folder");
    let (run, root) = (folder.path().join("poured"), folder.path().join("rested/stages"));
    let [_, pour] = store_two(&run.join("stages"));
    let before = read_record(&StageStore::folder_in(&run.join("stages"), &pour.key));
    let began_with = before.expect("a record").specimen_sha256;
    let rest = named("rest", Some(&pour.key));
    let asked = |began_with| AskedStage { identity: &rest, began_with, plausible: &|_| Ok(()) };
    let record = StageRecord {
        stage: rest.stage.clone(),
        end: Some(StageEnd::default()),
        begun_in: Some(run.to_string_lossy().into_owned()),
        ..StageRecord::default()
    };
    let state = SpecimenState::before_everything(2);
    let stage = StoredStage { record, state, series: Vec::new() };
    let store = StageStore::open(&root).expect("a store");
    store.save(&asked(Some(&*began_with)), stage.clone(), None).expect("it is stored");
    let found = || {
        let mut report = check_store(&root).expect("checked");
        let item = report.stages.remove(0);
        (item.state, item.note.unwrap_or_default())
    };
    let (state, note) = found();
    let expected = format!("it began with the specimen of the run in {}", run.display());
    assert_eq!((state, note), (StoredState::Whole, expected), "law: left what is found");
    let aside = folder.path().join("aside");
    fs::rename(&run, &aside).expect("moved");
    let (state, note) = found();
    assert_eq!(state, StoredState::Whole, "law: without it the stage is whole, got {note}");
    assert!(note.contains(&*run.to_string_lossy()), "law: it says where it was, got {note}");
    fs::rename(&aside, &run).expect("moved back");
    store.save(&asked(Some("another")), stage, None).expect("it takes the other's place");
    let (state, note) = found();
    assert_eq!(state, StoredState::Damaged, "law: it began with another, got {note}");
    assert!(note.contains("began with another specimen"), "law: and it says so, got {note}");
}

/// Law: a checkpoint that its stage removed after it was listed is no damage; one that is there and
/// cannot be read is.
#[test]
fn a_checkpoint_that_is_gone_is_not_damaged() {
    let root = tempfile::tempdir().expect("a folder");
    let folder = format!("{}{}", checkpoint::FOLDER, "0".repeat(24));
    let path = root.path().join(&folder).join("1.segment");
    let got = checkpoint_at(&path, &folder);
    assert_eq!(got, None, "law: left the item of one that is gone, right none");
    fs::create_dir_all(&path).expect("a folder in its place");
    let got = checkpoint_at(&path, &folder).map(|item| item.state);
    assert_eq!(got, Some(StoredState::Damaged), "law: left one that cannot be read, right damaged");
}

#[test]
fn damaged_and_foreign_checkpoints_are_found() {
    let root = tempfile::tempdir().expect("a folder");
    let [fill, pour] = store_two(root.path());
    let folder = |identity: &StageIdentity| {
        root.path().join(format!("{}{}", checkpoint::FOLDER, &identity.key[..24]))
    };
    let checkpoints = || {
        let report = check_store(root.path()).expect("checked");
        let items = report.checkpoints.iter();
        let items = items.map(|item| (item.state, item.note.clone().unwrap_or_default()));
        (report.damaged, items.collect::<Vec<_>>())
    };
    checkpoint::tests::keep_one(root.path(), &pour);
    let (damaged, items) = checkpoints();
    assert_eq!((damaged, items[0].0), (0, StoredState::Whole), "law: it is whole, got {items:?}");
    fs::rename(folder(&pour), folder(&fill)).expect("moved");
    let (damaged, items) = checkpoints();
    assert!(damaged == 1 && items[0].1.contains("another stage"), "law: not its own, {items:?}");
    let file = checkpoint::files(&folder(&fill)).remove(0);
    fs::write(file, "half").expect("damaged");
    let (damaged, items) = checkpoints();
    assert!(damaged == 1 && items[0].1.contains("not what was written"), "law: got {items:?}");
}

#[test]
fn a_check_changes_nothing_and_earlier_stages_are_no_damage() {
    let root = tempfile::tempdir().expect("a folder");
    let [fill, _] = store_two(root.path());
    let folder = StageStore::folder_in(root.path(), &fill.key);
    let mut old = read_record(&folder).expect("a record");
    (old.identity, old.record_sha256, old.end) = (None, String::new(), None);
    write_json(&folder.join(RECORD_FILE), &old).expect("written");
    let left = root.path().join(".pluvia-Abc123.part");
    fs::write(&left, "half").expect("a leftover");
    let report = check_store(root.path()).expect("checked");
    assert_eq!(report.damaged, 0, "{report:?}");
    assert!(states(&report).contains(&StoredState::Earlier), "{report:?}");
    assert!(left.exists(), "law: a check removes nothing");
    assert_eq!(report.unfinished[0].state, StoredState::Abandoned);
}
