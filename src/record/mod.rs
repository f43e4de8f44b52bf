//! What a run leaves on disk.

mod summary;

pub use summary::*;
