//! Finds states that no real grain can be in.

use super::{Snapshot, WorldError};
use crate::plain::three_decimals;
use crate::units::to_mm;

/// Checks snapshots against the limits of a plausible state.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RunTimeCheck {
    /// Largest speed in m/s.
    pub speed: f64,
    /// Largest angular speed in rad/s.
    pub angular_speed: f64,
    /// Largest distance from the origin in m.
    pub distance: f64,
}

impl RunTimeCheck {
    /// Checks every body of a snapshot; `name` is what a reader knows one as, by its number there.
    /// Comparisons are written so that NaN fails them.
    ///
    /// # Errors
    /// [`WorldError::Unphysical`] naming the first body found at fault, the value and the limit.
    pub fn check(
        &self,
        snapshot: &Snapshot,
        time_s: f64,
        name: impl Fn(usize) -> String,
    ) -> Result<(), WorldError> {
        for (index, body) in snapshot.iter().enumerate() {
            let Some(body) = body else { continue };
            let at = body.pose.translation.vector;
            let unphysical = |has: String| {
                let [x, y, z] = [at.x, at.y, at.z].map(|metres| short(to_mm(metres)));
                let what = format!("{} at ({x}, {y}, {z}) mm has {has}", name(index));
                Err(WorldError::Unphysical { time_s, what })
            };
            let beyond = |quantity: &str, value: f64, limit: f64, unit: &str| {
                let (value, limit) = (short(value), short(limit));
                unphysical(format!("{quantity} {value} {unit}, allowed is up to {limit} {unit}"))
            };
            let distance = at.norm();
            if !(distance <= self.distance) {
                return beyond("a distance from the origin of", distance, self.distance, "m");
            }
            if !body.pose.rotation.coords.iter().all(|c| c.is_finite()) {
                return unphysical("an orientation that is no number".to_owned());
            }
            let speed = body.linear_velocity.norm();
            if !(speed <= self.speed) {
                return beyond("a speed of", speed, self.speed, "m/s");
            }
            let spin = body.angular_velocity.norm();
            if !(spin <= self.angular_speed) {
                return beyond("an angular speed of", spin, self.angular_speed, "rad/s");
            }
        }
        Ok(())
    }
}

/// A number to three decimals; with an exponent where it would be long.
fn short(value: f64) -> String {
    if value.abs() < 1e6 { three_decimals(value) } else { format!("{value:.3e}") }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Pose, Vector};
    use crate::world::BodyState;

    const LIMITS: RunTimeCheck = RunTimeCheck { speed: 10.0, angular_speed: 100.0, distance: 2.0 };

    fn checked(snapshot: &Snapshot) -> Result<(), WorldError> {
        LIMITS.check(snapshot, 1.5, |n| format!("grain {n}"))
    }

    fn body(change: impl Fn(&mut BodyState)) -> Snapshot {
        let mut state = BodyState::at_rest(Pose::identity());
        change(&mut state);
        vec![None, Some(state)]
    }

    #[test]
    fn passes_what_is_within_the_limits() {
        for snapshot in [
            body(|_| {}),
            body(|b| b.linear_velocity = Vector::new(10.0, 0.0, 0.0)),
            body(|b| b.angular_velocity = Vector::new(0.0, 100.0, 0.0)),
            body(|b| b.pose.translation.vector.z = -2.0),
        ] {
            assert!(checked(&snapshot).is_ok(), "{snapshot:?}");
        }
    }

    #[test]
    fn names_body_value_and_limit_of_what_is_not() {
        for (snapshot, word) in [
            (body(|b| b.linear_velocity.x = 10.1), "speed"),
            (body(|b| b.linear_velocity.x = f64::NAN), "speed"),
            (body(|b| b.angular_velocity.x = 101.0), "angular speed"),
            (body(|b| b.pose.translation.vector.x = f64::INFINITY), "distance"),
            (body(|b| b.pose.rotation.as_mut_unchecked().coords.x = f64::NAN), "orientation"),
        ] {
            let text = checked(&snapshot).expect_err("beyond the limits").to_string();
            assert!(text.contains(word) && text.contains("grain 1 at"), "{word}: {text}");
        }
        let far = checked(&body(|b| b.pose.translation.vector.x = 20.308));
        let expected = "the simulation became unphysical at 1.5000 s: grain 1 at (20308, 0, 0) mm has \
                        a distance from the origin of 20.308 m, allowed is up to 2 m";
        assert_eq!(far.expect_err("beyond the limits").to_string(), expected, "law: plain numbers");
    }
}
