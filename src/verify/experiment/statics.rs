//! Assemblies of blocks that stand by friction alone, and the least
//! coefficient of friction with which they do.
//!
//! Both are mechanisms of one degree of freedom in which two contacts must slip at once. With more
//! friction than the value at which both are fully used, friction against the motion is more than
//! what drives it, so that the assembly stands; with less no forces in the cones keep it.
//!
//! **Arch.** A keystone of weight W hangs between two blocks of weight w each, on faces that lean
//! by β from the vertical; these stand on the floor. Each face bears the vertical W/2; the force
//! leans by at most φ = atan μ from the face's normal, so that its horizontal part is at least W/2
//! · cot(β + φ). The floor resists with at most μ (w + W/2). The arch stands where cot(β + φ) W/2 ≤
//! μ (w + W/2).
//!
//! **Ladder.** A bar of length L and thickness t leans at an angle θ from the floor against a wall,
//! on the two corners of its lower face. With both used, the wall's N₂ = μ N₁, N₁ + μ N₂ = W, and
//! moments about the foot give W (L/2 cos θ − t/2 sin θ) = N₂ (L sin θ + μ L cos θ).

use std::convert::Infallible;

use super::*;

/// An assembly that is set down with ever closer coefficients of friction
/// with which it stands and falls.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CriticalFriction {
    pub assembly: Assembly,
    /// Time in s in which it must not move.
    pub duration_s: f64,
}

/// Blocks that lean on each other or on a wall.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(tag = "of", rename_all = "snake_case", deny_unknown_fields)]
pub enum Assembly {
    /// Three blocks.
    Arch {
        /// β in degrees.
        lean_deg: f64,
        /// Width of the blocks at the sides at their foot, in mm.
        foot_mm: f64,
    },
    /// A bar against a wall.
    Ladder {
        /// θ in degrees.
        angle_deg: f64,
        /// L in mm.
        length_mm: f64,
        /// t in mm.
        thickness_mm: f64,
    },
}

/// Half the keystone's width at its lower face, in m.
const KEY_HALF: f64 = 0.005;
/// Height of the keystone, in m, and what it hangs above the floor.
const KEY_HEIGHT: f64 = 0.02;
const CLEARANCE: f64 = 0.005;
/// All of it, along y, in m.
const DEPTH: f64 = 0.02;
/// Range of friction that is tried, as shares of what the law says, and the halvings of it.
const RANGE: (f64, f64) = (0.9, 1.1);
const HALVINGS: u32 = 6;
/// What sinks by more, in m, falls.
const FALLS: f64 = 0.2e-3;

/// Least friction coefficient at which `holds` is true, between 0 and 10.
fn least(holds: impl Fn(f64) -> bool) -> f64 {
    let Ok((_, high)) = halved((0.0, 10.0), 60, |mu| Ok::<_, Infallible>(holds(mu)));
    high
}

impl Assembly {
    /// Corners of keystone and right block in the x-z plane, in m.
    fn arch(lean: f64, foot: f64) -> (Points, Points) {
        let face = |z: f64| KEY_HALF + (z - CLEARANCE) * lean.tan();
        let top = CLEARANCE + KEY_HEIGHT;
        let (inner, outer, upper) = (face(0.0), face(0.0) + foot, face(top));
        let key = vec![(-KEY_HALF, CLEARANCE), (KEY_HALF, CLEARANCE), (upper, top), (-upper, top)];
        (key, vec![(inner, 0.0), (outer, 0.0), (outer, top), (upper, top)])
    }

    /// The least friction coefficient by statics.
    fn law(&self) -> f64 {
        match *self {
            Self::Arch { lean_deg, foot_mm } => {
                let lean = from_deg(lean_deg);
                let area = |polygon: &[(f64, f64)]| -> f64 {
                    (0..polygon.len())
                        .map(|i| (polygon[i], polygon[(i + 1) % polygon.len()]))
                        .map(|((x0, z0), (x1, z1))| 0.5 * (x0 * z1 - x1 * z0))
                        .sum()
                };
                let (key, side) = Self::arch(lean, from_mm(foot_mm));
                let ratio = area(&side) / area(&key);
                least(|mu| 0.5 / (lean + mu.atan()).tan() <= mu * (ratio + 0.5))
            }
            Self::Ladder { angle_deg, length_mm, thickness_mm } => {
                let (sin, cos) = from_deg(angle_deg).sin_cos();
                let centroid = 0.5 * (length_mm * cos - thickness_mm * sin);
                least(|mu| centroid * (1.0 + mu * mu) <= mu * length_mm * (sin + mu * cos))
            }
        }
    }

