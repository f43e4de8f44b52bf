//! How the laboratory stands in the engine's world: turned, mirrored, moving.
//!
//! Mechanics knows no direction, no handedness and no velocity of its own (Galilei). An experiment
//! is therefore written once, in the laboratory's axes, and every body passes through a [`View`] on
//! its way to the engine and back. A point x of the laboratory lies at R (S x + V t) of the world:
//! S the mirror, V the velocity of the laboratory, R its rotation.

use std::sync::Arc;

use nalgebra::{Quaternion, Unit, UnitQuaternion};

use super::VerifyError;
use crate::geometry::{ConvexPolyhedron, Point, Pose, Sphere, Vector};
use crate::world::{Body, BodyState};

/// How the laboratory stands in the engine's world; upright and at rest by default.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct View {
    /// R: how the laboratory is turned, gravity with it.
    pub frame: UnitQuaternion<f64>,
    /// S: whether left and right are exchanged (y becomes −y), shapes too.
    pub mirrored: bool,
    /// V: velocity of the whole laboratory in m/s, its walls with it.
    pub velocity: Vector,
    /// Whether bodies are added to the engine last first.
    pub last_first: bool,
}

/// S x.
fn reflected(x: Vector) -> Vector {
    Vector::new(x.x, -x.y, x.z)
}

/// S R S: a turn about (x, y, z) becomes one about (−x, y, −z), because an
/// axis of rotation is no arrow.
fn reflected_turn(rotation: &UnitQuaternion<f64>) -> UnitQuaternion<f64> {
    let q = rotation.quaternion();
    Unit::new_unchecked(Quaternion::new(q.w, -q.i, q.j, -q.k))
}

/// A state in the mirror, which is its own way back.
fn reflected_state(state: &BodyState) -> BodyState {
    let at = reflected(state.pose.translation.vector);
    BodyState {
        pose: Pose::from_parts(at.into(), reflected_turn(&state.pose.rotation)),
        linear_velocity: reflected(state.linear_velocity),
        angular_velocity: -reflected(state.angular_velocity),
    }
}

fn turned(by: &UnitQuaternion<f64>, state: &BodyState) -> BodyState {
    let at = by * state.pose.translation.vector;
    BodyState {
        pose: Pose::from_parts(at.into(), by * state.pose.rotation),
        linear_velocity: by * state.linear_velocity,
        angular_velocity: by * state.angular_velocity,
    }
}

impl View {
    /// Whether the laboratory moves, so that what is fixed in it does not stay
    /// where it is in the world.
    pub fn moves(&self) -> bool {
        self.velocity != Vector::zeros()
    }

    /// A free vector of the laboratory (gravity, a normal, an impulse) in the world.
    pub fn vector_out(&self, x: Vector) -> Vector {
        self.frame * if self.mirrored { reflected(x) } else { x }
    }

    /// A free vector of the world in the laboratory.
    pub fn vector_back(&self, x: Vector) -> Vector {
        let x = self.frame.inverse() * x;
        if self.mirrored { reflected(x) } else { x }
    }

    /// A point (m) of the world in the laboratory at a time (s).
    pub fn point_back(&self, x: Vector, time: f64) -> Vector {
        let x = self.frame.inverse() * x - self.velocity * time;
        if self.mirrored { reflected(x) } else { x }
    }

    /// A pose of the laboratory in the world at a time (s).
    pub fn pose_out(&self, pose: &Pose, time: f64) -> Pose {
        self.state_out(&BodyState::at_rest(*pose), time).pose
    }

    /// A state of the laboratory in the world at a time (s).
    pub fn state_out(&self, state: &BodyState, time: f64) -> BodyState {
        let mut state = if self.mirrored { reflected_state(state) } else { *state };
        state.pose.translation.vector += self.velocity * time;
        state.linear_velocity += self.velocity;
        turned(&self.frame, &state)
    }

    /// A state of the world in the laboratory at a time (s).
    pub fn state_back(&self, state: &BodyState, time: f64) -> BodyState {
        let mut state = turned(&self.frame.inverse(), state);
        state.pose.translation.vector -= self.velocity * time;
        state.linear_velocity -= self.velocity;
        if self.mirrored { reflected_state(&state) } else { state }
    }

    /// A body of the laboratory in the world at a time (s); in the mirror it has the other hand.
    pub fn body_out(&self, body: &Body, time: f64) -> Result<Body, VerifyError> {
        let mut out = body.clone();
        out.state = self.state_out(&body.state, time);
        if self.mirrored {
            out.shape = Arc::new(reflected_shape(&body.shape)?);
        }
        Ok(out)
    }
}

