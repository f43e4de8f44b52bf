//! The sieve table, and how many grains it makes.

use super::*;

/// More grains than this one machine cannot carry: a step of 1456 takes some
/// 10 ms, and the time grows a little faster than the number.
const MOST_GRAINS: f64 = 1e6;

pub(super) fn check(parts: &Parts, faults: &mut Faults) {
    let mut faults = faults.at("grains");
    if let Some(meshes) = &parts.meshes {
        check_meshes(meshes, &mut faults);
    }
    let Some(sieved) = &parts.sieved else { return };
    let wrong = sieved.shape == SievedShape::Spheres && sieved.cells != CellShape::default();
    let allowed = "this field, or `shape` \"spheres\"";
    let why = "spheres are cut from no cells, so there is nothing to relax or stretch";
    faults.add_if(wrong, "cells", "", allowed, why);
    let rounding = sieved.cells.rounding;
    let wrong = rounding > 0.0 && rounding < LEAST_ROUNDING;
    let allowed = format!("0, or {LEAST_ROUNDING} to 0.9");
    let why = "corners with so small a radius are neither sharp nor round in a contact";
    faults.add_if(wrong, "cells.rounding", rounding, allowed, why);
    let table = &sieved.sieve_table;
    check_order(table, &mut faults);
    check_sum(table, &mut faults);
    let (mass, density) = (sieved.total_mass_g, sieved.density_kg_per_m3);
    let factor = SieveFraction::factor_to_hundred(table);
    if !(mass > 0.0 && DENSITIES.contains(&density)) {
        return;
    }
    let is_sound = |f: &SieveFraction| f.passing_mm > 0.0 && f.retained_mm > 0.0 && f.has_grains();
    let mut total = 0.0;
    let mut least = 0.0_f64; // mass of which every fraction has a grain, where no share would do
    for (i, fraction) in table.iter().enumerate().filter(|(_, fraction)| is_sound(fraction)) {
        let count = fraction.grain_count(mass * factor, density);
        total += count;
        let enough = fraction.mass_percent / count;
        if enough > 100.0 {
            least = least.max(1.0 / fraction.grain_count(factor, density));
            continue;
        }
        let [passing_mm, retained_mm] = [fraction.passing_mm, fraction.retained_mm].map(as_typed);
        let field = format!("sieve_table[{i}].mass_percent");
        let why = format!(
            "the fraction {passing_mm} to {retained_mm} mm is lighter than one grain of its mean \
             size"
        );
        let allowed = format!("at least {} %", no_less(enough));
        faults.add_if(count < 1.0, &field, fraction.mass_percent, allowed, why);
    }
    let allowed = match least.is_finite() {
        true => format!("at least {} g with this sieve table", no_less(least)),
        false => "none with this sieve table: a sieve is too wide, or a share too small".to_owned(),
    };
    let why = "not every fraction has the mass of one grain of its mean size";
    faults.add_if(least > 0.0, "total_mass_g", mass, allowed, why);
    let allowed = format!("at most {} g of this gravel", no_more(mass * MOST_GRAINS / total));
    let why = format!("this makes {:.0} grains, more than {MOST_GRAINS:.0}", total.ceil());
    faults.add_if(total > MOST_GRAINS, "total_mass_g", mass, allowed, why);
}

/// A sieve table needs a mass to share out, and leaves nothing else to choose.
fn check_meshes(meshes: &MeshGrains, faults: &mut Faults) {
    if meshes.sieve_table.is_empty() {
        if let Some(mass) = meshes.total_mass_g {
            let allowed = "this field together with `sieve_table`, or neither";
            let why = "without a sieve table the grains keep their own mass";
            faults.add("total_mass_g", mass, allowed, why);
        }
        return;
    }
    let missing = meshes.total_mass_g.is_none();
    let why = "the field is missing: the mass that `sieve_table` shares out";
    faults.add_if(missing, "total_mass_g", "", "a number above 0", why);
    if let Some(count) = meshes.count {
        let why = "the number of grains follows from the sieve table and the total mass";
        faults.add("count", count, "this field or `sieve_table`, not both", why);
    }
}

fn check_order(table: &[SieveFraction], faults: &mut Faults) {
    for (i, SieveFraction { passing_mm, retained_mm, .. }) in table.iter().enumerate() {
        let wrong = passing_mm <= retained_mm;
        let field = format!("sieve_table[{i}].retained_mm");
        let allowed = format!("less than passing_mm, {}", as_typed(*passing_mm));
        let why = "grains that pass a sieve are retained by a finer one";
        faults.add_if(wrong, &field, retained_mm, allowed, why);
    }
    for (i, pair) in table.windows(2).enumerate() {
        let (above, below) = (&pair[0], &pair[1]);
        let why = if below.passing_mm > above.passing_mm {
            "the sieve table is out of order: it goes from coarse to fine"
        } else if below.passing_mm > above.retained_mm {
            "two fractions of the sieve table overlap"
        } else {
            "the sieve table has a gap: a fraction begins where the one before it ends"
        };
        let wrong = below.passing_mm != above.retained_mm;
        let field = format!("sieve_table[{}].passing_mm", i + 1);
        let retained_mm = as_typed(above.retained_mm);
        let mut allowed = format!("{retained_mm}, the retained_mm of the fraction before");
        if below.passing_mm < above.retained_mm {
            allowed += "; or a fraction of 0 % between them";
        }
        faults.add_if(wrong, &field, below.passing_mm, allowed, why);
    }
}

fn check_sum(table: &[SieveFraction], faults: &mut Faults) {
    let found = format!("a sum of {} %", as_typed(nine_digits(SieveFraction::percent_sum(table))));
    let tolerance = short(SieveFraction::percent_tolerance(table));
    let allowed = format!("100 ± {tolerance} %, by which rounded rows may miss it");
    let why = "the mass percentages of the fractions do not add up";
    faults.add_if(!SieveFraction::add_up(table), "sieve_table", found, allowed, why);
}
