//! Settlement of a run, over time and at its end.

use crate::record::{RunRecord, SeriesRow, Settlement};

/// What settles: its name, and its settlement in a run.
type Settles = (&'static str, fn(&RunRecord) -> Option<&Settlement>);

/// The plate, and the mean surface of the grains.
pub(crate) const SETTLEMENTS: [Settles; 2] = [
    ("plate", |r| r.summary.settlement_mm.as_ref()),
    ("mean surface", |r| r.summary.surface_settlement_mm.as_ref()),
];

/// Settlement of the plate (or of the surface) over the time since vibration
/// began: (s, mm), of the rows that have it, through all later stages.
pub(crate) fn settlement_curve(
    run: &RunRecord,
    settlement_mm: impl Fn(&SeriesRow) -> Option<f64>,
) -> Vec<(f64, f64)> {
    let Some(start) = run.series.iter().find(|r| r.is_shaken()).map(|r| r.time_s) else {
        return Vec::new();
    };
    run.series
        .iter()
        .filter(|r| r.is_shaken())
        .filter_map(|r| Some((r.time_s - start, settlement_mm(r)?)))
        .filter(|(t, s)| t.is_finite() && s.is_finite())
        .collect()
}
