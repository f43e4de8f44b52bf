//! The shaking table's motion.

use std::f64::consts::PI;

/// A table that shakes along x in one or more periods of x(t) = A sin(2πft),
/// with rests at x = 0 between them. Each period holds a whole number of cycles,
/// so that it ends where it began, at zero displacement. Without a ramp it starts
/// with full speed, as an oscillator does that is switched on at its middle
/// position; with one the amplitude grows and dies away along half a cosine.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TableMotion {
    /// Half the stroke, in m.
    pub amplitude: f64,
    /// Frequency in Hz.
    pub frequency: f64,
    /// Length of one period of vibration in s.
    pub duration: f64,
    /// Number of periods.
    pub periods: u32,
    /// Rest between periods in s.
    pub rest: f64,
    /// Time in s in which the amplitude grows at the beginning of each period,
    /// and dies away at its end; 0 for none.
    pub ramp: f64,
}

impl TableMotion {
    /// Time from the start of the first to the end of the last period, in s.
    pub fn total(&self) -> f64 {
        f64::from(self.periods) * self.duration
            + f64::from(self.periods.saturating_sub(1)) * self.rest
    }

    /// Displacement in m at a time in s since the start.
    pub fn displacement(&self, time: f64) -> f64 {
        match self.within(time) {
            Some(t) => self.amplitude * self.share(t).0 * (2.0 * PI * self.frequency * t).sin(),
            None => 0.0,
        }
    }

    /// Velocity in m/s at a time in s since the start.
    pub fn velocity(&self, time: f64) -> f64 {
        let omega = 2.0 * PI * self.frequency;
        match self.within(time) {
            Some(t) => {
                let (share, growth) = self.share(t);
                self.amplitude * (share * omega * (omega * t).cos() + growth * (omega * t).sin())
            }
            None => 0.0,
        }
    }

    /// A speed in m/s that the table never exceeds: that of the sinusoid, and of
    /// the growth of its amplitude.
    pub fn peak_speed(&self) -> f64 {
        let growth = if self.ramp > 0.0 { 0.5 * PI / self.ramp } else { 0.0 };
        self.amplitude.abs() * (2.0 * PI * self.frequency + growth)
    }

    /// Times in s at which the periods of vibration end.
    pub fn period_ends(&self) -> Vec<f64> {
        (0..self.periods)
            .map(|p| f64::from(p) * (self.duration + self.rest) + self.duration)
            .collect()
    }

    /// Share of the amplitude at a time within a period, and its growth in 1/s.
    fn share(&self, t: f64) -> (f64, f64) {
        let left = self.duration - t;
        let (since, sign) = if t < left { (t, 1.0) } else { (left, -1.0) };
        if since >= self.ramp {
            return (1.0, 0.0);
        }
        let angle = PI * since / self.ramp;
        (0.5 * (1.0 - angle.cos()), sign * 0.5 * PI / self.ramp * angle.sin())
    }

    /// Time since the start of the period that holds `time`; `None` at rest.
    fn within(&self, time: f64) -> Option<f64> {
        if time < 0.0 || time >= self.total() {
            return None;
        }
        let t = time % (self.duration + self.rest);
        (t < self.duration).then_some(t)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The paper's intermittent vibration with rests of one second.
    const MOTION: TableMotion = TableMotion {
        amplitude: 0.025,
        frequency: 3.0,
        duration: 5.0,
        periods: 4,
        rest: 1.0,
        ramp: 0.0,
    };

    const RAMPED: TableMotion = TableMotion { ramp: 1.0, ..MOTION };

    #[test]
    fn the_table_never_exceeds_its_peak_speed() {
        for motion in [MOTION, RAMPED] {
            let fastest = (0..23_000)
                .map(|ms| motion.velocity(f64::from(ms) * 1e-3).abs())
                .fold(0.0, f64::max);
            let peak = motion.peak_speed();
            assert!(
                fastest <= peak && fastest > 0.7 * peak,
                "law: speeds up to the peak of {peak} m/s and near it, got {fastest} m/s"
            );
        }
    }

    #[test]
    fn peaks_at_the_amplitude_and_rests_in_the_middle() {
        let quarter = 1.0 / 12.0;
        let got = MOTION.displacement(quarter);
        assert!(
            (got - 0.025).abs() < 1e-12,
            "law x(T/4) = A, expected 0.025, got {got}, tolerance 1e-12"
        );
        for at_rest in [5.0 + 1e-9, 5.5, 23.0, -1.0] {
            assert_eq!(MOTION.displacement(at_rest), 0.0, "at rest at {at_rest} s");
            assert_eq!(MOTION.velocity(at_rest), 0.0, "at rest at {at_rest} s");
        }
        assert_eq!(MOTION.total(), 23.0);
        assert_eq!(MOTION.period_ends(), [5.0, 11.0, 17.0, 23.0]);
    }

    #[test]
    fn velocity_is_the_derivative_of_displacement() {
        let step = 1e-6;
        for (motion, ramp) in [(MOTION, "without"), (RAMPED, "with")] {
            for time in [0.013, 0.7, 1.7, 4.6, 6.25, 22.9] {
                let expected = (motion.displacement(time + step)
                    - motion.displacement(time - step))
                    / (2.0 * step);
                let got = motion.velocity(time);
                assert!(
                    (got - expected).abs() < 1e-8,
                    "law v = dx/dt at {time} s {ramp} a ramp, expected {expected}, got {got}, \
                     tolerance 1e-8"
                );
            }
        }
    }

    #[test]
    fn a_ramp_begins_and_ends_each_period_at_rest_and_leaves_the_middle() {
        for edge in [0.0, 5.0 - 1e-9, 6.0 + 1e-9, 23.0 - 1e-9] {
            let got = RAMPED.velocity(edge);
            assert!(got.abs() < 1e-6, "law v = 0 at {edge} s, got {got}, tolerance 1e-6");
        }
        for middle in [1.0, 2.3, 4.0, 8.1] {
            let (got, expected) = (RAMPED.displacement(middle), MOTION.displacement(middle));
            assert!(
                (got - expected).abs() < 1e-15,
                "law: as without a ramp at {middle} s, expected {expected}, got {got}"
            );
        }
        let half = RAMPED.displacement(0.5 + 1.0 / 12.0) / MOTION.displacement(0.5 + 1.0 / 12.0);
        let expected = 0.5 * (1.0 - (PI * (0.5 + 1.0 / 12.0)).cos());
        assert!(
            (half - expected).abs() < 1e-12,
            "law (1 - cos πt/r)/2, expected {expected}, got {half}"
        );
    }

    #[test]
    fn paper_amplitude_gives_the_peak_speed_of_0_471_m_per_s() {
        let got = MOTION.velocity(0.0);
        assert!((got - 0.4712).abs() < 1e-4, "law v = 2πfA, expected 0.4712, got {got}");
    }
}
