//! Settlement by vibration, read off a series of heights.
//!
//! Settlement is the height at the beginning of the first period of vibration
//! minus the height at the time of reading: positive downwards, never clipped,
//! smoothed or made monotone, so that a bouncing plate shows as it is
//! (the paper's Figures 9 and 10 show such fluctuations). The laboratory read the plate "before
//! and after vibration" and between periods (paper, section 2): at rest. So are read the value at
//! the end and those after each period; what is read while the table moves says so.

use super::MeasureError;

/// How far a series may begin late or end early, in s: one reading interval of the paper (section
/// 4, "every 0.08 seconds"). Within it the first or last sample stands for the missing moment.
const SLACK: f64 = 0.08;

/// Rounding of times that are sums of steps, in s.
const ROUNDING: f64 = 1e-9;

/// The paper's mark for the early part of vibration (section 4, "the first
/// five seconds of vibration"), in s.
pub const EARLY_SHAKING: f64 = 5.0;

/// Settlement by vibration, positive downwards.
#[derive(Debug, Clone, PartialEq)]
pub struct Settlement {
    /// At the last sample of the series, in m: at rest, where the series goes on until then.
    pub at_end: f64,
    /// At the end of the last period, in m, while what the table has thrown up still moves.
    pub end_of_shaking: f64,
    /// After the first 5 s of vibration, in m, rests between periods not counted; at the end of a
    /// period it is read in the rest that follows. `None` when the vibration is shorter.
    pub after_5_s: Option<f64>,
    /// `after_5_s` over `at_end`; `None` where there is no settlement to
    /// share out (`at_end` zero or negative).
    pub share_after_5_s: Option<f64>,
    /// After each period, in m, read where the laboratory read it: "between two successive
    /// vibration periods" (paper, section 4), that is at the last sample before the next period
    /// begins, and at the end of the series for the last one. Without rests this is the end of the
    /// period.
    pub after_each_period: Vec<f64>,
}

/// Reads the settlement off a series of times in s and heights in m (of the plate, the mean surface,
/// or the mean grain); heights between samples by linear interpolation. The series ends where the
/// final reading is taken: leave out what comes after (a rest test). Periods in which the table
/// shakes are from beginning to end in s, on the clock of the series.
///
/// # Errors
/// [`MeasureError`] without heights or periods, and where a time runs backwards, a value is not
/// finite, or a period is empty, out of order, or not covered by the series.
pub fn settlement(series: &[(f64, f64)], periods: &[[f64; 2]]) -> Result<Settlement, MeasureError> {
    check(series, periods)?;
    let start = height_clamped(series, periods[0][0]);
    let at_end = start - series[series.len() - 1].1;
    let after_5_s = height_after(series, periods, EARLY_SHAKING).map(|height| start - height);
    let end_of_shaking = start - height_clamped(series, periods[periods.len() - 1][1]);
    let after_each_period =
        (0..periods.len()).map(|n| start - height_at_rest(series, periods, n)).collect();
    Ok(Settlement {
        at_end,
        end_of_shaking,
        after_5_s,
        share_after_5_s: after_5_s.filter(|_| at_end > 0.0).map(|part| part / at_end),
        after_each_period,
    })
}

/// Height when the table has shaken for `seconds` in all; at the end of a period it is read in the
/// rest that follows, of the last one at the end of the series.
fn height_after(series: &[(f64, f64)], periods: &[[f64; 2]], seconds: f64) -> Option<f64> {
    let mut left = seconds;
    for (n, [from, to]) in periods.iter().enumerate() {
        let length = to - from;
        if left < length - ROUNDING {
            return Some(height_clamped(series, from + left));
        }
        if left <= length + ROUNDING {
            return Some(height_at_rest(series, periods, n));
        }
        left -= length;
    }
    None
}

/// Height in the rest after a period: at the last sample before the next one begins, for the first
/// sample after that is in motion. Where no sample lies in the rest, or there is none, it is that
/// at the beginning of the next period; after the last period, that at the end of the series.
fn height_at_rest(series: &[(f64, f64)], periods: &[[f64; 2]], period: usize) -> f64 {
    let Some([next, _]) = periods.get(period + 1) else { return series[series.len() - 1].1 };
    let until = series.partition_point(|(at, _)| *at <= next + ROUNDING);
    match series[..until].last() {
        Some((at, height)) if *at > periods[period][1] + ROUNDING => *height,
        _ => height_clamped(series, *next),
    }
}

/// Height at a time; before the first and after the last sample theirs.
fn height_clamped(series: &[(f64, f64)], time: f64) -> f64 {
    let after = series.partition_point(|(at, _)| *at <= time);
    if after == 0 {
        return series[0].1;
    }
    let Some(right) = series.get(after) else { return series[series.len() - 1].1 };
    let left = series[after - 1];
    let t = (time - left.0) / (right.0 - left.0);
    left.1 + t * (right.1 - left.1)
}

