//! Beverloo's law of the discharge of a hopper, fitted to rates through openings.
//!
//! W = C ρ √g (D − k d)^2.5, with W the mass rate, ρ the bulk density, D the diameter of the opening
//! and d that of a grain. With another exponent n it is written as W = C ρ √g d^2.5 (D/d − k)^n, so
//! that C has no unit whatever n is. Rates scatter by a share of themselves: the squares that are
//! least are those of the logarithms.

use pluvia::measure::statistics::least_squares_slope;

/// Lowest k that is tried. Below zero the law has no meaning by itself: grains would flow where
/// there is no opening. But rates scatter to either side of the law, k with them, and the exponent
/// makes up for it: a fit that may not go below zero cuts large exponents off and not small ones,
/// so that their mean is no longer that of the law. Rates that scatter by 4 % do not come near this
/// bound.
const LEAST_K: f64 = -20.0;
/// Least width of an opening beyond k grains, in grains.
const LEAST_GAP: f64 = 0.02;
/// Values of k that are tried before the best one is closed in on.
const TRIED: usize = 2000;
/// How near to a bound a k is at it, in grains.
const AT_BOUND: f64 = 1e-6;

/// A steady flow through an opening.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Discharge {
    /// Diameter of the opening in m.
    pub opening: f64,
    /// Mass rate in kg/s.
    pub rate: f64,
    /// Bulk density above the opening in kg/m³.
    pub bulk_density: f64,
}

/// What is held while the rest of the law is fitted.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Held {
    /// The exponent.
    pub exponent: Option<f64>,
    /// The share of a grain, k.
    pub k: Option<f64>,
}

/// Beverloo's law as fitted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BeverlooFit {
    /// The coefficient C.
    pub c: f64,
    /// Grain diameters by which the opening counts as narrower; negative where scatter asks for it.
    pub k: f64,
    /// Whether k is the least or the largest that is tried: rates may ask for one beyond it.
    pub at_bound: bool,
    /// The exponent.
    pub exponent: f64,
    /// Root mean square of the residuals of ln W.
    pub residual: f64,
}

/// Fits the law to discharges of grains of diameter `size` (m) under `gravity` (m/s²), by least
/// squares of ln W. `None` where there are no more rates than what is fitted, or one is not
/// positive.
pub fn fit_beverloo(
    discharges: &[Discharge],
    size: f64,
    gravity: f64,
    held: Held,
) -> Option<BeverlooFit> {
    let free = 1 + usize::from(held.exponent.is_none()) + usize::from(held.k.is_none());
    let unit = gravity.sqrt() * size.powf(2.5);
    let points: Vec<(f64, f64)> = discharges
        .iter()
        .map(|f| (f.opening / size, (f.rate / (f.bulk_density * unit)).ln()))
        .collect();
    let sound = points.iter().all(|(d, y)| d.is_finite() && y.is_finite());
    if points.len() <= free || !sound {
        return None;
    }
    let narrowest = points.iter().map(|p| p.0).fold(f64::INFINITY, f64::min);
    let most = narrowest - LEAST_GAP;
    let with = |k: f64| with_k(&points, k, held.exponent);
    if let Some(k) = held.k {
        return (k <= most).then(|| with(k)).flatten();
    }
    let at = |n: usize| LEAST_K + (most - LEAST_K) * n as f64 / TRIED as f64;
    let squares = |k: f64| with(k).map_or(f64::INFINITY, |fit| fit.residual);
    let best = (0..=TRIED).min_by(|a, b| squares(at(*a)).total_cmp(&squares(at(*b))))?;
    let (mut low, mut high) = (at(best.saturating_sub(1)), at((best + 1).min(TRIED)));
    // Golden section.
    let share = (5f64.sqrt() - 1.0) / 2.0;
    while high - low > 1e-10 {
        let (a, b) = (high - share * (high - low), low + share * (high - low));
        if squares(a) <= squares(b) { high = b } else { low = a }
    }
    let fit = with((low + high) / 2.0)?;
    let at_bound = fit.k - LEAST_K < AT_BOUND || most - fit.k < AT_BOUND;
    Some(BeverlooFit { at_bound, ..fit })
}

/// The least and the largest k of fits, and how many are at a bound of what is tried, for a reader.
pub fn k_in_words(fits: &[BeverlooFit]) -> String {
    let ks = || fits.iter().map(|fit| fit.k);
    let (low, high) = (ks().fold(f64::INFINITY, f64::min), ks().fold(f64::NEG_INFINITY, f64::max));
    let of = |k: f64| format!("{k:.2}").replace('-', "−");
    let range = match fits.len() {
        0 => return "no k, nothing could be fitted".to_owned(),
        1 => format!("k {}", of(low)),
        _ => format!("k {} to {}", of(low), of(high)),
    };
    match fits.iter().filter(|fit| fit.at_bound).count() {
        0 => range,
        count => format!("{range}, k at its bound in {count} of {}", fits.len()),
    }
}

