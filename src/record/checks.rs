//! What the checks of a stage and of a run found (docs/accuracy.md).

use super::*;
use crate::protocol::{Watch, Watched};

/// What the checks of one stage found.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StageChecks {
    /// How often every body was checked to be somewhere, with finite numbers.
    pub checks: u64,
    /// Grains that passed through a wall or a floor, or were found in one.
    pub through_walls: u32,
    /// Largest speed in m/s.
    pub speed: Watched,
    /// Unexplained energy gain in J.
    pub energy: Watched,
    /// Overlap of grains.
    pub overlap: OverlapWatch,
    /// Numerical creep: the rate at which the mean grain height sinks at rest, up or down, in µm/s.
    pub creep: Watched,
}

/// What was seen of the overlap of grains, in percent of the mean equivalent
/// diameter of the two.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct OverlapWatch {
    /// Mean over the overlapping pairs.
    pub mean: Watched,
    /// 99th percentile.
    pub p99: Watched,
    /// Time since the stage began at which the next look is due, in s.
    pub next_look_s: f64,
    /// Time since the stage began of the last look, in s.
    pub last_look_s: Option<f64>,
}

impl StageChecks {
    /// With what the stage itself watched, and the overlap.
    pub fn of(watch: &Watch, overlap: OverlapWatch, creep: Watched) -> Self {
        Self {
            checks: watch.checks,
            through_walls: watch.through_walls,
            speed: watch.speed,
            energy: watch.energy,
            overlap,
            creep,
        }
    }
}

/// `checks` of `summary.json`: what every check watched during a run, and
/// whether the run passed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Checks {
    /// Whether every check passed; null where a stage was stored before checks were.
    pub passed: Option<bool>,
    /// Stages that were stored before checks were, by name: nobody watched them.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub unwatched_stages: Vec<String>,
    /// Numbers of every body.
    pub finite: CheckSummary,
    /// Grains that the engine no longer holds.
    pub lost: CheckSummary,
    /// Grains that passed through a wall or a floor, or were found in one.
    pub through_walls: CheckSummary,
    /// Speeds.
    pub speed: CheckSummary,
    /// Unexplained energy gain.
    pub energy: CheckSummary,
    /// Mean overlap.
    pub overlap_mean: CheckSummary,
    /// 99th percentile of the overlap.
    pub overlap_p99: CheckSummary,
    /// Numerical creep at rest.
    pub creep: CheckSummary,
    /// How well the contacts were solved; null in summaries from before it was watched.
    pub solver_residual: Option<CheckSummary>,
}

impl Checks {
    /// Every check with its name.
    pub fn each(&self) -> Vec<(&'static str, &CheckSummary)> {
        let mut each = vec![
            ("finite", &self.finite),
            ("lost", &self.lost),
            ("through_walls", &self.through_walls),
            ("speed", &self.speed),
            ("energy", &self.energy),
            ("overlap_mean", &self.overlap_mean),
            ("overlap_p99", &self.overlap_p99),
            ("creep", &self.creep),
        ];
        each.extend(self.solver_residual.as_ref().map(|check| ("solver_residual", check)));
        each
    }

    /// In a line: `8 of 8 passed`, or which did not.
    pub fn line(&self) -> String {
        let beyond: Vec<&str> =
            self.each().iter().filter(|(_, g)| g.passed == Some(false)).map(|(n, _)| *n).collect();
        let seen = self.each().iter().filter(|(_, g)| g.passed.is_some()).count();
        let unwatched = match self.unwatched_stages.as_slice() {
            [] => String::new(),
            stages => format!("; not watched, being stored before: {}", stages.join(", ")),
        };
        if beyond.is_empty() {
            format!("{seen} of {seen} passed{unwatched}")
        } else {
            format!("NOT passed: {} of {seen}, {}{unwatched}", beyond.len(), beyond.join(", "))
        }
    }
}

/// One check of a run.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CheckSummary {
    /// What it watches.
    pub watches: String,
    /// Unit of `worst` and `limit`.
    pub unit: String,
    /// How often it looked.
    pub looks: u64,
    /// The value that came nearest to its limit, or went farthest beyond; null
    /// where nobody looked.
    pub worst: Option<f64>,
    /// The limit it was compared with.
    pub limit: Option<f64>,
    /// When that was, in s since the run began; null where no time belongs to it.
    pub worst_at_s: Option<f64>,
    /// When the limit was first exceeded; null where it was not.
    pub first_beyond_s: Option<f64>,
    /// Whether the limit was kept; null where nobody looked.
    pub passed: Option<bool>,
}

impl CheckSummary {
    /// Of what nobody looked at.
    fn unseen(watches: &str, unit: &str, looks: u64) -> Self {
        Self { watches: watches.to_owned(), unit: unit.to_owned(), looks, ..Self::default() }
    }

    /// Of a quantity that was watched.
    pub fn of(watches: &str, unit: &str, watched: &Watched) -> Self {
        let seen = |value: f64| (watched.looks > 0).then_some(value);
        Self {
            worst: seen(watched.worst),
            limit: seen(watched.limit),
            worst_at_s: seen(watched.worst_at_s),
            first_beyond_s: watched.first_beyond_s,
            passed: watched.passed(),
            ..Self::unseen(watches, unit, watched.looks)
        }
    }

    /// Of one figure over all looks, at most `limit`; `None` where there were no looks.
    pub fn at_most(watches: &str, limit: f64, figure: Option<f64>, looks: u64) -> Self {
        Self {
            worst: figure,
            limit: figure.map(|_| limit),
            passed: figure.map(|figure| figure <= limit),
            ..Self::unseen(watches, "", looks)
        }
    }

    /// Of what must not be at all: how often it was found, and in how many looks.
    pub fn none_of(watches: &str, unit: &str, found: u32, looks: u64) -> Self {
        let found = (looks > 0).then_some(f64::from(found));
        Self { unit: unit.to_owned(), ..Self::at_most(watches, 0.0, found, looks) }
    }
}
