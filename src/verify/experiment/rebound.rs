//! Restitution from the height of a rebound.

use super::{Bench, Outcome, VerifyError};
use crate::geometry::Vector;
use crate::units::{from_mm, to_mm};
use crate::verify::bench::GRAVITY;
use crate::verify::scene::{block, floor, uniform};
use crate::world::Motion;

const SIDE: f64 = 0.01;

/// A cube falls flat from rest at a height h under its lower face; it rises
/// again to e²h.
pub(super) fn rebound(
    bench: &Bench,
    restitution: f64,
    height: f64,
    rates: &[f64],
) -> Result<Outcome, VerifyError> {
    let height = from_mm(height);
    let fall = (2.0 * height / GRAVITY).sqrt();
    let rise = 2.0 * restitution * fall;
    let mut outcome = Outcome::new("Time (s)", "Height of the lower face (mm)");
    let mut worst: Option<f64> = None;
    let mut notes = Vec::new();
    for &rate in rates {
        let mut scene = bench.at_rate(rate).scene(&uniform(0.5, restitution))?;
        scene.add(&floor(0.2, Motion::Static)?)?;
        let id =
            scene.add(&block(Vector::repeat(SIDE), Vector::new(0.0, 0.0, height + SIDE / 2.0))?)?;
        let mut curve = vec![(0.0, to_mm(height))];
        let (mut struck, mut peak) = (false, 0.0_f64);
        for _ in 0..scene.steps_in(fall + rise + 0.1) {
            scene.step()?;
            let state = scene.state(id)?;
            let z = state.pose.translation.vector.z - SIDE / 2.0;
            // Struck once it no longer falls; the first peak after that counts.
            struck |= scene.time() > 0.5 * fall && state.linear_velocity.z > -0.5 * GRAVITY * fall;
            if struck {
                peak = peak.max(z);
            }
            curve.push((scene.time(), to_mm(z)));
        }
        if !struck {
            return Err(VerifyError::NoEvent("an impact"));
        }
        let got = (peak / height).sqrt();
        notes.push(format!("{got:.3} at {rate} Hz"));
        outcome.measured(format!("{rate} Hz"), curve);
        let error = |e: f64| (e - restitution).abs();
        if worst.is_none_or(|w| error(got) > error(w) || got.is_nan()) {
            worst = Some(got);
        }
    }
    let law = (0..=200).map(|i| {
        let t = (fall + rise) * f64::from(i) / 200.0;
        let up = t - fall;
        let z = if up < 0.0 {
            height - 0.5 * GRAVITY * t * t
        } else {
            restitution * GRAVITY * fall * up - 0.5 * GRAVITY * up * up
        };
        (t, to_mm(z))
    });
    outcome.law("Law", law.collect());
    outcome.note = Some(notes.join(", "));
    Ok(outcome.got(worst.unwrap_or(f64::NAN)))
}
