//! Loaded contacts of a specimen: who presses whom, how hard, in which direction, and whether
//! they slide.

use std::collections::HashMap;

use nalgebra::Matrix3;

use super::*;

/// Share of the friction limit from which on a contact point slides: below it forces of single
/// precision cannot be told from the limit.
const SLIDING: f64 = 0.999;

/// Width of the classes of [`ForceDistribution::classes`], in means.
pub const FORCE_CLASS: f64 = 0.25;

/// Number of these classes at most; the last then holds all that is beyond.
const CLASSES: usize = 200;

/// Two bodies that press each other, at one point or several.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LoadedContact {
    /// The two.
    pub between: [Party; 2],
    /// Where: mean of the points, weighted by their normal forces, in m.
    pub point: Vector,
    /// Unit normal from the second to the first, of all points together.
    pub normal: Vector,
    /// Normal force in N, of all points together.
    pub normal_force: f64,
    /// Whether every point of it bears as much friction as it can.
    pub slides: bool,
}

impl LoadedContact {
    /// Whether both are grains.
    pub fn is_of_grains(&self) -> bool {
        self.between.iter().all(|party| matches!(party, Party::Grain(_)))
    }
}

/// The contacts of which at least one side is a grain, in the order in which they first appear;
/// `friction` is the coefficient between two parties.
pub fn loaded_contacts(
    contacts: &[SavedContact],
    friction: impl Fn(&[Party; 2]) -> f64,
) -> Vec<LoadedContact> {
    let mut number: HashMap<[Party; 2], usize> = HashMap::new();
    // Until all points are in, `point` and `normal` are sums, weighted by the normal forces.
    let mut sums: Vec<LoadedContact> = Vec::new();
    for contact in contacts {
        let normal_force = contact.force_n.dot(&contact.normal);
        let grains = contact.between.iter().any(|party| matches!(party, Party::Grain(_)));
        // Written so that what is no number does not press.
        if !(normal_force > 0.0) || !grains {
            continue;
        }
        let [a, b] = contact.between;
        let (known, sign) = match number.get(&[b, a]) {
            Some(&known) => (known, -1.0),
            None => (*number.entry([a, b]).or_insert(sums.len()), 1.0),
        };
        if known == sums.len() {
            let (point, normal) = (Vector::zeros(), Vector::zeros());
            let between = [a, b];
            sums.push(LoadedContact { between, point, normal, normal_force: 0.0, slides: true });
        }
        let tangential = (contact.force_n - contact.normal * normal_force).norm();
        let sum = &mut sums[known];
        sum.point += contact.point_m * normal_force;
        sum.normal += contact.normal * (sign * normal_force);
        sum.normal_force += normal_force;
        sum.slides &= tangential >= SLIDING * friction(&contact.between) * normal_force;
    }
    let done = sums.into_iter().filter_map(|sum| {
        let normal_force = sum.normal.norm();
        let (point, normal) = (sum.point / sum.normal_force, sum.normal / normal_force);
        // Points that press against each other have no normal in common.
        (normal_force > 0.0).then_some(LoadedContact { point, normal, normal_force, ..sum })
    });
    done.collect()
}

/// Share of contacts that slide, from 0 to 1; `None` without contacts.
pub fn sliding_share<'a>(contacts: impl IntoIterator<Item = &'a LoadedContact>) -> Option<f64> {
    let (slide, all) = contacts
        .into_iter()
        .fold((0_u32, 0_u32), |(slide, all), c| (slide + u32::from(c.slides), all + 1));
    (all > 0).then(|| f64::from(slide) / f64::from(all))
}

/// How normal forces are distributed about their mean.
#[derive(Debug, Clone, PartialEq)]
pub struct ForceDistribution {
    /// Their mean in N.
    pub mean: f64,
    /// 10th, 50th, 90th and 99th percentile and the largest, over the mean (nearest rank).
    pub percentiles: [f64; 5],
    /// Share of contacts in classes of [`FORCE_CLASS`] means, from 0 up to the largest force, or to
    /// 50 means, where the last class holds all that is beyond. Together 1.
    pub classes: Vec<f64>,
}

