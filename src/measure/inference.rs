//! What a few values say of the many that were not measured: confidence
//! intervals, tests of a trend, and how many more would be needed.
//!
//! Distributions and ranks are those of the crate `statrs`.

use statrs::distribution::{ChiSquared, Continuous, ContinuousCDF, Normal};
use statrs::statistics::{Data, OrderStatistics, RankTieBreaker};

pub use super::students_t::{t_quantile, two_sided_p};
use super::*;

/// Mean of a sample, and how well it is known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeanTest {
    /// Mean of the values, its standard error, and their number.
    pub estimate: Estimate,
    /// Standard deviation of the values, with n − 1 in the denominator.
    pub standard_deviation: f64,
    /// Half the width of the confidence interval of the mean: t · s/√n.
    pub half_width: f64,
    /// Student's t of the hypothesis that the true mean is 0; infinite where
    /// all values are the same and not 0, 0 where all are 0.
    pub t: f64,
    /// Degrees of freedom, n − 1.
    pub freedom: f64,
    /// Two-sided p-value of that hypothesis.
    pub p: f64,
}

impl MeanTest {
    /// Student's one-sample t-test and interval (Student 1908; any textbook,
    /// as Snedecor & Cochran, *Statistical Methods*, chapter 5), for a
    /// confidence such as 0.95. `None` of fewer than two values, or where one
    /// is not finite.
    ///
    /// ```
    /// use pluvia::measure::inference::MeanTest;
    ///
    /// // Final settlements of three configurations, in mm.
    /// let settlement = MeanTest::of(&[15.9, 15.1, 15.0], 0.95).expect("three values");
    /// assert!((settlement.estimate.mean - 15.33).abs() < 0.01);
    /// assert!((settlement.half_width - 1.23).abs() < 0.01);
    /// ```
    pub fn of(values: &[f64], confidence: f64) -> Option<Self> {
        if values.iter().any(|v| !v.is_finite()) {
            return None;
        }
        let (estimate, deviation) = (Estimate::of(values)?, sample_standard_deviation(values)?);
        let (mean, error) = (estimate.mean, estimate.standard_error?);
        let freedom = (estimate.count - 1) as f64;
        let t = if mean == 0.0 { 0.0 } else { mean / error };
        let p = two_sided_p(t, freedom)?;
        Some(Self {
            estimate,
            standard_deviation: deviation,
            half_width: estimate.half_width(confidence)?,
            t,
            freedom,
            p,
        })
    }
}

/// 95 % interval of a share of cases, of which `independent` are (Wilson 1927, "Probable
/// inference, the law of succession, and statistical inference"); 0 to 1 of no cases.
pub fn wilson_interval(share: f64, independent: usize) -> [f64; 2] {
    // The normal distribution's quantile at 97.5 %.
    const Z: f64 = 1.959_963_984_540_054;
    if independent == 0 {
        return [0.0, 1.0];
    }
    let n = independent as f64;
    let middle = share + Z * Z / (2.0 * n);
    let half = Z * (share * (1.0 - share) / n + Z * Z / (4.0 * n * n)).sqrt();
    let whole = 1.0 + Z * Z / n;
    [((middle - half) / whole).max(0.0), ((middle + half) / whole).min(1.0)]
}

/// Outcome of Page's test.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PageTest {
    /// Page's L: the sum over columns of the column's number, from 1, times its sum of ranks.
    pub l: f64,
    /// Probability of an L as large, or larger, where there is no trend: exact, one-sided.
    pub p: f64,
}

/// Columns for which every permutation is looked at: 8! = 40 320.
const MOST_COLUMNS: usize = 8;

