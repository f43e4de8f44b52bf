//! The search on functions with scatter, whose roots are known.

use std::ops::Range;

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use statrs::distribution::{ContinuousCDF, Normal};

use super::{
    kept::Kept,
    search::{Answer, Question, search},
};
use crate::report::{CalibrationEnding as Ending, CalibrationRun};
use crate::study::StudyError;

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
        value,
        configuration,
        run: format!("at-{value}-c{configuration}"),
        result,
        wall_s: None,
        failure: result.is_none().then(|| "it blew up".to_owned()),
    }
}

fn question(wanted: f64) -> Question {
    Question {
        wanted,
        between: (0.1, 1.5),
        replicates: 5,
        tolerance: None,
        most_runs: 80,
        whole: false,
        also: None,
    }
}

fn found(question: &Question, of: Scattering) -> Answer {
    let mut experiment = |values: &[f64], configurations: Range<u32>| {
        let of_value = |v: &f64| {
            let v = *v;
            configurations.clone().map(move |n| run(v, n + 1, Some(of.at(v, n + 1))))
        };
        Ok(values.iter().flat_map(of_value).collect())
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

#[test]
fn without_scatter_roots_are_found() {
    let cases: [(&str, fn(f64) -> f64, f64, f64); 5] = [
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

/// How often the interval holds the root, and how often there is one.
fn coverage(of: Scattering, wanted: f64, root: f64, change: fn(&mut Question)) -> (f64, f64) {
    const TRIALS: u64 = 600;
    let (mut inside, mut with) = (0.0, 0.0);
    let (mut left, mut runs, mut width) = (0, 0, 0.0);
    for seed in 0..TRIALS {
        let mut question = question(wanted);
        change(&mut question);
        let answer = found(&question, Scattering { seed, ..of });
        runs += answer.kept.runs.len();
        let Some((low, high)) = answer.fit.and_then(|f| f.interval) else { continue };
        with += 1.0;
        inside += f64::from(u8::from(low <= root && root <= high));
        left += u32::from(high < root);
        width += high - low;
    }
    println!(
        "coverage {:.3} with {:.3} below {:.3} runs {:.1} width {:.4}",
        inside / with,
        with / TRIALS as f64,
        f64::from(left) / with,
        runs as f64 / TRIALS as f64,
        width / with
    );
    (inside / with, with / TRIALS as f64)
}

#[test]
fn try_coverage() {
    let means: [(&str, fn(f64) -> f64, f64, f64); 4] = [
        ("line", |x| 30.0 * x, 20.0, 2.0 / 3.0),
        ("saturating", saturating, 36.0, saturating_root(36.0)),
        ("falling", |x| 60.0 - 25.0 * x, 38.0, 0.88),
        ("steep", |x| 30.0 + 20.0 * ((x - 0.7) * 20.0).tanh(), 35.0, 0.7 + 0.25_f64.atanh() / 20.0),
    ];
    for (name, mean, wanted, root) in means {
        for (own, single) in [(0.0, 0.6), (0.6, 0.3), (0.3, 1.2), (1.0, 0.05)] {
            for (what, change) in [
                ("5", (|_| {}) as fn(&mut Question)),
                ("3", |q| q.replicates = 3),
                ("10", |q| q.replicates = 10),
            ] {
                print!("{name} own {own} single {single} n {what}: ");
                coverage(Scattering { mean, own, single, seed: 0 }, wanted, root, change);
            }
        }
    }
    let _ = Kept::default();
    let _: Option<StudyError> = None;
}
