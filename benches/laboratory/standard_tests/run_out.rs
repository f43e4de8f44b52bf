//! How high a column stands, and how far it has run out once it has collapsed.

use pluvia::{
    measure::{Container, HeightMap, MeasureError, statistics::mean},
    specimen::Specimen,
};

/// More in m than any column is high.
const TALL: f64 = 1.0;

/// Mean height in m of the surface of a column in a tube of `radius` (m), no nearer to the tube
/// than `margin` (m): there the surface falls off to where grains touch the tube. Grains that lie
/// there still count with what they cover of the rest. `cell` is the side in m of the cells that
/// are read.
///
/// # Errors
/// As [`HeightMap::of`].
pub fn column_height(
    column: &Specimen,
    radius: f64,
    margin: f64,
    cell: f64,
) -> Result<f64, MeasureError> {
    let tube = Container { centre_x: 0.0, radius, height: TALL };
    let map = HeightMap::of(column, &tube, cell)?;
    let middle = (map.across() - 1) as f64 / 2.0;
    let place = |n: usize| map.cell() * (n as f64 - middle);
    let mut heights = Vec::new();
    for j in 0..map.across() {
        let within = |i: &usize| place(*i).hypot(place(j)) <= radius - margin;
        heights.extend((0..map.across()).filter(within).filter_map(|i| map.height(i, j)));
    }
    Ok(mean(&heights).unwrap_or(0.0))
}

/// Distance from the axis in m at which the centroids of a deposit end: the outermost at which rings of one grain's
/// width are still covered to `share`, on straight lines between the middles of rings.
///
/// `distances` are those of the grains' centroids from the axis in m, `size` their diameter. The
/// covered share of a ring is the area of as many circles of that diameter as grains lie in it,
/// over its own. Grains that have rolled further one by one cover less. `None` where no ring is
/// covered so far.
pub fn deposit_edge(distances: &[f64], size: f64, share: f64) -> Option<f64> {
    let furthest = distances.iter().copied().fold(0.0, f64::max);
    let mut counts = vec![0_u32; (furthest / size) as usize + 2];
    for distance in distances {
        counts[(distance / size) as usize] += 1;
    }
    // π d²/4 over π d² ((n + 1)² − n²).
    let covered = |n: usize| f64::from(counts[n]) / (4.0 * (2 * n + 1) as f64);
    let last = (0..counts.len() - 1).rev().find(|n| covered(*n) >= share)?;
    let (here, beyond) = (covered(last), covered(last + 1));
    Some(size * (last as f64 + 0.5 + (here - share) / (here - beyond)))
}

/// Run-out (r∞ − r₀)/r₀ of a column of aspect ratio a = h₀/r₀ as Lube et al. (2004) state it:
/// 1.24 a below 1.7, 1.6 √a above.
pub fn run_out_of_lube(aspect: f64) -> f64 {
    if aspect < 1.7 { 1.24 * aspect } else { 1.6 * aspect.sqrt() }
}

/// Run-out of a column whose deposit has a slope (a tangent) all around and the column's volume: a
/// truncated cone with the column's height, or a cone where that is lower. It is what volume alone
/// makes of an angle of repose, without the run-up of a fall.
pub fn run_out_of_slope(aspect: f64, slope: f64) -> f64 {
    // How far the flank reaches, over r₀.
    let flank = aspect / slope;
    let radius = if flank * flank <= 3.0 {
        (flank + (4.0 - flank * flank / 3.0).sqrt()) / 2.0
    } else {
        (3.0 * flank).cbrt()
    };
    radius - 1.0
}

#[cfg(test)]
mod tests {
    use std::{f64::consts::SQRT_2, sync::Arc};

    use pluvia::{
        geometry::{ConvexPolyhedron, Pose, Vector},
        grains::{Grain, GrainSet},
        specimen::{Fate, GrainState, SpecimenState},
        world::BodyState,
    };

    use super::*;

    /// Where the two laws meet: 1.24 a = 1.6 √a.
    const MEETING: f64 = (1.6 / 1.24) * (1.6 / 1.24);

    /// Grains in the middles of rings of 10 mm, as many as cover the given shares.
    fn rings(shares: &[f64]) -> Vec<f64> {
        let ring = |(n, share): (usize, &f64)| {
            let count = (share * 4.0 * (2 * n + 1) as f64).round() as usize;
            vec![0.01 * (n as f64 + 0.5); count]
        };
        shares.iter().enumerate().flat_map(ring).collect()
    }

