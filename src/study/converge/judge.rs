//! Holds every rung against the finest, and chooses the cheapest that passes.

use super::design::Ladder;
use super::*;
use crate::report::{Cheapest, ConvergenceRow, Deviation, Deviations};

/// The precision that others are compared with where it is there.
const FINEST_PRECISION: &str = "double";

/// Judges the rungs of ladders in every precision in which they were run. A rung is compared with
/// the finest of its ladder and with that of the ladder `reference`, both in double precision where that is there.
pub(super) fn judge(
    runs: &[RunRow],
    ladders: &[Ladder],
    reference: &str,
    limits: ConvergenceLimits,
    standard: &Standard,
) -> Vec<ConvergenceRow> {
    let variations = VariationRow::of(runs);
    let mut precisions: Vec<&str> = runs.iter().map(|r| r.precision.as_str()).collect();
    precisions.sort_unstable();
    precisions.dedup();
    let of_variation = |name: &str, precision: &str| -> Vec<&RunRow> {
        runs.iter().filter(|r| r.variation == name && r.precision == precision).collect()
    };
    // What stands for a finest rung, and in which precision.
    let finest = |ladder: &Ladder, own: &str| -> Option<(String, String)> {
        let name = &ladder.rungs.last()?.0;
        let there = |p: &str| runs.iter().any(|r| r.variation == *name && r.precision == p);
        let precision = if there(FINEST_PRECISION) { FINEST_PRECISION } else { own };
        Some((name.clone(), precision.to_owned()))
    };
    let of_study = ladders.iter().find(|l| l.title == reference);
    let mut rows = Vec::new();
    for precision in precisions {
        let study = of_study.and_then(|l| finest(l, precision));
        for ladder in ladders {
            let own = finest(ladder, precision);
            for (name, title) in &ladder.rungs {
                let result =
                    variations.iter().find(|v| v.variation == *name && v.precision == precision);
                let Some(result) = result else { continue };
                let here = of_variation(name, precision);
                let from = |reference: &Option<(String, String)>| {
                    let there = reference.as_ref().map(|(n, p)| of_variation(n, p));
                    deviations(&here, &there.unwrap_or_default(), limits)
                };
                let is = |reference: &Option<(String, String)>| {
                    reference.as_ref().is_some_and(|(n, p)| n == name && p == precision)
                };
                rows.push(judged(
                    ConvergenceRow {
                        ladder: ladder.title.clone(),
                        rung: title.clone(),
                        finest_of_ladder: is(&own),
                        finest_of_study: is(&study),
                        result: result.clone(),
                        from_ladder: from(&own),
                        from_study: from(&study),
                        error_over_limit: None,
                        meets: None,
                        open: None,
                    },
                    standard,
                ));
            }
        }
    }
    in_every_ladder(rows)
}

/// A setting that stands in several ladders passes if it does so in all of them.
fn in_every_ladder(rows: Vec<ConvergenceRow>) -> Vec<ConvergenceRow> {
    let together = |row: &ConvergenceRow| {
        let same = || rows.iter().filter(|other| other.same_setting(row));
        let errors: Option<Vec<f64>> = same().map(|r| r.error_over_limit).collect();
        let meets: Option<Vec<bool>> = same().map(|r| r.meets).collect();
        let open: Option<Vec<bool>> = same().map(|r| r.open).collect();
        ConvergenceRow {
            error_over_limit: errors.map(|e| e.into_iter().fold(0.0, f64::max)),
            meets: if same().any(|r| r.meets == Some(false)) {
                Some(false)
            } else {
                meets.map(|m| m.into_iter().all(|m| m))
            },
            open: open.map(|o| o.into_iter().any(|o| o)),
            ..row.clone()
        }
    };
    rows.iter().map(together).collect()
}

fn deviations(here: &[&RunRow], there: &[&RunRow], limits: ConvergenceLimits) -> Deviations {
    let of = |value: fn(&RunRow) -> Option<f64>, limit| {
        Deviation::judged(
            deviation_percent(&RunRow::paired(here, value), &RunRow::paired(there, value)),
            limit,
        )
    };
    Deviations {
        height: of(|r| r.poured_height_mm, limits.height_percent),
        plate: of(RunRow::early_plate_mm, limits.settlement_percent),
        surface: of(RunRow::early_surface_mm, limits.settlement_percent),
    }
}