    /// The bodies, and which of them is watched.
    fn bodies(&self) -> Result<(Vec<Body>, usize)> {
        match *self {
            Self::Arch { lean_deg, foot_mm } => {
                let (key, side) = Self::arch(from_deg(lean_deg), from_mm(foot_mm));
                let mirrored: Vec<_> = side.iter().rev().map(|(x, z)| (-x, *z)).collect();
                let place = |polygon: &[(f64, f64)], by: Vector| -> Result<Body> {
                    let mut body = solid(&profile(polygon, DEPTH)?);
                    body.state.pose.translation.vector += by;
                    Ok(body)
                };
                let up = Vector::z() * START_GAP;
                let aside = Vector::x() * START_GAP;
                let bodies = vec![
                    place(&key, up)?,
                    place(&side, up + aside)?,
                    place(&mirrored, up - aside)?,
                ];
                Ok((bodies, 0))
            }
            Self::Ladder { angle_deg, length_mm, thickness_mm } => {
                const WALL: f64 = 0.02;
                let (length, thickness) = (from_mm(length_mm), from_mm(thickness_mm));
                let angle = from_deg(angle_deg);
                // Its length is x of the body; leaning turns x towards z, against y.
                let rotation = about_y(-angle);
                let mut bar = block(Vector::new(length, DEPTH, thickness), Vector::zeros())?;
                let foot = rotation * Vector::new(-length / 2.0, 0.0, -thickness / 2.0);
                let at = Vector::z() * START_GAP - foot;
                bar.state.pose = Pose::from_parts(at.into(), rotation);
                let face = length * angle.cos() + START_GAP;
                let height = 2.0 * length;
                let sides = Vector::new(WALL, 2.0 * DEPTH, height);
                let at = Vector::new(face + WALL / 2.0, 0.0, height / 2.0);
                Ok((vec![wall(sides, at, Motion::Static)?, bar], 1))
            }
        }
    }
}

impl CriticalFriction {
    /// How far in mm the body that is watched sinks, over time.
    fn sinks(&self, bench: &Bench, friction: f64) -> Result<Points> {
        let mut scene = on_floor(bench, 0.3, friction)?;
        let (bodies, watched) = self.assembly.bodies()?;
        let ids: Vec<BodyId> = bodies.iter().map(|body| scene.add(body)).collect();
        let start = bodies[watched].state.pose.translation.z;
        let mut curve = Vec::new();
        for _ in 0..scene.steps_in(self.duration_s) {
            scene.step()?;
            let sunk = start - scene.state(ids[watched])?.pose.translation.z;
            curve.push((scene.time(), to_mm(sunk)));
            if sunk > 10.0 * FALLS {
                break;
            }
        }
        Ok(curve)
    }

