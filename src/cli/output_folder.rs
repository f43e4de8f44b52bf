//! The folder for results, tried before anything runs.

use std::cell::RefCell;
use std::fs::File;

use super::*;
use crate::record::{begin_file, create_folder};

thread_local! {
    /// Folders in which the command of this thread has begun. They are held open, so that no other
    /// folder can have the number of one that was removed.
    static BEGUN: RefCell<Vec<(PathBuf, File)>> = const { RefCell::new(Vec::new()) };
    /// Folders that the command of this thread has made.
    static MADE: Made = Made::default();
}

/// Folders that a command has made, in the order of their making.
#[derive(Debug, Clone, Default)]
pub(super) struct Made(Arc<Mutex<Vec<Vec<PathBuf>>>>);

impl Made {
    /// Removes those that are empty: of a command that ends without what it was asked for.
    pub(super) fn remove_empty(&self) {
        lock(&self.0).drain(..).rev().for_each(|folders| remove_empty(&folders));
    }
}

/// What the command of this thread has made and will make.
pub(super) fn made() -> Made {
    MADE.with(Clone::clone)
}

/// Makes the folder and those above it, tries whether a file can be written
/// into it, and removes what writers that were killed left there.
///
/// # Errors
/// [`FileError`] naming the folder.
pub(super) fn prepare(folder: &Path) -> Result<(), FileError> {
    if let Some(store) = store_around(folder) {
        let why = format!(
            "{} is the store of another command, which holds stages alone; name another folder",
            plain_path(&store)
        );
        return Err(error::refused("write into the folder", folder, why));
    }
    if let Some(there) = folder.ancestors().find(|path| path.exists()).filter(|p| !p.is_dir()) {
        let what = if there == folder { "it".to_owned() } else { plain_path(there) };
        return Err(FileError::new("create the folder", folder, format!("{what} is a file")));
    }
    let new = missing(folder);
    create_folder(folder)?;
    MADE.with(|made| lock(&made.0).push(new));
    begin_file(folder)
        .and_then(tempfile::NamedTempFile::close)
        .map_err(|error| FileError::new("write into the folder", folder, error))?;
    remove_abandoned(folder);
    if let Ok(open) = File::open(folder) {
        BEGUN.with_borrow_mut(|begun| begun.push((folder.to_owned(), open)));
    }
    Ok(())
}

/// The store of stages that a folder is or is in, there or not yet.
fn store_around(folder: &Path) -> Option<PathBuf> {
    let folder = folder.canonicalize().or_else(|_| std::path::absolute(folder)).ok()?;
    let is_store = |path: &&Path| path.ends_with("stages") && path.join(".lock").is_file();
    folder.ancestors().find(is_store).map(Path::to_owned)
}

/// The folders that [`prepare`] would make, from the folder itself upwards.
fn missing(folder: &Path) -> Vec<PathBuf> {
    let above = folder.ancestors().take_while(|path| !path.as_os_str().is_empty());
    above.take_while(|path| !path.exists()).map(Path::to_owned).collect()
}

/// Removes folders, each only while it is empty, up to the first that is not.
fn remove_empty(folders: &[PathBuf]) {
    let _ = folders.iter().try_for_each(std::fs::remove_dir);
}

