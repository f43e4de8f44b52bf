//! Writing files so that a reader never sees half of one.

use std::io::Write;

use serde::de::DeserializeOwned;

use super::*;

/// Writes a file whole or not at all: into a temporary file beside it, to the
/// disk, then renamed into place.
///
/// # Errors
/// [`FileError`] naming the file; what stood there before is untouched.
pub fn write_file(path: &Path, content: &[u8]) -> Result<(), FileError> {
    let fail = |e: io::Error| FileError::new("write", path, e);
    let folder = above(path);
    let mut temporary = begin_file(folder).map_err(fail)?;
    // Its own `write_all` would name it.
    temporary.as_file_mut().write_all(content).map_err(fail)?;
    temporary.as_file().sync_all().map_err(fail)?;
    make_readable(temporary.as_file()).map_err(fail)?;
    temporary.persist(path).map_err(|e| fail(e.error))?;
    sync_folder(folder).map_err(fail)
}

/// Exchanges two files or folders at once, so that there is always one of each name; whether the
/// system and the file system can.
pub(super) fn exchange(one: &Path, other: &Path) -> bool {
    #[cfg(target_os = "linux")]
    {
        use rustix::fs::{CWD, RenameFlags, renameat_with};
        renameat_with(CWD, one, CWD, other, RenameFlags::EXCHANGE).is_ok()
    }
    #[cfg(not(target_os = "linux"))]
    {
        let _ = (one, other);
        false
    }
}

/// Temporary files are private to their owner; results are not.
pub(super) fn make_readable(file: &File) -> io::Result<()> {
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        file.set_permissions(fs::Permissions::from_mode(0o644))?;
    }
    Ok(())
}

/// Writes a value as indented JSON with a final newline.
///
/// # Errors
/// [`FileError`] naming the file.
pub fn write_json(path: &Path, value: &impl Serialize) -> Result<(), FileError> {
    write_file(path, &json_text(path, value)?)
}

/// The bytes that [`write_json`] writes.
///
/// # Errors
/// [`FileError`] naming the file, when the value has no JSON form.
pub fn json_text(path: &Path, value: &impl Serialize) -> Result<Vec<u8>, FileError> {
    let mut text =
        serde_json::to_vec_pretty(value).map_err(|e| FileError::new("write", path, e))?;
    text.push(b'\n');
    Ok(text)
}

/// Writes a table that was made, whole or not at all.
///
/// # Errors
/// When it could not be made, or the file not be written.
pub fn write_csv(path: &Path, table: Result<Vec<u8>, impl ToString>) -> Result<(), FileError> {
    write_file(path, &table.map_err(|e| FileError::new("write", path, e))?)
}

/// Reads a file.
///
/// # Errors
/// [`FileError`] naming the file.
pub fn read_file(path: &Path) -> Result<Vec<u8>, FileError> {
    input::read(path, input::LARGEST_OF_RUN).map_err(|e| FileError::unread(path, &e))
}

/// Reads a value from a JSON file.
///
/// # Errors
/// [`FileError`] naming the file and the place in it.
pub fn read_json<T: DeserializeOwned>(path: &Path) -> Result<T, FileError> {
    serde_json::from_slice(&read_file(path)?).map_err(|e| FileError::malformed(path, e))
}

/// Reads a file whose SHA-256 was noted when it was written; an empty one was
/// not noted, and nothing is compared.
///
/// # Errors
/// [`FileError`] naming the file, also when it is not what was written.
pub fn read_unchanged(path: &Path, sha256: &str) -> Result<Vec<u8>, FileError> {
    let content = read_file(path)?;
    if !sha256.is_empty() && hash_bytes(&content) != sha256 {
        return Err(FileError::changed(path));
    }
    Ok(content)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn replaces_a_file_whole_and_leaves_no_other() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.json");
        write_json(&path, &[1, 2]).expect("first");
        write_json(&path, &[3]).expect("second");
        assert_eq!(read_json::<Vec<i32>>(&path).expect("read back"), [3]);
        assert_eq!(fs::read_dir(folder.path()).expect("listing").count(), 1);
    }

    #[test]
    fn what_is_read_is_what_was_written() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a");
        write_file(&path, b"written").expect("written");
        let noted = hash_bytes(b"written");
        assert_eq!(read_unchanged(&path, &noted).expect("unchanged"), b"written");
        fs::write(&path, b"Written").expect("changed");
        let said = read_unchanged(&path, &noted).expect_err("changed").to_string();
        assert!(said.contains("is not what was written") && said.contains("/a:"), "{said}");
        assert!(read_unchanged(&path, "").is_ok(), "law: what was not noted is not compared");
    }

    #[test]
    fn names_the_file_it_cannot_write_or_read() {
        let folder = tempfile::tempdir().expect("a folder");
        let missing = folder.path().join("no/such/file.json");
        for error in [
            write_file(&missing, b"x").expect_err("no folder"),
            read_json::<i32>(&missing).expect_err("no file"),
        ] {
            let said = error.to_string();
            assert!(said.contains("no/such/file.json"), "{said}");
            assert!(!said.contains(".part"), "law: and no other, got {said}");
        }
    }
}