/// Mean difference over the mean of the reference, in percent, over the
/// configurations that both have.
fn deviation_percent(here: &[(u32, f64)], there: &[(u32, f64)]) -> Option<Estimate> {
    let difference = paired_difference(here, there)?;
    let common: Vec<f64> =
        there.iter().filter(|(c, _)| here.iter().any(|(o, _)| o == c)).map(|(_, v)| *v).collect();
    let reference = Estimate::of(&common)?.mean;
    (reference != 0.0).then(|| difference.scaled(100.0 / reference.abs()))
}

/// Holds a row against everything that is asked of it.
fn judged(row: ConvergenceRow, standard: &Standard) -> ConvergenceRow {
    let v = &row.result;
    // A deviation that cannot be measured because nothing was shaken is not asked for.
    let shaken = v.plate_settlement_mm.is_some() || v.surface_settlement_mm.is_some();
    let asked = |d: &Deviations| -> Vec<Deviation> {
        if shaken { vec![d.height, d.plate, d.surface] } else { vec![d.height] }
    };
    let deviations = [asked(&row.from_ladder), asked(&row.from_study)].concat();
    let quality = [
        (v.overlap_mean_percent, standard.overlap_mean_percent),
        (v.overlap_p99_percent, standard.overlap_p99_percent),
        (v.creep_um_per_s, standard.creep_um_per_s),
    ];
    let shares: Vec<Option<f64>> = quality
        .iter()
        .map(|(value, limit)| value.map(|e| e.mean / limit))
        .chain(deviations.iter().map(|d| d.percent.map(|p| p.mean.abs() / d.limit_percent)))
        .collect();
    // Of what misses by one of them the others need not be known.
    let largest = shares.iter().flatten().copied().fold(0.0, f64::max);
    let known = shares.iter().all(Option::is_some) || largest > 1.0;
    let error_over_limit = known.then_some(largest);
    let good = quality.iter().map(|(value, limit)| value.map(|e| e.mean < *limit));
    let passed: Vec<Option<bool>> = good.chain(deviations.iter().map(|d| d.within)).collect();
    // A setting does not pass by what is left out of its means: overlap and creep are of all
    // its runs, and one in which a run-time check found something counts as one that failed.
    let spoilt = v.failed > 0 || v.meeting_standard > v.valid;
    let meets = if spoilt || passed.contains(&Some(false)) {
        Some(false)
    } else {
        passed.into_iter().collect::<Option<Vec<bool>>>().map(|_| true)
    };
    let open: Option<Vec<bool>> = deviations.iter().map(|d| d.open).collect();
    let open = open.map(|o| o.into_iter().any(|o| o));
    ConvergenceRow { error_over_limit, meets, open, ..row }
}

/// The cheapest settings, by wall time over simulated time.
pub(super) fn cheapest(rows: &[ConvergenceRow], standard: &Standard) -> Cheapest {
    let pick = |passes: &dyn Fn(&ConvergenceRow) -> bool| {
        rows.iter()
            .enumerate()
            .filter(|(_, row)| rows.iter().filter(|r| r.same_setting(row)).all(passes))
            .filter_map(|(i, row)| Some((i, row.result.wall_s_per_simulated_s?.mean)))
            .min_by(|a, b| a.1.total_cmp(&b.1))
            .map(|(i, _)| i)
    };
    let below = |value: Option<Estimate>, limit: f64| value.is_some_and(|e| e.mean < limit);
    Cheapest {
        meeting: pick(&|r| r.meets == Some(true)),
        surely_meeting: pick(&|r| r.meets == Some(true) && r.open == Some(false)),
        not_shown_to_miss: pick(&|r| {
            let v = &r.result;
            v.failed == 0
                && v.meeting_standard <= v.valid
                && below(v.overlap_mean_percent, standard.overlap_mean_percent)
                && below(v.overlap_p99_percent, standard.overlap_p99_percent)
                && below(v.creep_um_per_s, standard.creep_um_per_s)
                && r.from_ladder
                    .all()
                    .into_iter()
                    .chain(r.from_study.all())
                    .all(|d| d.may_pass() != Some(false))
        }),
    }
}
