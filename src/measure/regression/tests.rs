//! Tests of linear models: planes that are known, and specimens that are shaken twice.

use statrs::distribution::Normal;

use super::super::testing::assert_near;
use super::*;

type Rows = Vec<(Vec<f64>, f64)>;

impl LinearModel {
    /// Mean of the result at a point.
    fn at(&self, point: &[f64]) -> f64 {
        self.strata.at(&scaled(point, &self.scales))
    }
}

/// A fit of runs that are specimens of their own.
fn alone(rows: &[(Vec<f64>, f64)]) -> Option<LinearModel> {
    LinearModel::fit(rows, &(0..rows.len()).collect::<Vec<_>>())
}

/// y = 2 + 3 a − 5 b with a given error at each of nine points of a grid.
fn grid(error: impl Fn(usize) -> f64) -> Rows {
    (0..9)
        .map(|n| {
            let (a, b) = ((n % 3) as f64, 10.0 * (n / 3) as f64);
            (vec![a, b], 2.0 + 3.0 * a - 5.0 * b + error(n))
        })
        .collect()
}

#[test]
fn a_plane_is_found_exactly() {
    let model = alone(&grid(|_| 0.0)).expect("a fit");
    assert_near("value of 2 + 3 a − 5 b at (0.5, 7)", -31.5, model.at(&[0.5, 7.0]), 1e-10);
    let effects = model.effects();
    assert_near("3 over a range of 2", 6.0, effects[0].change, 1e-10);
    assert_near("−5 over a range of 20", -100.0, effects[1].change, 1e-10);
    assert_near("all is explained", 1.0, model.quality().explained, 1e-12);
    assert_near("and predicted", 1.0, model.quality().predicted, 1e-12);
}

/// Law: of errors e = ±1 that are orthogonal to the plane the residuals are these, and
/// s² = Σ e² / (n − 3).
#[test]
fn scatter_is_that_of_the_residuals() {
    let orthogonal = [1.0, -2.0, 1.0, -2.0, 4.0, -2.0, 1.0, -2.0, 1.0];
    let model = alone(&grid(|n| orthogonal[n])).expect("a fit");
    let expected = (orthogonal.iter().map(|e| e * e).sum::<f64>() / 6.0).sqrt();
    let got = model.quality().residual_standard_deviation;
    assert_near("standard deviation of the residuals", expected, got, 1e-10);
    // In the middle of the grid (XᵀX)⁻¹ is 1/9: a new value has s √(1 + 1/9).
    let spread = expected * (1.0_f64 + 1.0 / 9.0).sqrt();
    let t = StudentsT::new(0.0, 1.0, 6.0).expect("a distribution").inverse_cdf(0.95);
    let middle = model.at(&[1.0, 10.0]);
    let got = model.between(&[1.0, 10.0], [middle - t * spread, middle + t * spread]);
    assert_near("nine tenths within ± t₀.₉₅ s √(1 + 1/9)", 0.9, got, 1e-9);
    let far = model.between(&[1.0, 10.0], [middle + 100.0 * spread, f64::INFINITY]);
    assert!(far < 1e-6, "law: next to none a hundred spreads away, got {far}");
}

/// Law: the variance of a residual is s² (1 − h) with Σ e² = s² (n − terms), and Σ h is the
/// number of terms; a value of a plane without scatter is certain.
#[test]
fn residuals_have_their_own_spread() {
    let rows = grid(|n| (n as f64 * 1.7).sin());
    let model = alone(&rows).expect("a fit");
    // Of a grid of three by three, h = 1/9 + a²/6 + b²/6 with a and b from −1 to 1.
    let share = |x: &[f64]| {
        let (a, b) = (x[0] - 1.0, x[1] / 10.0 - 1.0);
        1.0 - (1.0 / 9.0 + a * a / 6.0 + b * b / 6.0)
    };
    let squares =
        |(n, (x, y)): (usize, &(Vec<f64>, f64))| model.studentised(n, x, *y).powi(2) * share(x);
    let sum: f64 = rows.iter().enumerate().map(squares).sum();
    assert_near("Σ r² (1 − h) is the freedom", 6.0, sum, 1e-10);
    let mut certain = model;
    certain.strata.between.variance = 0.0;
    let middle = certain.at(&[1.0, 10.0]);
    let of = |low: f64, high: f64| certain.between(&[1.0, 10.0], [middle + low, middle + high]);
    assert_near("inside", 1.0, of(-1.0, 1.0), 0.0);
    assert_near("above", 0.0, of(1.0, 2.0), 0.0);
    assert_near("below", 0.0, of(-2.0, -1.0), 0.0);
}

