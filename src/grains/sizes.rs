//! Sizes of a grain set, and scenarios whose automatic values follow from them.

use std::path::Path;

use super::*;
use crate::apparatus;
use crate::input;
use crate::scale::{GrainSizes, Quantity, SieveMass};
use crate::scenario::{self, Grading, GrainsSpec, Loaded, Override, Readers, ScenarioErrors};

/// Any: sizes depend on it only where grains are drawn from meshes.
const SEED: u64 = 1;

/// Who reads what scenarios name, and builds their pieces.
const READERS: Readers =
    Readers { grading: grading_of, parts: parts_of_piece, overlaps: apparatus::overlaps };

impl GrainSet {
    /// Sizes by the sieves of the blocks; by equivalent diameters where grains come from no
    /// block; those of the paper's gravel where there are no grains.
    pub fn sizes(&self) -> GrainSizes {
        let mut masses = vec![0.0; self.blocks.len()];
        for grain in &self.grains {
            if let Some(mass) = masses.get_mut(grain.fraction) {
                *mass += grain.mass;
            }
        }
        let fractions: Vec<SieveMass> = self
            .blocks
            .iter()
            .zip(masses)
            .map(|(b, mass)| SieveMass { passing: b.passing, retained: b.retained, mass })
            .collect();
        GrainSizes::of(&fractions).or_else(|| self.equivalent_sizes()).unwrap_or(GrainSizes::PAPER)
    }

    fn equivalent_sizes(&self) -> Option<GrainSizes> {
        let mut grains: Vec<(f64, f64)> =
            self.grains.iter().map(|g| (g.equivalent_diameter, g.mass)).collect();
        grains.sort_by(|a, b| a.0.total_cmp(&b.0));
        let half = self.total_mass() / 2.0;
        let mut finer = 0.0;
        let median = grains.iter().find(|(_, mass)| {
            finer += mass;
            finer >= half
        });
        let (smallest, largest) = (grains.first()?.0, grains.last()?.0);
        Some(GrainSizes { smallest, median: median.map_or(largest, |m| m.0), largest })
    }

    /// The scale of these grains under a gravity in m/s².
    pub fn scale(&self, gravity: f64) -> Scale {
        Scale { sizes: self.sizes(), density: self.density, gravity }
    }

    /// Clearance in m around the bounding sphere of each grain that is placed to fall.
    pub fn rain_clearance(&self) -> f64 {
        self.of_size(&scale::RAIN_CLEARANCE)
    }

    /// A quantity that follows from the size of these grains, in SI units; of speeds and
    /// times, that on earth.
    pub fn of_size(&self, quantity: &Quantity) -> f64 {
        quantity.at(&self.scale(Scale::PAPER.gravity))
    }

    /// What automatic values of a scenario with these grains follow from.
    pub fn grading(&self) -> Grading {
        Grading {
            sizes: self.sizes(),
            density: self.density,
            solids: self.total_volume(),
            count: self.grains.len() as f64,
        }
    }
}

/// Loads a scenario for its grains alone, as [`scenario::load_grains_with`].
///
/// # Errors
/// As [`scenario::load_grains_with`].
pub fn load_grains(path: &Path, overrides: &[Override]) -> Result<Loaded, ScenarioErrors> {
    scenario::load_grains_with(path, overrides, READERS)
}

/// Loads a scenario with what follows from its grains, also where these stand in a file or
/// are meshes in their own size: then they are read to find out.
///
/// # Errors
/// As [`scenario::load_with`].
pub fn load_scenario(path: &Path, overrides: &[Override]) -> Result<Loaded, ScenarioErrors> {
    scenario::load_with(path, overrides, READERS)
}

/// `None` where grains cannot be made: whoever makes them later says why.
fn grading_of(spec: &GrainsSpec) -> Option<Grading> {
    let set = match spec {
        GrainsSpec::Sieved(sieved) => return Grading::of_table(sieved),
        // Its table has said all that there is to say: meshes are not drawn for a faulty one.
        GrainsSpec::Meshes(meshes) if !meshes.sieve_table.is_empty() => {
            return Grading::of_table(&meshes.as_sieved()?);
        }
        GrainsSpec::File(named) => {
            let text = input::read(Path::new(&named.file), input::LARGEST_OF_RUN).ok()?;
            file::read_json(&text[..]).ok()?
        }
        GrainsSpec::Meshes(meshes) => from_meshes(meshes, SEED).ok()?,
    };
    Some(set.grading())
}
