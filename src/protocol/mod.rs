//! The laboratory procedure: stages that take a specimen and give a specimen.
//!
//! A stage builds a fresh world from the specimen it is given, runs it and reads it back, so that
//! it does not matter whether the specimen came straight from the stage before or from a file. A
//! long stage does the same between its segments.

mod base;
mod bodies;
mod course;
mod ending;
#[cfg(test)]
mod ending_tests;
mod feeder;
mod free_pieces;
#[cfg(test)]
mod free_tests;
mod laboratory;
#[cfg(test)]
mod laboratory_tests;
mod mean_stress;
#[cfg(test)]
mod mean_stress_tests;
mod pieces;
#[cfg(test)]
mod pile_tests;
mod placing;
mod plausible;
#[cfg(test)]
mod press_tests;
mod progress;
#[cfg(test)]
mod segment_tests;
mod segments;
mod setup;
mod solids;
mod stages;
mod staging;
mod stand;
#[cfg(test)]
mod testing;
#[cfg(test)]
mod tests;
mod watch;
#[cfg(test)]
mod watch_tests;
mod watched;
mod whereabouts;

pub use base::{base_pieces, friction_between, pairs};
pub use bodies::{free_grain, remembered, spring_energy, wall_piece};
pub use ending::{Judged, UntilFound, opening};
pub use mean_stress::{KeptStress, region};
pub use plausible::plausible;
pub use progress::{Progress, Silent, Work};
pub use segments::{Midway, segments};
pub use setup::{SettleCriterion, Setup};
pub use stages::run;
pub use watch::{EnergyBalance, Watch};
pub use watched::Watched;

pub use crate::world::WorldMaker;

// What its parts are made of, too.
use std::borrow::Cow;
use std::collections::HashMap;
use std::ops::ControlFlow;
use std::time::Duration;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::apparatus::{
    ApparatusError, Cylinder, Funnel, Piece, RigidPiece, TopPlate, depth_in_others, stands_in,
};
use crate::geometry::{Point, Pose, Vector};
use crate::grains::streams::{in_unit_disc, stream, uniform};
use crate::grains::{Grain, GrainSet, grain_name};
use crate::motion::TableMotion;
use crate::scenario::{EngineSettings, StageSpec};
use crate::specimen::{
    Fate, Other, Party, PieceState, PressState, SavedContact, Specimen, SpecimenState,
};
use crate::units::{from_g, from_mm};
use crate::world::{
    Body, BodyId, BodyState, EffectiveSettings, HeldShape, Material, Motion, PairTable,
    RunTimeCheck, Snapshot, WorldError,
};
use crate::{grains, scale};
use {
    bodies::*, course::*, ending::*, feeder::*, free_pieces::*, mean_stress::*, pieces::*,
    placing::*, plausible::*, segments::*, solids::*, staging::*, stand::*, watch::*,
    whereabouts::*,
};

/// Sees the specimen at regular times: how series are recorded.
pub trait Observer {
    /// Called at the start of a stage, then every sample interval, then at its end.
    fn observe(&mut self, specimen: &Specimen, moment: Moment);

    /// Called at every look and at the end of a stage, in s since it began, however finely or coarsely
    /// it is sampled; after what was observed there.
    fn look(&mut self, _specimen: &Specimen, _stage_time: f64) {}

    /// Called at the end of every segment but the last, after what was observed there, with what
    /// the stage can go on from. `Break` ends the stage as if it had been cancelled.
    fn seam(&mut self, _midway: &Midway) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }

    /// Called when a grain that was waiting is let go at a place in m.
    fn let_go(&mut self, _grain: usize, _at: &Vector) {}

    /// Called when a check finds what a reader should know at once.
    fn warn(&mut self, _finding: &str) {}
}

/// Sees nothing.
impl Observer for () {
    fn observe(&mut self, _: &Specimen, _: Moment) {}
}

/// When and in what motion of the table an observation is made.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Moment {
    /// Time since the stage began, in s.
    pub stage_time: f64,
    /// Velocity of the table in m/s.
    pub table_velocity: Vector,
    /// What was given and taken since the stage began.
    pub balance: EnergyBalance,
}

/// What a stage leaves beside its specimen.
#[derive(Debug, Clone, PartialEq)]
pub struct StageOutcome {
    /// The specimen at the end.
    pub specimen: Specimen,
    /// Every grain's shape as the engine held it at the end, in the order of the grain set; `None`
    /// for a grain that was not there, all missing where the engine cannot be asked.
    pub corners: Vec<Option<HeldShape>>,
    /// Engine steps taken.
    pub steps: u64,
    /// Simulated time in s.
    pub simulated: f64,
    /// Wall time inside the engine.
    pub engine_time: Duration,
    /// How a pour, a pile, a plate or a vibration came to rest; none of another stage.
    pub settling: Option<Settling>,
    /// How far grains sank that were let go above a surface; none of another stage.
    pub fall: Option<Fall>,
    /// What came of the condition that was to end it; none of a stage without one.
    pub until: Option<UntilFound>,
    /// Findings a reader must know.
    pub warnings: Vec<String>,
    /// What was watched about its motion.
    pub watch: Watch,
    /// Solver residuals, one a look (see `World::solver_residual`); none of an
    /// engine that does not say.
    pub residuals: Vec<f64>,
    /// The engine's settings as read back.
    pub effective: EffectiveSettings,
}

/// How a specimen came to rest: after the last period of a vibration, with the table at its place;
/// or in a stage that pours it, piles it up or lays the plate on it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Settling {
    /// Time in s from the end of shaking, or the beginning of another stage or of its last part,
    /// to the end of the stage: with what was held to count as settled, or the limit.
    pub time_s: f64,
    /// The limit in s.
    pub limit_s: f64,
    /// Whether it settled by the scenario's criterion.
    pub settled: bool,
}

/// How far the centroids of grains sank from where they were let go to where they lay at the end of
/// the stage: the fall, and what they rolled and sank after it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Fall {
    /// Mean in mm.
    pub mean_mm: f64,
    /// The largest in mm.
    pub largest_mm: f64,
}

/// Why a stage did not finish.
#[derive(Debug, thiserror::Error)]
pub enum StageError {
    /// The apparatus cannot be built.
    #[error(transparent)]
    Apparatus(#[from] ApparatusError),
    /// Grains could not be placed.
    #[error("the grains could not be placed: {0}")]
    Placing(String),
    /// The stage does not fit the specimen it was given.
    #[error("stage `{stage}` cannot follow here: {reason}")]
    OutOfOrder {
        /// The stage.
        stage: &'static str,
        /// What it needs.
        reason: Cow<'static, str>,
    },
    /// The world failed; the last state found good is kept.
    #[error("{source}")]
    World {
        /// What happened.
        source: WorldError,
        /// The specimen as it was when last checked; of a stage that had begun, without contacts.
        last_good: Box<Specimen>,
    },
    /// Asked to stop.
    #[error("stopped on request")]
    Cancelled,
}
