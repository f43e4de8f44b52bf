//! What is known of the grains of a scenario: automatic values follow from it.

use std::ops::RangeInclusive;

use super::*;
use crate::scale::{GrainSizes, SieveMass};

/// What of the grains the values follow from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Grading {
    /// Sizes by sieves.
    pub sizes: GrainSizes,
    /// Density of the solids in kg/m³.
    pub density: f64,
    /// Volume of the solids in m³.
    pub solids: f64,
    /// How many grains there are, or will be made.
    pub count: f64,
}

/// Densities of solids in kg/m³ that grains by a sieve table may have: nothing follows from others.
pub(super) const DENSITIES: RangeInclusive<f64> = 10.0..=30_000.0;

/// Weaker gravity, in m/s², counts as this where values are filled in.
const WEAKEST: f64 = 0.01;

impl Grading {
    /// Of grains by a sieve table; `None` where the table has no sizes, or the mass or the density is
    /// none that grains have.
    pub fn of_table(sieved: &SievedGrains) -> Option<Self> {
        let solids = from_g(sieved.total_mass_g) / sieved.density_kg_per_m3;
        let is_density = DENSITIES.contains(&sieved.density_kg_per_m3);
        let sound = is_density && solids > 0.0 && solids.is_finite();
        let sizes = sizes_of(&sieved.sieve_table).filter(|_| sound)?;
        let density = sieved.density_kg_per_m3;
        let mass = sieved.total_mass_g * SieveFraction::factor_to_hundred(&sieved.sieve_table);
        let count = sieved.sieve_table.iter().map(|f| f.grain_count(mass, density)).sum();
        Some(Self { sizes, density, solids, count })
    }

    /// Of the `grains` of a scenario's JSON that has a sieve table.
    pub(super) fn of_json(grains: &Value) -> Option<Self> {
        Self::of_table(&sieved(grains)?)
    }

    /// The scale that automatic values follow from, under a gravity in m/s².
    pub(super) fn scale_for_filling(&self, gravity: f64) -> Scale {
        Scale { sizes: self.sizes, density: self.density, gravity: gravity.max(WEAKEST) }
    }
}

/// Sizes by a sieve table; `None` where it has none.
pub(super) fn sizes_of(table: &[SieveFraction]) -> Option<GrainSizes> {
    let fractions = table.iter().map(|f| SieveMass {
        passing: from_mm(f.passing_mm),
        retained: from_mm(f.retained_mm),
        mass: f.mass_percent,
    });
    GrainSizes::of(&fractions.collect::<Vec<_>>())
}

/// Grains by sieve fractions, also of meshes that are drawn by a sieve table.
pub(super) fn sieved(grains: &Value) -> Option<SievedGrains> {
    read(grains).or_else(|| read::<MeshGrains>(grains)?.as_sieved())
}

/// Grains three times as large as the paper's.
#[cfg(test)]
pub(super) fn larger() -> Grading {
    let sizes = GrainSizes::PAPER.times(3.0);
    Grading { sizes, density: 2000.0, solids: 0.035, count: 2000.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Law: what a file may say is what values follow from.
    #[test]
    fn densities_are_those_that_a_scenario_may_have() {
        let expected =
            format!("a number of at least {} and at most {}", DENSITIES.start(), DENSITIES.end());
        for grains in [json!({}), json!({ "meshes": [] })] {
            let value = json!({ "grains": grains });
            let got = structure::allowed_at(&value, "grains.density_kg_per_m3");
            assert_eq!(got, expected, "law: left what the schema allows of {grains}");
        }
    }

    #[test]
    fn nothing_follows_from_a_density_that_no_solid_has() {
        let of = |density: f64| {
            Grading::of_json(&json!({
                "total_mass_g": 100, "density_kg_per_m3": density,
                "sieve_table": [{ "passing_mm": 10, "retained_mm": 8, "mass_percent": 100 }]
            }))
        };
        for density in [0.0, -2650.0, 2.65, 9.99, 30_001.0] {
            assert_eq!(of(density), None, "law: of {density} kg/m³");
        }
        for density in [10.0, 2650.0, 30_000.0] {
            let found = of(density).map(|grading| grading.density);
            assert_eq!(found, Some(density), "law: of {density} kg/m³");
        }
    }
}
