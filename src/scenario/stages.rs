//! The stages a scenario can name.

use super::*;
use crate::motion::Start;

/// What the stated amplitude of a sinusoid means.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum StrokeKind {
    /// Amplitude in the physicist's sense: the table moves ± the amplitude.
    HalfStroke,
    /// The table moves by the amplitude from end to end.
    FullStroke,
}

/// How the table moves along x within a period of vibration.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum WaveformKind {
    /// x(t) = A sin(2πft), or from the turning point A (1 − cos(2πft)).
    #[default]
    Sine,
    /// A crank of radius A drives the table by a rod: `crank_to_rod` says how long that is.
    SliderCrank,
    /// As recorded: `motion_file`, or its rows in `motion_rows`.
    File,
}

/// What a pile stands on.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum BaseKind {
    /// A dense layer of the scenario's own grains, in random orientations, each
    /// fixed to a floor into which it is sunk to half of its height: a surface
    /// as rough as the pile itself. Its friction is that between grains.
    #[default]
    FixedGrains,
    /// A flat floor of stated friction.
    Plane,
}

parts! {
/// A vertical component of the table's motion, z(t) = A (sin(2πft + φ) − sin φ).
#[derive(Copy)]
pub struct VerticalSpec {
    /// Amplitude A in mm, half of the stroke.
    pub amplitude_mm: f64, from 0.0 to 1000.0;
    /// Frequency f in Hz; that of the horizontal motion where it is left out. A period holds a
    /// whole number of its cycles.
    pub frequency_hz: Option<f64>, skip "Option::is_none", above 0.0 to 1000.0;
    /// Phase φ in degrees.
    pub phase_deg: f64, or default, schemars(range(min = -360.0, max = 360.0));
}

/// A table that is set from pose to pose, each in one engine step, in which it covers the whole
/// displacement, and stands still in the others: as an animation program moves a body once a
/// video frame.
#[derive(Copy)]
pub struct VideoFramesSpec {
    /// Poses in a second.
    pub frames_per_s: f64, above 0.0 to 10000.0;
}

/// The base of a pile; the paper only says "rough".
#[derive(Default)]
pub struct BaseSpec {
    /// What it is made of.
    pub kind: BaseKind;
    /// Coulomb friction coefficient between grains and the floor: a `plane` needs it,
    /// `fixed_grains` have that between grains.
    pub friction: Option<f64>, skip "Option::is_none", from 0.0 to 10.0;
}
}

/// One step of the laboratory procedure.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "stage", rename_all = "snake_case", deny_unknown_fields)]
#[allow(clippy::large_enum_variant)] // a scenario has a handful of stages
pub enum StageSpec {
    /// Mix the grains, pour them into the closed funnel, let them settle.
    FillFunnel {
        /// Ends when the grains have settled, at the latest after this time.
        #[serde(default = "fill_limit")]
        #[schemars(extend("exclusiveMinimum" = 0.0, "maximum" = 600.0))]
        time_limit_s: f64,
    },
    /// Feed the grains one by one, slowly and from low above the pile, onto a
    /// base until all of them lie on it at rest (paper, section 2: "slow
    /// pluviation tests on a rough surface"). It takes neither funnel nor
    /// cylinder; every number of it is ours.
    SlowPluviation(SlowPluviationSpec),
    /// Remove the lid and let the grains fall into the cylinder.
    Pour {
        /// Distance between the bottom of the funnel and the top of the cylinder in mm.
        #[schemars(range(min = 0.0, max = 10000.0))]
        falling_height_mm: f64,
        /// Ends when the grains have settled, at the latest after this time.
        #[serde(default = "pour_limit")]
        #[schemars(extend("exclusiveMinimum" = 0.0, "maximum" = 600.0))]
        time_limit_s: f64,
    },
    /// Lay the top plate on the grains without dynamic effects.
    PlaceTopPlate(PlaceTopPlateSpec),
    /// Shake the table, then let everything come to rest.
    Vibrate(VibrateSpec),
    /// Let grains that are waiting fall into the laboratory: all of them, or as many as are
    /// asked for, from above an area. It may be done again and again, in layers.
    Deposit(DepositSpec),
    /// Move pieces as prescribed, then let everything come to rest where that is asked for.
    Move(MoveSpec),
    /// Press pieces: each moves along one direction alone, by a force along it and by what the
    /// grains do, and does so in all later stages until it is pressed otherwise, moved, locked or
    /// removed. Native contacts of Bullet alone can do this.
    Press(PressSpec),
    /// Let pieces go: from now on each moves freely, by its weight and by contacts with grains and
    /// with all other pieces, in all later stages until it is pressed, locked, moved or removed.
    Release(ReleaseSpec),
    /// Take pieces away, a gate for instance, and let the grains flow until everything has
    /// settled.
    Remove(RemoveSpec),
    /// Wait with nothing moving.
    Rest {
        /// Length in s.
        #[schemars(extend("exclusiveMinimum" = 0.0, "maximum" = 3600.0))]
        duration_s: f64,
    },
}

