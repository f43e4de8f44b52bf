//! What a specimen is at the end of a stage, to know it again.

use super::*;
use crate::record::StageEnd;

/// What a specimen is at the end of a stage, to know it again; gravity of that stage in m/s².
pub(super) fn end_of(gravity: f64, specimen: &Specimen) -> StageEnd {
    let present: Vec<usize> = specimen.present().collect();
    let overlap = overlap_statistics(specimen, &pairs_within(specimen, &present, 0.0));
    let energy = grain_energy(specimen, gravity, &Vector::zeros());
    StageEnd {
        grains: present.len(),
        kinetic_energy_j: energy.kinetic(),
        potential_energy_j: energy.potential,
        overlapping_pairs: overlap.overlapping,
        overlap_mean_percent: 100.0 * overlap.mean,
        overlap_max_percent: 100.0 * overlap.max,
    }
}
