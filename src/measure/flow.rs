//! Mass that passes an opening.

/// Mean rate of a flow between the moments at which a tenth and nine tenths of all had passed:
/// of masses passed since the moment before, and moments. `None` where nothing has passed, or both
/// lie between the same two moments: how long that took is not known.
///
/// In between those moments masses grow along straight lines.
pub fn steady_rate(series: &[(f64, f64)]) -> Option<f64> {
    let total: f64 = series.iter().map(|(_, mass)| mass).sum();
    if !(total > 0.0) {
        return None;
    }
    let when = |share: f64| {
        let mut sum = 0.0;
        series.windows(2).enumerate().find_map(|(interval, pair)| {
            let (before, (time, mass)) = (pair[0].0, pair[1]);
            let reached = sum + mass >= share * total && mass > 0.0;
            let at = before + (time - before) * (share * total - sum) / mass;
            sum += mass;
            reached.then_some((interval, at))
        })
    };
    let ((first, from), (last, to)) = (when(0.1)?, when(0.9)?);
    (last > first && to > from).then(|| 0.8 * total / (to - from))
}

#[cfg(test)]
mod tests {
    use super::super::testing::{DENSITY, assert_near, cube, specimen_of};
    use super::*;
    use crate::geometry::{Pose, Vector};
    use crate::specimen::{Fate, Opening, centroids};

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

    /// Law: a grain that was taken away after it passed has passed, once.
    #[test]
    fn a_grain_that_was_taken_away_counts_by_where_it_was_last_seen() {
        let at = |z: f64| Pose::translation(0.1, 0.0, z);
        let before = specimen_of(vec![(cube(0.01), at(0.6)), (cube(0.01), at(0.7))]);
        let mut after = specimen_of(vec![(cube(0.01), at(0.3)), (cube(0.01), at(0.65))]);
        for grain in &mut after.state.bodies {
            grain.fate = Fate::Spilled;
        }
        let got = MOUTH.mass_passed(&centroids(&before), &after);
        assert_near("1 cm³ of grains", 1e-6 * DENSITY, got, 1e-15);
        assert_eq!(MOUTH.mass_passed(&centroids(&after), &after), 0.0, "law: no second time");
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

    /// Law: what passes between two samples, as a single grain does, took no longer than their
    /// interval: a rate would be that of the sampling.
    #[test]
    fn what_passes_between_two_samples_has_no_rate() {
        for interval in [0.08, 0.01] {
            let at = |n: u32| interval * f64::from(n);
            let one = [(at(0), 0.0), (at(1), 0.0), (at(2), 1.0), (at(3), 0.0)];
            assert_eq!(steady_rate(&one), None, "law: one grain, looked at every {interval} s");
            let two = [(at(0), 0.0), (at(1), 1.0), (at(2), 1.0), (at(3), 0.0)];
            // From a fifth of the first interval to four fifths of the second.
            let expected = 0.8 * 2.0 / (1.6 * interval);
            assert_near("two intervals", expected, steady_rate(&two).expect("a rate"), 1e-9);
        }
    }
}
