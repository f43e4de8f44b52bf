//! The state of a piece that moves freely.

use serde::{Deserialize, Serialize};

use super::LARGEST;
use crate::world::BodyState;

/// How a piece moves freely: in all directions and about all axes, by its weight and by contacts.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct FreeState {
    /// Its mass in kg.
    pub mass_kg: f64,
    /// Where its centre of mass and its principal axes are, and how they move.
    pub body: BodyState,
}

impl FreeState {
    pub(super) fn check(&self) -> Result<(), String> {
        let velocities = [&self.body.linear_velocity, &self.body.angular_velocity];
        let sound = velocities.iter().all(|v| v.iter().all(|x| x.abs() <= LARGEST));
        match (self.mass_kg > 0.0 && self.mass_kg <= LARGEST, sound) {
            (false, _) => Err(format!("a free piece has a mass of {:e} kg", self.mass_kg)),
            (_, false) => Err("a free piece has a velocity that is no number".to_owned()),
            _ => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Pose, Vector};

    #[test]
    fn a_free_piece_has_a_mass_and_a_velocity() {
        let body = BodyState::at_rest(Pose::identity());
        let sound = FreeState { mass_kg: 0.3, body };
        assert_eq!(sound.check(), Ok(()));
        for mass_kg in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            let told = FreeState { mass_kg, ..sound }.check();
            assert!(told.is_err_and(|why| why.contains("a mass of")), "law: no mass {mass_kg}");
        }
        let mut lost = sound;
        lost.body.angular_velocity = Vector::new(0.0, f64::NAN, 0.0);
        assert!(lost.check().is_err_and(|why| why.contains("no number")), "law: numbers");
    }
}
