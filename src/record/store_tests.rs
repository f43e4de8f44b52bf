//! No byte of a stored stage can change and be used, and no stage is taken for another.

use std::sync::{Barrier, mpsc};

use super::*;
use crate::record::{SeriesRow, StageEnd, StageIdentity, StageRecord, hash_json};

/// A stage of two grains that nothing comes before.
fn named(stage: &str, seed: u64) -> StageIdentity {
    let determinants = serde_json::json!({ "seed": seed, "share": 0.1 + 0.2, "parent": "g" });
    StageIdentity::new(stage, (2, "g"), None, &determinants)
}

fn asked(identity: &StageIdentity) -> AskedStage<'_> {
    AskedStage { identity, began_with: None, plausible: &|_| Ok(()) }
}

/// A stage with two rows.
fn made() -> StoredStage {
    let row = |time_s| SeriesRow {
        time_s,
        kinetic_energy_j: 0.1,
        mean_surface_mm: Some(1.0 / 3.0),
        mean_grain_height_mm: Some(2.0),
        grains_in_cylinder: 2,
        largest_speed_m_per_s: 0.5,
        ..SeriesRow::default()
    };
    let record = StageRecord {
        stage: "rest".into(),
        steps: 39,
        wall_s: 0.1 + 0.2,
        sieved_mm: vec![Some(11.3), None],
        warnings: vec!["a — warning".into()],
        end: Some(StageEnd { grains: 2, ..StageEnd::default() }),
        ..StageRecord::default()
    };
    let state = SpecimenState::before_everything(2);
    StoredStage { record, state, series: vec![row(0.0), row(0.08)] }
}

/// A stored stage with two frames.
fn store_one(root: &Path) -> (StageStore, StoredStage, PathBuf) {
    let store = StageStore::open(root).expect("a store").with_frames(true);
    let stage = made();
    let mut frames = store.frames(2, 0).expect("a file").expect("frames are kept");
    frames.add(&stage.state, 0.0);
    frames.add(&stage.state, 0.08);
    let identity = named("rest", 1);
    let (saved, note) = store.save(&asked(&identity), stage, Some(frames)).expect("it is stored");
    assert_eq!(note, None, "law: nobody else stored it");
    let folder = store.folder(&identity.key);
    (store, saved, folder)
}

fn load(store: &StageStore) -> (Option<StoredStage>, Option<String>) {
    store.load(&asked(&named("rest", 1)))
}

fn key() -> String {
    named("rest", 1).key
}

fn files(folder: &Path) -> Vec<PathBuf> {
    fs::read_dir(folder).expect("a folder").flatten().map(|e| e.path()).collect()
}

/// Law: what failed, for lack of memory perhaps, is as if it had not once it is stored.
#[test]
fn a_stage_that_is_stored_has_not_failed() {
    let folder = tempfile::tempdir().expect("a folder");
    let store = StageStore::open(folder.path()).expect("a store");
    let kept = store.keep_failed(&key(), &made().state, "no memory", &[]).expect("it is kept");
    assert_eq!(store.failure(&key()).as_deref(), Some("no memory"));
    store.save(&asked(&named("rest", 1)), made(), None).expect("it is stored");
    assert!(!kept.exists() && store.failure(&key()).is_none(), "law: nothing is left of it");
}

#[test]
fn what_is_stored_comes_back_and_nothing_else_is_left() {
    let root = tempfile::tempdir().expect("a folder");
    let (store, saved, folder) = store_one(root.path());
    assert_eq!(load(&store), (Some(saved), None), "law: a stage comes back as it was");
    assert_eq!(files(&folder).len(), 4, "law: stage, specimen, series and frames");
    let frames =
        StageStore::frames_in(root.path(), &key(), FramesRead::All).expect("sound").expect("kept");
    assert_eq!(frames.0.len(), 2, "law: as many frames as were added");
    let state = StageStore::stage_in(root.path(), &key(), "").expect("sound").1;
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
            match load(&store) {
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
    assert_eq!(load(&store), (Some(saved), None), "law: as it was, it is used again");
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
            let (found, why) = load(&store);
            assert!(found.is_none() && why.is_some(), "law: {path:?} of {} bytes", torn.len());
        }
        fs::remove_file(&path).expect("removed");
        let (found, why) = load(&store);
        assert!(found.is_none() && why.is_some(), "law: without {path:?} it is not used");
        fs::write(&path, whole).expect("as it was");
    }
    let frames = folder.join(FRAMES_FILE);
    fs::remove_file(&frames).expect("removed");
    let found =
        StageStore::frames_in(root.path(), &key(), FramesRead::All).expect("the stage is whole");
    assert!(found.is_none(), "law: frames that were removed to make room are none");
    let plain = StageStore::open(root.path()).expect("a store");
    assert!(load(&plain).0.is_some(), "law: frames that nobody wants are not missed");
}

