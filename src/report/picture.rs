//! Pictures on the page: pixels that something else has made.

use std::path::Path;

use base64::{Engine, prelude::BASE64_STANDARD};

use crate::record::{FileError, create_folder, write_file};

/// A picture with its words.
#[derive(Debug, Clone, PartialEq)]
pub struct Picture {
    /// Name of its file, without extension.
    pub stem: String,
    /// Title.
    pub title: String,
    /// What is shown, what the colours tell, and how it was made.
    pub caption: String,
    /// The picture as PNG.
    pub png: Vec<u8>,
}

impl Picture {
    /// Writes `STEM.png` into a folder, which is made where it is missing.
    ///
    /// # Errors
    /// [`FileError`] naming the file.
    pub fn write(&self, folder: &Path) -> Result<(), FileError> {
        create_folder(folder)?;
        write_file(&folder.join(format!("{}.png", self.stem)), &self.png)
    }

    /// As a page holds it within itself.
    pub(super) fn as_data(&self) -> String {
        format!("data:image/png;base64,{}", BASE64_STANDARD.encode(&self.png))
    }
}
