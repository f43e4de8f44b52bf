//! One axis: its range, its ticks, and where a value falls on it.

/// An axis of a plot.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    /// Name with unit.
    pub name: String,
    /// Value at the left or lower end.
    pub from: f64,
    /// Value at the right or upper end; less than `from` where values grow downwards.
    pub to: f64,
    /// Whether the axis is logarithmic.
    pub log: bool,
    /// Values with a number and a grid line.
    pub ticks: Vec<f64>,
    /// Values with a short tick only.
    pub minor: Vec<f64>,
}

/// Share of the distance between ticks that values may stand over the end.
const HAIR: f64 = 5e-3;

impl Axis {
    /// An axis of rows below each other, numbered from 0 at the top.
    pub fn rows(count: usize) -> Self {
        let ticks = (0..count).map(|i| i as f64).collect();
        Self::between("", (count as f64 - 0.4, -0.6), ticks)
    }

    fn between(name: &str, (from, to): (f64, f64), ticks: Vec<f64>) -> Self {
        Self { name: name.to_owned(), from, to, log: false, ticks, minor: Vec::new() }
    }

    /// A linear axis that holds all finite values, its ends on round numbers.
    /// Without values it runs from 0 to 1.
    pub fn linear(name: &str, values: impl IntoIterator<Item = f64>) -> Self {
        let (low, high) = extent(values).unwrap_or((0.0, 1.0));
        // One value alone still needs a length.
        let (low, high) = if high - low > 1e-12 * high.abs().max(low.abs()).max(1e-300) {
            (low, high)
        } else {
            let pad = if low == 0.0 { 1.0 } else { 0.05 * low.abs() };
            (low - pad, high + pad)
        };
        let step = round_step((high - low) / 6.0);
        // What passes a round number by a hair does not lengthen the axis.
        let (first, last) =
            ((low / step + HAIR).floor() as i64, (high / step - HAIR).ceil() as i64);
        let ticks: Vec<f64> = (first..=last).map(|i| i as f64 * step).collect();
        Self::between(name, (first as f64 * step, last as f64 * step), ticks)
    }

    /// A linear axis with given ticks, from the first to the last.
    pub fn with_ticks(name: &str, ticks: &[f64]) -> Self {
        let ends = extent(ticks.iter().copied()).unwrap_or((0.0, 1.0));
        Self::between(name, ends, ticks.to_vec())
    }

    /// A logarithmic axis that holds all positive values; within two decades
    /// it is numbered at 1, 2 and 5 of each.
    pub fn logarithmic(name: &str, values: impl IntoIterator<Item = f64>) -> Self {
        let (low, high) = extent(values.into_iter().filter(|v| *v > 0.0)).unwrap_or((0.1, 10.0));
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
        Self { name: name.to_owned(), from, to, log: true, ticks, minor }
    }

    /// Logarithmic or linear.
    pub fn scaled(is_log: bool, name: &str, values: impl IntoIterator<Item = f64>) -> Self {
        if is_log { Self::logarithmic(name, values) } else { Self::linear(name, values) }
    }

    /// Falling heights in cm from 0 to a highest; markers at the ends stand clear of the frame.
    pub fn falling_heights(highest: f64) -> Self {
        let ticks: Vec<f64> = (0..=4).map(|i| f64::from(i) * highest / 4.0).collect();
        let axis = Self::with_ticks("Falling height (cm)", &ticks);
        Self { from: -0.05 * highest, to: 1.05 * highest, ..axis }
    }

    /// The same axis with its values growing the other way.
    pub fn reversed(mut self) -> Self {
        std::mem::swap(&mut self.from, &mut self.to);
        self
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
        let step = self.ticks.windows(2).map(|w| (w[1] - w[0]).abs()).fold(f64::INFINITY, f64::min);
        let decimals = if step.is_finite() && step > 0.0 {
            (-(step * (1.0 + 1e-9)).log10().floor()).clamp(0.0, 9.0) as usize
        } else {
            0
        };
        let text = format!("{:.decimals$}", if tick == 0.0 { 0.0 } else { tick });
        text.replace('-', "\u{2212}")
    }
}

