//! What others ask a scenario.

use serde_json::Value;

use super::{Grading, GrainsSpec, Scenario, SieveFraction, StageSpec, StrokeReading};
use crate::scale::Scale;
use crate::units::{from_g, from_mm};

/// A vibration in SI units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Vibration {
    /// Frequency in Hz.
    pub frequency: f64,
    /// Half of the stroke in m: the table moves ± this.
    pub half_stroke: f64,
    /// Length of one period of vibration in s.
    pub duration: f64,
    /// Number of periods of vibration.
    pub periods: u32,
    /// Rest between periods in s.
    pub rest: f64,
    /// Time in s in which the amplitude grows and dies away in each period.
    pub ramp: f64,
}

impl Vibration {
    /// Largest speed of the table in m/s: 2πfA for x = A sin(2πft).
    pub fn peak_speed(&self) -> f64 {
        std::f64::consts::TAU * self.frequency * self.half_stroke
    }

    /// Time from the start of the first to the end of the last period, in s.
    pub fn total(&self) -> f64 {
        f64::from(self.periods) * self.duration
            + f64::from(self.periods.saturating_sub(1)) * self.rest
    }
}

impl StageSpec {
    /// Name of the stage as in the file.
    pub fn name(&self) -> &'static str {
        match self {
            Self::FillFunnel { .. } => "fill_funnel",
            Self::SlowPluviation { .. } => "slow_pluviation",
            Self::Pour { .. } => "pour",
            Self::PlaceTopPlate { .. } => "place_top_plate",
            Self::Vibrate { .. } => "vibrate",
            Self::Rest { .. } => "rest",
        }
    }

    /// The vibration of a stage that vibrates.
    pub fn vibration(&self) -> Option<Vibration> {
        let Self::Vibrate {
            frequency_hz,
            amplitude_mm,
            stroke,
            duration_s,
            periods,
            rest_s,
            ramp_s,
        } = *self
        else {
            return None;
        };
        let half = match stroke {
            StrokeReading::HalfStroke => 1.0,
            StrokeReading::FullStroke => 0.5,
        };
        Some(Vibration {
            frequency: frequency_hz,
            half_stroke: half * from_mm(amplitude_mm),
            duration: duration_s,
            periods,
            rest: rest_s,
            ramp: ramp_s,
        })
    }

    /// Longest simulated time the stage can take, in s.
    pub fn longest(&self) -> f64 {
        match *self {
            Self::FillFunnel { time_limit_s }
            | Self::SlowPluviation { time_limit_s, .. }
            | Self::Pour { time_limit_s, .. }
            | Self::PlaceTopPlate { time_limit_s } => time_limit_s,
            Self::Rest { duration_s } => duration_s,
            Self::Vibrate { .. } => self.vibration().map_or(0.0, |v| v.total()),
        }
    }
}

impl SieveFraction {
    /// Number of grains as a plain quotient, n = V / (π/6 · d³): the volume of
    /// the fraction's solids over that of a sphere whose diameter is the mean
    /// of the two openings (paper, section 3: "the average size of polyhedrons
    /// ... was set by the average mesh openings of the two successive sieves").
    /// Total mass in g, density in kg/m³.
    pub fn grain_count(&self, total_mass_g: f64, density_kg_per_m3: f64) -> f64 {
        let volume = from_g(total_mass_g) * self.mass_percent / 100.0 / density_kg_per_m3;
        let size = from_mm(f64::midpoint(self.passing_mm, self.retained_mm));
        volume / (std::f64::consts::PI / 6.0 * size.powi(3))
    }
}

impl Scenario {
    /// The scenario as JSON in which equal scenarios are equal text: every
    /// field present, fields in alphabetical order, no spaces, numbers in
    /// their shortest exact form. For hashing.
    ///
    /// # Panics
    /// Never: a scenario's types all have a JSON form.
    pub fn canonical_json(&self) -> String {
        let mut value = serde_json::to_value(self).expect("a scenario has a JSON form");
        value.sort_all_objects();
        value.to_string()
    }

    /// Opening in m of the finest sieve that retains grains; `None` for grains from a file
    /// and for meshes in their own size.
    pub fn smallest_sieve_m(&self) -> Option<f64> {
        let table = match &self.grains {
            GrainsSpec::Sieved(sieved) => &sieved.sieve_table,
            GrainsSpec::Meshes(meshes) => &meshes.sieve_table,
            GrainsSpec::File(_) => return None,
        };
        table.iter().map(|f| from_mm(f.retained_mm)).min_by(f64::total_cmp)
    }