/// Distribution of normal forces in N; `None` without any.
pub fn force_distribution(forces: impl IntoIterator<Item = f64>) -> Option<ForceDistribution> {
    let mut sorted: Vec<f64> = forces.into_iter().collect();
    sorted.sort_by(f64::total_cmp);
    let count = sorted.len() as f64;
    let mean = sorted.iter().sum::<f64>() / count;
    if !(mean > 0.0) {
        return None;
    }
    let rank = |share: f64| (share * count).ceil().max(1.0) as usize - 1;
    let percentiles = [0.1, 0.5, 0.9, 0.99, 1.0].map(|share| sorted[rank(share)] / mean);
    let class = |force: f64| ((force / mean / FORCE_CLASS) as usize).min(CLASSES - 1);
    let mut classes = vec![0.0; class(sorted[sorted.len() - 1]) + 1];
    for &force in &sorted {
        classes[class(force)] += 1.0 / count;
    }
    Some(ForceDistribution { mean, percentiles, classes })
}

/// Fabric: how contact normals are directed (Satake 1982).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fabric {
    /// Number of contacts.
    pub contacts: usize,
    /// Mean of n ⊗ n over their unit normals; its trace is 1, and it is 1/3 of the unit tensor
    /// where no direction is preferred.
    pub tensor: Matrix3<f64>,
}

impl Fabric {
    /// √(3/2 F':F') of its deviator F': 0 where no direction is preferred, 1 where all normals
    /// are parallel.
    pub fn anisotropy(&self) -> f64 {
        let deviator = self.tensor - Matrix3::identity() / 3.0;
        (1.5 * deviator.norm_squared()).sqrt()
    }

    /// Principal values, the largest first.
    pub fn principal(&self) -> [f64; 3] {
        let mut values: [f64; 3] = self.tensor.symmetric_eigenvalues().into();
        values.sort_by(|a, b| b.total_cmp(a));
        values
    }
}

/// Fabric of contacts, each counted once; `None` without any.
pub fn fabric<'a>(contacts: impl IntoIterator<Item = &'a LoadedContact>) -> Option<Fabric> {
    let mut sum = Matrix3::zeros();
    let mut count = 0;
    for contact in contacts {
        sum += contact.normal * contact.normal.transpose();
        count += 1;
    }
    (count > 0).then(|| Fabric { contacts: count, tensor: sum / f64::from(count as u32) })
}

/// The contacts between grains whose point lies in a region.
pub fn contacts_of_grains_in<'a>(
    contacts: &'a [LoadedContact],
    region: &'a Region,
) -> impl Iterator<Item = &'a LoadedContact> {
    contacts.iter().filter(|c| c.is_of_grains() && region.holds(&c.point))
}

#[cfg(test)]
mod tests {
    use super::super::testing::{assert_near, contact};
    use super::*;
    use crate::specimen::Other;

    const FLOOR: Party = Party::Other(Other::Piece(0, 0));

    fn grains(a: usize, b: usize) -> [Party; 2] {
        [Party::Grain(a), Party::Grain(b)]
    }

    fn with(mut contact: SavedContact, normal: Vector) -> SavedContact {
        contact.normal = normal;
        contact
    }

    /// Law: the points of a pair are one contact, whichever of the two is named first.
    #[test]
    fn points_of_a_pair_are_one_contact() {
        let z = Vector::z();
        let contacts = [
            contact(grains(0, 1), Vector::new(0.0, 0.0, 1.0), z),
            contact(grains(1, 0), Vector::new(4.0, 0.0, 1.0), -3.0 * z),
            contact([Party::Grain(0), FLOOR], Vector::zeros(), 2.0 * z),
            // Nothing of the soil: the plate on the wall.
            contact([Party::Other(Other::TopPlate), FLOOR], Vector::zeros(), z),
            // It pulls: no contact presses so.
            with(contact(grains(2, 3), Vector::zeros(), z), -z),
        ];
        let got = loaded_contacts(&contacts, |_| 0.5);
        assert_eq!(got.len(), 2, "law: a pair of grains and a grain on the floor, got {got:?}");
        assert_eq!(got[0].point, Vector::new(3.0, 0.0, 1.0), "law: mean of the points by force");
        assert_eq!((got[0].normal, got[0].normal_force), (z, 4.0));
        assert_eq!((got[0].is_of_grains(), got[1].is_of_grains()), (true, false));
    }

