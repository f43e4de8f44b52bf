//! What many pours of one kind say: means, and whether an engine's height is that
//! of the referee.

use std::collections::HashMap;

use pluvia::measure::{
    inference::t_quantile,
    statistics::{mean, sample_standard_deviation},
};
use serde::Serialize;

use super::{
    packing::Recipe,
    pours::{Engine, Poured},
};

/// Half width of what counts as equivalent, in %.
const MARGIN_PERCENT: f64 = 0.5;

/// One engine's pours of one kind, beside the referee's.
#[derive(Debug, Clone, Serialize)]
pub struct Cell {
    pub engine: Engine,
    pub friction: f64,
    pub restitution: f64,
    pub realisations: usize,
    /// Of the grains' centres of mass above the floor.
    pub height_mean_mm: f64,
    pub height_standard_error_mm: f64,
    /// Of the heights to the referee's of the same seeds, mean in % of the referee's
    /// mean, with its standard error and its 90 % interval; `null` for the referee.
    pub difference_percent: Option<f64>,
    pub difference_standard_error_percent: Option<f64>,
    pub difference_interval_percent: Option<[f64; 2]>,
    /// Two one-sided t-tests at 5 %: the interval lies within ±0.5 %.
    pub equivalent_within_0_5_percent: Option<bool>,
    /// Of the heights of the same seeds by this engine and the referee.
    pub correlation: Option<f64>,
    pub coordination_mean: f64,
    pub coordination_standard_error: f64,
    /// Of the loaded contact points; `null` without friction.
    pub sliding_share: Option<f64>,
    pub deepest_overlap_mm: f64,
    /// Grains of all pours whose centre is behind a wall.
    pub outside: u64,
    /// Of the referee: mean share of steps above its tolerance, and the worst residual.
    pub unsolved_share: Option<f64>,
    pub worst_residual: Option<f64>,
    /// Of the referee: largest energy that a step gained, over what the fall set free.
    pub energy_gain_worst: Option<f64>,
    pub wall_s_per_pour: f64,
}

/// Mean of a sample and its standard error.
struct Mean {
    value: f64,
    error: f64,
}

impl Mean {
    fn of(values: &[f64]) -> Self {
        let deviation = sample_standard_deviation(values).unwrap_or(f64::NAN);
        let error = deviation / (values.len() as f64).sqrt();
        Self { value: mean(values).unwrap_or(f64::NAN), error }
    }
}

fn all(poured: &[&Poured], value: impl Fn(&Poured) -> Option<f64>) -> Vec<f64> {
    poured.iter().filter_map(|p| value(p)).collect()
}

/// Compares an engine's pours with the referee's.
pub fn judge(recipe: &Recipe, engine: Engine, poured: &[&Poured], referee: &[&Poured]) -> Cell {
    let height = Mean::of(&all(poured, |p| Some(p.height_m)));
    let coordination = Mean::of(&all(poured, |p| Some(p.coordination)));
    let pairs = if engine == Engine::Referee { Vec::new() } else { pairs(poured, referee) };
    let difference = difference(&pairs);
    Cell {
        engine,
        friction: recipe.friction,
        restitution: recipe.restitution,
        realisations: poured.len(),
        height_mean_mm: 1e3 * height.value,
        height_standard_error_mm: 1e3 * height.error,
        difference_percent: difference.map(|d| d.percent),
        difference_standard_error_percent: difference.map(|d| d.error),
        difference_interval_percent: difference
            .map(|d| [d.percent - d.half_width, d.percent + d.half_width]),
        equivalent_within_0_5_percent: difference
            .map(|d| d.percent.abs() + d.half_width < MARGIN_PERCENT),
        correlation: correlation(&pairs),
        coordination_mean: coordination.value,
        coordination_standard_error: coordination.error,
        sliding_share: mean(&all(poured, |p| p.sliding)),
        deepest_overlap_mm: 1e3 * poured.iter().map(|p| p.deepest_overlap_m).fold(0.0, f64::max),
        outside: poured.iter().map(|p| p.outside).sum(),
        unsolved_share: mean(&all(poured, |p| p.unsolved)),
        worst_residual: all(poured, |p| p.worst_residual).into_iter().reduce(f64::max),
        energy_gain_worst: all(poured, |p| p.energy_gain).into_iter().reduce(f64::max),
        wall_s_per_pour: mean(&all(poured, |p| Some(p.wall_s))).unwrap_or(f64::NAN),
    }
}

/// Difference of two means in % of the second, its standard error, and half the
/// width of its 90 % interval.
#[derive(Clone, Copy)]
struct Difference {
    percent: f64,
    error: f64,
    half_width: f64,
}

/// Heights of the same seeds by an engine and the referee.
fn pairs(poured: &[&Poured], referee: &[&Poured]) -> Vec<(f64, f64)> {
    let by_seed: HashMap<u64, f64> = referee.iter().map(|p| (p.seed, p.height_m)).collect();
    poured.iter().filter_map(|p| by_seed.get(&p.seed).map(|truth| (p.height_m, *truth))).collect()
}

/// Student's interval of paired differences: the same grains that begin in the same
/// places scatter alike (`correlation`).
fn difference(pairs: &[(f64, f64)]) -> Option<Difference> {
    let truths: Vec<f64> = pairs.iter().map(|p| p.1).collect();
    let percent = 100.0 / mean(&truths)?;
    let differences: Vec<f64> = pairs.iter().map(|p| p.0 - p.1).collect();
    let of = Mean::of(&differences);
    let half_width = t_quantile(0.95, differences.len() as f64 - 1.0)? * of.error;
    Some(Difference {
        percent: of.value * percent,
        error: of.error * percent,
        half_width: half_width * percent,
    })
}

fn correlation(pairs: &[(f64, f64)]) -> Option<f64> {
    let n = pairs.len() as f64;
    let (a, b) = pairs.iter().fold((0.0, 0.0), |s, p| (s.0 + p.0 / n, s.1 + p.1 / n));
    let sum =
        |f: &dyn Fn(f64, f64) -> f64| -> f64 { pairs.iter().map(|p| f(p.0 - a, p.1 - b)).sum() };
    let value = sum(&|x, y| x * y) / (sum(&|x, _| x * x) * sum(&|_, y| y * y)).sqrt();
    value.is_finite().then_some(value)
}
