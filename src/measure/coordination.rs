//! How many neighbours a grain touches.

use std::collections::BTreeMap;

use super::*;

/// Contacts a grain, over the grains looked at.
#[derive(Debug, Clone, PartialEq)]
pub struct Coordination {
    /// Mean number of touching grains a grain; `None` without grains.
    pub mean: Option<f64>,
    /// How many grains touch 0, 1, 2, ... others; it adds up to the number of grains looked at
    /// and ends with the largest number met.
    pub distribution: Vec<usize>,
}

/// Counts the touching neighbours of each of `grains` among `pairs` (from
/// [`super::pairs_within`] over the same grains).
///
/// A pair of bodies counts once, however many points they touch in; contacts
/// with floor, wall, plate and fixed grains of a base do not count, so that the mean of a bed lies
/// below that of its inside. Pairs with a grain not listed are left out.
pub fn coordination(grains: &[usize], pairs: &[PairGap]) -> Coordination {
    let mut contacts: BTreeMap<usize, usize> = grains.iter().map(|&i| (i, 0)).collect();
    for p in pairs {
        if contacts.contains_key(&p.a) && contacts.contains_key(&p.b) {
            for i in [p.a, p.b] {
                *contacts.entry(i).or_default() += 1;
            }
        }
    }
    let counts: Vec<usize> = contacts.into_values().collect();
    let mut distribution = vec![0; counts.iter().max().map_or(0, |m| m + 1)];
    for &n in &counts {
        distribution[n] += 1;
    }
    let total: usize = counts.iter().sum();
    Coordination {
        mean: (!counts.is_empty()).then(|| total as f64 / counts.len() as f64),
        distribution,
    }
}

#[cfg(test)]
mod tests {
    use super::super::{
        pairs_within,
        testing::{cube, specimen_of},
    };
    use super::*;

    const TOUCHING_GAP: f64 = 1e-4;
    use crate::geometry::Pose;

    /// Law: in a row of five touching cubes the ends touch one, the others
    /// two: mean 8/5; a sixth, far off, touches none: mean 8/6.
    #[test]
    fn row_of_cubes() {
        let xs = [0.0, 0.01, 0.02, 0.03, 0.04, 0.2];
        let specimen =
            specimen_of(xs.map(|x| (cube(0.01), Pose::translation(x, 0.0, 0.0))).to_vec());
        let all: Vec<usize> = (0..6).collect();
        let pairs = pairs_within(&specimen, &all, TOUCHING_GAP);
        let got = coordination(&all, &pairs);
        assert_eq!(got.distribution, [1, 2, 3]);
        assert_eq!(got.mean, Some(8.0 / 6.0));
        let row = coordination(&all[..5], &pairs);
        assert_eq!((row.mean, row.distribution), (Some(1.6), vec![0, 2, 3]));
        let cut = coordination(&[0, 1, 3], &pairs);
        assert_eq!(cut.distribution, [1, 2], "pairs with grains not listed are left out");
    }

    /// Law: in a 3 × 3 × 3 block of cubes with edges and corners meeting, the
    /// inner one touches the 26 others.
    #[test]
    fn block_of_cubes() {
        let mut parts = vec![];
        for i in 0..27 {
            let [x, y, z] = [i % 3, i / 3 % 3, i / 9].map(|k| f64::from(k) * 0.01);
            parts.push((cube(0.01), Pose::translation(x, y, z)));
        }
        let specimen = specimen_of(parts);
        let all: Vec<usize> = (0..27).collect();
        let got = coordination(&all, &pairs_within(&specimen, &all, TOUCHING_GAP));
        // Corners touch 7, edges 11, faces 17, the inside 26.
        for (contacts, grains) in [(7, 8), (11, 12), (17, 6), (26, 1)] {
            assert_eq!(got.distribution[contacts], grains, "grains with {contacts} contacts");
        }
        assert_eq!(got.distribution.len(), 27);
    }

    #[test]
    fn no_grains() {
        let got = coordination(&[], &[PairGap { a: 0, b: 1, gap: 0.0 }]);
        assert_eq!(got, Coordination { mean: None, distribution: vec![] });
    }
}
