//! One axis: its range, its ticks, and where a value falls on it.

use crate::measure::Interval;

/// An axis of a plot: it reaches to all that is drawn, unless it is divided already.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Axis {
    /// Name with unit.
    pub name: String,
    is_log: bool,
    is_reversed: bool,
    is_clear: bool,
    /// Values that it reaches to, whatever is drawn.
    holds: Vec<f64>,
    /// How it is divided, where that does not follow from what is drawn.
    scale: Option<Scale>,
}

/// From where to where an axis goes, and how it is divided.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Scale {
    /// Value at the left or lower end.
    pub from: f64,
    /// Value at the right or upper end; less than `from` where values grow downwards.
    pub to: f64,
    /// Whether it is logarithmic.
    pub log: bool,
    /// Values with a number and a grid line.
    pub ticks: Vec<f64>,
    /// Values with a short tick only.
    pub minor: Vec<f64>,
}

/// Share of the distance between ticks that values may stand over the end.
const HAIR: f64 = 5e-3;

/// Share of the extent of the values that may stay empty beyond them at an end of a linear axis, so
/// that it ends at a tick.
const MOST_EMPTY: f64 = 0.05;

/// Most decimals of a linear axis; finer ticks have an exponent.
const MOST_DECIMALS: f64 = 9.0;

/// Fewest ticks of a linear axis.
const FEWEST_TICKS: usize = 4;

impl Axis {
    /// A linear axis. It ends at ticks, or, where these are not near what is drawn, at a round number
    /// between them.
    pub fn linear(name: impl Into<String>) -> Self {
        Self { name: name.into(), ..Self::default() }
    }

    /// A logarithmic axis, of the positive values.
    pub fn logarithmic(name: impl Into<String>) -> Self {
        Self::scaled(true, name)
    }

    /// Logarithmic or linear.
    pub fn scaled(is_log: bool, name: impl Into<String>) -> Self {
        Self { is_log, ..Self::linear(name) }
    }

    /// An axis that is divided already.
    pub fn divided(name: impl Into<String>, scale: Scale) -> Self {
        Self { scale: Some(scale), ..Self::linear(name) }
    }

    /// A linear axis with given ticks, from the first to the last.
    pub fn with_ticks(name: impl Into<String>, ticks: &[f64]) -> Self {
        let (from, to) = extent(ticks.iter().copied()).unwrap_or((0.0, 1.0));
        Self::divided(name, Scale { from, to, ticks: ticks.to_vec(), ..Scale::default() })
    }

    /// An axis of rows below each other, numbered from 0 at the top.
    pub fn rows(count: usize) -> Self {
        let ticks = (0..count).map(|i| i as f64).collect();
        let (from, to) = (count as f64 - 0.4, -0.6);
        Self::divided("", Scale { from, to, ticks, ..Scale::default() })
    }

    /// The same axis, reaching to values whatever is drawn.
    pub fn holding(mut self, values: impl IntoIterator<Item = f64>) -> Self {
        self.holds.extend(values);
        self
    }

    /// The same axis beginning at nothing, for lengths to be compared.
    pub fn from_zero(self) -> Self {
        self.holding([0.0])
    }

    /// The same axis with its values growing the other way.
    pub fn reversed(self) -> Self {
        Self { is_reversed: !self.is_reversed, ..self }
    }

    /// The same linear axis, divided for the values that it holds, with its ends beyond all that is
    /// drawn: what stands at the first and the last value is not on the frame.
    pub fn clear_of_frame(self) -> Self {
        Self { is_clear: true, ..self }
    }

    /// How it is divided where these values are drawn.
    pub(super) fn scale(&self, values: impl Iterator<Item = f64>) -> Scale {
        let values: Vec<f64> = values.chain(self.holds.iter().copied()).collect();
        let of = || values.iter().copied();
        let mut scale = match &self.scale {
            Some(scale) => scale.clone(),
            None if self.is_log => Scale::logarithmic(of()),
            None if self.is_clear => Scale::linear(self.holds.iter().copied()).clear_of(of()),
            None => Scale::linear(of()),
        };
        if self.is_reversed {
            std::mem::swap(&mut scale.from, &mut scale.to);
        }
        scale
    }
}

