//! The folder for results, tried before anything runs.

use std::path::Path;

use crate::record::{FileError, begin_file, create_folder, remove_abandoned};

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
    Ok(())
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
