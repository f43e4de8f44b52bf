//! A body that falls over an edge or a corner.
//!
//! Friction holds the edge or corner, and the body is a physical pendulum that stands upside down:
//! Iₒ φ'' = m g R sin φ, R from the pivot to the centroid, Iₒ = I + m R². For a block on its edge
//! Iₒ = 4/3 m R²; for a cube of side s on its corner R² = 3/4 s² and Iₒ = 11/12 m s² about every
//! axis through the corner across its diagonal, because a cube's inertia is the same about all
//! axes. The equation is integrated by Runge-Kutta.

use super::*;

/// A block let go at an angle from where it would balance.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Pivot {
    pub sides_mm: [f64; 3],
    pub on: Support,
    pub friction: f64,
    /// Angle between the vertical and the line from the pivot to the
    /// centroid when it is let go, in degrees.
    pub from_deg: f64,
    /// The angle up to which the time is taken, in degrees.
    pub to_deg: f64,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Support {
    /// One of its edges along y.
    Edge,
    Corner,
}

/// Angle (rad) and its rate over time of φ'' = p² sin φ from rest, up to an angle.
fn pendulum(rate_squared: f64, from: f64, to: f64) -> Vec<(f64, f64, f64)> {
    let step = 1e-3 / rate_squared.sqrt();
    let mut y = Vector2::new(from, 0.0);
    let mut curve = vec![(0.0, from, 0.0)];
    while y.x < to {
        y = runge_kutta(&y, step, |y| Vector2::new(y.y, rate_squared * y.x.sin()));
        curve.push((curve.len() as f64 * step, y.x, y.y));
    }
    curve
}

/// Time at which a rising curve first reaches a value, between its points.
fn reaches(curve: &[(f64, f64)], value: f64) -> Option<f64> {
    curve.windows(2).find(|w| w[1].1 >= value).map(|w| {
        let [(t0, y0), (t1, y1)] = [w[0], w[1]];
        t0 + (t1 - t0) * (value - y0) / (y1 - y0)
    })
}

impl Pivot {
    /// From the centroid to the pivot in body axes, in m.
    fn arm(&self) -> Vector {
        let half = in_m(self.sides_mm) / 2.0;
        match self.on {
            Support::Edge => Vector::new(half.x, 0.0, -half.z),
            Support::Corner => Vector::new(half.x, -half.y, -half.z),
        }
    }

    /// p² = m g R/Iₒ in 1/s² and R in m.
    fn pendulum_of(&self) -> (f64, f64) {
        let sides = in_m(self.sides_mm);
        let square = sides.component_mul(&sides);
        // About y for an edge along y; for a cube about any axis.
        let gyration = (square.x + square.z) / 12.0;
        let radius = self.arm().norm();
        (GRAVITY * radius / (gyration + radius * radius), radius)
    }

