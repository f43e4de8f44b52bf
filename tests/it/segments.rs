//! Long stages in segments: what is simulated does not show where they end.

use std::{
    fs,
    path::{Path, PathBuf},
    sync::OnceLock,
    thread,
    time::{Duration, Instant},
};

use serde_json::{Value, json};
use tempfile::TempDir;

use super::{
    interruption::{copy, finished, pluvia, stages, without_figures, write_scenario_in_segments},
    near::near,
    program::{self, column, json as read, text, write},
    same::assert_same_files,
    small,
};

/// What an uninterrupted run in segments of a tenth of a second leaves.
fn in_segments() -> &'static Path {
    static OUT: OnceLock<PathBuf> = OnceLock::new();
    OUT.get_or_init(|| in_segments_timed().0.path().join("out"))
}

/// The folder that holds it in `out`, and how long it took.
pub fn in_segments_timed() -> &'static (TempDir, Duration) {
    static MADE: OnceLock<(TempDir, Duration)> = OnceLock::new();
    MADE.get_or_init(|| {
        let folder = tempfile::tempdir().expect("a folder");
        let scenario = write_scenario_in_segments(folder.path());
        let started = Instant::now();
        let done = pluvia(&scenario, &folder.path().join("out")).status().expect("started");
        assert!(done.success(), "law: the scenario can be run in segments");
        (folder, started.elapsed())
    })
}

/// Rows of a stage that shakes for half a second, until the shaking ends.
const ROWS_OF_SHAKING: usize = 8;

#[test]
fn no_row_is_missing_or_there_twice() {
    for table in ["series.csv", "rest_test.csv"] {
        let rows = |out: &Path| {
            let file = out.join(table);
            column(&file, "time_s").into_iter().zip(column(&file, "stage")).collect::<Vec<_>>()
        };
        for (name, rows) in [("segments", rows(in_segments())), ("one segment", rows(finished()))] {
            for pair in rows.windows(2) {
                let ((before, stage), (after, next)) = (pair[0], pair[1]);
                if stage == next {
                    let step = after - before;
                    // Rows are at whole steps of 1/480 s; the last may be sooner.
                    assert!(
                        step > 1e-6 && step < 0.08 + 1.01 / 480.0,
                        "law: rows 0.08 s apart to a step, {name}, {table}: {before} s and then \
                         {after} s"
                    );
                }
            }
        }
    }
    // Stages of given length have rows at the same times, and the table is where it was.
    let of = |out: &Path, name| column(&out.join("rest_test.csv"), name).len();
    assert_eq!(of(in_segments(), "time_s"), of(finished(), "time_s"), "law: as many rows");
    let shaken = |out: &Path| {
        let file = out.join("series.csv");
        let (stage, x) = (column(&file, "stage"), column(&file, "table_x_mm"));
        let of_last = stage.iter().zip(x).filter(|(s, _)| **s == 3.0).map(|(_, x)| x);
        // How long everything takes to come to rest is not given.
        of_last.take(ROWS_OF_SHAKING).collect::<Vec<f64>>()
    };
    assert_eq!(shaken(in_segments()), shaken(finished()), "law: the table moves on through seams");
}

#[test]
fn what_was_kept_on_the_way_is_gone_at_the_end() {
    for entry in fs::read_dir(in_segments().join("stages")).expect("stages").flatten() {
        let name = entry.file_name().to_string_lossy().into_owned();
        assert!(name == ".lock" || !name.starts_with('.'), "law: nothing is left, got {name}");
    }
    let [manifest, whole] = [in_segments(), finished()].map(|out| read(&out.join("manifest.json")));
    for (segments, one) in
        [("segments", &manifest), ("one segment", &whole)].map(|(n, m)| (n, &m["stages"]))
    {
        assert_eq!(one.as_array().map(Vec::len), Some(4), "law: four stages in {segments}");
    }
    let counted = |m: &Value| {
        let (steps, time) = (&m["stages"][3]["steps"], &m["stages"][3]["simulated_s"]);
        let rate = &m["scenario"]["engine"]["rate_hz"];
        let [steps, time, rate] = [steps, time, rate].map(|v| v.as_f64().expect("a number"));
        (steps, rate * time)
    };
    for (steps, expected) in [counted(&manifest), counted(&whole)] {
        near("steps are counted once", steps, expected, 1e-3);
    }
}

/// Three columns of the last stage's rows.
struct Rows {
    time: Vec<f64>,
    energy: Vec<f64>,
    plate: Vec<f64>,
    grains: Vec<f64>,
}

/// Runs a last stage on seventy grains, whole or in segments. The stages
/// before are shorter than a segment, so that it begins with the same bits.
fn last_stage(folder: &Path, stage: &Value, every: Option<f64>) -> Rows {
    let mut scenario = small::scenario(150.0, 0.5, 0.2);
    scenario["stages"][3] = stage.clone();
    if let Some(every) = every {
        scenario["engine"] = json!({ "native": { "checkpoint_every_s": every } });
    }
    let name = if every.is_some() { "segments" } else { "whole" };
    let file = write(folder, &format!("{name}.json"), &scenario);
    let out = folder.join(name);
    assert!(without_figures(&file, &out).status().expect("started").success());
    let table = out.join("series.csv");
    let of = |what: &str| {
        let all = column(&table, "stage").into_iter().zip(column(&table, what));
        all.filter(|(stage, _)| *stage == 3.0).map(|(_, x)| x).collect::<Vec<f64>>()
    };
    Rows {
        time: of("time_s"),
        energy: of("kinetic_energy_j"),
        plate: of("plate_height_mm"),
        grains: of("mean_grain_height_mm"),
    }
}

