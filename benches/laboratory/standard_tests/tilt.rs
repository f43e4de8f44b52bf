//! A box of grains that is tilted: when they begin to slide. A drum of grains that turns: how far
//! they are carried up.

use super::mean_of;

/// A moment of a box that is turned about a level axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tilted {
    /// How far the box is tilted, in rad.
    pub tilt: f64,
    /// Level distance in m of the grains' centre of mass from the axis, positive downhill.
    pub downhill: f64,
}

/// A piece of a box at a sample, and the load of the grains on it since the sample before.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Borne {
    /// Where its origin is, along x and up, in m.
    pub at: [f64; 2],
    /// Mean force in N along x and up.
    pub force: [f64; 2],
    /// Mean moment in N m about its origin, about y.
    pub moment: f64,
}

impl Tilted {
    /// Half way between two samples of pieces that turn about a level axis, along y through
    /// (`axis` m, 0), the first of which began at the origin: mean loads belong to the mean of the
    /// tilts and of the places, not to those at the end. Grains press down with their weight
    /// alone, so that their centre of mass lies where the moment over it says.
    pub fn between(before: &[Borne], now: &[Borne], axis: f64) -> Self {
        let tilt = |pieces: &[Borne]| pieces[0].at[1].atan2(axis - pieces[0].at[0]);
        let [mut moment, mut down] = [0.0; 2];
        for (before, now) in before.iter().zip(now) {
            let middle = |n: usize| 0.5 * (before.at[n] + now.at[n]);
            // (r × F) about y.
            moment += now.moment + middle(1) * now.force[0] - middle(0) * now.force[1];
            down -= now.force[1];
        }
        Self { tilt: 0.5 * (tilt(before) + tilt(now)), downhill: moment / down - axis }
    }
}

/// Tilt in rad at which grains have slid by `slid` m along the floor on average: where their centre
/// of mass lies so much further downhill than it would if it turned with the box.
///
/// Up to a tilt of `rigid` rad it does turn with the box: s cos θ + h sin θ, with s along the floor
/// and h above it, fitted by least squares. Between moments it moves along a straight line. `None`
/// where they have not slid so far, or there are less than three moments to fit.
pub fn sliding_tilt(moments: &[Tilted], rigid: f64, slid: f64) -> Option<f64> {
    let (along, above) = place(&moments[..moments.partition_point(|m| m.tilt <= rigid)])?;
    let slid_at = |m: &Tilted| (m.downhill - above * m.tilt.sin()) / m.tilt.cos() - along;
    moments.windows(2).find_map(|pair| {
        let (a, b) = (slid_at(&pair[0]), slid_at(&pair[1]));
        (a < slid && b >= slid)
            .then(|| pair[0].tilt + (pair[1].tilt - pair[0].tilt) * (slid - a) / (b - a))
    })
}

/// Where a centre of mass is that turns with the box: along the floor and above it, in m.
fn place(moments: &[Tilted]) -> Option<(f64, f64)> {
    let sum = |of: fn(f64, f64, f64) -> f64| -> f64 {
        moments.iter().map(|m| of(m.tilt.cos(), m.tilt.sin(), m.downhill)).sum()
    };
    let (cc, cs, ss) = (sum(|c, _, _| c * c), sum(|c, s, _| c * s), sum(|_, s, _| s * s));
    let (cx, sx) = (sum(|c, _, x| c * x), sum(|_, s, x| s * x));
    let determinant = cc * ss - cs * cs;
    let known = moments.len() >= 3 && determinant > 1e-12 * cc * cc;
    known.then(|| ((cx * ss - sx * cs) / determinant, (sx * cc - cx * cs) / determinant))
}

/// A sample of a drum that turns about a level axis through the origin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Turned {
    /// Time in s since it began to turn.
    pub time: f64,
    /// Mean moment in N m of the grains about the axis since the sample before.
    pub moment: f64,
    /// Potential energy of the grains in J above the axis.
    pub energy: f64,
}

