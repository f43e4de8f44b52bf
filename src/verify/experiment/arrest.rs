//! A body whose approach to a floor is arrested by something else.
//!
//! It comes fast, is caught a little above the floor, rests there, and is then let down. The
//! coefficient of restitution belongs to the velocity of the impact itself: what the body had
//! before it was caught is gone. Let down at a steady velocity u it leaves the floor with at most e
//! u, and with nothing where u is below the threshold of restitution. Gravity takes that away
//! within u e/g, less than a step of most engines: at the ends of steps the upward velocity is
//! between 0 and e u. Let go instead, it falls freely by the distance d that is left, with √(2 g
//! d), and rises to e² d; little gravity makes that last many steps.
//!
//! Or the floor comes up to the block at a steady velocity U and goes on. What holds the block does
//! not pull, so that only the floor's impulse acts: seen from the floor the block arrives with U,
//! leaves with e U, and rises by (e U)²/2g (Newton's coefficient; one flat impact without slip,
//! where Poisson's and Stronge's are the same). Because U may be large, gravity leaves the rebound
//! visible. This value is exact in both directions; "at most e u" also holds for a solver that
//! never rebounds. A block that sinks therefore counts only if more than half of the gap is left
//! before it is let down, and if the same block, caught likewise and met by the floor,
//! rebounds with at least half of e and at most half as much again.

use super::*;

/// A block falls, is caught above a floor, and is let down on it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ApproachArrested {
    pub caught_by: Catch,
    /// Gap to the floor where it is caught, in mm.
    pub gap_mm: f64,
    /// Height above that from which it falls, in mm.
    pub fall_mm: f64,
    /// Downward velocity with which it begins, in m/s.
    pub speed_m_per_s: f64,
    pub gravity_m_per_s2: f64,
    /// Coefficient of restitution on the floor.
    pub restitution: f64,
    /// Coefficient of restitution on what catches it.
    pub restitution_of_catch: f64,
    /// Friction coefficient, everywhere.
    pub friction: f64,
    /// Time until it is let down, in s.
    pub rest_s: f64,
    /// How far it is lifted before, in mm.
    pub lift_mm: f64,
    pub then: LetDown,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Catch {
    /// Two kinematic ledges under its ends.
    Ledges,
    /// Two leaning kinematic clamps, between which a wedge gets stuck.
    Clamps,
    /// Two piles of two cubes each, on kinematic ledges.
    Piles,
}

/// How a block is let down, and what is measured.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(tag = "how", rename_all = "snake_case", deny_unknown_fields)]
pub enum LetDown {
    /// Steadily: largest upward velocity afterwards, in mm/s.
    Sinks { speed_mm_per_s: f64 },
    /// What held it is pulled away: √(rise/fall).
    Drops,
    /// It is not; the floor comes up steadily: velocity of separation over that of approach.
    Meets {
        /// The floor's velocity in mm/s.
        speed_mm_per_s: f64,
    },
}

/// Length of the block; half the width of the floor's pedestal; where the ends rest. All in m.
const LENGTH: f64 = 0.06;
const SIDE: f64 = 0.01;
const PEDESTAL: f64 = 0.014;
const ENDS: f64 = 0.025;
/// Lean of the clamps from the vertical in degrees, height of the wedge in m.
const LEAN_DEG: f64 = 10.0;
const WEDGE: f64 = 0.02;
/// Velocity in m/s with which what holds a block that drops goes away, and how far in m.
const AWAY: f64 = 1.0;
const GONE: f64 = 0.02;
/// Velocity in mm/s of the floor that meets a block to show that it rebounds at all.
const MEETS: f64 = 1000.0;
/// Velocity in m/s with which it is lifted.
const LIFTS: f64 = 0.5e-3;

/// What holds the block: kinematic bodies, each with the direction (not of
/// unit length) in which it goes when the block is to go down by one.
struct Holder {
    bodies: Vec<(BodyId, Pose, Vector)>,
    floor: (BodyId, Pose),
}

impl Holder {
    /// Lets the block down by a depth (m) at the end of the next step.
    fn lower(&self, scene: &mut Scene, depth: f64) -> Result<()> {
        for (id, pose, way) in &self.bodies {
            scene.shift(*id, pose, way * depth)?;
        }
        Ok(())
    }
}

impl ApproachArrested {
    /// The block where it would rest on what catches it.
    fn block(&self) -> Result<Body> {
        let gap = from_mm(self.gap_mm);
        match self.caught_by {
            Catch::Ledges | Catch::Piles => {
                block(Vector::new(LENGTH, SIDE, SIDE), Vector::new(0.0, 0.0, gap + SIDE / 2.0))
            }
            Catch::Clamps => {
                let (low, high) = (SIDE / 2.0, SIDE / 2.0 + WEDGE * from_deg(LEAN_DEG).tan());
                let corners = [(-low, gap), (low, gap), (high, gap + WEDGE), (-high, gap + WEDGE)];
                Ok(solid(&profile(&corners, SIDE)?))
            }
        }
    }

