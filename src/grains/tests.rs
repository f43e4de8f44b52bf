//! The laws that generated grains must keep.

use super::{streams::Stream, *};
use crate::geometry::{MassProperties, Vector};
use crate::scenario::{SieveFraction, SievedGrains};

/// The sieve data of `scenarios/paper/pluviation.json`.
fn paper() -> SievedGrains {
    let fraction = |passing_mm, retained_mm, mass_percent| SieveFraction {
        passing_mm,
        retained_mm,
        mass_percent,
    };
    SievedGrains {
        total_mass_g: 2343.0,
        density_kg_per_m3: 2673.9,
        sieve_table: vec![
            fraction(16.0, 12.5, 15.0),
            fraction(12.5, 10.0, 51.95),
            fraction(10.0, 8.0, 33.05),
        ],
    }
}

#[test]
fn the_paper_s_numbers_come_out() {
    let set = generate(&paper(), 1).expect("grains");
    assert_eq!(set.grains.len(), 1456, "paper, section 3: 1456 polyhedra");
    let counts: Vec<usize> =
        (0..3).map(|f| set.grains.iter().filter(|g| g.fraction == f).count()).collect();
    assert_eq!(counts, [87, 610, 759]);
    let in_100_g = set.grains_in_100_g();
    assert!(
        (55.0..=65.0).contains(&in_100_g),
        "paper, section 3: 55 to 65 grains in 100 g, got {in_100_g}"
    );
    let mass = set.mass();
    assert!((mass - 2.343).abs() < 1e-9, "expected 2.343 kg, got {mass}, tolerance 1e-9");
    let gradation = Gradation::of(&ParticleSizeDistribution::new(&paper()).expect("fractions"));
    assert_eq!(gradation.uscs, "GP", "paper, section 2: poorly graded gravel");
}

#[test]
fn cells_fill_their_block_exactly() {
    for seed in 1..=4 {
        let set = generate(&paper(), seed).expect("grains");
        for (index, block) in set.blocks.iter().enumerate() {
            let sum: f64 =
                set.grains.iter().filter(|g| g.fraction == index).map(|g| g.volume).sum();
            let expected = block.side.powi(3);
            assert!(
                (sum / expected - 1.0).abs() < 1e-9,
                "law: cells fill the cube, seed {seed}, block {index}: expected {expected} m³, \
                 got {sum} m³, tolerance 1e-9"
            );
        }
        for grain in &set.grains {
            grain.shape.sanity_check().expect("a sound grain");
        }
    }
}

#[test]
fn shapes_stand_in_their_principal_frame() {
    let set = generate(&paper(), 2).expect("grains");
    for (index, grain) in set.grains.iter().enumerate() {
        let p = MassProperties::of(&grain.shape);
        let i = p.inertia_per_density * set.density;
        let size = grain.inertia.max();
        let off = i[(0, 1)].abs().max(i[(0, 2)].abs()).max(i[(1, 2)].abs()) / size;
        assert!(off < 1e-9, "law: no products of inertia, grain {index}: {off}, tolerance 1e-9");
        let error = (i.diagonal() - grain.inertia).norm() / size;
        assert!(error < 1e-9, "law: moments as stated, grain {index}: {error}, tolerance 1e-9");
        let offset = p.centroid.coords.norm() / grain.equivalent_diameter;
        assert!(offset < 1e-9, "law: centroid at the origin, grain {index}: {offset}");
        let m = grain.inertia;
        assert!(m.x <= m.y && m.y <= m.z, "moments ascend, grain {index}: {m:?}");
    }
}

#[test]
fn same_seed_same_grains_another_seed_others() {
    let make = |seed| generate(&paper(), seed).expect("grains");
    assert!(make(1) == make(1), "law: same seed, same bits");
    assert!(make(1) != make(2), "another seed gives other grains");
}

#[test]
fn a_configuration_is_another_order_and_other_orientations_of_the_same_grains() {
    let set = generate(&paper(), 1).expect("grains");
    let (one, two) = (mix(&set, 1, 1), mix(&set, 1, 2));
    assert_eq!(one, mix(&set, 1, 1), "law: same configuration, same mixing");
    assert_ne!(one.order, two.order);
    assert_ne!(one.orientations, two.orientations);
    let mut sorted = two.order.clone();
    sorted.sort_unstable();
    assert!(sorted.into_iter().eq(0..set.grains.len()), "every grain once");
}

#[test]
fn rain_leaves_no_two_bounding_spheres_overlapping_and_none_outside() {
    let set = generate(&paper(), 1).expect("grains");
    let (radius, bottom) = (0.128, 0.4);
    let poses = rain(&set, &mix(&set, 1, 1), radius, bottom, 1).expect("placed");
    let spheres: Vec<(Vector, f64)> = poses
        .iter()
        .zip(&set.grains)
        .map(|(p, g)| (p.translation.vector, g.shape.radius_about_origin()))
        .collect();
    for (i, (at, r)) in spheres.iter().enumerate() {
        let reach = at.x.hypot(at.y) + r;
        assert!(reach <= radius, "grain {i} reaches {reach} m, allowed {radius} m");
        assert!(at.z - r >= bottom, "grain {i} begins below {bottom} m");
        for (j, (other, s)) in spheres.iter().enumerate().skip(i + 1) {
            let gap = (at - other).norm() - r - s;
            assert!(gap > 0.0, "grains {i} and {j} overlap by {gap} m");
        }
    }
    let top = spheres.iter().map(|(at, r)| at.z + r).fold(0.0, f64::max);
    let volume: f64 =
        spheres.iter().map(|(_, r)| 4.0 / 3.0 * std::f64::consts::PI * r.powi(3)).sum();
    let fill = volume / (std::f64::consts::PI * radius * radius * (top - bottom));
    assert!(fill > 0.3, "spheres fill {fill} of their column, expected more than 0.3");
    let narrow = rain(&set, &mix(&set, 1, 1), 0.005, bottom, 1);
    assert!(matches!(narrow, Err(GrainsError::TooNarrow { .. })), "{narrow:?}");
}