impl Scale {
    /// A linear scale that holds all finite values, with little empty at its ends. Without values
    /// it runs from 0 to 1.
    fn linear(values: impl Iterator<Item = f64>) -> Self {
        let (low, high) = extent(values).unwrap_or((0.0, 1.0));
        // One value alone still needs a length.
        let (low, high) = if high - low > 1e-12 * high.abs().max(low.abs()).max(1e-300) {
            (low, high)
        } else {
            let pad = if low == 0.0 { 1.0 } else { 0.05 * low.abs() };
            (low - pad, high + pad)
        };
        let step = round_step((high - low) / 6.0);
        let scale = Self::stepped(low, high, step);
        let is_fine = scale.ticks.len() >= FEWEST_TICKS;
        if is_fine { scale } else { Self::stepped(low, high, round_step(step / 2.5)) }
    }

    /// A linear scale with ticks at multiples of a step, which holds all values from `low` to
    /// `high`. An end is at a tick that is near, else at the next tenth of a step.
    fn stepped(low: f64, high: f64, step: f64) -> Self {
        let most_empty = MOST_EMPTY * (high - low);
        let tenth = step / 10.0;
        // What passes a round number by a hair does not lengthen the axis.
        let below = |step: f64| (low / step + HAIR).floor();
        let above = |step: f64| (high / step - HAIR).ceil();
        let (first, last) = (below(step), above(step));
        let begins_at_tick = low - first * step <= most_empty;
        let ends_at_tick = last * step - high <= most_empty;
        let from = if begins_at_tick { first * step } else { below(tenth) * tenth };
        let to = if ends_at_tick { last * step } else { above(tenth) * tenth };
        let (first, last) =
            (first as i64 + i64::from(!begins_at_tick), last as i64 - i64::from(!ends_at_tick));
        let ticks = (first..=last).map(|i| i as f64 * step).collect();
        Self { from, to, ticks, ..Self::default() }
    }

    /// The same ticks between ends that no value is near.
    fn clear_of(self, values: impl Iterator<Item = f64>) -> Self {
        const MARGIN: f64 = 0.04;
        let Some((low, high)) = extent(values) else { return self };
        let margin = MARGIN * (self.to - self.from);
        Self { from: self.from.min(low - margin), to: self.to.max(high + margin), ..self }
    }

    /// A logarithmic scale that holds all positive values; within two decades
    /// it is numbered at 1, 2 and 5 of each.
    pub(super) fn logarithmic(values: impl Iterator<Item = f64>) -> Self {
        let (low, high) = extent(values.filter(|v| *v > 0.0)).unwrap_or((0.1, 10.0));
        let (first, last) = (low.log10().floor() as i32, high.log10().ceil() as i32);
        let last = last.max(first + 1);
        let mantissas: &[f64] = if last - first <= 2 { &[1.0, 2.0, 5.0] } else { &[1.0] };
        // Many decades are numbered every second or third.
        let every = 1 + (last - first) / 9;
        let (from, to) = (10f64.powi(first), 10f64.powi(last));
        let decades = || (first..=last).map(|d| (d, 10f64.powi(d)));
        let inside = |v: &f64| *v >= from * (1.0 - 1e-9) && *v <= to * (1.0 + 1e-9);
        let ticks = decades()
            .filter(|(d, _)| (d - first) % every == 0)
            .flat_map(|(_, p)| mantissas.iter().map(move |m| m * p))
            .filter(inside)
            .collect();
        let minor = decades()
            .flat_map(|(_, p)| (2..10).map(move |m| f64::from(m) * p))
            .filter(inside)
            .collect();
        Self { from, to, log: true, ticks, minor }
    }

    /// Where a value falls: 0 at `from`, 1 at `to`, beyond them outside;
    /// `None` for what has no place.
    pub fn place(&self, value: f64) -> Option<f64> {
        let place = if self.log {
            if value <= 0.0 {
                return None;
            }
            (value / self.from).ln() / (self.to / self.from).ln()
        } else {
            (value - self.from) / (self.to - self.from)
        };
        place.is_finite().then_some(place)
    }

    /// A tick's number.
    pub fn number(&self, tick: f64) -> String {
        if self.log {
            return log_number(tick);
        }
        if tick.abs() >= 1e9 {
            return format!("{tick:e}");
        }
        let step = self.ticks.windows(2).map(|w| (w[1] - w[0]).abs()).fold(f64::INFINITY, f64::min);
        let power = |value: f64| (value.abs() * (1.0 + 1e-9)).log10().floor();
        let decimals = if step.is_finite() && step > 0.0 { -power(step) } else { 0.0 };
        let text = if decimals <= MOST_DECIMALS {
            let decimals = decimals.max(0.0) as usize;
            format!("{:.decimals$}", if tick == 0.0 { 0.0 } else { tick })
        } else if tick == 0.0 {
            "0".to_owned()
        } else {
            // As many digits as tell it from the next tick, without zeros at their end.
            let digits = (decimals + power(tick)).clamp(0.0, 17.0) as usize;
            let rounded: f64 = format!("{tick:.digits$e}").parse().unwrap_or(tick);
            format!("{rounded:e}")
        };
        text.replace('-', "\u{2212}")
    }
}

