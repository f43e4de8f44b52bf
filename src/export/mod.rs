//! What a run left, for other programs: the exchange format that other engines read, tables, meshes
//! of everything in its place, and how it moved for ParaView and Blender.

mod apparatus;
mod exchange;
mod glb;
mod moments;
mod parts;
mod playback;
mod run_folder;
mod solids;
mod tables;
#[cfg(test)]
pub(crate) mod testing;
mod vtk;

pub use apparatus::{Carrier, StandingPiece, standing};
pub use exchange::{
    ApparatusPiece, Damping, ExchangeContact, ExchangeGrain, FORMAT, MadeBy, PairValue, Place,
    PlateBody, Scene, SceneError, Table, TableLaw, TableSamples, VERSION, VERSION_OF_SAMPLES,
};
pub use glb::{Glb, GlbTooLarge, glb};
pub use moments::{DEFAULT_EVERY, Moment, Moments, StageMoments, as_state, read_moments};
pub use parts::{Part, PartKind, parts};
pub use playback::{Playback, PlayedStage, read_playback};
pub use run_folder::{ExportError, Exported, read_at_rest, read_run, refuse_no_run, stage_at_rest};
pub use solids::{apparatus_obj, grains_obj, grains_ply, grains_stl};
pub use tables::{contacts_csv, grains_csv, pairs_csv};
pub use vtk::{VTK_LISTS, VtkFiles, write_vtk};

// What its parts are made of, too.
use std::path::Path;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use crate::apparatus::{ApparatusError, Funnel, Piece};
use crate::geometry::{ConvexPolyhedron, Pose, Vector};
use crate::grains;
use crate::grains::{GrainSet, grain_name};
use crate::motion::TableMotion;
use crate::protocol::{Setup, base_pieces};
pub use crate::record::FramesRead;
use crate::record::{FileError, Frame, StageStore, run_file};
use crate::scenario::Scenario;
use crate::specimen::{Fate, GrainState, Other, Party, SavedContact, Specimen, SpecimenState};
use crate::world::{BodyState, Material};
use {apparatus::party_name, run_folder::*};
