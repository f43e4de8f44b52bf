//! A block on a shaking table: Newmark's sliding block, with the table moving both ways.

use super::friction::BLOCK;
use super::*;

const FLOOR_CENTRE: f64 = -0.01;

/// The table's harmonic motion x = A sin ωt, which begins with full speed as
/// the experiment's does; the block begins with the table's speed.
#[derive(Clone, Copy)]
struct Table {
    amplitude: f64,
    omega: f64,
}

impl Table {
    fn place(&self, t: f64) -> f64 {
        self.amplitude * (self.omega * t).sin()
    }

    fn speed(&self, t: f64) -> f64 {
        self.amplitude * self.omega * (self.omega * t).cos()
    }

    fn acceleration(&self, t: f64) -> f64 {
        -self.amplitude * self.omega * self.omega * (self.omega * t).sin()
    }
}

/// Travel of the block on the table by Coulomb's law: it sticks while the table's acceleration
/// stays below μg, and slides with μg against its relative speed until that is nothing (Newmark
/// 1965), integrated in steps small enough to count as exact.
fn newmark(table: Table, friction: f64, times: &[f64]) -> Vec<f64> {
    const STEP: f64 = 2e-6;
    let limit = friction * GRAVITY;
    let (mut travel, mut speed, mut n) = (0.0, 0.0_f64, 0_u64);
    let mut out = Vec::with_capacity(times.len());
    for &time in times {
        while (n as f64 + 0.5) * STEP < time {
            let inertia = -table.acceleration((n as f64 + 0.5) * STEP);
            if speed == 0.0 && inertia.abs() <= limit {
                n += 1;
                continue;
            }
            let against = if speed == 0.0 { inertia.signum() } else { speed.signum() };
            let next = speed + (inertia - limit * against) * STEP;
            // A block that comes to rest on the table within a step sticks.
            let next = if speed != 0.0 && next * speed < 0.0 { 0.0 } else { next };
            travel += 0.5 * (speed + next) * STEP;
            speed = next;
            n += 1;
        }
        out.push(travel);
    }
    out
}

/// A block on a shaking table.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BlockOnTable {
    friction: f64,
    frequency_hz: f64,
    amplitude_mm: f64,
    duration_s: f64,
}

impl BlockOnTable {
    pub(super) fn run(&self, bench: &Bench) -> Measured {
        let table = Table { amplitude: from_mm(self.amplitude_mm), omega: TAU * self.frequency_hz };
        let mut scene = bench.scene(&uniform(self.friction, 0.0))?;
        let plate = scene.add(&floor(0.3, Motion::Kinematic)?);
        let mut body = block(BLOCK, Vector::new(0.0, 0.0, BLOCK.z / 2.0 + START_GAP))?;
        body.state.linear_velocity.x = table.speed(0.0);
        let id = scene.add(&body);
        let (mut times, mut travel) = (Vec::new(), Vec::new());
        for n in 1..=scene.steps_in(self.duration_s) {
            let time = n as f64 * scene.time_step();
            scene.drive(plate, &Pose::translation(table.place(time), 0.0, FLOOR_CENTRE))?;
            scene.step()?;
            times.push(time);
            travel.push(scene.state(id)?.pose.translation.vector.x - table.place(time));
        }
        let law = newmark(table, self.friction, &times);
        let off = largest(travel.iter().zip(&law).map(|(got, law)| (got - law).abs()));
        let in_mm =
            |values: &[f64]| times.iter().copied().zip(values.iter().map(|v| to_mm(*v))).collect();
        let (y, name) = ("Travel of the block on the table (mm)", "Newmark's sliding block");
        Ok(Outcome::over_time(y, in_mm(&travel), name, in_mm(&law)).got(to_mm(off)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::testing::near;

    #[test]
    fn a_block_sticks_below_and_slides_above_the_friction_limit() {
        let omega = TAU * 3.0;
        let limit = 0.4 * GRAVITY;
        let below = Table { amplitude: 0.99 * limit / (omega * omega), omega };
        assert_eq!(newmark(below, 0.4, &[1.0]), [0.0], "law: a < μg sticks");
        let above = Table { amplitude: 1.5 * limit / (omega * omega), omega };
        let travel = newmark(above, 0.4, &[0.2])[0];
        assert!(travel.abs() > 1e-4, "law: a > μg slides, got {travel} m");
    }

    #[test]
    fn without_friction_the_block_goes_straight_on() {
        let table = Table { amplitude: 0.025, omega: TAU * 3.0 };
        let time = 0.37;
        let expected = table.speed(0.0) * time - table.place(time);
        let got = newmark(table, 0.0, &[time])[0];
        near("x = v₀t in space", got, expected, 1e-8);
    }
}
