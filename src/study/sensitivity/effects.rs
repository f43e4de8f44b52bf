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
            let has_two_ends = p.low != p.default && p.high != p.default;
            let effect = |value: fn(&RunRow) -> Option<f64>| {
                let paired = |rows: &[&RunRow]| RunRow::paired(rows, value);
                effect(&paired(&low), &paired(&default), &paired(&high), range, has_two_ends)
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
/// its sides have; `range` is high less low in the parameter's unit, where it has one. Without two
/// ends the default is one of them, and there is but one difference.
fn effect(
    low: &[(u32, f64)],
    default: &[(u32, f64)],
    high: &[(u32, f64)],
    range: Option<f64>,
    has_two_ends: bool,
) -> Effect {
    let low_mm = paired_difference(low, default);
    let high_mm = paired_difference(high, default);
    let range_mm = paired_difference(high, low);
    let size = |e: &Estimate| e.mean.abs();
    let largest_mm = [range_mm, low_mm, high_mm]
        .into_iter()
        .flatten()
        .reduce(|best, other| if size(&other) > size(&best) { other } else { best });
    let distinct = if has_two_ends { vec![low_mm, high_mm, range_mm] } else { vec![range_mm] };
    let per_unit_mm = range.and_then(|range| change_for_one_unit(low, high, range));
    Effect {
        low_mm,
        high_mm,
        range_mm,
        per_unit_mm,
        per_unit_half_width_95_mm: per_unit_mm.and_then(|e| e.half_width_95()),
        largest_mm,
        inside_scatter: inside_scatter(&distinct),
    }
}

/// Whether none of the differences can be told from zero. Each is tested at 1 − 0.05/k of k
/// (Bonferroni), so that without an effect one of them passes in at most 5 % of cases. The largest
/// alone would pass more often, and hide a smaller one that scatters less.
fn inside_scatter(differences: &[Option<Estimate>]) -> Option<bool> {
    let confidence = 1.0 - 0.05 / differences.len() as f64;
    let inside = |e: &Estimate| Some(e.mean.abs() <= e.half_width(confidence)?);
    differences.iter().flatten().filter_map(inside).reduce(|all, one| all && one)
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64Mcg;

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
        let e = effect(&low, &default, &high, Some(0.5), true);
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
        let turned = effect(&high, &default, &low, Some(0.5), true);
        assert_eq!((mean(turned.range_mm), mean(turned.largest_mm)), (-3.0, -3.0));
    }

    #[test]
    fn ends_that_move_the_same_way_do_not_hide_each_other() {
        let default = values([100.0, 100.0, 100.0]);
        let both = values([104.0, 105.0, 106.0]);
        let e = effect(&both, &default, &both, Some(1.0), true);
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
        let e = effect(&default, &default, &noise, Some(1.0), false);
        assert_eq!(e.inside_scatter, Some(true), "law: 0.2 ± 1.1 mm is nothing: {e:?}");
        let alone = effect(&default[..1], &default[..1], &noise[..1], Some(1.0), false);
        assert_eq!(alone.inside_scatter, None, "law: one pair tells nothing of scatter");
        let none = effect(&[], &default, &[], Some(1.0), true);
        assert_eq!((none.low_mm, none.largest_mm), (None, None), "what failed has no effect");
    }

    /// Law: a parameter is beyond scatter where one of its differences is, at 1 − 0.05/3 each, also
    /// where the largest is not; where an end is the default there is one, at 95 %.
    #[test]
    fn every_difference_is_tested() {
        // Student's t of three pairs: 4.303 at 95 %, 7.649 at 1 − 0.05/3.
        let zero = values([0.0; 3]);
        // -3.5 ± 0.29 (t = 12), and over the range 4.5 ± 1.9 (t = 2.4).
        let (low, high) = (values([-3.0, -3.5, -4.0]), values([-2.0, 1.5, 3.5]));
        let e = effect(&low, &zero, &high, Some(1.0), true);
        let mean = |e: Option<Estimate>| e.expect("three pairs").mean;
        assert_eq!((mean(e.low_mm), mean(e.largest_mm)), (-3.5, 4.5), "law: ranked by the largest");
        assert_eq!(
            e.largest_mm.and_then(|l| l.inside_scatter()),
            Some(true),
            "law: t = 2.4 of 4.3"
        );
        assert_eq!(e.inside_scatter, Some(false), "law: the low end is beyond scatter: {e:?}");
        // 3 ± 0.58: t = 5.2, which one difference passes and the largest of three does not.
        let three = values([2.0, 3.0, 4.0]);
        for (has_two_ends, expected) in [(false, false), (true, true)] {
            let got = effect(&zero, &zero, &three, Some(1.0), has_two_ends).inside_scatter;
            assert_eq!(got, Some(expected), "law: t = 5.2, two ends: {has_two_ends}");
        }
    }

    /// Law: without an effect at most one parameter in twenty is beyond scatter, whether it has one
    /// end or two.
    #[test]
    fn chance_passes_in_one_case_of_twenty() {
        let mut chance = Pcg64Mcg::seed_from_u64(1);
        // Twelve uniform numbers add up to nearly a normal one.
        let mut normal = || (0..12).map(|_| chance.random_range(0.0_f64..1.0)).sum::<f64>() - 6.0;
        const CASES: u32 = 2000;
        for (has_two_ends, largest_alone) in [(false, 0.05), (true, 0.091)] {
            let [mut beyond, mut by_largest] = [0, 0];
            for _ in 0..CASES {
                let [low, default, high]: [Vec<(u32, f64)>; 3] =
                    std::array::from_fn(|_| values(std::array::from_fn(|_| normal())));
                let low = if has_two_ends { low } else { default.clone() };
                let e = effect(&low, &default, &high, Some(1.0), has_two_ends);
                beyond += u32::from(e.inside_scatter == Some(false));
                let largest = e.largest_mm.and_then(|l| l.inside_scatter());
                by_largest += u32::from(largest == Some(false));
            }
            // Four standard deviations of a share of 5 % of as many cases.
            let tolerance = 4.0 * (0.05 * 0.95 / f64::from(CASES)).sqrt();
            let [got, before] = [beyond, by_largest].map(|n| f64::from(n) / f64::from(CASES));
            let law = format!("two ends {has_two_ends}, tolerance {tolerance:.4}");
            assert!((got - 0.05).abs() < tolerance, "law: 0.05, got {got:.4}, {law}");
            let expected = largest_alone;
            let wide = 1.4 * tolerance;
            assert!((before - expected).abs() < wide, "law: {expected}, got {before:.4}, {law}");
        }
    }
}