    /// Law: |f_t| ≥ 0.999 μ f_n slides, 0.998 does not; a pair slides where all of its points do.
    #[test]
    fn what_bears_all_the_friction_it_can_slides() {
        let of = |between, share: f64| {
            let force = Vector::new(0.4 * share * 10.0, 0.0, 10.0);
            with(contact(between, Vector::zeros(), force), Vector::z())
        };
        let friction = |between: &[Party; 2]| if between[1] == FLOOR { 0.8 } else { 0.4 };
        let contacts = [
            of(grains(0, 1), 0.9995),
            of(grains(0, 2), 0.998),
            of(grains(0, 3), 1.0),
            of(grains(0, 3), 0.5),
            of([Party::Grain(0), FLOOR], 1.0),
            of(grains(4, 5), 1.0),
            of(grains(4, 5), 0.9999),
        ];
        let got = loaded_contacts(&contacts, friction);
        let slides: Vec<bool> = got.iter().map(|c| c.slides).collect();
        assert_eq!(slides, [true, false, false, false, true]);
        assert_eq!(sliding_share(&got), Some(0.4));
        assert_eq!(sliding_share(&[]), None, "law: no contacts, no share");
    }

    #[test]
    fn forces_are_told_over_their_mean() {
        let got = force_distribution((1..=100).map(f64::from)).expect("forces");
        assert_near("mean of 1 to 100 N", 50.5, got.mean, 1e-12);
        for (got, expected) in got.percentiles.iter().zip([10.0, 50.0, 90.0, 99.0, 100.0]) {
            assert_near("percentile over the mean", expected / 50.5, *got, 1e-12);
        }
        assert_near("all of them", 1.0, got.classes.iter().sum(), 1e-12);
        // 0.25 means are 12.625 N: 12 forces are smaller.
        assert_near("the first class", 0.12, got.classes[0], 1e-12);
        // 100 N are 1.98 means.
        assert_eq!(got.classes.len(), 8, "law: up to the largest force");
        let far = force_distribution([vec![0.0; 99], vec![1.0]].concat()).expect("forces");
        assert_near("a force of 100 means is in the last class", 0.01, far.classes[199], 1e-12);
        assert_eq!(force_distribution([]), None, "law: no forces, no distribution");
    }

    /// Law: normals along the axes of a cubic lattice are isotropic in the mean; all vertical ones
    /// have anisotropy 1; three to one along z and x have F = diag(1/4, 0, 3/4).
    #[test]
    fn fabric_of_lattices() {
        let along = |k: usize| contact(grains(0, 1), Vector::zeros(), Vector::ith(k, 1.0));
        let of = |axes: &[usize]| {
            let each = axes.iter().flat_map(|&k| loaded_contacts(&[along(k)], |_| 0.5));
            fabric(&each.collect::<Vec<_>>())
        };
        let cubic = of(&[0, 1, 2]).expect("contacts");
        assert_near("a cubic lattice", 0.0, cubic.anisotropy(), 1e-12);
        assert_eq!((cubic.contacts, of(&[])), (3, None));
        let column = of(&[2, 2, 2]).expect("contacts");
        assert_near("a column", 1.0, column.anisotropy(), 1e-12);
        let mixed = of(&[2, 0, 2, 2]).expect("contacts");
        for (got, expected) in mixed.principal().iter().zip([0.75, 0.25, 0.0]) {
            assert_near("principal values", expected, *got, 1e-12);
        }
        assert_near("F_zz", 0.75, mixed.tensor[(2, 2)], 1e-12);
    }

    #[test]
    fn a_region_takes_the_contacts_between_grains_in_it() {
        let at = |x: f64, between| contact(between, Vector::new(x, 0.5, 0.5), Vector::z());
        let all = [
            at(0.5, grains(0, 1)),
            at(1.5, grains(1, 2)),
            at(0.5, [Party::Grain(0), FLOOR]),
            at(0.0, grains(2, 3)),
        ];
        let all = loaded_contacts(&all, |_| 0.5);
        let region = Region { low: Vector::zeros(), high: Vector::repeat(1.0) };
        let inside = contacts_of_grains_in(&all, &region);
        assert_eq!(inside.map(|c| c.between).collect::<Vec<_>>(), [grains(0, 1), grains(2, 3)]);
    }
}