/// Law: PRESS is the sum over fits that leave one value out.
#[test]
fn prediction_leaves_each_value_out_in_turn() {
    let rows = grid(|n| (n as f64 * 1.7).sin());
    let model = alone(&rows).expect("a fit");
    let middle = mean(&rows.iter().map(|r| r.1).collect::<Vec<_>>()).expect("a mean");
    let total: f64 = rows.iter().map(|r| (r.1 - middle).powi(2)).sum();
    let unseen: f64 = (0..rows.len())
        .map(|left| {
            let mut others = rows.clone();
            let (x, y) = others.remove(left);
            (y - alone(&others).expect("a fit").at(&x)).powi(2)
        })
        .sum();
    assert_near("1 − PRESS/total", 1.0 - unseen / total, model.quality().predicted, 1e-12);
}

#[test]
fn what_cannot_be_told_apart_is_not_fitted() {
    let together: Vec<_> = (0..8).map(|n| (vec![n as f64, 2.0 * n as f64], 1.0)).collect();
    assert_eq!(alone(&together), None, "law: one factor is twice the other");
    let still: Vec<_> = (0..8).map(|n| (vec![n as f64, 3.0], 1.0)).collect();
    assert_eq!(alone(&still), None, "law: a factor that does not vary");
    assert_eq!(alone(&grid(|_| 0.0)[..4]), None, "law: four values, three unknowns");
    let mut broken = grid(|_| 0.0);
    broken[3].1 = f64::NAN;
    assert_eq!(alone(&broken), None, "law: a number that is none");
    assert_eq!(alone(&[]), None, "law: nothing");
}

/// Even numbers from 0 to 1, of a generator that is written out (Steele, Lea & Flood 2014).
struct Even(u64);

impl Even {
    fn draw(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64 + 1e-17
    }

    fn normal(&mut self) -> f64 {
        Normal::standard().inverse_cdf(self.draw())
    }
}

/// Eight specimens, each with a value of `a`, shaken without and with a ramp: 10 + 3 a + 2 ramp,
/// with an error of the specimen of 2 and one of the run of 1. Those of `single` are shaken once.
fn shaken(even: &mut Even, single: usize) -> (Rows, Vec<usize>) {
    let mut rows = Vec::new();
    let mut specimens = Vec::new();
    for specimen in 0..8_usize {
        let a = (3 * specimen % 8) as f64;
        let own = 2.0 * even.normal();
        for ramp in [0.0, 1.0].into_iter().take(if specimen < single { 1 } else { 2 }) {
            rows.push((vec![a, ramp], 10.0 + 3.0 * a + 2.0 * ramp + own + even.normal()));
            specimens.push(specimen);
        }
    }
    (rows, specimens)
}

/// Slope of a straight line, its standard error, and its value where x is given.
fn line(x: &[f64], y: &[f64], at: f64) -> (f64, f64, f64) {
    let of = |v: &[f64]| v.iter().sum::<f64>() / v.len() as f64;
    let (mx, my) = (of(x), of(y));
    let sxx: f64 = x.iter().map(|x| (x - mx).powi(2)).sum();
    let slope = x.iter().zip(y).map(|(x, y)| (x - mx) * (y - my)).sum::<f64>() / sxx;
    let residual = |(x, y): (&f64, &f64)| (y - my - slope * (x - mx)).powi(2);
    let squares: f64 = x.iter().zip(y).map(residual).sum();
    (slope, (squares / (x.len() - 2) as f64 / sxx).sqrt(), my + slope * (at - mx))
}

/// `a` of each specimen, the mean of its two runs, and their difference.
fn by_specimen(rows: &[(Vec<f64>, f64)]) -> (Vec<f64>, Vec<f64>, Vec<f64>) {
    let a = rows.chunks(2).map(|two| two[0].0[0]).collect();
    let means = rows.chunks(2).map(|two| (two[0].1 + two[1].1) / 2.0).collect();
    let differences = rows.chunks(2).map(|two| two[1].1 - two[0].1).collect();
    (a, means, differences)
}

