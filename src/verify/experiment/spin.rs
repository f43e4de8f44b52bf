//! A thin block that slides and spins on a floor.

use super::spin_law::Slide;
use super::*;
use crate::report::text::number;

/// A thin block with a velocity along its side and an angular velocity about the vertical.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SpinSlide {
    /// Length, width and height in mm; the height small beside the others, so
    /// that all corners bear alike.
    pub sides_mm: [f64; 3],
    pub friction: f64,
    pub speed_m_per_s: f64,
    pub spin_rad_per_s: f64,
    pub quantity: Quantity,
}

/// Several such blocks, each with its own quantity, which is compared with the law's own value.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SpinSlides {
    pub blocks: Vec<SpinSlide>,
}

/// What is measured of a block that spins to rest.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Quantity {
    /// Distance of the centroid from where it began, in mm.
    Distance,
    /// Angle turned, in rad.
    Angle,
    /// Time until it stops, in s.
    Time,
}

/// Time (s) at which a motion that is given at the ends of steps (time, size) has ended: the last
/// two of them that move, carried on in a straight line. A block decelerates evenly at the end.
fn stop(motion: &[(f64, f64)]) -> Option<f64> {
    const REST: f64 = 1e-3;
    let least = REST * motion.first()?.1;
    let last = motion.iter().rposition(|(_, size)| *size > least)?;
    let (t0, m0) = *motion.get(last.checked_sub(1)?)?;
    let (t1, m1) = motion[last];
    // Moves to the end, or faster than before: it has not stopped.
    (last + 1 < motion.len() && m1 < m0).then(|| t1 + m1 * (t1 - t0) / (m0 - m1))
}

impl SpinSlide {
    fn law(&self) -> Slide {
        let half = Vector2::new(self.sides_mm[0], self.sides_mm[1]).map(from_mm) / 2.0;
        Slide {
            half,
            friction: self.friction,
            speed: self.speed_m_per_s,
            spin: self.spin_rad_per_s,
            half_height: 0.0,
        }
    }

    /// What the law says, in the unit of the quantity (mm, rad or s).
    fn expected(&self) -> f64 {
        let end = self.law().end();
        match self.quantity {
            Quantity::Distance => to_mm(end.displacement.norm()),
            Quantity::Angle => end.angle,
            Quantity::Time => end.time,
        }
    }

    pub(super) fn run(&self, bench: &Bench) -> Measured {
        let law = self.law().end();
        let sides = in_m(self.sides_mm);
        let reach = 2.0 * (law.displacement.norm() + sides.x + sides.y);
        let mut scene = on_floor(bench, reach, self.friction)?;
        let start = Vector::new(0.0, 0.0, sides.z / 2.0 + START_GAP);
        let mut body = block(sides, start)?;
        body.state.linear_velocity.x = self.speed_m_per_s;
        body.state.angular_velocity.z = self.spin_rad_per_s;
        let id = scene.add(&body);
        let radius = sides.xy().norm() / 2.0;
        let size = |speed: Vector, spin: f64| speed.xy().norm().hypot(spin * radius);
        let mut motion = vec![(0.0, size(body.state.linear_velocity, self.spin_rad_per_s))];
        let (mut curve, mut moved, mut angle) = (vec![(0.0, 0.0)], Vector::zeros(), 0.0);
        let (mut before, mut points) = (body.state.pose.rotation, 0);
        for _ in 0..scene.steps_in(1.5 * law.time + 0.05) {
            scene.step()?;
            let state = scene.state(id)?;
            points += pushing(&scene);
            moved = state.pose.translation.vector - start;
            // No step turns it by half a turn: the angle is the sum of the steps'.
            angle += (state.pose.rotation * before.inverse()).scaled_axis().z;
            before = state.pose.rotation;
            motion.push((scene.time(), size(state.linear_velocity, state.angular_velocity.z)));
            curve.push((scene.time(), to_mm(moved.xy().norm())));
        }
        // Velocity first, then position: of a velocity that falls from v to 0, steps of length h
        // leave out h v/2.
        let half_step = scene.integration_step() / 2.0;
        let distance = moved.xy().norm() + half_step * self.speed_m_per_s;
        let angle = angle + half_step * self.spin_rad_per_s;
        let time = stop(&motion).ok_or(VerifyError::NoEvent("a stop"))?;
        let note = format!(
            "{:.2} mm, {angle:.3} rad, {time:.4} s; analytically {:.2} mm, {:.3} rad, {:.4} s; \
             {} mm aside, analytically {}; on {:.1} points",
            to_mm(distance),
            to_mm(law.displacement.norm()),
            law.angle,
            law.time,
            number(to_mm(moved.y), 2),
            number(to_mm(law.displacement.y), 2),
            points as f64 / (curve.len() - 1) as f64
        );
        let law = law.curve.iter().map(|(t, d)| (*t, to_mm(*d))).collect();
        let got = match self.quantity {
            Quantity::Distance => to_mm(distance),
            Quantity::Angle => angle,
            Quantity::Time => time,
        };
        let name = "Coulomb's law at four corners";
        Ok(Outcome::over_time("Distance (mm)", curve, name, law).said(note).got(got))
    }
}

