//! What is worth trying for a long time: `make soak`.

use std::time::{Duration, Instant};

/// How long each of the long tests goes on: `PLUVIA_SOAK` in minutes; none of
/// them is carried out where that is not set.
pub struct Soak {
    until: Instant,
}

impl Soak {
    /// The time there is, from now.
    pub fn begin() -> Option<Self> {
        let minutes = std::env::var("PLUVIA_SOAK").ok()?;
        let minutes: f64 = minutes.parse().expect("PLUVIA_SOAK is a number of minutes");
        Some(Self { until: Instant::now() + Duration::from_secs_f64(minutes * 60.0) })
    }

    /// Whether there is time left.
    pub fn goes_on(&self) -> bool {
        Instant::now() < self.until
    }
}

/// Where random numbers begin: `PLUVIA_SOAK_SEED`, or 1.
pub fn seed() -> u64 {
    let given = std::env::var("PLUVIA_SOAK_SEED").ok();
    given.map_or(1, |seed| seed.parse().expect("PLUVIA_SOAK_SEED is a whole number"))
}