    pub(super) fn run(&self, bench: &Bench) -> Measured {
        let (rate_squared, radius) = self.pendulum_of();
        let (from, to) = (from_deg(self.from_deg), from_deg(self.to_deg));
        let law = pendulum(rate_squared, from, to);
        let expected = law[law.len() - 1].0;
        let arm = self.arm();
        let mut scene = on_floor(bench, 0.2, self.friction)?;
        let upright = UnitQuaternion::rotation_between(&-arm, &Vector::z())
            .ok_or_else(|| VerifyError::Setup("a pivot above the centroid".into()))?;
        let rotation = about_y(from) * upright;
        let mut body = block(in_m(self.sides_mm), Vector::zeros())?;
        let at = Vector::z() * START_GAP - rotation * arm;
        body.state.pose = Pose::from_parts(at.into(), rotation);
        let (_, inertia) = mass_of(&body);
        if self.on == Support::Corner && inertia.max() > inertia.min() * (1.0 + 1e-9) {
            return Err(VerifyError::Setup("only a cube falls over its corner in a plane".into()));
        }
        let id = scene.add(&body);
        let (mut curve, mut slip) = (vec![(0.0, from)], 0.0_f64);
        scene.follow(id, 1.5 * expected + 0.02, |time, BodyState { pose, .. }| {
            let pivot = pose.translation.vector + pose.rotation * arm;
            let angle = (pose.rotation * -arm).angle(&Vector::z());
            if angle < to {
                slip = slip.max(pivot.xy().norm());
            }
            curve.push((time, angle));
        })?;
        // Velocity first, then position: in steps of length h everything comes h/2 early.
        let late = scene.integration_step() / 2.0;
        let got = reaches(&curve, to).ok_or(VerifyError::NoEvent("a fall"))? + late;
        let note = format!(
            "{got:.4} s, analytically {expected:.4} s; the pivot slips by {:.3} mm of {:.1}",
            1e3 * slip,
            1e3 * radius
        );
        let curve = curve.iter().map(|(t, a)| (*t, a.to_degrees())).collect();
        let law = law.iter().step_by(10).map(|(t, a, _)| (*t, a.to_degrees())).collect();
        Ok(Outcome::over_time("Angle from balance (°)", curve, "Physical pendulum", law)
            .said(note)
            .got(got / expected))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_angles_grow_like_a_hyperbolic_cosine() {
        let (p, from, to) = (18.0_f64, 1e-4_f64, 1e-2_f64);
        let curve = pendulum(p * p, from, to);
        let expected = (to / from).acosh() / p;
        let got = curve[curve.len() - 1].0;
        assert!((got / expected - 1.0).abs() < 2e-3, "law: {expected} s, got {got} s");
    }

    #[test]
    fn a_falling_pendulum_keeps_its_energy() {
        let rate_squared = 300.0;
        for (_, angle, rate) in pendulum(rate_squared, 0.1, 1.5) {
            let kinetic = 0.5 * rate * rate;
            let fallen = rate_squared * (0.1_f64.cos() - angle.cos());
            assert!((kinetic - fallen).abs() < 1e-6, "law: {fallen}, got {kinetic}");
        }
    }

    #[test]
    fn a_crossing_lies_between_the_points() {
        let curve = [(0.0, 0.0), (1.0, 1.0), (2.0, 3.0)];
        assert_eq!(reaches(&curve, 2.0), Some(1.5));
        assert_eq!(reaches(&curve, 4.0), None, "what is not reached has no time");
    }

    #[test]
    fn moments_are_those_of_the_handbook() {
        let pivot =
            |sides_mm, on| Pivot { sides_mm, on, friction: 1.0, from_deg: 1.0, to_deg: 2.0 };
        let (edge, radius) = pivot([10.0, 10.0, 40.0], Support::Edge).pendulum_of();
        let expected = 0.75 * GRAVITY / radius;
        assert!((edge / expected - 1.0).abs() < 1e-12, "law: 3g/4R = {expected}, got {edge}");
        let (corner, radius) = pivot([10.0; 3], Support::Corner).pendulum_of();
        let expected = GRAVITY * radius / (11.0 / 12.0 * 1e-4);
        assert!((corner / expected - 1.0).abs() < 1e-12, "law: {expected}, got {corner}");
    }

    /// Friction over normal force on the pivot, the largest up to an angle.
    fn friction_needed(curve: &[(f64, f64, f64)], rate_squared: f64, radius: f64) -> f64 {
        let needed = |(_, angle, rate): &(f64, f64, f64)| {
            let (sin, cos) = angle.sin_cos();
            let turning = rate_squared * sin;
            let sideways = radius * (turning * cos - rate * rate * sin);
            let down = radius * (turning * sin + rate * rate * cos);
            sideways.abs() / (GRAVITY - down)
        };
        curve.iter().map(needed).fold(0.0, f64::max)
    }

    #[test]
    fn friction_holds_every_pivot_of_the_files_and_nothing_else_touches() {
        for (case, pivot) in cases_of!(Pivot, 2) {
            let (rate_squared, radius) = pivot.pendulum_of();
            let curve = pendulum(rate_squared, from_deg(pivot.from_deg), from_deg(pivot.to_deg));
            let needed = friction_needed(&curve, rate_squared, radius);
            assert!(needed < 0.8 * pivot.friction, "{}: needs {needed}", case.id);
            // Over its edge it falls on the side that stood on it, over its corner, whatever its
            // heading, at first on one of the three edges there.
            let arm = pivot.arm();
            let axes = if pivot.on == Support::Edge { 2..3 } else { 0..3 };
            let lies = axes.map(|i| 90.0 - (arm[i].abs() / arm.norm()).acos().to_degrees());
            let room = lies.fold(90.0, f64::min);
            assert!(pivot.to_deg < room, "{}: lies on its side at {room}°", case.id);
        }
    }
}
