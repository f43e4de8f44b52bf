//! Locks of files: how programs that write into one folder keep out of each
//! other's way. They end with the program that holds them, however it ends.

use std::fs::TryLockError;

use super::*;

/// What came of asking for a lock without waiting.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Asked {
    /// It is held from now on.
    Given,
    /// Somebody else holds it.
    Busy,
    /// The file system has no locks.
    Unknown,
}

/// Asks to hold a file alone.
pub(super) fn ask_alone(file: &File) -> Asked {
    match file.try_lock() {
        Ok(()) => Asked::Given,
        Err(TryLockError::WouldBlock) => Asked::Busy,
        Err(TryLockError::Error(_)) => Asked::Unknown,
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
