//! A quantity that is watched against a limit while a stage goes on.

use super::*;

/// How often something was looked at, and how far it came to its limit.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Watched {
    /// Number of looks.
    pub looks: u64,
    /// Number of looks at which it was beyond the limit.
    pub beyond: u64,
    /// The value that came nearest to its limit, or went farthest beyond.
    pub worst: f64,
    /// The limit it was compared with.
    pub limit: f64,
    /// When that was, in s since the first stage began.
    pub worst_at_s: f64,
    /// When a value was first beyond its limit, in s since the first stage began.
    pub first_beyond_s: Option<f64>,
}

impl Watched {
    /// Notes a value and its limit, which is 0 where nothing can be given yet, at a time in s;
    /// tells whether it is the first beyond its limit.
    pub fn note(&mut self, value: f64, limit: f64, time_s: f64) -> bool {
        self.looks += 1;
        if self.looks == 1 || self.is_topped_by(value, limit) {
            (self.worst, self.limit, self.worst_at_s) = (value, limit, time_s);
        }
        // Written so that what is no number is beyond.
        if value <= limit {
            return false;
        }
        self.beyond += 1;
        let first = self.first_beyond_s.is_none();
        self.first_beyond_s.get_or_insert(time_s);
        first
    }

    /// Whether a value came nearer to its own limit than the worst so far. Shares are compared,
    /// for limits differ from stage to stage; before the first grain is let go both are 0, which
    /// has no share, and anything tops it.
    fn is_topped_by(&self, value: f64, limit: f64) -> bool {
        if self.worst == 0.0 && self.limit == 0.0 {
            return value > 0.0 || limit > 0.0;
        }
        value * self.limit > self.worst * limit
    }

    /// What was seen here and, later, there.
    #[must_use]
    pub fn and(self, later: Self) -> Self {
        if self.looks == 0 || later.looks == 0 {
            return if self.looks == 0 { later } else { self };
        }
        let nearer = if self.is_topped_by(later.worst, later.limit) { later } else { self };
        Self {
            looks: self.looks + later.looks,
            beyond: self.beyond + later.beyond,
            first_beyond_s: self.first_beyond_s.or(later.first_beyond_s),
            ..nearer
        }
    }

    /// Whether it stayed within its limits; none where nobody looked.
    pub fn passed(&self) -> Option<bool> {
        (self.looks > 0).then_some(self.beyond == 0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(values: &[(f64, f64)]) -> Watched {
        let mut watched = Watched::default();
        for (n, (value, limit)) in values.iter().enumerate() {
            watched.note(*value, *limit, n as f64);
        }
        watched
    }

    #[test]
    fn what_stays_within_passes_and_what_does_not_fails_with_its_time() {
        assert_eq!(Watched::default().passed(), None, "law: nobody looked");
        assert_eq!(of(&[(0.2, 0.5), (0.5, 0.5)]).passed(), Some(true), "law: up to the limit");
        let beyond = of(&[(0.2, 0.5), (0.6, 0.5), (0.9, 0.5), (0.1, 0.5)]);
        assert_eq!(beyond.passed(), Some(false));
        assert_eq!((beyond.looks, beyond.beyond, beyond.worst), (4, 2, 0.9));
        assert_eq!((beyond.first_beyond_s, beyond.worst_at_s), (Some(1.0), 2.0));
        assert_eq!(of(&[(f64::NAN, 0.5)]).passed(), Some(false), "law: no number is beyond");
    }

    #[test]
    fn the_worst_is_the_nearest_to_its_own_limit() {
        let watched = of(&[(3.0, 10.0), (2.0, 4.0), (4.0, 20.0)]);
        assert_eq!((watched.worst, watched.limit), (2.0, 4.0), "law: half of its limit");
        let [a, b] = [of(&[(3.0, 10.0), (5.0, 4.0)]), of(&[(9.0, 10.0)])];
        let both = a.and(b);
        assert_eq!((both.looks, both.beyond, both.worst), (3, 1, 5.0));
        assert_eq!(b.and(a).worst, 5.0, "law: whichever comes first");
        assert_eq!(a.and(Watched::default()), a, "law: nothing adds nothing");
        assert_eq!(Watched::default().and(a), a);
    }

    /// Law: a look at which nothing could move yet hides none of the others, those of later stages
    /// included.
    #[test]
    fn a_look_at_nothing_is_topped_by_any_other() {
        let [empty, within, beyond] =
            [of(&[(0.0, 0.0)]), of(&[(0.0, 0.0), (2.0, 4.0)]), of(&[(0.0, 0.0), (5.0, 4.0)])];
        assert_eq!((within.worst, within.limit, within.worst_at_s), (2.0, 4.0, 1.0));
        assert_eq!((beyond.worst, beyond.limit, beyond.passed()), (5.0, 4.0, Some(false)));
        for both in [empty.and(beyond), beyond.and(empty)] {
            assert_eq!((both.looks, both.worst, both.limit), (3, 5.0, 4.0), "law: what was seen");
        }
        let still = of(&[(0.0, 0.0), (0.0, 4.0), (0.0, 0.0)]);
        assert_eq!((still.worst, still.limit), (0.0, 4.0), "law: a limit says more than none");
        let without = of(&[(0.0, 0.0), (1.0, 0.0), (3.0, 4.0)]);
        assert_eq!((without.worst, without.limit), (1.0, 0.0), "law: beyond a limit of nothing");
    }
}
