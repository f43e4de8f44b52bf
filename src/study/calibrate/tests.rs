//! The search on functions with scatter, whose roots are known.

use std::ops::Range;

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use statrs::distribution::{ContinuousCDF, Normal};

use super::{
    line::in_result,
    search::{Answer, search},
    under_way::Question,
};
use crate::report::{CalibrationEnding as Ending, CalibrationRun};
use crate::study::{CalibrationOptions, GRAIN_FRICTION, MEANWHILE, StudyError, calibrate};

/// A result that scatters.
#[derive(Clone, Copy)]
struct Scattering {
    /// The mean over all configurations.
    mean: fn(f64) -> f64,
    /// Standard deviation of what a configuration has at every value.
    own: f64,
    /// Standard deviation of what a single run has beside.
    single: f64,
    seed: u64,
}

/// A number that depends on nothing but its names.
fn normal(names: [u64; 3]) -> f64 {
    let mut seed = 0x9e37_79b9_7f4a_7c15_u64;
    for name in names {
        seed = (seed ^ name).wrapping_mul(0xd129_9061_5c8b_4bb5).rotate_left(29);
    }
    let uniform: f64 = Pcg64Mcg::seed_from_u64(seed).random_range(1e-12..1.0 - 1e-12);
    Normal::standard().inverse_cdf(uniform)
}

impl Scattering {
    fn at(&self, value: f64, configuration: u32) -> f64 {
        let configuration = u64::from(configuration);
        (self.mean)(value)
            + self.own * normal([self.seed, 0, configuration])
            + self.single * normal([self.seed, value.to_bits(), configuration])
    }
}

fn run(value: f64, configuration: u32, result: Option<f64>) -> CalibrationRun {
    CalibrationRun {
        result,
        failure: result.is_none().then(|| "it blew up".to_owned()),
        ..CalibrationRun::new(value, configuration, &format!("at-{value}-c{configuration}"))
    }
}

/// Runs every value in all of the configurations.
fn run_all(
    values: &[f64],
    configurations: Range<u32>,
    mut of: impl FnMut(f64, u32) -> Option<f64>,
) -> Vec<CalibrationRun> {
    let mut runs = Vec::new();
    for &value in values {
        runs.extend(configurations.clone().map(|n| run(value, n + 1, of(value, n + 1))));
    }
    runs
}

fn question(wanted: f64) -> Question {
    Question {
        wanted,
        between: (0.1, 1.5),
        realisations: 5,
        tolerance: None,
        most_runs: 80,
        whole: false,
        also: None,
    }
}

fn found(question: &Question, of: Scattering) -> Answer {
    let mut experiment = |values: &[f64], configurations: Range<u32>| {
        Ok(run_all(values, configurations, |v, c| Some(of.at(v, c))))
    };
    search(question, &mut experiment).expect("nothing stops it")
}

/// An angle of repose as friction may give it: rising, ever less.
fn saturating(mu: f64) -> f64 {
    15.0 + 30.0 * (1.0 - (-1.8 * mu).exp())
}

/// Its inverse.
fn saturating_root(angle: f64) -> f64 {
    -(1.0 - (angle - 15.0) / 30.0_f64).ln() / 1.8
}

