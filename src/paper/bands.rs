//! The paper's numbers as intervals, each with how it is read.

use serde::{Deserialize, Serialize};

use crate::measure::Interval;

/// A number as the paper prints it: a range or a value.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum PaperValue {
    /// "from 14 to 19.61".
    Range(Interval),
    /// "2343".
    Value {
        /// The number printed.
        value: f64,
    },
}

/// A number of the paper as `claims.json` has it, which says how it is read.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Stated {
    /// A range that the paper prints. Its ends count as they stand: 13.97 is below a range from 14,
    /// though it rounds to it.
    Range(f64, f64),
    /// A value that the paper prints with a number of decimals: everything that rounds to it
    /// agrees.
    Printed(f64, i32),
    /// A count, which is met exactly or not at all.
    Count(usize),
    /// "About" a value, with a half width, which is ours, and its unit. Of "about 80 %" and
    /// "around 85 %" it is 5: the numbers are rounded to 5, so that the next ones would have been
    /// printed had they been nearer than this.
    About(f64, f64, String),
}

impl Stated {
    /// As printed.
    pub fn paper(&self) -> PaperValue {
        match *self {
            Self::Range(low, high) => PaperValue::Range(Interval::new(low, high)),
            Self::Printed(value, _) | Self::About(value, ..) => PaperValue::Value { value },
            Self::Count(count) => PaperValue::Value { value: count as f64 },
        }
    }

    /// What counts as agreement.
    pub fn read_as(&self) -> Interval {
        match *self {
            Self::Range(low, high) => Interval::new(low, high),
            Self::Printed(value, decimals) => Interval::around(value, half_digit(decimals)),
            Self::Count(count) => Interval::around(count as f64, 0.0),
            Self::About(value, half_width, _) => Interval::around(value, half_width),
        }
    }

    /// Why that interval, for the reader; empty where the paper gives it.
    pub fn interpretation(&self) -> String {
        match self {
            Self::Range(..) | Self::Count(_) => String::new(),
            Self::Printed(_, decimals) => {
                format!("Read as what rounds to the number printed: ±{}.", half_digit(*decimals))
            }
            Self::About(value, half_width, unit) => format!(
                "The paper gives about {value}; read as ±{half_width} {unit}. The width is ours, the \
                 paper gives none."
            ),
        }
    }
}

/// Half a unit in the last of a number's decimals.
fn half_digit(decimals: i32) -> f64 {
    0.5 * 10f64.powi(-decimals)
}

/// Final settlement of the top plate after 20 s of continuous vibration, in mm
/// (section 4 and Figure 9, hatched: range of the laboratory tests).
pub const FINAL_SETTLEMENT_MM: Interval = Interval::new(14.0, 19.61);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_interval_holds_its_ends_and_nothing_beyond() {
        let band = FINAL_SETTLEMENT_MM;
        for (value, expected) in [
            (14.0, true),
            (19.61, true),
            (17.0, true),
            (13.999, false),
            (19.611, false),
            (f64::NAN, false),
            (f64::INFINITY, false),
        ] {
            assert_eq!(
                band.contains(value),
                expected,
                "14 ≤ {value} ≤ 19.61: expected {expected} (right), got left"
            );
        }
    }

    #[test]
    fn a_printed_value_is_met_by_what_rounds_to_it() {
        let density = Stated::Printed(2673.9, 1).read_as();
        for (value, expected) in
            [(2673.86, true), (2673.94, true), (2673.8, false), (2674.0, false)]
        {
            assert_eq!(density.contains(value), expected, "{value} rounds to 2673.9: {expected}");
        }
    }

    /// Law: what is below the end of a printed range is outside, also where it rounds to it.
    #[test]
    fn ends_of_a_printed_range_count_as_they_stand() {
        let (range, printed) = (Stated::Range(14.0, 19.61), Stated::Printed(14.0, 0));
        for (stated, expected) in [(range, false), (printed, true)] {
            let got = stated.read_as().contains(13.97);
            assert_eq!(got, expected, "law: 13.97 is met by {stated:?}: expected {expected}");
        }
    }

    #[test]
    fn about_is_five_points_either_way_and_says_so() {
        let band = Stated::About(80.0, 5.0, "percentage points".to_owned());
        assert_eq!(band.read_as(), Interval::new(75.0, 85.0), "80 ± 5 percentage points");
        assert!(
            band.interpretation().contains("ours"),
            "the interpretation owns its width: {}",
            band.interpretation()
        );
    }

    #[test]
    fn paper_values_look_as_scripts_expect() {
        let json = |of: Stated| serde_json::to_string(&of.paper()).expect("serialises");
        assert_eq!(json(Stated::Range(14.0, 19.61)), r#"{"low":14.0,"high":19.61}"#);
        assert_eq!(json(Stated::Count(3)), r#"{"value":3.0}"#);
    }
}
