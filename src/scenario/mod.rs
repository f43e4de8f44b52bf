//! The scenario file: what is done in the laboratory, in the user's terms.
//!
//! [`Scenario`] is the typed content of a file after `extends` has been
//! resolved and everything has been validated ([`load_with`]). Numbers are kept in
//! the units people typed; the modules that use them convert to SI through
//! [`crate::units`].

/// Functions by which serde knows what a field is where it is left out, one a line.
macro_rules! defaults {
    ($($of:vis $name:ident: $type:ty = $value:expr;)*) => {
        $($of fn $name() -> $type {
            $value
        })*
    };
}

/// A group of settings, each with its default.
macro_rules! settings {
    ($(#[$of:meta])* pub struct $name:ident {
        $($(#[$about:meta])* pub $field:ident: $type:ty = $default:expr,)*
    }) => {
        $(#[$of])*
        pub struct $name {
            $($(#[$about])* pub $field: $type,)*
        }

        impl Default for $name {
            fn default() -> Self {
                Self { $($field: $default,)* }
            }
        }
    };
}

mod accessors;
mod automatic;
mod begin;
mod begun;
mod by_load;
mod cells;
mod engine;
mod fault;
mod faulty_grains;
mod index_densities;
mod load;
mod mean_stress;
mod meant;
mod mesh_pieces;
mod meshes;
mod motion_file;
mod native;
mod overrides;
mod pieces;
mod rapier;
mod renamed;
mod schema;
mod sized;
mod sizes_of_pieces;
mod source;
mod stages;
mod stock;
mod stress;
mod structure;
mod until;
mod unusual;
mod validate;

pub use automatic::Grading;
pub use begin::BeginSpec;
pub use cells::{CellShape, LEAST_ROUNDING, SievedShape};
pub use engine::{Backend, ContactSolver, EngineSettings};
pub use fault::{Fault, ScenarioErrors, nearest};
pub use index_densities::IndexDensitiesSpec;
pub use load::{GradingOf, Loaded, Readers, check, gathered, load_grains_with, load_with};
pub use mean_stress::KeepMeanStressSpec;
pub use meant::MeantStage;
pub use mesh_pieces::{MOST_PARTS, MeshPart, MeshPieceSpec, PartsOf};
pub use meshes::{MeshGrains, MeshUnit};
pub use native::{NativeSettings, automatic_threads};
pub use overrides::{NotAnOverride, Override};
pub use pieces::*;
pub use rapier::{FrictionModel, RapierSettings};
pub use schema::{document_schema, load_document, schema};
pub use stages::*;
pub use stock::{InertiaRule, StockSettings};
pub use until::{AllOfSpec, ConditionSpec, UntilSpec};
pub use validate::{Warning, warnings};

// What its parts are made of, too.
use std::f64::consts::PI;
use std::path::{Path, PathBuf};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value, json};

use crate::geometry::Vector;
use crate::input;
use crate::motion::{Interpolation, RecordedMotion};
use crate::scale::{Law, Scale};
use crate::units::{from_g, from_mm, to_mm};
use accessors::read;
use load::unusable;
use {automatic::*, by_load::*, fault::*, sized::*, source::*, stress::*};

/// One laboratory procedure: grains, apparatus, contact properties, engine
/// settings and the stages run one after the other.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Scenario {
    /// Name of the scenario; run folders and results carry it.
    #[schemars(length(min = 1, max = 100))]
    pub name: String,
    /// What the scenario is for, in a sentence or two.
    #[serde(default)]
    pub description: String,
    /// Why values that the source does not give were chosen; for the reader, shown in the report.
    #[serde(default)]
    pub notes: Vec<String>,
    /// A specimen of another run that the stages begin with. Everything but name, description,
    /// notes and stages may be left out then, and is as in that run.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub begin: Option<BeginSpec>,
    /// The grains.
    pub grains: GrainsSpec,
    /// Funnel, cylinder, top plate.
    #[serde(default)]
    pub apparatus: ApparatusSpec,
    /// Pieces of a user-defined apparatus, in place of funnel, cylinder and top plate.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schemars(length(max = 100))]
    pub pieces: Vec<PieceSpec>,
    /// What is measured of such an apparatus beside the forces on its pieces.
    #[serde(default, skip_serializing_if = "MeasuresSpec::is_empty")]
    pub measures: MeasuresSpec,
    /// Loosest and densest state of the grains; with them the summary gives relative densities.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub index_densities: Option<IndexDensitiesSpec>,
    /// Friction and restitution of each pair of surfaces.
    #[serde(default)]
    pub contact: ContactSpec,
    /// Physics engine and its settings.
    #[serde(default)]
    pub engine: EngineSettings,
    /// When a specimen counts as settled.
    #[serde(default)]
    pub settle: SettleSpec,
    /// Gravitational acceleration in m/s², acting along -z.
    #[serde(default = "default_gravity")]
    #[schemars(extend("exclusiveMinimum" = 0.0, "maximum" = 100.0))]
    pub gravity_m_per_s2: f64,
    /// Seed of every random stream (grain shapes, arrangement).
    #[serde(default = "default_seed")]
    #[schemars(extend("maximum" = u64::MAX))]
    pub seed: u64,
    /// Which random arrangement of the grains is used, counted from 1: another
    /// number gives another order and other orientations (paper, section 3:
    /// "three different initial configurations ... obtained by additional mixing").
    #[serde(default = "default_configuration")]
    #[schemars(range(min = 1, max = 1_000_000))]
    pub configuration: u32,
    /// What is done, in order.
    #[schemars(length(min = 1, max = 100))]
    pub stages: Vec<StageSpec>,
    /// Length in seconds of the rest test that measures how far the
    /// finished specimen creeps when nothing moves; 0 leaves it out.
    #[serde(default = "default_rest_test")]
    #[schemars(range(min = 0.0, max = 600.0))]
    pub rest_test_s: f64,
    /// Sizes, density and number of grains that have no sieve table, as they were found
    /// when the scenario was loaded; it is no part of what is written.
    #[serde(skip)]
    #[schemars(skip)]
    pub found: Option<Grading>,
}

defaults! {
    default_gravity: f64 = 9.81;
    default_seed: u64 = 1;
    default_configuration: u32 = 1;
    default_rest_test: f64 = 2.0;
}

/// Where the grains come from: cut from sieve data, read from a file, or with
/// the shapes of meshes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum GrainsSpec {
    /// By sieve fractions: Voronoi cells cut from one cube per fraction, or spheres.
    Sieved(SievedGrains),
    /// A `grains.json` as `pluvia grains` writes it.
    File(GrainsFile),
    /// Grains as OBJ, STL or PLY meshes.
    Meshes(MeshGrains),
}

/// Grains generated from a sieve analysis (paper, section 3).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SievedGrains {
    /// Mass of all grains together, in grams.
    #[schemars(extend("exclusiveMinimum" = 0.0, "maximum" = 1e9))]
    pub total_mass_g: f64,
    /// Density of the solids, in kg/m³.
    #[schemars(extend("exclusiveMinimum" = 0.0, "maximum" = 30000.0))]
    pub density_kg_per_m3: f64,
    /// Sieve fractions, coarsest first; each fraction's `retained_mm` is the
    /// next one's `passing_mm`, and the mass percentages add up to 100.
    #[schemars(length(min = 1, max = 100))]
    pub sieve_table: Vec<SieveFraction>,
    /// What the grains are; left out, cells.
    #[serde(default, skip_serializing_if = "SievedShape::is_default")]
    pub shape: SievedShape,
    /// Shape of the cells that the grains are cut into; not of spheres.
    #[serde(default)]
    pub cells: CellShape,
}

/// What passes one sieve and stays on the next.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SieveFraction {
    /// Opening of the sieve that the fraction passes, in mm.
    #[schemars(extend("exclusiveMinimum" = 0.0, "maximum" = 10000.0))]
    pub passing_mm: f64,
    /// Opening of the sieve that retains the fraction, in mm.
    #[schemars(extend("exclusiveMinimum" = 0.0, "maximum" = 10000.0))]
    pub retained_mm: f64,
    /// Share of the total mass, in percent.
    #[schemars(extend("exclusiveMinimum" = 0.0, "maximum" = 100.0))]
    pub mass_percent: f64,
}

