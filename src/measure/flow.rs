//! Mass that passes an opening.

use crate::geometry::Vector;
use crate::specimen::Specimen;

/// A disc that grains pass through, in m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Opening {
    /// Its middle.
    pub middle: Vector,
    /// Its radius.
    pub radius: f64,
    /// Unit vector in which flow counts as positive.
    pub direction: Vector,
}

impl Opening {
    /// 1 where a point went through it in its direction, −1 where it went the other way,
    /// 0 where it did not, on a straight way between two places.
    pub fn passed(&self, before: &Vector, after: &Vector) -> f64 {
        let along = |p: &Vector| self.direction.dot(&(p - self.middle));
        let (a, b) = (along(before), along(after));
        // What begins on the disc is behind it: each crossing counts once.
        if (a >= 0.0) == (b >= 0.0) {
            return 0.0;
        }
        let at = before + (after - before) * (a / (a - b));
        match (at - self.middle).norm() <= self.radius {
            true => (b - a).signum(),
            false => 0.0,
        }
    }

    /// Mass in kg that went through between two looks, by the centroids of the grains;
    /// `before` has their places at the first, of those that were there.
    pub fn mass_passed(&self, before: &[Option<Vector>], specimen: &Specimen) -> f64 {
        let passed = |i: usize| {
            let after = specimen.state.bodies[i].body.pose.translation.vector;
            let before = before.get(i).copied().flatten()?;
            Some(self.passed(&before, &after) * specimen.grains.grains[i].mass)
        };
        specimen.present().filter_map(passed).sum()
    }
}

/// Where the centroids of the grains are that are present, in m.
pub fn centroids(specimen: &Specimen) -> Vec<Option<Vector>> {
    let mut places = vec![None; specimen.state.bodies.len()];
    for i in specimen.present() {
        places[i] = Some(specimen.state.bodies[i].body.pose.translation.vector);
    }
    places
}

/// Mean rate of a flow between the moments at which a tenth and nine tenths of all had passed:
/// of masses passed since the moment before, and moments. `None` where nothing has passed.
///
/// In between those moments masses grow along straight lines.
pub fn steady_rate(series: &[(f64, f64)]) -> Option<f64> {
    let total: f64 = series.iter().map(|(_, mass)| mass).sum();
    if !(total > 0.0) {
        return None;
    }
    let when = |share: f64| {
        let mut sum = 0.0;
        series.windows(2).find_map(|pair| {
            let (before, (time, mass)) = (pair[0].0, pair[1]);
            let reached = sum + mass >= share * total && mass > 0.0;
            let at = before + (time - before) * (share * total - sum) / mass;
            sum += mass;
            reached.then_some(at)
        })
    };
    let (from, to) = (when(0.1)?, when(0.9)?);
    (to > from).then(|| 0.8 * total / (to - from))
}

#[cfg(test)]
mod tests {
    use super::super::testing::{DENSITY, assert_near, cube, specimen_of};
    use super::*;
    use crate::geometry::Pose;

    const MOUTH: Opening = Opening {
        middle: Vector::new(0.1, 0.0, 0.5),
        radius: 0.05,
        direction: Vector::new(0.0, 0.0, -1.0),
    };

    #[test]
    fn only_what_goes_through_the_disc_has_passed_and_its_way_counts() {
        for (from, to, expected) in [
            ([0.1, 0.0, 0.6], [0.1, 0.0, 0.4], 1.0),
            ([0.1, 0.0, 0.4], [0.1, 0.0, 0.6], -1.0),
            ([0.1, 0.0, 0.6], [0.1, 0.0, 0.51], 0.0),
            ([0.1, 0.0, 0.6], [0.1, 0.0, 0.5], 1.0),
            ([0.1, 0.0, 0.5], [0.1, 0.0, 0.4], 0.0),
            ([0.1, 0.06, 0.6], [0.1, 0.06, 0.4], 0.0),
            ([0.1, 0.08, 0.6], [0.1, 0.0, 0.4], 1.0),
            ([0.1, 0.12, 0.6], [0.1, 0.0, 0.4], 0.0),
        ] {
            let got = MOUTH.passed(&Vector::from(from), &Vector::from(to));
            assert_eq!(got, expected, "law: from {from:?} to {to:?} m");
        }
    }

    #[test]
    fn the_mass_is_that_of_the_grains_that_passed() {
        let at = |z: f64| Pose::translation(0.1, 0.0, z);
        let before =
            specimen_of(vec![(cube(0.01), at(0.6)), (cube(0.02), at(0.6)), (cube(0.01), at(0.4))]);
        let after = specimen_of(vec![
            (cube(0.01), at(0.55)),
            (cube(0.02), at(0.45)),
            (cube(0.01), at(0.3)),
        ]);
        let got = MOUTH.mass_passed(&centroids(&before), &after);
        assert_near("8 cm³ of grains", 8e-6 * DENSITY, got, 1e-15);
        assert_eq!(MOUTH.mass_passed(&[], &after), 0.0, "law: who was not there did not pass");
    }

    #[test]
    fn a_steady_flow_has_its_rate_however_it_begins_and_ends() {
        let rows: Vec<(f64, f64)> = (0..=100)
            .map(|n| {
                let time = 0.1 * f64::from(n);
                (time, if (2.0..7.0).contains(&(time - 0.05)) { 0.3 } else { 0.0 })
            })
            .collect();
        assert_near("3 kg/s", 3.0, steady_rate(&rows).expect("a rate"), 1e-9);
        assert_eq!(steady_rate(&[(0.0, 0.0), (1.0, 0.0)]), None, "law: nothing passed");
    }
}
