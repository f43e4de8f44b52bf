//! What a parameter moves: differences of runs, pair by pair.

use super::*;
use crate::report::{Effect, ParameterRow};

/// One row a parameter, in the order of the design; `variation` says what the
/// runs at an end of a parameter are called.
pub(super) fn rows(
    parameters: &[Parameter],
    variation: impl Fn(&Parameter, End) -> String,
    runs: &[RunRow],
) -> Vec<ParameterRow> {
    parameters
        .iter()
        .map(|p| {
            let of = |end: End| -> Vec<&RunRow> {
                let name = variation(p, end);
                runs.iter().filter(|r| r.variation == name).collect()
            };
            let (low, default, high) = (of(End::Low), of(End::Default), of(End::High));
            let all = [low.as_slice(), high.as_slice()].concat();
            let outside = |rows: &[&RunRow]| {
                let counts: Vec<f64> =
                    rows.iter().filter_map(|r| r.grains_outside.map(|g| g as f64)).collect();
                Estimate::of(&counts).map(|e| e.mean)
            };
            let range = (!Scenario::names_realisations(&p.path)).then_some(p.high - p.low);
            let effect = |value: fn(&RunRow) -> Option<f64>| {
                let paired = |rows: &[&RunRow]| RunRow::paired(rows, value);
                effect(&paired(&low), &paired(&default), &paired(&high), range)
            };
            ParameterRow {
                parameter: p.name.clone(),
                title: p.title.clone(),
                unit: p.unit.clone(),
                reason: p.reason.clone(),
                path: p.path.clone(),
                low: p.low,
                default: p.default,
                high: p.high,
                failed: all.iter().filter(|r| r.failure.is_some()).count(),
                left_out: all.iter().filter(|r| r.is_left_out()).count(),
                valid: all.iter().filter(|r| r.counts_in_means()).count(),
                grains_outside: outside(&low).into_iter().chain(outside(&high)).reduce(f64::max),
                height: effect(|r| r.poured_height_mm),
                plate: effect(RunRow::early_plate_mm),
                surface: effect(RunRow::early_surface_mm),
            }
        })
        .collect()
}

/// Differences of the ends, in mm, each over the configurations that both of
/// its sides have; `range` is high less low in the parameter's unit, where it has one.
fn effect(
    low: &[(u32, f64)],
    default: &[(u32, f64)],
    high: &[(u32, f64)],
    range: Option<f64>,
) -> Effect {
    let low_mm = paired_difference(low, default);
    let high_mm = paired_difference(high, default);
    let range_mm = paired_difference(high, low);
    let size = |e: &Estimate| e.mean.abs();
    let largest_mm = [range_mm, low_mm, high_mm]
        .into_iter()
        .flatten()
        .reduce(|best, other| if size(&other) > size(&best) { other } else { best });
    let per_unit_mm = range.and_then(|range| change_for_one_unit(low, high, range));
    Effect {
        low_mm,
        high_mm,
        range_mm,
        per_unit_mm,
        per_unit_half_width_95_mm: per_unit_mm.and_then(|e| e.half_width_95()),
        largest_mm,
        inside_scatter: largest_mm.and_then(|l| l.inside_scatter()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn values(of: [f64; 3]) -> Vec<(u32, f64)> {
        (1..).zip(of).collect()
    }

    #[test]
    fn effects_are_paired_by_configuration() {
        // Configurations differ by 10 mm, which is none of the parameter's doing.
        let default = values([100.0, 110.0, 120.0]);
        let low = values([99.0, 109.0, 119.0]);
        let high = values([102.0, 112.0, 122.0]);
        let e = effect(&low, &default, &high, Some(0.5));
        let mean = |e: Option<Estimate>| e.expect("three pairs").mean;
        assert_eq!(mean(e.low_mm), -1.0, "law: low less default");
        assert_eq!(mean(e.high_mm), 2.0, "law: high less default");
        assert_eq!(mean(e.range_mm), 3.0, "law: high less low");
        assert_eq!(mean(e.per_unit_mm), 6.0, "law: 3 mm over half a unit");
        assert_eq!(mean(e.largest_mm), 3.0);
        let error = e.range_mm.and_then(|r| r.standard_error).expect("three pairs");
        assert!(error.abs() < 1e-12, "law: what pairs share is no scatter, got {error}");
        assert_eq!(e.inside_scatter, Some(false));
        // The other way round: the same size, the other sign.
        let turned = effect(&high, &default, &low, Some(0.5));
        assert_eq!((mean(turned.range_mm), mean(turned.largest_mm)), (-3.0, -3.0));
    }

    #[test]
    fn ends_that_move_the_same_way_do_not_hide_each_other() {
        let default = values([100.0, 100.0, 100.0]);
        let both = values([104.0, 105.0, 106.0]);
        let e = effect(&both, &default, &both, Some(1.0));
        assert_eq!(e.range_mm.expect("pairs").mean, 0.0, "nothing over the range");
        assert_eq!(e.largest_mm.expect("pairs").mean, 5.0, "law: the largest of the three");
    }

    /// Law: a run that does not count takes its pair with it, and is counted; else nothing changes.
    #[test]
    fn what_is_left_out_moves_no_effect() {
        let scenario = crate::study::tests::bare_scenario();
        let row = |variation: &str, configuration, height| RunRow {
            configuration,
            poured_height_mm: Some(height),
            meets_standard: Some(true),
            valid: Some(true),
            ..RunRow::of_scenario("r", variation, "g", &scenario)
        };
        let mut runs: Vec<RunRow> = (1..=3)
            .flat_map(|c| [row("low", c, 100.0), row("default", c, 101.0), row("high", c, 102.0)])
            .collect();
        let parameter = Parameter {
            name: "p".into(),
            title: "P".into(),
            unit: String::new(),
            reason: String::new(),
            path: String::new(),
            low: 0.0,
            default: 0.5,
            high: 1.0,
            low_changes: Vec::new(),
            high_changes: Vec::new(),
        };
        let of = |runs: &[RunRow]| {
            let name = |_: &Parameter, end: End| {
                match end {
                    End::Low => "low",
                    End::Default => "default",
                    End::High => "high",
                }
                .to_owned()
            };
            let row = rows(std::slice::from_ref(&parameter), name, runs).remove(0);
            (row.height.range_mm.map(|e| (e.mean, e.count)), row.left_out, row.valid)
        };
        assert_eq!(of(&runs), (Some((2.0, 3)), 0, 6), "law: all count");
        // The high end of the second configuration, and far off.
        (runs[5].valid, runs[5].poured_height_mm) = (Some(false), Some(500.0));
        assert_eq!(of(&runs), (Some((2.0, 2)), 1, 5), "law: its pair is left out");
        runs.iter_mut().for_each(|r| r.left_out_of_means = Some("a jam".into()));
        assert_eq!(of(&runs), (None, 6, 0), "law: nothing is made of nothing");
    }

    #[test]
    fn scatter_is_told_from_effect() {
        let default = values([100.0, 100.0, 100.0]);
        let noise = values([101.0, 98.0, 101.5]);
        let e = effect(&default, &default, &noise, Some(1.0));
        assert_eq!(e.inside_scatter, Some(true), "law: 0.2 ± 1.1 mm is nothing: {e:?}");
        let alone = effect(&default[..1], &default[..1], &noise[..1], Some(1.0));
        assert_eq!(alone.inside_scatter, None, "law: one pair tells nothing of scatter");
        let none = effect(&[], &default, &[], Some(1.0));
        assert_eq!((none.low_mm, none.largest_mm), (None, None), "what failed has no effect");
    }
}