/// Page's trend test (E. B. Page 1963, *Journal of the American Statistical Association* 58,
/// 216–230): whether values rise from column to column, by their ranks within each row. Ties share
/// their mean rank. The p-value is exact for rows without ties, from the distribution of L over all
/// orders of each row; with ties it is a little too large.
///
/// `None` of fewer than two rows, fewer than three columns or more than eight,
/// rows of unequal length, or a value that is not finite.
pub fn page_test(rows: &[Vec<f64>]) -> Option<PageTest> {
    let columns = rows.first()?.len();
    let sound = rows.len() >= 2
        && (3..=MOST_COLUMNS).contains(&columns)
        && rows.iter().all(|r| r.len() == columns && r.iter().all(|v| v.is_finite()));
    if !sound {
        return None;
    }
    let ranks = |row: &Vec<f64>| Data::new(row.clone()).ranks(RankTieBreaker::Average);
    let l: f64 = rows
        .iter()
        .flat_map(|row| ranks(row).into_iter().enumerate().map(|(i, r)| (i + 1) as f64 * r))
        .sum();
    let all = l_of_rows(columns, rows.len());
    // With ties L may lie half way between two values; the lower one is the safe side.
    let p = all.iter().enumerate().filter(|(i, _)| *i as f64 >= f64::floor(l)).map(|(_, p)| p);
    Some(PageTest { l, p: p.sum() })
}

/// Probability of each L of a number of independent rows: those of one row convolved.
fn l_of_rows(columns: usize, rows: usize) -> Vec<f64> {
    let one = l_of_one_row(columns);
    let mut all = vec![1.0];
    for _ in 0..rows {
        let mut next = vec![0.0; all.len() + one.len() - 1];
        for (i, a) in all.iter().enumerate() {
            for (j, b) in one.iter().enumerate() {
                next[i + j] += a * b;
            }
        }
        all = next;
    }
    all
}

/// Probability of each L of one row, over all orders of its ranks.
fn l_of_one_row(columns: usize) -> Vec<f64> {
    let largest: usize = (1..=columns).map(|i| i * i).sum();
    let mut counts = vec![0.0; largest + 1];
    let mut order: Vec<usize> = (1..=columns).collect();
    permutations(&mut order, 0, &mut |ranks| {
        counts[ranks.iter().enumerate().map(|(i, r)| (i + 1) * r).sum::<usize>()] += 1.0;
    });
    let all: f64 = counts.iter().sum();
    counts.iter_mut().for_each(|c| *c /= all);
    counts
}

fn permutations(order: &mut [usize], from: usize, visit: &mut impl FnMut(&[usize])) {
    if from == order.len() {
        visit(order);
        return;
    }
    for i in from..order.len() {
        order.swap(from, i);
        permutations(order, from + 1, visit);
        order.swap(from, i);
    }
}

/// Probability that a two-sided one-sample t-test of `count` values finds a
/// mean that is `effect` standard deviations from 0, at the level 1 − confidence.
///
/// The power of the t-test (Cohen 1988, *Statistical Power Analysis for the Behavioral Sciences*,
/// chapter 2): the mass of the noncentral t distribution beyond the quantile, integrated over the
/// distribution of the sample's standard deviation. `None` of fewer than two values.
pub fn t_test_power(effect: f64, count: usize, confidence: f64) -> Option<f64> {
    if count < 2 || !effect.is_finite() {
        return None;
    }
    let freedom = (count - 1) as f64;
    let critical = t_quantile(0.5 + confidence / 2.0, freedom)?;
    let shift = effect.abs() * (count as f64).sqrt();
    let (normal, chi) = (Normal::standard(), ChiSquared::new(freedom).ok()?);
    // s = standard deviation of the sample over the true one; freedom · s² is
    // chi-squared. Beyond 8 standard errors of s nothing is left.
    let most = 1.0 + 8.0 / freedom.sqrt();
    const PIECES: usize = 2000;
    let width = most / PIECES as f64;
    let density = |s: f64| {
        let beyond = normal.cdf(shift - critical * s) + normal.cdf(-shift - critical * s);
        // By its logarithm: from 230 values on a density from powers of x overflows.
        beyond * chi.ln_pdf(freedom * s * s).exp() * 2.0 * freedom * s
    };
    // Midpoints: at s = 0 the density of one degree of freedom has no value.
    let power: f64 = (0..PIECES).map(|i| density((i as f64 + 0.5) * width) * width).sum();
    Some(power.clamp(0.0, 1.0))
}

/// Most values that are asked for.
const MOST_VALUES: usize = 100_000;

