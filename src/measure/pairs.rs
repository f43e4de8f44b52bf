//! Which grains touch or overlap.

use super::*;

/// Gap in m up to which two grains of a set count as touching.
pub fn touching_gap(grains: &GrainSet) -> f64 {
    grains.of_size(&scale::TOUCHING_GAP)
}

/// Two grains and how far they are apart.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PairGap {
    /// Index of the first grain, the lower one.
    pub a: usize,
    /// Index of the second grain.
    pub b: usize,
    /// Gap in m; negative where they overlap. See [`super::Separation::gap`].
    pub gap: f64,
}

/// All pairs of the given grains with a gap of at most `most` (m), exact for
/// overlaps, in order of their indices.
///
/// For grains apart the gap is that of the separating axis test, a lower bound
/// of the distance: a corner facing a corner may count as touching while
/// somewhat farther away than `most` (at most √3 times for cubes).
pub fn pairs_within(specimen: &Specimen, grains: &[usize], most: f64) -> Vec<PairGap> {
    let hull = |&i: &usize| {
        let (shape, pose) = specimen.placed(i);
        WorldHull::new(shape, pose)
    };
    let hulls: Vec<WorldHull> = grains.iter().map(hull).collect();
    let mut pairs: Vec<PairGap> = pairs_within_of(&hulls, most)
        .into_iter()
        .map(|(i, j, gap)| {
            let (a, b) = (grains[i].min(grains[j]), grains[i].max(grains[j]));
            PairGap { a, b, gap }
        })
        .collect();
    pairs.sort_unstable_by_key(|p| (p.a, p.b));
    pairs
}

/// How many others each grain touches; 0 of those that no longer take part.
pub fn neighbours(specimen: &Specimen) -> Vec<u32> {
    let present: Vec<usize> = specimen.present().collect();
    let mut counts = vec![0; specimen.grains.grains.len()];
    for pair in pairs_within(specimen, &present, touching_gap(&specimen.grains)) {
        counts[pair.a] += 1;
        counts[pair.b] += 1;
    }
    counts
}

/// The same for prepared hulls: (index, index, gap in m), lower index first, in order.
pub fn pairs_within_of(hulls: &[WorldHull], most: f64) -> Vec<(usize, usize, f64)> {
    let mut found: Vec<(usize, usize, f64)> = candidates(hulls, most)
        .into_iter()
        .filter_map(|(i, j)| separation_within(&hulls[i], &hulls[j], most).map(|s| (i, j, s.gap)))
        .collect();
    found.sort_unstable_by_key(|&(i, j, _)| (i, j));
    found
}

/// Pairs whose exact bounding boxes are at most `most` apart along every axis,
/// found by sweeping along the bed's longest side.
fn candidates(hulls: &[WorldHull], most: f64) -> Vec<(usize, usize)> {
    let Some(first) = hulls.first() else { return vec![] };
    let (low, high) =
        hulls.iter().fold((first.low, first.high), |(lo, hi), h| (lo.inf(&h.low), hi.sup(&h.high)));
    let axis = (high - low).imax();
    let mut order: Vec<usize> = (0..hulls.len()).collect();
    order.sort_unstable_by(|&i, &j| {
        hulls[i].low[axis].total_cmp(&hulls[j].low[axis]).then(i.cmp(&j))
    });
    let mut pairs = vec![];
    for (place, &i) in order.iter().enumerate() {
        let a = &hulls[i];
        for &j in &order[place + 1..] {
            let b = &hulls[j];
            if b.low[axis] > a.high[axis] + most {
                break;
            }
            if (0..3).all(|k| a.low[k] <= b.high[k] + most && b.low[k] <= a.high[k] + most) {
                pairs.push((i.min(j), i.max(j)));
            }
        }
    }
    pairs
}

#[cfg(test)]
mod tests {
    use super::super::{
        separation,
        testing::{cube, dense_bed, specimen_of},
    };
    use super::*;

    const TOUCHING_GAP: f64 = 1e-4;
    use crate::geometry::Pose;

    /// Law: the pairs are those that testing everything against everything finds.
    #[test]
    fn nothing_is_lost_in_the_sweep() {
        let specimen = dense_bed(150);
        let grains: Vec<usize> = specimen.present().collect();
        let bodies = &specimen.state.bodies;
        let hull =
            |i: usize| WorldHull::new(&specimen.grains.grains[i].shape, &bodies[i].body.pose);
        for most in [-2e-4, 0.0, TOUCHING_GAP] {
            let mut expected = vec![];
            for &a in &grains {
                for &b in &grains[a + 1..] {
                    let gap = separation(&hull(a), &hull(b)).gap;
                    if gap <= most {
                        expected.push(PairGap { a, b, gap });
                    }
                }
            }
            assert!(expected.len() > 100, "only {} pairs to find", expected.len());
            assert_eq!(pairs_within(&specimen, &grains, most), expected, "gap up to {most}");
        }
    }

    /// Law: the order in which the grains are named changes nothing.
    #[test]
    fn order_does_not_matter() {
        let specimen = dense_bed(60);
        let grains: Vec<usize> = specimen.present().collect();
        let backwards: Vec<usize> = grains.iter().rev().copied().collect();
        let pairs = |list: &[usize]| -> Vec<(usize, usize)> {
            pairs_within(&specimen, list, TOUCHING_GAP).iter().map(|p| (p.a, p.b)).collect()
        };
        assert_eq!(pairs(&grains), pairs(&backwards));
    }

    /// Law: a gap of 0.09 mm touches, one of 0.11 mm does not; grains not named do not count.
    #[test]
    fn touching_has_a_bound() {
        let place = |z| (cube(0.01), Pose::translation(0.0, 0.0, z));
        let specimen = specimen_of(vec![place(0.0), place(0.01009), place(0.0202)]);
        let touching = |list: &[usize]| -> Vec<(usize, usize)> {
            pairs_within(&specimen, list, TOUCHING_GAP).iter().map(|p| (p.a, p.b)).collect()
        };
        assert_eq!(touching(&[0, 1, 2]), [(0, 1)]);
        assert_eq!(touching(&[0, 2]), []);
        assert_eq!(touching(&[]), []);
    }
}
