//! Where a line through scattered results reaches a wanted value, and how well
//! that place is known: inverse prediction.
//!
//! Results come in blocks: one and the same specimen (a configuration) at each of several values of
//! x. What a specimen has of its own is in all of its results, so that results are not independent,
//! and lines are fitted block by block.

use super::*;

/// A straight line through blocks of results, and where it reaches a wanted value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InversePrediction {
    /// x at which the mean over blocks has the wanted value.
    pub x: f64,
    /// Confidence interval of `x`; `None` where it has no ends, because the
    /// slope cannot be told from zero.
    pub interval: Option<(f64, f64)>,
    /// Mean abscissa of the fit.
    pub centre: f64,
    /// Mean over blocks of the lines' heights at `centre`.
    pub level: f64,
    /// Mean over blocks of the lines' slopes.
    pub slope: f64,
    /// Half the confidence interval of the slope.
    pub slope_half_width: f64,
    /// Two-sided p-value of the hypothesis that the mean slope is 0.
    pub slope_p: f64,
    /// Half the confidence interval of the mean over blocks at `x`.
    pub half_width_there: f64,
    /// Two-sided p-value of the hypothesis that there is no curvature: that the
    /// mean over blocks of the quadratic term is 0. `None` of two abscissae.
    pub curvature_p: Option<f64>,
    /// Number of blocks.
    pub blocks: usize,
}

/// Fits a line to each block and finds where their mean reaches `wanted`.
///
/// `blocks` holds one result an abscissa of `xs` each. Their lines are taken for a sample of
/// independent, normally distributed pairs (height at the mean abscissa, slope), so that for every
/// x the lines' heights there less the wanted value are an ordinary sample, whose mean Student's
/// t-test holds against 0. The values of x at which it is not refused are the interval: the theorem
/// of E. C. Fieller (1954, *Journal of the Royal Statistical Society* B 16, 175–185) for the
/// quotient of two means that go in pairs.
///
/// `None` of fewer than two blocks or two distinct abscissae, of blocks of
/// another length than `xs`, of what is not finite, or of a slope of exactly 0.
pub fn inverse_prediction(
    xs: &[f64],
    blocks: &[Vec<f64>],
    wanted: f64,
    confidence: f64,
) -> Option<InversePrediction> {
    let finite = |values: &[f64]| values.iter().all(|v| v.is_finite());
    let sound = finite(xs)
        && wanted.is_finite()
        && blocks.len() >= 2
        && blocks.iter().all(|b| b.len() == xs.len() && finite(b));
    if !sound {
        return None;
    }
    let centre = mean(xs)?;
    let offsets: Vec<f64> = xs.iter().map(|x| x - centre).collect();
    let heights: Vec<f64> = blocks.iter().filter_map(|b| mean(b)).collect();
    let slopes: Vec<f64> = blocks.iter().map(|b| along(&offsets, b)).collect::<Option<_>>()?;
    let (level, slope) = (mean(&heights)?, mean(&slopes)?);
    if slope == 0.0 {
        return None;
    }
    let count = blocks.len() as f64;
    let t = t_quantile(0.5 + confidence / 2.0, count - 1.0)?;
    let above: Vec<f64> = heights.iter().map(|h| h - wanted).collect();
    // |mean(a) + θ mean(b)|² ≤ t²/n · var(a + θ b), a quadratic in θ = x − centre.
    let share = t * t / count;
    let a = slope * slope - share * covariance(&slopes, &slopes);
    let b = (level - wanted) * slope - share * covariance(&above, &slopes);
    let c = (level - wanted).powi(2) - share * covariance(&above, &above);
    let root = (b * b - a * c).max(0.0).sqrt();
    let interval = (a > 0.0).then(|| (centre + (-b - root) / a, centre + (-b + root) / a));
    let x = centre + (wanted - level) / slope;
    let there: Vec<f64> = heights.iter().zip(&slopes).map(|(h, s)| h + (x - centre) * s).collect();
    let of_slopes = MeanTest::of(&slopes, confidence)?;
    Some(InversePrediction {
        x,
        interval,
        centre,
        level,
        slope,
        slope_half_width: of_slopes.half_width,
        slope_p: of_slopes.p,
        half_width_there: MeanTest::of(&there, confidence)?.half_width,
        curvature_p: curvature_p(xs, blocks, confidence),
        blocks: blocks.len(),
    })
}

