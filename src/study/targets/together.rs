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

/// Targets of which the correlations are taken: a bit each of [`draws_met`].
const MOST_TARGETS: usize = 64;

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
        let of = |(n, range): (usize, &[f64; 2])| {
            range[0] + (range[1] - range[0]) * halton(number + 1, PRIMES[n % PRIMES.len()])
        };
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
    if !(2..=MOST_TARGETS).contains(&count) || points.len() < POINTS_A_TARGET * count {
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
        let alone = DVector::from_fn(count, |n, _| {
            normal.inverse_cdf(halton(number + 1, PRIMES[n % PRIMES.len()]))
        });
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

const PRIMES: [usize; 12] = [2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37];

/// Element of the van der Corput sequence of a base, from 0 to 1 (Halton 1960).
fn halton(mut number: usize, base: usize) -> f64 {
    let (mut share, mut value) = (1.0, 0.0);
    while number > 0 {
        share /= base as f64;
        value += share * (number % base) as f64;
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
        let got: Vec<f64> = (1..=4).map(|n| halton(n, 2)).collect();
        assert_eq!(got, [0.5, 0.25, 0.75, 0.125]);
        assert!((halton(5, 3) - (2.0 / 3.0 + 1.0 / 9.0)).abs() < 1e-15, "law: 5 is 12 in base 3");
    }
}