fn log_number(tick: f64) -> String {
    let exponent = tick.log10().round() as i32;
    if (-2..=3).contains(&exponent) {
        let least = usize::try_from(-(tick.log10() + 1e-9).floor() as i32).unwrap_or(0);
        // Sieves have openings such as 12.5 and 3.15 mm.
        let whole = |decimals: &usize| {
            let shifted = tick * 10f64.powi(*decimals as i32);
            (shifted - shifted.round()).abs() < 1e-6 * shifted
        };
        let decimals = (least..least + 3).find(whole).unwrap_or(least);
        return format!("{tick:.decimals$}");
    }
    let superscript = |c: char| match c {
        '-' => '\u{207B}',
        '1' => '\u{00B9}',
        '2' => '\u{00B2}',
        '3' => '\u{00B3}',
        d => char::from_u32(0x2070 + (d as u32 - '0' as u32)).unwrap_or(d),
    };
    format!("10{}", exponent.to_string().chars().map(superscript).collect::<String>())
}

/// Smallest and largest of the finite values.
fn extent(values: impl IntoIterator<Item = f64>) -> Option<(f64, f64)> {
    values
        .into_iter()
        .filter(|v| v.is_finite())
        .fold(None, |seen, v| Some(seen.map_or((v, v), |(a, b): (f64, f64)| (a.min(v), b.max(v)))))
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
        let axis = Axis::linear("h", [152.3, 163.9]);
        assert_eq!((axis.from, axis.to), (152.0, 164.0), "round ends around 152.3 to 163.9");
        assert_eq!(axis.number(154.0), "154");
        let axis = Axis::linear("t", [0.0, 20.000_000_1]);
        assert_eq!((axis.from, axis.to), (0.0, 20.0), "rounding does not lengthen the axis");
        assert_eq!(Axis::linear("h", [0.0, 0.5]).number(0.1), "0.1");
        assert_eq!(Axis::linear("h", [-3.0, 3.0]).number(-2.0), "\u{2212}2");
    }

    #[test]
    fn axes_survive_what_is_no_number() {
        for values in [vec![], vec![f64::NAN], vec![7.0], vec![0.0], vec![f64::INFINITY, 3.0]] {
            for axis in [Axis::linear("x", values.clone()), Axis::logarithmic("x", values.clone())]
            {
                assert!(axis.from < axis.to, "{values:?} gives an empty axis: {axis:?}");
                assert!((2..40).contains(&axis.ticks.len()), "{values:?}: {axis:?}");
            }
        }
        let log = Axis::logarithmic("x", [1.0, 100.0]);
        assert_eq!((log.place(0.0), log.place(-1.0), log.place(f64::NAN)), (None, None, None));
    }

    #[test]
    fn places_are_fractions_of_the_length() {
        let linear = Axis::with_ticks("t", &[0.0, 10.0, 20.0]);
        assert_eq!(linear.place(5.0), Some(0.25));
        assert_eq!(linear.reversed().place(5.0), Some(0.75), "values grow the other way");
        let log = Axis::logarithmic("d", [1.0, 100.0]);
        let got = log.place(10.0).expect("a place");
        assert!((got - 0.5).abs() < 1e-12, "10 is midway from 1 to 100 on a log axis: got {got}");
    }

    #[test]
    fn numbers_of_log_axes_are_read_easily() {
        let axis = Axis::logarithmic("E", [1e-8, 1.0]);
        for (tick, expected) in
            [(1.0, "1"), (0.01, "0.01"), (100.0, "100"), (1e-7, "10\u{207B}\u{2077}"), (0.5, "0.5")]
        {
            assert_eq!(axis.number(tick), expected, "number of {tick}");
        }
        for (tick, expected) in [(12.5, "12.5"), (3.15, "3.15"), (8.0, "8"), (1.0 / 3.0, "0.3")] {
            assert_eq!(axis.number(tick), expected, "number of {tick}");
        }
    }
}
