//! A block that rocks from edge to edge.
//!
//! Housner (1963), "The behavior of inverted pendulum structures during earthquakes", Bull. Seism.
//! Soc. Am. 53, 403. A block of half width B and half height H, tan α = B/H, R² = B² + H², tilted
//! by θ and held by friction, turns about its edge: Iₒ θ'' = −m g R sin(α − θ) with Iₒ = 4/3 m R²,
//! so that ω²/2 + p² cos(α − |θ|) is constant, p² = 3g/4R. When it is upright it meets the floor
//! with the other edge, which takes the whole impulse without rebound. The angular momentum about
//! that edge is kept: m R² (1/3 + cos 2α) ω = 4/3 m R² ω', and ω'/ω = 1 − 3/2 sin² α.

use super::*;

/// A block let go from a tilt about one of its lower edges.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RockingBlock {
    /// Width (across the edges), depth (along them) and height in mm.
    pub sides_mm: [f64; 3],
    pub friction: f64,
    /// Tilt at which it is let go, as a share of α.
    pub tilt: f64,
    pub comes: Comes,
}

/// How the block comes to its first impact; measured is its angular velocity
/// after it over that before.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Comes {
    /// Let go from rest, it falls back over its edge.
    Rocking,
    /// It flies without gravity, so that at the impact each of its points has the velocity that it
    /// would have turning about its edge, and the edge just meets the floor with none.
    Flying,
}

/// A block by Housner's law.
#[derive(Debug, Clone, Copy)]
struct Housner {
    /// α in rad.
    slenderness: f64,
    /// p² in 1/s².
    rate_squared: f64,
}

impl Housner {
    /// From half width and half height in m.
    fn new(half_width: f64, half_height: f64) -> Self {
        let radius = half_width.hypot(half_height);
        Self { slenderness: half_width.atan2(half_height), rate_squared: 0.75 * GRAVITY / radius }
    }

    /// ω'/ω.
    fn ratio(&self) -> f64 {
        1.0 - 1.5 * self.slenderness.sin().powi(2)
    }

    /// Square of the angular velocity (1/s²) that a state has when upright.
    fn upright(&self, tilt: f64, rate: f64) -> f64 {
        let height = (self.slenderness - tilt.abs()).cos() - self.slenderness.cos();
        rate * rate + 2.0 * self.rate_squared * height
    }

    /// Largest tilt (rad) of a motion with the square of an angular velocity when upright.
    fn peak(&self, upright: f64) -> f64 {
        let cosine = self.slenderness.cos() + upright / (2.0 * self.rate_squared);
        self.slenderness - cosine.min(1.0).acos()
    }

    /// Largest tilt after the first impact, let go from a tilt.
    fn next_peak(&self, tilt: f64) -> f64 {
        self.peak(self.upright(tilt, 0.0) * self.ratio().powi(2))
    }

    /// Time in s from a tilt at rest to upright or back (Housner's equation with the sine itself,
    /// by the midpoint rule in the tilt, with a substitution that takes the root away at the end).
    fn quarter(&self, tilt: f64) -> f64 {
        const PARTS: u32 = 2000;
        let speed = |t: f64| (self.upright(tilt, 0.0) - self.upright(t, 0.0)).max(0.0).sqrt();
        (0..PARTS)
            .map(|n| {
                // tilt (1 − s²), so that the integrand stays finite at rest.
                let s = (f64::from(n) + 0.5) / f64::from(PARTS);
                2.0 * s * tilt / speed(tilt * (1.0 - s * s)) / f64::from(PARTS)
            })
            .sum()
    }
}

/// Tilt (rad) and angular velocity (rad/s) over time (s).
type Rocking = Vec<(f64, f64, f64)>;

/// ω'/ω by the states nearest to the impact in which the block is clearly on one edge, each brought
/// to where it is upright by the energy.
fn first_impact(law: &Housner, motion: &Rocking, start: f64) -> Option<f64> {
    let clear = 0.1 * start.abs();
    let sign = start.signum();
    let after = motion.iter().position(|(_, tilt, _)| tilt * sign < -clear)?;
    let before = motion[..after].iter().rposition(|(_, tilt, _)| tilt * sign > clear)?;
    let speed = |n: usize| law.upright(motion[n].1, motion[n].2).max(0.0).sqrt();
    Some(speed(after) / speed(before))
}

impl RockingBlock {
    fn law(&self) -> Housner {
        Housner::new(from_mm(self.sides_mm[0]) / 2.0, from_mm(self.sides_mm[2]) / 2.0)
    }

    pub(super) fn run(&self, bench: &Bench) -> Measured {
        match self.comes {
            Comes::Rocking => self.rocks(bench),
            Comes::Flying => self.flies(bench),
        }
    }

    fn rocks(&self, bench: &Bench) -> Measured {
        let law = self.law();
        let sides = in_m(self.sides_mm);
        let tilt = self.tilt * law.slenderness;
        let mut scene = on_floor(bench, 0.2, self.friction)?;
        // About the edge at +x: the top leans towards +x.
        let rotation = about_y(tilt);
        let edge = Vector::new(sides.x, 0.0, -sides.z) / 2.0;
        let mut body = block(sides, Vector::zeros())?;
        let at = Vector::new(sides.x / 2.0, 0.0, START_GAP) - rotation * edge;
        body.state.pose = Pose::from_parts(at.into(), rotation);
        let id = scene.add(&body);
        let next = law.next_peak(tilt);
        let (falls, rises) = (law.quarter(tilt), law.quarter(next));
        let mut motion: Rocking = vec![(0.0, tilt, 0.0)];
        scene.follow(id, 1.1 * (falls + rises), |time, state| {
            let up = state.pose.rotation * Vector::z();
            motion.push((time, up.x.atan2(up.z), state.angular_velocity.y));
        })?;
        let curve = motion.iter().map(|(t, a, _)| (*t, a.to_degrees())).collect();
        let peaks = [(0.0, tilt), (falls, 0.0), (falls + rises, -next)];
        let peaks = peaks.map(|(t, a)| (t, a.to_degrees())).to_vec();
        let ratio = first_impact(&law, &motion, tilt).ok_or(VerifyError::NoEvent("an impact"))?;
        let lowest = motion.iter().map(|m| m.1).fold(0.0_f64, f64::min);
        let (rise, expected) = (-lowest.to_degrees(), next.to_degrees());
        Ok(Outcome::over_time("Tilt (°)", curve, "Impact and peaks by Housner’s law", peaks)
            .said(format!("rises to {rise:.3}°, analytically {expected:.3}°"))
            .got(ratio))
    }

