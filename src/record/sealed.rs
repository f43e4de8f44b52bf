//! Results that later commands read back and put beside their own: each file says the
//! SHA-256 of its own content, so that one that was changed enters no table.

use std::fs;

use serde::de::DeserializeOwned;

use super::*;

/// The field that a file has beside those of its value: SHA-256 of the others as JSON in one line.
const HASH: &str = "content_sha256";

/// What a folder holds beside the value that was put there.
#[derive(Debug)]
pub struct Beside<T> {
    /// Values of the other files, in the order of their names.
    pub others: Vec<T>,
    /// What is said of files that are damaged, of an earlier version, or nothing of this kind.
    pub damaged: Vec<String>,
}

/// Keeps a value in a file of a folder, and gives those of all other JSON files there. What the file held
/// before is not used: if it is damaged, it is made anew by this. Others that are damaged are left
/// out.
///
/// # Errors
/// When the folder cannot be read, or the file not be written.
pub fn keep_beside<T: Serialize + DeserializeOwned>(
    folder: &Path,
    name: &str,
    value: &T,
) -> Result<Beside<T>, FileError> {
    create_folder(folder)?;
    let own = folder.join(name);
    let mut beside = Beside { others: Vec::new(), damaged: Vec::new() };
    if own.exists()
        && let Err(error) = read_sealed::<Value>(&own)
    {
        beside.damaged.push(format!("{error}; it is made anew"));
    }
    write_json(&own, &sealed(&own, value)?)?;
    let unreadable = |e: std::io::Error| FileError::new("read", folder, e);
    let mut paths = Vec::new();
    for entry in fs::read_dir(folder).map_err(unreadable)? {
        paths.push(entry.map_err(unreadable)?.path());
    }
    paths.retain(|path| *path != own && path.extension().is_some_and(|e| e == "json"));
    paths.sort();
    for path in paths {
        match read_sealed(&path) {
            Ok(other) => beside.others.push(other),
            Err(error) => beside.damaged.push(format!(
                "{error}; it is left out until the command that made it is run again"
            )),
        }
    }
    Ok(beside)
}

/// A value with the hash of its content.
fn sealed(path: &Path, value: &impl Serialize) -> Result<Value, FileError> {
    let mut value = serde_json::to_value(value).map_err(|e| FileError::new("write", path, e))?;
    let hash = hash_json(&value);
    let Some(fields) = value.as_object_mut() else {
        return Err(FileError::new("write", path, "only an object can say its hash"));
    };
    fields.insert(HASH.to_owned(), hash.into());
    Ok(value)
}

/// The value of a file, if that is as it was written.
fn read_sealed<T: DeserializeOwned>(path: &Path) -> Result<T, FileError> {
    let mut value: Value = read_json(path)?;
    let noted = value.as_object_mut().and_then(|fields| fields.shift_remove(HASH));
    if noted.as_ref().and_then(Value::as_str) != Some(hash_json(&value).as_str()) {
        return Err(FileError::changed(path));
    }
    serde_json::from_value(value).map_err(|e| FileError::malformed(path, e))
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;

    type Column = BTreeMap<String, f64>;

    fn column(value: f64) -> Column {
        BTreeMap::from([("height_mm".to_owned(), value), ("zero".to_owned(), -0.0)])
    }

    #[test]
    fn values_come_back_and_changed_ones_do_not() {
        let folder = tempfile::tempdir().expect("a folder");
        let keep = |name: &str, value: f64| {
            keep_beside(folder.path(), name, &column(value)).expect("kept")
        };
        let awkward = 0.1 + 0.2;
        let first = keep("a.json", awkward);
        assert!(first.others.is_empty() && first.damaged.is_empty(), "law: nothing beside it");
        let second = keep("b.json", 1.0);
        assert_eq!(second.others, [column(awkward)], "law: the same bits");
        assert!(second.damaged.is_empty(), "law: nothing is damaged, got {:?}", second.damaged);
        // Every byte of the file, one after the other.
        let path = folder.path().join("a.json");
        let whole = fs::read(&path).expect("a file");
        let mut counting = Vec::new();
        for at in 0..whole.len() {
            let mut changed = whole.clone();
            changed[at] ^= 1;
            fs::write(&path, &changed).expect("changed");
            let found = keep("b.json", 1.0);
            if found.others.is_empty() {
                let told = &found.damaged[0];
                assert!(told.contains("a.json") && told.contains("left out"), "law: got {told}");
                counting.push(at);
            } else {
                // A blank, or a digit beyond the last that counts.
                assert_eq!(
                    found.others,
                    [column(awkward)],
                    "law: what is used is what was written"
                );
            }
        }
        assert!(counting.len() > whole.len() / 2, "law: most bytes count, got {counting:?}");
        let anew = keep("a.json", awkward);
        assert!(anew.damaged[0].contains("made anew"), "law: it is said, got {:?}", anew.damaged);
        assert!(keep("b.json", 1.0).damaged.is_empty(), "law: it is made anew");
    }

    #[test]
    fn files_of_earlier_versions_and_other_files_are_left_out() {
        let folder = tempfile::tempdir().expect("a folder");
        fs::write(folder.path().join("old.json"), "{\"height_mm\": 1.0}").expect("written");
        fs::write(folder.path().join("list.json"), "[1]").expect("written");
        fs::write(folder.path().join("notes.txt"), "x").expect("written");
        let found = keep_beside(folder.path(), "a.json", &column(1.0)).expect("kept");
        assert!(found.others.is_empty(), "law: what does not say its hash is not used");
        assert_eq!(found.damaged.len(), 2, "law: each is said, got {:?}", found.damaged);
    }
}
