//! Whether samples are as far apart as a run can take them, and show what it does.

use super::*;

const FIELD: &str = "sample_interval_s";

/// Fewest samples in a rest, whose numerical creep is read off the second half of them.
const SAMPLES_A_REST: f64 = 4.0;

/// Fewest samples in a cycle that show a vibration as one.
const SAMPLES_A_CYCLE: f64 = 8.0;

/// Frequency in Hz up to which a table is not warned of: the paper's, with 4.2 readings a cycle.
const SLOW: f64 = 3.0;

/// Share by which an interval may miss a step of the engine: people type few digits.
const TYPED: f64 = 1e-3;

pub(super) fn check(parts: &Parts, faults: &mut Faults) {
    // What is out of range has been reported.
    let Some(typed) = parts.sample_interval_s.filter(|s| *s > 0.0 && *s <= 10.0) else { return };
    let lowest = allowed(RATE).0;
    if let Some(rate) = parts.engine.as_ref().map(|e| e.rate_hz).filter(|rate| *rate >= lowest) {
        let wrong = typed < (1.0 - TYPED) / rate;
        let allowed = format!("at least {} s, one step of the engine", no_less(1.0 / rate));
        let why = format!("more samples than steps: {RATE} is {}", as_typed(rate));
        faults.add_if(wrong, FIELD, as_typed(typed), allowed, why);
    }
    let of_stage = |(i, spec): (usize, &StageSpec)| match spec {
        StageSpec::Rest { duration_s } => Some((format!("stages[{i}].duration_s"), *duration_s)),
        StageSpec::Vibrate(stage) if stage.periods > 1 => {
            Some((format!("stages[{i}].rest_s"), stage.rest_s))
        }
        _ => None,
    };
    let of_test = parts.rest_test_s.map(|rest| ("rest_test_s".to_owned(), rest));
    let rests = parts.specs().filter_map(of_stage).chain(of_test).filter(|(_, rest)| *rest > 0.0);
    let Some((field, shortest)) = rests.min_by(|a, b| a.1.total_cmp(&b.1)) else { return };
    let most = (shortest / SAMPLES_A_REST).max(SAMPLE_INTERVAL);
    let why = format!(
        "too few samples in a rest of {} s ({field}): its numerical creep is read off them",
        short(shortest)
    );
    faults.add_if(
        typed > most,
        FIELD,
        as_typed(typed),
        format!("at most {} s", no_more(most)),
        why,
    );
}

/// Vibrations of the table along x, faster than the paper's, that samples draw as another motion.
pub(super) fn coarse(parts: &Parts) -> Vec<Fault> {
    let mut found = Vec::new();
    let typed = parts.sample_interval_s.unwrap_or(SAMPLE_INTERVAL);
    let shakes = |spec: &&StageSpec| spec.motion().is_some_and(|motion| motion.amplitude != 0.0);
    let shaken = parts.specs().map(|(_, spec)| spec).filter(shakes);
    let Some(fastest) = shaken.map(time_step::cycles_per_s).max_by(f64::total_cmp) else {
        return found;
    };
    let samples = 1.0 / (fastest * typed);
    let why = format!(
        "a vibration of {} Hz has {} samples a cycle: series and frames show another motion",
        short(fastest),
        short(samples)
    );
    let step = parts.engine.as_ref().map_or(0.0, |engine| 1.0 / engine.rate_hz);
    let good = (1.0 / (SAMPLES_A_CYCLE * fastest)).max(step);
    // Rounded down, so that there are as many.
    let digits = 10f64.powf(1.0 - good.log10().floor());
    let good = ((good * digits).floor() / digits).max(step);
    let wrong = fastest > SLOW && samples < SAMPLES_A_CYCLE * (1.0 - TYPED);
    let allowed = format!("{} for {SAMPLES_A_CYCLE} samples a cycle", short(good));
    Faults::of(&mut found).add_if(wrong, FIELD, as_typed(typed), allowed, why);
    found
}