/// Law: what is varied on the same specimens is a mean of paired differences with n − 1 degrees of
/// freedom; what differs between specimens is a regression over their means with n − 2.
#[test]
fn each_factor_is_judged_in_its_own_stratum() {
    let (rows, specimens) = shaken(&mut Even(1), 0);
    let (a, means, differences) = by_specimen(&rows);
    let model = LinearModel::fit(&rows, &specimens).expect("a fit");
    let effects = model.effects();
    let t = |freedom: f64| t_quantile(0.975, freedom).expect("a quantile");
    let (slope, error, _) = line(&a, &means, 0.0);
    assert_near("slope of means over a range of 7", 7.0 * slope, effects[0].change, 1e-10);
    let half = effects[0].half_width_95;
    assert_near("t₆ times its standard error", 7.0 * t(6.0) * error, half, 1e-10);
    let by = differences.iter().sum::<f64>() / 8.0;
    let scatter: f64 = differences.iter().map(|d| (d - by).powi(2)).sum::<f64>() / 7.0;
    assert_near("mean of paired differences", by, effects[1].change, 1e-10);
    let half = effects[1].half_width_95;
    assert_near("t₇ s/√8 of differences", t(7.0) * (scatter / 8.0).sqrt(), half, 1e-10);
    let freedom: Vec<f64> = effects.iter().map(|effect| effect.freedom).collect();
    assert_near("specimens less two", 6.0, freedom[0], 1e-10);
    assert_near("specimens less one", 7.0, freedom[1], 1e-10);
    let within: Vec<bool> = effects.iter().map(|effect| effect.is_within_specimens).collect();
    assert_eq!(within, [false, true], "law: the ramp alone varies on a specimen");
    let as_if_alone = alone(&rows).expect("a fit").effects();
    assert!(
        as_if_alone[0].half_width_95 < effects[0].half_width_95
            && as_if_alone[1].half_width_95 > effects[1].half_width_95,
        "law: the test tells it from runs of 16 specimens, got {as_if_alone:?}"
    );
}

/// Law: a run of one more specimen scatters about the model by its specimen's mean, s²(1 + 1/n +
/// (a − ā)²/Sₐₐ), and by half the variance within specimens, which is half that of differences, and
/// by a quarter of the variance of the mean difference; degrees of freedom by Satterthwaite.
#[test]
fn one_more_run_scatters_by_both_strata() {
    let (rows, specimens) = shaken(&mut Even(2), 0);
    let (a, means, differences) = by_specimen(&rows);
    let model = LinearModel::fit(&rows, &specimens).expect("a fit");
    let (slope, error, middle) = line(&a, &means, 5.0);
    let sxx = 42.0; // Of 0 to 7.
    let of_means = error.powi(2) * sxx;
    let by = differences.iter().sum::<f64>() / 8.0;
    let of_differences: f64 = differences.iter().map(|d| (d - by).powi(2)).sum::<f64>() / 7.0;
    let between = of_means * (1.0 + 1.0 / 8.0 + (5.0 - 3.5_f64).powi(2) / sxx);
    let within = of_differences / 4.0 + of_differences / 8.0 / 4.0;
    let sum = between + within;
    let freedom = sum.powi(2) / (between.powi(2) / 6.0 + within.powi(2) / 7.0);
    let student = StudentsT::new(0.0, 1.0, freedom).expect("a distribution");
    let end = middle + by / 2.0 + 1.3 * sum.sqrt();
    let [got, _] = model.below(&[5.0, 1.0], [end, end + 1.0]);
    assert_near("share below 1.3 spreads", student.cdf(1.3), got, 1e-10);
    assert_near("value with a ramp", middle + by / 2.0, model.at(&[5.0, 1.0]), 1e-10);
    assert_near("and without", middle - by / 2.0, model.at(&[5.0, 0.0]), 1e-10);
    assert_near("slope", slope, model.at(&[6.0, 0.0]) - model.at(&[5.0, 0.0]), 1e-10);
    let expected = (of_means + of_differences / 4.0).sqrt();
    let got = model.quality().residual_standard_deviation;
    assert_near("spread of a run", expected, got, 1e-10);
}