impl SpinSlides {
    /// The ratio to the law's value that is furthest from 1.
    pub(super) fn run(&self, bench: &Bench) -> Measured {
        let mut outcome = Outcome::new("Time (s)", "Distance (mm)");
        let (mut ratios, mut notes) = (Vec::new(), Vec::new());
        for block in &self.blocks {
            let law = block.expected();
            let one = block.run(bench)?;
            let name = format!(
                "{:?} mm, μ = {}, {} m/s, {} rad/s",
                block.sides_mm, block.friction, block.speed_m_per_s, block.spin_rad_per_s
            );
            notes.push(format!("{name}: {:.4}, analytically {law:.4}", one.got));
            for mut curve in one.curves {
                curve.name = format!("{name}: {}", curve.name);
                outcome.curves.push(curve);
            }
            ratios.push(one.got / law);
        }
        let worst = worst_of(&ratios, |ratio| (ratio - 1.0).abs());
        Ok(outcome.said(notes.join("; ")).got(worst))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Angle and time are compared for every block whose distance is.
    #[test]
    fn angle_and_time_are_asked_of_every_block_that_slides() {
        let mut single: Vec<_> = cases_of!(SpinSlide, 9).into_iter().map(|(_, s)| s).collect();
        single.retain(|s| s.quantity == Quantity::Distance);
        assert!(single.len() >= 9, "found {} distances", single.len());
        let several: Vec<_> =
            cases_of!(SpinSlides, 2).into_iter().flat_map(|(_, s)| s.blocks).collect();
        for block in single {
            for quantity in [Quantity::Angle, Quantity::Time] {
                let wanted = SpinSlide { quantity, ..block.clone() };
                // What does not spin has no angle to compare.
                let nothing = quantity == Quantity::Angle && block.spin_rad_per_s == 0.0;
                assert!(nothing || several.contains(&wanted), "not asked: {wanted:?}");
            }
        }
        for block in several {
            assert!(block.expected() > 0.0, "law: a ratio needs a value: {block:?}");
        }
    }

    #[test]
    fn a_stop_lies_between_the_steps() {
        // Decelerating by 2 a second from 1: at rest after half a second.
        let even = |dt: f64| -> Vec<(f64, f64)> {
            (0..20).map(|n| dt * f64::from(n)).map(|t| (t, (1.0 - 2.0 * t).max(0.0))).collect()
        };
        for dt in [0.03, 0.04, 0.05, 0.07] {
            let got = stop(&even(dt)).expect("it stops");
            assert!((got - 0.5).abs() < 1e-12, "law: 0.5 s whatever the step, got {got}");
        }
        assert_eq!(stop(&even(0.01)), None, "what still moves has not stopped");
        assert_eq!(stop(&[(0.0, 1.0), (1.0, 2.0), (2.0, 0.0)]), None, "nor what was pushed");
    }

    #[test]
    fn the_files_say_what_the_law_says() {
        for (case, slide) in cases_of!(SpinSlide, 5) {
            let law = slide.expected();
            let off = (case.expected - law).abs();
            assert!(off <= 2e-4 * law, "{}: expected {law}, typed {}", case.id, case.expected);
            if slide.quantity == Quantity::Distance {
                let half_height = from_mm(slide.sides_mm[2]) / 2.0;
                let shifted = Slide { half_height, ..slide.law() }.end().displacement.norm();
                let moved = (to_mm(shifted) - law).abs();
                assert!(
                    moved < 0.2 * case.tolerance,
                    "{}: loads that shift move it by {moved} mm",
                    case.id
                );
            }
        }
    }
}