fn log_number(tick: f64) -> String {
    // Last digits do not lower the power.
    let exponent = (tick.log10() + 1e-9).floor() as i32;
    let with_decimals = |number: f64, least: usize| {
        // Sieves have openings such as 12.5 and 3.15 mm.
        let whole = |decimals: &usize| {
            let shifted = number * 10f64.powi(*decimals as i32);
            (shifted - shifted.round()).abs() < 1e-6 * shifted
        };
        let decimals = (least..least + 3).find(whole).unwrap_or(least);
        format!("{number:.decimals$}")
    };
    if (-2..=3).contains(&exponent) {
        return with_decimals(tick, usize::try_from(-exponent).unwrap_or(0));
    }
    let superscript = |c: char| match c.to_digit(10) {
        Some(digit) => "⁰¹²³⁴⁵⁶⁷⁸⁹".chars().nth(digit as usize).unwrap_or(c),
        None => '\u{207B}',
    };
    let power = format!("10{}", exponent.to_string().chars().map(superscript).collect::<String>());
    match with_decimals(tick / 10f64.powi(exponent), 0).as_str() {
        "1" => power,
        mantissa => format!("{mantissa}·{power}"),
    }
}

/// Smallest and largest of the finite values.
fn extent(values: impl IntoIterator<Item = f64>) -> Option<(f64, f64)> {
    Interval::of(values).map(|i| (i.low, i.high))
}

