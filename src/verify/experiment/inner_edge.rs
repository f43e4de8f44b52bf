//! A block that slides over the joints of a floor laid of pieces.
//!
//! Pieces of equal height are one floor: no contact point may push against
//! the sides of a piece ("ghost collisions" at inner edges).

use super::*;

/// A block slides over a floor of pieces and over one without joints.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct InnerEdge {
    pub sides_mm: [f64; 3],
    pub friction: f64,
    pub speed_m_per_s: f64,
    /// Angular velocity about the vertical in rad/s.
    pub spin_rad_per_s: f64,
    /// Directions of the velocity and of the block, from the normal of the joints, in degrees.
    pub headings_deg: Vec<f64>,
    /// Where the joints lie, in mm from the block's beginning; they run along y.
    pub joints_mm: Vec<f64>,
}

/// Half the floor's width in m.
const HALF: f64 = 0.2;

impl InnerEdge {
    fn path(&self, bench: &Bench, degrees: f64, joints: &[f64]) -> Result<Vec<(f64, BodyState)>> {
        let mut scene = bench.scene(&uniform(self.friction, 0.0))?;
        let mut bounds = vec![-HALF];
        bounds.extend(joints.iter().map(|x| from_mm(*x)));
        bounds.push(HALF);
        for ends in bounds.windows(2) {
            scene.add(&piece(ends[0], ends[1], 2.0 * HALF, 0.0)?);
        }
        let sides = in_m(self.sides_mm);
        let mut body = block(sides, Vector::new(0.0, 0.0, sides.z / 2.0 + START_GAP))?;
        body.state.linear_velocity = self.speed_m_per_s * heading(degrees);
        body.state.angular_velocity.z = self.spin_rad_per_s;
        body.state.pose.rotation =
            UnitQuaternion::from_axis_angle(&Vector::z_axis(), from_deg(degrees));
        let id = scene.add(&body);
        // Longer than any of the motion lasts: sliding and spinning share the friction.
        let radius = sides.xy().norm() / 2.0;
        let motion = self.speed_m_per_s.abs() + radius * self.spin_rad_per_s.abs();
        let mut path = Vec::new();
        let duration = 1.2 * motion / (self.friction * GRAVITY);
        scene.follow(id, duration, |time, state| path.push((time, state)))?;
        Ok(path)
    }

    pub(super) fn run(&self, bench: &Bench) -> Measured {
        let sides = in_m(self.sides_mm);
        let mut outcome = Outcome::new("Time (s)", "Distance between the paths (mm)");
        let (mut worst, mut notes) = (0.0_f64, Vec::new());
        for &heading in &self.headings_deg {
            let whole = self.path(bench, heading, &[])?;
            let laid = self.path(bench, heading, &self.joints_mm)?;
            let both = whole.iter().zip(&laid);
            let apart = both.map(|((t, a), (_, b))| (*t, to_mm(furthest_corner(sides, a, b))));
            let apart: Points = apart.collect();
            let most = largest(apart.iter().map(|(_, d)| *d));
            let gone = whole.last().map_or(0.0, |(_, s)| s.pose.translation.vector.xy().norm());
            notes.push(format!("{heading}°: {most:.4} of {:.2} mm", to_mm(gone)));
            outcome.measured(format!("{heading}°"), apart);
            worst = largest([worst, most]);
        }
        if let Some(end) = outcome.curves.first().and_then(|c| c.points.last()) {
            outcome.law("One floor", vec![(0.0, 0.0), (end.0, 0.0)]);
        }
        Ok(outcome.said(notes.join(", ")).got(worst))
    }
}

/// Distance in m of the corner of a box that two states have furthest apart.
fn furthest_corner(sides: Vector, a: &BodyState, b: &BodyState) -> f64 {
    largest((0..8).map(|n| {
        let sign = |bit: u32| if n & bit == 0 { -0.5 } else { 0.5 };
        let corner = sides.component_mul(&Vector::new(sign(1), sign(2), sign(4)));
        let of = |s: &BodyState| s.pose.translation.vector + s.pose.rotation * corner;
        (of(a) - of(b)).norm()
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn corners_see_shifts_and_turns() {
        let sides = Vector::new(2.0, 2.0, 1.0);
        let at = |x: f64, turn: f64| {
            let rotation = UnitQuaternion::from_axis_angle(&Vector::z_axis(), turn);
            BodyState::at_rest(Pose::from_parts(Vector::new(x, 0.0, 0.0).into(), rotation))
        };
        for (other, expected) in [
            (at(0.0, 0.0), 0.0),
            (at(0.3, 0.0), 0.3),
            (at(0.0, 0.1), 2.0 * 2.0_f64.sqrt() * 0.05_f64.sin()),
        ] {
            let got = furthest_corner(sides, &at(0.0, 0.0), &other);
            assert!((got - expected).abs() < 1e-12, "law: {expected}, got {got}");
        }
        assert!(furthest_corner(sides, &at(0.0, 0.0), &at(f64::NAN, 0.0)).is_nan());
    }
}
