//! How far grains have turned between two states.

use super::*;

/// Angle in rad, from 0 to π, of the one turn that leads from the orientation of each grain in one
/// state to that in another; `None` of a grain that is not present in both.
pub fn rotations(before: &SpecimenState, after: &SpecimenState) -> Vec<Option<f64>> {
    let both = before.bodies.iter().zip(&after.bodies);
    both.map(|(a, b)| {
        let present = a.fate == Fate::Present && b.fate == Fate::Present;
        present.then(|| a.body.pose.rotation.angle_to(&b.body.pose.rotation))
    })
    .collect()
}

#[cfg(test)]
mod tests {
    use super::super::testing::{assert_near, random, random_direction, random_rotation};
    use super::*;
    use nalgebra::{Unit, UnitQuaternion};

    /// Law: a turn by an angle about any axis is that angle; by more than half a turn it is what is
    /// missing to a whole one.
    #[test]
    fn a_turn_has_its_angle_whatever_its_axis() {
        let mut rng = random(2);
        for (turn, expected) in
            [(0.0, 0.0), (0.3, 0.3), (-2.0, 2.0), (5.0, 2.0 * std::f64::consts::PI - 5.0)]
        {
            let mut before = SpecimenState::before_everything(2);
            before.bodies[0].body.pose.rotation = random_rotation(&mut rng);
            let mut after = before.clone();
            let axis = Unit::new_normalize(random_direction(&mut rng));
            let by = UnitQuaternion::from_axis_angle(&axis, turn);
            after.bodies[0].body.pose.rotation = by * before.bodies[0].body.pose.rotation;
            after.bodies[1].fate = Fate::Spilled;
            let got = rotations(&before, &after);
            assert_near("angle in rad", expected, got[0].expect("present"), 1e-7);
            assert_eq!(got[1], None, "law: who left has no angle");
        }
    }
}
