//! The sieve table, and how many grains it makes.

use super::*;
use crate::scenario::{CellShape, LEAST_ROUNDING, SieveFraction, SievedShape};

/// Allowed error of the sum of the mass percentages.
const PERCENT_TOLERANCE: f64 = 0.01;

/// More grains than this one machine cannot carry: a step of 1456 takes some
/// 10 ms, and the time grows a little faster than the number.
const MOST_GRAINS: f64 = 1e6;

pub(super) fn check(parts: &Parts, faults: &mut Faults) {
    let mut faults = faults.at("grains");
    if let Some(meshes) = &parts.meshes {
        check_meshes(meshes, &mut faults);
    }
    let Some(sieved) = &parts.sieved else { return };
    faults.add_if(
        sieved.shape == SievedShape::Spheres && sieved.cells != CellShape::default(),
        "cells",
        "",
        "this field, or `shape` \"spheres\"",
        "spheres are cut from no cells, so there is nothing to relax or stretch",
    );
    let rounding = sieved.cells.rounding;
    faults.add_if(
        rounding > 0.0 && rounding < LEAST_ROUNDING,
        "cells.rounding",
        rounding,
        format!("0, or {LEAST_ROUNDING} to 0.9"),
        "corners with so small a radius are neither sharp nor round in a contact",
    );
    let table = &sieved.sieve_table;
    check_order(table, &mut faults);
    check_sum(table, &mut faults);
    let (mass, density) = (sieved.total_mass_g, sieved.density_kg_per_m3);
    if !(mass > 0.0 && density > 0.0) {
        return;
    }
    let is_sound =
        |f: &SieveFraction| f.passing_mm > 0.0 && f.retained_mm > 0.0 && f.mass_percent > 0.0;
    let mut total = 0.0;
    let mut least = 0.0_f64; // mass of which every fraction has a grain, where no share would do
    for (i, fraction) in table.iter().enumerate().filter(|(_, fraction)| is_sound(fraction)) {
        let count = fraction.grain_count(mass, density);
        total += count;
        let enough = fraction.mass_percent / count;
        if enough > 100.0 {
            least = least.max(1.0 / fraction.grain_count(1.0, density));
            continue;
        }
        faults.at(format!("sieve_table[{i}]")).add_if(
            count < 1.0,
            "mass_percent",
            fraction.mass_percent,
            format!("at least {} %", short(enough)),
            format!(
                "the fraction {} to {} mm is lighter than one grain of its mean size",
                fraction.passing_mm, fraction.retained_mm
            ),
        );
    }
    faults.add_if(
        least > 0.0,
        "total_mass_g",
        mass,
        format!("at least {} g with this sieve table", short(least)),
        "not every fraction has the mass of one grain of its mean size",
    );
    faults.add_if(
        total > MOST_GRAINS,
        "total_mass_g",
        mass,
        format!("at most {} g of this gravel", short(mass * MOST_GRAINS / total)),
        format!("this makes {total:.0} grains, more than {MOST_GRAINS:.0}"),
    );
}

/// A sieve table needs a mass to share out, and leaves nothing else to choose.
fn check_meshes(meshes: &MeshGrains, faults: &mut Faults) {
    let sieved = !meshes.sieve_table.is_empty();
    match (sieved, meshes.total_mass_g) {
        (true, None) => faults.add(
            "total_mass_g",
            "",
            "a number above 0",
            "the field is missing: the mass that `sieve_table` shares out",
        ),
        (false, Some(mass)) => faults.add(
            "total_mass_g",
            mass,
            "this field together with `sieve_table`, or neither",
            "without a sieve table the grains keep their own mass",
        ),
        _ => {}
    }
    if let (true, Some(count)) = (sieved, meshes.count) {
        let message = "the number of grains follows from the sieve table and the total mass";
        faults.add("count", count, "this field or `sieve_table`, not both", message);
    }
}

fn check_order(table: &[SieveFraction], faults: &mut Faults) {
    for (i, fraction) in table.iter().enumerate() {
        faults.at(format!("sieve_table[{i}]")).add_if(
            fraction.passing_mm <= fraction.retained_mm,
            "retained_mm",
            fraction.retained_mm,
            format!("less than passing_mm, {}", fraction.passing_mm),
            "grains that pass a sieve are retained by a finer one",
        );
    }
    for (i, pair) in table.windows(2).enumerate() {
        let (above, below) = (&pair[0], &pair[1]);
        let message = if below.passing_mm > above.passing_mm {
            "the sieve table is out of order: it goes from coarse to fine"
        } else if below.passing_mm > above.retained_mm {
            "two fractions of the sieve table overlap"
        } else {
            "the sieve table has a gap: a fraction begins where the one before it ends"
        };
        faults.at(format!("sieve_table[{}]", i + 1)).add_if(
            below.passing_mm != above.retained_mm,
            "passing_mm",
            below.passing_mm,
            format!("{}, the retained_mm of the fraction before", above.retained_mm),
            message,
        );
    }
}

fn check_sum(table: &[SieveFraction], faults: &mut Faults) {
    let sum: f64 = table.iter().map(|f| f.mass_percent).sum();
    faults.add_if(
        // The margin keeps a sum of decimals that is off by the tolerance itself inside.
        !((sum - 100.0).abs() <= PERCENT_TOLERANCE + 1e-9),
        "sieve_table",
        format!("a sum of {} %", short(sum)),
        format!("100 ± {PERCENT_TOLERANCE} %"),
        "the mass percentages of the fractions do not add up",
    );
}
