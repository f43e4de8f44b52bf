//! What holds for whole grain sets.

use super::*;
pub(super) use crate::geometry::testing::{near, regular_tetrahedron};
use crate::{
    geometry::MassProperties,
    scenario::{CellShape, SieveFraction, SievedGrains, SievedShape},
};

/// The paper's mass and density with a table of (passing mm, retained mm, mass percent).
pub(super) fn table(rows: &[(f64, f64, f64)]) -> SievedGrains {
    let row = |&(passing_mm, retained_mm, mass_percent): &(f64, f64, f64)| SieveFraction {
        passing_mm,
        retained_mm,
        mass_percent,
    };
    SievedGrains {
        total_mass_g: 2343.0,
        density_kg_per_m3: 2673.9,
        sieve_table: rows.iter().map(row).collect(),
        shape: SievedShape::default(),
        cells: CellShape::default(),
    }
}

/// The sieve table that gives the paper's 1456 grains.
pub(super) fn paper_grains() -> SievedGrains {
    table(&[(16.0, 12.5, 15.0), (12.5, 10.0, 51.95), (10.0, 8.0, 33.05)])
}

/// A twentieth of them.
pub(super) fn few_grains() -> SievedGrains {
    SievedGrains { total_mass_g: 2343.0 / 20.0, ..paper_grains() }
}

/// Law: a fraction of 0 % has no grains and changes none, wherever it stands; a file keeps it.
#[test]
fn a_fraction_without_grains_changes_no_grain() {
    for shape in [SievedShape::default(), SievedShape::Spheres] {
        let of = |rows: &[(f64, f64, f64)]| {
            let spec = SievedGrains { total_mass_g: 100.0, shape, ..table(rows) };
            let psd = ParticleSizeDistribution::new(&spec).expect("a table");
            (generate(&spec, 5).expect("grains"), psd)
        };
        let (plain, _) = of(&[(16.0, 12.5, 40.0), (12.5, 10.0, 60.0)]);
        let (padded, psd) =
            of(&[(20.0, 16.0, 0.0), (16.0, 12.5, 40.0), (12.5, 10.0, 60.0), (10.0, 8.0, 0.0)]);
        let moved: Vec<Grain> =
            plain.grains.iter().map(|g| Grain { fraction: g.fraction + 1, ..g.clone() }).collect();
        assert_eq!(padded.grains, moved, "law: the same grains, one fraction further");
        assert_eq!(padded.sizes(), plain.sizes(), "law: sizes are those of grains");
        assert!((10.0..20.0).contains(&(1e3 * psd.gradation().d10)), "law: D10 is of grains");
        let (gapped, psd) = of(&[(16.0, 12.5, 40.0), (12.5, 10.0, 0.0), (10.0, 8.0, 60.0)]);
        let counts: Vec<usize> = psd.fractions.iter().map(|f| f.grains).collect();
        assert!(counts[0] > 0 && counts[1] == 0 && counts[2] > 0, "law: none between, {counts:?}");
        near("total mass, kg", gapped.total_mass(), 0.1, 1e-13);
        assert_eq!(gapped.grains.iter().filter(|g| g.fraction == 1).count(), 0, "law: none");
        near("D60 begins the gap, mm", to_mm(psd.size_at_percent(60.0)), 10.0, 1e-12);
        for set in [padded, gapped] {
            let mut bytes = Vec::new();
            write_json(&set, &mut bytes).expect("written");
            assert_eq!(read_json(&bytes[..]).expect("read"), set, "law: a file keeps them");
            let specified = set.specified().expect("a distribution");
            let rows = String::from_utf8(sieve_csv(&specified, &set).expect("a table"));
            let rows = rows.expect("text");
            assert_eq!(rows.lines().count(), set.blocks.len() + 1, "law: a row a fraction");
            assert!(!rows.contains('-'), "law: nothing is less than zero, got {rows}");
        }
    }
}

