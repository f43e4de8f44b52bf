//! The grain size distribution curve and what soil mechanics reads off it.

use serde::Serialize;

use super::{GrainSet, ParticleSizeDistribution};
use crate::units::{to_g, to_mm};

/// A grain size distribution curve with its characteristic sizes.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Gradation {
    /// Points of the curve: sieve opening in mm and percent of the mass that
    /// passes it, from fine to coarse.
    pub curve: Vec<(f64, f64)>,
    /// Size in mm that 10 % of the mass is finer than.
    pub d10_mm: f64,
    /// Size in mm that 30 % of the mass is finer than.
    pub d30_mm: f64,
    /// Size in mm that 50 % of the mass is finer than.
    pub d50_mm: f64,
    /// Size in mm that 60 % of the mass is finer than.
    pub d60_mm: f64,
    /// Coefficient of uniformity D60 / D10.
    pub coefficient_of_uniformity: f64,
    /// Coefficient of curvature D30² / (D10 · D60).
    pub coefficient_of_curvature: f64,
    /// Group symbol of the Unified Soil Classification System (ASTM D2487)
    /// for clean coarse soil: GW, GP, SW or SP.
    pub uscs: &'static str,
}

/// Openings in mm of the sieve between gravel and sand in ASTM D2487 (No. 4).
const GRAVEL_FROM_MM: f64 = 4.75;

impl Gradation {
    /// Of sieve data; every fraction lies between its two sieves.
    pub fn of(distribution: &ParticleSizeDistribution) -> Self {
        let total: f64 = distribution.fractions.iter().map(|f| f.mass).sum();
        let mut curve = Vec::new();
        let mut passing = 0.0;
        for f in distribution.fractions.iter().rev() {
            if curve.is_empty() {
                curve.push((to_mm(f.retained), 0.0));
            }
            passing += 100.0 * f.mass / total;
            curve.push((to_mm(f.passing), passing));
        }
        let d = |percent| size_at(&curve, percent);
        let (d10, d30, d50, d60) = (d(10.0), d(30.0), d(50.0), d(60.0));
        let cu = d60 / d10;
        let cc = d30 * d30 / (d10 * d60);
        let gravel = percent_at(&curve, GRAVEL_FROM_MM) < 50.0;
        // ASTM D2487, table 1: well graded gravel Cu ≥ 4, sand Cu ≥ 6, both 1 ≤ Cc ≤ 3.
        let well = cu >= if gravel { 4.0 } else { 6.0 } && (1.0..=3.0).contains(&cc);
        Self {
            d10_mm: d10,
            d30_mm: d30,
            d50_mm: d50,
            d60_mm: d60,
            coefficient_of_uniformity: cu,
            coefficient_of_curvature: cc,
            uscs: match (gravel, well) {
                (true, true) => "GW",
                (true, false) => "GP",
                (false, true) => "SW",
                (false, false) => "SP",
            },
            curve,
        }
    }
}

/// Size at a percentage passing, linear in the logarithm of the size, as the
/// curve is drawn.
fn size_at(curve: &[(f64, f64)], percent: f64) -> f64 {
    let after = curve.iter().position(|&(_, p)| p >= percent).unwrap_or(curve.len() - 1).max(1);
    let ((a, pa), (b, pb)) = (curve[after - 1], curve[after]);
    (a.ln() + (b / a).ln() * ((percent - pa) / (pb - pa)).clamp(0.0, 1.0)).exp()
}

/// Percentage passing a size, by the same rule.
fn percent_at(curve: &[(f64, f64)], size: f64) -> f64 {
    match curve.iter().position(|&(s, _)| s >= size) {
        None => 100.0,
        Some(0) => 0.0,
        Some(after) => {
            let ((a, pa), (b, pb)) = (curve[after - 1], curve[after]);
            pa + (pb - pa) * (size / a).ln() / (b / a).ln()
        }
    }
}

/// One row of `sieve.csv`: a fraction as specified and as generated.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SieveRow {
    /// Opening of the sieve it passes, in mm.
    pub passing_mm: f64,
    /// Opening of the sieve that retains it, in mm.
    pub retained_mm: f64,
    /// Mass in g as specified.
    pub mass_g: f64,
    /// Volume of solids in cm³.
    pub solids_volume_cm3: f64,
    /// Mean of the two openings in mm.
    pub mean_size_mm: f64,
    /// Side in mm of the cube it was cut from.
    pub cube_side_mm: f64,
    /// Number of grains.
    pub grains: usize,
    /// Mass in g of the grains generated.
    pub generated_mass_g: f64,
}

impl SieveRow {
    /// The rows of a distribution and the grains generated from it.
    pub fn rows(distribution: &ParticleSizeDistribution, set: &GrainSet) -> Vec<Self> {
        let row = |(index, f): (usize, &super::Fraction)| {
            let mass: f64 = set.grains.iter().filter(|g| g.fraction == index).map(|g| g.mass).sum();
            Self {
                passing_mm: to_mm(f.passing),
                retained_mm: to_mm(f.retained),
                mass_g: to_g(f.mass),
                solids_volume_cm3: f.volume * 1e6,
                mean_size_mm: to_mm(f.mean_size),
                cube_side_mm: to_mm(f.volume.cbrt()),
                grains: f.grains,
                generated_mass_g: to_g(mass),
            }
        };
        distribution.fractions.iter().enumerate().map(row).collect()
    }
}