/// A shape in the mirror. Its faces run the other way round, so that they still look outwards.
fn reflected_shape(shape: &ConvexPolyhedron) -> Result<ConvexPolyhedron, VerifyError> {
    if let Some(sphere) = shape.sphere() {
        let sphere = Sphere { centre: Point::from(reflected(sphere.centre.coords)), ..sphere };
        return Ok(ConvexPolyhedron::of_sphere(sphere)?);
    }
    if let Some(rounded) = shape.rounded() {
        let core = reflected_shape(&rounded.core)?;
        return Ok(ConvexPolyhedron::of_rounded(core, rounded.radius)?);
    }
    let vertices = shape.vertices().iter().map(|v| Point::from(reflected(v.coords))).collect();
    let faces = shape.faces().iter().map(|f| f.iter().rev().copied().collect()).collect();
    Ok(ConvexPolyhedron::new(vertices, faces)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn somewhere() -> BodyState {
        BodyState {
            pose: Pose::from_parts(
                Vector::new(0.1, -0.2, 0.3).into(),
                UnitQuaternion::from_euler_angles(0.7, -0.4, 2.1),
            ),
            linear_velocity: Vector::new(1.0, 2.0, -3.0),
            angular_velocity: Vector::new(-5.0, 7.0, 11.0),
        }
    }

    fn views() -> Vec<View> {
        let frame = UnitQuaternion::from_euler_angles(-1.1, 0.3, 0.9);
        let velocity = Vector::new(0.3, -0.2, 0.1);
        [false, true]
            .into_iter()
            .flat_map(|mirrored| {
                [
                    View { mirrored, ..View::default() },
                    View { frame, velocity, mirrored, last_first: false },
                ]
            })
            .collect()
    }

    fn same(law: &str, got: &BodyState, expected: &BodyState) {
        let off = (got.pose.translation.vector - expected.pose.translation.vector).norm()
            + got.pose.rotation.angle_to(&expected.pose.rotation)
            + (got.linear_velocity - expected.linear_velocity).norm()
            + (got.angular_velocity - expected.angular_velocity).norm();
        assert!(off < 1e-7, "{law}: expected {expected:?}, got {got:?}, off by {off:e}");
    }

    #[test]
    fn the_comparison_of_states_can_fail() {
        let state = somewhere();
        for n in 0..4 {
            let mut other = state;
            match n {
                0 => other.pose.translation.vector.x += 1e-3,
                1 => other.pose.rotation *= UnitQuaternion::from_euler_angles(1e-3, 0.0, 0.0),
                2 => other.linear_velocity.z -= 1e-3,
                _ => other.angular_velocity.y += 1e-3,
            }
            assert!(std::panic::catch_unwind(|| same("", &other, &state)).is_err(), "part {n}");
        }
    }

    #[test]
    fn there_and_back_is_nothing() {
        for view in views() {
            let there = view.state_out(&somewhere(), 0.5);
            same("law: back is the inverse of out", &view.state_back(&there, 0.5), &somewhere());
            let arrow = Vector::new(1.0, -2.0, 4.0);
            let off = view.vector_back(view.vector_out(arrow)) - arrow;
            assert!(off.norm() < 1e-12, "law: the same for arrows, off by {off}");
        }
    }

    /// What a rigid body's points do is seen alike in the laboratory and in the world: R (S x + V
    /// t) of a point is where the viewed body has it, and its velocity the derivative of that.
    #[test]
    fn points_of_a_body_go_where_the_view_says() {
        let time = 0.5;
        let corner = Vector::new(0.004, 0.005, -0.006);
        for view in views() {
            let state = somewhere();
            let there = view.state_out(&state, time);
            let arm = state.pose.rotation * corner;
            let expected = view.vector_out(state.pose.translation.vector + arm)
                + view.frame * view.velocity * time;
            let own = if view.mirrored { reflected(corner) } else { corner };
            let got = there.pose.translation.vector + there.pose.rotation * own;
            assert!((got - expected).norm() < 1e-12, "law: place, {expected} and {got}");
            let speed = state.linear_velocity + state.angular_velocity.cross(&arm);
            let expected = view.vector_out(speed) + view.frame * view.velocity;
            let own = there.pose.rotation * own;
            let got = there.linear_velocity + there.angular_velocity.cross(&own);
            assert!((got - expected).norm() < 1e-12, "law: velocity, {expected} and {got}");
            let point = view.point_back(there.pose.translation.vector, time);
            let off = (point - state.pose.translation.vector).norm();
            assert!(off < 1e-12, "law: a point comes back, off by {off:e}");
        }
    }

    #[test]
    fn a_shape_in_the_mirror_has_its_volume_and_the_other_hand() {
        let wedge = ConvexPolyhedron::prism(&[(0.0, 0.0), (3.0, 0.5), (0.0, 1.0)], 0.0, 2.0);
        let wedge = wedge.expect("a shape");
        let mirrored = reflected_shape(&wedge).expect("it stays convex");
        let (a, b) = (wedge.signed_volume(), mirrored.signed_volume());
        assert!((a - b).abs() < 1e-12 && b > 0.0, "law: volume, expected {a}, got {b}");
        let (low, high) = wedge.bounding_box();
        let (low_m, high_m) = mirrored.bounding_box();
        assert_eq!((low_m.y, high_m.y), (-high.y, -low.y), "law: y becomes −y");
    }
}