/// Writes a record over that of a stage, with the hash that belongs to it.
fn forge(folder: &Path, mut record: StageRecord) {
    record.record_sha256 = record.own_hash();
    write_json(&folder.join(RECORD_FILE), &record).expect("written");
}

#[test]
fn a_stage_that_does_not_say_which_it_is_is_shown_but_not_used() {
    let root = tempfile::tempdir().expect("a folder");
    let (store, saved, folder) = store_one(root.path());
    let mut old = saved.record.clone();
    (old.identity, old.record_sha256) = (None, String::new());
    write_json(&folder.join(RECORD_FILE), &old).expect("written");
    let (found, why) = load(&store);
    assert!(found.is_none(), "law: it is not used");
    assert!(why.is_some_and(|why| why.contains("does not say which stage")), "law: and reported");
    assert!(store.sound(&asked(&named("rest", 1))).is_none(), "law: it counts as missing");
    StageStore::stage_in(root.path(), &key(), "").expect("law: runs of earlier versions are shown");
    let mut unsummed = saved.record;
    unsummed.record_sha256.clear();
    write_json(&folder.join(RECORD_FILE), &unsummed).expect("written");
    assert!(load(&store).0.is_none(), "law: a record that says what it is has its hash");
}

#[test]
fn a_stage_in_the_place_of_another_is_not_used() {
    let root = tempfile::tempdir().expect("a folder");
    let (store, saved, folder) = store_one(root.path());
    let other = named("rest", 2);
    fs::rename(&folder, store.folder(&other.key)).expect("moved");
    let (found, why) = store.load(&asked(&other));
    assert!(found.is_none(), "law: another's stage is not used");
    assert!(why.is_some_and(|why| why.contains("another stage")), "law: and reported");
    assert!(store.sound(&asked(&other)).is_none(), "law: it counts as missing");
    let said = StageStore::stage_in(root.path(), &other.key, "").expect_err("law: nor shown");
    assert!(said.to_string().contains("another stage"), "{said}");
    StageStore::frames_in(root.path(), &other.key, FramesRead::All)
        .expect_err("law: nor are its frames");
    // Even with the key that its place asks for, and all hashes.
    let mut record = saved.record;
    record.identity.as_mut().expect("it says").key = other.key.clone();
    forge(&store.folder(&other.key), record);
    let (found, why) = store.load(&asked(&other));
    assert!(found.is_none(), "law: a key that is not that of what determined it is noticed");
    assert!(why.is_some_and(|why| why.contains("determined")), "law: and reported");
}

