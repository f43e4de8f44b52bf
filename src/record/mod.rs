//! What a run leaves on disk.

mod atomic;
mod checkpoint;
mod frames;
mod guards;
mod hash;
mod run;
mod sieve;
mod store;
mod summary;
mod tables;
mod variations;

pub use atomic::{
    FileError, create_folder, json_text, read_file, read_json, read_unchanged, write_file,
    write_json,
};
pub use checkpoint::{Checkpoints, Observed, Reference, Resumed};
pub use frames::{FRAMES_FILE, Frame, FrameWriter};
pub use guards::{GuardSummary, Guards, OverlapWatch, StageGuards};
pub use hash::{hash_bytes, hash_json};
pub use run::{RunKind, RunRecord};
pub use sieve::{
    GradationSummary, NotSieved, SecondarySieve, ShapeSummary, SieveSummary, SievedFraction,
    Spread, UNCHANGED,
};
pub use store::{StageRecord, StageStore, StoredStage};
pub use summary::*;
pub use tables::{grains_csv, series_from_csv, to_csv};
pub use variations::{RunRow, VariationRow, variation_runs_csv, variations_csv};
