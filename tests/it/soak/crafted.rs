//! Stores with stages that are crafted, with every hash as it should be, or in each other's
//! place: reported, made anew, and the same at the end.

use std::{
    fs,
    path::{Path, PathBuf},
    sync::OnceLock,
};

use pluvia::geometry::Pose;
use pluvia::record::{
    StageRecord, StoredStage, hash_bytes, hash_json, read_file, read_json, series_from_csv, to_csv,
    write_file, write_json,
};
use pluvia::specimen::{Base, Fate, FixedGrain};
use rand::RngExt;
use tempfile::TempDir;

use super::{
    super::interruption::{
        copy, pluvia, stored as all_stored, stored_as, write_scenario_in_segments,
    },
    Ground,
    trials::{PATIENCE, Trial, ended, said, segments, spawned, sweep},
};

#[path = "../../../src/study/crafts_tests.rs"]
mod crafts;

const CLASS: &str = "crafted stores";
const OUTCOME: &str = "reported, made anew, the same bytes";

/// A stage as it is stored.
fn stored(folder: &Path) -> StoredStage {
    let series = read_file(&folder.join("series.csv")).expect("a series");
    StoredStage {
        record: read_json(&folder.join("stage.json")).expect("a record"),
        state: read_json(&folder.join("specimen.json")).expect("a specimen"),
        series: series_from_csv(&series).expect("rows"),
    }
}

/// The same run with another friction.
fn slippery() -> &'static Path {
    static MADE: OnceLock<(TempDir, PathBuf)> = OnceLock::new();
    let (_, out) = MADE.get_or_init(|| {
        let folder = tempfile::tempdir().expect("a folder");
        let path = write_scenario_in_segments(folder.path());
        let out = folder.path().join("out");
        let slippery = ["--set", "contact.grain_grain_friction=0.2"];
        let done = pluvia(&path, &out).args(slippery).status().expect("started");
        assert!(done.success(), "law: it can be run");
        (folder, out)
    });
    out
}

/// Runs once more what was crafted.
fn made_anew(trial: &Trial, out: &Path, crafted: usize, what: &str) {
    let output = ended(spawned(trial.command(out)), PATIENCE, what);
    let said = said(&output);
    assert!(output.status.success(), "law: {what} does not end a run: {said}");
    let reported = said.matches("damaged and done again").count();
    assert_eq!(reported, crafted, "law: {what} is reported once for each, got {said}");
    trial.assert_same(out, what);
}

/// Something that is not that pour in the place of a pour.
fn crafted_pour(trial: &Trial, which: Option<usize>, ground: &mut Ground) {
    let out = ground.place();
    copy(&trial.whole, &out);
    let place = stored_as(&out, "pour");
    let mut all = crafts::crafts(&stored(&place), &stored(&stored_as(&out, "fill_funnel")));
    if which.is_none() {
        all.push(("another friction's pour", stored(&stored_as(slippery(), "pour"))));
    }
    let which = which.unwrap_or_else(|| ground.rng.random_range(0..all.len()));
    let (what, stage) = &all[which];
    crafts::craft(&place, stage);
    made_anew(trial, &out, 1, what);
    ground.log.case(CLASS, what, OUTCOME);
}

/// Moves two stages to each other's place, or a copy of one to that of the other.
fn swapped(trial: &Trial, ground: &mut Ground) {
    let out = ground.place();
    copy(&trial.whole, &out);
    let mut stages = all_stored(&out);
    let a = stages.swap_remove(ground.rng.random_range(0..stages.len()));
    let b = stages.swap_remove(ground.rng.random_range(0..stages.len()));
    let aside = out.join("aside");
    let both: bool = ground.rng.random();
    if both {
        for (from, to) in [(&a, &aside), (&b, &a), (&aside, &b)] {
            fs::rename(from, to).expect("moved");
        }
    } else {
        fs::remove_dir_all(&b).expect("removed");
        copy(&a, &b);
    }
    let what = if both { "two stages swapped" } else { "a stage in another's place" };
    made_anew(trial, &out, if both { 2 } else { 1 }, what);
    ground.log.case(CLASS, what, OUTCOME);
}

/// `make soak`: one of either.
pub fn round(ground: &mut Ground) {
    crafted_pour(segments(), None, ground);
    let trial = if ground.rng.random() { segments() } else { sweep() };
    swapped(trial, ground);
}

#[test]
fn crafted_and_swapped_stages_of_a_store_are_made_anew() {
    let mut ground = Ground::quick(2);
    crafted_pour(sweep(), Some(3), &mut ground);
    swapped(sweep(), &mut ground);
    assert_eq!(ground.log.sum(CLASS, OUTCOME), 2, "law: each is noted");
}
