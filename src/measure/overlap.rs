//! How much grains overlap, measured outside any engine.

use super::*;

/// Penetration depth of the overlapping pairs of grains.
///
/// Shares are depth over the mean of the two grains' equivalent diameters.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct OverlapStatistics {
    /// Number of overlapping pairs.
    pub overlapping: usize,
    /// Mean share over the overlapping pairs; 0 when there are none.
    pub mean: f64,
    /// 99th percentile of the shares by nearest rank, over the overlapping pairs.
    pub p99: f64,
    /// Largest share.
    pub max: f64,
    /// Largest depth in m.
    pub max_depth: f64,
}

/// Sums up the overlaps among `pairs`, as [`super::pairs_within`] finds them.
pub fn overlap_statistics(specimen: &Specimen, pairs: &[PairGap]) -> OverlapStatistics {
    let grains = &specimen.grains.grains;
    let overlapping = || pairs.iter().filter(|p| p.gap < 0.0);
    let shares: Vec<f64> = overlapping()
        .map(|p| {
            let mean = (grains[p.a].equivalent_diameter + grains[p.b].equivalent_diameter) / 2.0;
            -p.gap / mean
        })
        .collect();
    OverlapStatistics {
        overlapping: shares.len(),
        mean: statistics::mean(&shares).unwrap_or(0.0),
        p99: statistics::percentile(&shares, 99.0).unwrap_or(0.0),
        max: shares.iter().copied().fold(0.0, f64::max),
        max_depth: overlapping().map(|p| -p.gap).fold(0.0, f64::max),
    }
}

#[cfg(test)]
mod tests {
    use super::super::{
        pairs_within,
        testing::{assert_near, cube, specimen_of},
    };
    use super::*;

    const TOUCHING_GAP: f64 = 1e-4;
    use crate::geometry::Pose;

    /// Law: a tower of cubes of 10, 10, 20 and 10 mm, overlapping by 0.1 and
    /// 0.4 mm and touching across 0.05 mm: depth over mean equivalent
    /// diameter, which for a cube is (6/π)^⅓ times its side.
    #[test]
    fn tower_of_cubes() {
        let place = |side, z| (cube(side), Pose::translation(0.0, 0.0, z));
        let specimen = specimen_of(vec![
            place(0.01, 0.0),
            place(0.01, 0.0099),
            place(0.02, 0.0245),
            place(0.01, 0.03955),
        ]);
        let pairs = pairs_within(&specimen, &[0, 1, 2, 3], TOUCHING_GAP);
        let got = overlap_statistics(&specimen, &pairs);
        let equivalent = (6.0 / std::f64::consts::PI).cbrt();
        let shares = [1e-4 / (0.01 * equivalent), 4e-4 / (0.015 * equivalent)];
        assert_eq!((pairs.len(), got.overlapping), (3, 2));
        assert_near("mean share", (shares[0] + shares[1]) / 2.0, got.mean, 1e-13);
        assert_near("99th of two is the larger", shares[1], got.p99, 1e-13);
        assert_near("largest share", shares[1], got.max, 1e-13);
        assert_near("largest depth", 4e-4, got.max_depth, 1e-15);
    }

    /// Largest share and largest depth may belong to different pairs, and the
    /// 99th percentile is not the largest of 200.
    #[test]
    fn percentile_and_maxima() {
        let place = |side| (cube(side), Pose::identity());
        let specimen = specimen_of(vec![place(0.01), place(0.01), place(0.1), place(0.1)]);
        let mut pairs = vec![PairGap { a: 2, b: 3, gap: -5e-4 }];
        pairs.extend((1..=199).map(|k| PairGap { a: 0, b: 1, gap: -1e-6 * f64::from(k) }));
        let got = overlap_statistics(&specimen, &pairs);
        let diameter = specimen.grains.grains[0].equivalent_diameter;
        assert_near("largest depth", 5e-4, got.max_depth, 0.0);
        assert_near("largest share", 199e-6 / diameter, got.max, 1e-15);
        // 200 shares, rank 198; the deep pair of large grains ranks about 50th.
        assert_near("99th percentile", 197e-6 / diameter, got.p99, 1e-15);
    }

    #[test]
    fn no_pairs() {
        let specimen = specimen_of(vec![]);
        assert_eq!(overlap_statistics(&specimen, &[]), OverlapStatistics::default());
    }
}
