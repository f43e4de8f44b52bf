//! The folder for results, tried before anything runs.

use std::cell::RefCell;
use std::fs::File;

use super::*;
use crate::record::{begin_file, create_folder};

thread_local! {
    /// Folders in which the command of this thread has begun. They are held open, so that no other
    /// folder can have the number of one that was removed.
    static BEGUN: RefCell<Vec<(PathBuf, File)>> = const { RefCell::new(Vec::new()) };
}

/// Makes the folder and those above it, tries whether a file can be written
/// into it, and removes what writers that were killed left there.
///
/// # Errors
/// [`FileError`] naming the folder.
pub(super) fn prepare(folder: &Path) -> Result<(), FileError> {
    create_folder(folder)?;
    begin_file(folder)
        .and_then(tempfile::NamedTempFile::close)
        .map_err(|error| FileError::new("write into the folder", folder, error))?;
    remove_abandoned(folder);
    if let Ok(open) = File::open(folder) {
        BEGUN.with_borrow_mut(|begun| begun.push((folder.to_owned(), open)));
    }
    Ok(())
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

    #[test]
    fn a_file_in_the_way_is_told() {
        let base = tempfile::tempdir().expect("a temporary folder");
        let file = base.path().join("file");
        fs::write(&file, "").expect("a file");
        for folder in [file.clone(), file.join("below")] {
            let error = prepare(&folder).expect_err("a file is in the way").to_string();
            assert!(error.contains(&folder.display().to_string()), "{error}");
        }
    }
}
