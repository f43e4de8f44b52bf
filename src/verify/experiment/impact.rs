//! A tilted block that falls on an edge or a corner: eccentric oblique impact
//! with friction, without gravity, so that velocities before and after are plain.

use super::impact_law::Impact;
use super::*;

/// A block that does not turn meets the floor.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ImpactTilted {
    pub sides_mm: [f64; 3],
    /// Roll, pitch and yaw in degrees. Pitch alone: it falls on an edge, whose
    /// two corners act as one point in the plane of symmetry.
    pub turn_deg: [f64; 3],
    pub velocity_m_per_s: [f64; 3],
    pub friction: f64,
    /// Coefficients of restitution; the worst result counts.
    pub restitutions: Vec<f64>,
    pub regime: Regime,
}

/// What the point of contact does during the impact.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Regime {
    Sticks,
    /// It slips in one direction throughout.
    Slips,
    /// It slips, stops and sticks; nothing rebounds.
    SlipStops,
    /// It slips, stops and slips the other way: judged are energy, cone and approach alone,
    /// which hold for every hypothesis of restitution.
    SlipReverses,
    /// It slips, stops, and sticks or slips the other way: judged by the impulse with Stronge's
    /// energetic coefficient of restitution.
    Energetic,
}

impl ImpactTilted {
    fn body(&self) -> Result<Body> {
        let [roll, pitch, yaw] = self.turn_deg.map(f64::to_radians);
        let rotation = UnitQuaternion::from_euler_angles(roll, pitch, yaw);
        let mut body = block(in_m(self.sides_mm), Vector::zeros())?;
        let height = ROOM - lowest(&body.shape, &rotation);
        body.state.pose = Pose::from_parts((Vector::z() * height).into(), rotation);
        body.state.linear_velocity = self.velocity_m_per_s.into();
        Ok(body)
    }

    fn impact(&self, body: &Body, restitution: f64) -> Impact {
        let rotation = body.state.pose.rotation;
        let down = lowest(&body.shape, &rotation);
        let turned = body.shape.vertices().iter().map(|v| rotation * v.coords);
        let corners: Vec<Vector> = turned.filter(|v| v.z < down + 1e-9).collect();
        let (mass, moments) = mass_of(body);
        let axes = rotation.to_rotation_matrix();
        Impact {
            mass,
            inertia: axes * Matrix3::from_diagonal(&moments) * axes.transpose(),
            arm: corners.iter().sum::<Vector>() / corners.len() as f64,
            velocity: body.state.linear_velocity,
            friction: self.friction,
            restitution,
        }
    }

    /// The impulse (N s) by the law; `None` where laws that every hypothesis obeys are judged.
    fn law(&self, impact: &Impact) -> Result<Option<Vector>> {
        let found = match self.regime {
            Regime::Sticks => impact.sticks().map(Some),
            Regime::Slips => impact.slips().map(Some),
            Regime::SlipStops => impact.slip_stops().map(Some),
            Regime::SlipReverses => impact.slip_reverses().filter(|r| *r).map(|_| None),
            Regime::Energetic => impact.energetic().map(Some),
        };
        found.ok_or_else(|| VerifyError::Setup("the impact is of another regime".into()))
    }

    pub(super) fn run(&self, bench: &Bench) -> Measured {
        of_each(&self.restitutions, "Angular velocity (rad/s)", |restitution, outcome| {
            self.one(bench, restitution, outcome)
        })
    }

    /// Error in % of the speed, and in words.
    fn one(&self, bench: &Bench, restitution: f64, outcome: &mut Outcome) -> Result<(f64, String)> {
        let body = self.body()?;
        let impact = self.impact(&body, restitution);
        let law = self.law(&impact)?;
        let pairs = uniform(self.friction, restitution);
        let mut scene = floored(bench.scene_under(Vector::zeros(), &pairs)?, 0.3)?;
        let meets = ROOM / impact.velocity.z.abs();
        let inverse = impact.inertia.try_inverse().ok_or(VerifyError::NoEvent("a body"))?;
        let turns = |state: &BodyState| state.angular_velocity.norm();
        let (state, curve) = through_impact(&mut scene, &body, meets, OVER, turns)?;
        outcome.measured(format!("e = {restitution}"), curve);
        let impulse = impact.mass * (state.linear_velocity - impact.velocity);
        let (_, moments) = mass_of(&body);
        // Kept while it flies on, unlike the angular velocity.
        let (momentum, _) = spin(&state, &moments);
        let speed = impact.velocity.norm();
        let Some(law) = law else {
            let before = 0.5 * impact.mass * speed * speed;
            let after = 0.5 * impact.mass * state.linear_velocity.norm_squared()
                + state.rotational_energy(&moments);
            let energy = after / before - 1.0;
            let cone = impact.outside_cone(&impulse) / impulse.norm();
            let point =
                impact.velocity + impulse / impact.mass + (inverse * momentum).cross(&impact.arm);
            let approach = point.z / impact.velocity.z.abs();
            let words = format!(
                "energy {:+.2} %, friction {:.3} of the normal impulse, the point leaves with \
                 {approach:.3} of the approach",
                100.0 * energy,
                impulse.xy().norm() / impulse.z
            );
            let got = 100.0 * energy.max(cone).max(-approach).max(0.0);
            return Ok((if energy.is_nan() { f64::NAN } else { got }, words));
        };
        let turning = (inverse * impact.arm.cross(&law)).norm();
        outcome.law(format!("Law, e = {restitution}"), stepped(0.0, turning, meets, scene.time()));
        let off = (impulse - law).norm() / (impact.mass * speed);
        let off_turning =
            (momentum - impact.arm.cross(&law)).norm() / (impact.mass * speed * impact.arm.norm());
        let share = |impulse: Vector| {
            let p = impulse / impact.mass / speed;
            format!("({:.3}, {:.3}, {:.3})", p.x, p.y, p.z)
        };
        let words = format!(
            "impulse {} m |v|, analytically {}; angular momentum off by {:.2} %",
            share(impulse),
            share(law),
            100.0 * off_turning
        );
        let nan = off.is_nan() || off_turning.is_nan();
        Ok((if nan { f64::NAN } else { 100.0 * off.max(off_turning) }, words))
    }
}

#[cfg(test)]
mod tests {
    #[test]
    fn the_files_have_the_regime_that_they_say() {
        for (case, tilted) in cases_of!(ImpactTilted, 4) {
            let body = tilted.body().expect("a block");
            for &restitution in &tilted.restitutions {
                let law = tilted.law(&tilted.impact(&body, restitution));
                assert!(law.is_ok(), "{} with e = {restitution}: {law:?}", case.id);
            }
        }
    }
}
