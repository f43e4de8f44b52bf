//! The paper's numbers as intervals, each with the way it is read.

use serde::{Deserialize, Serialize};

use super::constants;

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

/// A number of the paper with the interval in which it counts as met.
#[derive(Debug, Clone, PartialEq)]
pub struct Band {
    /// As printed.
    pub paper: PaperValue,
    /// What counts as agreement.
    pub read_as: Interval,
    /// Why that interval, for the reader; empty where the paper gives it.
    pub interpretation: String,
}

impl Band {
    /// A range that the paper prints.
    pub fn range(low: f64, high: f64) -> Self {
        let interval = Interval::new(low, high);
        Self {
            paper: PaperValue::Range(interval),
            read_as: interval,
            interpretation: String::new(),
        }
    }

    /// A value that the paper prints with the given number of decimals:
    /// everything that rounds to it agrees.
    pub fn printed(value: f64, decimals: i32) -> Self {
        let half = 0.5 * 10f64.powi(-decimals);
        Self {
            paper: PaperValue::Value { value },
            read_as: Interval::new(value - half, value + half),
            interpretation: format!("Read as what rounds to the number printed: ±{half}."),
        }
    }

    /// A count, which is met exactly or not at all.
    pub fn count(value: usize) -> Self {
        let value = value as f64;
        Self {
            paper: PaperValue::Value { value },
            read_as: Interval::new(value, value),
            interpretation: String::new(),
        }
    }

    /// "About" a value; the half width is ours.
    pub fn about(value: f64, half_width: f64, unit: &str) -> Self {
        Self {
            paper: PaperValue::Value { value },
            read_as: Interval::new(value - half_width, value + half_width),
            interpretation: format!(
                "The paper gives about {value}; read as ±{half_width} {unit}. The width is ours, the \
                 paper gives none."
            ),
        }
    }
}

/// Half width in percentage points given to "about 80 %" and "around 85 %".
/// Ours: the numbers are rounded to 5, so that the next ones would have been
/// printed had they been nearer than this.
pub const ABOUT_PERCENT_POINTS: f64 = 5.0;

/// Final settlement of the top plate after 20 s of continuous vibration, in mm
/// (section 4 and Figure 9, hatched: range of the laboratory tests).
pub fn final_settlement_mm() -> Band {
    Band::range(14.0, 19.61)
}

/// Share of the settlement after the first 5 s of continuous vibration, in
/// percent (section 4: "in all the three cases, about 80%").
pub fn share_after_5_s_percent() -> Band {
    Band::about(80.0, ABOUT_PERCENT_POINTS, "percentage points")
}

/// Share of the settlement in the first period of intermittent vibration, in
/// percent (section 4: "Around 85%").
pub fn share_in_first_period_percent() -> Band {
    Band::about(85.0, ABOUT_PERCENT_POINTS, "percentage points")
}

/// Number of grains in 100 g (section 3: "55 to 65 gravel stones").
pub fn grains_in_100_g() -> Band {
    Band::range(55.0, 65.0)
}

/// Total mass in g.
pub fn total_mass_g() -> Band {
    Band::printed(constants::TOTAL_MASS_G, 0)
}

/// Density of the solids in kg/m³.
pub fn solid_density_kg_per_m3() -> Band {
    Band::printed(constants::SOLID_DENSITY_KG_PER_M3, 1)
}

/// Time between two interpretations of the plate in s.
pub fn monitoring_interval_s() -> Band {
    Band::printed(constants::MONITORING_INTERVAL_S, 2)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_interval_holds_its_ends_and_nothing_beyond() {
        let band = final_settlement_mm().read_as;
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
        let density = solid_density_kg_per_m3().read_as;
        for (value, expected) in
            [(2673.86, true), (2673.94, true), (2673.8, false), (2674.0, false)]
        {
            assert_eq!(density.contains(value), expected, "{value} rounds to 2673.9: {expected}");
        }
    }

    #[test]
    fn about_is_five_points_either_way_and_says_so() {
        let band = share_after_5_s_percent();
        assert_eq!(band.read_as, Interval::new(75.0, 85.0), "80 ± 5 percentage points");
        assert!(
            band.interpretation.contains("ours"),
            "the interpretation owns its width: {}",
            band.interpretation
        );
    }

    #[test]
    fn the_hull_of_values_leaves_out_what_is_no_number() {
        assert_eq!(Interval::of([2.0, f64::NAN, -1.0]), Some(Interval::new(-1.0, 2.0)));
        assert_eq!(Interval::of([f64::NAN]), None);
        assert_eq!(Interval::of([]), None);
    }

    #[test]
    fn paper_values_look_as_scripts_expect() {
        let json = |b: Band| serde_json::to_string(&b.paper).expect("serialises");
        assert_eq!(json(final_settlement_mm()), r#"{"low":14.0,"high":19.61}"#);
        assert_eq!(json(Band::count(3)), r#"{"value":3.0}"#);
    }
}