/// Name, response, what is wanted, and the root or the end of the range.
type Case = (&'static str, fn(f64) -> f64, f64, f64);

#[test]
fn without_scatter_roots_are_found() {
    let cases: [Case; 5] = [
        ("a line", |x| 3.0 * x, 2.4, 0.8),
        ("falling", |x| 10.0 - 5.0 * x, 4.0, 1.2),
        ("saturating", saturating, 36.0, saturating_root(36.0)),
        ("steep", |x| 20.0 * ((x - 0.7) * 20.0).tanh(), 5.0, 0.7 + 0.25_f64.atanh() / 20.0),
        ("near the end", |x| x * x, 0.0121, 0.11),
    ];
    for (name, mean, wanted, root) in cases {
        let of = Scattering { mean, own: 0.0, single: 0.0, seed: 1 };
        let answer = found(&question(wanted), of);
        assert_eq!(answer.ending, Ending::Found, "{name}: {answer:?}");
        let x = answer.fit.expect("a line").x;
        assert!(
            (x - root).abs() < 5e-3,
            "law: {name} is {wanted} at {root}, got {x}, tolerance 5e-3"
        );
    }
}

/// How an interval about a value is taken; the second is wrong on purpose.
type Take = fn(f64, (f64, f64)) -> (f64, f64);

fn as_told(_: f64, interval: (f64, f64)) -> (f64, f64) {
    interval
}

fn half_as_wide(x: f64, (low, high): (f64, f64)) -> (f64, f64) {
    (f64::midpoint(x, low), f64::midpoint(x, high))
}

/// Searches with scatter of many seeds: what was found, and its interval.
fn many(of: Scattering, question: &Question) -> Vec<(f64, (f64, f64))> {
    let one = |seed| {
        let fit = found(question, Scattering { seed, ..of }).fit?;
        Some((fit.x, fit.interval?))
    };
    (0..TRIALS).filter_map(one).collect()
}

const TRIALS: u64 = 600;

/// Holds how often intervals hold the root against how often they should.
fn coverage(found: &[(f64, (f64, f64))], root: f64, take: Take) -> Result<(), String> {
    let inside = found.iter().filter(|(x, interval)| {
        let (low, high) = take(*x, *interval);
        low <= root && root <= high
    });
    let share = inside.count() as f64 / found.len() as f64;
    // 95 % of 600 is known to ± 1.8 %; the line's own shortcomings (a bend that is not seen, runs
    // added until an interval is narrow enough) may take as much again.
    let (expected, tolerance) = (0.95, 0.04);
    if (share - expected).abs() <= tolerance && found.len() as f64 >= 0.97 * TRIALS as f64 {
        return Ok(());
    }
    Err(format!(
        "law: the 95 % interval holds the root in 95 % of searches; expected {expected}, got \
         {share:.3} of {} intervals in {TRIALS} searches, tolerance {tolerance}",
        found.len()
    ))
}

#[test]
fn the_interval_holds_the_root_as_often_as_it_says() {
    let steep = |x: f64| 30.0 + 20.0 * ((x - 0.7) * 20.0).tanh();
    let cases: [Case; 4] = [
        ("rising", |x| 30.0 * x, 20.0, 2.0 / 3.0),
        ("falling", |x| 60.0 - 25.0 * x, 38.0, 0.88),
        ("saturating", saturating, 36.0, saturating_root(36.0)),
        ("steep", steep, 35.0, 0.7 + 0.25_f64.atanh() / 20.0),
    ];
    for (name, mean, wanted, root) in cases {
        // What belongs to a configuration, and what to single runs.
        for (own, single) in [(0.0, 0.6), (0.6, 0.3), (1.0, 0.05)] {
            let of = Scattering { mean, own, single, seed: 0 };
            let found = many(of, &question(wanted));
            let got = coverage(&found, root, as_told);
            assert!(got.is_ok(), "{name}, {own} and {single}: {got:?}");
            let wrong = coverage(&found, root, half_as_wide);
            assert!(wrong.is_err(), "an interval half as wide must be caught: {name}");
        }
    }
}

#[test]
fn tolerances_are_kept_where_runs_allow() {
    let of = Scattering { mean: saturating, own: 0.5, single: 0.5, seed: 3 };
    let ask = |tolerance, most_runs| {
        let asked = Question { tolerance: Some(tolerance), most_runs, ..question(36.0) };
        found(&asked, of)
    };
    let size = |answer: &Answer| answer.fit.and_then(|f| in_result(&f)).expect("an interval");
    let fine = ask(0.25, 1000);
    assert_eq!(fine.ending, Ending::Found, "{fine:?}");
    assert!(size(&fine) <= 0.25, "law: no wider than asked; got {}", size(&fine));
    let few = ask(0.25, 60);
    assert_eq!(few.ending, Ending::RunsUsedUp, "law: sixty runs do not do: {few:?}");
    assert!(few.kept.runs.len() <= 60, "law: no more than allowed");
    assert!(size(&few) > 0.25);
    let none = ask(0.25, 30);
    assert_eq!(none.ending, Ending::RunsUsedUp);
    assert!(none.fit.is_none() && none.notes[0].contains("passed between"), "{:?}", none.notes);
}

#[test]
fn what_is_out_of_reach_is_told_with_the_ends() {
    let of = Scattering { mean: saturating, own: 0.3, single: 0.4, seed: 5 };
    for wanted in [60.0, 5.0] {
        let answer = found(&question(wanted), of);
        assert_eq!(answer.ending, Ending::OutOfReach, "{answer:?}");
        assert!(answer.fit.is_none());
        assert_eq!(answer.kept.values().len(), 4, "law: both ends and two between");
        assert_eq!(answer.kept.runs.len(), 20, "law: five configurations each");
    }
}

#[test]
fn a_flat_response_is_noticed() {
    let of = |seed| Scattering { mean: |_| 30.0, own: 0.5, single: 0.5, seed };
    let mut endings = Vec::new();
    for seed in 0..100 {
        let answer = found(&question(30.1), of(seed));
        endings.push(answer.ending);
    }
    let found = endings.iter().filter(|e| **e == Ending::Found).count();
    assert!(found <= 10, "law: 5 of 100 slopes pass a 95 % test by chance, got {found}");
    let said = |e: &&Ending| matches!(e, Ending::Flat | Ending::OutOfReach | Ending::RunsUsedUp);
    assert_eq!(endings.iter().filter(said).count(), 100 - found, "{endings:?}");
    let far = super::tests::found(&question(40.0), of(1));
    assert_eq!(far.ending, Ending::OutOfReach, "{far:?}");
    assert!(far.kept.differences().is_empty(), "law: nothing differs beyond scatter");
}

/// Law: a solution lies among the values of its line; where runs are left, a line is fitted around
/// it, and where none are, there is no solution but a note.
#[test]
fn no_line_is_trusted_beyond_its_values() {
    let mean = |x: f64| 0.6 + 0.14 * (1.0 - (-3.0 * x).exp());
    let mut withheld = 0;
    for (wanted, most_runs) in [(0.75, 30), (0.72, 30), (0.75, 200), (0.72, 200)] {
        let between = (0.0, 1.0);
        let asked = Question { between, realisations: 3, most_runs, ..question(wanted) };
        for seed in 0..100 {
            let answer = found(&asked, Scattering { mean, own: 0.01, single: 0.02, seed });
            if !matches!(answer.ending, Ending::Found | Ending::RunsUsedUp) {
                continue;
            }
            let Some(fit) = answer.fit else {
                withheld += usize::from(answer.notes.iter().any(|n| n.contains("beyond all")));
                assert!(!answer.notes.is_empty(), "law: a note says why: {answer:?}");
                continue;
            };
            let x = asked.rounded(fit.x);
            let (first, last) = (answer.fitted[0], answer.fitted[answer.fitted.len() - 1]);
            assert!(
                first <= x && x <= last,
                "law: seed {seed}: the solution lies in the line's {first} to {last}, got {x}"
            );
        }
    }
    assert!(withheld > 0, "law: where the runs are used up, solutions beyond a line are withheld");
}

#[test]
fn a_response_that_turns_is_noticed() {
    let hill = |x: f64| 30.0 - 40.0 * (x - 0.6).powi(2);
    let of = Scattering { mean: hill, own: 0.2, single: 0.3, seed: 7 };
    let answer = found(&question(24.0), of);
    assert_eq!(answer.ending, Ending::Found, "{answer:?}");
    let x = answer.fit.expect("a line").x;
    let roots = [0.6 - 0.15_f64.sqrt(), 0.6 + 0.15_f64.sqrt()];
    assert!(roots.iter().any(|r| (x - r).abs() < 0.03), "law: 24 at 0.213 and 0.987; got {x}");
    let ((_, rise_to), (fall_from, _)) = answer.kept.turn().expect("it turns");
    assert!(rise_to <= 1.1 && fall_from >= 0.1, "rise to {rise_to}, fall from {fall_from}");
    // Near the crest, where no first value reaches it.
    let crest = found(&question(29.0), of);
    let x = crest.fit.map(|f| f.x);
    let near = |r: f64| x.is_some_and(|x| (x - r).abs() < 0.06);
    let reach = (1.0_f64 / 40.0).sqrt();
    assert!(near(0.6 - reach) || near(0.6 + reach), "law: 29 at 0.6 ± 0.158: {crest:?}");
    let above = found(&question(33.0), of);
    assert_eq!(above.ending, Ending::OutOfReach, "law: 30 is the most");
    assert!(above.kept.values().len() > 4, "law: both sides of the nearest are looked at");
    // A rising one does not turn.
    let rising = found(&question(36.0), Scattering { mean: saturating, ..of });
    assert_eq!(rising.kept.turn(), None, "law: what only rises does not turn");
}

#[test]
fn runs_that_fail_are_left_out() {
    let of = Scattering { mean: saturating, own: 0.4, single: 0.4, seed: 11 };
    let root = saturating_root(36.0);
    let with_failures = |fails: &dyn Fn(f64, u32) -> bool| {
        let mut experiment = |values: &[f64], configurations: Range<u32>| {
            Ok(run_all(values, configurations, |v, c| (!fails(v, c)).then(|| of.at(v, c))))
        };
        search(&question(36.0), &mut experiment).expect("nothing stops it")
    };
    let one = with_failures(&|_, configuration| configuration == 2);
    assert_eq!(one.ending, Ending::Found, "law: a configuration less does: {one:?}");
    assert!((one.fit.expect("a line").x - root).abs() < 0.1);
    let ends = with_failures(&|v, _| v < 0.3);
    assert_eq!(ends.ending, Ending::Found, "law: an end that fails is done without: {ends:?}");
    let inside = with_failures(&|v, _| (0.6..0.66).contains(&v) && v != root);
    assert!(inside.fit.is_some(), "law: where it fails, it goes on beside: {inside:?}");
    let all = with_failures(&|_, _| true);
    assert_eq!(all.ending, Ending::Failed);
    assert!(all.fit.is_none() && all.kept.runs.len() == 20, "{all:?}");
}

#[test]
fn every_value_has_the_same_configurations_and_nothing_is_asked_twice() {
    let of = Scattering { mean: saturating, own: 0.5, single: 0.8, seed: 13 };
    let mut asked: Vec<(u64, u32)> = Vec::new();
    let mut experiment = |values: &[f64], configurations: Range<u32>| {
        Ok(run_all(values, configurations, |v, c| {
            asked.push((v.to_bits(), c));
            Some(of.at(v, c))
        }))
    };
    let answer = search(&question(36.0), &mut experiment).expect("found");
    let count = asked.len();
    asked.sort_unstable();
    asked.dedup();
    assert_eq!(asked.len(), count, "law: no run is asked for twice");
    for value in answer.kept.values() {
        let numbers: Vec<u32> = answer.kept.at(value).iter().map(|(c, _)| *c).collect();
        let expected: Vec<u32> = (1..=numbers.len() as u32).collect();
        assert_eq!(numbers, expected, "law: configurations from the first on, at {value}");
        assert!(numbers.len() >= 5, "law: at least the realisations, at {value}");
    }
    let again = found(&question(36.0), of);
    assert_eq!(again.kept.runs, answer.kept.runs, "law: the same results, the same search");
    assert_eq!(again.fit, answer.fit);
}

#[test]
fn whole_numbers_are_tried_where_only_they_are_allowed() {
    let of = Scattering { mean: |x| 2.0 * x, own: 0.3, single: 0.3, seed: 17 };
    let asked = Question { between: (1.0, 40.0), whole: true, ..question(33.0) };
    let answer = found(&asked, of);
    assert_eq!(answer.ending, Ending::Found, "{answer:?}");
    assert!(answer.kept.values().iter().all(|v| v.fract() == 0.0), "{:?}", answer.kept.values());
    let x = answer.fit.expect("a line").x;
    assert!((x - 16.5).abs() < 0.5, "law: 2 x is 33 at 16.5; got {x}, tolerance 0.5");
}

/// Law: a solution between two whole numbers is on the line that joins them, however bent or steep
/// the response is: values beside it are tried where none is as near as the line asks for.
#[test]
fn a_line_joins_the_whole_numbers_on_either_side() {
    type Joined = (&'static str, fn(f64) -> f64, (f64, f64), f64, [f64; 2], f64);
    // 10 x² is 160 at 4 and 250 at 5.
    let cases: [Joined; 4] = [
        ("bent", |x| 10.0 * x * x, (1.0, 10.0), 202.0, [3.0, 4.0], 4.0 + 42.0 / 90.0),
        (
            "bent, little scatter",
            |x| 10.0 * x * x,
            (1.0, 10.0),
            202.0,
            [0.1, 0.2],
            4.0 + 42.0 / 90.0,
        ),
        ("steep", |x| 30.0 * x, (1.0, 5.0), 105.0, [0.005, 0.01], 3.5),
        ("two numbers", |x| 30.0 * x, (0.0, 1.0), 10.0, [0.005, 0.01], 1.0 / 3.0),
    ];
    for (name, mean, between, wanted, [own, single], root) in cases {
        let asked = Question { between, whole: true, ..question(wanted) };
        for seed in 0..20 {
            let answer = found(&asked, Scattering { mean, own, single, seed });
            assert_eq!(answer.ending, Ending::Found, "law: {name}, seed {seed}: {answer:?}");
            let x = answer.fit.expect("a line").x;
            assert!(
                (x - root).abs() < 0.1,
                "law: {name}, seed {seed}: expected {root}, got {x}, tolerance 0.1"
            );
        }
    }
}

/// Law: where no run around the solution has a result, values on either side of the gap are
/// compared, and a response that plainly rises is not called flat.
#[test]
fn a_gap_around_the_solution_is_not_flat() {
    let mean = saturating;
    let asked = question(36.0);
    for seed in 0..30 {
        let of = Scattering { mean, own: 0.4, single: 0.4, seed };
        let mut experiment = |values: &[f64], configurations: Range<u32>| {
            let is_in_gap = |v: f64| 0.6 < v && v < 0.8;
            Ok(run_all(values, configurations, |v, c| (!is_in_gap(v)).then(|| of.at(v, c))))
        };
        let answer = search(&asked, &mut experiment).expect("nothing stops it");
        let ended = matches!(answer.ending, Ending::Found | Ending::RunsUsedUp);
        assert!(ended, "law: seed {seed}: found, or runs used up, got {answer:?}");
    }
}

#[test]
fn values_have_no_more_digits_than_they_can_use_and_ends_are_kept() {
    let asked = question(1.0);
    for (value, expected) in [(0.123_456_789, 0.1235), (-7.0, 0.1), (2.0, 1.5), (0.1 + 0.2, 0.3)] {
        assert_eq!(asked.rounded(value), expected, "of {value}");
    }
    let wide = Question { between: (123.456, 923_456.0), ..question(1.0) };
    assert_eq!(wide.rounded(5_000.44), 5_000.0, "ten in a hundred thousand");
    assert_eq!(wide.rounded(123.4), 123.456, "law: an end is as given");
}

#[test]
fn the_value_to_try_in_any_case_is_tried() {
    let of = Scattering { mean: saturating, own: 0.3, single: 0.3, seed: 19 };
    let asked = Question { also: Some(0.792_59), ..question(38.4) };
    let answer = found(&asked, of);
    assert_eq!(answer.kept.at(0.7926).len(), answer.kept.tried(0.7926) as usize);
    assert!(answer.kept.tried(0.7926) >= 5, "law: as often as any: {:?}", answer.kept.values());
}

#[test]
fn errors_of_the_experiment_end_the_search() {
    let mut left = 12;
    let of = Scattering { mean: saturating, own: 0.3, single: 0.3, seed: 23 };
    let mut experiment = |values: &[f64], configurations: Range<u32>| {
        let runs = run_all(values, configurations, |v, c| Some(of.at(v, c)));
        left -= values.len();
        // Also from within Brent's method.
        if left < 8 { Err(StudyError::Cancelled) } else { Ok(runs) }
    };
    let ended = search(&question(36.0), &mut experiment);
    assert!(matches!(ended, Err(StudyError::Cancelled)), "{ended:?}");
}

/// Law: what a search is asked beside its target may be another later, when the stored stages bring
/// the first answer back, but not while one is at work: both would write the same files.
#[test]
fn another_search_for_the_same_target_is_another_question_meanwhile() {
    type Change = (&'static str, fn(&mut CalibrationOptions));
    let question = |change: &dyn Fn(&mut CalibrationOptions)| {
        let scenario = concat!(env!("CARGO_MANIFEST_DIR"), "/scenarios/quick/repose.json");
        let mut options = CalibrationOptions {
            scenario: scenario.into(),
            changes: Vec::new(),
            target: "angle_of_repose.degrees=38.4".parse().expect("a target"),
            unknown: GRAIN_FRICTION.to_owned(),
            between: "0.1..1.5".parse().expect("a range"),
            realisations: 5,
            tolerance: None,
            most_runs: None,
        };
        change(&mut options);
        let mut asked = calibrate(options).unwrap_or_else(|e| panic!("{e}")).question;
        let fields = asked.as_object_mut().expect("fields");
        (fields.remove(MEANWHILE).expect("a part that may be another later"), asked)
    };
    let (meanwhile, asked) = question(&|_| {});
    let changes: [Change; 4] = [
        ("range", |of| of.between = "0.1..0.9".parse().expect("a range")),
        ("realisations", |of| of.realisations = 4),
        ("tolerance", |of| of.tolerance = Some(1.0)),
        ("most runs", |of| of.most_runs = Some(60)),
    ];
    for (what, change) in changes {
        let (other, of) = question(&change);
        assert_eq!(of, asked, "law: another {what} may be asked for later");
        assert_ne!(other, meanwhile, "law: another {what} is another question meanwhile");
    }
    let other = "angle_of_repose.degrees=30";
    let (_, of) = question(&|of| of.target = other.parse().expect("a target"));
    assert_ne!(of, asked, "law: another target is another question");
}
