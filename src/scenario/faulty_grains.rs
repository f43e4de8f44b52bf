//! Scenarios whose grains are at fault, so that what follows from them is not known: what nobody
//! typed is not judged there, or the paper's apparatus would be a fault beside small grains.

use super::*;
use crate::scale::GrainSizes;

/// Sizes of grains that automatic values are tried with where nothing is known of them, in sizes
/// of the paper's.
const TRIED: [f64; 2] = [0.01, 50.0];

/// Fills in what follows from grains whose mass or density is at fault, by the sizes of their sieve
/// table. Whether it has any.
pub(super) fn fill_by_sizes(value: &mut Value) -> bool {
    let table: Option<Vec<SieveFraction>> = read(&value["grains"]["sieve_table"]);
    let Some(sizes) = table.and_then(|table| sizes_of(&table)) else { return false };
    fill(value, &of_sizes(sizes));
    true
}

/// The faults of meaning that a scenario's JSON has whatever its grains are.
pub(super) fn faults(value: &Value) -> Vec<Fault> {
    let mut found = validate::faults(value, None);
    for factor in TRIED {
        let mut filled = value.clone();
        fill(&mut filled, &of_sizes(GrainSizes::PAPER.times(factor)));
        let with_these = validate::faults(&filled, None);
        found.retain(|fault| with_these.contains(fault));
    }
    found
}

/// Of grains of which nothing but their sizes is known.
fn of_sizes(sizes: GrainSizes) -> Grading {
    Grading { sizes, density: Scale::PAPER.density, solids: 0.0, count: 0.0 }
}