/// Mean angle in rad by which the centre of mass of grains in a drum is carried up, over intervals
/// between samples that lie between two times in s. Its level distance from the axis is the moment
/// over the weight, its height the energy over the weight, half way between samples as the moment
/// is. `None` without such an interval, or where a number is missing.
pub fn carried_up(samples: &[Turned], from: f64, to: f64) -> Option<f64> {
    let within = samples.windows(2).filter(|pair| pair[0].time >= from && pair[1].time <= to);
    let angle = |pair: &[Turned]| {
        let energy = 0.5 * (pair[0].energy + pair[1].energy);
        pair[1].moment.abs().atan2(-energy)
    };
    let mean = mean_of(within.map(angle));
    mean.is_finite().then_some(mean)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A box turned to 60°, whose grains slide by 1 mm a degree from some degrees on.
    fn box_of(above: f64, from: f64) -> Vec<Tilted> {
        (0..=120_u32)
            .map(|n| {
                let degrees = 0.5 * f64::from(n);
                let tilt = degrees.to_radians();
                let slid = 0.001 * (degrees - from).max(0.0);
                Tilted { tilt, downhill: (-0.07 + slid) * tilt.cos() + above * tilt.sin() }
            })
            .collect()
    }

    #[test]
    fn grains_that_turn_with_the_box_do_not_slide() {
        let rigid = 10f64.to_radians();
        assert_eq!(sliding_tilt(&box_of(0.03, 90.0), rigid, 1e-6), None, "law: a rigid turn");
        assert_eq!(sliding_tilt(&[], rigid, 1e-3), None, "law: no box");
        let level = [Tilted { tilt: 0.0, downhill: 0.1 }; 9];
        assert_eq!(sliding_tilt(&level, rigid, 1e-3), None, "law: a level box tells no height");
    }

    #[test]
    fn the_tilt_is_that_at_which_they_have_slid_so_far() {
        for above in [0.02, 0.05] {
            for (slid, expected) in [(0.001, 36.0), (0.0025, 37.5), (0.0035, 38.5)] {
                let got = sliding_tilt(&box_of(above, 35.0), 10f64.to_radians(), slid);
                let got = got.expect("they slide").to_degrees();
                assert!(
                    (got - expected).abs() < 1e-6,
                    "law: {slid} m slid at {expected}°, got {got}°, tolerance 1e-6"
                );
            }
        }
    }

    /// Samples of a box of two pieces, every 0.96° up to 50°: grains of 5 N as in [`box_of`], their
    /// loads means over the interval before.
    fn samples(above: f64, from: f64, axis: f64) -> Vec<[Borne; 2]> {
        let every = 0.96;
        let sample = |n: u32| {
            let at_end = every * f64::from(n);
            let piece = |height: f64, weight: f64| {
                let place = |tilt: f64| {
                    let (sin, cos) = tilt.sin_cos();
                    [axis * (1.0 - cos) + height * sin, axis * sin + height * cos]
                };
                let moment = |part: u32| {
                    let degrees = at_end - every * (f64::from(part) + 0.5) / 100.0;
                    let tilt = degrees.max(0.0).to_radians();
                    let slid = 0.001 * (degrees - from).max(0.0);
                    let downhill = (-0.07 + slid) * tilt.cos() + above * tilt.sin();
                    weight * (axis + downhill - place(tilt)[0])
                };
                let moment = (0..100).map(moment).sum::<f64>() / 100.0;
                Borne { at: place(at_end.to_radians()), force: [0.0, -weight], moment }
            };
            [piece(0.0, 2.0), piece(-0.005, 3.0)]
        };
        (0..=52).map(sample).collect()
    }

    #[test]
    fn loads_that_are_means_belong_to_the_middle_of_their_interval() {
        let axis = 0.06;
        for (slid, expected) in [(0.001, 36.0), (0.0025, 37.5)] {
            let samples = samples(0.03, 35.0, axis);
            let read = |first: usize| -> f64 {
                let between = |pair: &[[Borne; 2]]| Tilted::between(&pair[first], &pair[1], axis);
                let moments: Vec<Tilted> = samples.windows(2).map(between).collect();
                let got = sliding_tilt(&moments, 10f64.to_radians(), slid);
                got.expect("they slide").to_degrees()
            };
            let got = read(0);
            assert!(
                (got - expected).abs() < 0.02,
                "law: {slid} m slid at {expected}° by means over 0.96°, got {got}°, tolerance 0.02°"
            );
            // Taken for those at the end, the same loads are late.
            let late = read(1);
            assert!((late - expected).abs() > 0.2, "law: half of 0.96° late, got {late}°");
        }
    }

    #[test]
    fn a_drum_carries_its_grains_by_the_angle_of_their_centre_of_mass() {
        // 5 N at 50 mm from the axis, carried by 20° at first, by 40° in the middle and by 0° as
        // it slows down, a sample each 0.1 s.
        let at = |degrees: f64, time: f64| {
            let (sin, cos) = degrees.to_radians().sin_cos();
            Turned { time, moment: -5.0 * 0.05 * sin, energy: -5.0 * 0.05 * cos }
        };
        let samples: Vec<Turned> = (0..=40_u32)
            .map(|n| match n {
                0..=10 => at(20.0, 0.1 * f64::from(n)),
                11..=30 => at(40.0, 0.1 * f64::from(n)),
                _ => at(0.0, 0.1 * f64::from(n)),
            })
            .collect();
        let got = carried_up(&samples, 1.15, 2.95).expect("it turns").to_degrees();
        let off = (got - 40.0).abs();
        assert!(off < 1e-9, "law: 40° in the middle, got {got}°, tolerance 1e-9");
        let whole = carried_up(&samples, 0.0, 4.0).expect("it turns").to_degrees();
        assert!((whole - 40.0).abs() > 5.0, "law: other parts would be felt, got {whole}°");
        assert_eq!(carried_up(&samples, 3.0, 3.05), None, "law: no interval");
        let unknown = [Turned { energy: f64::NAN, ..at(40.0, 0.0) }, at(40.0, 0.1)];
        assert_eq!(carried_up(&unknown, 0.0, 1.0), None, "law: no energy, no height");
    }
}
