//! Spheres by sieve fractions, their diameters drawn as the sizes of grains from meshes are.

use super::meshes::{Prototype, by_fraction, laid_out};
use super::*;

/// Makes spheres of a sieve table: in each fraction their diameters lie between the two sieves,
/// such that mass is uniform over the logarithm of diameter, and together they have the
/// fraction's mass. The same table and seed give the same bits.
///
/// # Errors
/// A fraction whose mass no whole number of spheres has.
pub(super) fn spheres(psd: &ParticleSizeDistribution, seed: u64) -> Result<GrainSet, GrainsError> {
    // Of diameter 1 m, to be scaled.
    let shape = ConvexPolyhedron::ball(0.5);
    let unit = [Prototype { volume: shape.signed_volume(), shape, sieve_size: 1.0 }];
    let blocks = by_fraction(psd, seed, "spheres", &unit).map_err(|unfilled| {
        let (index, fault) = *unfilled;
        let reason = format!(
            "no whole number of spheres between its sieves has its mass: {}, where {} is needed",
            fault.found, fault.allowed
        );
        GrainsError::BadSieveTable { row: index + 1, reason }
    })?;
    Ok(laid_out(psd.density, &blocks, &unit))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grains::{
        self, GrainShape, ShapeRatio, SieveAnalysis, generate,
        tests::{few_grains, near},
    };
    use crate::scenario::{SievedGrains, SievedShape};

    fn beads() -> SievedGrains {
        SievedGrains { shape: SievedShape::Spheres, ..few_grains() }
    }

    #[test]
    fn spheres_have_the_mass_of_their_fractions_and_lie_between_the_sieves() {
        let spec = beads();
        let psd = ParticleSizeDistribution::new(&spec).expect("a table");
        let set = generate(&spec, 3).expect("spheres");
        assert_eq!(set, generate(&spec, 3).expect("spheres"), "same seed, same bits");
        assert_ne!(set, generate(&spec, 4).expect("spheres"), "another seed, others");
        let sieved = SieveAnalysis::of(&set);
        for (n, fraction) in psd.fractions.iter().enumerate() {
            let own = || set.grains.iter().filter(|g| g.fraction == n);
            near("mass of a fraction, kg", own().map(|g| g.mass).sum(), fraction.mass, 1e-12);
            let inside = (fraction.retained..fraction.passing)
                .contains(&own().map(|g| g.equivalent_diameter).fold(0.0, f64::max));
            assert!(inside, "law: diameters between the sieves");
            let (count, _) = sieved.between(fraction.passing, fraction.retained);
            assert_eq!(count, own().count(), "law: every sphere is found in its fraction");
        }
        for (n, grain) in set.grains.iter().enumerate() {
            let sphere = grain.shape.sphere().expect("a sphere");
            let r = sphere.radius;
            near("centre, m", sphere.centre.coords.norm(), 0.0, 1e-12 * r);
            let mass = set.density * 4.0 / 3.0 * std::f64::consts::PI * r.powi(3);
            near("mass, kg", grain.mass, mass, 1e-14 * mass);
            near(
                "moment 2/5 m r²",
                (grain.inertia.add_scalar(-0.4 * mass * r * r)).amax(),
                0.0,
                1e-14 * mass * r * r,
            );
            near("sieve size, m", sieved.grains()[n].size, 2.0 * r, 1e-15);
            let shape = GrainShape::of(&grain.shape);
            for ratio in ShapeRatio::ALL {
                near("a shape descriptor", shape.ratio(ratio), 1.0, 1e-12);
            }
        }
    }

    #[test]
    fn spheres_come_back_from_their_file_bit_by_bit() {
        let set = generate(&beads(), 7).expect("spheres");
        let mut bytes = Vec::new();
        grains::write_json(&set, &mut bytes).expect("written");
        assert_eq!(grains::read_json(&bytes[..]).expect("read"), set);
        let per_grain = bytes.len() / set.grains.len();
        assert!(per_grain < 600, "law: a sphere takes no mesh in the file, {per_grain} bytes");
        let json = grains::to_json(&set);
        let fault = |change: &dyn Fn(&mut grains::CellJson)| {
            let mut json = json.clone();
            change(&mut json.blocks[1].cells[2]);
            grains::from_json(&json).expect_err("the change must be noticed").to_string()
        };
        for (words, said) in [
            ("radius of a sphere", fault(&|c| c.radius_m = Some(-1.0))),
            ("radius of a sphere", fault(&|c| c.radius_m = Some(f64::NAN))),
            ("its centre", fault(&|c| c.centroid_m[1] = f64::INFINITY)),
            ("volume_m3", fault(&|c| c.radius_m = c.radius_m.map(|r| r * 1.001))),
            ("at least 4 vertices", fault(&|c| c.radius_m = None)),
            ("at least 4 vertices", fault(&|c| c.vertices_m = vec![[0.0; 3]])),
        ] {
            assert!(said.contains(words), "law: it says `{words}`, got `{said}`");
        }
    }

    /// Law: sieves that differ by an eighth of a millionth hold spheres of one size between them.
    #[test]
    fn sieves_may_be_as_near_as_one_size_asks_for() {
        let mut spec = beads();
        spec.sieve_table.truncate(1);
        let row = &mut spec.sieve_table[0];
        (row.passing_mm, row.retained_mm, row.mass_percent) = (8.000_001, 8.0, 100.0);
        // Ten spheres of the size between.
        let size = 8.000_000_5e-3_f64;
        let kg = 10.0 * spec.density_kg_per_m3 * std::f64::consts::FRAC_PI_6 * size.powi(3);
        spec.total_mass_g = 1e3 * kg;
        let set = generate(&spec, 1).expect("spheres");
        assert_eq!(set.grains.len(), 10, "law: as many as weigh so much");
        near("total mass, kg", set.total_mass(), kg, 1e-12 * kg);
        let fraction = ParticleSizeDistribution::new(&spec).expect("a table").fractions[0];
        let (count, _) = SieveAnalysis::of(&set).between(fraction.passing, fraction.retained);
        assert_eq!(count, 10, "law: every sphere is found in its fraction");
        // Half a sphere more: refused, not a panic.
        spec.total_mass_g *= 1.05;
        let said = generate(&spec, 1).expect_err("no whole number").to_string();
        assert!(said.contains("no whole number of spheres"), "{said}");
    }

    #[test]
    fn a_mass_that_no_spheres_have_is_refused() {
        let mut spec = beads();
        // 0.75 spheres of the mean size.
        spec.sieve_table.truncate(1);
        spec.sieve_table[0].mass_percent = 100.0;
        spec.sieve_table[0].retained_mm = 15.9;
        spec.total_mass_g = 4.2;
        let said = generate(&spec, 1).expect_err("no whole number").to_string();
        assert!(said.contains("no whole number of spheres"), "{said}");
    }
}
