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

/// Declares parts of the scenario file. Behind the type of a field stands what it may be, in this
/// order:
/// - `= v`: its default is v; of a struct either every field has one, or none (see `default_of`);
/// - `or default`: it may be left out, and is the default of its type then;
/// - `else "f"`: it may be left out, and is f() then;
/// - `skip "f"`: it may be left out, and is not written where f of it holds;
/// - `above a to b`: a number greater than a and at most b;
/// - `from a to b`: a number of at least a and at most b;
/// - `length a to b`: of a text or a list;
/// - `schemars(...)`: other limits, as schemars has them.
macro_rules! parts {
    ($(
        $(#[$of:meta])*
        pub struct $name:ident {$(
            $(#[$about:meta])*
            pub $field:ident: $type:ty
                $(= $value:expr)?
                $(, or $zero:tt)?
                $(, else $default:tt)?
                $(, skip $skip:tt)?
                $(, above $over:tt to $top:tt)?
                $(, from $low:tt to $high:tt)?
                $(, length $short:tt to $long:tt)?
                $(, schemars($($limits:tt)*))?;
        )*}
    )*) => {$(
        #[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
        #[serde(deny_unknown_fields)]
        $(#[$of])*
        pub struct $name {$(
            $(#[$about])*
            $(#[serde($zero)])?
            $(#[serde(default = $default)])?
            $(#[serde(default, skip_serializing_if = $skip)])?
            $(#[schemars(extend("exclusiveMinimum" = $over, "maximum" = $top))])?
            $(#[schemars(range(min = $low, max = $high))])?
            $(#[schemars(length(min = $short, max = $long))])?
            $(#[schemars($($limits)*)])?
            pub $field: $type,
        )*}

        default_of! { $name $($field $(= $value)?;)* }
    )*};
}

/// The default of a struct whose fields all have one; nothing for others.
macro_rules! default_of {
    ($name:ident $($field:ident = $value:expr;)*) => {
        impl Default for $name {
            fn default() -> Self {
                Self { $($field: $value,)* }
            }
        }
    };
    ($name:ident $($other:tt)*) => {};
}

mod accessors;
mod automatic;
mod begin;
mod begun;
mod by_load;
mod by_motion;
mod calm;
mod cells;
mod engine;
mod fault;
mod faulty_grains;
mod fields;
mod filled_numbers;
mod grading;
mod index_densities;
mod json_text;
mod load;
mod loads_of_pieces;
mod meant;
mod mesh_pieces;
mod meshes;
mod motion_file;
mod named_files;
mod native;
mod other_files;
mod overlapping_pieces;
mod overrides;
mod percentages;
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
mod volumes_of_pieces;
mod wide_deposits;

pub use begin::BeginSpec;
pub use cells::{CellShape, LEAST_ROUNDING, SievedShape};
pub use engine::{Backend, ContactSolver, EngineSettings};
pub use fault::{Fault, ScenarioErrors, nearest};
pub use grading::Grading;
pub use index_densities::IndexDensitiesSpec;
pub use load::{GradingOf, Loaded, Readers, check, gathered, load_grains_with, load_with};
pub use meant::MeantStage;
pub use mesh_pieces::{MOST_PARTS, MeshPart, MeshPieceSpec, PartsOf};
pub use meshes::{MeshGrains, MeshUnit};
pub use native::{NativeSettings, automatic_threads};
pub use overlapping_pieces::OverlapsOf;
pub use overrides::{NotAnOverride, Override};
pub use pieces::*;
pub use rapier::{FrictionModel, RapierSettings};
pub use renamed::{of_earlier_version, renamed_field, renamed_result};
pub use schema::{document_schema, load_document, schema};
pub use stages::*;
pub use stock::{InertiaRule, StockSettings};
pub use until::{AllOfSpec, ConditionSpec, UntilSpec};
pub use validate::{is_of_coarse_steps, warnings};

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
use fields::{elements, field, field_path, number_at, pointer, read, stages_of};
use {
    automatic::*, by_load::*, by_motion::*, calm::*, fault::*, filled_numbers::*, grading::*,
    loads_of_pieces::*, sized::*, source::*, stress::*,
};

parts! {
/// One laboratory procedure: grains, apparatus, contact properties, engine
/// settings and the stages run one after the other.
pub struct Scenario {
    /// Name of the scenario; run folders and results carry it.
    pub name: String, length 1 to 100;
    /// What the scenario is for, in a sentence or two.
    pub description: String, or default;
    /// Why values that the source does not give were chosen; for the reader, shown in the report.
    pub notes: Vec<String>, or default;
    /// A specimen of another run that the stages begin with. Everything but name, description,
    /// notes and stages may be left out then, and is as in that run.
    pub begin: Option<BeginSpec>, skip "Option::is_none";
    /// The grains.
    pub grains: GrainsSpec;
    /// Funnel, cylinder, top plate.
    pub apparatus: ApparatusSpec, or default;
    /// Pieces of a user-defined apparatus, in place of funnel, cylinder and top plate.
    pub pieces: Vec<PieceSpec>, skip "Vec::is_empty", schemars(length(max = 100));
    /// What is measured of such an apparatus beside the forces on its pieces.
    pub measures: MeasuresSpec, skip "MeasuresSpec::is_empty";
    /// Loosest and densest state of the grains; with them the summary gives relative densities.
    pub index_densities: Option<IndexDensitiesSpec>, skip "Option::is_none";
    /// Friction and restitution of each pair of surfaces.
    pub contact: ContactSpec, or default;
    /// Physics engine and its settings.
    pub engine: EngineSettings, or default;
    /// When a specimen counts as settled.
    pub settle: SettleSpec, or default;
    /// Gravitational acceleration in m/s², acting along -z.
    pub gravity_m_per_s2: f64, else "default_gravity", above 0.0 to 100.0;
    /// Seed of every random stream (grain shapes, arrangement).
    pub seed: u64, else "default_seed", schemars(extend("maximum" = u64::MAX));
    /// Which random arrangement of the grains is used, counted from 1: another
    /// number gives another order and other orientations (paper, section 3:
    /// "three different initial configurations ... obtained by additional mixing").
    pub configuration: u32, else "default_configuration", from 1 to 1_000_000;
    /// What is done, in order.
    pub stages: Vec<StageSpec>, length 1 to 100;
    /// Length in seconds of the rest test, which measures the numerical creep
    /// of the finished specimen when nothing moves; 0 leaves it out.
    pub rest_test_s: f64, else "default_rest_test", from 0.0 to 600.0;
    /// Interval in seconds between the rows of `series.csv`, and between frames: at least one step of
    /// the engine and, above 0.08 s, at most a quarter of each rest. Left out, it is 0.08 s. Grains
    /// move the same whatever it is.
    pub sample_interval_s: Option<f64>, skip "Option::is_none", above 0.0 to 10.0;
    /// Sizes, density and number of grains that have no sieve table, as they were found
    /// when the scenario was loaded; it is no part of what is written.
    #[serde(skip)]
    #[schemars(skip)]
    pub found: Option<Grading>;
}
}

/// Whether a value is that of a scenario that says nothing of it.
fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}

defaults! {
    default_gravity: f64 = 9.81;
    default_seed: u64 = 1;
    default_configuration: u32 = 1;
    default_rest_test: f64 = 2.0;
}

/// Interval between samples in s where a scenario gives none (paper, section 4: "continuously
/// monitored every 0.08 seconds").
pub const SAMPLE_INTERVAL: f64 = 0.08;

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

parts! {
/// Grains generated from a sieve analysis (paper, section 3).
pub struct SievedGrains {
    /// Mass of all grains together, in grams.
    pub total_mass_g: f64, above 0.0 to 1e9;
    /// Density of the solids, in kg/m³: from that of expanded polystyrene, one of the lightest solids,
    /// so that a value in g/cm³ is refused.
    pub density_kg_per_m3: f64, from 10.0 to 30000.0;
    /// Sieve fractions, coarsest first; each fraction's `retained_mm` is the
    /// next one's `passing_mm`. The mass percentages add up to 100, but for half of the last digit
    /// that is typed in each row (of 0.1 where all are whole), and are scaled to 100 exactly.
    pub sieve_table: Vec<SieveFraction>, length 1 to 100;
    /// What the grains are; left out, cells.
    pub shape: SievedShape, skip "is_default";
    /// Shape of the cells that the grains are cut into; not of spheres.
    pub cells: CellShape, or default;
}

/// What passes one sieve and stays on the next.
#[derive(Copy)]
pub struct SieveFraction {
    /// Opening of the sieve that the fraction passes, in mm.
    pub passing_mm: f64, above 0.0 to 10000.0;
    /// Opening of the sieve that retains the fraction, in mm.
    pub retained_mm: f64, above 0.0 to 10000.0;
    /// Share of the total mass, in percent; 0 where nothing stays between the sieves, as in a
    /// gap-graded soil.
    pub mass_percent: f64, from 0.0 to 100.0;
}

/// Grains read from a file.
pub struct GrainsFile {
    /// Path of a `grains.json`, relative to the scenario file that names it;
    /// once loaded, relative to the working directory.
    pub file: String, schemars(length(min = 1));
}

/// The apparatus. Everything the paper gives is in the defaults; the rest is ours.
#[derive(Default)]
#[serde(default)]
pub struct ApparatusSpec {
    /// The container.
    pub cylinder: CylinderSpec;
    /// The funnel above it.
    pub funnel: FunnelSpec;
    /// The loading plate laid on the grains before vibration.
    pub top_plate: TopPlateSpec;
}

/// The cylindrical container (paper, section 2: diameter 11.5 cm and height 20 cm, which we read
/// as inside).
#[serde(default)]
pub struct CylinderSpec {
    /// Inner diameter in mm.
    pub inner_diameter_mm: f64 = 115.0, above 0.0 to 10000.0;
    /// Inner height in mm.
    pub height_mm: f64 = 200.0, above 0.0 to 10000.0;
    /// Number of flat wall pieces; the polygon has the circle's area.
    pub wall_pieces: u32 = 48, from 12 to 256;
    /// Thickness of wall pieces and floor in mm.
    pub wall_thickness_mm: f64 = 20.0, from 0.001 to 10000.0;
}

/// The funnel, a cone with a cylindrical collar on top. The paper's figure of it was not
/// available to us (only its text was), and the text gives no size: all numbers are ours.
#[serde(default)]
pub struct FunnelSpec {
    /// Diameter of the bottom opening in mm.
    pub opening_diameter_mm: f64 = 80.0, above 0.0 to 10000.0;
    /// Diameter of the top of the cone in mm.
    pub top_diameter_mm: f64 = 260.0, above 0.0 to 10000.0;
    /// Angle of the cone's wall from the vertical, in degrees.
    pub half_angle_deg: f64 = 30.0, from 1.0 to 89.0;
    /// Number of flat wall pieces.
    pub wall_pieces: u32 = 32, from 12 to 256;
    /// Thickness of the wall pieces and the lid in mm.
    pub wall_thickness_mm: f64 = 20.0, from 0.001 to 10000.0;
}

/// The top plate (paper, section 2: 11.3 cm × 1 cm, 104 g).
#[serde(default)]
pub struct TopPlateSpec {
    /// Diameter in mm.
    pub diameter_mm: f64 = 113.0, from 0.001 to 10000.0;
    /// Thickness in mm.
    pub thickness_mm: f64 = 10.0, from 0.001 to 10000.0;
    /// Mass in g.
    pub mass_g: f64 = 104.0, from 0.001 to 1e9;
    /// Number of sides of the polygonal plate; it has the circle's area.
    pub sides: u32 = 48, from 12 to 256;
}

/// Friction and restitution. These are values of the *pair* of surfaces: what
/// the contact gets, with no rule of combination in between.
#[serde(default)]
pub struct ContactSpec {
    /// Coulomb friction coefficient between grains (paper, section 3: 0.793).
    pub grain_grain_friction: f64 = 0.793, from 0.0 to 10.0;
    /// Coulomb friction coefficient between grains and walls, floor, funnel and lid (ours).
    pub grain_wall_friction: f64 = 0.5, from 0.0 to 10.0;
    /// Coulomb friction coefficient between grains and top plate (ours).
    pub grain_plate_friction: f64 = 0.5, from 0.0 to 10.0;
    /// Coulomb friction coefficient between top plate and cylinder wall (ours).
    pub plate_wall_friction: f64 = 0.2, from 0.0 to 10.0;
    /// Coefficient of restitution of every pair (paper, section 3: 0.315).
    pub restitution: f64 = 0.315, from 0.0 to 1.0;
}

/// When a specimen counts as settled (ours; the paper only says "settled in a
/// static state"): the root mean square speed of grains and plate stays below
/// one limit and every speed below another for a while. With slow pluviation the automatic speeds
/// are a quarter and a tenth of these.
#[serde(default)]
pub struct SettleSpec {
    /// Largest root mean square speed in mm/s.
    pub rms_speed_mm_per_s: f64 = 20.0, above 0.0 to 1e6;
    /// Largest speed of any grain in mm/s: one that still falls or flows.
    pub largest_speed_mm_per_s: f64 = 500.0, above 0.0 to 1e6;
    /// How long both must hold, in s.
    pub hold_s: f64 = 0.25, from 0.0 to 60.0;
}
}
