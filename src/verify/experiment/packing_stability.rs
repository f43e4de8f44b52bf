//! Whether a packing stays as it is: at rest, after a restart, between walls that shake.

use std::f64::consts::TAU;

use super::packing::{Heap, WIDTH, corners, mass, rough, rough_of};
use super::{Bench, Outcome, VerifyError};
use crate::units::to_mm;

/// The paper's vibration: 3 Hz, 25 mm to either side (sections 3 and 4).
const FREQUENCY: f64 = 3.0;
const AMPLITUDE: f64 = 0.025;

pub(super) fn creep(
    bench: &Bench,
    count: usize,
    settle: f64,
    duration: f64,
) -> Result<Outcome, VerifyError> {
    let mut heap = rough(bench, count)?;
    heap.scene.run(settle)?;
    let start = heap.mean_height()?;
    let steps = heap.scene.steps_in(duration);
    let (mut curve, mut lost) = (Vec::new(), 0.0);
    for n in 1..=steps {
        heap.scene.step()?;
        if n % (steps / 400).max(1) == 0 || n == steps {
            lost = to_mm(start - heap.mean_height()?);
            curve.push((n as f64 * heap.scene.time_step(), lost));
        }
    }
    let mut outcome = Outcome::new("Time at rest (s)", "Mean grain height lost (mm)");
    outcome.law("Law", vec![(0.0, 0.0), (duration, 0.0)]);
    outcome.measured("Engine", curve);
    Ok(outcome.got(lost))
}

pub(super) fn reload(
    bench: &Bench,
    count: usize,
    settle: f64,
    duration: f64,
) -> Result<Outcome, VerifyError> {
    let mut heap = rough(bench, count)?;
    heap.scene.run(settle)?;
    let mut again = rough_of(bench, heap.as_now()?)?;
    again.scene.recall(&heap.scene.remember())?;
    let start = heap.mean_height()?;
    let mut outcome = Outcome::new("Time since the restart (s)", "Mean grain height lost (mm)");
    let mut lost = Vec::new();
    for (name, heap) in [("Went on", &mut heap), ("Restarted", &mut again)] {
        let steps = heap.scene.steps_in(duration);
        let mut curve = vec![(0.0, 0.0)];
        for n in 1..=steps {
            heap.scene.step()?;
            if n % (steps / 400).max(1) == 0 || n == steps {
                let time = n as f64 * heap.scene.time_step();
                curve.push((time, to_mm(start - heap.mean_height()?)));
            }
        }
        lost.push(to_mm(start - heap.mean_height()?));
        outcome.measured(name, curve);
    }
    Ok(outcome.got(lost[1] - lost[0]))
}

/// Shakes a settled heap; with `kept` the share of grains and mass that stays
/// inside, else how far in mm a vertex gets beyond a wall's or the floor's face.
pub(super) fn shaken(
    bench: &Bench,
    count: usize,
    settle: f64,
    duration: f64,
    kept: bool,
) -> Result<Outcome, VerifyError> {
    let mut heap = rough(bench, count)?;
    heap.scene.run(settle)?;
    let (mut curve, mut furthest, mut share) = (Vec::new(), 0.0_f64, 1.0_f64);
    for n in 1..=heap.scene.steps_in(duration) {
        let time = n as f64 * heap.scene.time_step();
        let x = AMPLITUDE * (TAU * FREQUENCY * time).sin();
        heap.drive(x)?;
        heap.scene.step()?;
        let beyond = beyond_walls(&mut heap, x)?;
        furthest = beyond.iter().fold(furthest, |far, b| if b.is_nan() { *b } else { far.max(*b) });
        // Outside: the grain as a whole has passed a wall.
        let inside: f64 = beyond
            .iter()
            .zip(&heap.bodies)
            .filter(|(b, body)| **b < 2.0 * body.shape.radius_about_origin())
            .map(|(_, body)| mass(body))
            .sum();
        share = share.min(inside / heap.mass());
        curve
            .push((time, if kept { share } else { to_mm(beyond.into_iter().fold(0.0, f64::max)) }));
    }
    let (y, law) = if kept {
        ("Share of the mass inside", 1.0)
    } else {
        ("Furthest vertex beyond a wall (mm)", 0.0)
    };
    let mut outcome = Outcome::new("Time (s)", y);
    outcome.law("Law", vec![(0.0, law), (duration, law)]);
    outcome.measured("Engine", curve);
    Ok(outcome.got(if kept { share } else { to_mm(furthest) }))
}

/// How far in m each grain's furthest vertex lies beyond the inner faces of
/// the box, which stands at a displacement `x` (m).
fn beyond_walls(heap: &mut Heap, x: f64) -> Result<Vec<f64>, VerifyError> {
    let states = heap.states()?;
    let bodies = heap.bodies.iter().zip(&states);
    Ok(bodies
        .map(|(body, state)| {
            corners(&body.shape, &state.pose)
                .map(|c| {
                    let beside = (c.x - x).abs().max(c.y.abs()) - WIDTH / 2.0;
                    beside.max(-c.z)
                })
                .fold(0.0, |far: f64, b| if b.is_nan() { b } else { far.max(b) })
        })
        .collect())
}
