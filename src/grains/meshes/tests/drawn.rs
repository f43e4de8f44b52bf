//! Drawn grains weigh what the sieve table asks for, each on its sieve.

use super::*;
use crate::{
    grains::{psd::ParticleSizeDistribution, sieve_csv},
    scenario::{CellShape, SieveFraction, SievedGrains},
};

/// Six boxes of different shape.
fn boxes(folder: &Path) -> MeshGrains {
    for (i, sides) in [
        [10.0, 12.0, 15.0],
        [9.0, 9.0, 9.0],
        [8.0, 15.0, 20.0],
        [12.0, 13.0, 30.0],
        [7.0, 7.0, 14.0],
        [11.0, 12.0, 12.0],
    ]
    .into_iter()
    .enumerate()
    {
        file(folder, &format!("{i}.obj"), cuboid_obj(sides, [0.0; 3]));
    }
    spec(&[format!("{}/*.obj", folder.display())])
}

fn table(total_mass_g: f64) -> (Option<f64>, Vec<SieveFraction>) {
    let row = |passing_mm, retained_mm, mass_percent| SieveFraction {
        passing_mm,
        retained_mm,
        mass_percent,
    };
    (Some(total_mass_g), vec![row(16.0, 12.5, 15.0), row(12.5, 10.0, 51.95), row(10.0, 8.0, 33.05)])
}

#[test]
fn every_fraction_has_its_mass_and_every_grain_its_sieve() {
    let folder = tempfile::tempdir().unwrap();
    let (total_mass_g, sieve_table) = table(500.0);
    let spec = MeshGrains { total_mass_g, sieve_table, ..boxes(folder.path()) };
    let set = from_meshes(&spec, 5).unwrap();
    assert_eq!(set, from_meshes(&spec, 5).unwrap(), "same seed, same bits");
    assert_ne!(set.grains, from_meshes(&spec, 6).unwrap().grains, "another seed, other grains");
    near("total mass, kg", set.total_mass(), 0.5, 1e-12);
    let sieved: SievedGrains = spec.as_sieved().unwrap();
    assert_eq!(sieved.cells, CellShape::default());
    let psd = ParticleSizeDistribution::new(&sieved).unwrap();
    assert_eq!(set.blocks.len(), psd.fractions.len(), "one block a fraction");
    assert!(set.specified().is_some(), "law: the table is specified");
    for (index, fraction) in psd.fractions.iter().enumerate() {
        let own: Vec<_> = set.grains.iter().filter(|g| g.fraction == index).collect();
        near("mass of a fraction, kg", own.iter().map(|g| g.mass).sum(), fraction.mass, 1e-12);
        for grain in &own {
            let size = sieve_size(&grain.shape);
            // Another orientation, another path of the search: a percent.
            let (least, most) = (fraction.retained * 0.99, fraction.passing * 1.01);
            assert!((least..=most).contains(&size), "{size} m between {least} and {most}");
        }
        // The grains' own measure holds exactly.
        let shape = |g: &crate::grains::Grain| g.volume.cbrt();
        assert!(own.iter().any(|g| shape(g) != shape(own[0])), "sizes are scattered");
    }
    let used: usize = set.meshes.iter().map(|s| s.grains).sum();
    assert_eq!(used, set.grains.len(), "every grain has its mesh");
    let counts: Vec<usize> = set.meshes.iter().map(|s| s.grains).collect();
    let (least, most) = (counts.iter().min().unwrap(), counts.iter().max().unwrap());
    assert!(
        most - least <= 3,
        "each mesh is used before any comes again, in each fraction: {counts:?}"
    );
    let csv = sieve_csv(&psd, &set).unwrap();
    assert_eq!(String::from_utf8(csv).unwrap().lines().count(), 4, "a row a fraction");
    for pair in set.blocks[0].cells.windows(2) {
        let ((_, high), (low, _)) = (pair[0].bounding_box(), pair[1].bounding_box());
        assert!(
            high.x < low.x || pair[1].bounding_box().0.y > pair[0].bounding_box().0.y,
            "grains lie apart"
        );
    }
}

