//! No byte of a stored stage can change and be used.

use super::*;

/// A stage with two rows and two frames.
fn store_one(root: &Path) -> (StageStore, StoredStage, PathBuf) {
    let store = StageStore::open(root).expect("a store").with_frames(true);
    let state = SpecimenState::before_everything(2);
    let row = |time_s| SeriesRow {
        time_s,
        stage: 0,
        plate_height_mm: None,
        settlement_mm: None,
        surface_settlement_mm: None,
        kinetic_energy_j: 0.1,
        table_x_mm: 0.0,
        mean_surface_mm: 1.0 / 3.0,
        mean_grain_height_mm: 2.0,
        grains_in_cylinder: 2,
        plate_tilt_deg: None,
        largest_speed_m_per_s: 0.5,
        pile_height_mm: None,
    };
    let mut frames = store.frames(2).expect("a file").expect("frames are kept");
    frames.add(&state, 0.0);
    frames.add(&state, 0.08);
    let record = StageRecord {
        stage: "rest".into(),
        steps: 39,
        wall_s: 0.1 + 0.2,
        sieved_mm: vec![Some(11.3), None],
        warnings: vec!["a — warning".into()],
        ..StageRecord::default()
    };
    let stage = StoredStage { record, state, series: vec![row(0.0), row(0.08)] };
    let saved = store.save("key", stage, Some(frames)).expect("it is stored");
    let folder = store.folder("key");
    (store, saved, folder)
}

fn files(folder: &Path) -> Vec<PathBuf> {
    fs::read_dir(folder).expect("a folder").flatten().map(|e| e.path()).collect()
}

#[test]
fn what_is_stored_comes_back_and_nothing_else_is_left() {
    let root = tempfile::tempdir().expect("a folder");
    let (store, saved, folder) = store_one(root.path());
    assert_eq!(store.load("key"), (Some(saved), None), "law: a stage comes back as it was");
    assert_eq!(files(&folder).len(), 4, "law: stage, specimen, series and frames");
    let frames = StageStore::frames_in(root.path(), "key").expect("sound").expect("kept");
    assert_eq!(frames.0.len(), 2, "law: as many frames as were added");
    let state = StageStore::state_in(root.path(), "key").expect("sound").0;
    assert_eq!(state, SpecimenState::before_everything(2));
}

#[test]
fn every_byte_that_changes_is_noticed_or_changes_nothing() {
    let root = tempfile::tempdir().expect("a folder");
    let (store, saved, folder) = store_one(root.path());
    let (mut tried, mut harmless) = (0, 0);
    for path in files(&folder) {
        let whole = fs::read(&path).expect("a file");
        for at in 0..whole.len() {
            let mut torn = whole.clone();
            // 32 makes of a letter the other case, of a digit a control character.
            torn[at] ^= if tried % 2 == 0 { 1 } else { 32 };
            fs::write(&path, &torn).expect("written");
            tried += 1;
            match store.load("key") {
                (None, Some(why)) => {
                    let name = path.file_name().expect("a name").to_string_lossy();
                    assert!(why.contains(&*name), "law: {name} is named, got {why}");
                }
                (Some(stage), None) => {
                    // White space of the record, which is no content.
                    assert_eq!(stage, saved, "law: byte {at} of {path:?} changes nothing");
                    assert!(path.ends_with("stage.json"), "law: {path:?} is compared by its bytes");
                    harmless += 1;
                }
                other => panic!("law: a stage, or why there is none; got {other:?}"),
            }
        }
        fs::write(&path, whole).expect("as it was");
    }
    assert!(tried > 1000 && harmless * 5 < tried, "{harmless} of {tried} bytes are no content");
    assert_eq!(store.load("key"), (Some(saved), None), "law: as it was, it is used again");
}

#[test]
fn a_file_cut_off_lengthened_emptied_or_gone_is_noticed() {
    let root = tempfile::tempdir().expect("a folder");
    let (store, _, folder) = store_one(root.path());
    for path in files(&folder) {
        let whole = fs::read(&path).expect("a file");
        let torn = [&whole[..whole.len() / 2], &whole[..0], &[&whole[..], b"}"].concat()];
        for torn in torn {
            fs::write(&path, torn).expect("written");
            let (found, why) = store.load("key");
            assert!(found.is_none() && why.is_some(), "law: {path:?} of {} bytes", torn.len());
        }
        fs::remove_file(&path).expect("removed");
        let (found, why) = store.load("key");
        assert!(found.is_none() && why.is_some(), "law: without {path:?} it is not used");
        fs::write(&path, whole).expect("as it was");
    }
    let frames = folder.join(FRAMES_FILE);
    fs::remove_file(&frames).expect("removed");
    let found = StageStore::frames_in(root.path(), "key").expect("the stage is whole");
    assert!(found.is_none(), "law: frames that were removed to make room are none");
    let plain = StageStore::open(root.path()).expect("a store");
    assert!(plain.load("key").0.is_some(), "law: frames that nobody wants are not missed");
}

#[test]
fn a_stage_of_an_older_version_has_no_sums_and_is_used() {
    let root = tempfile::tempdir().expect("a folder");
    let (store, saved, folder) = store_one(root.path());
    let mut old = saved.record.clone();
    old.frames_sha256.clear();
    old.record_sha256.clear();
    write_json(&folder.join("stage.json"), &old).expect("written");
    assert_eq!(store.load("key").0.map(|s| s.state), Some(saved.state));
}

#[test]
fn leftovers_of_the_dead_go_and_those_of_the_living_stay() {
    let root = tempfile::tempdir().expect("a folder");
    let leftover = root.path().join(".part-x");
    let living = StageStore::open(root.path()).expect("a store");
    fs::create_dir(&leftover).expect("made");
    drop(StageStore::open(root.path()).expect("another"));
    assert!(leftover.exists(), "law: while a store is open, nothing is removed");
    drop(living);
    drop(StageStore::open(root.path()).expect("another"));
    assert!(!leftover.exists(), "law: alone, what is half written is removed");
}

#[test]
fn an_error_says_what_is_kept() {
    let root = tempfile::tempdir().expect("a folder");
    let full = || FileError::new("write", Path::new("a"), "full");
    let store = StageStore::open(root.path()).expect("a store");
    let said = |store: &StageStore| store.keeping(full()).to_string();
    assert!(said(&store).contains("no stage had been finished"), "{}", said(&store));
    let (store, ..) = store_one(root.path());
    assert!(said(&store).contains("the finished stage in"), "{}", said(&store));
    fs::remove_dir_all(root.path()).expect("removed");
    assert!(said(&store).contains("are gone too"), "{}", said(&store));
}
