//! Checks what a scenario means, once its fields are what the schema asks for.
//!
//! The parts are taken from the JSON one by one, so that a fault in one part
//! does not hide those of another: a check whose part cannot be read is left
//! out, and the schema has already said why.

mod apparatus;
mod engine;
mod grains;
mod loads;
mod mean_stress;
mod motion;
mod moves;
mod pieces;
mod sampling;
mod stages;
mod time_step;
mod until;

pub(super) use crate::plain::four_digits as short;
pub(super) use time_step::least_rate_hz;

// What the checks are made of, too.
use std::collections::{BTreeSet, HashSet};

use serde::de::DeserializeOwned;

use super::*;
use crate::geometry::Point;
use crate::motion::TableMotion;
use crate::plain::{counted, in_number, misleads};

/// The parts of a scenario that could be read.
struct Parts {
    /// Also of meshes that are drawn by a sieve table; `None` where the grains
    /// come from a file, and where meshes keep their own size.
    sieved: Option<SievedGrains>,
    /// Of all grains whose sizes are known.
    grading: Option<Grading>,
    meshes: Option<MeshGrains>,
    cylinder: Option<CylinderSpec>,
    funnel: Option<FunnelSpec>,
    top_plate: Option<TopPlateSpec>,
    engine: Option<EngineSettings>,
    settle: Option<SettleSpec>,
    gravity: Option<f64>,
    rest_test_s: Option<f64>,
    sample_interval_s: Option<f64>,
    /// Stages that a specimen of another run has been through, where one is begun with; none of one
    /// that could not be looked up.
    begun_after: Option<Vec<String>>,
    stages: Vec<Stage>,
    /// The pieces of a laboratory; none where one could not be read.
    pieces: Vec<Option<PieceSpec>>,
    /// Whether `pieces` is there and no list, which is a fault of its own.
    are_pieces_unread: bool,
    measures: Option<MeasuresSpec>,
}

/// A stage as far as it could be read.
struct Stage {
    name: Option<String>,
    spec: Option<StageSpec>,
}

impl Stage {
    /// Its name where there are stages of that name.
    fn known(&self) -> Option<&str> {
        let is_stage = |name: &&str| {
            *name == "rest" || pieces::BUILT_IN.contains(name) || pieces::OF_PIECES.contains(name)
        };
        self.name.as_deref().filter(is_stage)
    }
}

impl Parts {
    /// `found` is what is known of grains that have no sieve table.
    fn of(value: &Value, found: Option<&Grading>) -> Self {
        let stage = |value: &Value| Stage {
            name: value.get("stage").and_then(Value::as_str).map(str::to_owned),
            spec: read(value),
        };
        let number = |name: &str, default: f64| match value.get(name) {
            None => Some(default),
            Some(value) => value.as_f64(),
        };
        let sieved = sieved(field(value, "/grains"));
        Self {
            grading: match &sieved {
                Some(sieved) => Grading::of_table(sieved),
                None => found.copied(),
            },
            sieved,
            meshes: read(field(value, "/grains")),
            cylinder: cylinder(value),
            funnel: read_or_default(value, "/apparatus/funnel"),
            top_plate: read_or_default(value, "/apparatus/top_plate"),
            engine: read_or_default(value, "/engine"),
            settle: read_or_default(value, "/settle"),
            gravity: number("gravity_m_per_s2", super::default_gravity()),
            rest_test_s: number("rest_test_s", super::default_rest_test()),
            sample_interval_s: number("sample_interval_s", SAMPLE_INTERVAL),
            begun_after: value.get("begin").map(|begin| {
                let begin: Option<BeginSpec> = read(begin);
                begin.map(|begin| begin.after).unwrap_or_default()
            }),
            stages: elements(value, "stages").map(stage).collect(),
            pieces: elements(value, "pieces").map(read).collect(),
            are_pieces_unread: value.get("pieces").is_some_and(|pieces| !pieces.is_array()),
            measures: read_or_default(value, "/measures"),
        }
    }

    /// Largest opening a grain passes, in mm.
    fn coarsest_mm(&self) -> Option<f64> {
        let mm = match &self.sieved {
            Some(s) => with_grains(s).map(|f| f.passing_mm).max_by(f64::total_cmp)?,
            None => shown_mm(self.grading?.sizes.largest),
        };
        Some(mm).filter(|mm| *mm > 0.0)
    }