#[test]
fn sizes_fill_the_fraction_as_its_curve_is_drawn() {
    // By mass, half of a fraction is finer than the geometric mean of its sieves.
    let folder = tempfile::tempdir().unwrap();
    let spec = MeshGrains {
        total_mass_g: Some(20_000.0),
        sieve_table: vec![SieveFraction {
            passing_mm: 16.0,
            retained_mm: 8.0,
            mass_percent: 100.0,
        }],
        meshes: vec![file(folder.path(), "cube.obj", cuboid_obj([10.0; 3], [0.0; 3]))],
        ..spec(&[])
    };
    let set = from_meshes(&spec, 3).unwrap();
    let middle = (0.008_f64 * 0.016).sqrt().powi(3);
    let finer: f64 = set.grains.iter().filter(|g| g.volume < middle).map(|g| g.mass).sum();
    // Some 5000 cubes: the share's standard error is about 0.8 %.
    near("share of the mass finer than the geometric mean", finer / 20.0, 0.5, 0.03);
}

#[test]
fn a_count_draws_grains_in_their_own_size() {
    let folder = tempfile::tempdir().unwrap();
    let spec = MeshGrains { count: Some(15), ..boxes(folder.path()) };
    let set = from_meshes(&spec, 5).unwrap();
    assert_eq!(set.grains.len(), 15, "as many as asked for");
    for prototype in &set.meshes {
        assert!((2..=3).contains(&prototype.grains), "15 of 6 meshes: {}", prototype.grains);
        assert_eq!(prototype.scales, (1.0, 1.0), "in their own size");
    }
    let specified = set.specified();
    assert_eq!(specified, None, "law: what nobody specified is not that of a block's sieves");
}

/// Law: grains read from a file have the sieve table of those that were written to it, or none.
#[test]
fn a_file_says_whether_sizes_were_specified() {
    let folder = tempfile::tempdir().unwrap();
    let (total_mass_g, sieve_table) = table(500.0);
    let own = boxes(folder.path());
    let sieved = MeshGrains { total_mass_g, sieve_table, ..own.clone() };
    for (spec, specified) in [(own, false), (sieved, true)] {
        let set = from_meshes(&spec, 5).unwrap();
        let mut bytes = Vec::new();
        crate::grains::write_json(&set, &mut bytes).unwrap();
        let back = crate::grains::read_json(&bytes[..]).unwrap();
        assert_eq!(set.specified().is_some(), specified, "law: whether there was a table");
        assert_eq!(back.specified().is_some(), specified, "law: the same of the file");
        let text = String::from_utf8(bytes).unwrap();
        assert_eq!(text.contains("own_sizes"), !specified, "law: other files are as they were");
    }
}

#[test]
fn a_fraction_too_light_for_a_grain_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let (_, sieve_table) = table(1.0);
    let spec = MeshGrains { total_mass_g: Some(8.0), sieve_table, ..boxes(folder.path()) };
    let error = from_meshes(&spec, 5).unwrap_err();
    assert!(!error.faults().is_empty(), "{error}");
    assert!(error.to_string().contains("grains.sieve_table"), "{error}");
}

#[test]
fn scaling_a_thousand_times_is_noted() {
    let folder = tempfile::tempdir().unwrap();
    let (total_mass_g, sieve_table) = table(300.0);
    let spec = MeshGrains {
        total_mass_g,
        sieve_table,
        mesh_unit: MeshUnit::Cm,
        meshes: vec![file(folder.path(), "cube.obj", cuboid_obj([80.0; 3], [0.0; 3]))],
        ..spec(&[])
    };
    let set = from_meshes(&spec, 5).unwrap();
    let notes = MeshRecord::notes(&set.meshes).join("\n");
    assert!(notes.contains("is `mesh_unit` right?"), "{notes}");
}
