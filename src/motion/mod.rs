//! The shaking table's motion: periods of a waveform with rests between them.
//!
//! One type says where the table is, how fast it goes and how hard it is accelerated, for
//! checks of a scenario, for the stage that drives the table, and for whoever reports it.
//! Directions: the table shakes along x; a recorded motion and a vertical component
//! may move it along y and z, too. SI units.

mod facts;
mod pieces;
mod recorded;
#[cfg(test)]
mod tests;
mod waveform;

pub use facts::{MotionFacts, STANDARD_GRAVITY};
pub use pieces::{Path, PieceMotion};
pub use recorded::{Interpolation, MOST_ROWS, RecordedMotion, RowFault, Rows, rows_from_csv};
pub use waveform::{LARGEST_CRANK, Start, Waveform};

use std::f64::consts::PI;

use crate::geometry::Vector;

/// Share of a frame that is rounding: a moment so little past a frame belongs to it.
const FRAME_ROUNDING: f64 = 1e-6;

/// A table that moves in one or more periods of a waveform, with rests at its place between
/// them. A period begins at zero displacement, and but for rounding and the ends of a
/// recording it ends there. With a ramp the displacement grows and dies away along half a cosine.
#[derive(Debug, Clone, PartialEq)]
pub struct TableMotion {
    /// How it moves along x within a period.
    pub waveform: Waveform,
    /// Half the stroke in m; 0 of a recorded motion.
    pub amplitude: f64,
    /// Frequency in Hz; 0 of a recorded motion.
    pub frequency: f64,
    /// Length of one period of vibration in s.
    pub duration: f64,
    /// Number of periods.
    pub periods: u32,
    /// Rest between periods in s.
    pub rest: f64,
    /// Time in s in which the amplitude grows at the beginning of each period,
    /// and dies away at its end; 0 for none.
    pub ramp: f64,
    /// What it does along z beside that.
    pub vertical: Option<Vertical>,
    /// Poses in a second, where the table is set from one to the next, each in one engine step.
    pub frames_per_s: Option<f64>,
}

/// z(t) = A (sin(2πft + φ) − sin φ): it begins at zero displacement.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Vertical {
    /// A in m.
    pub amplitude: f64,
    /// f in Hz.
    pub frequency: f64,
    /// φ in radians.
    pub phase: f64,
}

/// Displacement in m, velocity in m/s and acceleration in m/s² at one moment.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Course {
    /// Displacement.
    pub displacement: Vector,
    /// Velocity.
    pub velocity: Vector,
    /// Acceleration.
    pub acceleration: Vector,
}

impl TableMotion {
    /// A sine from the middle of the stroke in one period: m, Hz, s.
    pub fn sine(amplitude: f64, frequency: f64, duration: f64) -> Self {
        Self {
            waveform: Waveform::Sine(Start::Middle),
            amplitude,
            frequency,
            duration,
            periods: 1,
            rest: 0.0,
            ramp: 0.0,
            vertical: None,
            frames_per_s: None,
        }
    }

    /// Time from the start of the first to the end of the last period, in s.
    pub fn total(&self) -> f64 {
        f64::from(self.periods) * self.duration
            + f64::from(self.periods.saturating_sub(1)) * self.rest
    }

    /// Displacement in m as the table is moved at a time in s since the start: of a table
    /// that is set from frame to frame that of the frame under way.
    pub fn displacement(&self, time: f64) -> Vector {
        match (self.within(time), self.frames_per_s) {
            (None, _) => Vector::zeros(),
            (Some(t), None) => self.course(t).displacement,
            (Some(t), Some(rate)) => self.frame((t * rate - FRAME_ROUNDING).ceil().max(0.0), rate),
        }
    }

    /// Velocity in m/s with which the table is moved in the engine step of the given length in
    /// s that ends at a time in s since the start.
    pub fn velocity(&self, time: f64, step: f64) -> Vector {
        match (self.within(time), self.frames_per_s) {
            (_, Some(_)) => (self.displacement(time) - self.displacement(time - step)) / step,
            (Some(t), None) => self.course(t).velocity,
            (None, None) => Vector::zeros(),
        }
    }

    /// Acceleration in m/s² of the waveform at a time in s since the start, whatever frames
    /// make of it.
    pub fn acceleration(&self, time: f64) -> Vector {
        self.within(time).map_or(Vector::zeros(), |t| self.course(t).acceleration)
    }

    /// A speed in m/s that the waveform never exceeds.
    pub fn peak_speed(&self) -> f64 {
        let growth = if self.ramp > 0.0 { 0.5 * PI / self.ramp } else { 0.0 };
        let along = match &self.waveform {
            Waveform::Recorded(motion) => return motion.peak_speed(),
            waveform => {
                let (speed, reach) = waveform.bounds();
                self.amplitude.abs() * (2.0 * PI * self.frequency * speed + growth * reach)
            }
        };
        let up = self.vertical.map_or(0.0, |v| {
            v.amplitude.abs() * (2.0 * PI * v.frequency + growth * (1.0 + v.phase.sin().abs()))
        });
        if up == 0.0 { along } else { along.hypot(up) }
    }

