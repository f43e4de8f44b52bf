//! Where a curve of measured points takes a value.

/// Where a curve takes a value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Crossing {
    /// At this place. Where noise takes the curve across several times, the first place would be
    /// too low and the last one too high: this is the middle one, of an even number the mean of
    /// the middle two, which does not change with how far out the others lie.
    At {
        /// The place.
        place: f64,
        /// At how many places it does.
        times: usize,
    },
    /// At no place.
    Nowhere,
    /// It may, or does, where points are missing.
    Unknown,
}

/// Where a curve takes a value, rising or falling, on straight lines between neighbouring points
/// in the order of their places. A point without a number is missing: no line bridges it. A point
/// alone is no curve.
pub fn crossing(points: &[(f64, Option<f64>)], wanted: f64) -> Crossing {
    if points.len() < 2 {
        return Crossing::Nowhere;
    }
    let mut places = Vec::new();
    let mut is_hidden = false;
    // The number of the point before that is not missing, its place, and how far off it is.
    let mut before: Option<(usize, f64, f64)> = None;
    for (n, (x, y)) in points.iter().enumerate() {
        let Some(off) = y.map(|y| y - wanted) else { continue };
        match before {
            _ if off == 0.0 => places.push(*x),
            Some((last, from, was)) if was * off < 0.0 && last + 1 == n => {
                places.push(from + (x - from) * was / (was - off));
            }
            Some((_, _, was)) if was * off < 0.0 => is_hidden = true,
            _ => {}
        }
        before = Some((n, *x, off));
    }
    let times = places.len();
    let is_missing = points.iter().any(|(_, y)| y.is_none());
    match times {
        _ if is_hidden => Crossing::Unknown,
        0 if is_missing => Crossing::Unknown,
        0 => Crossing::Nowhere,
        _ => Crossing::At { place: 0.5 * (places[(times - 1) / 2] + places[times / 2]), times },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Points at 0.1, 0.2, 0.4, 0.6 and so on.
    fn curve(of: &[Option<f64>]) -> Vec<(f64, Option<f64>)> {
        let place = |n: usize| if n == 0 { 0.1 } else { 0.2 * n as f64 };
        of.iter().enumerate().map(|(n, y)| (place(n), *y)).collect()
    }

    #[test]
    fn a_curve_takes_a_value_where_its_lines_do() {
        let [a, b, c, d] = [20.0, 30.0, 40.0, 35.0].map(Some);
        let missing = None;
        for (points, wanted, expected) in [
            (vec![a, b, c, d], 25.0, Some((0.15, 1))),
            (vec![d, c, b, a], 25.0, Some((0.5, 1))),
            (vec![a, b, c, d], 30.0, Some((0.2, 1))),
            (vec![a, b, c], 40.0, Some((0.4, 1))),
            // 0.36 rising, 0.48 falling.
            (vec![a, b, c, d], 38.0, Some((0.42, 2))),
            // Of 0.15, 0.3 and 0.5 and of these and 0.7 the middle.
            (vec![a, b, a, b], 25.0, Some((0.3, 3))),
            (vec![a, b, a, b, a], 25.0, Some((0.4, 4))),
            // Missing where the curve does not pass the value.
            (vec![missing, a, b, c], 25.0, Some((0.3, 1))),
            (vec![a, b, missing, c], 25.0, Some((0.15, 1))),
            (vec![a, b, missing, c], 30.0, Some((0.2, 1))),
        ] {
            let got = crossing(&curve(&points), wanted);
            let is_near = match (got, expected) {
                (Crossing::At { place, times }, Some((at, count))) => {
                    (place - at).abs() < 1e-12 && times == count
                }
                _ => false,
            };
            assert!(
                is_near,
                "law: {wanted} on lines between neighbours of {points:?}, place and times expected \
                 {expected:?}, got {got:?}, tolerance 1e-12"
            );
        }
    }

    #[test]
    fn a_value_that_is_not_taken_is_told_from_one_that_may_be() {
        let [a, b, c] = [20.0, 30.0, 40.0].map(Some);
        let missing = None;
        for (points, wanted, expected) in [
            (vec![a, b, c], 45.0, Crossing::Nowhere),
            (vec![a, b, c], 10.0, Crossing::Nowhere),
            (vec![c], 40.0, Crossing::Nowhere),
            (vec![], 40.0, Crossing::Nowhere),
            // The chord over a missing point is no line of the curve.
            (vec![a, missing, c], 30.0, Crossing::Unknown),
            (vec![b, missing, missing, a], 25.0, Crossing::Unknown),
            // One more place in the gap: which one is the middle is not known.
            (vec![a, missing, c, a, b], 25.0, Crossing::Unknown),
            (vec![a, b, missing], 45.0, Crossing::Unknown),
            (vec![missing, b, c], 25.0, Crossing::Unknown),
            (vec![missing, missing], 25.0, Crossing::Unknown),
        ] {
            let got = crossing(&curve(&points), wanted);
            assert_eq!(got, expected, "law: where {points:?} take {wanted}");
        }
    }
}