/// Coefficient of `y` along a pattern: Σ p·y / Σ p².
fn along(pattern: &[f64], y: &[f64]) -> Option<f64> {
    let square: f64 = pattern.iter().map(|p| p * p).sum();
    let product: f64 = pattern.iter().zip(y).map(|(p, y)| p * y).sum();
    (square > 0.0).then(|| product / square)
}

/// Sample covariance, with n − 1 in the denominator.
fn covariance(a: &[f64], b: &[f64]) -> f64 {
    let n = a.len() as f64;
    let (ma, mb) = (a.iter().sum::<f64>() / n, b.iter().sum::<f64>() / n);
    a.iter().zip(b).map(|(a, b)| (a - ma) * (b - mb)).sum::<f64>() / (n - 1.0)
}

/// The t-test of the blocks' quadratic terms.
fn curvature_p(xs: &[f64], blocks: &[Vec<f64>], confidence: f64) -> Option<f64> {
    let bend = bend_pattern(xs)?;
    let terms: Vec<f64> = blocks.iter().map(|y| along(&bend, y)).collect::<Option<_>>()?;
    MeanTest::of(&terms, confidence).map(|test| test.p)
}

/// What x² has beyond a straight line at some abscissae, by least squares. Of
/// results y the quotient Σ p·y / Σ p² is the quadratic term of their parabola.
/// `None` where two distinct abscissae leave nothing.
pub fn bend_pattern(xs: &[f64]) -> Option<Vec<f64>> {
    let centre = mean(xs)?;
    let offsets: Vec<f64> = xs.iter().map(|x| x - centre).collect();
    let squares: Vec<f64> = offsets.iter().map(|x| x * x).collect();
    let (offset, tilt) = (mean(&squares)?, along(&offsets, &squares)?);
    let bend: Vec<f64> = squares.iter().zip(&offsets).map(|(s, x)| s - offset - tilt * x).collect();
    let width = squares.iter().copied().fold(0.0, f64::max);
    bend.iter().any(|b| b.abs() > 1e-9 * width).then_some(bend)
}

#[cfg(test)]
mod tests {
    use super::super::testing::assert_near;
    use super::*;

    /// Two abscissae 1 apart on either side of 0, and blocks made of heights and slopes.
    fn blocks(lines: &[(f64, f64)], xs: &[f64]) -> Vec<Vec<f64>> {
        lines.iter().map(|(h, s)| xs.iter().map(|x| h + s * x).collect()).collect()
    }

    #[test]
    fn lines_without_scatter_are_met_exactly() {
        let xs = [-1.0, 0.0, 2.0];
        let got =
            inverse_prediction(&xs, &blocks(&[(10.0, 4.0); 3], &xs), 12.0, 0.95).expect("a line");
        assert_near("x where 10 + 4 x is 12", 0.5, got.x, 1e-12);
        let (low, high) = got.interval.expect("it has ends");
        assert_near("lower end without scatter", 0.5, low, 1e-6);
        assert_near("upper end without scatter", 0.5, high, 1e-6);
        assert_near("slope", 4.0, got.slope, 1e-12);
    }

