//! How pieces of a laboratory move: one displacement of space from where they began.

use std::f64::consts::PI;

use nalgebra::{Translation3, Unit, UnitQuaternion};

use crate::geometry::{Point, Pose, Vector};

/// What is prescribed, in SI units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Path {
    /// A constant velocity.
    Velocity(Vector),
    /// A constant angular speed about an axis through a point.
    Rotation {
        /// Direction.
        axis: Unit<Vector>,
        /// A point of the axis.
        about: Point,
        /// rad/s, right-handed.
        speed: f64,
    },
    /// A sin(2πft).
    Sine {
        /// A.
        amplitude: Vector,
        /// f in Hz.
        frequency: f64,
    },
}

/// A motion that begins and ends at rest where it has a ramp.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PieceMotion {
    /// What is prescribed.
    pub path: Path,
    /// Length in s.
    pub duration: f64,
    /// Time in s in which it grows from nothing, and dies away at its end.
    pub ramp: f64,
}

impl PieceMotion {
    /// Share of the full motion at a time in s, which grows along half a cosine.
    fn share(&self, time: f64) -> f64 {
        let since_end = (time).min(self.duration - time);
        match self.ramp > 0.0 && since_end < self.ramp {
            true => 0.5 * (1.0 - (PI * since_end.max(0.0) / self.ramp).cos()),
            false => 1.0,
        }
    }

    /// Integral of the share from the beginning to a time in s.
    fn elapsed(&self, time: f64) -> f64 {
        let (end, ramp) = (self.duration, self.ramp);
        let time = time.clamp(0.0, end);
        if ramp <= 0.0 {
            return time;
        }
        // ∫ ½ (1 − cos(πs/r)) ds = s/2 − r/(2π) sin(πs/r).
        let grown = |s: f64| s / 2.0 - ramp / (2.0 * PI) * (PI * s / ramp).sin();
        if time < ramp {
            grown(time)
        } else if time > end - ramp {
            end - ramp - grown(end - time)
        } else {
            time - ramp / 2.0
        }
    }

    /// What takes pieces from where they began to where they are at a time in s; after the
    /// end, where they ended.
    pub fn displacement(&self, time: f64) -> Pose {
        let time = time.clamp(0.0, self.duration);
        let shift =
            |by: Vector| Pose::from_parts(Translation3::from(by), UnitQuaternion::identity());
        match self.path {
            Path::Velocity(velocity) => shift(velocity * self.elapsed(time)),
            Path::Sine { amplitude, frequency } => {
                shift(amplitude * (self.share(time) * (2.0 * PI * frequency * time).sin()))
            }
            Path::Rotation { axis, about, speed } => {
                let turn = UnitQuaternion::from_axis_angle(&axis, speed * self.elapsed(time));
                let back = about.coords - turn * about.coords;
                Pose::from_parts(Translation3::from(back), turn)
            }
        }
    }

    /// Largest speed in m/s of a point that is so far (m) from the axis of a rotation.
    pub fn peak_speed(&self, from_axis: f64) -> f64 {
        match self.path {
            Path::Velocity(velocity) => velocity.norm(),
            Path::Rotation { speed, .. } => speed.abs() * from_axis,
            // A ramp as long as a cycle adds less than this.
            Path::Sine { amplitude, frequency } => {
                let ramp = if self.ramp > 0.0 { PI / (2.0 * self.ramp) } else { 0.0 };
                amplitude.norm() * (2.0 * PI * frequency + ramp)
            }
        }
    }

    /// Distance in m of a point from the axis of a rotation; 0 of another motion.
    pub fn from_axis(&self, point: &Point) -> f64 {
        match self.path {
            Path::Rotation { axis, about, .. } => (point - about).cross(&axis).norm(),
            _ => 0.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const VELOCITY: Path = Path::Velocity(Vector::new(0.1, 0.0, 0.0));

    #[test]
    fn a_velocity_covers_its_way_with_and_without_a_ramp() {
        for (ramp, expected) in [(0.0, 0.2), (0.5, 0.15), (1.0, 0.1)] {
            let motion = PieceMotion { path: VELOCITY, duration: 2.0, ramp };
            let got = motion.displacement(2.0).translation.x;
            assert!((got - expected).abs() < 1e-15, "law: v (T − r), {ramp} s, got {got} m");
            let half = motion.displacement(1.0).translation.x;
            assert!((half - expected / 2.0).abs() < 1e-15, "law: half the way at half the time");
            assert_eq!(motion.displacement(9.0), motion.displacement(2.0), "law: it stays");
        }
    }

    #[test]
    fn a_rotation_keeps_its_axis_and_the_distance_from_it() {
        let about = Point::new(0.1, 0.2, 0.3);
        let axis = Unit::new_normalize(Vector::new(0.0, 1.0, 0.0));
        let path = Path::Rotation { axis, about, speed: PI / 2.0 };
        let motion = PieceMotion { path, duration: 1.0, ramp: 0.0 };
        let place = motion.displacement(1.0);
        assert!((place * about - about).norm() < 1e-15, "law: the axis stays");
        // A quarter turn about y takes z to x.
        let got = place * (about + Vector::z());
        assert!((got - (about + Vector::x())).norm() < 1e-15, "law: right-handed, got {got}");
        assert_eq!(motion.from_axis(&(about + Vector::x() * 0.5)), 0.5);
        assert!((motion.peak_speed(0.5) - PI / 4.0).abs() < 1e-15, "law: ω r");
    }

    #[test]
    fn a_sine_is_one_and_no_point_is_faster_than_its_peak() {
        let path = Path::Sine { amplitude: Vector::new(0.0, 0.0, 0.01), frequency: 5.0 };
        for ramp in [0.0, 0.4] {
            let motion = PieceMotion { path, duration: 2.0, ramp };
            let at = |t: f64| motion.displacement(t).translation.z;
            assert!((at(1.05) - 0.01).abs() < 1e-12, "law: A at a quarter of a cycle");
            let fastest = (0..20_000)
                .map(|n| (at(1e-4 * f64::from(n + 1)) - at(1e-4 * f64::from(n))).abs() / 1e-4)
                .fold(0.0, f64::max);
            let peak = motion.peak_speed(0.0);
            assert!(fastest <= peak * (1.0 + 1e-6), "law: at most {peak} m/s, got {fastest}");
        }
    }
}