#[test]
fn the_paper_s_grains() {
    let spec = paper_grains();
    let psd = ParticleSizeDistribution::new(&spec).unwrap();
    let set = generate(&spec, 1).unwrap();
    assert_eq!(set.grains.len(), 1456, "number of grains (paper, section 3)");
    near("total mass, kg", set.total_mass(), 2.343, 1e-13);
    near("solid volume, m³", set.total_volume(), 2.343 / 2673.9, 1e-16);
    let in_100_g = set.grains_in_100_g();
    assert!((55.0..=65.0).contains(&in_100_g), "55 to 65 grains in 100 g, got {in_100_g}");
    for (index, (block, fraction)) in set.blocks.iter().zip(&psd.fractions).enumerate() {
        let own: Vec<&Grain> = set.grains.iter().filter(|g| g.fraction == index).collect();
        assert_eq!((own.len(), block.cells.len()), (fraction.grains, fraction.grains));
        assert_eq!(block.points.len(), fraction.grains, "a point a grain");
        near("mass of a fraction, kg", own.iter().map(|g| g.mass).sum(), fraction.mass, 1e-13);
        near("side³ = solid volume, m³", block.side.powi(3), fraction.volume, 1e-16);
        assert_eq!(set.grains[block.first_grain].fraction, index, "first grain of the block");
    }
    for pair in set.blocks.windows(2) {
        assert!(pair[1].origin.x > pair[0].origin.x + pair[0].side, "blocks lie apart");
    }
    let radius = set.largest_bounding_radius();
    assert!((0.012..0.03).contains(&radius), "longest grains of 24 to 60 mm, got radius {radius}");
}

#[test]
fn grains_lie_in_their_principal_frames() {
    let set = generate(&few_grains(), 5).unwrap();
    for (index, grain) in set.grains.iter().enumerate() {
        grain.shape.sanity_check().unwrap_or_else(|e| panic!("grain {index}: {e}"));
        let own = MassProperties::of(&grain.shape);
        let size = grain.equivalent_diameter;
        near("centroid at the origin, m", own.centroid.coords.amax(), 0.0, 1e-12 * size);
        near("volume, m³", own.volume, grain.volume, 1e-12 * grain.volume);
        near("mass = density × volume, kg", grain.mass, set.density * grain.volume, 0.0);
        let inertia = own.inertia_per_density * set.density;
        let expected = nalgebra::Matrix3::from_diagonal(&grain.inertia);
        near("inertia is diagonal", (inertia - expected).amax(), 0.0, 1e-12 * inertia.trace());
        let [a, b, c] = grain.inertia.into();
        assert!(0.0 < a && a <= b && b <= c, "moments ascend: {a:e} {b:e} {c:e}");
        assert!(a + b > c, "triangle inequality of moments: {a:e} + {b:e} > {c:e}");
        let sphere = std::f64::consts::FRAC_PI_6 * size.powi(3);
        near("volume of the equivalent sphere, m³", sphere, grain.volume, 1e-14 * grain.volume);
        let block = &set.blocks[grain.fraction];
        let cell = &block.cells[index - block.first_grain];
        let back = grain.shape.transformed(&grain.pose_in_block);
        for (v, w) in back.vertices().iter().zip(cell.vertices()) {
            near("pose_in_block leads back to the block, m", (v - w).norm(), 0.0, 1e-15);
        }
    }
}

#[test]
fn same_seed_same_bits_another_seed_other_grains() {
    let spec = few_grains();
    let set = generate(&spec, 9).unwrap();
    assert_eq!(set, generate(&spec, 9).unwrap(), "same seed, same bits");
    assert_ne!(set.grains, generate(&spec, 10).unwrap().grains, "another seed, other grains");
}

#[test]
fn a_faulty_table_is_an_error_not_a_panic() {
    assert!(generate(&table(&[]), 1).is_err());
    assert!(generate(&table(&[(1600.0, 1250.0, 100.0)]), 1).is_err());
}