/// Grains read from a file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct GrainsFile {
    /// Path of a `grains.json`, relative to the scenario file that names it;
    /// once loaded, relative to the working directory.
    #[schemars(length(min = 1))]
    pub file: String,
}

/// The apparatus. Everything the paper gives is in the defaults; the rest is ours.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct ApparatusSpec {
    /// The container.
    pub cylinder: CylinderSpec,
    /// The funnel above it.
    pub funnel: FunnelSpec,
    /// The loading plate laid on the grains before vibration.
    pub top_plate: TopPlateSpec,
}

settings! {
    /// The cylindrical container (paper, section 2: 11.5 cm × 20 cm, inside).
    #[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
    #[serde(deny_unknown_fields, default)]
    pub struct CylinderSpec {
        /// Inner diameter in mm.
        #[schemars(extend("exclusiveMinimum" = 0.0, "maximum" = 10000.0))]
        pub inner_diameter_mm: f64 = 115.0,
        /// Inner height in mm.
        #[schemars(extend("exclusiveMinimum" = 0.0, "maximum" = 10000.0))]
        pub height_mm: f64 = 200.0,
        /// Number of flat wall pieces; the polygon has the circle's area.
        #[schemars(range(min = 12, max = 256))]
        pub wall_pieces: u32 = 48,
        /// Thickness of wall pieces and floor in mm.
        #[schemars(range(min = 0.001, max = 10000.0))]
        pub wall_thickness_mm: f64 = 20.0,
    }
}

