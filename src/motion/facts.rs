//! What a motion asks of a specimen: peaks and jumps, for manifests, summaries and people.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Start, TableMotion, Waveform};
use crate::units::to_mm;

/// Standard gravity in m/s², by which accelerations are given in g (CGPM 1901).
pub const STANDARD_GRAVITY: f64 = 9.806_65;

/// Points a cycle of the fastest component at which peaks without a formula are looked for.
const POINTS_A_CYCLE: f64 = 1000.0;

/// Most points that are looked at; longer motions are looked at more coarsely.
const MOST_POINTS: f64 = 1e6;

/// Peaks and jumps of a motion, as an engine gets it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct MotionFacts {
    /// The waveform in words.
    pub waveform: String,
    /// Largest speed of the waveform in m/s.
    pub peak_speed_m_per_s: f64,
    /// Largest acceleration of the waveform in m/s², jumps aside.
    pub peak_acceleration_m_per_s2: f64,
    /// The same in multiples of standard gravity.
    pub peak_acceleration_g: f64,
    /// Largest jump of the displacement in mm: at the ends of a period, or from frame to frame.
    pub largest_position_jump_mm: f64,
    /// Largest jump of the velocity in m/s: where a period begins or ends, at a row of a
    /// recording, or into the one step in which the table is set to the next frame.
    pub largest_velocity_jump_m_per_s: f64,
    /// How the peaks were found: `formula`, or in which samples.
    pub found_by: String,
}

impl MotionFacts {
    /// Of a motion that an engine follows in steps of a length in s.
    pub fn of(motion: &TableMotion, step: f64) -> Self {
        let (speed, acceleration, within, found_by) = peaks(motion);
        let mut waveform = motion.waveform.name();
        if motion.vertical.is_some() {
            waveform += ", with a vertical component";
        }
        if motion.ramp > 0.0 {
            waveform += &format!(", ramps of {} s", motion.ramp);
        }
        let begins = motion.course(0.0);
        let ends = motion.course(motion.duration);
        let mut position = ends.displacement.norm().max(begins.displacement.norm());
        let mut velocity = within.max(begins.velocity.norm()).max(ends.velocity.norm());
        if let Some(rate) = motion.frames_per_s {
            waveform += &format!(", one pose a video frame at {rate} a second, each in one step");
            position = largest_frame(motion, rate);
            velocity = position / step;
        }
        Self {
            waveform,
            peak_speed_m_per_s: speed,
            peak_acceleration_m_per_s2: acceleration,
            peak_acceleration_g: acceleration / STANDARD_GRAVITY,
            largest_position_jump_mm: to_mm(position),
            largest_velocity_jump_m_per_s: velocity,
            found_by,
        }
    }

    /// In one line.
    pub fn line(&self) -> String {
        let Self { waveform, peak_speed_m_per_s: speed, peak_acceleration_g: g, .. } = self;
        let mut text = format!("{waveform}; peak speed {speed:.3} m/s, peak acceleration {g:.3} g");
        // Below a micrometre and a millimetre a second it is rounding.
        if self.largest_velocity_jump_m_per_s > 1e-3 {
            text += &format!(
                "; its velocity jumps by up to {:.3} m/s",
                self.largest_velocity_jump_m_per_s
            );
        }
        if self.largest_position_jump_mm > 1e-3 {
            text +=
                &format!("; its position jumps by up to {:.3} mm", self.largest_position_jump_mm);
        }
        text
    }
}

/// Largest displacement in m from one frame to the next.
fn largest_frame(motion: &TableMotion, rate: f64) -> f64 {
    let frames = (motion.duration * rate).ceil().clamp(1.0, MOST_POINTS) as u64;
    let place = |n: u64| motion.frame(n as f64, rate);
    // From the last frame the table returns to its place.
    let home = place(frames).norm();
    (0..frames).map(|n| (place(n + 1) - place(n)).norm()).fold(home, f64::max)
}

/// Peak speed, peak acceleration, largest jump of the velocity within a period, and how they
/// were found.
fn peaks(motion: &TableMotion) -> (f64, f64, f64, String) {
    if let Waveform::Recorded(recorded) = &motion.waveform {
        let (speed, acceleration, jump) = recorded.peaks();
        let found = format!(
            "acceleration at the rows, where it peaks; speed at {} points an interval",
            super::recorded::POINTS_AN_INTERVAL
        );
        return (speed, acceleration, jump, found);
    }
    let omega = 2.0 * std::f64::consts::PI * motion.frequency;
    let amplitude = motion.amplitude.abs();
    let plain = motion.ramp == 0.0 && motion.vertical.is_none();
    if let (Waveform::Sine(Start::Middle | Start::TurningPoint), true) = (&motion.waveform, plain) {
        return (amplitude * omega, amplitude * omega * omega, 0.0, "formula".to_owned());
    }
    let fastest = motion.fastest().unwrap_or(0.0).max(f64::MIN_POSITIVE);
    // A cycle between the ramps is like the others, but for a vertical component of another frequency.
    let edge = motion.ramp + 1.0 / motion.frequency;
    let spans = if motion.vertical.is_none() && 2.0 * edge < motion.duration {
        vec![(0.0, edge), (motion.duration - edge, motion.duration)]
    } else {
        vec![(0.0, motion.duration)]
    };
    let (mut speed, mut acceleration) = (0.0_f64, 0.0_f64);
    for (from, to) in spans {
        let points = ((to - from) * fastest * POINTS_A_CYCLE).ceil().clamp(1.0, MOST_POINTS);
        for n in 0..=points as u64 {
            let at = motion.course(from + (to - from) * n as f64 / points);
            speed = speed.max(at.velocity.norm());
            acceleration = acceleration.max(at.acceleration.norm());
        }
    }
    let mut found = format!("{POINTS_A_CYCLE} points a cycle, {MOST_POINTS} at most");
    if let (Waveform::SliderCrank { ratio, .. }, true) = (&motion.waveform, plain) {
        acceleration = amplitude * omega * omega * (1.0 + ratio);
        found = format!("acceleration by formula, speed at {found}");
    }
    (speed, acceleration, 0.0, found)
}
