//! What the runs of a sweep say together.

use super::drawn::{Drawn, drawn};
use super::*;
use crate::measure::{
    inference::{page_test, values_needed},
    statistics::{least_squares_slope, mean},
};
use crate::report::{SweepEffect, SweepEstimate, SweepPoint, averaged_outcomes, main_outcomes};

/// Confidence of intervals, and of the test that decides how many configurations are needed.
const CONFIDENCE: f64 = 0.95;

/// With what probability that many show the slope.
const POWER: f64 = 0.8;

/// Means of each point over its configurations, of the runs that count.
pub(super) fn point_rows(points: &[Point], runs: &[SweepRun]) -> Vec<SweepPoint> {
    let averaged = averaged_outcomes(runs);
    let row = |point: &Point| {
        let of: Vec<&SweepRun> = runs.iter().filter(|r| r.point == point.name).collect();
        let mut outcomes = BTreeMap::new();
        for path in &averaged {
            let values: Vec<f64> =
                counting(&of).filter_map(|r| r.outcomes.get(*path).copied()).collect();
            if let Some(estimate) = SweepEstimate::of(&values) {
                outcomes.insert((*path).to_owned(), estimate);
            }
        }
        let failed = of.iter().filter(|r| r.failure.is_some()).count();
        let counted = counting(&of).count();
        SweepPoint {
            point: point.name.clone(),
            values: point.values.clone(),
            runs: of.len() - failed,
            valid: of.iter().filter(|r| r.valid == Some(true)).count(),
            left_out: of.len() - failed - counted,
            failed,
            outcomes,
        }
    };
    points.iter().map(row).collect()
}

/// The runs that count in means.
fn counting<'a>(runs: &[&'a SweepRun]) -> impl Iterator<Item = &'a SweepRun> {
    runs.iter().copied().filter(|r| r.counts_in_means())
}

/// The effect of every factor on every main result that was measured.
pub(super) fn effects(
    design: Design,
    factors: &[SweepFactor],
    points: &[Point],
    runs: &[SweepRun],
) -> Vec<SweepEffect> {
    let mut found = Vec::new();
    let main = main_outcomes(runs);
    for (n, factor) in factors.iter().enumerate() {
        for &outcome in &main {
            // Of factors varied one at a time only the scenario itself and the
            // factor's own points tell of it.
            let own: Vec<&Point> = points
                .iter()
                .filter(|p| design != Design::OneAtATime || p.varies.is_none_or(|v| v == n))
                .collect();
            let of_own: Vec<&SweepRun> =
                runs.iter().filter(|r| own.iter().any(|p| p.name == r.point)).collect();
            let withheld = counting(&of_own).filter(|r| r.why_withheld(outcome).is_some()).count();
            let all: Vec<&SweepRun> =
                of_own.into_iter().filter(|r| r.outcomes.contains_key(outcome)).collect();
            let runs: Vec<&SweepRun> = counting(&all).collect();
            let found_here = match design {
                Design::LatinHypercube(_) if factor.has_slope() => {
                    let Drawn { slopes, together_with } =
                        drawn(factors, n, outcome, &configurations(&runs), &runs);
                    let found = effect(factor, outcome, Vec::new(), &slopes, None);
                    SweepEffect { together_with, ..found }
                }
                Design::LatinHypercube(_) if factor.sampled => {
                    effect(factor, outcome, Vec::new(), &[], None)
                }
                Design::Grid | Design::LatinHypercube(_) => listed(factor, n, outcome, &own, &runs),
                Design::OneAtATime => {
                    let listed = listed(factor, n, outcome, &own, &runs);
                    between_the_ends(factor, n, outcome, &runs, listed)
                }
            };
            let left_out = all.len() - runs.len();
            found.push(SweepEffect { runs: runs.len(), left_out, withheld, ..found_here });
        }
    }
    found
}

/// Configurations that have results that count, ascending.
fn configurations(runs: &[&SweepRun]) -> Vec<u32> {
    let mut all: Vec<u32> = runs.iter().map(|r| r.configuration).collect();
    all.sort_unstable();
    all.dedup();
    all
}

