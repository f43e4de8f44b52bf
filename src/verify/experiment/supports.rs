//! Impact at several points at once, without gravity.
//!
//! **Flat.** A block that falls flat on its four corners, and slides: all corners come with one
//! velocity and leave with e times it, so that the block does not turn, v_z' = −e v_z. Friction
//! slips throughout: |v_x'| = |v_x| − μ (1 + e) |v_z|. Its moment about the centroid, half the
//! height times the friction, is borne by corners in front that push more than those behind; none
//! pulls as long as μ h < L.
//!
//! **Bar on two supports.** Level, with a support on either side of the centroid:
//! two points that both leave with −e times the approach leave no rigid
//! bar a turn, wherever they are; both impulses push.
//!
//! **Bar on supports at one side.** Two points x₁ < x₂ on the same side: the one nearer to the
//! centroid stops the bar, which then turns about it so that the farther one leaves by itself and
//! bears nothing. p = (1 + e) m v/(1 + x₁²/k²), v' = −v + p/m, ω' = x₁ p/I.

use super::*;

/// A level block falls on a floor or on supports.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ImpactAtSeveralPoints {
    pub sides_mm: [f64; 3],
    /// Horizontal velocity along x and downward velocity in m/s.
    pub velocity_m_per_s: [f64; 2],
    pub friction: f64,
    /// Coefficients of restitution; the worst result counts.
    pub restitutions: Vec<f64>,
    /// Where narrow supports begin and end along x, in mm from the centroid; none is a floor.
    pub supports_mm: Vec<[f64; 2]>,
}

/// Velocity (m/s) along x and z and angular velocity (rad/s) about y.
#[derive(Debug, Clone, Copy, PartialEq)]
struct After {
    x: f64,
    z: f64,
    spin: f64,
}

impl ImpactAtSeveralPoints {
    /// Where the supports begin and end, in m.
    fn supports(&self) -> Vec<[f64; 2]> {
        self.supports_mm.iter().map(|support| support.map(from_mm)).collect()
    }

    /// Square of the radius of gyration about y, in m².
    fn gyration_squared(&self) -> f64 {
        let [length, _, height] = self.sides_mm.map(from_mm);
        (length * length + height * height) / 12.0
    }

    /// By the law with a coefficient of restitution; `None` where it says nothing.
    fn law(&self, restitution: f64) -> Option<After> {
        let [along, down] = self.velocity_m_per_s;
        let (friction, supports) = (self.friction, self.supports());
        let least = supports.iter().map(|s| s[0]).fold(f64::INFINITY, f64::min);
        let most = supports.iter().map(|s| s[1]).fold(f64::NEG_INFINITY, f64::max);
        if supports.is_empty() || (least < 0.0 && most > 0.0) {
            let lost = friction * (1.0 + restitution) * down;
            let pushes = friction * self.sides_mm[2] < self.sides_mm[0];
            let level = supports.is_empty() || friction == 0.0;
            let slides = along.abs() > lost && pushes;
            let x = if along == 0.0 { 0.0 } else { along - lost * along.signum() };
            return (level && (slides || along == 0.0 || friction == 0.0)).then_some(After {
                x,
                z: restitution * down,
                spin: 0.0,
            });
        }
        // One side, without friction: the edge nearest to the centroid.
        let arm = if least > 0.0 { least } else { most };
        let gyration_squared = self.gyration_squared();
        let impulse = (1.0 + restitution) * down / (1.0 + arm * arm / gyration_squared);
        // An impulse upwards at +x turns the bar against y.
        let spin = -arm * impulse / gyration_squared;
        (friction == 0.0).then_some(After { x: along, z: impulse - down, spin })
    }

    pub(super) fn run(&self, bench: &Bench) -> Measured {
        of_each(&self.restitutions, "Upward velocity (m/s)", |restitution, outcome| {
            self.one(bench, restitution, outcome)
        })
    }