parts! {
/// Fields of [`StageSpec::SlowPluviation`].
#[schemars(description = "")] // that of the stage stands in the schema
pub struct SlowPluviationSpec {
    /// Grains let go in a second. A grain waits where the one before it is
    /// still in its way.
    pub feed_rate_grains_per_s: f64, else "feed_rate", above 0.0 to 10000.0;
    /// Distance in mm from the present top of the pile up to the sphere
    /// around a grain that is let go: the spout rises with the pile.
    pub drop_height_mm: f64, else "drop_height", from 0.0 to 10000.0;
    /// Diameter in mm of the disc about the axis within which the centres
    /// of grains are let go.
    pub spout_diameter_mm: f64, else "spout_diameter", from 0.0 to 10000.0;
    /// What the pile stands on.
    pub base: BaseSpec, or default;
    /// Diameter of the base in mm. Grains that roll over its edge fall off,
    /// are taken away and counted.
    pub base_diameter_mm: f64, above 0.0 to 10000.0;
    /// Ends when all grains have been fed and have settled, at the latest
    /// after this time.
    pub time_limit_s: f64, else "slow_limit", above 0.0 to 3600.0;
}

/// Fields of [`StageSpec::PlaceTopPlate`].
#[schemars(description = "")] // that of the stage stands in the schema
pub struct PlaceTopPlateSpec {
    /// Ends when plate and grains have settled, at the latest after this time; a plate that
    /// is seated settles three times, each at the latest after it.
    pub time_limit_s: f64, else "place_limit", above 0.0 to 600.0;
    /// Which placement of the plate: 0 lays it on the axis, unturned; every other number
    /// draws a horizontal offset and a rotation about the vertical of its own, from a random
    /// stream of the seed, the configuration and this number.
    pub placement: u32, or default, schemars(range(max = 1_000_000));
    /// Largest offset in mm that is drawn, uniformly on a disc; left out, 0.8 of the
    /// clearance between plate and cylinder. Not with placement 0.
    pub offset_mm: Option<f64>, skip "Option::is_none", from 0.0 to 10000.0;
    /// Largest rotation in degrees that is drawn, uniformly to either side. Not with placement 0.
    pub rotation_deg: f64, else "half_turn", from 0.0 to 180.0;
    /// Load in N with which the plate is seated: once it has settled, a weight of so much is
    /// laid on it, everything settles, the weight is taken off, and everything settles
    /// again. 0: the plate is only laid.
    pub seating_load_n: f64, or default, from 0.0 to 10000.0;
}

/// Fields of [`StageSpec::Vibrate`].
#[schemars(description = "")] // that of the stage stands in the schema
pub struct VibrateSpec {
    /// How the table moves along x within a period.
    pub waveform: WaveformKind, or default;
    /// Where a sine or a slider-crank begins.
    pub start: Start, or default;
    /// Frequency in Hz; must be given but for a recorded motion.
    pub frequency_hz: Option<f64>, skip "Option::is_none", above 0.0 to 1000.0;
    /// Amplitude in mm; must be given but for a recorded motion.
    pub amplitude_mm: Option<f64>, skip "Option::is_none", from 0.0 to 1000.0;
    /// Whether the amplitude is half or the full stroke.
    pub stroke: StrokeKind, else "half_stroke";
    /// Length of one period of vibration in s; must be given but for a recorded motion.
    pub duration_s: Option<f64>, skip "Option::is_none", above 0.0 to 3600.0;
    /// Number of periods of vibration.
    pub periods: u32, else "one", from 1 to 1000;
    /// Rest after each period but the last of several, in s.
    pub rest_s: f64, or default, from 0.0 to 3600.0;
    /// Time in which the amplitude grows from nothing at the beginning of each period, along
    /// half a cosine, and dies away at its end, in s; 0: the table starts and stops as the
    /// waveform does.
    pub ramp_s: f64, or default, from 0.0 to 1800.0;
    /// Radius of the crank over the length of the rod, of a `slider_crank`.
    pub crank_to_rod: Option<f64>, skip "Option::is_none", above 0.0 to 0.5;
    /// Path of a recorded motion, relative to the scenario file that names it: a CSV with the
    /// columns `time_s`, `x_mm` and optionally `y_mm` and `z_mm`, of at most 100 000 rows.
    /// Displacement and time are counted from the first row; the last must be where the
    /// first is. Once loaded, its rows stand in `motion_rows`.
    pub motion_file: Option<String>, skip "Option::is_none", schemars(length(min = 1));
    /// Rows of a recorded motion, in place of a file: time in s, x, y and z in mm.
    pub motion_rows: Option<Vec<[f64; 4]>>, skip "Option::is_none", length 2 to 100_000;
    /// How a recorded displacement goes between two rows; left out, `cubic`.
    pub interpolation: Option<Interpolation>, skip "Option::is_none";
    /// What the table does along z beside that; of a recorded motion, a column does.
    pub vertical: Option<VerticalSpec>, skip "Option::is_none";
    /// Sets the table from video frame to video frame instead of moving it all the time.
    pub video_frames: Option<VideoFramesSpec>, skip "Option::is_none";
    /// Longest time in s in which, after the last period, everything comes to rest with
    /// the table at its place; the stage ends when it has settled, at the latest after this.
    pub settle_limit_s: f64, else "settle_limit", above 0.0 to 600.0;
}

/// Fields of [`StageSpec::Deposit`].
#[schemars(description = "")] // that of the stage stands in the schema
pub struct DepositSpec {
    /// Whether they rain at a rate, or begin at rest on a lattice.
    pub how: DepositKind, or default;
    /// Middle of the area in mm. Grains begin at its height, those of a lattice from
    /// there upwards.
    pub at_mm: [f64; 3];
    /// Sizes of a rectangular area along x and y in mm.
    pub area_mm: Option<[f64; 2]>, skip "Option::is_none", schemars(inner(range(max = 10000.0)));
    /// Diameter of a round area in mm, in place of `area_mm`.
    pub diameter_mm: Option<f64>, skip "Option::is_none", above 0.0 to 10000.0;
    /// Lets the height of a rain follow the grains that lie there: the sphere around a grain begins
    /// so far in mm above where it would meet that around another, and nowhere below `at_mm`. Left
    /// out, all begin at the height of `at_mm`.
    pub above_surface_mm: Option<f64>, skip "Option::is_none", above 0.0 to 10000.0;
    /// Mass in g that is let go in a second; rain needs it. A grain waits where others
    /// are still in its way.
    pub rate_g_per_s: Option<f64>, skip "Option::is_none", above 0.0 to 1e9;
    /// Mass in g of the layer; left out, all that is waiting.
    pub mass_g: Option<f64>, skip "Option::is_none", above 0.0 to 1e9;
    /// Takes only grains of the sieve fractions that lie between these two openings in mm,
    /// the finer first: a layer of grains of its own.
    pub sizes_mm: Option<[f64; 2]>, skip "Option::is_none";
    /// Ends when all of them have been let go and everything has settled, at the latest
    /// after this time.
    pub time_limit_s: f64, else "deposit_limit", above 0.0 to 3600.0;
    /// Largest speed in m/s at which native contacts push an overlap apart in this stage; other
    /// contacts do not read it. Left out, it is that of `engine.native`. Where that is automatic
    /// and larger because of a load, deposits before the first load have the speed without a load;
    /// loads on a specimen that is begun with count. One that is typed for the engine holds in
    /// deposits, too, with a warning if it is more than 4 times as large.
    pub max_depenetration_velocity_m_per_s: Option<f64>, skip "Option::is_none", above 0.0 to 100.0;
}

/// Fields of [`StageSpec::Move`].
#[schemars(description = "")] // that of the stage stands in the schema
pub struct MoveSpec {
    /// Names of the pieces that move as one; left out, all that stand and are neither pressed nor
    /// free.
    pub pieces: Vec<String>, skip "Vec::is_empty", schemars(length(max = 100));
    /// Velocity along x, y and z in mm/s.
    pub velocity_mm_per_s: Option<[f64; 3]>, skip "Option::is_none",
        schemars(inner(range(min = -1e7, max = 1e7)));
    /// A turn about an axis, in place of a velocity.
    pub rotation: Option<RotationSpec>, skip "Option::is_none";
    /// A sine, in place of a velocity.
    pub sine: Option<SineSpec>, skip "Option::is_none";
    /// Path of a recorded motion, in place of a velocity: a CSV as that of a vibration, whose
    /// last row may be anywhere. Once loaded, its rows stand in `motion_rows`.
    pub motion_file: Option<String>, skip "Option::is_none", schemars(length(min = 1));
    /// Rows of a recorded motion, in place of a file: time in s, x, y and z in mm.
    pub motion_rows: Option<Vec<[f64; 4]>>, skip "Option::is_none", length 2 to 100_000;
    /// How a recorded displacement goes between two rows; left out, `cubic`.
    pub interpolation: Option<Interpolation>, skip "Option::is_none";
    /// How long they move, in s; or `travel_mm`, `travel_deg` or `until`.
    pub duration_s: Option<f64>, skip "Option::is_none", above 0.0 to 3600.0;
    /// The displacement in mm after which a velocity ends.
    pub travel_mm: Option<f64>, skip "Option::is_none", above 0.0 to 100000.0;
    /// The angle in degrees after which a rotation ends.
    pub travel_deg: Option<f64>, skip "Option::is_none", above 0.0 to 1e6;
    /// What ends the motion: from when it holds on, the motion dies away within its ramp. A
    /// sine without a ramp ends with its cycle.
    pub until: Option<UntilSpec>, skip "Option::is_none";
    /// Time in s after which a motion with `until` ends if that does not hold before.
    pub time_limit_s: Option<f64>, skip "Option::is_none", above 0.0 to 3600.0;
    /// Time in s in which the motion grows from nothing along half a cosine, and dies
    /// away at its end; 0: it starts and stops abruptly.
    pub ramp_s: f64, or default, from 0.0 to 1800.0;
    /// Longest time in s in which everything comes to rest afterwards; 0: the stage ends
    /// with the motion.
    pub settle_limit_s: f64, or default, from 0.0 to 600.0;
    /// Changes the forces on pressed pieces all the time, so that the mean stress in a region
    /// stays what it was when the stage began; left out, they keep their forces. Native
    /// contacts of Bullet alone can do this.
    pub keep_mean_stress: Option<KeepMeanStressSpec>, skip "Option::is_none";
}

/// Fields of [`StageSpec::Press`].
#[schemars(description = "")] // that of the stage stands in the schema
pub struct PressSpec {
    /// One load per piece.
    pub loads: Vec<LoadSpec>, length 1 to 100;
    /// Time in s in which a force grows from what it was to what is wanted, once the piece
    /// meets grains.
    pub ramp_s: f64, else "press_ramp", from 1e-9 to 1800.0;
    /// Speed in mm/s at most with which a piece comes to the grains: until the whole force is
    /// on it, it moves no faster.
    pub approach_mm_per_s: f64, else "approach", above 0.0 to 10000.0;
    /// What ends the stage before that.
    pub until: Option<UntilSpec>, skip "Option::is_none";
    /// Ends when the forces are what is wanted and everything has settled, at the latest
    /// after this time.
    pub time_limit_s: f64, else "deposit_limit", above 0.0 to 3600.0;
}

/// Fields of [`StageSpec::Release`].
#[schemars(description = "")] // that of the stage stands in the schema
pub struct ReleaseSpec {
    /// Names of the pieces.
    pub pieces: Vec<String>, length 1 to 100;
    /// Mass in g of each; left out, that of the piece in aluminium, 2700 kg/m³.
    pub mass_g: Option<f64>, skip "Option::is_none", above 0.0 to 1e9;
    /// What ends the stage before everything has settled.
    pub until: Option<UntilSpec>, skip "Option::is_none";
    /// Ends when everything has settled, at the latest after this time.
    pub time_limit_s: f64, else "deposit_limit", above 0.0 to 3600.0;
}

/// Fields of [`StageSpec::Remove`].
#[schemars(description = "")] // that of the stage stands in the schema
pub struct RemoveSpec {
    /// Names of the pieces.
    pub pieces: Vec<String>, length 1 to 100;
    /// What ends the stage before everything has settled.
    pub until: Option<UntilSpec>, skip "Option::is_none";
    /// Ends when everything has settled, at the latest after this time.
    pub time_limit_s: f64, else "deposit_limit", above 0.0 to 3600.0;
}
}

defaults! {
    pub(super) fill_limit: f64 = 4.0;
    pub(super) feed_rate: f64 = 25.0;
    pub(super) drop_height: f64 = 10.0;
    pub(super) spout_diameter: f64 = 30.0;
    pub(super) slow_limit: f64 = 120.0;
    pub(super) pour_limit: f64 = 6.0;
    pub(super) deposit_limit: f64 = 10.0;
    pub(super) place_limit: f64 = 1.5;
    pub(super) settle_limit: f64 = 2.0;
    pub(super) half_turn: f64 = 180.0;
    pub(super) press_ramp: f64 = 0.2;
    pub(super) approach: f64 = 50.0;
    half_stroke: StrokeKind = StrokeKind::HalfStroke;
    one: u32 = 1;
}