#[test]
fn crafted_records_and_states_with_their_hashes_are_not_used() {
    type Craft = fn(&mut StageRecord);
    let crafts: [(&str, Craft); 6] = [
        ("stage", |r| r.identity.as_mut().expect("it says").stage = "pour".into()),
        ("number of grains", |r| r.identity.as_mut().expect("it says").grains = 3),
        ("hash of the grains", |r| {
            r.identity.as_mut().expect("it says").grains_sha256 = "h".into()
        }),
        ("stage before", |r| r.identity.as_mut().expect("it says").parent = Some("p".into())),
        ("determined", |r| r.identity.as_mut().expect("it says").determined_by["seed"] = 3.into()),
        ("another specimen", |r| r.began_with_sha256 = Some("s".into())),
    ];
    let root = tempfile::tempdir().expect("a folder");
    let (store, saved, folder) = store_one(root.path());
    for (word, craft) in crafts {
        let mut record = saved.record.clone();
        craft(&mut record);
        forge(&folder, record);
        let (found, why) = load(&store);
        assert!(found.is_none(), "law: another {word} is noticed");
        assert!(why.as_ref().is_some_and(|why| why.contains(word)), "law: {word}, got {why:?}");
    }
    // Too few bodies.
    let few = serde_json::to_vec(&SpecimenState::before_everything(1)).expect("JSON");
    fs::write(folder.join(STATE_FILE), &few).expect("written");
    forge(&folder, StageRecord { specimen_sha256: hash_bytes(&few), ..saved.record });
    let (found, why) = load(&store);
    assert!(found.is_none() && why.is_some_and(|why| why.contains("1 body")), "law: all grains");
    StageStore::stage_in(root.path(), &key(), "").expect_err("law: nor is it shown");
}

#[test]
fn what_cannot_be_and_what_a_manifest_does_not_know_is_not_used() {
    let root = tempfile::tempdir().expect("a folder");
    let (store, saved, _) = store_one(root.path());
    let identity = named("rest", 1);
    let impossible = AskedStage { plausible: &|_| Err("grains fly".into()), ..asked(&identity) };
    let (found, why) = store.load(&impossible);
    assert!(found.is_none() && why.is_some_and(|why| why.contains("grains fly")));
    let sum = &saved.record.specimen_sha256;
    StageStore::stage_in(root.path(), &key(), sum).expect("law: as the manifest has it");
    StageStore::stage_in(root.path(), &key(), "0").expect_err("law: another than it has");
    let unknown = StageRecord { frames_sha256: String::new(), ..saved.record.clone() };
    forge(&store.folder(&key()), unknown);
    let frames =
        StageStore::frames_in(root.path(), &key(), FramesRead::All).expect("a whole stage");
    assert!(frames.is_none(), "law: frames that a stage knows nothing of are not shown");
}