settings! {
    /// The funnel, a cone with a cylindrical collar on top. The paper's figure of it was not
    /// available to us (only its text was), and the text gives no size: all numbers are ours.
    #[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
    #[serde(deny_unknown_fields, default)]
    pub struct FunnelSpec {
        /// Diameter of the bottom opening in mm.
        #[schemars(extend("exclusiveMinimum" = 0.0, "maximum" = 10000.0))]
        pub opening_diameter_mm: f64 = 80.0,
        /// Diameter of the top of the cone in mm.
        #[schemars(extend("exclusiveMinimum" = 0.0, "maximum" = 10000.0))]
        pub top_diameter_mm: f64 = 260.0,
        /// Angle of the cone's wall from the vertical, in degrees.
        #[schemars(range(min = 1.0, max = 89.0))]
        pub half_angle_deg: f64 = 30.0,
        /// Number of flat wall pieces.
        #[schemars(range(min = 12, max = 256))]
        pub wall_pieces: u32 = 32,
        /// Thickness of the wall pieces and the lid in mm.
        #[schemars(range(min = 0.001, max = 10000.0))]
        pub wall_thickness_mm: f64 = 20.0,
    }
}

settings! {
    /// The top plate (paper, section 2: 11.3 cm × 1 cm, 104 g).
    #[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
    #[serde(deny_unknown_fields, default)]
    pub struct TopPlateSpec {
        /// Diameter in mm.
        #[schemars(range(min = 0.001, max = 10000.0))]
        pub diameter_mm: f64 = 113.0,
        /// Thickness in mm.
        #[schemars(range(min = 0.001, max = 10000.0))]
        pub thickness_mm: f64 = 10.0,
        /// Mass in g.
        #[schemars(range(min = 0.001, max = 1e9))]
        pub mass_g: f64 = 104.0,
        /// Number of sides of the polygonal plate; it has the circle's area.
        #[schemars(range(min = 12, max = 256))]
        pub sides: u32 = 48,
    }
}

settings! {
    /// Friction and restitution. These are values of the *pair* of surfaces: what
    /// the contact gets, with no rule of combination in between.
    #[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
    #[serde(deny_unknown_fields, default)]
    pub struct ContactSpec {
        /// Coulomb friction coefficient between grains (paper, section 3: 0.793).
        #[schemars(range(min = 0.0, max = 10.0))]
        pub grain_grain_friction: f64 = 0.793,
        /// Coulomb friction coefficient between grains and walls, floor, funnel and lid (ours).
        #[schemars(range(min = 0.0, max = 10.0))]
        pub grain_wall_friction: f64 = 0.5,
        /// Coulomb friction coefficient between grains and top plate (ours).
        #[schemars(range(min = 0.0, max = 10.0))]
        pub grain_plate_friction: f64 = 0.5,
        /// Coulomb friction coefficient between top plate and cylinder wall (ours).
        #[schemars(range(min = 0.0, max = 10.0))]
        pub plate_wall_friction: f64 = 0.2,
        /// Coefficient of restitution of every pair (paper, section 3: 0.315).
        #[schemars(range(min = 0.0, max = 1.0))]
        pub restitution: f64 = 0.315,
    }
}

settings! {
    /// When a specimen counts as settled (ours; the paper only says "settled in a
    /// static state"): the root mean square speed of grains and plate stays below
    /// one limit and every speed below another for a while.
    #[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
    #[serde(deny_unknown_fields, default)]
    pub struct SettleSpec {
        /// Largest root mean square speed in mm/s.
        #[schemars(extend("exclusiveMinimum" = 0.0, "maximum" = 1e6))]
        pub rms_speed_mm_per_s: f64 = 20.0,
        /// Largest speed of any grain in mm/s: one that still falls or flows.
        #[schemars(extend("exclusiveMinimum" = 0.0, "maximum" = 1e6))]
        pub largest_speed_mm_per_s: f64 = 500.0,
        /// How long both must hold, in s.
        #[schemars(range(min = 0.0, max = 60.0))]
        pub hold_s: f64 = 0.25,
    }
}