    /// Floor, what catches the block, and cubes where those are part of it.
    fn place(&self, scene: &mut Scene) -> Result<Holder> {
        const DEEP: f64 = 0.04;
        const THICK: f64 = 0.01;
        let gap = from_mm(self.gap_mm);
        let half = if self.caught_by == Catch::Clamps { SIDE / 2.0 } else { PEDESTAL };
        let sides = Vector::new(2.0 * half, 2.0 * SIDE, DEEP);
        let motion = match self.then {
            LetDown::Meets { .. } => Motion::Kinematic,
            LetDown::Sinks { .. } | LetDown::Drops => Motion::Static,
        };
        let floor = wall(sides, Vector::new(0.0, 0.0, -DEEP / 2.0), motion)?;
        let floor = (scene.add(&floor), floor.state.pose);
        let mut bodies = Vec::new();
        let mut hold = |scene: &mut Scene, mut body: Body, way: Vector| {
            // Of the plate's material, to have coefficients of its own.
            body.material = Material::Plate;
            bodies.push((scene.add(&body), body.state.pose, way));
        };
        for side in [-1.0, 1.0] {
            match self.caught_by {
                Catch::Ledges | Catch::Piles => {
                    let piled = if self.caught_by == Catch::Piles { 2.0 * SIDE } else { 0.0 };
                    let at = Vector::new(side * ENDS, 0.0, gap - piled - THICK / 2.0);
                    let sides = Vector::new(1.2 * SIDE, 2.0 * SIDE, THICK);
                    hold(scene, wall(sides, at, Motion::Kinematic)?, -Vector::z());
                }
                Catch::Clamps => {
                    let lean = from_deg(LEAN_DEG);
                    let turn = about_y(side * lean);
                    let sides = Vector::new(THICK, 2.0 * SIDE, 3.0 * WEDGE);
                    // Beside the middle of the wedge's face, whose normal is x turned.
                    let beside = SIDE / 2.0 + 0.5 * WEDGE * lean.tan();
                    let face = Vector::new(side * beside, 0.0, gap + 0.5 * WEDGE);
                    let at = face + turn * Vector::x() * (side * THICK / 2.0);
                    let mut body = wall(sides, Vector::zeros(), Motion::Kinematic)?;
                    body.state.pose = Pose::from_parts(at.into(), turn);
                    hold(scene, body, Vector::x() * (side * lean.tan()));
                }
            }
        }
        if self.caught_by == Catch::Piles {
            for side in [-1.0, 1.0] {
                for n in [1.5, 0.5] {
                    let at = Vector::new(side * ENDS, 0.0, gap - n * SIDE);
                    scene.add(&block(Vector::repeat(SIDE), at)?);
                }
            }
        }
        Ok(Holder { bodies, floor })
    }