    fn flies(&self, bench: &Bench) -> Measured {
        // Tilt at which it begins, small: its edge still is where it will touch.
        const BEGINS: f64 = 0.03;
        // Steps after which the impact is over, counted from when it began.
        const OVER: u64 = 3;
        let law = self.law();
        let sides = in_m(self.sides_mm);
        let rate = law.upright(self.tilt * law.slenderness, 0.0).sqrt();
        let pairs = uniform(self.friction, 0.0);
        let mut scene = floored(bench.scene_under(Vector::zeros(), &pairs)?, 0.2)?;
        let time = BEGINS / rate;
        let turning = -rate * Vector::y();
        let upright = Vector::new(0.0, 0.0, sides.z / 2.0 + START_GAP);
        // About the edge at +x.
        let velocity = turning.cross(&(Vector::new(-sides.x, 0.0, sides.z) / 2.0));
        let mut body = block(sides, Vector::zeros())?;
        body.state = BodyState {
            pose: Pose::from_parts((upright - velocity * time).into(), about_y(BEGINS)),
            linear_velocity: velocity,
            angular_velocity: turning,
        };
        let turns = |state: &BodyState| -state.angular_velocity.y / rate;
        let (state, curve) = through_impact(&mut scene, &body, time, OVER, turns)?;
        let mut outcome = Outcome::new("Time (s)", "Angular velocity over that before");
        outcome.law("Housner’s law", stepped(1.0, law.ratio(), time, scene.time()));
        outcome.measured("Engine", curve);
        Ok(outcome.got(turns(&state)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ratio_keeps_the_angular_momentum_about_the_new_edge() {
        for (b, h) in [(0.005_f64, 0.02_f64), (0.01, 0.02), (0.01, 0.015)] {
            let law = Housner::new(b, h);
            let gyration = (b * b + h * h) / 3.0;
            // About the new edge, before: r × v + k² ω, with v = ω × (arm from the old edge).
            let before = gyration + (h * h - b * b);
            let after = gyration + (b * b + h * h);
            let expected = before / after;
            assert!((law.ratio() - expected).abs() < 1e-12, "law: {expected}, got {}", law.ratio());
        }
    }

    #[test]
    fn the_energy_tells_peak_and_speed_from_each_other() {
        let law = Housner::new(0.01, 0.02);
        let tilt = 0.5 * law.slenderness;
        let off = (law.peak(law.upright(tilt, 0.0)) - tilt).abs();
        assert!(off < 1e-12, "law: without impact it comes back, off by {off:e}");
        assert!(law.next_peak(tilt) < tilt, "law: each impact takes energy");
        // Small tilts of a slender block: θ = α − (α − θ₀) cosh pt (Housner).
        let slender = Housner::new(0.001, 0.05);
        let tilt = 0.5 * slender.slenderness;
        let expected = 2.0_f64.acosh() / slender.rate_squared.sqrt();
        let got = slender.quarter(tilt);
        assert!((got / expected - 1.0).abs() < 1e-3, "law: {expected} s, got {got} s");
    }

    #[test]
    fn the_ratio_is_read_from_a_motion_that_obeys_it() {
        let law = Housner::new(0.01, 0.02);
        let tilt = 0.4 * law.slenderness;
        for (step, ratio) in [(1e-3, law.ratio()), (4e-3, law.ratio()), (1e-3, 1.0), (1e-3, 0.5)] {
            let (mut t, mut a, mut w) = (0.0, tilt, 0.0);
            let mut motion = vec![(t, a, w)];
            while motion.len() < 400 {
                // Fine steps in between.
                for _ in 0..100 {
                    let h: f64 = step / 100.0;
                    let pull = law.rate_squared * (law.slenderness - f64::abs(a)).sin();
                    w -= pull * f64::signum(a) * h;
                    let next: f64 = a + w * h;
                    w *= if next.signum() == a.signum() { 1.0 } else { ratio };
                    a = next;
                    t += h;
                }
                motion.push((t, a, w));
            }
            let got = first_impact(&law, &motion, tilt).expect("an impact");
            assert!((got - ratio).abs() < 2e-3, "law: {ratio}, got {got} at steps of {step} s");
        }
    }

    #[test]
    fn friction_holds_the_edge_through_every_impact_of_the_files() {
        for (case, rocking) in cases_of!(RockingBlock, 2) {
            let law = rocking.law();
            let r = law.ratio();
            // m Δv at the new edge, v = ω × arm: sideways over upwards.
            let needed = (1.0 - r) / (1.0 + r) / law.slenderness.tan();
            assert!(needed < rocking.friction, "{}: needs {needed}", case.id);
            let off = (case.expected - r).abs();
            assert!(off < 1e-4, "{}: expected {r}, typed {}", case.id, case.expected);
        }
    }
}
