//! What a motion asks of a specimen: peaks and jumps, for manifests, summaries and people.

use std::{f64::consts::PI, sync::Arc};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{FRAME_ROUNDING, Path, PieceMotion, Start, TableMotion, Waveform};
use crate::units::to_mm;

/// Standard gravity in m/s², by which accelerations are given in g (CGPM 1901).
pub const STANDARD_GRAVITY: f64 = 9.806_65;

/// Points a cycle of the fastest component, and a shorter ramp, at which peaks without a formula
/// are looked for.
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
    /// Largest jump of the displacement in mm: at the ends of a period, or from frame to frame (of
    /// those that steps do not pass over).
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
        if motion.periods > 1 && motion.rest == 0.0 {
            // Where a period ends the next begins.
            velocity = velocity.max((begins.velocity - ends.velocity).norm());
        }
        if let Some(rate) = motion.frames_per_s {
            waveform += &format!(", one pose a video frame at {rate} a second, each in one step");
            position = largest_frame(motion, rate, step);
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

    /// Of a motion of pieces, none of which has a point farther (m) from the axis of a rotation. Where
    /// a condition ends it, its end is another.
    pub fn of_pieces(motion: &PieceMotion, farthest: f64) -> Self {
        let PieceMotion { ref path, duration, ramp } = *motion;
        let table = match path {
            Path::Velocity(velocity) => {
                return Self::of_constant("constant velocity", velocity.norm(), 0.0, ramp);
            }
            Path::Rotation { speed, .. } => {
                let (name, speed) = ("rotation, at the farthest point", speed.abs());
                return Self::of_constant(name, speed * farthest, speed, ramp);
            }
            Path::Sine { amplitude, frequency } => {
                TableMotion { ramp, ..TableMotion::sine(amplitude.norm(), *frequency, duration) }
            }
            Path::Recorded { rows, .. } => TableMotion {
                waveform: Waveform::Recorded(Arc::clone(rows)),
                ..TableMotion::sine(0.0, 0.0, rows.duration())
            },
        };
        // They stay where they end. Without frames no step counts.
        Self { largest_position_jump_mm: 0.0, ..Self::of(&table, 1.0) }
    }

    /// Of a speed in m/s that grows and dies away within a ramp in s, along half a cosine, about an
    /// axis at an angular speed in rad/s, or along a line at none.
    fn of_constant(name: &str, speed: f64, turning: f64, ramp: f64) -> Self {
        let has_ramp = ramp > 0.0;
        let at = |n: u32| {
            let (sin, cos) = (PI * f64::from(n) / POINTS_A_CYCLE).sin_cos();
            let share = 0.5 * (1.0 - cos);
            let growth = if has_ramp { 0.5 * PI / ramp * sin } else { 0.0 };
            speed * growth.hypot(turning * share * share)
        };
        let acceleration = (0..=POINTS_A_CYCLE as u32).map(at).fold(0.0, f64::max);
        let ramps = if has_ramp { format!(", ramps of {ramp} s") } else { String::new() };
        let found_by = if has_ramp && turning > 0.0 {
            format!("speed by formula, acceleration at {POINTS_A_CYCLE} points of a ramp")
        } else {
            "formula".to_owned()
        };
        Self {
            waveform: format!("{name}{ramps}"),
            peak_speed_m_per_s: speed,
            peak_acceleration_m_per_s2: acceleration,
            peak_acceleration_g: acceleration / STANDARD_GRAVITY,
            largest_position_jump_mm: 0.0,
            largest_velocity_jump_m_per_s: if has_ramp { 0.0 } else { speed },
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

/// Largest displacement in m from one pose to the next that an engine sets in steps of a length
/// in s.
fn largest_frame(motion: &TableMotion, rate: f64, step: f64) -> f64 {
    // Where more than one frame passes in a step, it takes the last of them.
    let passed = (rate * step).max(1.0);
    let poses = (motion.duration * rate / passed).ceil().clamp(1.0, MOST_POINTS) as u64;
    let place = |n: u64| motion.frame((n as f64 * passed - FRAME_ROUNDING).ceil().max(0.0), rate);
    // From the last frame the table returns to its place.
    let home = motion.course(motion.duration).displacement.norm();
    (0..poses).map(|n| (place(n + 1) - place(n)).norm()).fold(home, f64::max)
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
    let mut spans = if motion.vertical.is_none() && 2.0 * edge < motion.duration {
        vec![(0.0, edge), (motion.duration - edge, motion.duration)]
    } else {
        vec![(0.0, motion.duration)]
    };
    // That of a piece may lie between two points of a cycle.
    let has_short_ramp = motion.ramp > 0.0 && motion.ramp * fastest < 1.0;
    if has_short_ramp {
        spans.extend([(0.0, motion.ramp), (motion.duration - motion.ramp, motion.duration)]);
    }
    let (mut speed, mut acceleration) = (0.0_f64, 0.0_f64);
    for (from, to) in spans {
        let points = ((to - from) * fastest * POINTS_A_CYCLE).ceil();
        let points = points.clamp(POINTS_A_CYCLE, MOST_POINTS);
        for n in 0..=points as u64 {
            let at = motion.course(from + (to - from) * n as f64 / points);
            speed = speed.max(at.velocity.norm());
            acceleration = acceleration.max(at.acceleration.norm());
        }
    }
    let of_ramp = if has_short_ramp { " and a ramp" } else { "" };
    let mut found = format!("{POINTS_A_CYCLE} points a cycle{of_ramp}, {MOST_POINTS} at most");
    if let (Waveform::SliderCrank { ratio, .. }, true) = (&motion.waveform, plain) {
        acceleration = amplitude * omega * omega * (1.0 + ratio);
        found = format!("acceleration by formula, speed at {found}");
    }
    (speed, acceleration, 0.0, found)
}
