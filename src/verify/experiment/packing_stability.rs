//! Whether a packing stays as it is: at rest, after a restart, between walls that shake.

use super::packing::{FRICTION, OfGrains, Packing, WIDTH};
use super::*;

/// The paper's vibration: 3 Hz, 25 mm to either side (sections 2 and 3).
const FREQUENCY: f64 = 3.0;
const AMPLITUDE: f64 = 0.025;
/// Orders in which the grains of a packing are added.
const ORDERS: u64 = 5;

impl OfGrains {
    pub(super) fn creep(&self, bench: &Bench) -> Measured {
        let mut packing = self.in_order(bench, 0)?;
        packing.scene.run(self.settle_s)?;
        let start = packing.mean_height()?;
        let heights = packing.heights(self.duration_s, 400)?;
        let curve: Vec<_> = heights.iter().map(|(t, height)| (*t, to_mm(start - height))).collect();
        let lost = curve.last().map_or(0.0, |last| last.1);
        let mut outcome = Outcome::new("Time at rest (s)", "Mean grain height lost (mm)");
        outcome.law("Known solution", vec![(0.0, 0.0), (self.duration_s, 0.0)]);
        outcome.measured("Engine", curve);
        Ok(outcome.got(lost))
    }

    pub(super) fn reload(&self, bench: &Bench) -> Measured {
        let mut packing = self.in_order(bench, 0)?;
        packing.scene.run(self.settle_s)?;
        let mut again = Packing::of(bench, packing.as_now()?, FRICTION)?;
        again.scene.recall(&packing.scene.remember())?;
        let start = packing.mean_height()?;
        let mut outcome = Outcome::new("Time since the restart (s)", "Mean grain height lost (mm)");
        let mut lost = Vec::new();
        for (name, packing) in [("Went on", &mut packing), ("Restarted", &mut again)] {
            let mut curve = vec![(0.0, 0.0)];
            let heights = packing.heights(self.duration_s, 400)?;
            curve.extend(heights.iter().map(|(time, height)| (*time, to_mm(start - height))));
            lost.push(curve[curve.len() - 1].1);
            outcome.measured(name, curve);
        }
        Ok(outcome.got(lost[1] - lost[0]))
    }

    /// Shakes a settled packing, step by step, and hands on the time and how far in m
    /// each grain's furthest vertex lies beyond a wall's or the floor's face.
    fn shake(
        &self,
        packing: &mut Packing,
        mut watch: impl FnMut(f64, &[f64], &Packing),
    ) -> Result<()> {
        packing.scene.run(self.settle_s)?;
        for n in 1..=packing.scene.steps_in(self.duration_s) {
            let time = n as f64 * packing.scene.time_step();
            let x = AMPLITUDE * (TAU * FREQUENCY * time).sin();
            packing.drive(x)?;
            packing.scene.step()?;
            let beyond = beyond_walls(packing, x)?;
            watch(time, &beyond, packing);
        }
        Ok(())
    }

    /// Share of grains and mass that stays inside a packing that is shaken.
    pub(super) fn kept(&self, bench: &Bench) -> Measured {
        let (mut curve, mut share) = (Vec::new(), 1.0_f64);
        self.shake(&mut self.in_order(bench, 0)?, |time, beyond, packing| {
            // Outside: the grain as a whole has passed a wall.
            let inside: f64 = beyond
                .iter()
                .zip(&packing.bodies)
                .filter(|(b, body)| **b < 2.0 * body.shape.radius_about_origin())
                .map(|(_, body)| mass_of(body).0)
                .sum();
            share = share.min(inside / packing.mass());
            curve.push((time, share));
        })?;
        let mut outcome = Outcome::new("Time (s)", "Share of the mass inside");
        outcome.law("Known solution", vec![(0.0, 1.0), (self.duration_s, 1.0)]);
        outcome.measured("Engine", curve);
        Ok(outcome.got(share))
    }

    /// How far in mm a vertex gets beyond a wall's or the floor's face, at the worst of [`ORDERS`]
    /// packings of the same grains: how hard a grain is pressed against a wall is chance.
    pub(super) fn beyond(&self, bench: &Bench) -> Measured {
        let mut outcome = Outcome::new("Time (s)", "Furthest vertex beyond a wall (mm)");
        outcome.law("Known solution", vec![(0.0, 0.0), (self.duration_s, 0.0)]);
        let (mut furthest, mut notes) = (0.0_f64, Vec::new());
        for order in 0..ORDERS {
            let (mut curve, mut worst) = (Vec::new(), 0.0_f64);
            let mut packing = self.in_order(bench, order)?;
            self.shake(&mut packing, |time, beyond, _| {
                let far = largest(beyond.iter().copied());
                worst = largest([worst, far]);
                curve.push((time, to_mm(far)));
            })?;
            furthest = largest([furthest, worst]);
            notes.push(format!("{:.3}", to_mm(worst)));
            outcome.measured(format!("Order {order}"), curve);
        }
        let note = format!("mm in each order: {}", notes.join(", "));
        Ok(outcome.said(note).got(to_mm(furthest)))
    }
}

/// How far in m each grain's furthest vertex lies beyond the inner faces of
/// the box, which stands at a displacement `x` (m).
fn beyond_walls(packing: &mut Packing, x: f64) -> Result<Vec<f64>> {
    let states = packing.states()?;
    let bodies = packing.bodies.iter().zip(&states);
    Ok(bodies
        .map(|(body, state)| {
            largest(body.shape.vertices().iter().map(|vertex| {
                let c = state.pose * vertex;
                let beside = (c.x - x).abs().max(c.y.abs()) - WIDTH / 2.0;
                beside.max(-c.z)
            }))
        })
        .collect())
}
