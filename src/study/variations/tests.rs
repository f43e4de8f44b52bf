//! Variations on a few grains: pairs, failures, grains of their own, resuming.

use std::{
    fs,
    path::Path,
    sync::atomic::{AtomicUsize, Ordering},
};

use super::*;
use crate::geometry::Vector;
use crate::scenario::EngineSettings;
use crate::study::tests::run_options;
use crate::world::{BodyState, World, scripted::ScriptedWorld};

fn varied(folder: &Path, variations: &[(&str, &[&str])]) -> Result<Varied, ScenarioErrors> {
    let base = folder.join("base.json");
    let scenario = serde_json::json!({
        "name": "test",
        "grains": {
            "total_mass_g": 30, "density_kg_per_m3": 2673.9,
            "sieve_table": [{ "passing_mm": 12.5, "retained_mm": 10, "mass_percent": 100 }]
        },
        "stages": [{ "stage": "fill_funnel" }],
        "rest_test_s": 0.1
    });
    fs::write(&base, scenario.to_string()).expect("a scenario");
    let of = |(name, changes): &(&str, &[&str])| Variation {
        name: (*name).to_owned(),
        group: "group".to_owned(),
        changes: changes.iter().map(|c| c.parse().expect("a change")).collect(),
        configurations: None,
    };
    Varied::load(&base, &[], variations.iter().map(of).collect())
}

/// Worlds of Bullet, but at 960 steps a second one that blows up.
fn worlds(
    made: &AtomicUsize,
) -> impl Fn(
    &EngineSettings,
    Vector,
    &crate::world::PairTable,
) -> Result<Box<dyn World + Send>, crate::world::WorldError>
+ Sync {
    move |settings, gravity, pairs| {
        made.fetch_add(1, Ordering::Relaxed);
        if settings.rate_hz != 960.0 {
            return crate::world::create(settings, gravity, pairs);
        }
        let script = |_, state: &BodyState, _, _| BodyState {
            linear_velocity: Vector::new(1e9, 0.0, 0.0),
            ..*state
        };
        Ok(Box::new(ScriptedWorld::new(1.0 / 960.0, Box::new(script))))
    }
}

/// Keeps the beginnings and ends of work, and what is left out of it.
#[derive(Default)]
struct Works {
    told: Mutex<Vec<&'static str>>,
    left_out: Mutex<Vec<f64>>,
}

impl Progress for Works {
    fn begin_work(&self, _: f64) {
        self.told.lock().expect("nobody panics").push("begun");
    }
    fn end_work(&self) {
        self.told.lock().expect("nobody panics").push("ended");
    }
    fn left_out(&self, expected: f64) {
        self.left_out.lock().expect("nobody panics").push(expected);
    }
    fn message(&self, _: &str) {}
}