    pub(super) fn run(&self, bench: &Bench) -> Measured {
        let gravity = Vector::new(0.0, 0.0, -self.gravity_m_per_s2);
        let pairs = uniform(self.friction, self.restitution);
        let pairs = with_plate(pairs, Material::Grain, self.friction, self.restitution_of_catch);
        let mut scene = bench.scene_under(gravity, &pairs)?;
        let holder = self.place(&mut scene)?;
        let mut body = self.block()?;
        let caught = body.state.pose.translation.z;
        body.state.pose.translation.z += from_mm(self.fall_mm);
        body.state.linear_velocity.z = -self.speed_m_per_s;
        let id = scene.add(&body);
        let (gap, lift) = (from_mm(self.gap_mm), from_mm(self.lift_mm));
        let dt = scene.time_step();
        scene.run(self.rest_s)?;
        for n in 1..=scene.steps_in(lift / LIFTS) {
            holder.lower(&mut scene, -(LIFTS * dt * n as f64).min(lift))?;
            scene.step()?;
        }
        if lift > 0.0 {
            scene.run(0.2)?;
        }
        let distance = gap + lift;
        let (speed, depth, duration) = match self.then {
            LetDown::Sinks { speed_mm_per_s } => {
                let speed = from_mm(speed_mm_per_s);
                // Until well after it has met the floor.
                (speed, f64::INFINITY, 2.0 * distance / speed + 0.25)
            }
            LetDown::Drops => {
                let fall = (2.0 * distance / self.gravity_m_per_s2).sqrt();
                (AWAY, GONE, fall * (1.0 + 2.0 * self.restitution) * 1.1)
            }
            LetDown::Meets { speed_mm_per_s } => {
                return self.met(&mut scene, &holder, id, distance, from_mm(speed_mm_per_s));
            }
        };
        let start = scene.state(id)?;
        let (begin, mut motion) = (scene.time(), Vec::new());
        for n in 1..=scene.steps_in(duration) {
            holder.lower(&mut scene, (speed * dt * n as f64).min(depth) - lift)?;
            scene.step()?;
            let state = scene.state(id)?;
            let height = state.pose.translation.z - caught + gap;
            motion.push((scene.time() - begin, height, state.linear_velocity.z));
        }
        let upwards = largest(motion.iter().map(|m| m.2));
        let lowest = motion.iter().map(|m| m.1).fold(f64::INFINITY, f64::min);
        let note = format!(
            "caught {:.1} µm above the floor for {:.0}, there with {:.3} mm/s; then down to {:.1} µm, \
             and up with {:.2} mm/s at most",
            1e6 * (start.pose.translation.z - caught + gap),
            1e6 * distance,
            to_mm(start.linear_velocity.norm()),
            1e6 * lowest,
            to_mm(upwards)
        );
        let mut outcome = Outcome::new("Time since it is let down (s)", "Height (µm)");
        outcome.measured("Engine", motion.iter().map(|m| (m.0, 1e6 * m.1)).collect());
        // What never comes down shows nothing of the impact.
        let came_down = lowest < 0.5 * distance;
        if self.then == LetDown::Drops {
            let (g, e) = (self.gravity_m_per_s2, self.restitution);
            let law = over(duration, 200, |t| 1e6 * rebounding(distance, g, e, t).max(0.0));
            outcome.law("Falls freely and rebounds", law);
            let rise = if came_down { rise_after_fall(&motion) } else { f64::NAN };
            return Ok(outcome.said(note).got((rise / distance).sqrt()));
        }
        let ground = distance / speed;
        outcome.law("Let down", vec![(0.0, 1e6 * distance), (ground, 0.0), (duration, 0.0)]);
        let met = Self { then: LetDown::Meets { speed_mm_per_s: MEETS }, ..self.clone() };
        let rebounds = met.run(bench)?.got;
        let note = format!("{note}; met by the floor it rebounds with {rebounds:.3}");
        // What was on the floor before it was let down met nothing there.
        let held = start.pose.translation.z - caught > -0.5 * gap;
        let shows = held && came_down && (rebounds / self.restitution - 1.0).abs() < 0.5;
        Ok(outcome.said(note).got(if shows { to_mm(upwards) } else { f64::NAN }))
    }

    /// The floor comes up to the block, from a distance (m) and at a velocity (m/s), until the
    /// block has risen from it as far as it will.
    fn met(
        &self,
        scene: &mut Scene,
        holder: &Holder,
        id: BodyId,
        distance: f64,
        speed: f64,
    ) -> Measured {
        let g = self.gravity_m_per_s2;
        let meets = distance / speed;
        let leaves = self.restitution * speed;
        let duration = meets + 1.3 * leaves / g + 2.0 * scene.time_step();
        let (begin, dt) = (scene.time(), scene.time_step());
        let (start, mut motion) = (scene.state(id)?.pose.translation.z, vec![(0.0, distance)]);
        for n in 1..=scene.steps_in(duration) {
            let raised = speed * dt * n as f64;
            scene.shift(holder.floor.0, &holder.floor.1, Vector::new(0.0, 0.0, raised))?;
            scene.step()?;
            let height = scene.state(id)?.pose.translation.z - start + distance - raised;
            motion.push((scene.time() - begin, height));
        }
        let rise = largest(motion.iter().filter(|m| m.0 > meets).map(|m| m.1.max(0.0)));
        // `max` passes over what is no number.
        let lost = motion.iter().any(|m| m.1.is_nan());
        let mut outcome = Outcome::new("Time since the floor rises (s)", "Height over it (mm)");
        outcome.note = Some(format!(
            "rises by {:.3} mm from the floor, analytically {:.3}",
            to_mm(rise),
            to_mm(0.5 * leaves * leaves / g)
        ));
        outcome.measured("Engine", motion.iter().map(|m| (m.0, to_mm(m.1))).collect());
        let law = over(duration, 200, |t| {
            let after = t - meets;
            let away = leaves * after - 0.5 * g * after * after;
            to_mm(if after < 0.0 { distance - speed * t } else { away.max(0.0) })
        });
        outcome.law("Waits and rebounds", law);
        Ok(outcome.got(if lost { f64::NAN } else { (2.0 * g * rise).sqrt() / speed }))
    }
}

