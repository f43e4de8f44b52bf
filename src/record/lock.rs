//! Locks of files: how programs that write into one folder keep out of each
//! other's way. They end with the program that holds them, however it ends.

use std::fs::TryLockError;

use super::*;

/// Who else is at work with a file or in a folder.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AtWork {
    /// Nobody else is.
    Nobody,
    /// Somebody else is.
    Somebody,
    /// The file system has no locks.
    Unknown,
}

/// Asks, without waiting, to hold a file alone. With [`AtWork::Nobody`] it is held from now on.
pub(super) fn ask_alone(file: &File) -> AtWork {
    match file.try_lock() {
        Ok(()) => AtWork::Nobody,
        Err(TryLockError::WouldBlock) => AtWork::Somebody,
        Err(TryLockError::Error(_)) => AtWork::Unknown,
    }
}

/// Waits until nobody holds a file, then holds it alone; not where the file system has no locks.
pub(super) fn wait_alone(file: &File) {
    undisturbed(|| file.lock());
}

/// Waits until nobody holds a file alone, then holds it together with others;
/// not where the file system has no locks.
pub(super) fn wait_shared(file: &File) {
    undisturbed(|| file.lock_shared());
}

/// A signal ends the wait of a lock early.
fn undisturbed(lock: impl Fn() -> io::Result<()>) {
    while lock().is_err_and(|e| e.kind() == io::ErrorKind::Interrupted) {}
}

/// Whether an open file still has a name: one that was removed may be held, but
/// nobody else will ever ask for it.
pub(super) fn has_name(file: &File) -> bool {
    #[cfg(unix)]
    {
        use std::os::unix::fs::MetadataExt;
        file.metadata().is_ok_and(|m| m.nlink() > 0)
    }
    #[cfg(not(unix))]
    {
        file.metadata().is_ok()
    }
}
