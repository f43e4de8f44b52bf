//! The virtual sieve, and the table `sieve.csv`.

use std::io::Write;

use nalgebra::{Quaternion, UnitQuaternion};

use super::{
    GrainSet, GrainsError,
    psd::ParticleSizeDistribution,
    streams::{rotation, stream},
};
use crate::{
    geometry::{ConvexPolyhedron, Vector},
    units::{to_cm3, to_g, to_mm},
};

/// Orientations tried before the best are refined.
const ORIENTATIONS: usize = 160;

/// Orientations refined.
const REFINED: usize = 4;

/// Side in m of the smallest square opening that a grain passes, moving
/// straight in its best orientation: the smallest, over all pairs of
/// perpendicular directions, of the larger of the grain's two widths.
///
/// Found by a search that always takes the same path; the result is never too
/// small, and for grains like Voronoi cells less than a percent too large.
pub fn sieve_size(shape: &ConvexPolyhedron) -> f64 {
    let opening =
        |q: &UnitQuaternion<f64>| width(shape, q * Vector::x()).max(width(shape, q * Vector::y()));
    let mut rng = stream(0, "orientations of the virtual sieve");
    let mut starts: Vec<(f64, UnitQuaternion<f64>)> = std::iter::once(UnitQuaternion::identity())
        .chain((0..ORIENTATIONS).map(|_| rotation(&mut rng)))
        .map(|q| (opening(&q), q))
        .collect();
    starts.sort_by(|a, b| a.0.total_cmp(&b.0));
    starts.truncate(REFINED);
    for (best, at) in &mut starts {
        // Half the angle of a step: that of a quaternion's vector part.
        let mut step = 0.1;
        while step > 2e-4 {
            let before = *best;
            for _ in 0..4 {
                // Random axes: a fixed set stalls in the creases where the two
                // widths are equal.
                let axis = rotation(&mut rng) * Vector::z();
                for signed in [step, -step] {
                    let turn = Quaternion::from_parts(1.0, axis * signed);
                    let q = *at * UnitQuaternion::new_normalize(turn);
                    let value = opening(&q);
                    if value < *best {
                        (*best, *at) = (value, q);
                    }
                }
            }
            if *best >= before {
                step /= 2.0;
            }
        }
    }
    starts.iter().map(|s| s.0).fold(f64::INFINITY, f64::min)
}

/// Extent of a polyhedron along a unit direction, in m.
fn width(shape: &ConvexPolyhedron, direction: Vector) -> f64 {
    let (low, high) = shape
        .vertices()
        .iter()
        .map(|v| v.coords.dot(&direction))
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), d| (low.min(d), high.max(d)));
    high - low
}