    pub(super) fn run(&self, bench: &Bench) -> Measured {
        let law = self.assembly.law();
        let mut outcome = Outcome::new("Time (s)", "Sinks by (mm)");
        let mut stands = |friction: f64, show: bool| -> Result<bool> {
            let curve = self.sinks(bench, friction)?;
            let sunk = largest(curve.iter().map(|(_, z)| *z));
            if show {
                outcome.measured(format!("μ = {friction:.4}"), curve);
            }
            Ok(sunk <= to_mm(FALLS))
        };
        let (low, high) = (RANGE.0 * law, RANGE.1 * law);
        let (low_stands, high_stands) = (stands(low, true)?, stands(high, true)?);
        if low_stands == high_stands {
            // Outside of what was tried; which end says on which side.
            let (end, does) = if low_stands { (low, "stands") } else { (high, "falls") };
            let note = format!("{does} from μ = {low:.4} to {high:.4}; by statics {law:.4}");
            return Ok(outcome.said(note).got(end));
        }
        let (low, high) = halved((low, high), HALVINGS, |friction| stands(friction, false))?;
        outcome.law("Stands", vec![(0.0, 0.0), (self.duration_s, 0.0)]);
        let note = format!("falls at {low:.4}, stands at {high:.4}; by statics {law:.4}");
        Ok(outcome.said(note).got(0.5 * (low + high)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_least_is_found_from_both_sides() {
        for edge in [0.2, 0.7, 3.0] {
            let got = least(|mu| mu >= edge);
            assert!((got - edge).abs() < 1e-12, "law: {edge}, got {got}");
        }
    }

    #[test]
    fn a_thin_ladder_is_that_of_the_textbook() {
        // μ = tan(45° − θ/2) for equal friction at wall and floor.
        for angle_deg in [30.0, 45.0, 60.0] {
            let ladder = Assembly::Ladder { angle_deg, length_mm: 40.0, thickness_mm: 0.0 };
            let expected = from_deg(45.0 - angle_deg / 2.0).tan();
            let got = ladder.law();
            assert!((got - expected).abs() < 1e-9, "law: {expected} at {angle_deg}°, got {got}");
        }
    }

    #[test]
    fn a_heavy_abutment_needs_little_friction_and_a_steep_face_much() {
        let arch = |lean_deg, foot_mm| Assembly::Arch { lean_deg, foot_mm }.law();
        assert!(arch(20.0, 60.0) < arch(20.0, 30.0), "law: weight helps");
        assert!(arch(10.0, 30.0) > arch(20.0, 30.0), "law: steep faces thrust more");
    }

    /// Law: with a friction that is 1 % too small the keystone of mass m sinks with a,
    /// m a = m g − 2 N (sin β + μ cos β), and blocks of mass M at its sides go aside with a tan β,
    /// M a tan β = N (cos β − μ sin β) − μ (M g + N (sin β + μ cos β)).
    #[test]
    fn the_source_of_the_arch_says_how_far_its_keystone_sinks() {
        let mut cases = cases_of!(CriticalFriction, 2).into_iter();
        let (case, critical) =
            cases.find(|(c, _)| c.id == "arch-critical-friction").expect("the arch");
        let Assembly::Arch { lean_deg, .. } = critical.assembly else { panic!("an arch") };
        let (bodies, _) = critical.assembly.bodies().expect("bodies");
        let (key, side) = (mass_of(&bodies[0]).0, mass_of(&bodies[1]).0);
        let (sin, cos) = from_deg(lean_deg).sin_cos();
        let (mu, tan) = (0.99 * critical.assembly.law(), sin / cos);
        let (up, aside) = (sin + mu * cos, cos - mu * sin);
        let normal = side * GRAVITY * (tan + mu) / (aside - mu * up + 2.0 * side / key * tan * up);
        let sunk = 0.5 * (GRAVITY - 2.0 * normal * up / key) * critical.duration_s.powi(2);
        let expected = format!("would sink by {:.0} mm in the time", to_mm(sunk));
        assert!(case.source.contains(&expected), "law: {expected}, got `{}`", case.source);
    }

    /// The forces at the critical friction, put together anew from the bodies
    /// themselves: nothing is left over, and no block tips.
    #[test]
    fn forces_of_the_arches_balance_and_blocks_do_not_tip() {
        for (case, critical) in cases_of!(CriticalFriction, 2) {
            let mu = critical.assembly.law();
            let off = (case.expected - mu).abs();
            assert!(off < 2e-4, "{}: expected {mu}, typed {}", case.id, case.expected);
            let Assembly::Arch { lean_deg, foot_mm } = critical.assembly else { continue };
            let (bodies, _) = critical.assembly.bodies().expect("bodies");
            let weights: Vec<f64> = bodies.iter().map(|b| mass_of(b).0).collect();
            let (sin, cos) = from_deg(lean_deg).sin_cos();
            // Normal and friction of one face, fully used, bear half the keystone.
            let normal = 0.5 * weights[0] / (sin + mu * cos);
            let thrust = normal * (cos - mu * sin);
            let floor = weights[1] + 0.5 * weights[0];
            let rest = thrust - mu * floor;
            assert!(rest.abs() < 1e-9 * floor, "law: balance, {rest} of {floor} is left");
            // Even at the top of the face the thrust turns no block over its outer edge.
            let arm = from_mm(foot_mm) / 2.0;
            let turning = thrust * (CLEARANCE + KEY_HEIGHT);
            assert!(turning < weights[1] * arm, "{}: tips", case.id);
        }
    }
}