    /// Law: at either end of the interval the t-test of the lines' heights
    /// there has p = 1 − confidence, and inside it is larger.
    #[test]
    fn ends_are_where_the_t_test_turns() {
        let xs = [0.0, 1.0, 2.0, 3.0];
        let lines = [(10.0, 4.0), (10.8, 3.6), (9.5, 4.5), (10.1, 4.2)];
        for confidence in [0.8, 0.95] {
            let got =
                inverse_prediction(&xs, &blocks(&lines, &xs), 15.0, confidence).expect("a line");
            let (low, high) = got.interval.expect("it has ends");
            let p_at = |x: f64| {
                let there: Vec<f64> = lines.iter().map(|(h, s)| h + s * x - 15.0).collect();
                MeanTest::of(&there, 0.95).expect("a test").p
            };
            for (end, x) in [("lower", low), ("upper", high)] {
                assert_near(&format!("p at the {end} end"), 1.0 - confidence, p_at(x), 1e-9);
            }
            assert!(low < got.x && got.x < high && p_at(got.x) > 0.999, "{got:?}");
            assert!(p_at(low - 0.1) < 1.0 - confidence && p_at(high + 0.1) < 1.0 - confidence);
        }
    }

    /// Law: what a block has of its own widens the level's interval, and
    /// leaves that of the slope alone.
    #[test]
    fn blocks_are_told_from_noise() {
        let xs = [0.0, 1.0];
        let apart = [(0.0, 1.0), (2.0, 1.1), (4.0, 0.9), (6.0, 1.0)];
        let got = inverse_prediction(&xs, &blocks(&apart, &xs), 3.5, 0.95).expect("a line");
        assert!(got.slope_half_width < 0.2 && got.slope_p < 1e-3, "{got:?}");
        let (low, high) = got.interval.expect("the slope is sure");
        // t 3.182 · s/√4, s of 0, 2, 4, 6 = 2.582, over a slope of 1: ± 4.1.
        assert!(high - low > 7.0, "law: heights scatter by 2.58: {got:?}");
    }

    #[test]
    fn a_slope_inside_its_scatter_has_no_interval() {
        let xs = [0.0, 1.0];
        let got = inverse_prediction(
            &xs,
            &blocks(&[(0.0, 1.0), (0.1, -1.2), (0.2, 0.9)], &xs),
            0.3,
            0.95,
        )
        .expect("a line");
        assert_eq!(got.interval, None, "law: 1, −1.2 and 0.9 may be 0: {got:?}");
        assert!(got.slope_p > 0.5);
    }

    #[test]
    fn bends_are_found_and_lines_have_none() {
        let xs = [0.0, 1.0, 3.0];
        let bent = |bend: f64| -> Vec<Vec<f64>> {
            [0.1, -0.1, 0.05]
                .iter()
                .map(|e| xs.iter().map(|x| 5.0 + 2.0 * x + (bend + e) * x * x).collect())
                .collect()
        };
        let p = |bend| {
            let got = inverse_prediction(&xs, &bent(bend), 7.0, 0.95).expect("a line");
            got.curvature_p.expect("three abscissae")
        };
        assert!(p(3.0) < 0.01, "a bend of 3 ± 0.1 is found: p {}", p(3.0));
        assert!(p(0.0) > 0.3, "one of 0 ± 0.1 is not: p {}", p(0.0));
        let two = blocks(&[(0.0, 1.0), (0.1, 1.1)], &[0.0, 1.0]);
        let got = inverse_prediction(&[0.0, 1.0], &two, 0.5, 0.95).expect("a line");
        assert_eq!(got.curvature_p, None, "two abscissae show no bend");
    }

    #[test]
    fn what_cannot_be_fitted_is_none() {
        let fit = |xs: &[f64], blocks: &[Vec<f64>]| inverse_prediction(xs, blocks, 1.0, 0.95);
        let line = vec![0.0, 1.0];
        assert_eq!(fit(&[0.0, 1.0], std::slice::from_ref(&line)), None, "one block");
        assert_eq!(fit(&[1.0, 1.0], &[line.clone(), line.clone()]), None, "one abscissa");
        assert_eq!(fit(&[0.0], &[line.clone(), line.clone()]), None, "another length");
        assert_eq!(fit(&[0.0, 1.0], &[line, vec![0.0, f64::NAN]]), None, "no number");
        assert_eq!(fit(&[0.0, 1.0], &[vec![1.0, 1.0], vec![2.0, 2.0]]), None, "flat");
    }
}
