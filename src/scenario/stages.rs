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

/// A vertical component of the table's motion, z(t) = A (sin(2πft + φ) − sin φ).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct VerticalSpec {
    /// Amplitude A in mm, half of the stroke.
    #[schemars(range(min = 0.0, max = 1000.0))]
    pub amplitude_mm: f64,
    /// Frequency f in Hz; that of the horizontal motion where it is left out. A period holds a
    /// whole number of its cycles.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0.0, "maximum" = 1000.0))]
    pub frequency_hz: Option<f64>,
    /// Phase φ in degrees.
    #[serde(default)]
    #[schemars(range(min = -360.0, max = 360.0))]
    pub phase_deg: f64,
}

/// A table that is set from pose to pose, each in one engine step, in which it has the speed
/// of the whole way, and stands still in the others: as an animation program moves a body once
/// a video frame.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct VideoFramesSpec {
    /// Poses in a second.
    #[schemars(extend("exclusiveMinimum" = 0.0, "maximum" = 10000.0))]
    pub frames_per_s: f64,
}

/// What a pile stands on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum BaseKind {
    /// A dense layer of the scenario's own grains, in random orientations, each
    /// fixed to a floor into which it is sunk to half of its height: a surface
    /// as rough as the pile itself. Its friction is that between grains.
    FixedGrains,
    /// A flat floor of stated friction.
    Plane,
}

/// The base of a pile; the paper only says "rough".
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BaseSpec {
    /// What it is made of.
    pub kind: BaseKind,
    /// Coulomb friction coefficient between grains and the floor: a `plane` needs it,
    /// `fixed_grains` have that between grains.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0, max = 10.0))]
    pub friction: Option<f64>,
}