#[test]
fn a_run_that_fails_is_a_row_and_the_others_go_on() {
    let _turn = crate::world::exclusive_turn();
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("out");
    let varied = varied(
        folder.path(),
        &[
            ("plain", &[]),
            ("blown", &["engine.rate_hz=960"]),
            ("threshold", &["engine.contact_threshold_mm=0.8"]),
            ("grains", &["seed=2", "grains.total_mass_g=20"]),
        ],
    )
    .expect("sound");
    let made = AtomicUsize::new(0);
    let worlds = worlds(&made);
    let mut lengths = Vec::new();
    let mut so_far = |rows: &[RunRow]| {
        lengths.push(rows.len());
        Ok(())
    };
    let works = Arc::new(Works::default());
    let options = RunOptions { progress: works.clone(), ..run_options(&out) };
    let rows = carry_out_in(&worlds, &varied, &[0..1, 1..2], &options, &mut so_far)
        .expect("the study goes on");
    let told = works.told.lock().expect("nobody panics").clone();
    assert_eq!(told, ["begun", "ended"], "law: all parts are reported as one work");
    let left_out = works.left_out.lock().expect("nobody panics").clone();
    assert_eq!(left_out, [0.1; 2], "law: the rest test of each failed run is no work any more");
    assert_eq!(rows.len(), 8, "law: one row a run, failed or not");
    // Another contact threshold cannot live in the process at the same time.
    assert_eq!(lengths, [3, 4, 7, 8], "law: rows are reported as they come");
    for row in &rows {
        let blown = row.variation == "blown";
        assert_eq!(row.failure.is_some(), blown, "law: only the blown run fails: {row:?}");
        assert_eq!(row.grains.is_none(), blown, "law: results of what ran alone: {row:?}");
        assert_eq!(out.join("runs").join(&row.run).join("summary.json").is_file(), !blown);
        let own = out.join("runs").join(&row.run).join("grains.json").is_file();
        assert_eq!(own, row.variation == "grains", "law: grains of its own are kept with it");
    }
    let why = rows[1].failure.as_deref().expect("it failed");
    assert!(why.contains("speed") && why.contains("blown-c1"), "it says why and where: {why}");
    let counts: Vec<_> = ["plain", "grains"]
        .iter()
        .map(|v| rows.iter().find(|r| r.variation == *v).and_then(|r| r.grains))
        .collect();
    assert!(counts[0] > counts[1], "law: less mass, fewer grains: {counts:?}");

    // The same again: only what failed is tried again.
    let before = made.swap(0, Ordering::Relaxed);
    let again = carry_out_in(&worlds, &varied, &[0..1, 1..2], &run_options(&out), &mut |_| Ok(()))
        .expect("done");
    assert_eq!(again, rows, "law: stored runs give the same rows, wall time included");
    let tried = made.load(Ordering::Relaxed);
    assert_eq!(tried, 2, "law: the two failed runs are tried again, of {before} worlds before");
}

#[test]
fn the_faults_of_all_variations_are_told_with_their_names() {
    let folder = tempfile::tempdir().expect("a folder");
    let found = varied(
        folder.path(),
        &[("fast", &["engine.rate_hz=-1"]), ("fine", &[]), ("red", &["colour=red"])],
    )
    .expect_err("two faults");
    let said = found.to_string();
    assert_eq!(found.faults().len(), 2, "{said}");
    for words in ["variation `fast`", "engine.rate_hz", "variation `red`", "colour"] {
        assert!(said.contains(words), "`{words}` is missing in: {said}");
    }
}

#[test]
fn programmes_are_told_apart_by_all_that_is_done() {
    let folder = tempfile::tempdir().expect("a folder");
    let of = |variations: &[(&str, &[&str])], n| {
        varied(folder.path(), variations).expect("sound").programme(n)
    };
    let one = of(&[("a", &["seed=2"])], 2);
    assert_eq!(one, of(&[("a", &["seed=2"])], 2), "law: the same, the same name");
    for (other, n) in [(&[("a", &["seed=3"] as &[&str])], 2), (&[("b", &["seed=2"])], 2)] {
        assert_ne!(one, of(other, n), "law: another programme, another name");
    }
    assert_ne!(one, of(&[("a", &["seed=2"])], 3), "configurations count");
    let same = varied(folder.path(), &[("a", &["seed=2"])]).expect("sound");
    assert_eq!(one, same.programme_of_format(2, STAGE_FORMAT), "law: that of this build");
    let earlier = same.programme_of_format(2, STAGE_FORMAT - 1);
    assert_ne!(one, earlier, "law: an earlier build computed other results");
}

/// Law: every configuration stands in one range, and there are four runs together for each core, or
/// more by less than the number of variations.
#[test]
fn every_core_has_several_runs() {
    for (configurations, variations, cores, expected) in [
        (16, 1, 2, &[(0, 8), (8, 16)][..]),
        (9, 1, 2, &[(0, 8), (8, 9)]),
        (4, 3, 2, &[(0, 3), (3, 4)]),
        (2, 8, 2, &[(0, 1), (1, 2)]),
        (2, 9, 2, &[(0, 1), (1, 2)]),
        (8, 3, 4, &[(0, 6), (6, 8)]),
        (2, 1, 64, &[(0, 2)]),
        (2, 0, 0, &[(0, 1), (1, 2)]),
        (0, 1, 2, &[]),
    ] {
        let got = ranges(configurations, variations, cores);
        let got: Vec<(u32, u32)> = got.into_iter().map(|range| (range.start, range.end)).collect();
        assert_eq!(got, expected, "law: {configurations} of {variations} on {cores} cores");
    }
}
