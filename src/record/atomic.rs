//! Writing files so that a reader never sees half of one.

use std::fmt::Display;
use std::io::Write;

use serde::de::DeserializeOwned;

use super::*;
use crate::input::{self, Refusal};
use crate::plain::{plain, plain_path};

/// A file or folder that could not be read or written.
#[derive(Debug, thiserror::Error)]
#[error("cannot {action} {}: {}", plain_path(path), plain(reason))]
pub struct FileError {
    /// `read`, `write`, `create`, ...
    pub action: &'static str,
    /// The file or folder.
    pub path: PathBuf,
    /// What the system or the parser said.
    pub reason: String,
    /// Whether the file is refused because of what it is or holds; else the system does not let it
    /// be read or written.
    pub refused: bool,
}

impl FileError {
    /// An error of the operating system about a path.
    pub fn new(action: &'static str, path: &Path, reason: impl ToString) -> Self {
        Self { action, path: path.to_owned(), reason: reason.to_string(), refused: false }
    }

    /// A file that holds what cannot be used.
    pub fn unfit(path: &Path, reason: impl ToString) -> Self {
        Self { refused: true, ..Self::new("use", path, reason) }
    }

    /// A file that was not read.
    pub fn unread(path: &Path, error: &io::Error) -> Self {
        let refused = Refusal::within(error).is_some();
        Self { refused, ..Self::new("read", path, error) }
    }

    /// A file whose content is not what is read there, as its parser says.
    pub fn malformed(path: &Path, why: impl Display) -> Self {
        let reason = format!("{why}; only a file as Pluvia writes it is read");
        Self { refused: true, ..Self::new("read", path, reason) }
    }

    /// A file that has another content than it was given.
    pub(super) fn changed(path: &Path) -> Self {
        Self::unfit(path, "its content is not what was written, and nothing else is used")
    }
}

/// Creates a folder and those above it, and has their names brought to the disk.
///
/// # Errors
/// [`FileError`] naming the folder.
pub fn create_folder(path: &Path) -> Result<(), FileError> {
    let refused = |e: io::Error| FileError::new("create the folder", path, e);
    let missing = path.ancestors().take_while(|p| !p.as_os_str().is_empty() && !p.exists());
    let mut missing: Vec<&Path> = missing.collect();
    // The name of a new folder is in the one above it, which goes to the disk before anything is
    // put into the new one.
    while let Some(folder) = missing.pop() {
        match fs::create_dir(folder) {
            Err(e) if e.kind() == io::ErrorKind::AlreadyExists && folder.is_dir() => {}
            made => made.map_err(refused)?,
        }
        sync_folder(above(folder)).map_err(refused)?;
    }
    // Of one that is there already, or something else that is in the way.
    fs::create_dir_all(path).map_err(refused)
}

/// The folder that holds a name.
pub(super) fn above(path: &Path) -> &Path {
    path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Writes a file whole or not at all: into a temporary file beside it, to the
/// disk, then renamed into place.
///
/// # Errors
/// [`FileError`] naming the file; what stood there before is untouched.
pub fn write_file(path: &Path, content: &[u8]) -> Result<(), FileError> {
    let fail = |e: io::Error| FileError::new("write", path, e);
    let folder = above(path);
    let mut temporary = begin_file(folder).map_err(fail)?;
    temporary.write_all(content).map_err(fail)?;
    temporary.as_file().sync_all().map_err(fail)?;
    make_readable(temporary.as_file()).map_err(fail)?;
    temporary.persist(path).map_err(|e| fail(e.error))?;
    sync_folder(folder).map_err(fail)
}

/// Has the names in a folder written to the disk: without that, a file renamed
/// into it may be gone after the power fails, whole as it is.
pub(super) fn sync_folder(folder: &Path) -> io::Result<()> {
    if !cfg!(unix) {
        return Ok(());
    }
    match File::open(folder).and_then(|folder| folder.sync_all()) {
        // Some file systems have no such call for folders.
        Err(e) if matches!(e.kind(), io::ErrorKind::InvalidInput | io::ErrorKind::Unsupported) => {
            Ok(())
        }
        // One that may be written into but not read cannot be opened.
        Err(e) if e.kind() == io::ErrorKind::PermissionDenied => Ok(()),
        done => done,
    }
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
            assert!(error.to_string().contains("no/such/file.json"), "{error}");
        }
    }
}
