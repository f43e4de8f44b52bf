//! The state of a piece that is pressed.

use serde::{Deserialize, Serialize};

use super::LARGEST;
use crate::geometry::Vector;

/// How a piece is pressed: it moves along one direction alone, by a force along it and by what
/// the grains do. Where it turns about an axis instead, `turns` says so: forces are then moments in
/// N m, the mass is a moment of inertia in kg m², and speeds are in rad/s.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct PressState {
    /// A unit vector.
    pub direction: Vector,
    /// Its mass in kg; its weight is part of the force.
    pub mass_kg: f64,
    /// Area in m² that it shows along the direction.
    pub area_m2: f64,
    /// The force in N that is wanted.
    pub target_n: f64,
    /// How fast the force grows or falls towards that, in N/s.
    pub rate_n_per_s: f64,
    /// Speed in m/s along the direction above which it is not pushed on until the whole force is
    /// on it.
    pub approach_m_per_s: f64,
    /// Whether the whole force that was wanted has been on it and grains bore it.
    pub arrived: bool,
    /// The force of the last step in N.
    pub force_n: f64,
    /// Force in N by which the grains resisted it in the last step, against the direction.
    pub resistance_n: f64,
    /// Its speed along the direction in m/s.
    pub speed_m_per_s: f64,
    /// How it turns about the direction in place of moving along it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub turns: Option<TurnState>,
}

/// How a piece turns that is pressed by a moment.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct TurnState {
    /// A point of the axis in m.
    pub about: Vector,
    /// Distance in m from the axis that no point of the piece exceeds.
    pub reach_m: f64,
    /// By how much it has turned in rad since it was first pressed so.
    pub turned_rad: f64,
}

impl PressState {
    /// Sets the force of the next step, of a length in s: it grows at its rate from that of the
    /// last. Until the piece has arrived, it drives it no faster than it may approach against
    /// what resisted it in the last step, so that a piece that meets nothing yet has next to none,
    /// and begins to press from nothing. After that nothing holds the piece back: it follows
    /// grains that are shaken.
    pub fn next(&mut self, step: f64) {
        self.force_n = self.next_force(step);
        // A small force is whole before the piece meets anything.
        let bears = self.resistance_n > 0.5 * self.target_n;
        self.arrived = self.arrived || bears && self.is_reached();
    }

    /// Notes the speed in rad/s of one that turns at the end of a step of a length in s. What
    /// resisted it is the moment that did not make it faster: that of its contacts is off by the
    /// little that their points lie elsewhere than where the solver pushed, which would hold a
    /// large moment down for ever.
    pub fn has_turned(&mut self, speed: f64, step: f64) {
        self.resistance_n = self.force_n - self.mass_kg * (speed - self.speed_m_per_s) / step;
        self.speed_m_per_s = speed;
    }

    fn next_force(&self, step: f64) -> f64 {
        let change = self.rate_n_per_s * step;
        let wanted = self.target_n.clamp(self.force_n - change, self.force_n + change);
        if self.arrived {
            return wanted;
        }
        let faster = self.mass_kg * (self.approach_m_per_s - self.speed_m_per_s) / step;
        wanted.min((self.resistance_n + faster).max(0.0))
    }

    /// Force in N that stops it within a step of a length in s, where no load is on it and grains no
    /// longer touch it: what they gave it would carry it away for ever. 0 else.
    pub fn stop(&self, step: f64) -> f64 {
        let is_loose = self.target_n == 0.0 && self.force_n == 0.0 && self.resistance_n == 0.0;
        if is_loose { -self.mass_kg * self.speed_m_per_s / step } else { 0.0 }
    }

    /// Whether the whole force that is wanted is on it.
    pub fn is_reached(&self) -> bool {
        (self.force_n - self.target_n).abs() <= 1e-6 * self.target_n
    }

    /// Speed in m/s that no point of it exceeds where it moves at a speed along the direction, or
    /// about it.
    pub fn of_points(&self, speed: f64) -> f64 {
        speed.abs() * self.turns.map_or(1.0, |turns| turns.reach_m)
    }

    /// Its kinetic energy in J.
    pub fn kinetic_energy(&self) -> f64 {
        0.5 * self.mass_kg * self.speed_m_per_s * self.speed_m_per_s
    }