#[test]
fn what_determined_a_stage_has_the_same_hash_read_back() {
    let identity = named("rest", 1);
    let text = serde_json::to_string_pretty(&identity).expect("JSON");
    let back: StageIdentity = serde_json::from_str(&text).expect("read back");
    assert_eq!(hash_json(&back.determined_by), identity.key, "law: the key follows from the file");
    back.check().expect("law: it fits itself");
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

/// Whether somebody waits for the lock of a file; none where the system does not say.
fn is_awaited(file: &File) -> Option<bool> {
    use std::os::unix::fs::MetadataExt;
    let locks = fs::read_to_string("/proc/locks").ok()?;
    let inode = format!(":{} ", file.metadata().ok()?.ino());
    Some(locks.lines().any(|line| line.contains("->") && line.contains(&inode)))
}

/// Law: a store that is open is locked, also when it was opened while somebody
/// was removing leftovers; a third must not remove what the second writes.
#[test]
fn a_store_is_never_open_without_its_lock() {
    let root = tempfile::tempdir().expect("a folder");
    drop(StageStore::open(root.path()).expect("a store"));
    let lock = File::options().append(true).open(root.path().join(LOCK)).expect("its lock");
    lock.lock().expect("held, as by one that removes leftovers");
    if is_awaited(&lock).is_none() {
        eprintln!("not tested here: the system does not say who waits for a lock");
        return;
    }
    let (opened, is_open) = mpsc::channel();
    std::thread::scope(|scope| {
        scope.spawn(|| opened.send(StageStore::open(root.path()).expect("a store")));
        // Until the second waits, or has opened it without its lock.
        let mut second = None;
        while second.is_none() && is_awaited(&lock) == Some(false) {
            second = is_open.try_recv().ok();
            std::thread::yield_now();
        }
        lock.unlock().expect("the leftovers are removed");
        let second = second.unwrap_or_else(|| is_open.recv().expect("it opens"));
        let part = second.part().expect("it writes");
        drop(StageStore::open(root.path()).expect("a third"));
        assert!(part.path().exists(), "law: what somebody writes is not removed");
    });
}

/// Law: who comes second keeps what is there, so that no reader misses it.
#[test]
fn a_stage_that_is_stored_already_is_never_taken_away() {
    use std::os::unix::fs::MetadataExt;
    let root = tempfile::tempdir().expect("a folder");
    let (store, first, folder) = store_one(root.path());
    let inode = || fs::metadata(&folder).expect("law: it is there").ino();
    let before = inode();
    let identity = named("rest", 1);
    // Asked in the middle of the second saving, when it has found the first.
    let reader = |stage: &StoredStage| {
        assert_eq!(inode(), before, "law: it is there all the time");
        assert_eq!(stage.record, first.record, "law: it is the first");
        Ok(())
    };
    let second = AskedStage { plausible: &reader, ..asked(&identity) };
    let mut made = made();
    made.record.wall_s = 7.0;
    let (kept, note) = store.save(&second, made.clone(), None).expect("law: that is no error");
    assert_eq!((kept, note), (first.clone(), None), "law: the first is kept and given");
    assert_eq!(inode(), before, "law: it was not replaced");
    // Another result of the same stage: the first is kept, and that is reported.
    made.state.time = 1.0;
    let (kept, note) = store.save(&second, made, None).expect("law: that is no error");
    assert_eq!(kept, first, "law: the first is kept");
    assert!(note.is_some_and(|note| note.contains("another result")), "law: and it is reported");
    let left: Vec<PathBuf> = parts_in(root.path());
    assert!(left.is_empty(), "law: nothing half written is left, got {left:?}");
}

/// Law: of two programs that have both found a stage damaged, one replaces it and
/// the other keeps what the first has put there.
#[test]
fn a_damaged_stage_is_replaced_once() {
    use std::os::unix::fs::MetadataExt;
    let root = tempfile::tempdir().expect("a folder");
    let (store, _, folder) = store_one(root.path());
    let damaged = fs::metadata(&folder).expect("there").ino();
    let identity = named("rest", 1);
    let both_made_it = Barrier::new(2);
    let finish = |steps| {
        let (store, identity, both_made_it) = (&store, &identity, &both_made_it);
        move || {
            let judge = |stage: &StoredStage| match stage.record.steps {
                39 => Err("damaged".to_owned()),
                _ => Ok(()),
            };
            let own = AskedStage { plausible: &judge, ..asked(identity) };
            assert!(store.load(&own).0.is_none(), "law: it is damaged");
            let mut made = made();
            made.record.steps = steps;
            both_made_it.wait();
            store.save(&own, made, None).expect("law: neither fails").0.record.steps
        }
    };
    let kept = std::thread::scope(|scope| {
        let threads = [40, 41].map(|steps| scope.spawn(finish(steps)));
        threads.map(|thread| thread.join().expect("law: neither panics"))
    });
    assert_eq!(kept[0], kept[1], "law: both go on from the same stage");
    let now = store.load(&asked(&identity)).0.expect("law: it is whole");
    assert_eq!(now.record.steps, kept[0], "law: the one that is there");
    assert_ne!(fs::metadata(&folder).expect("there").ino(), damaged, "law: it was replaced");
}

/// Law: what is at a stage's place and cannot be listed is damage, not nothing, and is replaced.
#[test]
fn what_cannot_be_listed_is_not_taken_for_nothing() {
    let root = tempfile::tempdir().expect("a folder");
    let (store, _, folder) = store_one(root.path());
    fs::remove_dir_all(&folder).expect("removed");
    assert_eq!(load(&store), (None, None), "law: nothing is there");
    fs::write(&folder, "").expect("a file");
    let why = load(&store).1.unwrap_or_default();
    assert!(why.contains("damaged and done again"), "law: reported, got `{why}`");
    store.save(&asked(&named("rest", 1)), made(), None).expect("law: it is replaced");
    assert!(load(&store).0.is_some(), "law: by a whole one");
}

/// Law: where many finish the same stage at once, a reader that has seen it once sees it always.
#[test]
fn a_reader_never_misses_a_stage_that_many_store_at_once() {
    const WRITERS: usize = 4;
    let root = tempfile::tempdir().expect("a folder");
    let store = StageStore::open(root.path()).expect("a store");
    let identity = named("rest", 1);
    let start = Barrier::new(WRITERS);
    std::thread::scope(|scope| {
        let write = || {
            start.wait();
            store.save(&asked(&identity), made(), None).expect("law: nobody fails");
        };
        let writers = [(); WRITERS].map(|()| scope.spawn(write));
        let mut seen = false;
        while !writers.iter().all(|writer| writer.is_finished()) {
            let (found, why) = store.load(&asked(&identity));
            assert_eq!(why, None, "law: it is never damaged");
            assert!(found.is_some() || !seen, "law: once there it stays");
            seen |= found.is_some();
        }
    });
    assert!(load(&store).0.is_some(), "law: it is there");
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

/// Damages the stage of a store and puts a sound one in its place, as `exchange` does.
fn replaced_by(exchange: fn(&Path, &Path) -> bool) -> (Option<StoredStage>, usize) {
    let [root, other] = [(), ()].map(|()| tempfile::tempdir().expect("a folder"));
    let (store, _, folder) = store_one(root.path());
    fs::write(folder.join(STATE_FILE), "{}").expect("damaged");
    let (_, _, sound) = store_one(other.path());
    let part = store.part().expect("a folder");
    for file in files(&sound) {
        fs::copy(&file, part.path().join(file.file_name().expect("a name"))).expect("copied");
    }
    let identity = named("rest", 1);
    let first = store.publish(exchange, part.path(), &folder, &asked(&identity));
    assert_eq!(first.expect("replaced"), None, "law: a damaged stage is not kept");
    drop(part);
    (load(&store).0, parts_in(root.path()).len())
}

/// Law: while a damaged stage is replaced, there is always one of its name.
#[test]
fn a_damaged_stage_is_exchanged_at_once() {
    let folder = tempfile::tempdir().expect("a folder");
    let [one, other] = ["one", "other"].map(|name| folder.path().join(name));
    for path in [&one, &other] {
        fs::create_dir(path).expect("made");
        fs::write(path.join(path.file_name().expect("a name")), "").expect("written");
    }
    let can = exchange(&one, &other);
    if can {
        assert!(one.join("other").exists() && other.join("one").exists(), "law: exchanged");
        static ASKED: std::sync::atomic::AtomicBool = std::sync::atomic::AtomicBool::new(false);
        let over = std::sync::atomic::Ordering::SeqCst;
        let (stage, left) = replaced_by(|part, target| {
            ASKED.store(true, std::sync::atomic::Ordering::SeqCst);
            let done = exchange(part, target);
            let [new, old] = [target, part].map(|folder| folder.join(RECORD_FILE).exists());
            assert!(done && new && old, "law: the new one is there, and the old one, too");
            done
        });
        assert!(stage.is_some() && left == 0, "law: it is sound, and nothing is left, {left}");
        assert!(ASKED.load(over), "law: an exchange is tried before anything is taken away");
        // Who reads meanwhile never misses it.
        let (store, _, folder) = store_one(&folder.path().join("store"));
        let (identity, record) = (named("rest", 1), folder.join(RECORD_FILE));
        let is_over = std::sync::atomic::AtomicBool::new(false);
        std::thread::scope(|scope| {
            let reader = scope.spawn(|| {
                let mut missed = 0;
                while !is_over.load(over) {
                    missed += u32::from(!record.exists());
                }
                missed
            });
            for _ in 0..40 {
                fs::write(folder.join(STATE_FILE), "{}").expect("damaged");
                store.save(&asked(&identity), made(), None).expect("it is stored");
            }
            is_over.store(true, over);
            assert_eq!(reader.join().expect("it reads"), 0, "law: a reader never misses it");
        });
    } else {
        eprintln!("not tested here: the file system cannot exchange two folders");
    }
    let (stage, left) = replaced_by(|_, _| false);
    assert!(
        stage.is_some() && left == 0,
        "law: without an exchange it is replaced as well, {left}"
    );
}
