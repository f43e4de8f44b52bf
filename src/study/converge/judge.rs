//! Compares every rung with the finest, and chooses the cheapest that passes.

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
    let of_study = ladders.iter().find(|l| l.title == reference);
    let is_poured = runs.iter().any(|r| r.poured_height_mm.is_some());
    let mut rows = Vec::new();
    for precision in precisions {
        let study = of_study.and_then(|l| finest(runs, l, precision));
        for ladder in ladders {
            let own = finest(runs, ladder, precision);
            for (name, title) in &ladder.rungs {
                let result =
                    variations.iter().find(|v| v.variation == *name && v.precision == precision);
                let Some(result) = result else { continue };
                let here = of_variation(name, precision);
                let from = |reference: Option<(&str, &str)>| {
                    let there = reference.map(|(name, precision)| of_variation(name, precision));
                    deviations(&here, &there.unwrap_or_default(), limits)
                };
                let is = |reference: Option<(&str, &str)>| {
                    reference.is_some_and(|(n, p)| n == name && p == precision)
                };
                rows.push(judged(
                    ConvergenceRow {
                        ladder: ladder.title.clone(),
                        rung: title.clone(),
                        finest_of_ladder: is(own),
                        finest_of_study: is(study),
                        result: result.clone(),
                        from_ladder: from(own),
                        from_study: from(study),
                        error_over_limit: None,
                        meets: None,
                        open: None,
                    },
                    is_poured,
                    standard,
                ));
            }
        }
    }
    in_every_ladder(rows)
}

/// The variation that stands for a ladder's finest rung, and the precision in which it does.
fn finest<'a>(runs: &[RunRow], ladder: &'a Ladder, own: &'a str) -> Option<(&'a str, &'a str)> {
    let name = ladder.rungs.last()?.0.as_str();
    let there = |p: &str| runs.iter().any(|r| r.variation == name && r.precision == p);
    Some((name, if there(FINEST_PRECISION) { FINEST_PRECISION } else { own }))
}

/// A setting that stands in several ladders passes if it does so in all of them.
fn in_every_ladder(rows: Vec<ConvergenceRow>) -> Vec<ConvergenceRow> {
    let together = |row: &ConvergenceRow| {
        let same = || rows.iter().filter(|other| other.same_setting(row));
        let errors: Option<Vec<f64>> = same().map(|r| r.error_over_limit).collect();
        ConvergenceRow {
            error_over_limit: errors.map(|e| e.into_iter().fold(0.0, f64::max)),
            meets: all(same().map(|r| r.meets)),
            open: any(same().map(|r| r.open)),
            ..row.clone()
        }
    };
    rows.iter().map(together).collect()
}

/// Whether all hold: they do not where one is known not to hold; `None` where, without such a one,
/// some are not known.
fn all(of: impl Iterator<Item = Option<bool>>) -> Option<bool> {
    let of: Vec<Option<bool>> = of.collect();
    if of.contains(&Some(false)) {
        return Some(false);
    }
    if of.contains(&None) { None } else { Some(true) }
}

/// Whether any of them holds; `None` where some are not known.
fn any(of: impl Iterator<Item = Option<bool>>) -> Option<bool> {
    let of: Option<Vec<bool>> = of.collect();
    of.map(|of| of.contains(&true))
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

/// Holds a row against everything that is asked of it; `is_poured` says whether runs of the study
/// pour their specimens.
fn judged(row: ConvergenceRow, is_poured: bool, standard: &Standard) -> ConvergenceRow {
    let v = &row.result;
    // A deviation that cannot be measured because nothing was poured or shaken is not asked for;
    // without a run that counts the height is, and is not known.
    let asks_height = is_poured || v.has_no_valid_run();
    let shaken = v.plate_settlement_mm.is_some() || v.surface_settlement_mm.is_some();
    let asked = |d: &Deviations| -> Vec<Deviation> {
        let height = asks_height.then_some(d.height);
        height.into_iter().chain([d.plate, d.surface].into_iter().filter(|_| shaken)).collect()
    };
    let deviations = [asked(&row.from_ladder), asked(&row.from_study)].concat();
    let quality = quality(v, standard);
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
    let passed = all(good.chain(deviations.iter().map(|d| d.within)));
    // A setting does not pass by what is left out of its means: overlap and numerical creep are of
    // all its runs, and one in which a run-time check found something, or grains had not settled,
    // counts as one that failed.
    let meets = if is_spoilt(v) { Some(false) } else { passed };
    let quality_open = quality.iter().map(|(value, limit)| value.and_then(|e| is_open(e, *limit)));
    let open = any(quality_open.chain(deviations.iter().map(|d| d.open)));
    ConvergenceRow { error_over_limit, meets, open, ..row }
}

/// Means that the accuracy standard limits, each with its limit.
fn quality(of: &VariationRow, standard: &Standard) -> [(Option<Estimate>, f64); 3] {
    [
        (of.overlap_mean_percent, standard.overlap_mean_percent),
        (of.overlap_p99_percent, standard.overlap_p99_percent),
        (of.creep_um_per_s, standard.creep_um_per_s),
    ]
}

/// Whether scatter leaves open, at 95 %, if a mean lies below its limit; `None` of a single run.
fn is_open(mean: Estimate, limit: f64) -> Option<bool> {
    let half = mean.half_width_95()?;
    Some(mean.mean - half < limit && limit <= mean.mean + half)
}

/// Whether a run failed, or a run-time check found something in one, or its grains had not settled.
fn is_spoilt(of: &VariationRow) -> bool {
    of.spoilt > 0
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
    Cheapest {
        meeting: pick(&|r| r.meets == Some(true)),
        surely_meeting: pick(&|r| r.meets == Some(true) && r.open == Some(false)),
        not_shown_to_miss: pick(&|r| {
            let good = quality(&r.result, standard);
            let deviations = [r.from_ladder, r.from_study];
            let mut deviations = deviations.iter().flat_map(|d| [d.height, d.plate, d.surface]);
            !is_spoilt(&r.result)
                && good.iter().all(|(value, limit)| {
                    value.is_some_and(|e| e.mean < *limit || is_open(e, *limit) == Some(true))
                })
                && deviations.all(|d| d.may_pass() != Some(false))
        }),
    }
}
