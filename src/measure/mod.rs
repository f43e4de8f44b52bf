//! What is read off a specimen: pure functions of a state, blind to engines.
//!
//! All results are in SI units; conversion to the units of result files is
//! left to `record`. Every measure that speaks of "the specimen in the
//! cylinder" takes its grains from [`Container::members`], so that height,
//! void ratio and coordination number always speak of the same grains.

mod bootstrap;
mod container;
mod content;
mod coordination;
mod energy;
mod estimate;
mod flow;
mod height_map;
mod hull;
pub mod inference;
mod interval;
mod inverse;
mod loads;
pub mod nested;
mod overlap;
mod pairs;
mod places;
mod plate;
mod profile;
mod raster;
mod region;
pub mod regression;
mod repose;
mod rotation;
mod separation;
mod settlement;
#[cfg(test)]
mod sphere_tests;
pub mod statistics;
mod stress;
mod students_t;
#[cfg(test)]
pub(crate) mod testing;

pub use bootstrap::bootstrap_interval;
pub use container::Container;
pub use content::{Content, Voids, content, mean_grain_height, void_ratio};
pub use coordination::{Coordination, coordination};
pub use energy::{Energy, body_energy, grain_energy, largest_speed};
pub use estimate::{Estimate, change_for_one_unit, paired_difference};
pub use flow::steady_rate;
pub use height_map::{HeightMap, StandingHeight, height_cell, height_cell_over};
pub use hull::WorldHull;
pub use interval::Interval;
pub use inverse::{InversePrediction, bend_pattern, inverse_prediction};
pub use loads::{
    FORCE_CLASS, Fabric, ForceDistribution, LoadedContact, contacts_of_grains_in, fabric,
    force_distribution, loaded_contacts, sliding_share,
};
pub use overlap::{OverlapStatistics, overlap_statistics};
pub use pairs::{PairGap, neighbours, pairs_within, pairs_within_of, touching_gap};
pub use places::fates;
pub use plate::{PlatePosition, plate_position};
pub use profile::{Slice, layers, rings};
pub use region::{grains_span, void_ratio_in};
pub use repose::{FLANK, PileSurface, Repose, Sector, base_level, over, pile_surface, pile_top};
pub use rotation::rotations;
pub use separation::{Separation, separation, separation_within};
pub use settlement::{EARLY_SHAKING, Settlement, settlement};
pub use stress::{Stress, stress_in};

// What its parts are made of, too.
use statrs::distribution::StudentsT;

use crate::geometry::{
    ConvexPolyhedron, MassProperties, Point, Pose, Sphere, Vector, cut, edges_of,
};
use crate::grains::GrainSet;
use crate::scale;
pub use crate::specimen::Region;
use crate::specimen::{Fate, Party, SavedContact, Specimen, SpecimenState};
use crate::world::BodyState;
use {hull::*, inference::*, raster::*, region::*, statistics::*};

/// Why something could not be measured, in a sentence.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct MeasureError(String);