/// Of a factor with listed values: means at each, all else averaged over, by
/// configurations that have every value.
fn listed(
    factor: &SweepFactor,
    n: usize,
    outcome: &str,
    points: &[&Point],
    runs: &[&SweepRun],
) -> SweepEffect {
    let mut values: Vec<&Value> = each_once(points.iter().map(|point| &point.values[n]));
    values.sort_by(|a, b| factor.number(a).total_cmp(&factor.number(b)));
    let at = |configuration: u32, value: &Value| {
        // A point that failed or is left out must not shift the mean of its value.
        let wanted = points.iter().filter(|p| p.values[n] == *value).count();
        let of: Vec<f64> = runs
            .iter()
            .filter(|r| r.configuration == configuration && r.values[n] == *value)
            .map(|r| r.outcomes[outcome])
            .collect();
        if of.len() == wanted { mean(&of) } else { None }
    };
    let rows: Vec<Vec<f64>> = configurations(runs)
        .into_iter()
        .filter_map(|c| values.iter().map(|v| at(c, v)).collect())
        .collect();
    let means = values.iter().enumerate().filter_map(|(k, value)| {
        let column: Vec<f64> = rows.iter().map(|row| row[k]).collect();
        Some(((*value).clone(), SweepEstimate::of(&column)?))
    });
    let means: Vec<_> = means.collect();
    let numbers: Vec<f64> = values.iter().map(|v| factor.number(v)).collect();
    let slopes: Vec<f64> = if factor.has_slope() {
        let line = |row: &Vec<f64>| {
            let points: Vec<(f64, f64)> =
                numbers.iter().copied().zip(row.iter().copied()).collect();
            least_squares_slope(&points)
        };
        rows.iter().filter_map(line).collect()
    } else {
        Vec::new()
    };
    let page_p = if factor.has_slope() { trend(&rows) } else { None };
    effect(factor, outcome, means, &slopes, page_p)
}

/// Two-sided p-value of Page's test: which way results go was seen in the results themselves, so
/// that both ways count.
fn trend(rows: &[Vec<f64>]) -> Option<f64> {
    let one_way = |sign: f64| {
        let turned: Vec<Vec<f64>> =
            rows.iter().map(|row| row.iter().map(|v| sign * v).collect()).collect();
        page_test(&turned).map(|test| test.p)
    };
    let less = one_way(1.0)?.min(one_way(-1.0)?);
    Some((2.0 * less).min(1.0))
}

/// Of a factor that was varied by itself the slope is that from its lowest to
/// its highest value, by pairs, as `pluvia sensitivity` has it: what lies
/// between tells of bends, and takes no pair away when it failed.
fn between_the_ends(
    factor: &SweepFactor,
    n: usize,
    outcome: &str,
    runs: &[&SweepRun],
    listed: SweepEffect,
) -> SweepEffect {
    let numbers = || factor.values.iter().map(|v| factor.number(v));
    let (low, high) =
        (numbers().fold(f64::INFINITY, f64::min), numbers().fold(f64::NEG_INFINITY, f64::max));
    if !factor.has_slope() || low >= high {
        return listed;
    }
    let at = |end: f64| -> Vec<(u32, f64)> {
        let there = runs.iter().filter(|r| factor.number(&r.values[n]) == end);
        there.map(|r| (r.configuration, r.outcomes[outcome])).collect()
    };
    let (low_runs, high_runs) = (at(low), at(high));
    let Some(slope) = change_for_one_unit(&low_runs, &high_runs, high - low) else {
        return SweepEffect { slope: None, slope_half_width: None, slope_p: None, ..listed };
    };
    let of_each: Vec<f64> = high_runs
        .iter()
        .filter_map(|pair| {
            Some(change_for_one_unit(&low_runs, std::slice::from_ref(pair), high - low)?.mean)
        })
        .collect();
    let tested = effect(factor, outcome, listed.means, &of_each, listed.page_p);
    SweepEffect { slope: Some(slope.mean), slope_half_width: slope.half_width_95(), ..tested }
}

