//! The stages a scenario can name.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What the stated amplitude of a sinusoid means.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum StrokeReading {
    /// Amplitude in the physicist's sense: the table moves ± the amplitude.
    HalfStroke,
    /// The table moves by the amplitude from end to end.
    FullStroke,
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
    /// Coulomb friction ratio between grains and the floor: a `plane` needs it,
    /// `fixed_grains` have that between grains.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "f64", range(min = 0.0, max = 10.0))]
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
        /// Ends when plate and grains have settled, at the latest after this time.
        #[serde(default = "place_limit")]
        #[schemars(extend("exclusiveMinimum" = 0.0, "maximum" = 600.0))]
        time_limit_s: f64,
    },
    /// Shake the table horizontally along x with x(t) = A sin(2πft).
    Vibrate {
        /// Frequency in Hz.
        #[schemars(extend("exclusiveMinimum" = 0.0, "maximum" = 1000.0))]
        frequency_hz: f64,
        /// Amplitude in mm.
        #[schemars(range(min = 0.0, max = 1000.0))]
        amplitude_mm: f64,
        /// Whether the amplitude is half or the full stroke.
        #[serde(default = "half_stroke")]
        stroke: StrokeReading,
        /// Length of one period of vibration in s.
        #[schemars(extend("exclusiveMinimum" = 0.0, "maximum" = 3600.0))]
        duration_s: f64,
        /// Number of periods of vibration.
        #[serde(default = "one")]
        #[schemars(range(min = 1, max = 1000))]
        periods: u32,
        /// Rest after each period but the last of several, in s.
        #[serde(default)]
        #[schemars(range(min = 0.0, max = 3600.0))]
        rest_s: f64,
        /// Time in which the amplitude grows from nothing at the beginning of each period, along
        /// half a cosine, and dies away at its end, in s; 0: the table starts and stops at full
        /// speed.
        #[serde(default)]
        #[schemars(range(min = 0.0, max = 1800.0))]
        ramp_s: f64,
    },
    /// Wait with nothing moving.
    Rest {
        /// Length in s.
        #[schemars(extend("exclusiveMinimum" = 0.0, "maximum" = 3600.0))]
        duration_s: f64,
    },
}

pub(super) fn fill_limit() -> f64 {
    4.0
}
pub(super) fn feed_rate() -> f64 {
    25.0
}
pub(super) fn drop_height() -> f64 {
    10.0
}
pub(super) fn spout_diameter() -> f64 {
    30.0
}
pub(super) fn slow_limit() -> f64 {
    120.0
}
pub(super) fn pour_limit() -> f64 {
    6.0
}
pub(super) fn place_limit() -> f64 {
    1.5
}
fn half_stroke() -> StrokeReading {
    StrokeReading::HalfStroke
}
fn one() -> u32 {
    1
}