    /// Boxes at rest by their sides and middles in m.
    fn boxes(of: &[([f64; 3], [f64; 3])]) -> Specimen {
        let grain = |(sides, _): &([f64; 3], [f64; 3])| {
            let shape = ConvexPolyhedron::cuboid(Vector::from(*sides)).expect("a box");
            let (volume, equivalent_diameter) =
                (shape.signed_volume(), shape.equivalent_diameter());
            Grain {
                shape: Arc::new(shape),
                pose_in_block: Pose::identity(),
                volume,
                mass: 2650.0 * volume,
                inertia: Vector::repeat(1.0),
                equivalent_diameter,
                fraction: 0,
            }
        };
        let body = |(_, [x, y, z]): &([f64; 3], [f64; 3])| GrainState {
            body: BodyState::at_rest(Pose::translation(*x, *y, *z)),
            fate: Fate::Present,
        };
        let (grains, bodies) = (of.iter().map(grain).collect(), of.iter().map(body).collect());
        let grains = GrainSet { grains, blocks: Vec::new(), density: 2650.0, meshes: Vec::new() };
        let state = SpecimenState { bodies, ..SpecimenState::default() };
        Specimen { grains: Arc::new(grains), state }
    }

    /// Law: a grain in the margin of a tube counts with what it covers of the rest, and a grain
    /// that covers none of it does not.
    #[test]
    fn a_column_is_as_high_as_what_covers_it_away_from_its_tube() {
        let floor = ([0.2, 0.2, 0.03], [0.0, 0.0, 0.015]);
        // Over half of the tube; its middle lies in the margin, from 45.5 mm on.
        let half = ([0.0955, 0.2, 0.06], [0.048, 0.0, 0.03]);
        let pin = ([0.002, 0.002, 0.002], [-0.048, 0.0, 0.09]);
        for (column, expected) in [
            (&[floor][..], 0.03),
            (&[floor, pin][..], 0.03),
            (&[floor, half][..], 0.045),
            (&[floor, half, pin][..], 0.045),
        ] {
            let got = column_height(&boxes(column), 0.05, 0.0045, 1e-3).expect("a height");
            let off = (got - expected).abs();
            let count = column.len();
            assert!(off < 3e-4, "law: of {count} boxes {expected} m, got {got}, tolerance 3e-4");
        }
    }

    #[test]
    fn a_deposit_ends_where_rings_are_covered_to_the_share() {
        let mut shares = vec![2.0; 4];
        shares.extend([1.0, 0.25, 0.25]);
        // From 1 in the ring about 45 mm to 0.25 in that about 55 mm.
        let got = deposit_edge(&rings(&shares), 0.01, 0.5).expect("an edge");
        let expected = 0.01 * (4.5 + 0.5 / 0.75);
        assert!((got - expected).abs() < 1e-12, "law: {expected} m, got {got}, tolerance 1e-12");
        // What has rolled on alone does not move it.
        let mut rolled = rings(&shares);
        rolled.extend([0.151, 0.222, 0.3]);
        assert_eq!(deposit_edge(&rolled, 0.01, 0.5), Some(got), "law: single grains do not count");
        assert_eq!(deposit_edge(&rolled[rolled.len() - 3..], 0.01, 0.5), None, "law: no deposit");
        assert_eq!(deposit_edge(&[], 0.01, 0.5), None, "law: no grains");
    }

    #[test]
    fn a_deposit_with_a_slope_has_the_volume_of_its_column() {
        for (aspect, slope) in [(0.56, 0.93), (1.2, 0.93), (2.4, 0.6), (3.7, 0.93), (0.1, 2.0)] {
            let radius = 1.0 + run_out_of_slope(aspect, slope);
            // The plateau on top, or none; volumes over π r₀³.
            let top = (radius - aspect / slope).max(0.0);
            let height = slope * (radius - top);
            let got = height * (radius * radius + radius * top + top * top) / 3.0;
            assert!(
                (got - aspect).abs() < 1e-12,
                "law: a = {aspect}, slope {slope}: the volume is {aspect}, got {got}, tolerance 1e-12"
            );
        }
        assert!(run_out_of_slope(1.0, 1e9) < 1e-8, "law: a wall stays where it is");
    }

    #[test]
    fn the_two_laws_of_lube_meet_near_their_bend() {
        assert!((run_out_of_lube(1.0) - 1.24).abs() < 1e-12, "law: 1.24 a");
        assert!((run_out_of_lube(4.0) - 3.2).abs() < 1e-12, "law: 1.6 √a");
        assert!((run_out_of_lube(2.0) - 1.6 * SQRT_2).abs() < 1e-12, "law: 1.6 √a above 1.7");
        assert!((MEETING - 1.7).abs() < 0.05, "law: they meet at {MEETING}, near 1.7");
    }
}