/// Largest height (m) after the first impact of a motion (time, height,
/// upward velocity) that falls to less than half its height.
fn rise_after_fall(motion: &[(f64, f64, f64)]) -> f64 {
    let half = 0.5 * motion.first().map_or(0.0, |m| m.1);
    let fallen = motion.iter().position(|m| m.1 < half).unwrap_or(motion.len());
    let after = &motion[fallen..];
    // Where it no longer goes down it has landed.
    let landed = after.windows(2).position(|m| m[1].1 >= m[0].1).unwrap_or(after.len());
    largest(after[landed..].iter().map(|m| m.1))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenario::EngineSettings;

    #[test]
    fn the_files_expect_what_the_threshold_of_restitution_allows() {
        let threshold = 1e3 * EngineSettings::default().restitution_velocity_threshold_m_per_s;
        for (case, arrested) in cases_of!(ApproachArrested, 5) {
            match arrested.then {
                LetDown::Sinks { speed_mm_per_s } => {
                    let rebounds = speed_mm_per_s > threshold;
                    let most = if rebounds { arrested.restitution * speed_mm_per_s } else { 0.0 };
                    assert_eq!(case.expected, 0.0, "{}: from 0", case.id);
                    let above = case.tolerance - most;
                    assert!((0.0..=0.5).contains(&above), "{}: to {most} and a little", case.id);
                }
                LetDown::Drops => {
                    let distance = from_mm(arrested.gap_mm + arrested.lift_mm);
                    let speed = to_mm((2.0 * arrested.gravity_m_per_s2 * distance).sqrt());
                    assert!(speed > 2.0 * threshold, "{}: {speed} mm/s rebounds", case.id);
                    assert_eq!(case.expected, arrested.restitution, "{}", case.id);
                }
                LetDown::Meets { speed_mm_per_s } => {
                    assert_eq!(case.expected, arrested.restitution, "{}", case.id);
                    // The approach before the block was caught, were it not forgotten.
                    let fall = 2.0 * arrested.gravity_m_per_s2 * from_mm(arrested.fall_mm);
                    let before = to_mm((fall + arrested.speed_m_per_s.powi(2)).sqrt());
                    let off = arrested.restitution * (before / speed_mm_per_s - 1.0).abs();
                    assert!(off > 5.0 * case.tolerance, "{}: it would be seen, {off}", case.id);
                    assert!(speed_mm_per_s > 2.0 * threshold, "{}: it rebounds", case.id);
                }
            }
        }
    }

    #[test]
    fn a_wedge_touches_both_clamps_where_it_is_caught() {
        let cases = cases_of!(ApproachArrested, 5).into_iter();
        for (case, arrested) in cases.filter(|(_, a)| a.caught_by == Catch::Clamps) {
            let lean = from_deg(LEAN_DEG);
            assert!(arrested.friction > lean.tan(), "{}: friction holds the wedge", case.id);
            let body = arrested.block().expect("a wedge");
            let vertices = body.shape.vertices().iter().map(|v| body.state.pose * v);
            for corner in vertices {
                let gap = from_mm(arrested.gap_mm);
                let face = SIDE / 2.0 + (corner.z - gap) * lean.tan();
                let off = corner.x.abs() - face;
                assert!(off.abs() < 1e-12, "law: {corner} is on a clamp's face, off by {off:e}");
            }
        }
    }

    #[test]
    fn the_rise_is_that_after_the_impact() {
        let heights = [1.0, 0.9, 0.45, 0.1, 0.02, 0.2, 0.25, 0.1, 0.0];
        let motion: Vec<_> = heights.iter().map(|h| (0.0, *h, 0.0)).collect();
        assert_eq!(rise_after_fall(&motion), 0.25);
        assert_eq!(rise_after_fall(&motion[..5]), 0.0, "law: no impact, no rise");
        assert_eq!(rise_after_fall(&motion[..2]), 0.0, "law: nor without a fall");
    }

    #[test]
    fn a_dropped_body_rises_to_the_square_of_the_restitution() {
        let mut cases = cases_of!(ApproachArrested, 5).into_iter();
        let (_, drops) = cases.find(|(_, a)| a.then == LetDown::Drops).expect("one");
        let (g, e) = (drops.gravity_m_per_s2, drops.restitution);
        let fall = (2.0 * 1e-4 / g).sqrt();
        let peak = rebounding(1e-4, g, e, fall * (1.0 + e));
        let expected = e * e * 1e-4;
        assert!((peak - expected).abs() < 1e-12, "law: e² d = {expected}, got {peak}");
        assert_eq!(rebounding(1e-4, g, e, 0.0), 1e-4, "law: it begins at d");
    }
}
