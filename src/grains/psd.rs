//! Particle size distribution: from sieve data to numbers of grains.

use std::f64::consts::PI;

use super::GrainsError;
use crate::scenario::SievedGrains;
use crate::units::{from_g, from_mm, to_mm};

/// One sieve fraction in SI units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fraction {
    /// Opening of the sieve it passes, in m.
    pub passing: f64,
    /// Opening of the sieve that retains it, in m.
    pub retained: f64,
    /// Mass in kg.
    pub mass: f64,
    /// Volume of its solids in m³.
    pub volume: f64,
    /// Mean of the two openings in m: the average size of its grains (paper, section 3).
    pub mean_size: f64,
    /// Number of grains: its volume over that of a sphere of the mean size.
    pub grains: usize,
}

/// Sieve fractions, coarsest first.
#[derive(Debug, Clone, PartialEq)]
pub struct ParticleSizeDistribution {
    /// The fractions.
    pub fractions: Vec<Fraction>,
    /// Density of the solids in kg/m³.
    pub density: f64,
}

impl ParticleSizeDistribution {
    /// From sieve data.
    ///
    /// # Errors
    /// [`GrainsError::EmptyFraction`] for a fraction whose mass makes less than half a grain.
    pub fn new(spec: &SievedGrains) -> Result<Self, GrainsError> {
        let total = from_g(spec.total_mass_g);
        let mut fractions: Vec<Fraction> = spec
            .sieve_table
            .iter()
            .map(|f| {
                let mass = total * f.mass_percent / 100.0;
                Fraction {
                    passing: from_mm(f.passing_mm),
                    retained: from_mm(f.retained_mm),
                    mass,
                    volume: mass / spec.density_kg_per_m3,
                    mean_size: from_mm((f.passing_mm + f.retained_mm) / 2.0),
                    grains: 0,
                }
            })
            .collect();
        apportion(&mut fractions);
        if let Some(f) = fractions.iter().find(|f| f.grains == 0) {
            return Err(GrainsError::EmptyFraction {
                passing_mm: to_mm(f.passing),
                retained_mm: to_mm(f.retained),
            });
        }
        Ok(Self { fractions, density: spec.density_kg_per_m3 })
    }
}

/// Numbers of grains by the method of largest remainders: the whole specimen
/// gets the rounded total, each fraction its whole part, and the fractions
/// with the largest remainders one grain more. Rounding each fraction by
/// itself would let the total drift by half a grain a fraction.
fn apportion(fractions: &mut [Fraction]) {
    let exact: Vec<f64> =
        fractions.iter().map(|f| f.volume / (PI / 6.0 * f.mean_size.powi(3))).collect();
    let total = exact.iter().sum::<f64>().round() as usize;
    for (f, exact) in fractions.iter_mut().zip(&exact) {
        f.grains = exact.floor() as usize;
    }
    let mut order: Vec<usize> = (0..fractions.len()).collect();
    order.sort_by(|&a, &b| exact[b].fract().total_cmp(&exact[a].fract()));
    let given: usize = fractions.iter().map(|f| f.grains).sum();
    for &index in order.iter().take(total.saturating_sub(given)) {
        fractions[index].grains += 1;
    }
}
