//! How good a run is as a simulation, whatever it shows.

use serde::Serialize;

use crate::record::{RunRecord, left_out_in_words};

/// The accuracy standard (`docs/accuracy.md`): what a run must stay below.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Standard {
    /// Mean overlap in percent of the equivalent diameter.
    pub overlap_mean_percent: f64,
    /// 99th percentile of the overlap in percent of the equivalent diameter.
    pub overlap_p99_percent: f64,
    /// Creep in the rest test in µm/s, up or down.
    pub creep_um_per_s: f64,
}

/// Creep of a run's rest test over the length of a vibration, beside the
/// settlement it may be taken for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CreepShare {
    /// Creep times the length of the vibration, in mm.
    pub creep_mm: f64,
    /// The settlement of the plate, in mm.
    pub settlement_mm: f64,
}

impl CreepShare {
    /// Of a vibrated run with a rest test; `vibration_s` is the time from the
    /// beginning to the end of vibration.
    pub fn of(run: &RunRecord, vibration_s: f64) -> Option<Self> {
        let creep = run.summary.creep_um_per_s?;
        let settlement_mm = run.summary.settlement_mm.as_ref()?.final_mm;
        let creep_mm = 1e-3 * creep * vibration_s;
        (run.kind.is_vibration() && creep_mm.is_finite() && settlement_mm.is_finite())
            .then_some(Self { creep_mm, settlement_mm })
    }

    /// The one over the other, in percent.
    pub fn percent(&self) -> f64 {
        100.0 * self.creep_mm / self.settlement_mm
    }
}

/// What does not count of the runs behind a number.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct LeftOut {
    /// How many runs do not count.
    pub(super) runs: usize,
    /// Whether none counts, so that the number is theirs.
    pub(super) all: bool,
}

/// Of runs those that count in means; where none does, all of them, which are then to be
/// marked: valid runs and others never stand in one mean.
pub(super) fn never_mixed<'a>(
    runs: impl Iterator<Item = &'a RunRecord>,
) -> (Vec<&'a RunRecord>, LeftOut) {
    let (counting, others): (Vec<_>, Vec<_>) = runs.partition(|r| r.counts_in_means());
    let left_out = LeftOut { runs: others.len(), all: counting.is_empty() && !others.is_empty() };
    (if left_out.all { others } else { counting }, left_out)
}

/// Time in s from the beginning to the end of a run's vibration, without what it took to come
/// to rest.
pub fn vibration_s(run: &RunRecord) -> Option<f64> {
    run.summary.shaken_s().map(|(first, last)| last - first).filter(|t| *t > 0.0)
}

/// That runs are left out of means, as another sentence with how it ends; nothing where none is.
pub(super) fn sentence_of_left_out(left_out: usize, of: usize, end: &str) -> String {
    left_out_in_words(left_out, of).map_or(String::new(), |said| format!(" {said}{end}."))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::paper::canned;
    use crate::record::RunKind;

    #[test]
    fn creep_is_held_against_the_settlement() {
        let runs = canned::runs();
        // Configuration 3: 45 µm/s over 20 s are 0.9 mm of 20 mm.
        let run = runs
            .iter()
            .find(|r| r.kind == RunKind::VibrationContinuous && r.configuration == 3)
            .expect("a run");
        let seconds = vibration_s(run).expect("vibrated");
        assert!(
            (seconds - 20.0).abs() < 1e-9,
            "law: 20 s of shaking without the rest, got {seconds}"
        );
        let share = CreepShare::of(run, seconds).expect("a rest test");
        assert!((share.creep_mm - 0.9).abs() < 1e-9, "45 µm/s × 20 s: got {}", share.creep_mm);
        assert!((share.percent() - 4.5).abs() < 1e-9, "0.9 of 20 mm: got {} %", share.percent());
        let poured = runs.iter().find(|r| r.kind == RunKind::Pluviation).expect("a run");
        assert_eq!(CreepShare::of(poured, 20.0), None, "nothing settles in a pluviation run");
        assert_eq!(vibration_s(poured), None);
    }
}