/// Law: each run is predicted from the other specimens, never from its own.
#[test]
fn prediction_leaves_whole_specimens_out() {
    let (rows, specimens) = shaken(&mut Even(3), 0);
    let (a, means, differences) = by_specimen(&rows);
    let predicted = LinearModel::fit(&rows, &specimens).expect("a fit").quality().predicted;
    let middle = means.iter().sum::<f64>() / 8.0;
    let total: f64 = rows.iter().map(|(_, y)| (y - middle).powi(2)).sum();
    let others = |of: &[f64], left: usize| -> Vec<f64> {
        (0..8).filter(|n| *n != left).map(|n| of[n]).collect()
    };
    let unseen = |left: usize| {
        let (_, _, mean) = line(&others(&a, left), &others(&means, left), a[left]);
        let by = others(&differences, left).iter().sum::<f64>() / 7.0;
        let off = |run: usize, sign: f64| (rows[2 * left + run].1 - mean - sign * by / 2.0).powi(2);
        off(0, -1.0) + off(1, 1.0)
    };
    let unseen: f64 = (0..8).map(unseen).sum();
    assert_near("1 − PRESS/total", 1.0 - unseen / total, predicted, 1e-10);
    let one_left_out = alone(&rows).expect("a fit").quality().predicted;
    assert!(one_left_out > predicted, "law: its twin predicts a run better, got {one_left_out}");
}

/// Law: in 95 of 100 cases an interval holds the true change, whatever the scatter between
/// specimens, also where some were shaken once.
#[test]
fn intervals_hold_what_they_say() {
    for single in [0, 3] {
        let mut even = Even(4);
        let cases = 2000_u32;
        let mut missed = [0_u32; 2];
        for _ in 0..cases {
            let (rows, specimens) = shaken(&mut even, single);
            let effects = LinearModel::fit(&rows, &specimens).expect("a fit").effects();
            for (n, truth) in [21.0, 2.0].into_iter().enumerate() {
                let off = (effects[n].change - truth).abs();
                missed[n] += u32::from(off > effects[n].half_width_95);
            }
        }
        for missed in missed {
            // Four standard deviations of 2000 cases of 5 % are 2 %.
            let share = f64::from(missed) / f64::from(cases);
            assert_near("share of intervals that miss the truth", 0.05, share, 0.02);
        }
    }
}

/// Law: nothing is made up of too few specimens, and runs of a single one are a regression of it.
#[test]
fn too_few_specimens_have_no_model() {
    let (rows, specimens) = shaken(&mut Even(5), 0);
    assert_eq!(
        LinearModel::fit(&rows[..4], &specimens[..4]),
        None,
        "law: two specimens, two terms"
    );
    let three = LinearModel::fit(&rows[..6], &specimens[..6]).expect("law: a degree of freedom");
    assert_near("freedom of a", 1.0, three.effects()[0].freedom, 1e-10);
    let plane = grid(|n| (n as f64 * 1.7).sin());
    let of_one = LinearModel::fit(&plane, &[7; 9]).map(|model| model.effects());
    assert_eq!(of_one, alone(&plane).map(|model| model.effects()), "law: of one specimen");
}

/// Law: where a single specimen was shaken twice its difference says nothing of scatter, and all
/// factors are judged by means of specimens.
#[test]
fn one_difference_is_no_stratum() {
    let mut rows = grid(|n| (n as f64 * 1.7).sin());
    let expected = alone(&rows).expect("a fit").effects();
    let (x, y) = rows[4].clone();
    let specimens: Vec<usize> = (0..9).chain([4]).collect();
    let twin = |off: f64| (vec![x[0] + off, x[1]], y + off);
    rows[4] = twin(0.5);
    rows.push(twin(-0.5));
    let got = LinearModel::fit(&rows, &specimens).expect("a fit").effects();
    for (expected, got) in expected.into_iter().zip(got) {
        assert_near("change by means of specimens", expected.change, got.change, 1e-10);
        assert_near("its interval", expected.half_width_95, got.half_width_95, 1e-10);
    }
}
