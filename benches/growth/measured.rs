//! What is measured of a world with one specimen: what its steps take, and how much memory it
//! holds.

use std::fmt;

use clap::ValueEnum;
use pluvia::{motion::TableMotion, world::PhaseTimes};
use serde::{Deserialize, Serialize};

/// Steps measured: half a cycle of the shaking.
const MEASURED: usize = 80;

/// Steps measured of a pour, up to half a second from its beginning.
const POURED: usize = 192;

/// What a specimen goes through.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ValueEnum)]
#[serde(rename_all = "snake_case")]
#[value(rename_all = "snake_case")]
pub enum State {
    /// It is left alone.
    Rest,
    /// It is on the table, 3 Hz and ±25 mm.
    Shaken,
    /// The lid of the filled funnel is gone.
    Pour,
    /// Shaken, while every core has something else to do.
    ShakenBusy,
    /// Shaken, with one core for all threads.
    ShakenOneCore,
}

impl fmt::Display for State {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.to_possible_value().expect("none is skipped").get_name())
    }
}

impl State {
    /// How the table moves.
    pub fn motion(self) -> Option<TableMotion> {
        let shaking = TableMotion::sine(0.025, 3.0, 1e6);
        (!matches!(self, Self::Rest | Self::Pour)).then_some(shaking)
    }

    /// How many steps are measured.
    pub fn steps(self) -> usize {
        if self == Self::Pour { POURED } else { MEASURED }
    }
}

/// Wall time of a step in s.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
pub struct Step {
    /// Broadphase, collision, solver, integration.
    pub phases: [f64; 4],
    /// All of it, where the next two were measured.
    pub whole: f64,
    /// Of that, what threads can share.
    pub shared: f64,
    /// What `shared` would take on 2, 8 and 16 threads.
    pub shared_on: [(u32, f64); 3],
}

impl Step {
    /// The one between these times.
    pub fn between(before: &PhaseTimes, after: &PhaseTimes) -> Self {
        let phases = [
            after.broadphase_s - before.broadphase_s,
            after.collision_s - before.collision_s,
            after.solver_s - before.solver_s,
            after.integration_s - before.integration_s,
        ];
        Self {
            phases,
            whole: phases.iter().sum(),
            shared: after.shared_s - before.shared_s,
            shared_on: std::array::from_fn(|n| {
                let (threads, time) = after.shared_on_s[n];
                (threads, time - before.shared_on_s[n].1)
            }),
        }
    }

    /// All of it.
    pub fn took(&self) -> f64 {
        self.phases.iter().sum()
    }

    /// Of the same step in two worlds that begin alike, the shorter time of each phase; and what
    /// threads can share of the shorter one.
    pub fn shorter(&self, other: &Self) -> Self {
        let phases = std::array::from_fn(|n| self.phases[n].min(other.phases[n]));
        Self { phases, ..if other.whole < self.whole { *other } else { *self } }
    }
}

/// What a process that measures says.
#[derive(Debug, Serialize, Deserialize)]
pub struct Measured {
    pub grains: usize,
    pub rate_hz: f64,
    /// Points that bear something, at the end.
    pub contacts_per_grain: f64,
    /// Of the world alone; `None` where the system does not tell.
    pub memory_kib_per_grain: Option<f64>,
    pub steps: Vec<Step>,
}

/// Time of all steps in s.
pub fn sum(steps: &[Step]) -> f64 {
    steps.iter().map(Step::took).sum()
}
