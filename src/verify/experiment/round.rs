//! Spheres and rounded polyhedra: a ball slides and rolls, another slides off what it lies on,
//! rounded corners meet, and a rounded block topples.
//!
//! A ball (I = 2/5 m r²) on a slope θ that starts without spin slides with v' = g sin θ − μ g cos θ
//! and r ω' = 5/2 μ g cos θ, until v = r ω at v₀/(7/2 μ g cos θ − g sin θ), where that is positive;
//! from then on it rolls with v' = 5/7 g sin θ.
//!
//! Without friction a ball on a fixed round body, an edge or a corner is a point on a circle of the
//! radius R about the other's centre, axis or corner. Let go at rest at φ₀ from the top it has
//! v² = 2 g R (cos φ₀ − cos φ), and the contact bears m g cos φ − m v²/R, which is nothing at
//! cos φ = 2/3 cos φ₀. It leaves there, and keeps the horizontal velocity v cos φ that it then has.
//!
//! Bodies that meet on the line of their centroids turn nothing: their relative velocity is
//! reversed and e times as large.
//!
//! A block that stands on the flat part w of its face, its centroid at a height z, topples where the
//! slope is steeper than w/(2 z).

use super::*;

/// A box of sides in m, rounded by a radius in mm.
fn rounded(core: Vector, radius_mm: f64) -> Result<ConvexPolyhedron> {
    Ok(ConvexPolyhedron::of_rounded(ConvexPolyhedron::cuboid(core)?, from_mm(radius_mm))?)
}

/// A ball on a slope, or thrown along a floor.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BallOnPlane {
    pub radius_mm: f64,
    pub slope_deg: f64,
    pub friction: f64,
    /// Speed down the slope at the beginning, without spin.
    pub speed_m_per_s: f64,
    pub duration_s: f64,
}

impl BallOnPlane {
    /// Speed in m/s down the slope and speed r ω of the surface about the centre.
    fn law(&self, time: f64) -> (f64, f64) {
        let (sin, cos) = from_deg(self.slope_deg).sin_cos();
        let (down, rubbing) = (GRAVITY * sin, self.friction * GRAVITY * cos);
        let closing = 3.5 * rubbing - down;
        let rolls_at = if closing > 0.0 { self.speed_m_per_s / closing } else { f64::INFINITY };
        let sliding = time.min(rolls_at);
        let speed = self.speed_m_per_s + (down - rubbing) * sliding;
        if time <= rolls_at {
            return (speed, 2.5 * rubbing * sliding);
        }
        let rolling = speed + 5.0 / 7.0 * down * (time - rolls_at);
        (rolling, rolling)
    }

    pub(super) fn run(&self, bench: &Bench) -> Measured {
        let radius = from_mm(self.radius_mm);
        let (sin, cos) = from_deg(self.slope_deg).sin_cos();
        let (end, spin) = self.law(self.duration_s);
        let reach = 1.5 * end.max(self.speed_m_per_s) * self.duration_s + 0.1;
        let gravity = GRAVITY * Vector::new(sin, 0.0, -cos);
        let mut scene = floored(bench.scene_under(gravity, &uniform(self.friction, 0.0))?, reach)?;
        let mut ball = free(ConvexPolyhedron::ball(radius), Vector::z() * (radius + START_GAP));
        ball.state.linear_velocity = self.speed_m_per_s * Vector::x();
        let id = scene.add(&ball);
        let (mut speeds, mut spins) = (Vec::new(), Vec::new());
        scene.follow(id, self.duration_s, |time, state| {
            speeds.push((time, state.linear_velocity.x));
            spins.push((time, radius * state.angular_velocity.y));
        })?;
        let (got, got_spin) = (at_end(&speeds), at_end(&spins));
        let mut outcome = Outcome::new("Time (s)", "Speed (m/s)");
        outcome.note = Some(format!("at the end rω is {got_spin:.4} m/s, analytically {spin:.4}"));
        outcome.measured("v", speeds);
        outcome.measured("rω", spins);
        outcome.law("v, known solution", over(self.duration_s, 100, |time| self.law(time).0));
        // Whichever is farther off.
        Ok(outcome.got(worst_of(&[got / end, got_spin / spin], |got| (got - 1.0).abs())))
    }
}

/// A ball that slides off a fixed body without friction.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SlidesOff {
    pub radius_mm: f64,
    pub on: On,
    /// Angle from the top at which it is let go, in degrees.
    pub from_deg: f64,
}

#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum On {
    BallMm(f64),
    Edge,
    Corner,
    /// The edge of a block that is rounded by a radius in mm.
    RoundedEdgeMm(f64),
}