    /// What our lengths, speeds and times follow from: the sizes of the sieve table, or
    /// else the size that the engine is given.
    pub fn scale(&self) -> Scale {
        let gravity = self.gravity_m_per_s2;
        match self.grading_by_sieves() {
            Some(Grading { sizes, density, .. }) => Scale { sizes, density, gravity },
            None => Scale::of_smallest(from_mm(self.engine.grain_size_mm), gravity),
        }
    }

    /// What the sieve table says of the grains; `None` where there is none.
    pub(super) fn grading_by_sieves(&self) -> Option<Grading> {
        match &self.grains {
            GrainsSpec::Sieved(sieved) => Grading::of_table(sieved),
            GrainsSpec::Meshes(meshes) => meshes.as_sieved().and_then(|s| Grading::of_table(&s)),
            GrainsSpec::File(_) => None,
        }
    }

    /// What is known of the grains: by the sieve table, or as found when they were read.
    pub(super) fn grading(&self) -> Option<Grading> {
        self.grading_by_sieves().or(self.found)
    }

    /// Falling height of the pour in mm, where grains are poured.
    pub fn falling_height_mm(&self) -> Option<f64> {
        self.stages.iter().find_map(|stage| match stage {
            StageSpec::Pour { falling_height_mm, .. } => Some(*falling_height_mm),
            _ => None,
        })
    }

    /// The first vibration, where the specimen is shaken.
    pub fn vibration(&self) -> Option<Vibration> {
        self.stages.iter().find_map(StageSpec::vibration)
    }

    /// Longest simulated time that stages and control can take, in s.
    pub fn longest(&self) -> f64 {
        self.stages.iter().map(StageSpec::longest).sum::<f64>() + self.control_s
    }
}

/// A field of an object, `null` where it is missing.
pub(super) fn field<'a>(value: &'a Value, pointer: &str) -> &'a Value {
    value.pointer(pointer).unwrap_or(&Value::Null)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scenario(stages: &str) -> Scenario {
        let text = format!(
            r#"{{ "name": "a", "stages": {stages}, "grains": {{ "total_mass_g": 2343,
              "density_kg_per_m3": 2673.9, "sieve_table": [
              {{ "passing_mm": 16, "retained_mm": 12.5, "mass_percent": 15 }},
              {{ "passing_mm": 12.5, "retained_mm": 8, "mass_percent": 85 }}] }} }}"#
        );
        serde_json::from_str(&text).expect("a scenario")
    }

    #[test]
    fn peak_speed_is_that_of_the_sinusoid() {
        let vibrate = |stroke: &str| {
            scenario(&format!(
                r#"[{{ "stage": "vibrate", "frequency_hz": 3, "amplitude_mm": 25,
                   "stroke": "{stroke}", "duration_s": 5, "periods": 4, "rest_s": 1 }}]"#
            ))
            .vibration()
            .expect("it vibrates")
        };
        let (half, full) = (vibrate("half_stroke"), vibrate("full_stroke"));
        for (got, expected) in
            [(half.peak_speed(), 0.471_239), (full.peak_speed(), 0.235_619), (half.total(), 23.0)]
        {
            assert!(
                (got - expected).abs() < 1e-6,
                "law: 2πfA, and 4 periods with 3 rests; expected {expected}, got {got}, tolerance 1e-6"
            );
        }
    }

    #[test]
    fn canonical_json_does_not_depend_on_the_file() {
        let a = scenario(r#"[{ "stage": "pour", "falling_height_mm": 50 }]"#);
        let b = scenario(r#"[{ "falling_height_mm": 50.0, "stage": "pour", "time_limit_s": 6 }]"#);
        let c = scenario(r#"[{ "stage": "pour", "falling_height_mm": 51 }]"#);
        assert_eq!(a.canonical_json(), b.canonical_json(), "equal scenarios, equal text");
        assert_ne!(a.canonical_json(), c.canonical_json(), "other scenarios, other text");
        let back: Scenario = serde_json::from_str(&a.canonical_json()).expect("it is a scenario");
        assert_eq!(back, a);
        assert_eq!(a.falling_height_mm(), Some(50.0));
        assert_eq!(a.smallest_sieve_m(), Some(0.008));
    }
}