/// The number of the first row after a seam, up to which both are the same.
fn first_after_seam(whole: &Rows, segments: &Rows, seam_s: f64) -> usize {
    // The last row may be at another time.
    let both = whole.time.len().min(segments.time.len()) - 1;
    assert_eq!(whole.time[..both], segments.time[..both], "law: rows at the same times");
    let first = whole.time.iter().position(|t| t - whole.time[0] > seam_s).expect("a seam");
    for (what, a, b) in
        [("energy", &whole.energy, &segments.energy), ("plate", &whole.plate, &segments.plate)]
    {
        assert_eq!(a[..first], b[..first], "law: the same bits before the seam, {what}");
    }
    first
}

fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

#[test]
#[ignore = "slow: make test-all"]
fn a_packing_at_rest_hardly_feels_a_seam() {
    let folder = tempfile::tempdir().expect("a folder");
    let stage = json!({ "stage": "rest", "duration_s": 3.5 });
    let whole = last_stage(folder.path(), &stage, None);
    let segments = last_stage(folder.path(), &stage, Some(2.5));
    let first = first_after_seam(&whole, &segments, 2.5);
    // A grain of 2 g that falls by a micrometre has 2e-8 J.
    let energy = segments.energy[first..].iter().copied().fold(0.0, f64::max);
    assert!(
        energy < 2e-8,
        "law: a seam gives no energy; expected under 2e-8 J, got up to {energy:.3e} J"
    );
    for (what, a, b) in
        [("plate", &whole.plate, &segments.plate), ("grains", &whole.grains, &segments.grains)]
    {
        let jump = largest_difference(&a[first..], &b[first..]);
        assert!(
            jump < 1e-3,
            "law: heights do not jump at a seam; {what}, expected without seam to 0.001 mm, got \
             {jump:.3e} mm"
        );
    }
}

/// The checkpoints of a stage that is under way, from the earliest to the latest.
fn checkpoints(out: &Path) -> Vec<PathBuf> {
    let below = |path: &Path| {
        let entries = fs::read_dir(path).into_iter().flatten().flatten();
        entries.map(|e| e.path()).collect::<Vec<PathBuf>>()
    };
    let segments = below(&out.join("stages")).into_iter().filter(|path| {
        path.file_name().is_some_and(|name| name.to_string_lossy().starts_with(".segments-"))
    });
    let mut found: Vec<PathBuf> = segments
        .flat_map(|folder| below(&folder))
        .filter(|path| path.extension().is_some_and(|e| e == "segment"))
        .collect();
    found.sort();
    found
}

/// Runs and kills until a stage has two checkpoints; none if it was too quick.
fn killed_between_segments(scenario: &Path, out: &Path) -> Option<Vec<PathBuf>> {
    for _ in 0..20 {
        let _ = fs::remove_dir_all(out);
        let mut run = without_figures(scenario, out).spawn().expect("started");
        let patience = Instant::now();
        while checkpoints(out).len() < 2 && stages(out) < 5 {
            assert!(patience.elapsed() < Duration::from_secs(120), "law: it gets on");
            thread::sleep(Duration::from_millis(2));
        }
        let _ = run.kill();
        run.wait().expect("ended");
        let found = checkpoints(out);
        if found.len() == 2 {
            return Some(found);
        }
    }
    None
}

#[test]
#[ignore = "slow: make test-all"]
fn damaged_checkpoints_are_told_and_those_before_are_used() {
    let folder = tempfile::tempdir().expect("a folder");
    let scenario = write_scenario_in_segments(folder.path());
    let killed = folder.path().join("killed");
    let found = killed_between_segments(&scenario, &killed).expect("law: segments can be met");
    // The last is torn; both are; the frames are cut off, which both need.
    for torn in [1, 2, 3] {
        let out = folder.path().join(format!("out-{torn}"));
        copy(&killed, &out);
        // Figures take longer than the run: they are drawn once, and copied otherwise.
        let is_drawn = torn == 1;
        if !is_drawn {
            copy(&in_segments().join("figures"), &out.join("figures"));
        }
        let found: Vec<PathBuf> = found
            .iter()
            .map(|file| out.join(file.strip_prefix(&killed).expect("a file of the run")))
            .collect();
        if torn < 3 {
            for file in found.iter().rev().take(torn) {
                let content = fs::read(file).expect("a checkpoint");
                fs::write(file, &content[..content.len() / 2]).expect("torn");
            }
        } else {
            fs::write(found[0].with_file_name("frames.bin"), "PLUVFRM1").expect("cut off");
        }
        let mut args = vec!["run", text(&scenario), "--out", text(&out)];
        args.extend((!is_drawn).then_some("--no-figures"));
        let (code, _, said) = program::run(&args);
        assert_eq!(code, Some(0), "law: damage does not end a run, got {said}");
        let told = said.matches("a checkpoint is damaged").count();
        assert_eq!(told, torn.min(2), "law: as many are reported as are damaged, got {said}");
        let goes_on = said.contains("resumes at");
        assert_eq!(goes_on, torn == 1, "law: it goes on where one is sound, got {said}");
        assert_same_files(in_segments(), &out, &format!("{torn} damaged checkpoints"));
    }
}
