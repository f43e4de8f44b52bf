//! Checks that need measures: overlap while a stage goes on, numerical creep where it
//! rests; and what all checks of a run found together.

use super::*;
use crate::protocol::Watched;
use crate::record::{CheckSummary, Checks, OverlapWatch, Sunk, mean_drop_mm};

/// Largest 99th percentile of the solver's residual, our choice: quick specimens have 0.002 to
/// 0.015 at the default while they are poured and shaken, and 0.02 to 0.04 with eight
/// iterations whatever they leave.
const RESIDUAL_LIMIT: f64 = 0.05;

/// Times in s that differ by less are the same.
const ROUNDING: f64 = 1e-9;

/// Share by which a rest may miss the shortest that tells of numerical creep: people type few
/// digits.
const TYPED: f64 = 1e-3;

/// Whether grains are held to the standard of overlap all through a stage, being
/// at rest or shaken; where they fall it is only at its end.
fn judged_throughout(stage: &StageSpec) -> bool {
    matches!(
        stage,
        StageSpec::PlaceTopPlate { .. } | StageSpec::Vibrate { .. } | StageSpec::Rest { .. }
    )
}

/// Looks at the overlap if that is due at a time in s since the stage began;
/// what a reader should know at once.
pub(super) fn look_at_overlap(
    watch: &mut OverlapWatch,
    (stage, scale): (&StageSpec, &Scale),
    specimen: &Specimen,
    stage_time: f64,
    time: f64,
) -> Option<String> {
    let interval = scale::OVERLAP_INTERVAL.at(scale);
    if watch.next_look_s == 0.0 {
        watch.next_look_s = interval;
    }
    if stage_time < watch.next_look_s - ROUNDING || !judged_throughout(stage) {
        return None;
    }
    while watch.next_look_s <= stage_time + ROUNDING {
        watch.next_look_s += interval;
    }
    watch.last_look_s = Some(stage_time);
    measure_overlap(watch, specimen, time)
}

/// Looks at the overlap at the end of a stage, unless that has just been done.
pub(super) fn last_look_at_overlap(
    watch: &mut OverlapWatch,
    specimen: &Specimen,
    stage_time: f64,
    time: f64,
) -> Option<String> {
    if watch.last_look_s.is_some_and(|last| last >= stage_time - ROUNDING) {
        return None;
    }
    watch.last_look_s = Some(stage_time);
    measure_overlap(watch, specimen, time)
}

fn measure_overlap(watch: &mut OverlapWatch, specimen: &Specimen, time: f64) -> Option<String> {
    let present: Vec<usize> = specimen.present().collect();
    // Pairs that only touch count in neither figure.
    let statistics = overlap_statistics(specimen, &pairs_within(specimen, &present, 0.0));
    let (mean, p99) = (100.0 * statistics.mean, 100.0 * statistics.p99);
    let limits = standard(&Scale::PAPER);
    let (mean_limit, p99_limit) = (limits.overlap_mean_percent, limits.overlap_p99_percent);
    let mean_is_new = watch.mean.note(mean, mean_limit, time);
    let p99_is_new = watch.p99.note(p99, p99_limit, time);
    (mean_is_new || p99_is_new).then(|| {
        format!(
            "at {time:.2} s grains overlap by {mean:.2} % on average (limit {mean_limit} %), 99th \
             percentile {p99:.2} % ({p99_limit} %)"
        )
    })
}

/// Beginning and end of the rests of a stage that are long enough to tell of numerical creep, in s
/// since it began; a stage that only rests has no end here.
pub(super) fn rests(stage: &StageSpec, scale: &Scale) -> Vec<(f64, f64)> {
    let shortest = scale::SHORTEST_REST.at(scale);
    match stage {
        StageSpec::Rest { .. } => vec![(0.0, f64::INFINITY)],
        StageSpec::Vibrate { .. } => stage
            .motion()
            .filter(|motion| motion.rest >= shortest * (1.0 - TYPED))
            .map(|motion| {
                let ends = motion.period_ends();
                let last = ends.len().saturating_sub(1);
                ends[..last].iter().map(|end| (*end, end + motion.rest)).collect()
            })
            .unwrap_or_default(),
        _ => Vec::new(),
    }
}

