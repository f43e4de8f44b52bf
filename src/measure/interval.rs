//! A closed interval.

use serde::{Deserialize, Serialize};

/// A closed interval.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Interval {
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

impl Interval {
    /// From its ends.
    pub const fn new(low: f64, high: f64) -> Self {
        Self { low, high }
    }

    /// To either side of a value.
    pub fn around(middle: f64, half: f64) -> Self {
        Self::new(middle - half, middle + half)
    }

    /// Whether a value lies in it, ends included; NaN lies in none.
    pub fn contains(&self, value: f64) -> bool {
        value >= self.low && value <= self.high
    }

    /// The smallest interval that holds all finite values; `None` without any.
    pub fn of(values: impl IntoIterator<Item = f64>) -> Option<Self> {
        values.into_iter().filter(|v| v.is_finite()).fold(None, |seen: Option<Self>, v| {
            Some(seen.map_or(Self::new(v, v), |s| Self::new(s.low.min(v), s.high.max(v))))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_hull_of_values_leaves_out_what_is_no_number() {
        assert_eq!(Interval::of([2.0, f64::NAN, -1.0]), Some(Interval::new(-1.0, 2.0)));
        assert_eq!(Interval::of([f64::NAN]), None);
        assert_eq!(Interval::of([]), None);
    }
}
