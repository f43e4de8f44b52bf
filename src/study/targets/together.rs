//! How probable it is to meet several targets together, searched over the ranges of all factors.
//!
//! Points fill the ranges evenly (Halton 1960). Residuals of different targets at one point go
//! together, as those of two results of one specimen do: where there are enough points that have
//! all targets, the correlations of their studentised residuals are taken, the dependence is that
//! of a normal copula (Sklar 1959; Li 2000), and every target keeps its own Student's t.

use statrs::distribution::{ContinuousCDF, Normal};

use super::points::{Point, met, met_at, points};
use super::*;
use crate::report::Together;

/// Points that are searched.
const POINTS: usize = 20_000;

/// Draws of residuals that go together. Ours: a probability of 0.1 is known to ± 0.01.
const DRAWS: usize = 1000;

/// Points with all targets that are needed for correlations, for each target. Ours.
const POINTS_A_TARGET: usize = 3;

/// Factors that are searched, and targets, a bit each of [`draws_met`]: a base of [`halton`] each.
pub(super) const MOST: usize = PRIMES.len();

/// Two targets, or all, while points are searched.
struct Group {
    which: Vec<usize>,
    sum: f64,
    best: (usize, f64),
}

pub(super) fn search(models: &[Modelled], mut targets: Vec<TargetFound>) -> TargetsFound {
    let mut factors: BTreeMap<String, [f64; 2]> = BTreeMap::new();
    for Modelled { table, .. } in models {
        for (n, name) in table.factors.iter().enumerate() {
            let range = factors.entry(name.clone()).or_insert([f64::MAX, f64::MIN]);
            for row in &table.rows {
                *range = [range[0].min(row.factors[n]), range[1].max(row.factors[n])];
            }
        }
    }
    let names: Vec<&String> = factors.keys().collect();
    let ranges: Vec<[f64; 2]> = factors.values().copied().collect();
    let place = |name: &String| names.iter().position(|n| *n == name);
    let places: Vec<Vec<usize>> =
        models.iter().map(|m| m.table.factors.iter().filter_map(place).collect()).collect();
    let point = |number: usize| -> Vec<f64> {
        let of =
            |(n, range): (usize, &[f64; 2])| range[0] + (range[1] - range[0]) * even(number, n);
        ranges.iter().enumerate().map(of).collect()
    };
    let all_models: Vec<&Modelled> = models.iter().collect();
    let whole = points(&all_models);
    let correlations = correlations(models, &whole);
    let draws = correlations.as_deref().map(draws);
    let count = targets.len();
    let group = |which| Group { which, sum: 0.0, best: (0, -1.0) };
    let two = |a: usize| (a + 1..count).map(move |b| group(vec![a, b]));
    let mut pairs: Vec<Group> = (0..count).flat_map(two).collect();
    let mut all = group((0..count).collect());
    for number in 0..POINTS {
        let at = point(number);
        let own = |n: usize| -> Vec<f64> { places[n].iter().map(|place| at[*place]).collect() };
        let ranges: Vec<[f64; 2]> = (0..count)
            .map(|n| (&models[n].model, models[n].target, own(n)))
            .map(|(model, target, own)| model.below(&own, [target.low, target.high]))
            .collect();
        let alone: Vec<f64> = ranges.iter().map(|[low, high]| high - low).collect();
        for (found, chance) in targets.iter_mut().zip(&alone) {
            found.best = found.best.max(*chance);
        }
        let met = draws.as_ref().map(|draws| draws_met(draws, &ranges));
        for group in pairs.iter_mut().chain([&mut all]) {
            let chance: f64 = match &met {
                None => group.which.iter().map(|n| alone[*n]).product(),
                Some(met) => share(met, &group.which),
            };
            group.sum += chance;
            if chance > group.best.1 {
                group.best = (number, chance);
            }
        }
    }
    let together = |group: Group| {
        let wanted: Vec<&Modelled> = group.which.iter().map(|n| &models[*n]).collect();
        Together {
            points: met(&points(&wanted), &wanted),
            targets: group.which,
            mean: group.sum / POINTS as f64,
            best: group.best.1,
            at: names.iter().map(|n| (*n).clone()).zip(point(group.best.0)).collect(),
        }
    };
    let mut pairs: Vec<Together> = pairs.into_iter().map(together).collect();
    pairs.sort_by(|a, b| a.best.total_cmp(&b.best));
    let met_at = met_at(&whole, &all_models);
    let all = together(all);
    TargetsFound { factors, targets, correlations, pairs, all, met_at, searched: POINTS }
}

/// Correlations of the residuals of all targets at points that have them all, about a mean of
/// zero; none where such points are few.
fn correlations(models: &[Modelled], points: &[Point]) -> Option<Vec<Vec<f64>>> {
    let count = models.len();
    if count < 2 || points.len() < POINTS_A_TARGET * count {
        return None;
    }
    let residual = |point: usize, target: usize| {
        let (row, value) = points[point][target];
        models[target].model.studentised(row.specimen, &row.factors, value)
    };
    let residuals = DMatrix::from_fn(points.len(), count, residual);
    let products = residuals.tr_mul(&residuals);
    let of = |a: usize, b: usize| products[(a, b)] / (products[(a, a)] * products[(b, b)]).sqrt();
    let all: Vec<Vec<f64>> = (0..count).map(|a| (0..count).map(|b| of(a, b)).collect()).collect();
    all.iter().flatten().all(|x| x.is_finite()).then_some(all)
}

