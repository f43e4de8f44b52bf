//! Stored stages that were crafted, with every hash as it should be, for tests: those of this
//! crate and, from outside, those of `tests/it/soak/`. Whoever includes this file brings the
//! names that it takes from above.

use std::path::Path;

use super::{
    Base, Fate, FixedGrain, Pose, StageRecord, StoredStage, hash_bytes, hash_json, read_json,
    to_csv, write_file, write_json,
};

/// Puts a state and a series in the place of those of a stage, with their hashes.
pub(super) fn craft(folder: &Path, stage: &StoredStage) {
    let state = serde_json::to_vec(&stage.state).expect("JSON");
    let series = to_csv(&stage.series).expect("CSV");
    write_file(&folder.join("specimen.json"), &state).expect("written");
    write_file(&folder.join("series.csv"), &series).expect("written");
    let path = folder.join("stage.json");
    let mut record: StageRecord = read_json(&path).expect("a record");
    record.simulated_s = stage.record.simulated_s;
    record.specimen_sha256 = hash_bytes(&state);
    record.series_sha256 = hash_bytes(&series);
    record.record_sha256 = String::new();
    record.record_sha256 = hash_json(&record);
    write_json(&path, &record).expect("written");
}

/// What can be made of a poured specimen, given the stage that was before it, so that it is
/// not that specimen any more.
pub(super) fn crafts(pour: &StoredStage, fill: &StoredStage) -> Vec<(&'static str, StoredStage)> {
    let changed = |change: &dyn Fn(&mut StoredStage)| {
        let mut stage = pour.clone();
        change(&mut stage);
        stage
    };
    vec![
        ("the stage before", fill.clone()),
        ("too few bodies", changed(&|s| s.state.bodies.truncate(3))),
        ("too many bodies", changed(&|s| s.state.bodies.push(s.state.bodies[0]))),
        (
            "a grain beside the cylinder",
            changed(&|s| {
                s.state.bodies[0].body.pose.translation.vector.x += 0.2;
            }),
        ),
        ("grains in each other", changed(&|s| s.state.bodies[1].body = s.state.bodies[0].body)),
        (
            "all lifted",
            changed(&|s| {
                s.state.bodies.iter_mut().for_each(|g| g.body.pose.translation.vector.z += 1e-3);
            }),
        ),
        ("a grain taken out", changed(&|s| s.state.bodies[0].fate = Fate::Spilled)),
        (
            "the funnel still there",
            changed(&|s| {
                s.state.funnel = fill.state.funnel;
            }),
        ),
        (
            "a fixed grain that there is not",
            changed(&|s| {
                let fixed_grains = vec![FixedGrain { grain: 1 << 40, pose: Pose::identity() }];
                s.state.base = Some(Base { radius: 0.1, friction: None, fixed_grains });
            }),
        ),
        ("a later time", changed(&|s| s.state.time += 1.0)),
        ("no series", changed(&|s| s.series.clear())),
    ]
}