/// Writes files of one command into its folder. Where a file of one of these names lies there with
/// another content, none is written, unless `force` says that it is replaced.
///
/// # Errors
/// [`FileError`], refused, naming the first such file; the system's where one cannot be written.
pub(super) fn write_files(
    folder: &Path,
    files: &[(&'static str, Vec<u8>)],
    force: bool,
) -> Result<Vec<PathBuf>, FileError> {
    let paths: Vec<PathBuf> = files.iter().map(|(name, _)| folder.join(name)).collect();
    let differs = |path: &Path, content: &[u8]| {
        let same_length = path.metadata().is_ok_and(|m| m.len() == content.len() as u64);
        path.exists() && !(same_length && read_file(path).is_ok_and(|there| there == content))
    };
    let mut all = paths.iter().zip(files);
    if let Some((path, _)) = all.find(|(path, (_, content))| !force && differs(path, content)) {
        return Err(refused(path, "another file of this name exists"));
    }
    for (path, (_, content)) in paths.iter().zip(files) {
        write_file(path, content)?;
    }
    Ok(paths)
}

/// Refuses a folder in which one of the files is there already.
///
/// # Errors
/// [`FileError`], refused, naming it.
pub(super) fn refuse_any(folder: &Path, names: &[&str]) -> Result<(), FileError> {
    match names.iter().map(|name| folder.join(name)).find(|path| path.exists()) {
        Some(path) => Err(refused(&path, "it exists already")),
        None => Ok(()),
    }
}

fn refused(path: &Path, why: &str) -> FileError {
    let reason = format!("{why}; name another folder, or give --force to replace it");
    error::refused("write", path, reason)
}

/// Whether each folder is still where its command began: files that were written after it got
/// another name are in a folder made anew, without those before.
///
/// # Errors
/// [`FileError`] naming the first folder that is not.
pub(super) fn still_there() -> Result<(), FileError> {
    let moved = BEGUN.with_borrow(|begun| {
        let moved = begun.iter().find(|(path, open)| !is_same(path, open));
        moved.map(|(path, _)| path.clone())
    });
    match moved {
        None => Ok(()),
        Some(path) => {
            let why = "it was renamed or removed while results were written, so that they are \
                       split between two folders; run the same command again";
            Err(FileError::new("use", &path, why))
        }
    }
}

/// Whether a path leads to an open folder.
#[cfg(unix)]
fn is_same(path: &Path, open: &File) -> bool {
    use std::os::unix::fs::MetadataExt;
    let id = |m: std::io::Result<std::fs::Metadata>| m.map(|m| (m.dev(), m.ino())).ok();
    id(std::fs::metadata(path)) == id(open.metadata())
}

#[cfg(not(unix))]
fn is_same(path: &Path, _: &File) -> bool {
    path.is_dir()
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    #[test]
    fn a_folder_is_made_and_left_empty() {
        let base = tempfile::tempdir().expect("a temporary folder");
        let folder = base.path().join("a/b");
        prepare(&folder).expect("it can be made");
        assert_eq!(fs::read_dir(&folder).expect("it is there").count(), 0, "the probe is gone");
    }

    /// Law: all folders that were made are removed, none that was there, and none that holds something.
    #[test]
    fn folders_that_were_made_are_removed() {
        let base = tempfile::tempdir().expect("a temporary folder");
        let folder = base.path().join("a/b/c");
        prepare(&folder).expect("it can be made");
        made().remove_empty();
        assert!(!base.path().join("a").exists(), "law: all of them are gone");
        assert!(base.path().exists(), "law: what was there stays");
        prepare(&folder).expect("it can be made");
        prepare(&folder.join("within")).expect("it can be made");
        fs::write(base.path().join("a/own"), "").expect("a file");
        made().remove_empty();
        assert!(!base.path().join("a/b").exists(), "law: what is empty is gone");
        assert!(base.path().join("a/own").exists(), "law: what holds something stays");
    }

    /// Law: the same files again change nothing, another content is written by force alone, and
    /// where one of several is refused the others are as they were.
    #[test]
    fn files_with_another_content_are_kept() {
        let base = tempfile::tempdir().expect("a temporary folder");
        let folder = base.path();
        let files = |a: &str, b: &str| [("a", a.into()), ("b", b.into())];
        let there = |name| fs::read_to_string(folder.join(name)).expect("it is there");
        write_files(folder, &files("1", "2"), false).expect("law: nothing is there");
        write_files(folder, &files("1", "2"), false).expect("law: the same is there");
        for (a, b) in [("3", "2"), ("1", "3"), ("1", "22")] {
            let error =
                write_files(folder, &files(a, b), false).expect_err("law: another is there");
            assert!(error.refused && error.to_string().contains("--force"), "{error}");
            assert_eq!((there("a"), there("b")), ("1".into(), "2".into()), "law: all are kept");
        }
        write_files(folder, &files("3", "4"), true).expect("law: by force");
        assert_eq!((there("a"), there("b")), ("3".into(), "4".into()), "law: replaced");
        assert!(refuse_any(folder, &["c", "b"]).is_err() && refuse_any(folder, &["c"]).is_ok());
    }

    /// Law: results in two folders are not said to be in one.
    #[test]
    fn a_folder_that_another_took_the_place_of_is_noticed() {
        let base = tempfile::tempdir().expect("a temporary folder");
        let folder = base.path().join("out");
        fs::create_dir(&folder).expect("a folder");
        let open = File::open(&folder).expect("it is there");
        assert!(is_same(&folder, &open), "law: it is where it was");
        fs::rename(&folder, base.path().join("away")).expect("renamed");
        assert!(!is_same(&folder, &open), "law: nothing is there");
        fs::create_dir(&folder).expect("another");
        assert!(!is_same(&folder, &open), "law: another is there");
    }

    /// Law: nothing but stages goes into a store, whose check would take it for a damaged stage.
    #[test]
    fn a_store_takes_no_results() {
        let base = tempfile::tempdir().expect("a temporary folder");
        let store = base.path().join("stages");
        fs::create_dir(&store).expect("a folder");
        fs::write(store.join(".lock"), "").expect("a file");
        for folder in [store.clone(), store.join("a/b")] {
            let error = prepare(&folder).expect_err("law: it is refused");
            assert!(error.refused && error.to_string().contains("store"), "law: why, got {error}");
            assert!(!store.join("a").exists(), "law: nothing is made");
        }
        fs::remove_file(store.join(".lock")).expect("removed");
        prepare(&store.join("a/b")).expect("law: other folders may have this name");
    }

    #[test]
    fn a_file_in_the_way_is_told() {
        let base = tempfile::tempdir().expect("a temporary folder");
        let file = base.path().join("file");
        fs::write(&file, "").expect("a file");
        for folder in [file.clone(), file.join("below")] {
            let error = prepare(&folder).expect_err("a file is in the way").to_string();
            assert!(error.contains(&folder.display().to_string()), "{error}");
            assert!(error.ends_with("is a file"), "law: it says what is in the way, got {error}");
        }
        #[cfg(unix)]
        {
            let link = base.path().join("link");
            std::os::unix::fs::symlink("nowhere", &link).expect("a link");
            for folder in [link.clone(), link.join("below")] {
                let error = prepare(&folder).expect_err("a link is in the way").to_string();
                let said = format!("the link {} leads nowhere", link.display());
                assert!(error.ends_with(&said), "law: it says what is in the way, got {error}");
            }
        }
    }
}