/// The law of one k, through D/d and ln W.
fn with_k(points: &[(f64, f64)], k: f64, exponent: Option<f64>) -> Option<BeverlooFit> {
    let logs: Vec<(f64, f64)> = points.iter().map(|(d, y)| ((d - k).ln(), *y)).collect();
    let count = logs.len() as f64;
    let exponent = match exponent {
        Some(held) => held,
        None => least_squares_slope(&logs)?,
    };
    let level = logs.iter().map(|(x, y)| y - exponent * x).sum::<f64>() / count;
    let squares: f64 = logs.iter().map(|(x, y)| (y - exponent * x - level).powi(2)).sum();
    let residual = (squares / count).sqrt();
    Some(BeverlooFit { c: level.exp(), k, at_bound: false, exponent, residual })
}

/// Longest time in s in which nothing passes an opening that is not jammed.
const LONGEST_STOP: f64 = 0.3;
/// Most by which the rates of the two halves of a steady flow differ, as a factor: what dies away
/// grain by grain is no more steady than what stops. Ours; halves of flows that go on differ by less
/// than 1.4.
const MOST_CHANGE: f64 = 2.0;

/// An outflow as read.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Outflow {
    /// Steady, at a rate in kg/s.
    Steady(f64),
    /// For a while nothing passed.
    Jammed,
    /// Too little was watched to tell, or it stood still when the watch ended.
    Short,
    /// It died away or grew.
    Unsteady,
}