/// Least number of values with which a two-sided one-sample t-test finds a mean `effect` standard
/// deviations from 0 with a probability of `power`; `None` where even 100 000 are too few.
pub fn values_needed(effect: f64, confidence: f64, power: f64) -> Option<usize> {
    let enough = |n: usize| t_test_power(effect, n, confidence).is_some_and(|p| p >= power);
    if !enough(MOST_VALUES) {
        return None;
    }
    // Power grows with the number: halve the range.
    let (mut low, mut high) = (1, MOST_VALUES);
    while high - low > 1 {
        let middle = usize::midpoint(low, high);
        if enough(middle) { high = middle } else { low = middle }
    }
    Some(high)
}

#[cfg(test)]
mod tests {
    use super::super::testing::assert_near;
    use super::*;

    /// Law: the ends p of Wilson's interval are where |p̂ − p| = z √(p (1 − p)/n).
    #[test]
    fn wilsons_interval_ends_where_the_share_is_just_believed() {
        for (met, count) in [(0, 8), (3, 8), (8, 8), (40, 200)] {
            let (share, n) = (met as f64 / count as f64, count as f64);
            for end in wilson_interval(share, count) {
                let expected = 1.959_963_984_540_054 * (end * (1.0 - end) / n).sqrt();
                assert_near(
                    "distance of the end from the share",
                    expected,
                    (share - end).abs(),
                    1e-12,
                );
            }
        }
        assert_eq!(wilson_interval(f64::NAN, 0), [0.0, 1.0], "law: nothing is known of no cases");
    }

    /// Student's own example (1908), also R's `sleep`: differences of hours slept,
    /// mean 1.58, s 1.229995, t = 4.0621 with 9 degrees of freedom, p = 0.002833,
    /// 95 % from 0.7001142 to 2.4598858.
    #[test]
    fn the_t_test_is_students() {
        let hours = [1.2, 2.4, 1.3, 1.3, 0.0, 1.0, 1.8, 0.8, 4.6, 1.4];
        let got = MeanTest::of(&hours, 0.95).expect("a test");
        for (what, expected, got, tolerance) in [
            ("mean", 1.58, got.estimate.mean, 1e-12),
            ("standard deviation", 1.229_995, got.standard_deviation, 1e-6),
            ("t", 4.0621, got.t, 5e-5),
            ("p", 0.002_833, got.p, 5e-7),
            ("lower end", 0.700_114_2, got.estimate.mean - got.half_width, 1e-6),
        ] {
            assert_near(what, expected, got, tolerance);
        }
        let half = got.estimate.half_width_95().expect("ten values");
        assert_eq!(got.half_width.to_bits(), half.to_bits(), "law: the interval is its estimate's");
        let other = hours.map(|h| -h);
        let got = MeanTest::of(&other, 0.95).expect("a test");
        assert_near("t of the other sign", -4.0621, got.t, 5e-5);
        assert_near("its p", 0.002_833, got.p, 5e-7);
        assert_eq!(MeanTest::of(&[1.0], 0.95), None, "one value has no interval");
        assert_eq!(MeanTest::of(&[1.0, f64::NAN], 0.95), None);
        let even = MeanTest::of(&[-1.0, 1.0], 0.95).expect("a test");
        assert_near("p of a mean of 0", 1.0, even.p, 1e-12);
        let same = MeanTest::of(&[2.0, 2.0, 2.0], 0.95).expect("a test");
        assert_eq!((same.half_width, same.p), (0.0, 0.0), "no scatter, no doubt");
    }

    /// Least L that is significant at 5, 1 and 0.1 % (Page 1963, table 2).
    #[test]
    fn critical_values_of_l_are_pages() {
        for (columns, rows, level, critical) in [
            (3, 2, 0.05, 28),
            (3, 3, 0.05, 41),
            (3, 3, 0.01, 42),
            (3, 4, 0.001, 56),
            (4, 2, 0.05, 58),
            (4, 2, 0.01, 60),
            (4, 3, 0.05, 84),
            (4, 3, 0.01, 87),
            (4, 3, 0.001, 89),
            (4, 4, 0.05, 111),
            (4, 6, 0.001, 172),
            (5, 2, 0.05, 103),
            (5, 3, 0.01, 155),
        ] {
            let all = l_of_rows(columns, rows);
            let tail = |l: usize| all[l..].iter().sum::<f64>();
            let (at, below) = (tail(critical), tail(critical - 1));
            assert!(
                at <= level && below > level,
                "law: {critical} is the least L significant at {level} for {columns} columns and \
                 {rows} rows; got p {at} there and {below} below"
            );
        }
    }