/// Writes `sieve.csv`: a row a fraction, with what the sieve table asks for
/// and what the generated grains weigh.
///
/// # Errors
/// When writing fails, or the grains have not as many blocks as the
/// distribution has fractions.
pub fn sieve_csv(
    psd: &ParticleSizeDistribution,
    grains: &GrainSet,
    into: impl Write,
) -> Result<(), GrainsError> {
    let (fractions, blocks) = (psd.fractions.len(), grains.blocks.len());
    if fractions != blocks {
        return Err(GrainsError::BadBlock {
            block: fractions.min(blocks),
            reason: format!("there are {blocks} blocks for {fractions} sieve fractions"),
        });
    }
    let mut csv = csv::Writer::from_writer(into);
    csv.write_record([
        "passing_mm",
        "retained_mm",
        "mass_percent",
        "mass_g",
        "solids_volume_cm3",
        "mean_size_mm",
        "grains",
        "generated_mass_g",
        "cube_side_mm",
    ])?;
    for (index, (fraction, block)) in psd.fractions.iter().zip(&grains.blocks).enumerate() {
        let own = || grains.grains.iter().filter(|g| g.fraction == index);
        let generated: f64 = own().map(|g| g.mass).sum();
        csv.write_record([
            to_mm(fraction.passing).to_string(),
            to_mm(fraction.retained).to_string(),
            format!("{:.4}", fraction.mass_percent),
            format!("{:.4}", to_g(fraction.mass)),
            format!("{:.4}", to_cm3(fraction.volume)),
            to_mm(fraction.mean_size).to_string(),
            own().count().to_string(),
            format!("{:.4}", to_g(generated)),
            format!("{:.4}", to_mm(block.side)),
        ])?;
    }
    csv.flush()?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        geometry::{Point, Pose},
        grains::{generate, tests::few_grains},
    };

    #[test]
    fn sieve_sizes_of_known_bodies() {
        let cuboid = |x, y, z| ConvexPolyhedron::cuboid(Vector::new(x, y, z)).unwrap();
        let tetrahedron = ConvexPolyhedron::new(
            vec![
                Point::new(1.0, 1.0, 1.0),
                Point::new(1.0, -1.0, -1.0),
                Point::new(-1.0, 1.0, -1.0),
                Point::new(-1.0, -1.0, 1.0),
            ],
            vec![vec![0, 1, 2], vec![0, 3, 1], vec![0, 2, 3], vec![1, 3, 2]],
        )
        .unwrap();
        let mut rng = stream(1, "test of the virtual sieve");
        for (name, body, expected) in [
            ("cube of side 1", cuboid(1.0, 1.0, 1.0), 1.0),
            ("brick 0.8 × 1 × 2, endways", cuboid(2.0, 0.8, 1.0), 1.0),
            // A thin plate passes along the diagonal of the opening.
            ("plate 0.1 × 1 × 2", cuboid(0.1, 1.0, 2.0), 1.1 / 2.0_f64.sqrt()),
            // Its least width is the distance of opposite edges, and the
            // projection along the third such axis is a square of that side.
            ("regular tetrahedron in a cube of side 2", tetrahedron, 2.0),
        ] {
            for turn in [UnitQuaternion::identity(), rotation(&mut rng)] {
                let turned = body.transformed(&Pose::from_parts([0.3, 0.0, -0.2].into(), turn));
                turned.sanity_check().unwrap();
                let got = sieve_size(&turned);
                assert!(
                    got > expected * (1.0 - 1e-9) && got < expected * 1.01,
                    "sieve size of a {name}: expected {expected} to 1 % more, got {got}"
                );
            }
        }
    }

    #[test]
    fn the_table_has_units_and_the_generated_mass() {
        let spec = few_grains();
        let psd = ParticleSizeDistribution::new(&spec).unwrap();
        let grains = generate(&spec, 1).unwrap();
        let mut bytes = Vec::new();
        sieve_csv(&psd, &grains, &mut bytes).unwrap();
        let mut csv = csv::Reader::from_reader(&bytes[..]);
        let header = csv.headers().unwrap().iter().collect::<Vec<_>>().join(",");
        assert_eq!(
            header,
            "passing_mm,retained_mm,mass_percent,mass_g,solids_volume_cm3,mean_size_mm,grains,\
             generated_mass_g,cube_side_mm"
        );
        let rows: Vec<_> = csv.records().map(Result::unwrap).collect();
        assert_eq!(rows.len(), spec.sieve_table.len(), "a row a fraction");
        let sum =
            |column: usize| -> f64 { rows.iter().map(|r| r[column].parse::<f64>().unwrap()).sum() };
        for (name, column, expected) in
            [("mass", 3, spec.total_mass_g), ("generated mass", 7, spec.total_mass_g)]
        {
            let got = sum(column);
            assert!((got - expected).abs() < 1e-3, "{name}: expected {expected} g, got {got} g");
        }
        assert_eq!(sum(6) as usize, grains.grains.len(), "number of grains");
        let mut one_less = grains.clone();
        one_less.blocks.pop();
        assert!(sieve_csv(&psd, &one_less, Vec::new()).is_err(), "a block is missing");
    }
}