/// Rate of a steady outflow: the slope of the straight line through the mass that has passed, from
/// `settled` s after the opening at `opened` until `most` kg have passed.
///
/// `series` holds times in s and the mass in kg passed since the time before. It is short with less
/// than four times within; and where it ends before `most` has passed with a stop longer than each
/// before: who watches no longer cannot tell that from a jam. It is unsteady where the rates of its
/// halves differ by more than [`MOST_CHANGE`].
pub fn steady_outflow(series: &[(f64, f64)], opened: f64, settled: f64, most: f64) -> Outflow {
    let mut sum = 0.0;
    let all = series.iter().filter(|(time, _)| *time > opened);
    let passed: Vec<(f64, f64)> = all
        .map(|(time, mass)| {
            sum += mass;
            (*time, sum)
        })
        .collect();
    let within = |p: &&(f64, f64)| p.0 >= opened + settled && p.1 <= most;
    let steady: Vec<(f64, f64)> = passed.iter().filter(within).copied().collect();
    if steady.len() < 4 {
        return Outflow::Short;
    }
    let (mut since, mut longest) = (steady[0], 0.0f64);
    for point in &steady {
        if point.1 > since.1 {
            longest = longest.max(point.0 - since.0);
            since = *point;
        } else if point.0 - since.0 >= LONGEST_STOP {
            return Outflow::Jammed;
        }
    }
    let stop = steady[steady.len() - 1].0 - since.0;
    let goes_on = passed.last().is_some_and(|p| p.1 > most);
    if !goes_on && stop > longest * (1.0 + 1e-6) {
        return Outflow::Short;
    }
    let (first, second) = (&steady[..=steady.len() / 2], &steady[steady.len() / 2..]);
    let mean = |half: &[(f64, f64)]| {
        let (begin, end) = (half[0], half[half.len() - 1]);
        (end.1 - begin.1) / (end.0 - begin.0)
    };
    let (first, second) = (mean(first), mean(second));
    if first > MOST_CHANGE * second || second > MOST_CHANGE * first {
        return Outflow::Unsteady;
    }
    least_squares_slope(&steady).map_or(Outflow::Short, Outflow::Steady)
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: f64 = 0.009;

    /// Rates by the law itself.
    fn exact(c: f64, k: f64, exponent: f64) -> Vec<Discharge> {
        let unit = 9.81f64.sqrt() * SIZE.powf(2.5);
        [5.0, 6.0, 7.0, 8.0, 10.0]
            .map(|d: f64| Discharge {
                opening: d * SIZE,
                rate: c * 1400.0 * unit * (d - k).powf(exponent),
                bulk_density: 1400.0,
            })
            .to_vec()
    }

    #[test]
    fn the_law_is_found_again_in_its_own_rates() {
        for (c, k, exponent) in
            [(0.58, 1.4, 2.5), (0.3, 0.2, 2.2), (0.7, 2.9, 2.8), (0.2, -1.2, 3.4)]
        {
            let rates = exact(c, k, exponent);
            let fit = fit_beverloo(&rates, SIZE, 9.81, Held::default()).expect("a fit");
            for (name, expected, got) in
                [("C", c, fit.c), ("k", k, fit.k), ("exponent", exponent, fit.exponent)]
            {
                assert!(
                    (got - expected).abs() < 1e-5,
                    "law: {name} of exact rates, expected {expected}, got {got}, tolerance 1e-5"
                );
            }
            assert!(fit.residual < 1e-7, "law: nothing is left over, got {}", fit.residual);
            assert!(!fit.at_bound, "law: k {k} is at no bound");
        }
        let held = Held { exponent: Some(2.5), k: None };
        let fit = fit_beverloo(&exact(0.4, -0.8, 2.5), SIZE, 9.81, held).expect("a fit");
        let off = (fit.k + 0.8).abs();
        assert!(off < 1e-6, "law: k −0.8 by the usual exponent, got {}, tolerance 1e-6", fit.k);
    }

    /// Law: rates that scatter to either side of a law move its exponent to either side by about as
    /// much, also where one of both asks for a k below zero.
    #[test]
    fn scatter_to_either_side_leaves_the_exponent_where_it_is() {
        let fit = |sign: f64| {
            let mut rates = exact(0.58, 0.3, 2.5);
            for (rate, by) in rates.iter_mut().zip([1.0, -1.0, -1.0, 0.0, 1.0]) {
                rate.rate *= (0.006 * sign * by).exp();
            }
            fit_beverloo(&rates, SIZE, 9.81, Held::default()).expect("a fit")
        };
        let (more, less) = (fit(1.0), fit(-1.0));
        assert!(more.k < -0.1 && less.k > 0.6, "law: to either side of 0.3: {more:?}, {less:?}");
        assert!(!more.at_bound && !less.at_bound, "law: neither is at a bound");
        let mean = (more.exponent + less.exponent) / 2.0;
        assert!((mean - 2.5).abs() < 0.02, "law: 2.5 on average, got {mean}, tolerance 0.02");
    }

    /// Law: a fit that ends at a bound of k says so, and words count such fits.
    #[test]
    fn a_k_at_its_bound_is_counted() {
        let law = |of: fn(f64) -> f64| -> Vec<Discharge> {
            let rate = |d: f64| Discharge { opening: d * SIZE, rate: of(d), bulk_density: 1400.0 };
            [5.0, 6.0, 7.0, 8.0, 10.0].map(rate).to_vec()
        };
        let fit = |rates: &[Discharge], held| fit_beverloo(rates, SIZE, 9.81, held).expect("a fit");
        let (free, usual) = (Held::default(), Held { exponent: Some(2.5), k: None });
        // An exponential function is a power of k without end; one of 0.01 at 5 d wants a k of
        // 4.99.
        for (what, rates, held) in [
            ("the least, free", law(|d| (0.4 * d).exp()), free),
            ("the least, usual", law(|d| (d + 30.0).powf(2.5)), usual),
            ("the largest, free", law(|d| (d - 4.99).powf(2.5)), free),
            ("the largest, usual", law(|d| (d - 4.99).powf(2.5)), usual),
        ] {
            let got = fit(&rates, held);
            assert!(got.at_bound, "law: {what}: k at its bound, got {got:?}");
        }
        let inner = fit(&exact(0.58, 1.4, 2.5), free);
        let below = fit(&exact(0.2, -1.2, 3.4), free);
        let bound = BeverlooFit { at_bound: true, ..below };
        for (fits, expected) in [
            (vec![inner], "k 1.40"),
            (vec![inner, below], "k −1.20 to 1.40"),
            (vec![inner, bound, inner], "k −1.20 to 1.40, k at its bound in 1 of 3"),
            (Vec::new(), "no k, nothing could be fitted"),
        ] {
            assert_eq!(k_in_words(&fits), expected, "law: left the words, right what they say");
        }
    }

    #[test]
    fn what_is_held_stays_and_the_rest_follows() {
        let rates = exact(0.58, 1.4, 2.5);
        let held = Held { exponent: Some(2.5), k: None };
        let fit = fit_beverloo(&rates, SIZE, 9.81, held).expect("a fit");
        assert!((fit.k - 1.4).abs() < 1e-6 && (fit.c - 0.58).abs() < 1e-6, "law: {fit:?}");
        // A k that is too small asks for a larger exponent.
        let held = Held { exponent: None, k: Some(0.0) };
        let fit = fit_beverloo(&rates, SIZE, 9.81, held).expect("a fit");
        assert!(fit.exponent > 2.8 && fit.residual > 1e-3, "law: not the exponent, got {fit:?}");
    }

    #[test]
    fn too_few_rates_and_blocked_openings_give_no_law() {
        let rates = exact(0.58, 1.4, 2.5);
        assert_eq!(fit_beverloo(&rates[..3], SIZE, 9.81, Held::default()), None, "law: 3 of 3");
        let mut blocked = rates.clone();
        blocked[0].rate = 0.0;
        assert_eq!(fit_beverloo(&blocked, SIZE, 9.81, Held::default()), None, "law: no flow");
        let wide = Held { exponent: None, k: Some(6.0) };
        assert_eq!(fit_beverloo(&rates, SIZE, 9.81, wide), None, "law: k wider than the opening");
    }

    #[test]
    fn an_outflow_is_read_where_it_is_steady() {
        // Opened at 1 s; for 0.2 s it begins, then 0.5 kg/s, from 3 kg on it dies away.
        let (mut sum, mut series) = (0.0, vec![(1.0, 7.0)]);
        for n in 1..=100 {
            let mass = if n <= 2 {
                0.01
            } else if sum < 3.0 {
                0.05
            } else {
                0.005
            };
            sum += mass;
            series.push((1.0 + 0.1 * f64::from(n), mass));
        }
        let got = steady_outflow(&series, 1.0, 0.25, 2.5);
        let Outflow::Steady(rate) = got else { panic!("law: it is steady, got {got:?}") };
        assert!((rate - 0.5).abs() < 1e-9, "law: 0.5 kg/s, got {rate}, tolerance 1e-9");
        let short = steady_outflow(&series, 1.0, 0.25, 0.1);
        assert_eq!(short, Outflow::Short, "law: too little has passed");
        // Nothing passes for 0.3 s.
        for row in &mut series[10..=12] {
            row.1 = 0.0;
        }
        let jammed = steady_outflow(&series, 1.0, 0.25, 2.5);
        assert_eq!(jammed, Outflow::Jammed, "law: an outflow that stops is no rate");
        series[12].1 = 0.05;
        let slow = steady_outflow(&series, 1.0, 0.25, 2.5);
        assert!(matches!(slow, Outflow::Steady(_)), "law: 0.2 s are no jam, got {slow:?}");
    }

    /// Law: where the watch ends before the bin is no longer full, a flow that stands still is not
    /// known to go on, unless it stood as long before; a row between two grains is no stop.
    #[test]
    fn an_outflow_that_stands_still_at_the_end_of_the_watch_is_no_rate() {
        // Rows of 0.05 s, 0.02 kg in each but those that are named.
        let watched = |rows: usize, empty: &[usize]| -> Vec<(f64, f64)> {
            let mass = |n: &usize| if empty.contains(n) { 0.0 } else { 0.02 };
            (1..=rows).map(|n| (0.05 * n as f64, mass(&n))).collect()
        };
        for (rows, empty, most, expected) in [
            (24, Vec::new(), 2.0, "steady"),
            // The last row alone, as long as from one grain to the next.
            (24, vec![24], 2.0, "steady"),
            (24, vec![23, 24], 2.0, "short"),
            (24, vec![21, 22, 23, 24], 2.0, "short"),
            (24, vec![18, 19, 20, 21, 22, 23, 24], 2.0, "jammed"),
            // It stood as long before.
            (24, vec![12, 13, 14, 22, 23, 24], 2.0, "steady"),
            // What stops when the bin is no longer full says nothing.
            (24, vec![21, 22, 23, 24], 0.3, "steady"),
        ] {
            let got = steady_outflow(&watched(rows, &empty), 0.0, 0.24, most);
            let called = match got {
                Outflow::Steady(_) => "steady",
                Outflow::Jammed => "jammed",
                Outflow::Short => "short",
                Outflow::Unsteady => "unsteady",
            };
            assert_eq!(called, expected, "law: of {rows} rows {empty:?} empty, got {got:?}");
        }
    }

    /// Law: a flow that dies away or grows gives no rate, one that varies by less does.
    #[test]
    fn an_outflow_that_dies_away_is_no_rate() {
        let flow = |factor: f64| -> Vec<(f64, f64)> {
            (1..=24).map(|n| (0.05 * f64::from(n), 0.02 * factor.powi(n))).collect()
        };
        let read = |factor: f64| steady_outflow(&flow(factor), 0.0, 0.24, 2.0);
        for factor in [0.85, 1.2] {
            assert_eq!(read(factor), Outflow::Unsteady, "law: {factor} from row to row");
        }
        for factor in [0.95, 1.0, 1.05] {
            let got = read(factor);
            assert!(
                matches!(got, Outflow::Steady(_)),
                "law: {factor} from row to row, got {got:?}"
            );
        }
    }
}
