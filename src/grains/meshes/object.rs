//! What a mesh file holds, and why it holds none, whatever its format.

use super::*;

/// One object of a file, as the file gives it: in the file's unit of length.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Object {
    /// Its name in the file, or its number.
    pub name: String,
    /// Vertices; a file may give the same place several times.
    pub vertices: Vec<Point>,
    /// Faces as loops of vertex numbers, all of which exist.
    pub faces: Vec<Vec<u32>>,
}

/// Why a file gives no objects.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum ReadError {
    /// The system does not let it be read.
    Unreadable(String),
    /// Its content is wrong; the fault lacks the file.
    Fault(Fault),
}

impl ReadError {
    /// A fault of the content of a file.
    pub fn fault(message: impl Into<String>, found: impl ToString, allowed: &str) -> Self {
        Self::Fault(Fault::new(message, found, allowed))
    }
}

/// The bytes of a text without the mark of UTF-8 (`EF BB BF`) that some programs put before it.
pub(super) fn without_mark(bytes: &[u8]) -> &[u8] {
    bytes.strip_prefix("\u{feff}".as_bytes()).unwrap_or(bytes)
}