    pub(super) fn check(&self) -> Result<(), String> {
        let numbers = [
            self.mass_kg,
            self.area_m2,
            self.target_n,
            self.rate_n_per_s,
            self.approach_m_per_s,
            self.force_n,
            self.resistance_n,
            self.speed_m_per_s,
        ];
        let refuse = |what: &str| Err(format!("a piece is pressed {what}"));
        match () {
            () if !numbers.iter().all(|x| x.abs() <= LARGEST) => refuse("by what is no number"),
            () if !self.turns.is_none_or(|t| t.is_sound()) => refuse("about no axis"),
            () if !(self.mass_kg > 0.0) => refuse("and has no mass"),
            () if !((self.direction.norm() - 1.0).abs() < 1e-9) => refuse("in no direction"),
            () => Ok(()),
        }
    }
}

impl TurnState {
    fn is_sound(&self) -> bool {
        let numbers = [self.reach_m, self.turned_rad];
        self.about.iter().chain(&numbers).all(|x| x.abs() <= LARGEST)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_force_grows_at_its_rate_and_drives_no_faster_than_it_may() {
        let press = PressState {
            direction: Vector::z(),
            mass_kg: 0.2,
            target_n: 100.0,
            rate_n_per_s: 500.0,
            approach_m_per_s: 0.05,
            force_n: 40.0,
            resistance_n: 40.0,
            ..PressState::default()
        };
        let step = 0.002;
        let next = |change: PressState| change.next_force(step);
        let near = |what: &str, got: f64, expected: f64| {
            assert!((got - expected).abs() < 1e-12, "law: {what}: {expected} N, got {got} N");
        };
        near("500 N/s for 2 ms more", next(press), 41.0);
        near("down as well", next(PressState { target_n: 0.0, ..press }), 39.0);
        near("no farther than wanted", next(PressState { target_n: 40.5, ..press }), 40.5);
        let loose = PressState { resistance_n: 0.0, ..press };
        near("without resistance m Δv/Δt", next(loose), 0.2 * 0.05 / step);
        let fast = PressState { resistance_n: 0.0, speed_m_per_s: 0.06, ..press };
        near("faster than it may: none, and no pull", next(fast), 0.0);
        let mut last = PressState { force_n: 99.5, resistance_n: 99.5, ..press };
        last.next(step);
        assert!(last.arrived, "law: with the whole force on it, it has arrived");
        let mut small = PressState { target_n: 1.0, force_n: 1.0, resistance_n: 0.0, ..press };
        small.next(step);
        assert!(!small.arrived, "law: a small force that nothing resists has not");
        last.resistance_n = 0.0;
        near("nothing holds it back then", last.next_force(step), 100.0);
        assert!(!press.is_reached() && PressState { force_n: 100.0, ..press }.is_reached());
    }

    #[test]
    fn a_piece_without_load_stops_where_nothing_touches_it() {
        let touched = PressState {
            direction: -Vector::z(),
            mass_kg: 0.2,
            arrived: true,
            resistance_n: 0.1,
            speed_m_per_s: -0.3,
            ..PressState::default()
        };
        let step = 0.002;
        assert_eq!(touched.stop(step), 0.0, "law: what grains touch is theirs to move");
        let loose = PressState { resistance_n: 0.0, ..touched };
        let got = loose.stop(step);
        assert!((got - 30.0).abs() < 1e-12, "law: m v/Δt stops it, 30 N, got {got} N");
        let loaded = PressState { force_n: 1.0, ..loose };
        assert_eq!(loaded.stop(step), 0.0, "law: not while there is a load");
        assert_eq!(
            PressState { target_n: 1.0, ..loose }.stop(step),
            0.0,
            "law: nor where one comes"
        );
    }

    #[test]
    fn points_of_what_turns_are_as_fast_as_they_are_far() {
        let turns = TurnState { about: Vector::zeros(), reach_m: 0.05, turned_rad: 0.0 };
        let press = PressState {
            direction: Vector::z(),
            mass_kg: 2e-4,
            speed_m_per_s: -4.0,
            turns: Some(turns),
            ..PressState::default()
        };
        assert_eq!(press.of_points(press.speed_m_per_s), 0.2, "law: ω r");
        let along = PressState { turns: None, ..press };
        assert_eq!(along.of_points(along.speed_m_per_s), 4.0, "law: v");
        assert!((press.kinetic_energy() - 1.6e-3).abs() < 1e-15, "law: ½ I ω²");
        let nowhere = TurnState { reach_m: f64::NAN, ..turns };
        let refused = PressState { turns: Some(nowhere), ..press }.check();
        assert!(refused.is_err_and(|why| why.contains("about no axis")), "law: numbers");
    }
}
