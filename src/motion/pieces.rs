//! How pieces of a laboratory move: one displacement of space from where they began.

use std::{f64::consts::PI, sync::Arc};

use nalgebra::{Translation3, Unit, UnitQuaternion};

use super::RecordedMotion;
use crate::geometry::{Point, Pose, Vector};

/// What is prescribed, in SI units.
#[derive(Debug, Clone, PartialEq)]
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
    /// As recorded.
    Recorded {
        /// The rows.
        rows: Arc<RecordedMotion>,
        /// From when on, in s, it dies away within the ramp; none where it goes on to its last row.
        slows_from: Option<f64>,
    },
}

/// A motion that begins and ends at rest where it has a ramp.
#[derive(Debug, Clone, PartialEq)]
pub struct PieceMotion {
    /// What is prescribed.
    pub path: Path,
    /// Length in s.
    pub duration: f64,
    /// Time in s in which it grows from nothing, and dies away at its end; of a recorded motion,
    /// in which it dies away where it is ended.
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
        if end < 2.0 * ramp {
            // It dies away before it has grown.
            return match time < end / 2.0 {
                true => grown(time),
                false => 2.0 * grown(end / 2.0) - grown(end - time),
            };
        }
        if time < ramp {
            grown(time)
        } else if time > end - ramp {
            end - ramp - grown(end - time)
        } else {
            time - ramp / 2.0
        }
    }

    /// Integral of a share that falls from 1 to 0 within the ramp, along half a cosine, up to a
    /// time in s.
    fn dying(&self, time: f64) -> f64 {
        let time = time.clamp(0.0, self.ramp);
        if self.ramp <= 0.0 {
            return 0.0;
        }
        // ∫ ½ (1 + cos(πs/r)) ds = s/2 + r/(2π) sin(πs/r).
        time / 2.0 + self.ramp / (2.0 * PI) * (PI * time / self.ramp).sin()
    }

    /// The same that from a time in s on dies away as it grew: within its ramp, or within as
    /// long as it had grown. A sine without a ramp ends with its cycle; a recorded motion goes on
    /// along its rows, ever more slowly, and stands still a ramp later.
    #[must_use]
    pub fn ended_at(&self, time: f64) -> Self {
        if let Path::Recorded { rows, .. } = &self.path {
            let path = Path::Recorded { rows: Arc::clone(rows), slows_from: Some(time) };
            return Self { path, duration: time + self.ramp, ramp: self.ramp };
        }
        let end = match self.path {
            Path::Sine { frequency, .. } if self.ramp == 0.0 => {
                // A time that is typed may be a rounding above a whole number of cycles.
                (time * frequency - 1e-9).ceil().max(1.0) / frequency
            }
            _ => time + self.ramp.min(time),
        };
        Self { duration: end.min(self.duration), ..self.clone() }
    }

    /// What takes pieces from where they began to where they are at a time in s; after the
    /// end, where they ended.
    pub fn displacement(&self, time: f64) -> Pose {
        let time = time.clamp(0.0, self.duration);
        let shift =
            |by: Vector| Pose::from_parts(Translation3::from(by), UnitQuaternion::identity());
        match &self.path {
            Path::Velocity(velocity) => shift(velocity * self.elapsed(time)),
            Path::Recorded { rows, slows_from } => {
                let row = slows_from.map_or(time, |from| from.min(time) + self.dying(time - from));
                shift(rows.at(row.min(rows.duration())).displacement)
            }
            Path::Sine { amplitude, frequency } => {
                shift(amplitude * (self.share(time) * (2.0 * PI * frequency * time).sin()))
            }
            Path::Rotation { axis, about, speed } => {
                let turn = UnitQuaternion::from_axis_angle(axis, speed * self.elapsed(time));
                let back = about.coords - turn * about.coords;
                Pose::from_parts(Translation3::from(back), turn)
            }
        }
    }

    /// Angle in rad that a rotation has turned by at a time in s, whole turns included; none of another
    /// motion.
    pub fn turned(&self, time: f64) -> Option<f64> {
        match &self.path {
            Path::Rotation { speed, .. } => Some((speed * self.elapsed(time)).abs()),
            _ => None,
        }
    }

    /// Height in m that a point never gets below on its path, from where it begins: of a sine that of
    /// its whole stroke, of a recorded motion that of all its rows.
    pub fn lowest(&self, from: &Point) -> f64 {
        let (axis, about, speed) = match &self.path {
            Path::Velocity(_) => return from.z.min((self.displacement(self.duration) * from).z),
            Path::Recorded { rows, .. } => return from.z + rows.lowest(),
            Path::Sine { amplitude, .. } => return from.z - amplitude.z.abs(),
            Path::Rotation { axis, about, speed } => (axis, about, speed),
        };
        // r = k (k·r) + r⊥ cos φ + (k × r) sin φ, seen along z.
        let arm = from - about;
        let along = axis.into_inner() * axis.dot(&arm);
        let (across, ahead) = ((arm - along).z, axis.cross(&arm).z);
        let turned = speed * self.elapsed(self.duration);
        // From a place against (r⊥, k × r) on it rises, whichever way it turns.
        let to_lowest = ahead.atan2(across) + PI;
        let way = if turned < 0.0 { -to_lowest } else { to_lowest };
        let ends = from.z.min((self.displacement(self.duration) * from).z);
        match way.rem_euclid(2.0 * PI) <= turned.abs() {
            true => ends.min(about.z + along.z - across.hypot(ahead)),
            false => ends,
        }
    }

    /// Largest speed in m/s of a point that is so far (m) from the axis of a rotation.
    pub fn peak_speed(&self, from_axis: f64) -> f64 {
        match &self.path {
            Path::Velocity(velocity) => velocity.norm(),
            Path::Recorded { rows, .. } => rows.peak_speed(),
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
        match &self.path {
            Path::Rotation { axis, about, .. } => (point - about).cross(axis).norm(),
            _ => 0.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::testing::near;

    const VELOCITY: Path = Path::Velocity(Vector::new(0.1, 0.0, 0.0));

    #[test]
    fn a_velocity_covers_its_way_with_and_without_a_ramp() {
        for (ramp, expected) in [(0.0, 0.2), (0.5, 0.15), (1.0, 0.1)] {
            let motion = PieceMotion { path: VELOCITY, duration: 2.0, ramp };
            let got = motion.displacement(2.0).translation.x;
            assert!((got - expected).abs() < 1e-15, "law: v (T − r), {ramp} s, got {got} m");
            let half = motion.displacement(1.0).translation.x;
            assert!(
                (half - expected / 2.0).abs() < 1e-15,
                "law: half of the displacement at half the time"
            );
            assert_eq!(motion.displacement(9.0), motion.displacement(2.0), "law: it stays");
        }
    }

    /// Law: a motion that is ended early is the same until then, dies away without a jump of its
    /// velocity, and is over when it says.
    #[test]
    fn a_motion_that_is_ended_is_the_same_before_and_dies_away_as_it_grew() {
        let way = |motion: &PieceMotion, t: f64| motion.displacement(t).translation.x;
        let whole = PieceMotion { path: VELOCITY, duration: 10.0, ramp: 0.5 };
        for (ended, over, expected) in [
            (2.0, 2.5, 0.2),
            (0.5, 1.0, 0.05),
            (0.25, 0.5, 0.05 * (0.5 - 1.0 / PI)),
            (9.8, 10.0, 0.95),
        ] {
            let motion = whole.ended_at(ended);
            assert_eq!(motion.duration, over, "law: T + min(r, T), at most the end");
            let before = (0..=50).map(|n| ended.min(9.5) * f64::from(n) / 50.0);
            let worst =
                before.map(|t| (way(&motion, t) - way(&whole, t)).abs()).fold(0.0, f64::max);
            assert!(worst < 1e-15, "law: the same before {ended} s, off by {worst} m");
            let got = way(&motion, over);
            near(&format!("ended at {ended} s"), got, expected, 1e-12);
            let speeds = (0..1000).map(|n| {
                let t = over * f64::from(n) / 1000.0;
                (way(&motion, t + over / 1000.0) - way(&motion, t)) / (over / 1000.0)
            });
            let speeds: Vec<f64> = speeds.collect();
            let jump = speeds.windows(2).map(|v| (v[1] - v[0]).abs()).fold(0.0, f64::max);
            let steepest = 0.1 * PI / (2.0 * 0.5) * over / 1000.0;
            assert!(
                jump < 1.01 * steepest,
                "law: at most v π/(2r) Δt = {steepest}, got {jump} m/s"
            );
        }
        let path = Path::Sine { amplitude: Vector::new(0.01, 0.0, 0.0), frequency: 4.0 };
        let sine = PieceMotion { path, duration: 10.0, ramp: 0.0 };
        for (ended, over) in [(0.6, 0.75), (0.75, 0.75), (0.0, 0.25)] {
            assert_eq!(
                sine.ended_at(ended).duration,
                over,
                "law: with its cycle, ended at {ended} s"
            );
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
        let path = Path::Rotation { axis, about, speed: -2.0 * PI };
        let turns = PieceMotion { path, duration: 3.0, ramp: 0.5 };
        near("ω (t − r/2)", turns.turned(2.0).expect("an angle"), 3.5 * PI, 1e-12);
        let shift = PieceMotion { path: VELOCITY, duration: 1.0, ramp: 0.0 };
        assert_eq!(shift.turned(1.0), None, "law: nothing turns");
        assert!((motion.peak_speed(0.5) - PI / 4.0).abs() < 1e-15, "law: ω r");
    }

    #[test]
    fn a_sine_is_one_and_no_point_is_faster_than_its_peak() {
        let path = Path::Sine { amplitude: Vector::new(0.0, 0.0, 0.01), frequency: 5.0 };
        for ramp in [0.0, 0.4] {
            let motion = PieceMotion { path: path.clone(), duration: 2.0, ramp };
            let at = |t: f64| motion.displacement(t).translation.z;
            assert!((at(1.05) - 0.01).abs() < 1e-12, "law: A at a quarter of a cycle");
            let fastest = (0..20_000)
                .map(|n| (at(1e-4 * f64::from(n + 1)) - at(1e-4 * f64::from(n))).abs() / 1e-4)
                .fold(0.0, f64::max);
            let peak = motion.peak_speed(0.0);
            assert!(fastest <= peak * (1.0 + 1e-6), "law: at most {peak} m/s, got {fastest}");
        }
    }

    /// Law: no point gets below its lowest place, and it gets there: also where motions repeat 64
    /// times, so that 64 evenly spaced moments see none of them, and where a spline swings beyond its
    /// rows.
    #[test]
    fn no_point_gets_below_its_lowest_place() {
        let sine = |frequency: f64| Path::Sine { amplitude: -0.01 * Vector::z(), frequency };
        let turn = |axis: [f64; 3], speed: f64| Path::Rotation {
            axis: Unit::new_normalize(Vector::from(axis)),
            about: Point::new(0.02, -0.01, 0.3),
            speed,
        };
        let rows = |how| {
            let rows = [
                [0.0, 0.0, 0.0, 0.0],
                [0.4, 3.0, 0.0, -20.0],
                [0.5, 3.0, 0.0, -20.0],
                [1.0, 0.0, 1.0, 30.0],
            ];
            let recorded = RecordedMotion::of_piece(&rows, how).expect("sound rows");
            Path::Recorded { rows: Arc::new(recorded), slows_from: None }
        };
        let y = [0.0, 1.0, 0.0];
        for (name, path, ramp) in [
            ("down", Path::Velocity(Vector::new(0.1, 0.0, -0.2)), 0.3),
            ("up", Path::Velocity(Vector::new(0.1, 0.0, 0.2)), 0.3),
            ("sine of 64 cycles", sine(64.0), 0.0),
            ("sine of 3 cycles", sine(3.0), 0.0),
            ("64 turns", turn(y, 128.0 * PI), 0.0),
            ("64 turns back about a slanting axis", turn([1.0, 2.0, 3.0], -128.0 * PI), 0.0),
            ("a quarter turn", turn(y, PI / 2.0), 0.0),
            ("a quarter turn back", turn(y, -PI / 2.0), 0.0),
            ("a tenth of a turn", turn([-3.0, 1.0, 0.5], PI / 5.0), 0.2),
            ("rows and straight lines", rows(super::super::Interpolation::Linear), 0.0),
            ("rows and splines", rows(super::super::Interpolation::Cubic), 0.0),
        ] {
            let motion = PieceMotion { path, duration: 1.0, ramp };
            for from in [[0.05, 0.0, 0.27], [-0.04, 0.02, 0.31], [0.02, -0.03, 0.36]] {
                let from = Point::from(from);
                let places = (0..=40_000).map(|n| f64::from(n) / 40_000.0);
                let places = places.map(|time| (motion.displacement(time) * from).z);
                let (expected, got) = (places.fold(f64::MAX, f64::min), motion.lowest(&from));
                assert!(
                    got <= expected + 1e-12 && got > expected - 1e-5,
                    "law: {name} from {from} gets down to {expected} m within 10 µm, got {got}"
                );
            }
        }
    }

    /// Law: a recorded motion goes through its rows, counted from the first, and stays at its last.
    #[test]
    fn a_recorded_motion_goes_through_its_rows_and_stays_at_the_last() {
        let rows = [[1.0, 5.0, 0.0, 2.0], [1.5, 15.0, 0.0, 2.0], [3.0, 15.0, -4.0, 8.0]];
        let linear = RecordedMotion::of_piece(&rows, super::super::Interpolation::Linear);
        let recorded = linear.expect("sound rows");
        let duration = recorded.duration();
        let path = Path::Recorded { rows: Arc::new(recorded), slows_from: None };
        let motion = PieceMotion { path, duration, ramp: 0.0 };
        assert_eq!(motion.duration, 2.0);
        for (time, expected) in [
            (0.0, [0.0; 3]),
            (0.25, [5.0, 0.0, 0.0]),
            (1.25, [10.0, -2.0, 3.0]),
            (9.0, [10.0, -4.0, 6.0]),
        ] {
            let got = motion.displacement(time).translation.vector * 1e3;
            assert!(
                (got - Vector::from(expected)).norm() < 1e-12,
                "law: at {time} s, got {got} mm"
            );
        }
        // 20 mm/s along x, then 4 along z and 8/3 along y: never beyond all together.
        let peak = motion.peak_speed(1.0) * 1e3;
        assert!((20.0..20.8).contains(&peak), "law: at least 20 mm/s, got {peak}");
        assert!(
            RecordedMotion::new(&rows, super::super::Interpolation::Linear).is_err(),
            "law: a table has to come back"
        );
    }

    /// Law: a recorded motion that is ended is the same until then, has half of what it would have
    /// gone in its ramp before it, along its rows and never beyond the last, without a jump of its
    /// velocity; without a ramp it stops at once.
    #[test]
    fn a_recorded_motion_that_is_ended_dies_away_along_its_rows() {
        let rows = [[0.0, 0.0, 0.0, 0.0], [2.0, 20.0, 0.0, 0.0]];
        let recorded = RecordedMotion::of_piece(&rows, super::super::Interpolation::Linear);
        let path =
            Path::Recorded { rows: Arc::new(recorded.expect("sound rows")), slows_from: None };
        let way = |motion: &PieceMotion, t: f64| motion.displacement(t).translation.x * 1e3;
        // mm at 10 mm/s.
        for (ramp, ended, over, expected) in
            [(0.4, 1.0, 1.4, 12.0), (0.4, 1.9, 2.3, 20.0), (0.0, 1.0, 1.0, 10.0)]
        {
            let whole = PieceMotion { path: path.clone(), duration: 2.0, ramp };
            assert_eq!(way(&whole, 1.5), 15.0, "law: a ramp alone changes nothing");
            let motion = whole.ended_at(ended);
            assert_eq!(motion.duration, over, "law: T + r");
            let before = (0..=50).map(|n| ended * f64::from(n) / 50.0);
            let worst = before.map(|t| (way(&motion, t) - way(&whole, t)).abs());
            assert_eq!(worst.fold(0.0, f64::max), 0.0, "law: the same before {ended} s");
            let got = way(&motion, over);
            assert!((got - expected).abs() < 1e-12, "law: {expected} mm, got {got} mm");
            assert_eq!(way(&motion, 9.0), got, "law: it stays");
        }
        let ended = PieceMotion { path, duration: 2.0, ramp: 0.4 }.ended_at(1.0);
        let speeds: Vec<f64> = (0..1400)
            .map(|n| f64::from(n) * 1e-3)
            .map(|t| (way(&ended, t + 1e-3) - way(&ended, t)) / 1e-3)
            .collect();
        let jump = speeds.windows(2).map(|v| (v[1] - v[0]).abs()).fold(0.0, f64::max);
        let steepest = 10.0 * PI / (2.0 * 0.4) * 1e-3;
        assert!(jump < 1.01 * steepest, "law: at most v π/(2r) Δt = {steepest}, got {jump} mm/s");
    }
}
