//! What a run leaves on disk.

mod at_work;
mod atomic;
#[cfg(test)]
pub(crate) mod canned;
mod checkpoint;
mod checks;
mod contacts;
mod energy;
mod file_error;
mod findings;
mod folders;
mod frames;
mod grain_table;
mod hash;
mod identity;
mod laboratory;
mod left_out;
mod lock;
mod profile;
mod run;
mod sealed;
mod series;
mod sieve;
mod sinking;
mod stage;
mod store;
mod store_check;
mod summary;
mod tables;
mod unfinished;
mod variations;

pub use at_work::{RunLock, at_work_in};
pub use atomic::{
    json_text, read_file, read_json, read_unchanged, write_csv, write_file, write_json,
};
pub use checkpoint::{Checkpoints, Observed, Reference, Resumed};
pub use checks::{CheckSummary, Checks, OverlapWatch, StageChecks};
pub use contacts::*;
pub use energy::*;
pub use file_error::FileError;
pub use folders::{create_folder, refuse_no_folder, refuse_without};
pub use frames::{FRAMES_FILE, Frame, FrameWriter, FramesRead};
pub use grain_table::grains_csv;
pub use hash::{hash_bytes, hash_json};
pub use identity::{StageEnd, StageIdentity};
pub use laboratory::*;
pub use left_out::{MOST_MISSING, NO_VALID_RUN, left_out_in_words, left_out_with_reasons};
pub use lock::AtWork;
pub use profile::{DistributionRow, ProfileRow, distributions};
pub use run::{RunKind, RunRecord, run_file};
pub use sealed::{Beside, keep_beside};
pub use series::{SeriesRow, series_csv, series_from_csv};
pub use sieve::*;
pub use sinking::{Sinking, Sunk, mean_drop_mm};
pub use stage::{AskedStage, StageRecord, StoredStage};
pub use store::StageStore;
pub use store_check::{StoreReport, StoredItem, StoredState, check_store};
pub use summary::*;
pub use tables::{csv_of, to_csv};
pub use unfinished::{begin_file, remove_abandoned};
pub use variations::{RunRow, VariationRow, variations_csv};

// What its parts are made of, too.
use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::grains::{GrainShape, ShapeRatio, Sieved};
use crate::input;
use crate::plain::{counted, in_number, json_path};
use crate::protocol::{Fall, Settling, UntilFound};
use crate::specimen::{Fate, SpecimenState};
use crate::units::{from_mm, to_mm};
use {
    atomic::*, folders::*, frames::*, hash::*, identity::*, lock::*, stage::*, store::*, tables::*,
    unfinished::*,
};