    /// Error in % of the downward velocity, and in words.
    fn one(&self, bench: &Bench, restitution: f64, outcome: &mut Outcome) -> Result<(f64, String)> {
        let sides = in_m(self.sides_mm);
        let supports = self.supports();
        let law = self
            .law(restitution)
            .ok_or_else(|| VerifyError::Setup("the law does not cover this impact".into()))?;
        let mut scene = bench.scene_under(Vector::zeros(), &uniform(self.friction, restitution))?;
        if supports.is_empty() {
            scene.add(&floor(0.2, Motion::Static)?);
        }
        for [from, to] in &supports {
            scene.add(&piece(*from, *to, 2.0 * sides.y, 0.0)?);
        }
        let [along, down] = self.velocity_m_per_s;
        let mut body = block(sides, Vector::new(0.0, 0.0, sides.z / 2.0 + ROOM))?;
        // Where it is when it meets the supports, they are where they are said to be.
        body.state.pose.translation.vector.x = -along * ROOM / down;
        body.state.linear_velocity = Vector::new(along, 0.0, -down);
        let (mass, inertia) = mass_of(&body);
        let meets = ROOM / down;
        let rises = |state: &BodyState| state.linear_velocity.z;
        let (state, curve) = through_impact(&mut scene, &body, meets, OVER, rises)?;
        outcome.measured(format!("e = {restitution}"), curve);
        outcome.law(format!("Law, e = {restitution}"), stepped(-down, law.z, meets, scene.time()));
        let velocity = state.linear_velocity - Vector::new(law.x, 0.0, law.z);
        let turning = state.angular_velocity - Vector::y() * law.spin;
        // A turn counts by the speed it has at the radius of gyration.
        let gyration = (inertia.y / mass).sqrt();
        let got = velocity.norm().max(gyration * turning.norm()) / down;
        let words = format!(
            "velocity ({:.4}, {:.4}, {:.4}) m/s and {:.3} rad/s, analytically ({:.4}, 0, {:.4}) and {:.3}",
            state.linear_velocity.x,
            state.linear_velocity.y,
            state.linear_velocity.z,
            state.angular_velocity.y,
            law.x,
            law.z,
            law.spin
        );
        Ok((if turning.norm().is_nan() { f64::NAN } else { 100.0 * got }, words))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bar(friction: f64, supports_mm: &[[f64; 2]]) -> ImpactAtSeveralPoints {
        ImpactAtSeveralPoints {
            sides_mm: [60.0, 20.0, 10.0],
            velocity_m_per_s: [0.4, 0.2],
            friction,
            restitutions: Vec::new(),
            supports_mm: supports_mm.to_vec(),
        }
    }

    #[test]
    fn between_two_supports_a_bar_rebounds_level() {
        for supports in [[[-20.0, -19.0], [10.0, 11.0]], [[-30.0, -29.0], [2.0, 3.0]]] {
            let got = bar(0.0, &supports).law(0.5).expect("a law");
            assert_eq!(got, After { x: 0.4, z: 0.1, spin: 0.0 });
        }
        let slides = bar(0.3, &[]).law(0.5).expect("a law");
        let upright = ImpactAtSeveralPoints { velocity_m_per_s: [0.0, 0.2], ..bar(0.3, &[]) };
        let straight = upright.law(0.5).expect("a law");
        assert_eq!(straight, After { x: 0.0, z: 0.1, spin: 0.0 }, "law: friction has no part");
        assert!((slides.x - (0.4 - 0.3 * 1.5 * 0.2)).abs() < 1e-15, "law: Coulomb, {slides:?}");
    }

    #[test]
    fn beyond_its_centroid_a_bar_turns_about_the_nearer_support() {
        let bar = bar(0.0, &[[4.5, 5.5], [20.0, 21.0]]);
        let gyration_squared = bar.gyration_squared();
        for restitution in [0.0, 0.5, 1.0] {
            let after = bar.law(restitution).expect("a law");
            let at = |x: f64| after.z - after.spin * x;
            let near = at(0.0045) - restitution * 0.2;
            assert!(near.abs() < 1e-15, "law: the nearer point leaves with e v, off by {near}");
            assert!(at(0.02) > at(0.0045), "law: the farther one leaves faster, unaided");
            // Angular momentum about the nearer point, which bears the impulse.
            let before = 0.0045 * 0.2;
            let then = -0.0045 * after.z - gyration_squared * after.spin;
            let off = before - then;
            assert!(off.abs() < 1e-15, "law: momentum about the support, off by {off:e}");
            if restitution == 1.0 {
                let energy = after.z * after.z + gyration_squared * after.spin * after.spin;
                assert!((energy - 0.04).abs() < 1e-15, "law: e = 1 loses nothing, {energy}");
            }
        }
    }

    #[test]
    fn where_the_law_says_nothing_there_is_none() {
        assert_eq!(bar(2.0, &[]).law(0.5), None, "law: it would stop sliding");
        assert_eq!(bar(0.3, &[[4.5, 5.5]]).law(0.5), None, "law: no friction there");
        assert_eq!(bar(0.3, &[[-20.0, -10.0], [10.0, 20.0]]).law(0.5), None);
    }
}