/// Results of all targets that go together, each by the probability that one is below it: normal
/// numbers with these correlations, of which those probabilities are taken.
fn draws(correlations: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let count = correlations.len();
    let matrix = DMatrix::from_fn(count, count, |a, b| correlations[a][b]).symmetric_eigen();
    let roots = matrix.eigenvalues.map(|of| of.max(0.0).sqrt());
    let root = &matrix.eigenvectors * DMatrix::from_diagonal(&roots);
    let normal = Normal::standard();
    let draw = |number: usize| -> Vec<f64> {
        let alone = DVector::from_fn(count, |n, _| normal.inverse_cdf(even(number, n)));
        (&root * alone).iter().map(|z| normal.cdf(*z)).collect()
    };
    (0..DRAWS).map(draw).collect()
}

/// Which targets each draw meets, a bit each, where results below the ends of their ranges have
/// these probabilities.
fn draws_met(draws: &[Vec<f64>], ranges: &[[f64; 2]]) -> Vec<u64> {
    let met = |draw: &Vec<f64>| {
        let inside =
            draw.iter().zip(ranges).map(|(below, [low, high])| low <= below && below <= high);
        inside.enumerate().fold(0, |met, (n, inside)| met | u64::from(inside) << n)
    };
    draws.iter().map(met).collect()
}

/// Share of draws that meet these targets.
fn share(met: &[u64], which: &[usize]) -> f64 {
    let wanted = which.iter().fold(0, |all, n| all | 1_u64 << n);
    met.iter().filter(|draw| *draw & wanted == wanted).count() as f64 / met.len() as f64
}

const PRIMES: [usize; 64] = [
    2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37, 41, 43, 47, 53, 59, 61, 67, 71, 73, 79, 83, 89, 97,
    101, 103, 107, 109, 113, 127, 131, 137, 139, 149, 151, 157, 163, 167, 173, 179, 181, 191, 193,
    197, 199, 211, 223, 227, 229, 233, 239, 241, 251, 257, 263, 269, 271, 277, 281, 283, 293, 307,
    311,
];

/// Bases from here on have the digits of their numbers mixed.
const PLAIN: usize = 12;

/// Element of an even sequence in one of as many dimensions as there are [`PRIMES`], from 0 to 1.
/// Two large bases fill a square by diagonals: their digits are multiplied by the fraction of the
/// base that its root has behind the point (after Kocis & Whiten 1997).
fn even(number: usize, dimension: usize) -> f64 {
    let base = PRIMES[dimension];
    let part = (base as f64).sqrt().fract() * base as f64;
    let by = if dimension < PLAIN { 1 } else { part.round().max(1.0) as usize };
    halton(number + 1, base, by)
}

/// Element of the van der Corput sequence of a base, from 0 to 1 (Halton 1960), each digit
/// multiplied by a number modulo the base.
fn halton(mut number: usize, base: usize, by: usize) -> f64 {
    let (mut share, mut value) = (1.0, 0.0);
    while number > 0 {
        share /= base as f64;
        value += share * (number * by % base) as f64;
        number /= base;
    }
    value
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Law: the first elements of the sequence of base 2 are 1/2, 1/4, 3/4, 1/8.
    #[test]
    fn haltons_sequence_halves_and_halves_again() {
        let got: Vec<f64> = (1..=4).map(|n| halton(n, 2, 1)).collect();
        assert_eq!(got, [0.5, 0.25, 0.75, 0.125]);
        let got = halton(5, 3, 1);
        assert!((got - (2.0 / 3.0 + 1.0 / 9.0)).abs() < 1e-15, "law: 5 is 12 in base 3");
        let got = halton(5, 3, 2);
        assert!((got - (1.0 / 3.0 + 2.0 / 9.0)).abs() < 1e-15, "law: twice 12 is 21, modulo 3");
    }

    /// Law: bases are the first primes, each once.
    #[test]
    fn no_base_is_that_of_another() {
        let is_prime = |n: &usize| (2..*n).all(|of| !n.is_multiple_of(of));
        let expected: Vec<usize> = (2..).filter(is_prime).take(MOST).collect();
        assert_eq!(PRIMES.to_vec(), expected);
    }

    /// Law: the places that are searched fill the square of any two factors. A tenth of its side
    /// has 200 of them on average; a base that is taken twice leaves nine tenths of them empty.
    #[test]
    fn places_fill_the_square_of_any_two_factors() {
        let tenth = |x: f64| ((10.0 * x) as usize).min(9);
        let places: Vec<Vec<usize>> = (0..MOST)
            .map(|factor| (0..POINTS).map(|number| tenth(even(number, factor))).collect())
            .collect();
        for a in 0..MOST {
            for b in 0..a {
                let mut counts = [0_usize; 100];
                for (x, y) in places[a].iter().zip(&places[b]) {
                    counts[10 * x + y] += 1;
                }
                let fewest = counts.iter().min().copied().unwrap_or_default();
                assert!(fewest >= 20, "law: factors {a} and {b}: 20 or more, got {fewest}");
            }
        }
    }
}