impl SlidesOff {
    /// The fixed body, with the middle of the circle in the origin.
    fn body(&self) -> Result<Body> {
        const SIDE: f64 = 0.1;
        let corner = -Vector::repeat(SIDE / 2.0);
        let edge = Vector::new(corner.x, 0.0, corner.z);
        let cube = Vector::repeat(SIDE);
        let body = match self.on {
            On::BallMm(radius) => free(ConvexPolyhedron::ball(from_mm(radius)), Vector::zeros()),
            On::Edge => block(cube, edge)?,
            On::Corner => block(cube, corner)?,
            On::RoundedEdgeMm(radius) => free(rounded(cube, radius)?, edge),
        };
        Ok(Body { motion: Motion::Static, material: Material::Wall, ..body })
    }

    /// Radius in m of the circle, and the horizontal direction in which the ball slides off.
    fn circle(&self) -> (f64, Vector) {
        let radius = from_mm(self.radius_mm);
        match self.on {
            On::BallMm(other) | On::RoundedEdgeMm(other) => (radius + from_mm(other), Vector::x()),
            On::Edge => (radius, Vector::x()),
            On::Corner => (radius, Vector::new(1.0, 1.0, 0.0).normalize()),
        }
    }

    pub(super) fn run(&self, bench: &Bench) -> Measured {
        let (circle, aside) = self.circle();
        let from = from_deg(self.from_deg);
        let leaves = 2.0 / 3.0 * from.cos();
        let expected = (GRAVITY * circle * leaves).sqrt() * leaves;
        let mut scene = bench.scene(&uniform(0.0, 0.0))?;
        scene.add(&self.body()?);
        let at = (circle + START_GAP) * (from.sin() * aside + from.cos() * Vector::z());
        let id = scene.add(&free(ConvexPolyhedron::ball(from_mm(self.radius_mm)), at));
        let mut curve = vec![(0.0, 0.0)];
        // It has left at two thirds of its height.
        for _ in 0..scene.steps_in(20.0 * (circle / GRAVITY).sqrt()) {
            scene.step()?;
            let BodyState { pose, linear_velocity, .. } = scene.state(id)?;
            curve.push((scene.time(), linear_velocity.dot(&aside)));
            if pose.translation.z < 0.3 * circle {
                let got = linear_velocity.dot(&aside);
                let law = vec![(0.0, expected), (scene.time(), expected)];
                let y = "Horizontal velocity (m/s)";
                return Ok(Outcome::over_time(y, curve, "After leaving", law)
                    .said(format!("{got:.4} m/s, analytically {expected:.4}"))
                    .got(got / expected));
            }
        }
        Err(VerifyError::NoEvent("a ball that leaves"))
    }
}

/// Two rounded cubes meet corner to corner, without gravity.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CornersMeet {
    /// Side of the core in mm.
    pub core_mm: f64,
    /// Radius of edges and corners in mm.
    pub radius_mm: f64,
    /// Their relative speed.
    pub speed_m_per_s: f64,
    pub restitution: f64,
    pub friction: f64,
}

impl CornersMeet {
    pub(super) fn run(&self, bench: &Bench) -> Measured {
        const GAP: f64 = 1e-3;
        let shape = rounded(Vector::repeat(from_mm(self.core_mm)), self.radius_mm)?;
        let reach = 0.75_f64.sqrt() * from_mm(self.core_mm) + from_mm(self.radius_mm);
        let pairs = uniform(self.friction, self.restitution);
        let mut scene = bench.scene_under(Vector::zeros(), &pairs)?;
        let diagonal = Vector::repeat(1.0);
        let mut ids = Vec::new();
        for towards in [Vector::x(), -Vector::x()] {
            let turn = UnitQuaternion::rotation_between(&diagonal, &towards)
                .ok_or_else(|| VerifyError::Setup("a diagonal along the line".into()))?;
            let mut body = free(shape.clone(), Vector::zeros());
            let at = -(reach + GAP / 2.0) * towards;
            body.state.pose = Pose::from_parts(at.into(), turn);
            body.state.linear_velocity = 0.5 * self.speed_m_per_s * towards;
            ids.push(scene.add(&body));
        }
        let mut outcome = Outcome::new("Time (s)", "Relative velocity (m/s)");
        let (mut curve, mut spin) = (Vec::new(), 0.0_f64);
        for _ in 0..scene.steps_in(4.0 * GAP / self.speed_m_per_s) {
            scene.step()?;
            let states = scene.states(&ids)?;
            let apart = states[1].linear_velocity.x - states[0].linear_velocity.x;
            spin = largest(states.iter().map(|s| s.angular_velocity.norm()).chain([spin]));
            curve.push((scene.time(), apart));
        }
        let got = at_end(&curve) / self.speed_m_per_s;
        outcome.note = Some(format!("they turn by {spin:.3e} rad/s at most"));
        let after = self.restitution * self.speed_m_per_s;
        outcome.law("Apart", vec![(0.0, after), (scene.time(), after)]);
        outcome.measured("Engine", curve);
        Ok(outcome.got(got))
    }
}

