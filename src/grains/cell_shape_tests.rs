//! Shape of relaxed and stretched cells, and the table of it in the docs.

use super::*;
use crate::grains::{Grain, GrainSet, generate, tests::paper_grains};

/// What the table of the docs says of a grain set.
#[derive(Debug)]
struct Shape {
    faces: f64,
    scatter_of_volume: f64,
    elongation: f64,
    flatness: f64,
    sphericity: f64,
}

/// Semi-axes of the ellipsoid with the same moments, longest first: for mass
/// m, I₁ = m/5·(b² + c²) and so on.
fn axes(grain: &Grain) -> [f64; 3] {
    let [i1, i2, i3] = (grain.inertia / grain.mass * 2.5).into();
    [i2 + i3 - i1, i1 + i3 - i2, i1 + i2 - i3].map(f64::sqrt)
}

fn shape_of(set: &GrainSet) -> Shape {
    let n = set.grains.len() as f64;
    let mean = |of: &dyn Fn(&Grain) -> f64| set.grains.iter().map(of).sum::<f64>() / n;
    let volume = mean(&|g| g.volume);
    Shape {
        faces: mean(&|g| g.shape.faces().len() as f64),
        scatter_of_volume: mean(&|g| (g.volume / volume - 1.0).powi(2)).sqrt(),
        elongation: mean(&|g| axes(g)[0] / axes(g)[1]),
        flatness: mean(&|g| axes(g)[1] / axes(g)[2]),
        sphericity: mean(&|g| {
            std::f64::consts::PI * g.equivalent_diameter.powi(2) / g.shape.surface()
        }),
    }
}

fn made(relaxation_steps: u32, elongation: f64, flatness: f64) -> Shape {
    // One fraction of 1000 grains.
    let mut spec = paper_grains();
    spec.sieve_table.truncate(1);
    spec.sieve_table[0].mass_percent = 100.0;
    let each = std::f64::consts::FRAC_PI_6 * 0.014_25_f64.powi(3) * spec.density_kg_per_m3;
    spec.total_mass_g = 1000.0 * each * 1000.0;
    spec.cells = CellShape { relaxation_steps, elongation, flatness, rounding: 0.0 };
    let set = generate(&spec, 1).unwrap();
    assert_eq!(set.grains.len(), 1000, "one fraction of 1000 grains");
    shape_of(&set)
}

#[test]
fn boxes_of_known_axes_measure_the_helpers() {
    // A box's moments are those of an ellipsoid whose axes are in the same ratios.
    let cell = crate::geometry::ConvexPolyhedron::cuboid(Vector::new(3.0, 2.0, 1.0)).unwrap();
    let grain = Grain::of_cell(&cell, 1000.0, 0);
    let [a, b, c] = axes(&grain);
    assert!((a / b - 1.5).abs() < 1e-12 && (b / c - 2.0).abs() < 1e-12, "{a} {b} {c}");
}

#[test]
fn defaults_leave_points_and_box_as_they_are() {
    let default = CellShape::default();
    assert_eq!(box_sides(&default), Vector::repeat(1.0), "a cube");
    let points = vec![Vector::new(0.1, 0.2, 0.3), Vector::new(0.7, 0.6, 0.9)];
    assert_eq!(relaxed(points.clone(), box_sides(&default), 0).unwrap(), points);
}

#[test]
fn two_points_relax_to_the_centroids_of_halves() {
    let points = vec![Vector::new(0.2, 0.5, 0.5), Vector::new(0.9, 0.5, 0.5)];
    let after = relaxed(points, Vector::new(1.0, 0.5, 1.0), 200).unwrap();
    for (got, x) in after.iter().zip([0.25, 0.75]) {
        let expected = Vector::new(x, 0.5, 0.5);
        assert!((got - expected).norm() < 1e-9, "expected {expected}, got {got} ± 1e-9");
    }
}

/// The table in the docs is what the program makes, to its last digit.
#[test]
fn the_table_of_shapes_is_that_of_the_docs() {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
    let docs = std::fs::read_to_string(root.join("docs/grains-from-meshes.md")).unwrap();
    let rows: Vec<Vec<f64>> = docs
        .lines()
        .filter(|line| line.starts_with("| "))
        .map(|line| line.split('|').filter_map(|cell| cell.trim().parse().ok()).collect())
        .filter(|row: &Vec<f64>| row.len() == 8)
        .collect();
    assert!(rows.len() >= 8, "the table has a row a setting, found {}", rows.len());
    let mut wrong = Vec::new();
    for row in &rows {
        let shape = made(row[0] as u32, row[1], row[2]);
        let got = [
            (shape.faces, 0.051),
            (shape.scatter_of_volume, 0.0051),
            (shape.elongation, 0.0051),
            (shape.flatness, 0.0051),
            (shape.sphericity, 0.0051),
        ];
        for ((got, tolerance), expected) in got.into_iter().zip(&row[3..]) {
            if !((got - expected).abs() <= tolerance) {
                wrong.push(format!(
                    "row {row:?} of the docs: expected {expected}, got {got} ± {tolerance} of {shape:?}"
                ));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    let by = |steps: f64, e: f64| {
        rows.iter().find(|r| r[0] == steps && r[1] == e && r[2] == 1.0).unwrap()
    };
    assert!(by(50.0, 1.0)[4] < by(0.0, 1.0)[4] / 2.0, "relaxed cells are more alike in volume");
    assert!(by(50.0, 1.0)[7] > by(0.0, 1.0)[7], "and rounder");
    assert!(by(0.0, 2.0)[5] > 1.3 * by(0.0, 1.0)[5], "stretched cells are longer");
}
