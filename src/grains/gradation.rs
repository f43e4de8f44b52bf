//! What soil mechanics reads off a grain size distribution curve.

/// Percentages of the mass that differ by less are the same: sums of shares differ in last digits.
pub(super) const SAME_PERCENT: f64 = 1e-9;

/// Opening of the 3-inch sieve in m, which parts cobbles from gravel (ASTM D2487).
const THREE_INCH_SIEVE: f64 = 75e-3;

/// Opening of the No. 4 sieve in m, which parts gravel from sand (ASTM D2487).
const NO_4_SIEVE: f64 = 4.75e-3;

/// Opening of the No. 200 sieve in m, which parts sand from fines (ASTM D2487).
const NO_200_SIEVE: f64 = 0.075e-3;

/// Coefficients that differ by less, as a fraction of them, are the same: 0.6 mm over 0.1 mm is
/// 5.999999999999999.
const SAME_RATIO: f64 = 1e-12;

/// Characteristic sizes, coefficients and class of a grain size distribution.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gradation {
    /// Size in m than which 10 % of the mass is finer.
    pub d10: f64,
    /// Size in m than which 30 % of the mass is finer.
    pub d30: f64,
    /// Size in m than which 50 % of the mass is finer.
    pub d50: f64,
    /// Size in m than which 60 % of the mass is finer.
    pub d60: f64,
    /// Coefficient of uniformity Cu, D₆₀ / D₁₀.
    pub uniformity: f64,
    /// Coefficient of curvature (gradation) Cc, D₃₀² / (D₆₀·D₁₀).
    pub curvature: f64,
    /// Group symbol in the Unified Soil Classification System, such as `GP`; in words where the
    /// curve alone does not tell it.
    pub uscs: &'static str,
}

impl Gradation {
    /// Reads a curve, given both ways round: the size in m than which a
    /// percentage of the mass is finer, and the percentage finer than a size in m.
    pub fn of(size_at_percent: impl Fn(f64) -> f64, percent_finer: impl Fn(f64) -> f64) -> Self {
        let [d10, d30, d50, d60] = [10.0, 30.0, 50.0, 60.0].map(&size_at_percent);
        let [uniformity, curvature] = coefficients(d10, d30, d60);
        let uscs = class(size_at_percent, percent_finer);
        Self { d10, d30, d50, d60, uniformity, curvature, uscs }
    }
}

/// Cu and Cc.
fn coefficients(d10: f64, d30: f64, d60: f64) -> [f64; 2] {
    [d60 / d10, d30 * d30 / (d60 * d10)]
}

/// Class of what passes the 75 mm sieve, as ASTM D2487 classifies; coarser grains are cobbles.
fn class(size_at_percent: impl Fn(f64) -> f64, percent_finer: impl Fn(f64) -> f64) -> &'static str {
    let soil = percent_finer(THREE_INCH_SIEVE);
    if soil < SAME_PERCENT {
        return "cobbles";
    }
    // 1 where there are no cobbles, so that all numbers stay as they are.
    let share = if soil > 100.0 - SAME_PERCENT { 1.0 } else { soil / 100.0 };
    let [d10, d30, d60] = [10.0, 30.0, 60.0].map(|percent| size_at_percent(percent * share));
    let [uniformity, curvature] = coefficients(d10, d30, d60);
    let [fines, gravel] =
        [percent_finer(NO_200_SIEVE) / share, 100.0 - percent_finer(NO_4_SIEVE) / share];
    uscs(fines, gravel, uniformity, curvature)
}

/// Group symbol of a coarse soil by ASTM D2487, table 1: gravel if more than half of the coarse
/// fraction stays on the 4.75 mm sieve, else sand; well graded if 1 ≤ Cc ≤ 3 and Cu ≥ 4 (gravel) or
/// Cu ≥ 6 (sand), else poorly graded. No symbol where 5 % or more are fines (below 0.075 mm): the
/// class then depends on their plasticity. Shares are in percent of the mass. What misses a bound
/// by rounding is on it.
fn uscs(fines: f64, gravel: f64, uniformity: f64, curvature: f64) -> &'static str {
    if !(fines < 5.0 - SAME_PERCENT) {
        return "not coarse";
    }
    let is_gravel = gravel > (100.0 - fines) / 2.0 + SAME_PERCENT;
    let least_uniformity = if is_gravel { 4.0 } else { 6.0 };
    let well_graded = uniformity >= least_uniformity * (1.0 - SAME_RATIO)
        && (1.0 - SAME_RATIO..=3.0 * (1.0 + SAME_RATIO)).contains(&curvature);
    match (is_gravel, well_graded) {
        (true, true) => "GW",
        (true, false) => "GP",
        (false, true) => "SW",
        (false, false) => "SP",
    }
}
