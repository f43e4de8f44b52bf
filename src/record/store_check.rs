//! Looks a whole store over, changing nothing.

use std::collections::BTreeMap;

use super::*;

/// What became of something in a store.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum StoredState {
    /// All there, as it was written, and what its place says.
    Whole,
    /// It is made anew when it is needed.
    Damaged,
    /// Of an earlier version, which did not say what it stored: not used any more.
    Earlier,
    /// An empty folder, as engines of workflows make before a stage is stored.
    Expected,
    /// Somebody is writing it.
    BeingWritten,
    /// Its writer was killed; the next command that uses the store removes it.
    Abandoned,
}

/// A stage, a checkpoint, or what is half written.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct StoredItem {
    /// Its name in the store.
    pub name: String,
    /// What became of it.
    pub state: StoredState,
    /// What it says it is; none where it does not say.
    pub stage: Option<String>,
    /// How many grains; none where it does not say.
    pub grains: Option<usize>,
    /// Key of the stage before; none of the first of a run.
    pub parent: Option<String>,
    /// What is wrong, or what a reader should know.
    pub note: Option<String>,
}

/// What a store holds.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct StoreReport {
    /// Its folder.
    #[serde(serialize_with = "json_path")]
    pub store: PathBuf,
    /// How many stages and checkpoints are damaged.
    pub damaged: usize,
    /// Stages by name.
    pub stages: Vec<StoredItem>,
    /// Checkpoints of stages that are not finished.
    pub checkpoints: Vec<StoredItem>,
    /// What is half written.
    pub unfinished: Vec<StoredItem>,
}

impl StoredItem {
    fn new(name: String, state: StoredState, identity: Option<&StageIdentity>) -> Self {
        Self {
            name,
            state,
            stage: identity.map(|i| i.stage.clone()),
            grains: identity.map(|i| i.grains),
            parent: identity.and_then(|i| i.parent.clone()),
            note: None,
        }
    }

    fn damaged(&mut self, why: impl ToString) {
        self.state = StoredState::Damaged;
        self.note = Some(why.to_string());
    }
}

/// Checks every stage of a store (complete, hashes, its key that of its folder and of what
/// determined it, the stage before, bodies, finite numbers), every checkpoint, and lists what is
/// half written. Of a specimen that a run began with, the store of its own run is asked. Whether a state can be one of its laboratory is checked when it is used.
///
/// # Errors
/// When the folder cannot be listed.
pub fn check_store(root: &Path) -> Result<StoreReport, FileError> {
    let listed = |e| FileError::new("list", root, e);
    let mut names = Vec::new();
    for entry in fs::read_dir(root).map_err(listed)? {
        let entry = entry.map_err(listed)?;
        if entry.path().is_dir() {
            names.push(entry.file_name().to_string_lossy().into_owned());
        }
    }
    names.sort();
    let mut checkpoints = Vec::new();
    let (mut stages, mut records) = (Vec::new(), BTreeMap::new());
    for name in names {
        if name.starts_with(checkpoint::FOLDER) {
            checkpoints.extend(checkpoints_in(root, &name));
        } else if !name.starts_with('.') {
            let (item, record) = stage(&root.join(&name), name.clone());
            stages.push(item);
            records.extend(record.map(|record| (name, record)));
        }
    }
    for item in &mut stages {
        lineage(root, item, &records);
    }
    let unfinished = unfinished(root);
    let is_damaged = |item: &&StoredItem| item.state == StoredState::Damaged;
    let damaged = stages.iter().chain(&checkpoints).filter(is_damaged).count();
    Ok(StoreReport { store: root.to_owned(), damaged, stages, checkpoints, unfinished })
}

/// One stage by itself; its record, where it is whole.
fn stage(folder: &Path, name: String) -> (StoredItem, Option<StageRecord>) {
    if is_vacant(folder) {
        return (StoredItem::new(name, StoredState::Expected, None), None);
    }
    let read = || read_record(folder).and_then(|record| read_stage(folder, record, true));
    // One that was replaced while it was read is read again.
    match read().or_else(|_| read()) {
        Ok(stored) => judged(name, stored),
        Err(error) => {
            let mut item = StoredItem::new(name, StoredState::Damaged, None);
            item.damaged(error);
            (item, None)
        }
    }
}

