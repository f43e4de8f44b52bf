//! Particle size distribution: from sieve data to numbers of grains.

use std::f64::consts::PI;

use super::GrainsError;
use crate::scenario::SievedGrains;
use crate::units::{from_g, from_mm};

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
        let fractions = spec
            .sieve_table
            .iter()
            .map(|f| {
                let mass = total * f.mass_percent / 100.0;
                let volume = mass / spec.density_kg_per_m3;
                let mean_size = from_mm((f.passing_mm + f.retained_mm) / 2.0);
                let grains = (volume / (PI / 6.0 * mean_size.powi(3))).round() as usize;
                if grains == 0 {
                    return Err(GrainsError::EmptyFraction {
                        passing_mm: f.passing_mm,
                        retained_mm: f.retained_mm,
                    });
                }
                Ok(Fraction {
                    passing: from_mm(f.passing_mm),
                    retained: from_mm(f.retained_mm),
                    mass,
                    volume,
                    mean_size,
                    grains,
                })
            })
            .collect::<Result<Vec<_>, _>>()?;
        Ok(Self { fractions, density: spec.density_kg_per_m3 })
    }
}
