//! Folders that last: made, and the names in them brought to the disk; and those that are of
//! another kind than is read.

use super::*;
use crate::input::Refusal;

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
            Err(_) if folder.is_symlink() => {
                let why = format!("the link {} leads nowhere", folder.display());
                return Err(FileError::new("create the folder", path, why));
            }
            made => made.map_err(refused)?,
        }
        sync_folder(above(folder)).map_err(refused)?;
    }
    // Of one that is there already, or something else that is in the way.
    fs::create_dir_all(path).map_err(refused)
}

/// Refuses what is there and is no folder. What is not there is none of this: whoever reads it says
/// so.
///
/// # Errors
/// [`FileError`], refused, with what it is.
pub fn refuse_no_folder(path: &Path) -> Result<(), FileError> {
    match input::is_folder(path) {
        Err(error) if Refusal::within(&error).is_some() => Err(FileError::unread(path, &error)),
        _ => Ok(()),
    }
}

/// Refuses a folder that lacks the file by which its kind is known, and what is no folder; `what`
/// says what it is instead. What is not there, or may not be looked into, whoever reads it says.
///
/// # Errors
/// [`FileError`], refused.
pub fn refuse_without(folder: &Path, file: &str, what: &str) -> Result<(), FileError> {
    refuse_no_folder(folder)?;
    let lacks = folder.is_dir() && folder.join(file).try_exists().is_ok_and(|is_there| !is_there);
    if lacks {
        return Err(FileError { refused: true, ..FileError::new("read", folder, what) });
    }
    Ok(())
}

/// The folder that holds a name.
pub(super) fn above(path: &Path) -> &Path {
    path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."))
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
