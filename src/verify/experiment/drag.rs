//! A block that is dragged over the joint of two floor pieces, level or with a step down.

use super::drag_law::Drag;
use super::*;

/// A block is pushed at a steady velocity from one piece onto the next.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Dragged {
    pub sides_mm: [f64; 3],
    /// Friction coefficient on the floor; the pusher has none.
    pub friction: f64,
    /// The pusher's velocity in m/s.
    pub speed_m_per_s: f64,
    /// Step down to the second piece in mm.
    pub step_mm: f64,
    /// Distance of the joint in front of the block at the beginning, in mm.
    pub before_mm: f64,
    /// How far it is pushed, in mm.
    pub distance_mm: f64,
}

/// Half the floor's width, and the pusher's length, both in m.
const HALF: f64 = 0.1;
const PUSHER: f64 = 0.01;

impl Dragged {
    fn law(&self) -> Drag {
        Drag {
            half_length: from_mm(self.sides_mm[0]) / 2.0,
            height: from_mm(self.sides_mm[2]),
            friction: self.friction,
            step: from_mm(self.step_mm),
        }
    }

    /// Two pieces, the block and what pushes it with an edge at the height of its centroid.
    fn place(&self, scene: &mut Scene) -> Result<(BodyId, BodyId, Body)> {
        let sides = in_m(self.sides_mm);
        let joint = from_mm(self.before_mm) + sides.x / 2.0;
        scene.add(&piece(-HALF, joint, 2.0 * HALF, 0.0)?);
        scene.add(&piece(joint, HALF, 2.0 * HALF, -from_mm(self.step_mm))?);
        let mut body = block(sides, Vector::new(0.0, 0.0, sides.z / 2.0 + START_GAP))?;
        body.state.linear_velocity.x = self.speed_m_per_s;
        let id = scene.add(&body);
        let tip = -sides.x / 2.0 - START_GAP;
        let (middle, thick) = (sides.z / 2.0, sides.z / 4.0);
        let corners =
            [(tip - PUSHER, middle + thick), (tip - PUSHER, middle - thick), (tip, middle)];
        let shape = profile(&corners, sides.y / 2.0)?;
        // Of the plate's material, to have no friction.
        let material = Material::Plate;
        let pusher = Body { motion: Motion::Kinematic, material, ..solid(&shape) };
        Ok((id, scene.add(&pusher), pusher))
    }

    pub(super) fn run(&self, bench: &Bench) -> Measured {
        let pairs = with_plate(uniform(self.friction, 0.0), Material::Grain, 0.0, 0.0);
        let mut scene = bench.scene(&pairs)?;
        let (id, pusher, body) = self.place(&mut scene)?;
        let (mass, _) = mass_of(&block(in_m(self.sides_mm), Vector::zeros())?);
        let (weight, dt) = (mass * GRAVITY, scene.time_step());
        let steps = scene.steps_in(from_mm(self.distance_mm) / self.speed_m_per_s);
        let (mut total, mut tilt, mut recent) = (0.0, 0.0_f64, 0.0);
        let (mut curve, mut down) = (Vec::new(), 0.0);
        let every = (steps / 100).max(1);
        for n in 1..=steps {
            let displacement = self.speed_m_per_s * dt * n as f64;
            scene.shift(pusher, &body.state.pose, Vector::new(displacement, 0.0, 0.0))?;
            scene.step()?;
            let forward = -scene.impulse_on(pusher).x;
            total += forward;
            recent += forward;
            let state = scene.state(id)?;
            down = from_mm(self.sides_mm[2]) / 2.0 - state.pose.translation.z;
            tilt = tilt.max((state.pose.rotation * Vector::x()).z.abs());
            if n % every == 0 {
                let mean = recent / (every as f64 * dt * weight * self.friction);
                curve.push((to_mm(self.speed_m_per_s * scene.time()), mean));
                recent = 0.0;
            }
        }
        // The block lies on the lower piece if it was pushed over the edge at all.
        let there = (to_mm(down) - self.step_mm).abs() < 0.05 + 0.1 * self.step_mm;
        let got = total / (steps as f64 * dt * weight * self.friction);
        let law = self.law();
        let mean = law.mean(from_mm(self.distance_mm));
        let mut outcome = Outcome::new("Pushed by (mm)", "Force / μ m g");
        outcome.note = Some(format!(
            "{got:.4}, analytically {mean:.4}; {:.4} mm lower at the end, tilted by {:.2}° at most, analytically {:.2}°",
            to_mm(down),
            tilt.min(1.0).asin().to_degrees(),
            (law.step / law.tips()).asin().to_degrees()
        ));
        outcome.measured("Engine", curve);
        let way = |x: f64| to_mm(x + 2.0 * law.half_length) + self.before_mm;
        let tilted = law.tilted();
        let tilted: Vec<(f64, f64)> =
            tilted.iter().step_by(50).map(|(x, f)| (way(*x), f / self.friction)).collect();
        // Flat before the block tips and after it lies on the lower piece.
        let (tips, lies) = (tilted[0].0, tilted[tilted.len() - 1].0);
        let mut points = vec![(0.0, 1.0), (tips, 1.0)];
        points.extend(tilted);
        points.extend([(lies, 1.0), (self.distance_mm, 1.0)]);
        outcome.law("Statics", points);
        Ok(outcome.got(if there { got } else { f64::NAN }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_files_say_what_the_law_says() {
        let cases = cases_of!(Dragged, 2);
        assert_eq!(cases.len(), 2, "with and without a step");
        for (case, dragged) in cases {
            let [length, ..] = dragged.sides_mm;
            let passes = dragged.before_mm + length;
            assert!(dragged.distance_mm > 1.1 * passes, "{}: it passes the edge", case.id);
            let law = dragged.law().mean(from_mm(dragged.distance_mm));
            assert!((case.expected - law).abs() < 5e-5, "{}: expected {law}", case.id);
            // A step that were not felt, and one that caught the block, would be seen.
            let seen = dragged.step_mm == 0.0 || (1.0 - law) > 2.0 * case.tolerance;
            assert!(seen, "{}: {law} is {} from 1", case.id, case.tolerance);
        }
    }
}