#[test]
fn file_form_goes_there_and_back() {
    let set = generate(&paper(), 3).expect("grains");
    let json = to_json(&set);
    let text = serde_json::to_string(&json).expect("text");
    let read: GrainsJson = serde_json::from_str(&text).expect("read");
    let back = from_json(&read).expect("sound");
    assert!(back == set, "law: written and read, the same grains to the bit");
    assert_eq!(serde_json::to_string(&to_json(&back)).expect("text"), text, "and the same bytes");
}

#[test]
fn damaged_files_are_refused_by_name() {
    let small = SievedGrains { total_mass_g: 100.0, ..paper() };
    let good = to_json(&generate(&small, 1).expect("grains"));
    let spoil = |change: &dyn Fn(&mut GrainsJson)| {
        let mut json = good.clone();
        change(&mut json);
        from_json(&json).expect_err("spoilt").to_string()
    };
    let cases: [(&str, &dyn Fn(&mut GrainsJson)); 5] = [
        ("density_kg_per_m3", &|j| j.density_kg_per_m3 = -1.0),
        ("blocks[1].cells[2].mass_kg", &|j| j.blocks[1].cells[2].mass_kg *= 1.01),
        ("blocks[0].cells[0]", &|j| j.blocks[0].cells[0].faces[0].reverse()),
        ("blocks[0].cells[0]", &|j| j.blocks[0].cells[0].vertices_m[0][0] = f64::NAN),
        ("blocks[2]", &|j| j.blocks[2].side_m = 0.0),
    ];
    for (path, change) in cases {
        let text = spoil(change);
        assert!(text.contains(path), "expected {path} in: {text}");
    }
    assert!(from_json(&good).is_ok(), "and the unspoilt file is accepted");
}

#[test]
fn impossible_points_and_masses_are_errors() {
    let inside = Vector::repeat(0.5);
    for points in [vec![inside, inside], vec![Vector::repeat(1.5)], vec![Vector::repeat(f64::NAN)]]
    {
        let made = voronoi::cells(1.0, &points);
        assert!(matches!(made, Err(GrainsError::Points { .. })), "{made:?}");
    }
    assert_eq!(voronoi::cells(1.0, &[inside]).expect("one cell").len(), 1);
    let nothing = SievedGrains { total_mass_g: 0.1, ..paper() };
    assert!(matches!(generate(&nothing, 1), Err(GrainsError::EmptyFraction { .. })));
}

#[test]
fn streams_are_named_and_rotations_have_no_preferred_direction() {
    let mut a = Stream::new(1, "a");
    let mut again = Stream::new(1, "a");
    let mut b = Stream::new(1, "b");
    let (first, second) = (a.uniform(), b.uniform());
    assert_eq!(first, again.uniform());
    assert_ne!(first, second);
    let n = 20_000;
    let mean: Vector = (0..n).map(|_| a.rotation() * Vector::z()).sum::<Vector>() / f64::from(n);
    // The mean of n unit vectors has components of about 1/√(3n) = 0.004.
    assert!(mean.norm() < 0.03, "law: no preferred direction, got {mean:?}, tolerance 0.03");
}

#[test]
fn meshes_hold_every_grain() {
    let set = generate(&SievedGrains { total_mass_g: 100.0, ..paper() }, 1).expect("grains");
    let text = |write: &dyn Fn(&mut Vec<u8>)| {
        let mut out = Vec::new();
        write(&mut out);
        String::from_utf8(out).expect("text")
    };
    let obj = text(&|out| mesh::write_obj(&set, out).expect("written"));
    let stl = text(&|out| mesh::write_stl(&set, out).expect("written"));
    let ply = text(&|out| mesh::write_ply(&set, out).expect("written"));
    let grains = set.grains.len();
    assert_eq!(obj.lines().filter(|l| l.starts_with("o ")).count(), grains);
    assert_eq!(stl.lines().filter(|l| l.starts_with("endsolid")).count(), grains);
    let vertices: usize = set.grains.iter().map(|g| g.cell.vertices().len()).sum();
    assert_eq!(obj.lines().filter(|l| l.starts_with("v ")).count(), vertices);
    assert!(ply.contains(&format!("element vertex {vertices}")));
    let largest = obj
        .lines()
        .filter(|l| l.starts_with("f "))
        .flat_map(|l| l.split(' ').skip(1).map(|c| c.parse::<usize>().expect("a corner")))
        .max();
    assert_eq!(largest, Some(vertices), "faces name the last vertex and none beyond");
}
