//! Waveforms of the table along x: displacement, velocity and acceleration in time.

use std::sync::Arc;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::RecordedMotion;

/// Largest ratio of crank to connecting rod: up to it the largest acceleration is that of the
/// outer dead centre.
pub const LARGEST_CRANK: f64 = 0.5;

/// Where a waveform begins and the table rests.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Start {
    /// In the middle of the stroke: at full speed, unless there is a ramp.
    #[default]
    Middle,
    /// At a turning point, from which the whole stroke lies on one side: at rest.
    TurningPoint,
}

/// How a table moves along x within a period. Formulas are for a half stroke of 1, with θ = 2πft.
#[derive(Debug, Clone, PartialEq)]
pub enum Waveform {
    /// sin θ from the middle, 1 − cos θ from the turning point.
    Sine(Start),
    /// A crank of radius 1 that drives a slider by a rod of length 1/λ.
    ///
    /// With φ the angle from the outer dead centre the slider stands off the middle of its
    /// stroke by X(φ) = cos φ + (√(1 − λ² sin² φ) − 1)/λ. From the middle, φ = θ − arccos(λ/2),
    /// where X = 0; from the turning point the displacement is 1 − X(θ), away from the outer
    /// dead centre.
    SliderCrank {
        /// λ, radius of the crank over length of the rod; above 0, at most [`LARGEST_CRANK`].
        ratio: f64,
        /// Where it begins.
        start: Start,
    },
    /// As recorded.
    Recorded(Arc<RecordedMotion>),
}

impl Waveform {
    /// Displacement for a half stroke of 1, and its first and second derivative by the phase θ;
    /// zeros of a recorded motion, which has no phase.
    pub(super) fn phase(&self, theta: f64) -> (f64, f64, f64) {
        match *self {
            Self::Sine(Start::Middle) => {
                let (sin, cos) = (theta.sin(), theta.cos());
                (sin, cos, -sin)
            }
            Self::Sine(Start::TurningPoint) => {
                let (sin, cos) = theta.sin_cos();
                (1.0 - cos, sin, cos)
            }
            Self::SliderCrank { ratio, start: Start::Middle } => {
                slider(theta - (ratio / 2.0).acos(), ratio)
            }
            Self::SliderCrank { ratio, start: Start::TurningPoint } => {
                let (x, v, a) = slider(theta, ratio);
                (1.0 - x, -v, -a)
            }
            Self::Recorded(_) => (0.0, 0.0, 0.0),
        }
    }

    /// What the derivative by the phase and the displacement never exceed.
    pub(super) fn bounds(&self) -> (f64, f64) {
        let reach = |start: &Start| if *start == Start::Middle { 1.0 } else { 2.0 };
        match self {
            Self::Sine(start) => (1.0, reach(start)),
            // |sin φ (1 + λ cos φ / q)| with q ≥ √(1 − λ²).
            Self::SliderCrank { ratio, start } => {
                (1.0 + ratio / (1.0 - ratio * ratio).sqrt(), reach(start))
            }
            Self::Recorded(_) => (0.0, 0.0),
        }
    }

    /// Name as in a scenario, with where it begins.
    pub fn name(&self) -> String {
        let from = |start: &Start| match start {
            Start::Middle => "from the middle",
            Start::TurningPoint => "from the turning point",
        };
        match self {
            Self::Sine(start) => format!("sine {}", from(start)),
            Self::SliderCrank { ratio, start } => {
                format!("slider-crank with r/l {ratio} {}", from(start))
            }
            Self::Recorded(motion) => motion.name(),
        }
    }
}

/// X(φ) of a slider-crank and its derivatives.
fn slider(phi: f64, ratio: f64) -> (f64, f64, f64) {
    let (sin, cos) = phi.sin_cos();
    let q = (1.0 - (ratio * sin).powi(2)).sqrt();
    (
        cos + (q - 1.0) / ratio,
        -sin - ratio * sin * cos / q,
        -cos - ratio * ((cos * cos - sin * sin) / q + (ratio * sin * cos).powi(2) / q.powi(3)),
    )
}
