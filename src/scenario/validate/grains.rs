//! The sieve table, and how many grains it makes.

use super::{Parts, fault, short};
use crate::scenario::{CellShape, Fault, LEAST_ROUNDING, MeshGrains, SieveFraction, SievedShape};

/// Allowed error of the sum of the mass percentages.
const PERCENT_TOLERANCE: f64 = 0.01;

/// More grains than this one machine cannot carry: a step of 1456 takes some
/// 10 ms, and the time grows a little faster than the number.
const MOST_GRAINS: f64 = 1e6;

pub(super) fn check(parts: &Parts, faults: &mut Vec<Fault>) {
    if let Some(meshes) = &parts.meshes {
        check_meshes(meshes, faults);
    }
    let Some(sieved) = &parts.sieved else { return };
    if sieved.shape == SievedShape::Spheres && sieved.cells != CellShape::default() {
        faults.push(fault(
            "grains.cells",
            "",
            "this field, or `shape` \"spheres\"".into(),
            "spheres are cut from no cells, so there is nothing to relax or stretch".into(),
        ));
    }
    let rounding = sieved.cells.rounding;
    if rounding > 0.0 && rounding < LEAST_ROUNDING {
        faults.push(fault(
            "grains.cells.rounding",
            rounding,
            format!("0, or {LEAST_ROUNDING} to 0.9"),
            "corners with so small a radius are neither sharp nor round in a contact".into(),
        ));
    }
    let table = &sieved.sieve_table;
    check_order(table, faults);
    check_sum(table, faults);
    if !(sieved.total_mass_g > 0.0 && sieved.density_kg_per_m3 > 0.0) {
        return;
    }
    let mut total = 0.0;
    for (i, fraction) in table.iter().enumerate() {
        if !(fraction.passing_mm > 0.0 && fraction.retained_mm > 0.0 && fraction.mass_percent > 0.0)
        {
            continue;
        }
        let count = fraction.grain_count(sieved.total_mass_g, sieved.density_kg_per_m3);
        total += count;
        if count < 1.0 {
            faults.push(fault(
                &format!("grains.sieve_table[{i}].mass_percent"),
                fraction.mass_percent,
                format!("at least {} %", short(fraction.mass_percent / count)),
                format!(
                    "the fraction {} to {} mm is lighter than one grain of its mean size",
                    fraction.passing_mm, fraction.retained_mm
                ),
            ));
        }
    }
    if total > MOST_GRAINS {
        faults.push(fault(
            "grains.total_mass_g",
            sieved.total_mass_g,
            format!(
                "at most {} g of this gravel",
                short(sieved.total_mass_g * MOST_GRAINS / total)
            ),
            format!("this makes {total:.0} grains, more than {MOST_GRAINS:.0}"),
        ));
    }
}

/// A sieve table needs a mass to share out, and leaves nothing else to choose.
fn check_meshes(meshes: &MeshGrains, faults: &mut Vec<Fault>) {
    let sieved = !meshes.sieve_table.is_empty();
    match (sieved, meshes.total_mass_g) {
        (true, None) => faults.push(fault(
            "grains.total_mass_g",
            "",
            "a number above 0".into(),
            "the field is missing: the mass that `sieve_table` shares out".into(),
        )),
        (false, Some(mass)) => faults.push(fault(
            "grains.total_mass_g",
            mass,
            "this field together with `sieve_table`, or neither".into(),
            "without a sieve table the stones keep their own mass".into(),
        )),
        _ => {}
    }
    if let (true, Some(count)) = (sieved, meshes.count) {
        faults.push(fault(
            "grains.count",
            count,
            "this field or `sieve_table`, not both".into(),
            "the number of stones follows from the sieve table and the total mass".into(),
        ));
    }
}

fn check_order(table: &[SieveFraction], faults: &mut Vec<Fault>) {
    for (i, fraction) in table.iter().enumerate() {
        if fraction.passing_mm <= fraction.retained_mm {
            faults.push(fault(
                &format!("grains.sieve_table[{i}].retained_mm"),
                fraction.retained_mm,
                format!("less than passing_mm, {}", fraction.passing_mm),
                "grains that pass a sieve are retained by a finer one".into(),
            ));
        }
    }
    for (i, pair) in table.windows(2).enumerate() {
        let (above, below) = (&pair[0], &pair[1]);
        if below.passing_mm == above.retained_mm {
            continue;
        }
        let message = if below.passing_mm > above.passing_mm {
            "the sieve table is out of order: it goes from coarse to fine"
        } else if below.passing_mm > above.retained_mm {
            "two fractions of the sieve table overlap"
        } else {
            "the sieve table has a gap: a fraction begins where the one before it ends"
        };
        faults.push(fault(
            &format!("grains.sieve_table[{}].passing_mm", i + 1),
            below.passing_mm,
            format!("{}, the retained_mm of the fraction before", above.retained_mm),
            message.into(),
        ));
    }
}

fn check_sum(table: &[SieveFraction], faults: &mut Vec<Fault>) {
    let sum: f64 = table.iter().map(|f| f.mass_percent).sum();
    // The margin keeps a sum of decimals that is off by the tolerance itself inside.
    if !((sum - 100.0).abs() <= PERCENT_TOLERANCE + 1e-9) {
        faults.push(fault(
            "grains.sieve_table",
            format!("a sum of {} %", short(sum)),
            format!("100 ± {PERCENT_TOLERANCE} %"),
            "the mass percentages of the fractions do not add up".into(),
        ));
    }
}