fn check(series: &[(f64, f64)], periods: &[[f64; 2]]) -> Result<(), MeasureError> {
    let fault = |what: String| Err(MeasureError(what));
    let (Some(&(first, _)), Some(&(last, _))) = (series.first(), series.last()) else {
        return fault("there is no height in the series".to_owned());
    };
    let mut before = f64::NEG_INFINITY;
    for (index, &(time, height)) in series.iter().enumerate() {
        if !time.is_finite() || !height.is_finite() || time < before {
            return fault(format!(
                "sample {index} of the series (time {time} s, height {height} m) is not finite or \
                 lies before its predecessor"
            ));
        }
        before = time;
    }
    if periods.is_empty() {
        let what = "settlement by vibration needs at least one period of vibration";
        return fault(what.to_owned());
    }
    let mut free_from = first - SLACK;
    for (index, &[start, end]) in periods.iter().enumerate() {
        let fits = start >= free_from - ROUNDING && end > start && end <= last + SLACK + ROUNDING;
        if !fits {
            return fault(format!(
                "period {index} of vibration, {start} s to {end} s, is empty, overlaps the one \
                 before, or is not covered by the series ({first} s to {last} s)"
            ));
        }
        free_from = end;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::super::testing::assert_near;
    use super::*;

    /// Share of the final settlement reached after a time of vibration, by the parts.
    fn share_after(series: &[(f64, f64)], periods: &[[f64; 2]], seconds: f64) -> Option<f64> {
        let start = height_clamped(series, periods[0][0]);
        let last = series[series.len() - 1].1;
        Some((start - height_after(series, periods, seconds)?) / (start - last))
    }

    /// Law: for a height h₀ − s(1 − exp(−t/τ)), sampled every 0.08 s from 3 s before the vibration,
    /// the readings are those of the formula; linear interpolation errs by at most Δt²/8 · s/τ².
    #[test]
    fn continuous_vibration() {
        let (begin, sink, tau) = (3.0, 0.018, 3.0);
        let fallen = |t: f64| sink * (1.0 - (-t.max(0.0) / tau).exp());
        let points: Vec<(f64, f64)> = (0..=288)
            .map(|i| f64::from(i) * 0.08)
            .map(|time| (time, 0.16 - fallen(time - begin)))
            .collect();
        let got = settlement(&points, &[[begin, 23.0]]).unwrap();
        // Larger than the smooth bound: the curve bends within one interval at the beginning.
        let tolerance = 0.08 * sink / tau / 4.0;
        let end = fallen(288.0 * 0.08 - begin);
        assert_near("final settlement", end, got.at_end, tolerance);
        assert_near("after 5 s", fallen(5.0), got.after_5_s.unwrap(), tolerance);
        let share = got.share_after_5_s.unwrap();
        assert_near("share", fallen(5.0) / end, share, tolerance / end);
        assert_eq!(got.after_each_period, [got.at_end]);
        let again = share_after(&points, &[[begin, 23.0]], 5.0);
        assert_eq!(again, got.share_after_5_s, "share by the other way");
    }

    /// Law: linear interpolation, on the beginning, between samples, and over
    /// a step of height at one time (the later sample counts).
    #[test]
    fn interpolation() {
        let s = [(0.0, 1.0), (1.0, 3.0), (1.0, 5.0), (2.0, 4.0)];
        for (time, expected) in
            [(0.0, 1.0), (0.25, 1.5), (0.999, 2.998), (1.0, 5.0), (1.5, 4.5), (2.0, 4.0)]
        {
            assert_near("height", expected, height_clamped(&s, time), 1e-12);
        }
    }

    /// Intermittent vibration: periods are read at the end of the rest that
    /// follows, 5 s of vibration are counted without rests.
    #[test]
    fn intermittent_vibration() {
        let s = [
            (0.0, 0.160),
            (2.0, 0.150), // end of the first period
            (3.0, 0.149), // settled in the rest
            (5.0, 0.145), // end of the second
            (6.0, 0.144),
            (8.0, 0.140), // end of the third
            (9.0, 0.142), // the plate comes up again
        ];
        let shaken = [[0.0, 2.0], [3.0, 5.0], [6.0, 8.0]];
        let got = settlement(&s, &shaken).unwrap();
        assert_near("final", 0.018, got.at_end, 1e-15);
        for (expected, got) in [0.011, 0.016, 0.018].iter().zip(&got.after_each_period) {
            assert_near("after a period and its rest", *expected, *got, 1e-15);
        }
        assert_eq!(got.after_each_period.len(), 3);
        // 2 s + 2 s + 1 s: the clock says 7 s.
        assert_near("after 5 s", 0.018, got.after_5_s.unwrap(), 1e-15);
        assert_near("at the end of shaking", 0.020, got.end_of_shaking, 1e-15);
        // The end of a period is read in the rest, as the laboratory did.
        let share = share_after(&s, &shaken, 2.0).unwrap();
        assert_near("share after the first period", 11.0 / 18.0, share, 1e-12);
        let share = share_after(&s, &shaken, 6.0).unwrap();
        assert_near("all of it", 1.0, share, 1e-12);
        // The settlement overshoots: a share above one is kept.
        let share = share_after(&s, &shaken, 5.9).unwrap();
        assert_near("share above one", 19.8 / 18.0, share, 1e-12);
        assert_eq!(share_after(&s, &shaken, 6.1), None, "longer than the vibration");
    }

    /// Law: what is read in a rest is the height at rest, whatever the first sample of the next
    /// period shows: here the plate has jumped by 3 mm. Rests may begin and end between samples,
    /// taken every 0.08 s; without a sample in them the height at the next beginning is read, as
    /// without rests.
    #[test]
    fn a_rest_is_read_before_the_next_shaking() {
        let (at_rest, jump) = (0.15, 0.003);
        let read = |shaken: f64, rest: f64| {
            let next = shaken + rest;
            let height = |t: f64| match t {
                t if t <= 0.0 => 0.16,
                t if t <= next + 1e-9 => at_rest,
                _ => at_rest + jump,
            };
            let last = 2.0 * shaken + rest;
            let count = (last / 0.08).round() as u32;
            let times = (0..=count).map(|n| 0.08 * f64::from(n));
            let series: Vec<(f64, f64)> = times.map(|t| (t, height(t))).collect();
            settlement(&series, &[[0.0, shaken], [next, last]]).expect("it can be read")
        };
        for (shaken, rest) in [(2.0, 1.0), (4.0, 1.0), (5.0, 0.5), (5.0, 1.0), (5.0, 2.0)] {
            let got = read(shaken, rest);
            let law = format!("at rest, after {shaken} s of shaking and {rest} s of rest");
            assert_near(&law, 0.01, got.after_each_period[0], 1e-12);
            let of_5_s = got.after_5_s.filter(|_| shaken == 5.0).unwrap_or(0.01);
            assert_near(&format!("{law}, after 5 s"), 0.01, of_5_s, 1e-12);
        }
        // From 2 s to 2.06 s there is no sample but that at 2 s, of the shaking.
        let got = read(2.0, 0.06).after_each_period[0];
        assert_near("between the samples at 2 s and 2.08 s", 0.01 - 0.75 * jump, got, 1e-12);
    }

    /// Law: shaking of 2 s and a rest, in which what was thrown up comes down, give the value at rest as
    /// final and that of the moving table beside it, and shares are of the value at rest.
    #[test]
    fn what_comes_down_after_shaking_counts() {
        let s = [(0.0, 0.160), (5.0, 0.150), (6.0, 0.1545), (6.5, 0.153), (9.0, 0.153)];
        let got = settlement(&s, &[[0.0, 6.0]]).unwrap();
        assert_near("at rest", 0.007, got.at_end, 1e-15);
        assert_near("at the end of shaking", 0.0055, got.end_of_shaking, 1e-15);
        assert_near("share of the value at rest", 10.0 / 7.0, got.share_after_5_s.unwrap(), 1e-12);
        assert_eq!(got.after_each_period, [got.at_end], "the last period is read at rest");
    }

    #[test]
    fn nothing_to_share_out() {
        for rise in [0.0, 0.001] {
            let s = [(0.0, 0.16), (5.0, 0.159), (20.0, 0.16 + rise)];
            let got = settlement(&s, &[[0.0, 20.0]]).unwrap();
            assert_near("final", -rise, got.at_end, 1e-15);
            assert_near("after 5 s", 0.001, got.after_5_s.unwrap(), 1e-15);
            assert_eq!(got.share_after_5_s, None, "no share of {}", got.at_end);
        }
        let got = settlement(&[(0.0, 0.16), (4.0, 0.15)], &[[0.0, 4.0]]).unwrap();
        assert_eq!((got.after_5_s, got.share_after_5_s), (None, None), "only 4 s shaken");
    }

    #[test]
    fn faults_are_named() {
        let good = [(0.0, 0.16), (5.0, 0.15)];
        let all = [[0.0, 5.0]];
        let says = |got: Result<Settlement, MeasureError>, fault: &str| {
            assert!(got.as_ref().is_err_and(|why| why.0.contains(fault)), "{fault}: {got:?}");
        };
        assert!(settlement(&good, &all).is_ok());
        says(settlement(&[], &all), "no height");
        says(settlement(&good, &[]), "at least one period");
        for bad in [[(1.0, 0.1), (0.0, 0.1)], [(0.0, 0.1), (1.0, f64::NAN)]] {
            says(settlement(&bad, &all), "sample 1 of");
        }
        let cases: [(&[[f64; 2]], usize); 5] = [
            (&[[-0.1, 5.0]], 0),
            (&[[0.0, 5.1]], 0),
            (&[[2.0, 2.0]], 0),
            (&[[0.0, 3.0], [2.0, 4.0]], 1),
            (&[[0.0, f64::NAN]], 0),
        ];
        for (bounds, which) in cases {
            says(settlement(&good, bounds), &format!("period {which} of"));
        }
        let late = settlement(&good, &[[-0.07, 5.07]]).unwrap();
        assert_near("within one reading interval", 0.01, late.at_end, 1e-15);
    }
}