    #[test]
    fn page_finds_a_trend_in_its_direction_only() {
        let rising = vec![vec![1.0, 2.0, 3.0, 4.0]; 3];
        let got = page_test(&rising).expect("a test");
        // 3 · (1 + 4 + 9 + 16); one order in 24, three times.
        assert_near("L of three rising rows", 90.0, got.l, 1e-12);
        assert_near("p of three rising rows", 24.0_f64.powi(-3), got.p, 1e-12);
        let falling: Vec<Vec<f64>> =
            rising.iter().map(|r| r.iter().rev().copied().collect()).collect();
        let got = page_test(&falling).expect("a test");
        assert_near("p of three falling rows", 1.0, got.p, 1e-12);
        // The example in SciPy's documentation of page_trend_test: L 133.5, p 0.00181912.
        let rated = [
            [3.0, 4.0, 3.0],
            [2.0, 2.0, 4.0],
            [3.0, 3.0, 5.0],
            [1.0, 3.0, 2.0],
            [2.0, 3.0, 2.0],
            [2.0, 4.0, 5.0],
            [1.0, 2.0, 4.0],
            [3.0, 4.0, 4.0],
            [2.0, 4.0, 5.0],
            [1.0, 3.0, 4.0],
        ];
        let rows: Vec<Vec<f64>> = rated.iter().map(|r| r.to_vec()).collect();
        let got = page_test(&rows).expect("a test");
        assert_near("L with ties", 133.5, got.l, 1e-12);
        assert_near("p with ties", 0.001_819_116, got.p, 1e-8);
        assert_eq!(page_test(&rows[..1]), None, "one row is too few");
        assert_eq!(page_test(&[vec![1.0, 2.0], vec![1.0, 2.0]]), None, "two columns too");
        assert_eq!(page_test(&[vec![1.0, 2.0, 3.0], vec![1.0, 2.0]]), None, "unequal rows");
    }

    /// Sample sizes of the one-sample t-test at 5 %, two-sided, power 80 %, as
    /// G*Power and R's `power.t.test(type = "one.sample")` give them.
    #[test]
    fn sample_sizes_are_those_of_the_tables() {
        for (effect, expected) in [(0.2, 199), (0.5, 34), (0.8, 15), (1.0, 10), (-0.5, 34)] {
            let got = values_needed(effect, 0.95, 0.8).expect("a number");
            assert_eq!(got, expected, "law: an effect of {effect} asks for {expected} values");
            let power = t_test_power(effect, got, 0.95).expect("a power");
            let less = t_test_power(effect, got - 1, 0.95).expect("a power");
            assert!(
                power >= 0.8 && less < 0.8,
                "{effect}: {power} with {got}, {less} with one less"
            );
        }
        // As scipy.stats.nct 1.17.1 gives them: P(T > t) of a noncentral T with n - 1 degrees of
        // freedom and effect·√n.
        for (effect, expected) in [(0.185, 232), (0.165, 291), (0.15, 351), (0.1425, 389)] {
            let got = values_needed(effect, 0.95, 0.8).expect("a number");
            assert_eq!(got, expected, "law: an effect of {effect} asks for {expected} values");
        }
        let got = t_test_power(0.165, 290, 0.95).expect("a power");
        assert_near("power of 290 values at 0.165", 0.799_696, got, 1e-5);
        assert_eq!(values_needed(0.0, 0.95, 0.8), None, "no effect is ever found");
        // power.t.test(n = 20, delta = 0.5, type = "one.sample"): 0.5645044.
        let got = t_test_power(0.5, 20, 0.95).expect("a power");
        assert_near("power of 20 values at 0.5", 0.564_504, got, 1e-4);
        // Without an effect a test at 5 % finds one in twenty.
        for count in [2, 3, 10] {
            let got = t_test_power(0.0, count, 0.95).expect("a power");
            assert_near(&format!("power of {count} without effect"), 0.05, got, 1e-3);
        }
        assert_eq!(t_test_power(1.0, 1, 0.95), None);
    }
}