/// The smallest of 1, 2, 5 times a power of ten that is not below `step`.
fn round_step(step: f64) -> f64 {
    let power = 10f64.powf(step.log10().floor());
    [1.0, 2.0, 5.0, 10.0]
        .into_iter()
        .map(|m| m * power)
        .find(|s| *s >= step * (1.0 - 1e-9))
        .unwrap_or(10.0 * power)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn linear_axes_end_on_round_numbers() {
        let linear = |values: [f64; 2]| Scale::linear(values.into_iter());
        let axis = linear([152.3, 163.9]);
        assert_eq!((axis.from, axis.to), (152.0, 164.0), "round ends around 152.3 to 163.9");
        assert_eq!(axis.number(154.0), "154");
        let axis = linear([0.0, 20.000_000_1]);
        assert_eq!((axis.from, axis.to), (0.0, 20.0), "rounding does not lengthen the axis");
        assert_eq!(linear([0.0, 0.5]).number(0.1), "0.1");
        assert_eq!(linear([-3.0, 3.0]).number(-2.0), "\u{2212}2");
    }

    /// Law: an axis ends at a tick, or, where more than 5 % would stay empty, at a round number
    /// between ticks; it holds all values and has ticks enough to read it.
    #[test]
    fn linear_axes_end_near_the_values() {
        let linear = |low: f64, high: f64| Scale::linear([low, high].into_iter());
        for (low, high, from, to, step) in [
            (0.0, 20.32, 0.0, 20.5, 5.0),
            (0.0, 19.4, 0.0, 20.0, 5.0),
            (0.0, 13.0, 0.0, 13.0, 2.0),
            (1.1, 13.2, 1.0, 13.2, 2.0),
            (-0.31, 0.02, -0.31, 0.02, 0.1),
        ] {
            let got = linear(low, high);
            for (got, expected) in
                [(got.from, from), (got.to, to), (got.ticks[1] - got.ticks[0], step)]
            {
                let is_same = (got - expected).abs() < 1e-9;
                assert!(is_same, "law: {low} to {high} gives {expected}, got {got}");
            }
        }
        for n in 1..400 {
            let high = 1.013_f64.powi(n);
            for low in [0.0, 0.37 * high, -0.71 * high, 0.97 * high] {
                let got = linear(low, high);
                let (extent, hair) = (high - low, 0.01 * (high - low));
                let empty = [low - got.from, got.to - high].map(|empty| empty / extent);
                let is_near = |empty: &f64| (-0.01..=MOST_EMPTY).contains(empty);
                assert!(empty.iter().all(is_near), "law: {low} to {high}: 5 % at most: {got:?}");
                let inside = |tick: &f64| *tick >= got.from - hair && *tick <= got.to + hair;
                let ticks = &got.ticks;
                assert!((4..=10).contains(&ticks.len()), "law: {low} to {high}: {got:?}");
                assert!(ticks.iter().all(inside), "law: {low} to {high}: between ends: {got:?}");
            }
        }
    }

    /// Law: ticks that differ have different numbers, however small they are.
    #[test]
    fn small_ticks_have_exponents() {
        let numbers = |high: f64| -> Vec<String> {
            let axis = Scale::linear([0.0, high].into_iter());
            axis.ticks.iter().map(|tick| axis.number(*tick)).collect()
        };
        let expected =
            ["0", "2e\u{2212}10", "4e\u{2212}10", "6e\u{2212}10", "8e\u{2212}10", "1e\u{2212}9"];
        assert_eq!(numbers(1e-9), expected, "law: got left, expected right");
        let expected = ["0.000000000", "0.000000002", "0.000000004", "0.000000006", "0.000000008"];
        assert_eq!(numbers(9e-9)[..5], expected, "law: nine decimals still tell them apart");
    }

    /// Law: the ends stand clear of the values, and ticks stay round numbers between them.
    #[test]
    fn what_stands_at_the_ends_is_clear_of_the_frame() {
        let scale = |held: &[f64], drawn: &[f64]| {
            let axis = Axis::linear("").holding(held.iter().copied()).clear_of_frame();
            axis.scale(drawn.iter().copied())
        };
        let ends = scale(&[30.0, 80.0], &[29.5, 80.5]);
        assert_eq!((ends.from, ends.to), (27.5, 82.5), "law: beyond what is drawn by 4 % of 50");
        let ticks: Vec<f64> = (3..=8).map(|n| 10.0 * f64::from(n)).collect();
        assert_eq!(ends.ticks, ticks, "law: ticks from the first value to the last");
        let inside = scale(&[12.1, 57.9], &[]);
        assert_eq!((inside.from, inside.to), (10.0, 60.0), "law: there is room already");
        let none = scale(&[], &[]);
        assert_eq!((none.from, none.to), (0.0, 1.0), "law: nothing is drawn");
    }

    #[test]
    fn axes_survive_what_is_no_number() {
        for values in [vec![], vec![f64::NAN], vec![7.0], vec![0.0], vec![f64::INFINITY, 3.0]] {
            let of = || values.iter().copied();
            for axis in [Scale::linear(of()), Scale::logarithmic(of())] {
                assert!(axis.from < axis.to, "{values:?} gives an empty axis: {axis:?}");
                assert!((2..40).contains(&axis.ticks.len()), "{values:?}: {axis:?}");
            }
        }
        let log = Scale::logarithmic([1.0, 100.0].into_iter());
        assert_eq!((log.place(0.0), log.place(-1.0), log.place(f64::NAN)), (None, None, None));
    }

    #[test]
    fn places_are_fractions_of_the_length() {
        let linear = Axis::with_ticks("t", &[0.0, 10.0, 20.0]);
        let place = |axis: &Axis| axis.scale([].into_iter()).place(5.0);
        assert_eq!(place(&linear), Some(0.25));
        assert_eq!(place(&linear.reversed()), Some(0.75), "values grow the other way");
        let log = Scale::logarithmic([1.0, 100.0].into_iter());
        let got = log.place(10.0).expect("a place");
        assert!((got - 0.5).abs() < 1e-12, "10 is midway from 1 to 100 on a log axis: got {got}");
    }

    #[test]
    fn numbers_of_log_axes_are_read_easily() {
        let axis = Scale::logarithmic([1e-8, 1.0].into_iter());
        for (tick, expected) in [
            (1.0, "1"),
            (0.01, "0.01"),
            (100.0, "100"),
            (1e-7, "10\u{207B}\u{2077}"),
            (0.5, "0.5"),
            (5000.0, "5000"),
            (2e4, "2·10\u{2074}"),
            (0.002, "2·10\u{207B}\u{00B3}"),
            (2e-4, "2·10\u{207B}\u{2074}"),
        ] {
            assert_eq!(axis.number(tick), expected, "law: the number of {tick} is its own");
        }
        for (tick, expected) in [(12.5, "12.5"), (3.15, "3.15"), (8.0, "8"), (1.0 / 3.0, "0.3")] {
            assert_eq!(axis.number(tick), expected, "number of {tick}");
        }
    }
}
