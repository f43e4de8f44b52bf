//! Why a file or folder could not be read or written.

use std::fmt::Display;

use super::*;
use crate::input::Refusal;
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