/// A rounded block on steeper and steeper slopes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RoundedTopples {
    /// Sides of the core in mm; the third stands upright.
    pub core_mm: [f64; 3],
    /// Radius of edges and corners in mm.
    pub radius_mm: f64,
    /// Friction coefficient, more than the slope's tangent.
    pub friction: f64,
    /// How long it may take to topple.
    pub duration_s: f64,
}

impl RoundedTopples {
    /// Tangent of the steepest slope on which it stands.
    fn law(&self) -> f64 {
        self.core_mm[0] / (self.core_mm[2] + 2.0 * self.radius_mm)
    }

    /// Whether it topples on a slope of a tangent.
    fn topples(&self, bench: &Bench, tangent: f64) -> Result<bool> {
        const FALLEN: f64 = 10.0;
        let (sin, cos) = tangent.atan().sin_cos();
        let gravity = GRAVITY * Vector::new(sin, 0.0, -cos);
        let mut scene = floored(bench.scene_under(gravity, &uniform(self.friction, 0.0))?, 0.2)?;
        let height = from_mm(self.core_mm[2] / 2.0 + self.radius_mm) + START_GAP;
        let shape = rounded(in_m(self.core_mm), self.radius_mm)?;
        let id = scene.add(&free(shape, Vector::z() * height));
        let mut fallen = false;
        scene.follow(id, self.duration_s, |_, state| {
            let up = state.pose.rotation * Vector::z();
            fallen |= up.angle(&Vector::z()).to_degrees() > FALLEN;
        })?;
        Ok(fallen)
    }

    pub(super) fn run(&self, bench: &Bench) -> Measured {
        const HALVINGS: u32 = 9;
        let law = self.law();
        let range = (0.8, 1.2);
        for (share, expected) in [(range.0, false), (range.1, true)] {
            if self.topples(bench, share * law)? != expected {
                return Err(VerifyError::NoEvent("a block that stands and topples"));
            }
        }
        let mut trials = Vec::new();
        let (stands, falls) = halved(range, HALVINGS, |share| {
            trials.push(((trials.len() + 1) as f64, share));
            self.topples(bench, share * law)
        })?;
        let mut outcome = Outcome::new("Trial", "Slope / slope of the law");
        outcome.measured("Engine", trials);
        outcome.law("Statics", vec![(1.0, 1.0), (f64::from(HALVINGS), 1.0)]);
        let note = format!("it stands at {:.4}, topples at {:.4}", stands * law, falls * law);
        Ok(outcome.said(note).got((stands + falls) / 2.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ball(slope_deg: f64, friction: f64, speed_m_per_s: f64) -> BallOnPlane {
        BallOnPlane { radius_mm: 10.0, slope_deg, friction, speed_m_per_s, duration_s: 1.0 }
    }

    #[test]
    fn a_thrown_ball_rolls_with_five_sevenths_of_its_speed() {
        let thrown = ball(0.0, 0.3, 1.0);
        let rolls_at = 2.0 / (7.0 * 0.3 * GRAVITY);
        let (speed, spin) = thrown.law(2.0 * rolls_at);
        assert!((speed - 5.0 / 7.0).abs() < 1e-12, "law: 5/7 v₀, got {speed}");
        assert!((spin - speed).abs() < 1e-12, "law: it rolls, {spin} and {speed}");
        let (speed, spin) = thrown.law(0.5 * rolls_at);
        assert!(speed > spin + 0.1, "law: it slides until then, {speed} and {spin}");
    }

    #[test]
    fn it_rolls_where_friction_is_two_sevenths_of_the_slope() {
        let slope = 30.0_f64;
        let least = 2.0 / 7.0 * slope.to_radians().tan();
        let (speed, spin) = ball(slope, 1.001 * least, 0.0).law(1.0);
        assert!(
            (speed - 5.0 / 7.0 * GRAVITY * 0.5).abs() < 1e-12 && spin == speed,
            "law: it rolls"
        );
        let (speed, spin) = ball(slope, 0.9 * least, 0.0).law(1.0);
        assert!(speed > 1.05 * spin, "law: it slides, {speed} and {spin}");
        let energy = 0.5 * speed * speed + 0.2 * spin * spin;
        assert!(energy < GRAVITY * 0.5 * 0.5 * speed, "law: sliding costs energy");
    }

    #[test]
    fn a_sharp_block_topples_at_width_over_height() {
        let block = RoundedTopples {
            core_mm: [8.0, 8.0, 24.0],
            radius_mm: 0.0,
            friction: 0.9,
            duration_s: 1.0,
        };
        assert!((block.law() - 1.0 / 3.0).abs() < 1e-12);
        assert!((RoundedTopples { radius_mm: 2.0, ..block }.law() - 2.0 / 7.0).abs() < 1e-12);
    }
}