fn effect(
    factor: &SweepFactor,
    outcome: &str,
    means: Vec<(Value, SweepEstimate)>,
    slopes: &[f64],
    page_p: Option<f64>,
) -> SweepEffect {
    let test = MeanTest::of(slopes, CONFIDENCE);
    // Two values say next to nothing of their scatter.
    let known = test.filter(|t| t.estimate.count >= 3);
    let size = known.map(|t| (t.estimate.mean / t.standard_deviation).abs());
    let size = size.filter(|s| s.is_finite());
    SweepEffect {
        factor: factor.path.clone(),
        outcome: outcome.to_owned(),
        means,
        slope: mean(slopes),
        slope_half_width: test.map(|t| t.half_width),
        slope_p: test.map(|t| t.p),
        page_p,
        configurations_needed: size.and_then(|s| values_needed(s, CONFIDENCE, POWER)),
        ..SweepEffect::default()
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::super::points::points;
    use super::*;
    use crate::study::tests::bare_scenario as base;

    const RESULT: &str = "void_ratio";

    fn factor(path: &str, values: &[Value], sampled: bool) -> SweepFactor {
        let numeric = values.iter().all(Value::is_number);
        SweepFactor { path: path.into(), values: values.to_vec(), sampled, numeric }
    }

    /// Results by a rule of the factors' numbers and the configuration.
    fn runs(
        points: &[Point],
        factors: &[SweepFactor],
        rule: impl Fn(&[f64], u32) -> f64,
    ) -> Vec<SweepRun> {
        let of = |point: &Point, configuration: u32| {
            let numbers: Vec<f64> =
                factors.iter().zip(&point.values).map(|(f, v)| f.number(v)).collect();
            SweepRun {
                run: format!("{}-c{configuration}", point.name),
                point: point.name.clone(),
                configuration,
                values: point.values.clone(),
                outcomes: BTreeMap::from([(RESULT.to_owned(), rule(&numbers, configuration))]),
                ..SweepRun::counted()
            }
        };
        (1..=3).flat_map(|c| points.iter().map(move |p| (p, c))).map(|(p, c)| of(p, c)).collect()
    }

    fn assert_slope(effect: &SweepEffect, expected: f64) {
        let got = effect.slope.expect("a slope");
        assert!(
            (got - expected).abs() < 1e-9,
            "law: slope of {}, expected {expected}, got {got}, tolerance 1e-9",
            effect.factor
        );
    }

    /// Law: on a plane the slopes of a grid are the plane's, whatever each configuration adds.
    #[test]
    fn a_grid_gives_the_slopes_of_a_plane() {
        let over = ["a=1,2,4", "b=10,20"].map(|t| t.parse().expect("a factor"));
        let all = points(Design::Grid, &over, &[], &[], &base()).expect("points");
        let factors = [
            factor("a", &[json!(1), json!(2), json!(4)], false),
            factor("b", &[json!(10), json!(20)], false),
        ];
        let runs = runs(&all, &factors, |x, c| 3.0 * x[0] - 0.5 * x[1] + f64::from(c));
        let found = effects(Design::Grid, &factors, &all, &runs);
        assert_eq!(found.len(), 2, "law: one result that was measured, two factors");
        assert_slope(&found[0], 3.0);
        assert_slope(&found[1], -0.5);
        let p = found[0].page_p.expect("three values in three configurations");
        assert!((p - 2.0 / 216.0).abs() < 1e-12, "law: each order is one of six, got {p}");
        let falling: Vec<SweepRun> = runs
            .iter()
            .map(|run| {
                let outcomes = run.outcomes.iter().map(|(path, v)| (path.clone(), -v)).collect();
                SweepRun { outcomes, ..run.clone() }
            })
            .collect();
        let turned = &effects(Design::Grid, &factors, &all, &falling)[0];
        assert_eq!(turned.page_p, Some(p), "law: falling or rising, the same");
        assert_eq!(found[1].page_p, None, "law: two values make no order");
        let half = found[0].slope_half_width.expect("three configurations");
        assert!(half < 1e-9, "law: slopes that agree leave no doubt, got ± {half}");
        let rows = point_rows(&all, &runs);
        assert_eq!(rows.len(), 6);
        assert_eq!(rows[0].outcomes[RESULT].count, 3, "law: three configurations a point");
    }

    /// Law: a configuration that lacks a point does not take part.
    #[test]
    fn a_failed_run_takes_its_configuration_with_it() {
        let over = ["a=1,2".parse().expect("a factor")];
        let all = points(Design::Grid, &over, &[], &[], &base()).expect("points");
        let factors = [factor("a", &[json!(1), json!(2)], false)];
        let mut runs = runs(&all, &factors, |x, c| x[0] * f64::from(c));
        let found = effects(Design::Grid, &factors, &all, &runs);
        assert!(found[0].configurations_needed.is_some(), "law: three have a scatter: {found:?}");
        runs[5].outcomes.clear();
        runs[5].failure = Some("it broke".into());
        runs[5].valid = None;
        let found = effects(Design::Grid, &factors, &all, &runs);
        assert_eq!(found[0].configurations_needed, None, "law: two are too few to know theirs");
        assert_eq!(found[0].means[0].1.count, 2, "law: two whole configurations are left");
        assert_slope(&found[0], 1.5);
        let row = &point_rows(&all, &runs)[1];
        assert_eq!((row.runs, row.valid, row.failed), (2, 2, 1), "law: each is counted as it is");
    }

    /// Law: what is left out moves neither means nor effects, of no design, and is counted;
    /// where nothing is left out nothing changes, and where everything is there is no number.
    #[test]
    fn a_run_left_out_moves_nothing_and_is_counted() {
        let over = ["a=1,2".parse().expect("a factor")];
        let all = points(Design::Grid, &over, &[], &[], &base()).expect("points");
        let factors = [factor("a", &[json!(1), json!(2)], false)];
        let good = runs(&all, &factors, |x, c| x[0] * f64::from(c));
        let spoil = |runs: &mut [SweepRun], which: &[usize]| {
            for n in which {
                let run = &mut runs[*n];
                run.left_out_of_means = Some("grains are missing".into());
                run.outcomes.insert(RESULT.to_owned(), 1e6);
            }
        };
        for design in [Design::Grid, Design::OneAtATime] {
            let told = |runs: &[SweepRun]| {
                let e = effects(design, &factors, &all, runs).remove(0);
                (e.slope, e.runs, e.left_out)
            };
            assert_eq!(told(&good), (Some(2.0), 6, 0), "law: {design:?}, nothing left out");
            // The last configuration's second point; its slope was 3.
            let mut one = good.clone();
            spoil(&mut one, &[5]);
            assert_eq!(told(&one), (Some(1.5), 5, 1), "law: {design:?}, its pair is left out");
            let mut none = good.clone();
            spoil(&mut none, &[0, 1, 2, 3, 4, 5]);
            assert_eq!(told(&none), (None, 0, 6), "law: {design:?}, nothing of nothing");
        }
        let mut one = good.clone();
        spoil(&mut one, &[5]);
        let told = |runs: &[SweepRun]| {
            let row = point_rows(&all, runs).remove(1);
            (row.outcomes.get(RESULT).map(|e| (e.mean, e.count)), row.runs, row.left_out)
        };
        assert_eq!(told(&good), (Some((4.0, 3)), 3, 0), "law: 2, 4 and 6");
        assert_eq!(told(&one), (Some((3.0, 2)), 3, 1), "law: 2 and 4");
        spoil(&mut one, &[1, 3]);
        assert_eq!(told(&one), (None, 3, 3), "law: nothing is made of nothing");
        let drawn = points(
            Design::LatinHypercube(5),
            &[],
            &[],
            &["contact.restitution=0..1".parse().expect("a range")],
            &base(),
        )
        .expect("points");
        let factors = [factor("contact.restitution", &[json!(0.0), json!(1.0)], true)];
        let mut runs = runs(&drawn, &factors, |x, _| 3.0 * x[0]);
        spoil(&mut runs, &[2]);
        let found = effects(Design::LatinHypercube(5), &factors, &drawn, &runs).remove(0);
        assert_slope(&found, 3.0);
        assert_eq!((found.runs, found.left_out), (14, 1), "law: drawn values, too");
    }

    /// Law: of a run that counts and withholds a result the effect says so, and its point has one value
    /// less.
    #[test]
    fn a_withheld_result_is_counted() {
        let over = ["a=1,2".parse().expect("a factor")];
        let all = points(Design::Grid, &over, &[], &[], &base()).expect("points");
        let factors = [factor("a", &[json!(1), json!(2)], false)];
        let mut runs = runs(&all, &factors, |x, c| x[0] * f64::from(c));
        runs[5].outcomes.clear();
        runs[5].withheld =
            vec![Withheld { field: RESULT.to_owned(), reason: "it is low".to_owned() }];
        let found = effects(Design::Grid, &factors, &all, &runs).remove(0);
        let got = (found.runs, found.left_out, found.withheld);
        assert_eq!(got, (5, 0, 1), "law: runs, left out, withheld (got left)");
        let row = &point_rows(&all, &runs)[1];
        let got = (row.runs, row.left_out, row.outcomes[RESULT].count);
        assert_eq!(got, (3, 0, 2), "law: runs, left out, values of the mean (got left)");
    }

    /// Law: of a factor varied by itself the slope is that between its ends, and
    /// a value between them does not count; pairs that lack an end do not either.
    #[test]
    fn one_at_a_time_the_slope_is_that_between_the_ends() {
        let over = ["contact.restitution=0.1,0.9".parse().expect("a factor")];
        let all = points(Design::OneAtATime, &over, &[], &[], &base()).expect("points");
        let values = [json!(0.315), json!(0.1), json!(0.9)];
        let factors = [factor("contact.restitution", &values, false)];
        let bent = |x: &[f64], c: u32| if x[0] == 0.315 { 99.0 } else { x[0] * f64::from(c) };
        let mut runs = runs(&all, &factors, bent);
        let found = effects(Design::OneAtATime, &factors, &all, &runs);
        assert_slope(&found[0], 2.0);
        // Student's t of two degrees of freedom is 4.303; slopes 1, 2 and 3.
        let half = found[0].slope_half_width.expect("three configurations");
        assert!((half - 4.3027 / 3f64.sqrt()).abs() < 1e-3, "law: t · s/√3, got ± {half}");
        runs[7].outcomes.clear();
        runs[7].failure = Some("it broke".into());
        let found = effects(Design::OneAtATime, &factors, &all, &runs);
        assert_slope(&found[0], 1.5);
    }

    /// Law: values drawn from ranges give the coefficients of a linear law.
    #[test]
    fn drawn_values_give_the_coefficients_of_a_linear_law() {
        let ranges = ["contact.restitution=0..1", "gravity_m_per_s2=1000..3000"]
            .map(|t| t.parse().expect("a range"));
        let design = Design::LatinHypercube(12);
        let all = points(design, &[], &[], &ranges, &base()).expect("points");
        let factors = [
            factor("contact.restitution", &[json!(0.0), json!(1.0)], true),
            factor("gravity_m_per_s2", &[json!(1000.0), json!(3000.0)], true),
        ];
        let runs = runs(&all, &factors, |x, c| 2.0 * x[0] - 0.001 * x[1] + f64::from(c));
        let found = effects(design, &factors, &all, &runs);
        assert_slope(&found[0], 2.0);
        assert_slope(&found[1], -0.001);
    }

    /// Law: words have means and no slope, also beside values that are drawn.
    #[test]
    fn words_have_means_and_no_slope() {
        let over: [Factor; 1] = ["engine.backend=bullet,rapier".parse().expect("a factor")];
        let words = factor("engine.backend", &[json!("bullet"), json!("rapier")], false);
        let range: SampledRange = "contact.restitution=0..1".parse().expect("a range");
        let drawn = factor("contact.restitution", &[json!(0.0), json!(1.0)], true);
        for (design, ranges, factors) in [
            (Design::Grid, vec![], vec![words.clone()]),
            (Design::LatinHypercube(5), vec![range], vec![words, drawn]),
        ] {
            let all = points(design, &over, &[], &ranges, &base()).expect("points");
            let runs = runs(&all, &factors, |x, _| x[0]);
            let found = effects(design, &factors, &all, &runs);
            assert_eq!(found[0].slope, None, "law: {design:?}");
            let means: Vec<f64> = found[0].means.iter().map(|(_, e)| e.mean).collect();
            assert_eq!(means, [1.0, 2.0], "law: {design:?}, in the order in which they were given");
        }
    }

    /// Law: numbers that only name realisations have means and no slope, of no design.
    #[test]
    fn realisations_have_means_and_no_slope() {
        let over: [Factor; 1] = ["seed=1,2,3".parse().expect("a factor")];
        let seeds = factor("seed", &[json!(1), json!(2), json!(3)], false);
        let range: SampledRange = "seed=1..1000".parse().expect("a range");
        let drawn = factor("seed", &[json!(1), json!(1000)], true);
        for (design, over, ranges, factors, expected) in [
            (Design::Grid, &over[..], vec![], [seeds.clone()], 3),
            (Design::OneAtATime, &over[..], vec![], [seeds], 3),
            (Design::LatinHypercube(5), &over[..0], vec![range], [drawn], 0),
        ] {
            let all = points(design, over, &[], &ranges, &base()).expect("points");
            let runs = runs(&all, &factors, |x, c| x[0] * f64::from(c));
            let found = effects(design, &factors, &all, &runs).remove(0);
            let told = (found.slope, found.slope_p, found.page_p, found.configurations_needed);
            assert_eq!(told, (None, None, None, None), "law: {design:?}");
            assert_eq!(
                found.means.len(),
                expected,
                "law: {design:?}, a mean at each that is listed"
            );
        }
    }
}