impl Default for BaseSpec {
    fn default() -> Self {
        Self { kind: BaseKind::FixedGrains, friction: None }
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
    SlowPluviation {
        /// Grains let go in a second. A grain waits where the one before it is
        /// still in its way.
        #[serde(default = "feed_rate")]
        #[schemars(extend("exclusiveMinimum" = 0.0, "maximum" = 10000.0))]
        feed_rate_grains_per_s: f64,
        /// Distance in mm from the present top of the pile up to the sphere
        /// around a grain that is let go: the spout rises with the pile.
        #[serde(default = "drop_height")]
        #[schemars(range(min = 0.0, max = 10000.0))]
        drop_height_mm: f64,
        /// Diameter in mm of the disc about the axis within which the centres
        /// of grains are let go.
        #[serde(default = "spout_diameter")]
        #[schemars(range(min = 0.0, max = 10000.0))]
        spout_diameter_mm: f64,
        /// What the pile stands on.
        #[serde(default)]
        base: BaseSpec,
        /// Diameter of the base in mm. Grains that roll over its edge fall off,
        /// are taken away and counted.
        #[schemars(extend("exclusiveMinimum" = 0.0, "maximum" = 10000.0))]
        base_diameter_mm: f64,
        /// Ends when all grains have been fed and have settled, at the latest
        /// after this time.
        #[serde(default = "slow_limit")]
        #[schemars(extend("exclusiveMinimum" = 0.0, "maximum" = 3600.0))]
        time_limit_s: f64,
    },
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
    PlaceTopPlate {
        /// Ends when plate and grains have settled, at the latest after this time; a plate that
        /// is seated settles three times, each at the latest after it.
        #[serde(default = "place_limit")]
        #[schemars(extend("exclusiveMinimum" = 0.0, "maximum" = 600.0))]
        time_limit_s: f64,
        /// Which placement of the plate: 0 lays it on the axis, unturned; every other number
        /// draws a horizontal offset and a rotation about the vertical of its own, from a random
        /// stream of the seed, the configuration and this number.
        #[serde(default)]
        #[schemars(range(max = 1_000_000))]
        placement: u32,
        /// Largest offset in mm that is drawn, uniformly on a disc; left out, 0.8 of the
        /// clearance between plate and cylinder. Not with placement 0.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(range(min = 0.0, max = 10000.0))]
        offset_mm: Option<f64>,
        /// Largest rotation in degrees that is drawn, uniformly to either side. Not with placement 0.
        #[serde(default = "half_turn")]
        #[schemars(range(min = 0.0, max = 180.0))]
        rotation_deg: f64,
        /// Load in N with which the plate is seated: once it has settled, a weight of so much is
        /// laid on it, everything settles, the weight is taken off, and everything settles
        /// again. 0: the plate is only laid.
        #[serde(default)]
        #[schemars(range(min = 0.0, max = 10000.0))]
        seating_load_n: f64,
    },
    /// Shake the table, then let everything come to rest.
    Vibrate {
        /// How the table moves along x within a period.
        #[serde(default)]
        waveform: WaveformKind,
        /// Where a sine or a slider-crank begins.
        #[serde(default)]
        start: Start,
        /// Frequency in Hz; must be given but for a recorded motion.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(extend("exclusiveMinimum" = 0.0, "maximum" = 1000.0))]
        frequency_hz: Option<f64>,
        /// Amplitude in mm; must be given but for a recorded motion.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(range(min = 0.0, max = 1000.0))]
        amplitude_mm: Option<f64>,
        /// Whether the amplitude is half or the full stroke.
        #[serde(default = "half_stroke")]
        stroke: StrokeKind,
        /// Length of one period of vibration in s; must be given but for a recorded motion.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(extend("exclusiveMinimum" = 0.0, "maximum" = 3600.0))]
        duration_s: Option<f64>,
        /// Number of periods of vibration.
        #[serde(default = "one")]
        #[schemars(range(min = 1, max = 1000))]
        periods: u32,
        /// Rest after each period but the last of several, in s.
        #[serde(default)]
        #[schemars(range(min = 0.0, max = 3600.0))]
        rest_s: f64,
        /// Time in which the amplitude grows from nothing at the beginning of each period, along
        /// half a cosine, and dies away at its end, in s; 0: the table starts and stops as the
        /// waveform does.
        #[serde(default)]
        #[schemars(range(min = 0.0, max = 1800.0))]
        ramp_s: f64,
        /// Radius of the crank over the length of the rod, of a `slider_crank`.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(extend("exclusiveMinimum" = 0.0, "maximum" = 0.5))]
        crank_to_rod: Option<f64>,
        /// Path of a recorded motion, relative to the scenario file that names it: a CSV with the
        /// columns `time_s`, `x_mm` and optionally `y_mm` and `z_mm`, of at most 100 000 rows.
        /// Displacement and time are counted from the first row; the last must be where the
        /// first is. Once loaded, its rows stand in `motion_rows`.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(length(min = 1))]
        motion_file: Option<String>,
        /// Rows of a recorded motion, in place of a file: time in s, x, y and z in mm.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(length(min = 2, max = 100_000))]
        motion_rows: Option<Vec<[f64; 4]>>,
        /// How a recorded displacement goes between two rows; left out, `cubic`.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        interpolation: Option<Interpolation>,
        /// What the table does along z beside that; of a recorded motion, a column does.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        vertical: Option<VerticalSpec>,
        /// Sets the table from video frame to video frame instead of moving it all the time.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        video_frames: Option<VideoFramesSpec>,
        /// Longest time in s in which, after the last period, everything comes to rest with
        /// the table at its place; the stage ends when it has settled, at the latest after this.
        #[serde(default = "settle_limit")]
        #[schemars(extend("exclusiveMinimum" = 0.0, "maximum" = 600.0))]
        settle_limit_s: f64,
    },
    /// Let grains that are waiting fall into the laboratory: all of them, or as many as are
    /// asked for, from above an area. It may be done again and again, in layers.
    Deposit {
        /// Whether they rain at a rate, or begin at rest on a lattice.
        #[serde(default)]
        how: DepositKind,
        /// Middle of the area in mm. Grains begin at its height, those of a lattice from
        /// there upwards.
        at_mm: [f64; 3],
        /// Sizes of a rectangular area along x and y in mm.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        area_mm: Option<[f64; 2]>,
        /// Diameter of a round area in mm, in place of `area_mm`.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(extend("exclusiveMinimum" = 0.0, "maximum" = 10000.0))]
        diameter_mm: Option<f64>,
        /// Mass in g that is let go in a second; rain needs it. A grain waits where others
        /// are still in its way.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(extend("exclusiveMinimum" = 0.0, "maximum" = 1e9))]
        rate_g_per_s: Option<f64>,
        /// Mass in g of the layer; left out, all that is waiting.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(extend("exclusiveMinimum" = 0.0, "maximum" = 1e9))]
        mass_g: Option<f64>,
        /// Takes only grains of the sieve fractions that lie between these two openings in mm,
        /// the finer first: a layer of grains of its own.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        sizes_mm: Option<[f64; 2]>,
        /// Ends when all of them have been let go and everything has settled, at the latest
        /// after this time.
        #[serde(default = "deposit_limit")]
        #[schemars(extend("exclusiveMinimum" = 0.0, "maximum" = 3600.0))]
        time_limit_s: f64,
    },
    /// Move pieces as prescribed, then let everything come to rest where that is asked for.
    Move {
        /// Names of the pieces that move as one; left out, all that stand.
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        pieces: Vec<String>,
        /// Velocity along x, y and z in mm/s.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        velocity_mm_per_s: Option<[f64; 3]>,
        /// A turn about an axis, in place of a velocity.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        rotation: Option<RotationSpec>,
        /// A sine, in place of a velocity.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        sine: Option<SineSpec>,
        /// Path of a recorded motion, in place of a velocity: a CSV as that of a vibration, whose
        /// last row may be anywhere. Once loaded, its rows stand in `motion_rows`.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(length(min = 1))]
        motion_file: Option<String>,
        /// Rows of a recorded motion, in place of a file: time in s, x, y and z in mm.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(length(min = 2, max = 100_000))]
        motion_rows: Option<Vec<[f64; 4]>>,
        /// How a recorded displacement goes between two rows; left out, `cubic`.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        interpolation: Option<Interpolation>,
        /// How long they move, in s; or `travel_mm`, `travel_deg` or `until`.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(extend("exclusiveMinimum" = 0.0, "maximum" = 3600.0))]
        duration_s: Option<f64>,
        /// The displacement in mm after which a velocity ends.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(extend("exclusiveMinimum" = 0.0, "maximum" = 100000.0))]
        travel_mm: Option<f64>,
        /// The angle in degrees after which a rotation ends.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(extend("exclusiveMinimum" = 0.0, "maximum" = 1e6))]
        travel_deg: Option<f64>,
        /// What ends the motion: from when it holds on, the motion dies away within its ramp. A
        /// sine without a ramp ends with its cycle.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        until: Option<UntilSpec>,
        /// Time in s after which a motion with `until` ends if that does not hold before.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(extend("exclusiveMinimum" = 0.0, "maximum" = 3600.0))]
        time_limit_s: Option<f64>,
        /// Time in s in which the motion grows from nothing along half a cosine, and dies
        /// away at its end; 0: it starts and stops abruptly.
        #[serde(default)]
        #[schemars(range(min = 0.0, max = 1800.0))]
        ramp_s: f64,
        /// Longest time in s in which everything comes to rest afterwards; 0: the stage ends
        /// with the motion.
        #[serde(default)]
        #[schemars(range(min = 0.0, max = 600.0))]
        settle_limit_s: f64,
        /// Changes the forces on pressed pieces all the time, so that the mean stress in a region
        /// stays what it was when the stage began; left out, they keep their forces. Native
        /// contacts of Bullet alone can do this.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        keep_mean_stress: Option<KeepMeanStressSpec>,
    },
    /// Press pieces: each moves along one direction alone, by a force along it and by what the
    /// grains do, and does so in all later stages until it is pressed otherwise, moved, locked or
    /// removed. Native contacts of Bullet alone can do this.
    Press {
        /// One load a piece.
        #[schemars(length(min = 1, max = 100))]
        loads: Vec<LoadSpec>,
        /// Time in s in which a force grows from what it was to what is wanted, once the piece
        /// meets grains.
        #[serde(default = "press_ramp")]
        #[schemars(extend("exclusiveMinimum" = 0.0, "maximum" = 1800.0))]
        ramp_s: f64,
        /// Speed in mm/s at most with which a piece comes to the grains: until the whole force is
        /// on it, it is driven no faster.
        #[serde(default = "approach")]
        #[schemars(extend("exclusiveMinimum" = 0.0, "maximum" = 10000.0))]
        approach_mm_per_s: f64,
        /// What ends the stage before that.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        until: Option<UntilSpec>,
        /// Ends when the forces are what is wanted and everything has settled, at the latest
        /// after this time.
        #[serde(default = "deposit_limit")]
        #[schemars(extend("exclusiveMinimum" = 0.0, "maximum" = 3600.0))]
        time_limit_s: f64,
    },
    /// Let pieces go: from now on each moves freely, by its weight and by contacts with grains and
    /// with all other pieces, in all later stages until it is pressed, locked, moved or removed.
    Release {
        /// Names of the pieces.
        #[schemars(length(min = 1, max = 100))]
        pieces: Vec<String>,
        /// Mass in g of each; left out, that of the piece in aluminium, 2700 kg/m³.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(extend("exclusiveMinimum" = 0.0, "maximum" = 1e9))]
        mass_g: Option<f64>,
        /// What ends the stage before everything has settled.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        until: Option<UntilSpec>,
        /// Ends when everything has settled, at the latest after this time.
        #[serde(default = "deposit_limit")]
        #[schemars(extend("exclusiveMinimum" = 0.0, "maximum" = 3600.0))]
        time_limit_s: f64,
    },
    /// Take pieces away, a gate for instance, and let the grains flow until everything has
    /// settled.
    Remove {
        /// Names of the pieces.
        #[schemars(length(min = 1, max = 100))]
        pieces: Vec<String>,
        /// What ends the stage before everything has settled.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        until: Option<UntilSpec>,
        /// Ends when everything has settled, at the latest after this time.
        #[serde(default = "deposit_limit")]
        #[schemars(extend("exclusiveMinimum" = 0.0, "maximum" = 3600.0))]
        time_limit_s: f64,
    },
    /// Wait with nothing moving.
    Rest {
        /// Length in s.
        #[schemars(extend("exclusiveMinimum" = 0.0, "maximum" = 3600.0))]
        duration_s: f64,
    },
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
