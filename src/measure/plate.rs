//! Where the top plate lies.

use super::*;

/// Height and tilt of the top plate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlatePosition {
    /// Height of the centre of the plate's lower face above the floor, in m.
    pub height: f64,
    /// Angle between the plate's axis and the vertical, 0 to π, in radians.
    pub tilt: f64,
}

/// Position of a plate whose body origin is its centroid, whose axis is the
/// body's z axis, and whose lower face is the one towards −z.
///
/// `thickness` in m. The laboratory measured the displacement of "the center
/// of the top plate" (paper, section 2); the lower face is the one that
/// touches the grains, and without tilt both sink alike.
pub fn plate_position(state: &BodyState, thickness: f64) -> PlatePosition {
    let axis = state.pose.rotation * Vector::z();
    PlatePosition {
        height: (state.pose * Point::new(0.0, 0.0, -thickness / 2.0)).z,
        // atan2 keeps full precision near the horizontal, where acos loses half the digits.
        tilt: axis.x.hypot(axis.y).atan2(axis.z),
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::assert_near;
    use super::*;
    use crate::geometry::Pose;

    /// Law: lower face at z − t/2 · cos(tilt); turning about the axis changes nothing.
    #[test]
    fn tilted_plate() {
        for tilt in [0.0, 1e-9, 0.1, 1.0, 3.0] {
            for turn in [0.0, 2.0] {
                let rotation = nalgebra::UnitQuaternion::from_axis_angle(&Vector::y_axis(), tilt)
                    * nalgebra::UnitQuaternion::from_axis_angle(&Vector::z_axis(), turn);
                let pose = Pose::from_parts(Vector::new(0.01, 0.02, 0.16).into(), rotation);
                let got = plate_position(&BodyState::at_rest(pose), 0.01);
                assert_near("tilt", tilt, got.tilt, 1e-15 + 1e-12 * tilt);
                let height = 0.16 - 0.005 * tilt.cos();
                assert_near("centre of the lower face", height, got.height, 1e-15);
            }
        }
    }
}