    /// Smallest opening that retains a grain, in mm.
    fn finest_mm(&self) -> Option<f64> {
        let mm = match &self.sieved {
            Some(s) => with_grains(s).map(|f| f.retained_mm).min_by(f64::total_cmp)?,
            None => shown_mm(self.grading?.sizes.smallest),
        };
        Some(mm).filter(|mm| *mm > 0.0)
    }

    /// The stages that could be read, with their numbers.
    fn specs(&self) -> impl Iterator<Item = (usize, &StageSpec)> {
        self.stages.iter().enumerate().filter_map(|(i, stage)| Some((i, stage.spec.as_ref()?)))
    }

    fn has_stage(&self, name: &str) -> bool {
        self.stages.iter().any(|stage| stage.name.as_deref() == Some(name))
    }

    /// Whether the scenario begins with a specimen that could not be looked up, which is a fault of
    /// its own: anything may have been done to it, and any pieces may stand.
    fn begins_with_unknown(&self) -> bool {
        self.begun_after.as_deref().is_some_and(<[String]>::is_empty)
    }
}

/// Those of some fields that are given: what was found where one of them is to be.
fn given(fields: &[(&'static str, bool)]) -> Vec<&'static str> {
    fields.iter().filter(|(_, is_given)| *is_given).map(|(field, _)| *field).collect()
}

/// The fractions that have grains.
fn with_grains(sieved: &SievedGrains) -> impl Iterator<Item = &SieveFraction> {
    sieved.sieve_table.iter().filter(|fraction| fraction.has_grains())
}

/// A size in m as messages have it: in mm, to nine digits.
fn shown_mm(size: f64) -> f64 {
    nine_digits(to_mm(size))
}

/// A number rounded to nine digits: as near as people type one.
fn nine_digits(value: f64) -> f64 {
    format!("{value:.8e}").parse().unwrap_or(value)
}

/// A lower bound as [`short`] has it, rounded up: who types it is not refused for its last digit.
fn no_less(value: f64) -> String {
    rounded(value, f64::ceil)
}

/// An upper bound as [`short`] has it, rounded down.
fn no_more(value: f64) -> String {
    rounded(value, f64::floor)
}

fn rounded(value: f64, to: fn(f64) -> f64) -> String {
    let text = short(value);
    let shown = text.parse().unwrap_or(value);
    // What differs in its last bits alone is the same number.
    if !value.is_finite() || nine_digits(value) == shown {
        return text;
    }
    let exponent = 3.0 - value.abs().log10().floor();
    let decimals = if value.abs() < 1e12 { exponent.clamp(0.0, 12.0) } else { exponent };
    let unit = 10f64.powf(-decimals);
    short(to(value / unit) * unit)
}

fn read_or_default<T: DeserializeOwned>(value: &Value, pointer: &str) -> Option<T> {
    match value.pointer(pointer) {
        Some(value) => read(value),
        None => read(&Value::Object(Map::new())),
    }
}

/// A cylinder that has a size: one without has been reported, and says nothing of what must fit
/// into it.
fn cylinder(value: &Value) -> Option<CylinderSpec> {
    let cylinder: CylinderSpec = read_or_default(value, "/apparatus/cylinder")?;
    (cylinder.inner_diameter_mm > 0.0 && cylinder.height_mm > 0.0).then_some(cylinder)
}

/// Every fault of meaning in the JSON of a scenario, without the file; `found` is what is known
/// of grains that have no sieve table.
pub(super) fn faults(value: &Value, found: Option<&Grading>) -> Vec<Fault> {
    let parts = Parts::of(value, found);
    let mut found = Vec::new();
    let faults = &mut Faults::of(&mut found);
    check_name(field(value, "/name"), faults);
    grains::check(&parts, faults);
    IndexDensitiesSpec::check(value, faults);
    apparatus::check(&parts, faults);
    pieces::check(&parts, faults);
    stages::check(&parts, faults);
    motion::check(&parts, faults);
    engine::check(&parts, faults);
    time_step::check(&parts, faults);
    sampling::check(&parts, faults);
    found
}

/// How a warning of steps that cannot resolve the motion begins.
const LET_PASS: &str = "let pass by engine.allow_coarse_steps: ";

/// Whether a warning is of steps that cannot resolve the motion.
pub fn is_of_coarse_steps(warning: &str) -> bool {
    warning.starts_with(LET_PASS)
}

/// What a valid scenario's results must be read with: values that are typed and far from what the
/// grains ask for, apparatus that does not suit them, samples that do not show a vibration, and steps
/// that cannot resolve the motion but that `engine.allow_coarse_steps` lets pass.
pub fn warnings(scenario: &Scenario) -> Vec<String> {
    let Ok(value) = serde_json::to_value(scenario) else { return Vec::new() };
    let parts = Parts::of(&value, scenario.found.as_ref());
    let unusual = unusual::unusual(scenario, &value);
    let mut warnings: Vec<String> = unusual.iter().map(ToString::to_string).collect();
    warnings.extend(sampling::coarse(&parts).iter().map(ToString::to_string));
    if parts.engine.as_ref().is_some_and(|e| e.allow_coarse_steps) {
        let mut coarse = Vec::new();
        time_step::find_coarse_steps(&parts, &mut Faults::of(&mut coarse));
        let words = |fault: &Fault| format!("{LET_PASS}{fault}");
        warnings.extend(coarse.iter().map(words));
    }
    warnings
}

/// A number with all its digits, as somebody typed it, unless these are zeros by the dozen.
pub(super) fn as_typed(value: f64) -> String {
    let is_short = value == 0.0 || !value.is_finite() || (1e-9..1e12).contains(&value.abs());
    if is_short { value.to_string() } else { format!("{value:.3e}") }
}

/// Whether a character leaves no trace in a line.
fn has_no_width(c: char) -> bool {
    matches!(c, '\u{ad}' | '\u{200b}'..='\u{200d}' | '\u{2060}'..='\u{2064}' | '\u{feff}')
}

/// The name becomes the name of a folder.
fn check_name(value: &Value, faults: &mut Faults) {
    let Some(name) = value.as_str() else { return };
    let shown = shown(value);
    let code_points = |which: fn(char) -> bool| {
        let found: BTreeSet<char> = name.chars().filter(|c| which(*c)).collect();
        let points = found.into_iter().map(|c| format!("U+{:04X}", u32::from(c)));
        points.collect::<Vec<String>>().join(", ")
    };
    let allowed = "letters, digits and signs that are seen, and spaces";
    let points = code_points(misleads);
    let why = format!("the name holds what is not seen but changes how it is read: {points}");
    faults.add_if(!points.is_empty(), "name", &shown, allowed, why);
    let wrong = name.contains(['/', '\\']) || name.starts_with('.') || name.trim() != name;
    let allowed =
        "a text without / and \\, that begins with no dot and begins and ends with no space";
    faults.add_if(wrong, "name", &shown, allowed, "the name cannot be that of a folder");
    let unseen = !name.is_empty() && name.chars().all(has_no_width);
    let allowed = "a text with letters, digits or signs that are seen";
    let why = format!("nothing of the name is seen: {}", code_points(has_no_width));
    faults.add_if(unseen, "name", shown, allowed, why);
}

#[cfg(test)]
mod tests {
    use super::{as_typed, no_less, no_more, short};

    /// Law: a bound that is shown is one: a lower one is not below the number, an upper one not above
    /// it, and a number of four digits is itself.
    #[test]
    fn bounds_that_are_shown_are_kept() {
        for (value, above, below) in [
            (1.0 / 3.0, "0.3334", "0.3333"),
            (29.6232, "29.63", "29.62"),
            (29.628, "29.63", "29.62"),
            (-29.6232, "-29.62", "-29.63"),
            (0.1 + 0.2, "0.3", "0.3"),
            (115.0, "115", "115"),
            (9999.5, "10000", "9999"),
            (123_456.2, "123457", "123456"),
            (1.234_56e300, "1.235e300", "1.234e300"),
            (0.0, "0", "0"),
        ] {
            assert_eq!(no_less(value), above, "law: four digits that are at least {value}");
            assert_eq!(no_more(value), below, "law: four digits that are at most {value}");
        }
    }

    #[test]
    fn numbers_are_short() {
        for (value, expected) in [
            (0.0, "0"),
            (36.944_44, "36.94"),
            (8.0, "8"),
            (277.0, "277"),
            (0.001_234_56, "0.001235"),
            (123_456.0, "123456"),
            (1.234_56e300, "1.235e300"),
        ] {
            assert_eq!(short(value), expected, "law: four significant digits of {value}");
        }
        for (value, expected) in
            [(0.0, "0"), (36.944_44, "36.94444"), (1e300, "1.000e300"), (1e-300, "1.000e-300")]
        {
            assert_eq!(as_typed(value), expected, "law: every digit of {value} that counts");
        }
    }
}