/// Whether a time lies in a rest, all in s since a stage began.
pub(super) fn is_within(time: f64, (from, to): (f64, f64)) -> bool {
    time >= from - ROUNDING && time <= to + ROUNDING
}

/// Numerical creep wherever a stage rests, from its rows and how far grains sank where some left or
/// came, against what the scale allows.
pub(super) fn creep(
    stage: &StageSpec,
    rows: &[SeriesRow],
    sunk: &[Sunk],
    scale: &Scale,
) -> Watched {
    let limit = standard(scale).creep_um_per_s;
    let mut watched = Watched::default();
    let Some(began) = rows.first().map(|r| r.time_s) else { return watched };
    for rest in rests(stage, scale) {
        let within = |r: &&SeriesRow| is_within(r.time_s - began, rest);
        let rest: Vec<SeriesRow> = rows.iter().filter(within).copied().collect();
        if let (Some(creep), Some(last)) = (creep_um_per_s(&rest, sunk), rest.last()) {
            watched.note(creep.abs(), limit, last.time_s);
        }
    }
    watched
}

/// Speed in µm/s at which the mean grain sinks in the second half of the
/// rest test. In the first, what still moved comes to rest: a specimen poured by
/// a stated criterion of calm, or one whose table stops from full speed. Of grains that leave or
/// come meanwhile, `sunk` knows how far the others sank.
pub(super) fn creep_um_per_s(series: &[SeriesRow], sunk: &[Sunk]) -> Option<f64> {
    let (first, last) = (series.first()?, series.last()?);
    let half = (first.time_s + last.time_s) / 2.0;
    let from = series.iter().find(|row| row.time_s >= half)?;
    let duration = last.time_s - from.time_s;
    let drop = mean_drop_mm(from, last, sunk)?;
    (duration > 0.0).then(|| 1e3 * drop / duration)
}

/// What a reader must know of a stage's checks; of a rest with numerical creep also whether grains
/// still moved in its second half, where that is measured.
pub(super) fn warnings(
    checks: &StageChecks,
    stage: &StageSpec,
    rows: &[SeriesRow],
    scale: &Scale,
) -> Vec<String> {
    let of = |what: &str, unit: &str, watched: &Watched| {
        let first = watched.first_beyond_s?;
        Some(format!(
            "{what}: {:.3} {unit} at worst (at {:.2} s), limit {:.3} {unit}, first beyond it at \
             {first:.2} s, in {} of {} looks",
            watched.worst, watched.worst_at_s, watched.limit, watched.beyond, watched.looks
        ))
    };
    let half = rows.first().zip(rows.last()).map(|(a, b)| (a.time_s + b.time_s) / 2.0);
    let in_it = rows.iter().filter(|row| half.is_some_and(|half| row.time_s >= half));
    let fastest = in_it.map(|row| row.largest_speed_m_per_s).fold(0.0, f64::max);
    let is_motion = matches!(stage, StageSpec::Rest { .. })
        && checks.creep.first_beyond_s.is_some()
        && fastest > scale::SLOW.at(scale);
    let moving = is_motion.then(|| {
        format!(
            "grains still moved in the second half of the rest, at up to {:.0} mm/s, and that counts \
             as numerical creep: rest longer, or let them settle before (`settle_limit_s`)",
            to_mm(fastest)
        )
    });
    [
        of("speed beyond what fall and table can give", "m/s", &checks.speed),
        of("unexplained energy gain", "J", &checks.energy),
        of("mean overlap of grains", "%", &checks.overlap.mean),
        of("99th percentile of the overlap of grains", "%", &checks.overlap.p99),
        of("numerical creep at rest", "µm/s", &checks.creep),
        moving,
    ]
    .into_iter()
    .flatten()
    .collect()
}