/// One stage whose files are as they were written.
fn judged(name: String, stored: StoredStage) -> (StoredItem, Option<StageRecord>) {
    let record = stored.record;
    let Some(identity) = &record.identity else {
        let mut item = StoredItem::new(name, StoredState::Earlier, None);
        item.stage = Some(record.stage.clone());
        item.grains = Some(stored.state.bodies.len());
        return (item, None);
    };
    let mut item = StoredItem::new(name, StoredState::Whole, Some(identity));
    if identity.key.get(..24) != Some(item.name.as_str()) {
        item.damaged(format!("{RECORD_FILE} holds another stage, {}", identity.key));
    } else if let Err(why) = identity.check() {
        item.damaged(why);
    } else if record.stage != identity.stage {
        item.damaged(format!("it is named {} and {}", identity.stage, record.stage));
    } else if record.end.is_none() {
        item.damaged("it does not say how it ended");
    } else if record.began_with_sha256.is_some() != identity.parent.is_some() {
        item.damaged("it does not say which specimen it began with");
    }
    let is_whole = item.state == StoredState::Whole;
    (item, is_whole.then_some(record))
}

/// Whether the stage before is there, in this store or in that of the run with whose specimen the
/// stage began, and is the one that it went on from.
fn lineage(root: &Path, item: &mut StoredItem, records: &BTreeMap<String, StageRecord>) {
    let (Some(record), Some(parent)) = (records.get(&item.name), item.parent.clone()) else {
        return;
    };
    let folder = StageStore::folder_in(root, &parent);
    let name = folder.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
    let elsewhere = match (records.get(&name), &record.begun_in) {
        (None, Some(run)) => {
            let stages = run_file(Path::new(run), "stages");
            match StageStore::stage_in(&stages, &parent, "") {
                Ok((before, ..)) => {
                    item.note = Some(format!("it began with the specimen of the run in {run}"));
                    Some(before)
                }
                Err(error) => {
                    item.note = Some(format!("the specimen that it began with: {error}"));
                    None
                }
            }
        }
        (None, None) => {
            item.note = Some("the stage before it is not there, or damaged".to_owned());
            None
        }
        (Some(_), _) => None,
    };
    let Some(before) = records.get(&name).or(elsewhere.as_ref()) else { return };
    let grains = |r: &StageRecord| r.identity.as_ref().map(|i| (i.grains, i.grains_sha256.clone()));
    if record.began_with_sha256.as_deref() != Some(&before.specimen_sha256) {
        item.damaged("it began with another specimen than the stage before has");
    } else if grains(record) != grains(before) {
        item.damaged("it has other grains than the stage before");
    }
}

fn checkpoints_in(root: &Path, folder: &str) -> Vec<StoredItem> {
    let files = checkpoint::files(&root.join(folder));
    files.iter().filter_map(|path| checkpoint_at(path, folder)).collect()
}

/// One checkpoint of a folder; none where it is gone by now: a stage under way keeps the last ones,
/// and one that has ended none.
fn checkpoint_at(path: &Path, folder: &str) -> Option<StoredItem> {
    let key = &folder[checkpoint::FOLDER.len()..];
    let file = path.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
    let name = format!("{folder}/{file}");
    let checked = checkpoint::check_checkpoint(path);
    let mut item = StoredItem::new(name, StoredState::Whole, checked.as_ref().ok());
    let is_gone = || fs::symlink_metadata(path).is_err_and(|e| e.kind() == io::ErrorKind::NotFound);
    match checked {
        Err(_) if is_gone() => return None,
        Err(error) => item.damaged(error),
        Ok(identity) if identity.key.get(..24) != Some(key) => {
            item.damaged(format!("it is of another stage, {}", identity.key));
        }
        Ok(_) => {}
    }
    Some(item)
}

/// What is half written, and whether its writer may be at it still.
fn unfinished(root: &Path) -> Vec<StoredItem> {
    let is_free = |path: &Path| {
        let lock = File::open(path);
        lock.is_ok_and(|lock| ask_alone(&lock) == AtWork::Nobody)
    };
    let state = |free| if free { StoredState::Abandoned } else { StoredState::BeingWritten };
    let parts = parts_in(root);
    let nobody_here = !parts.is_empty() && is_free(&root.join(LOCK));
    let name = |path: &PathBuf| path.file_name().map(|n| n.to_string_lossy().into_owned());
    let parts = parts.iter().filter_map(name).map(|name| (name, nobody_here));
    let files = unfinished_in(root).into_iter();
    let files = files.map(|name| (name.clone(), is_free(&root.join(name))));
    let mut items: Vec<StoredItem> =
        parts.chain(files).map(|(name, free)| StoredItem::new(name, state(free), None)).collect();
    items.sort_by(|a, b| a.name.cmp(&b.name));
    items
}

#[cfg(test)]
#[path = "store_check_tests.rs"]
mod tests;