    /// A speed in m/s that the table never exceeds when an engine takes steps of a length in s:
    /// set from frame to frame, it covers the displacement of a frame in one of them, or of as many
    /// as may pass in it.
    pub fn peak_speed_in_steps(&self, step: f64) -> f64 {
        let Some(rate) = self.frames_per_s else { return self.peak_speed() };
        let passed = rate * step;
        self.peak_speed() * ((passed - FRAME_ROUNDING).ceil().max(1.0) / passed)
    }

    /// Frequency in Hz of the fastest component, the first overtone of a slider-crank
    /// included; `None` where the velocity may change as it likes from step to step.
    pub fn fastest_component(&self) -> Option<f64> {
        if self.frames_per_s.is_some() { None } else { self.fastest() }
    }

    /// As [`Self::fastest_component`], of a motion without frames.
    fn fastest(&self) -> Option<f64> {
        let along = match self.waveform {
            Waveform::Recorded(_) => return None,
            Waveform::Sine(_) => self.frequency,
            Waveform::SliderCrank { .. } => 2.0 * self.frequency,
        };
        Some(along.max(self.vertical.map_or(0.0, |v| v.frequency)))
    }

    /// Whether the table moves along y, and along z.
    pub fn moves_along_y_z(&self) -> [bool; 2] {
        match &self.waveform {
            Waveform::Recorded(motion) => motion.moves_along_y_z(),
            _ => [false, self.vertical.is_some_and(|v| v.amplitude != 0.0)],
        }
    }

    /// Beginning and end of each period of vibration, in s since the start.
    pub fn period_bounds(&self) -> Vec<(f64, f64)> {
        (0..self.periods)
            .map(|p| f64::from(p) * (self.duration + self.rest))
            .map(|begin| (begin, begin + self.duration))
            .collect()
    }

    /// Times in s at which they end.
    pub fn period_ends(&self) -> Vec<f64> {
        self.period_bounds().into_iter().map(|(_, end)| end).collect()
    }

    /// The waveform at a time in s within a period, its end included.
    fn course(&self, t: f64) -> Course {
        if let Waveform::Recorded(motion) = &self.waveform {
            return motion.at(t);
        }
        let mut course = Course::default();
        let ramp = self.share(t);
        let phase = self.waveform.phase(2.0 * PI * self.frequency * t);
        let (x, v, a) = ramp.of(self.amplitude, 2.0 * PI * self.frequency, phase);
        (course.displacement.x, course.velocity.x, course.acceleration.x) = (x, v, a);
        if let Some(vertical) = self.vertical {
            let omega = 2.0 * PI * vertical.frequency;
            let (sin, cos) = (omega * t + vertical.phase).sin_cos();
            let phase = (sin - vertical.phase.sin(), cos, -sin);
            let (z, v, a) = ramp.of(vertical.amplitude, omega, phase);
            (course.displacement.z, course.velocity.z, course.acceleration.z) = (z, v, a);
        }
        course
    }

    /// Displacement at the frame of a number within a period.
    fn frame(&self, number: f64, rate: f64) -> Vector {
        self.course((number / rate).min(self.duration)).displacement
    }

    /// Share of the amplitude at a time within a period.
    fn share(&self, t: f64) -> Ramp {
        let left = self.duration - t;
        let (since, sign) = if t < left { (t, 1.0) } else { (left, -1.0) };
        if since >= self.ramp {
            return Ramp { share: 1.0, growth: 0.0, bend: 0.0 };
        }
        let angle = PI * since / self.ramp;
        Ramp {
            share: 0.5 * (1.0 - angle.cos()),
            growth: sign * 0.5 * PI / self.ramp * angle.sin(),
            bend: 0.5 * (PI / self.ramp).powi(2) * angle.cos(),
        }
    }

    /// Time since the start of the period that holds `time`; `None` at rest.
    fn within(&self, time: f64) -> Option<f64> {
        if time < 0.0 || time >= self.total() {
            return None;
        }
        let t = time % (self.duration + self.rest);
        (t < self.duration).then_some(t)
    }
}

/// Share of the amplitude, its growth in 1/s, and the growth of that in 1/s².
#[derive(Clone, Copy)]
struct Ramp {
    share: f64,
    growth: f64,
    bend: f64,
}

impl Ramp {
    /// Displacement, velocity and acceleration of an amplitude under the ramp; the waveform is
    /// given with its first and second derivative by the phase, which grows by ω a second.
    fn of(&self, amplitude: f64, omega: f64, (p, p1, p2): (f64, f64, f64)) -> (f64, f64, f64) {
        let Self { share, growth, bend } = *self;
        (
            amplitude * share * p,
            amplitude * (share * omega * p1 + growth * p),
            amplitude * (share * omega * omega * p2 + 2.0 * growth * omega * p1 + bend * p),
        )
    }
}