/// All checks of a run, from the records of its stages, the rest test's the last, and the number
/// of grains gone through a floor or a wall that no stage of the run noted: pressed into it, or
/// gone that way before the run began.
pub(super) fn of_run<'a>(
    stages: impl Iterator<Item = &'a StageRecord> + Clone,
    unnoted: usize,
) -> Checks {
    let unwatched: Vec<String> =
        stages.clone().filter(|s| s.checks.is_none()).map(|s| s.stage.clone()).collect();
    let each = stages.clone().filter_map(|s| s.checks.as_ref());
    let watched = |of: fn(&StageChecks) -> Watched| {
        each.clone().map(of).fold(Watched::default(), Watched::and)
    };
    let residuals: Vec<f64> =
        stages.clone().flat_map(|s| s.solver_residuals.iter().copied()).collect();
    let residual = SolverResidual::of(residuals.iter().copied());
    let checks: u64 = each.clone().map(|g| g.checks).sum();
    let noted: u32 = each.clone().map(|g| g.through_walls).sum();
    let through = noted.saturating_add(u32::try_from(unnoted).unwrap_or(u32::MAX));
    let mut checks = Checks {
        passed: None,
        finite: CheckSummary::none_of(
            "bodies whose place, orientation or velocity is no finite number, or far off: ends the run",
            "bodies",
            0,
            checks,
        ),
        lost: CheckSummary::none_of(
            "bodies that the engine no longer holds though nobody took them away: ends the run",
            "bodies",
            0,
            checks,
        ),
        through_walls: CheckSummary::none_of(
            "grains that passed through a wall or a floor, were found with their centroid in one, or were gone that way before the run began",
            "grains",
            through,
            checks,
        ),
        speed: CheckSummary::of(
            "largest speed of grains, plate, and pressed and free pieces, against 1.5 times that of free fall and table; 5 times ends the run",
            "m/s",
            &watched(|g| g.speed),
        ),
        energy: CheckSummary::of(
            "unexplained energy gain, against 5 % of what gravity and table can give; as much ends the run",
            "J",
            &watched(|g| g.energy),
        ),
        overlap_mean: CheckSummary::of(
            "mean overlap of grains at rest or shaken, exact, outside the engine",
            "%",
            &watched(|g| g.overlap.mean),
        ),
        overlap_p99: CheckSummary::of(
            "99th percentile of the overlap of grains at rest or shaken",
            "%",
            &watched(|g| g.overlap.p99),
        ),
        creep: CheckSummary::of(
            "sinking rate of the mean grain height in the second half of every rest, up or down",
            "µm/s",
            &watched(|g| g.creep),
        ),
        solver_residual: Some(CheckSummary::at_most(
            "99th percentile of the residual of the native contact solver over its impulses, in \
             the kinetic norm",
            RESIDUAL_LIMIT,
            residual.map(|r| r.p99),
            residuals.len() as u64,
        )),
        unwatched_stages: unwatched,
    };
    let passed = checks.each().iter().all(|(_, g)| g.passed != Some(false));
    checks.passed = match (passed, checks.unwatched_stages.is_empty()) {
        (false, _) => Some(false),
        (true, complete) => complete.then_some(true),
    };
    checks
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::geometry::Pose;
    use crate::grains::generate;
    use crate::scenario::{GrainsSpec, Scenario};
    use crate::specimen::SpecimenState;

    /// Grains in a row 30 mm apart, but the second so far into the first, in m.
    fn specimen(sunk: f64) -> Specimen {
        let scenario: Scenario = serde_json::from_value(serde_json::json!({
            "name": "test",
            "grains": {
                "total_mass_g": 30, "density_kg_per_m3": 2673.9,
                "sieve_table": [{ "passing_mm": 12.5, "retained_mm": 10, "mass_percent": 100 }]
            },
            "stages": []
        }))
        .expect("a scenario");
        let GrainsSpec::Sieved(spec) = &scenario.grains else { panic!("sieved") };
        let grains = Arc::new(generate(spec, 1).expect("grains"));
        let mut state = SpecimenState::before_everything(grains.grains.len());
        for (n, grain) in state.bodies.iter_mut().enumerate() {
            grain.body.pose = Pose::translation(0.03 * n as f64, 0.0, 0.0);
        }
        let half = |n: usize, high: bool| {
            let (low, top) = grains.grains[n].shape.bounding_box();
            if high { top.x } else { -low.x }
        };
        // Boxes overlap by less than bodies do nowhere, so that touching boxes are apart.
        let touching = half(0, true) + half(1, false);
        state.bodies[1].body.pose = Pose::translation(touching - sunk, 0.0, 0.0);
        Specimen { grains, state }
    }

    const REST: StageSpec = StageSpec::Rest { duration_s: 10.0 };

    #[test]
    fn grains_in_each_other_are_found_and_grains_apart_are_not() {
        let mut watch = OverlapWatch::default();
        let mut at = |specimen: &Specimen, time: f64| {
            look_at_overlap(&mut watch, (&REST, &Scale::PAPER), specimen, time, 5.0 + time)
        };
        assert_eq!(at(&specimen(0.0), 1.96), None, "law: not before two seconds are over");
        assert_eq!(at(&specimen(0.0), 2.04), None, "law: grains apart are no fault");
        assert_eq!(at(&specimen(0.006), 2.12), None, "law: not due");
        let told = at(&specimen(0.006), 4.0).expect("law: it is due, and told");
        assert!(told.contains("at 9.00 s") && told.contains("limit 0.5 %"), "{told}");
        assert_eq!(at(&specimen(0.006), 6.0), None, "law: told once");
        assert_eq!((watch.mean.looks, watch.mean.beyond), (3, 2));
        assert_eq!((watch.mean.first_beyond_s, watch.p99.first_beyond_s), (Some(9.0), Some(9.0)));
        assert!(watch.mean.worst > 3.0, "{watch:?}");
    }

    #[test]
    fn falling_grains_are_judged_at_the_end_alone_and_an_end_is_looked_at_once() {
        let mut watch = OverlapWatch::default();
        let pour = StageSpec::Pour { falling_height_mm: 0.0, time_limit_s: 4.0 };
        let deep = specimen(0.006);
        let paper = Scale::PAPER;
        assert_eq!(look_at_overlap(&mut watch, (&pour, &paper), &deep, 2.0, 2.0), None);
        assert!(last_look_at_overlap(&mut watch, &deep, 2.5, 2.5).is_some());
        assert_eq!(watch.mean.looks, 1);
        for (length, looks) in [(1.0, 1), (2.0, 1), (4.0, 2), (4.5, 3)] {
            let mut watch = OverlapWatch::default();
            for n in 0..=(length / 0.08_f64).round() as u32 {
                let time = 0.08 * f64::from(n);
                look_at_overlap(&mut watch, (&REST, &paper), &deep, time, time);
            }
            look_at_overlap(&mut watch, (&REST, &paper), &deep, length, length);
            last_look_at_overlap(&mut watch, &deep, length, length);
            assert_eq!(
                watch.mean.looks, looks,
                "law: every two seconds and at the end, {length} s"
            );
        }
    }

    #[test]
    fn looks_and_rests_follow_the_size_of_the_grains() {
        let deep = specimen(0.006);
        for (size, looks) in [(0.008 / 16.0, 8), (0.008, 2), (0.008 * 4.0, 1)] {
            let scale = Scale::of_smallest(size, Scale::PAPER.gravity);
            let mut watch = OverlapWatch::default();
            for n in 1..=50 {
                let time = 0.08 * f64::from(n);
                look_at_overlap(&mut watch, (&REST, &scale), &deep, time, time);
            }
            let got = watch.mean.looks;
            assert_eq!(got, looks, "law: every 2 s times √(d/8 mm), in 4 s; grains of {size} m");
        }
        let still = rows(14.0, |_| 80.0);
        let of = |rest_s: f64, size: f64| {
            creep(&vibrated(rest_s), &still, &[], &Scale::of_smallest(size, 9.81)).looks
        };
        for (rest_s, size, looks) in
            [(1.0, 0.008, 2), (1.0, 0.04, 0), (2.236, 0.04, 2), (2.2, 0.04, 0), (0.5, 0.0008, 2)]
        {
            let got = of(rest_s, size);
            assert_eq!(got, looks, "law: rests of √(d/8 mm) s, {rest_s} s with {size} m");
        }
    }

    /// Three periods of 2 s with rests between them.
    fn vibrated(rest_s: f64) -> StageSpec {
        serde_json::from_value(serde_json::json!({
            "stage": "vibrate", "frequency_hz": 1, "amplitude_mm": 1, "duration_s": 2,
            "periods": 3, "rest_s": rest_s
        }))
        .expect("a vibration")
    }

    fn row(time_s: f64, mean_grain_height_mm: f64) -> SeriesRow {
        SeriesRow {
            time_s,
            mean_grain_height_mm: Some(mean_grain_height_mm),
            ..SeriesRow::default()
        }
    }

    /// Rows every 0.1 s from 3 s on; heights in mm by the time since then.
    fn rows(duration: f64, height: impl Fn(f64) -> f64) -> Vec<SeriesRow> {
        let count = (duration / 0.1_f64).round() as u32;
        let times = (0..=count).map(|n| 0.1 * f64::from(n));
        times.map(|t| row(3.0 + t, height(t))).collect()
    }

    #[test]
    fn creep_is_that_of_the_second_half() {
        // 1 mm lost while coming to rest, then 2 µm in a second.
        let rows = [row(5.0, 80.0), row(5.5, 79.2), row(6.0, 79.0), row(7.0, 78.998)];
        let got = creep_um_per_s(&rows, &[]).expect("a creep");
        assert!((got - 2.0).abs() < 1e-6, "law: 2 µm/s in the second half, got {got}");
        assert_eq!(creep_um_per_s(&rows[..1], &[]), None, "law: one row tells nothing");
        // Numerical creep that never ends shows in full.
        let for_ever = [row(0.0, 80.0), row(1.0, 79.0), row(2.0, 78.0)];
        let got = creep_um_per_s(&for_ever, &[]).expect("a creep");
        assert!((got - 1000.0).abs() < 1e-6, "law: 1000 µm/s, got {got}");
    }

    #[test]
    fn creep_is_found_in_every_rest_and_nowhere_else() {
        // Sinks by 1 mm/s when shaken, and when at rest by 20 µm/s in the second rest alone.
        let sinking = rows(8.0, |t| match t {
            t if t < 2.0 => 80.0 - t,
            t if t < 3.0 => 78.0,
            t if t < 5.0 => 78.0 - (t - 3.0),
            t if t < 6.05 => 76.0 - 0.02 * (t - 5.0),
            t => 76.0 - (t - 6.0),
        });
        let watched = creep(&vibrated(1.0), &sinking, &[], &Scale::PAPER);
        assert_eq!((watched.looks, watched.beyond), (2, 1), "law: two rests, {watched:?}");
        assert!((watched.worst - 20.0).abs() < 1e-6, "law: 20 µm/s, got {}", watched.worst);
        assert!((watched.worst_at_s - 9.0).abs() < 1e-9, "law: at the end of its rest");
        assert_eq!(
            creep(&vibrated(0.5), &sinking, &[], &Scale::PAPER).looks,
            0,
            "law: too short to tell"
        );
        let still = creep(&REST, &rows(10.0, |_| 80.0), &[], &Scale::PAPER);
        assert_eq!((still.looks, still.passed()), (1, Some(true)));
        let rising = creep(&REST, &rows(10.0, |t| 80.0 + 0.02 * t), &[], &Scale::PAPER);
        assert_eq!(rising.passed(), Some(false), "law: up or down");
        let pour = StageSpec::Pour { falling_height_mm: 0.0, time_limit_s: 4.0 };
        assert_eq!(creep(&pour, &sinking, &[], &Scale::PAPER).passed(), None);
    }

    /// Law: of creep in a rest it is said that grains still moved in its second half, not before.
    #[test]
    fn creep_of_grains_that_still_move_is_said_to_be_their_motion() {
        let mut creeping = sound();
        creeping.creep.note(117.0, 5.0, 9.0);
        for (until, expected) in [(3.9, true), (3.4, false)] {
            let mut rows = rows(1.0, |_| 80.0);
            let moving = rows.iter_mut().filter(|row| row.time_s < until);
            moving.for_each(|row| row.largest_speed_m_per_s = 0.045);
            let told = warnings(&creeping, &REST, &rows, &Scale::PAPER);
            let got = told.iter().any(|text| text.contains("at up to 45 mm/s"));
            assert_eq!(got, expected, "law: in motion from 3 s to {until} s of 4 s, got {told:?}");
        }
    }

    fn stage(name: &str, checks: Option<StageChecks>) -> StageRecord {
        StageRecord { stage: name.to_owned(), checks, ..StageRecord::default() }
    }

    fn sound() -> StageChecks {
        let mut checks = StageChecks { checks: 10, ..StageChecks::default() };
        for watched in [&mut checks.speed, &mut checks.energy, &mut checks.overlap.mean] {
            watched.note(0.1, 0.5, 1.0);
        }
        checks
    }

    #[test]
    fn a_run_passes_when_each_stage_was_watched_and_passed() {
        let of = |stages: &[StageRecord]| of_run(stages.iter(), 0);
        let both = of(&[stage("pour", Some(sound())), stage("rest", Some(sound()))]);
        assert_eq!((both.passed, both.finite.looks, both.speed.looks), (Some(true), 20, 2));
        assert_eq!((both.creep.passed, both.creep.worst), (None, None), "law: nobody looked");
        assert_eq!(both.line(), "6 of 6 passed");
        assert!(warnings(&sound(), &REST, &[], &Scale::PAPER).is_empty());

        let unwatched = of(&[stage("pour", None), stage("rest", Some(sound()))]);
        assert_eq!(unwatched.passed, None, "law: not known");
        assert!(unwatched.line().ends_with("stored before: pour"), "{}", unwatched.line());

        let mut creeping = sound();
        creeping.creep.note(117.0, 5.0, 9.0);
        let run = of(&[stage("pour", None), stage("rest", Some(creeping))]);
        assert_eq!((run.passed, run.creep.passed), (Some(false), Some(false)));
        assert!(run.line().starts_with("NOT passed: 1 of 7, creep"), "{}", run.line());
        let told = warnings(&creeping, &REST, &[], &Scale::PAPER);
        assert_eq!(told.len(), 1);
        assert!(told[0].contains("117.000 µm/s") && told[0].contains("9.00 s"), "{told:?}");

        // One of a hundred samples may be worse than the limit, two may not.
        for (bad, passed) in [(1, true), (2, false)] {
            let mut solved = stage("rest", Some(sound()));
            solved.solver_residuals = vec![0.01; 100 - bad];
            solved.solver_residuals.extend(vec![0.2; bad]);
            let run = of(&[solved]);
            let check = run.solver_residual.as_ref().expect("it is watched");
            assert_eq!((check.passed, run.passed), (Some(passed), Some(passed)), "{bad} of 100");
            assert_eq!((check.looks, check.limit), (100, Some(0.05)));
        }
        let unseen = both.solver_residual.as_ref().expect("there");
        assert_eq!((unseen.passed, unseen.worst), (None, None), "law: another engine says nothing");

        let through = StageChecks { through_walls: 2, ..sound() };
        let run = of(&[stage("pour", Some(through))]);
        assert_eq!((run.through_walls.passed, run.passed), (Some(false), Some(false)));
        assert_eq!(run.through_walls.worst, Some(2.0));
    }
}
