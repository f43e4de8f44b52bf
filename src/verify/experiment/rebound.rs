//! Restitution from the height of a rebound.

use super::*;

const SIDE: f64 = 0.01;

/// A cube over a floor, its lower face at a height (m).
fn dropped(bench: &Bench, restitution: f64, height: f64) -> Result<(Scene, BodyId)> {
    let mut scene = floored(bench.scene(&uniform(0.5, restitution))?, 0.2)?;
    let start = Vector::new(0.0, 0.0, height + SIDE / 2.0);
    let id = scene.add(&block(Vector::repeat(SIDE), start)?);
    Ok((scene, id))
}

/// A cube falls flat from rest at a height h under its lower face; it rises again to e²h.
pub(super) fn rebound(bench: &Bench, restitution: f64, height: f64, rates: &[f64]) -> Measured {
    let height = from_mm(height);
    let fall = (2.0 * height / GRAVITY).sqrt();
    let rise = 2.0 * restitution * fall;
    let mut outcome = Outcome::new("Time (s)", "Height of the lower face (mm)");
    let (mut found, mut notes) = (Vec::new(), Vec::new());
    for &rate in rates {
        let (mut scene, id) = dropped(&bench.at_rate(rate), restitution, height)?;
        let mut curve = vec![(0.0, to_mm(height))];
        let (mut landed, mut peak) = (false, 0.0_f64);
        scene.follow(id, fall + rise + 0.1, |time, state| {
            let z = state.pose.translation.vector.z - SIDE / 2.0;
            // Landed once it no longer falls; the first peak after that counts.
            landed |= time > 0.5 * fall && state.linear_velocity.z > -0.5 * GRAVITY * fall;
            if landed {
                peak = peak.max(z);
            }
            curve.push((time, to_mm(z)));
        })?;
        if !landed {
            return Err(VerifyError::NoEvent("an impact"));
        }
        let got = (peak / height).sqrt();
        notes.push(format!("{got:.3} at {rate} Hz"));
        outcome.measured(format!("{rate} Hz"), curve);
        found.push(got);
    }
    let law = |t: f64| to_mm(rebounding(height, GRAVITY, restitution, t));
    outcome.law("Known solution", over(fall + rise, 200, law));
    let worst = worst_of(&found, |e| (e - restitution).abs());
    Ok(outcome.said(notes.join(", ")).got(worst))
}

/// Heights (m) of the peaks of a motion (time, height, upward velocity), the
/// start first: a peak ends when the body falls again.
fn peaks(motion: &[(f64, f64, f64)]) -> Vec<f64> {
    let mut peaks = vec![motion.first().map_or(0.0, |m| m.1)];
    let (mut rises, mut highest) = (false, 0.0_f64);
    for &(_, height, velocity) in motion {
        // What does not rise visibly is no rebound.
        if velocity > 1e-3 {
            rises = true;
            highest = highest.max(height);
        } else if rises && velocity < 0.0 {
            peaks.push(highest.max(height));
            (rises, highest) = (false, 0.0);
        }
    }
    peaks
}

/// A cube falls flat from rest and bounces: each peak is e² times the one
/// before it, whatever the body did earlier.
pub(super) fn bounces(bench: &Bench, restitution: f64, height: f64, count: usize) -> Measured {
    let height = from_mm(height);
    let (mut scene, id) = dropped(bench, restitution, height)?;
    let fall = (2.0 * height / GRAVITY).sqrt();
    // Of each rebound the rise and the fall.
    let flights = (1..=count as i32).map(|n| 2.0 * fall * restitution.powi(n));
    let duration = fall + flights.sum::<f64>() + 0.02;
    let (mut motion, mut turns) = (vec![(0.0, height, 0.0)], 0.0_f64);
    scene.follow(id, duration, |time, state| {
        turns = turns.max(state.angular_velocity.norm());
        motion.push((time, state.pose.translation.z - SIDE / 2.0, state.linear_velocity.z));
    })?;
    let peaks = peaks(&motion);
    let mut ratios: Vec<f64> =
        peaks.windows(2).take(count).map(|p| (p[1] / p[0]).max(0.0).sqrt()).collect();
    // What does not rebound visibly rises to nothing.
    ratios.resize(count, 0.0);
    let mut law = vec![(0.0, to_mm(height))];
    let mut time = fall;
    for n in 1..=count as i32 {
        let flight = fall * restitution.powi(n);
        law.push((time, 0.0));
        law.push((time + flight, to_mm(height * restitution.powi(2 * n))));
        time += 2.0 * flight;
    }
    let curve = motion.iter().map(|m| (m.0, to_mm(m.1))).collect();
    let words: Vec<String> = ratios.iter().map(|r| format!("{r:.3}")).collect();
    let worst = worst_of(&ratios, |e| (e - restitution).abs());
    Ok(Outcome::over_time("Height of the lower face (mm)", curve, "Impacts and peaks", law)
        .said(format!("{}; turns with {turns:.3} rad/s at most", words.join(", ")))
        .got(worst))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn peaks_are_found_between_impacts() {
        let flight = |from: f64, up: f64| -> Vec<(f64, f64, f64)> {
            let n = (2.0 * up / GRAVITY / 1e-3) as u32;
            (1..n)
                .map(|i| f64::from(i) * 1e-3)
                .map(|t| (from + t, up * t - 0.5 * GRAVITY * t * t, up - GRAVITY * t))
                .collect()
        };
        let mut motion = vec![(0.0, 0.05, 0.0), (0.05, 0.03, -0.5)];
        motion.extend(flight(0.1, 0.5));
        motion.extend(flight(0.3, 0.25));
        let got = peaks(&motion);
        let expected = [0.05, 0.25 / (2.0 * GRAVITY), 0.0625 / (2.0 * GRAVITY)];
        assert_eq!(got.len(), 3, "law: the start and two peaks, got {got:?}");
        for (got, expected) in got.iter().zip(expected) {
            assert!((got / expected - 1.0).abs() < 1e-3, "law: {expected} m, got {got} m");
        }
    }
}
