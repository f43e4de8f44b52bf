//! What a calibration is asked: which result is wanted, and which field of the
//! scenario is to give it.

use super::*;
use crate::report::{numbers_in, unit_of};
use crate::scenario::{nearest, renamed_field, renamed_result};

/// A result of a run that is to have a value: a number of its `summary.json`.
#[derive(Debug, Clone, PartialEq)]
pub struct CalibrationTarget {
    /// The field of `summary.json`.
    pub field: String,
    /// Its wanted value.
    pub wanted: f64,
    place: Override,
}

/// Where `summary.json` has the angle of repose.
pub(super) const ANGLE_OF_REPOSE: &str = "angle_of_repose.degrees";
/// Where a scenario has the friction between grains.
pub const GRAIN_FRICTION: &str = "contact.grain_grain_friction";

impl FromStr for CalibrationTarget {
    type Err = String;

    /// Reads `field=value`, as `standing_height_mm.mean_surface=160`.
    fn from_str(text: &str) -> Result<Self, String> {
        let bad =
            || format!("`{text}` is not field=number, as in standing_height_mm.mean_surface=160");
        let (field, wanted) = text.split_once('=').ok_or_else(bad)?;
        let wanted = wanted.trim().parse().ok().filter(|v: &f64| v.is_finite()).ok_or_else(bad)?;
        let place = text.parse().map_err(|_| bad())?;
        Ok(Self { field: field.trim().to_owned(), wanted, place })
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Reading {
    Number(f64),
    /// The field, or what it is part of, is null.
    NotMeasured,
    /// There is no such field, or it is no number.
    Missing,
}

impl CalibrationTarget {
    /// An angle of repose in degrees.
    ///
    /// # Errors
    /// When it is not between 0 and 90.
    pub fn angle_of_repose(degrees: f64) -> Result<Self, String> {
        if !(degrees > 0.0 && degrees < 90.0) {
            return Err(format!("an angle of repose lies between 0 and 90 degrees, not {degrees}"));
        }
        format!("{ANGLE_OF_REPOSE}={degrees}").parse()
    }

    /// Its unit, as its name says; empty for pure numbers.
    pub fn unit(&self) -> &'static str {
        // A share of a length in mm is no length.
        let last = self.field.rsplit('.').next().unwrap_or_default();
        if last.starts_with("share_") || last == "count" {
            return "";
        }
        let parts = self.field.rsplit('.').map(|part| part.split('[').next().unwrap_or_default());
        parts.map(unit_of).find(|unit| !unit.is_empty()).unwrap_or("")
    }

    pub(super) fn read(&self, summary: &Value) -> Reading {
        match self.place.value_before(summary) {
            Some(Value::Null) => Reading::NotMeasured,
            Some(value) => value.as_f64().map_or(Reading::Missing, Reading::Number),
            None => {
                // Part of what was not measured is not there either.
                let mut at = summary;
                for part in self.field.split('.') {
                    match at.get(part) {
                        Some(Value::Null) => return Reading::NotMeasured,
                        Some(next) => at = next,
                        None => return Reading::Missing,
                    }
                }
                Reading::Missing
            }
        }
    }

    /// Says what a summary has in place of the field.
    pub(super) fn not_there(&self, summary: &Value, reading: Reading) -> StudyError {
        if matches!(reading, Reading::NotMeasured) {
            let warnings = summary["warnings"].as_array().into_iter().flatten();
            let told: Vec<&str> = warnings.filter_map(Value::as_str).collect();
            let told = if told.is_empty() { "no warning says why" } else { &told.join("; ") };
            return StudyError::Scenario(format!(
                "the first run did not measure `{}`, it is null ({told}). Where a value of the \
                 range is at fault, choose another one with --between",
                self.field
            ));
        }
        StudyError::Scenario(format!(
            "summary.json of a run has no number at `{}`; it has {}",
            self.field,
            paths_of_numbers(summary).join(", ")
        ))
    }
}

/// Paths of all numbers of a value.
fn paths_of_numbers(value: &Value) -> Vec<String> {
    numbers_in("", value, ["[", "]"]).into_iter().map(|(path, _)| path).collect()
}

impl FromStr for Interval {
    type Err = String;

    /// Reads a range of values, `0.2..1.2`.
    fn from_str(text: &str) -> Result<Self, String> {
        match range(text) {
            Some((low, high)) if low < high => Ok(Self::new(low, high)),
            Some((low, high)) => Err(format!(
                "the range {low}..{high} is empty or reversed: the lower end comes first"
            )),
            None => Err(format!("`{text}` is not a range, as in 0.2..1.2")),
        }
    }
}

/// Whether the field of the scenario that is sought takes whole numbers only; an error where there
/// is none, it is no number, or it names samples.
pub(super) fn takes_whole(field: &str, scenario: &Scenario) -> Result<bool, StudyError> {
    let fault = |why: &str| refused(format!("--unknown {field}: {why}"));
    if Scenario::names_realisations(field) {
        return fault("it tells samples apart, of which --realisations takes several");
    }
    let Ok(place) = format!("{field}=0").parse::<Override>() else {
        return fault("that is no path of a field, as contact.grain_grain_friction");
    };
    let all = serde_json::to_value(scenario)
        .map_err(|e| StudyError::Scenario(format!("the scenario has no JSON form: {e}")))?;
    match place.value_before(&all) {
        Some(Value::Number(number)) => return Ok(number.is_u64() || number.is_i64()),
        Some(other) => return fault(&format!("the scenario has no number there but {other}")),
        None => {}
    }
    if let Some(now) = renamed_field(field) {
        return fault(&format!("this field is now called `{now}`"));
    }
    let numbers = paths_of_numbers(&all);
    let near = nearest(field, numbers.iter().map(String::as_str));
    let meant = near.map_or(String::new(), |near| format!("; did you mean `{near}`?"));
    fault(&format!("the scenario has no such field{meant}"))
}

/// Checks that a summary may hold the target; says which number was meant, where one is near.
pub(super) fn known(target: &CalibrationTarget) -> Result<(), StudyError> {
    let numbers = summary_numbers();
    let asked = numbered(&target.field);
    if numbers.contains(&asked) {
        return Ok(());
    }
    let field = &target.field;
    let now = renamed_result(&asked);
    if let Some(now) = now.as_ref().filter(|now| numbers.contains(now)) {
        return refused(format!("--target {field}: this number is now called `{now}`"));
    }
    if let Some(now) = now.as_ref().filter(|_| !asked.contains('.')) {
        let what = format!("this result is now called `{now}`, which is no number");
        return refused(format!("--target {field}: {what}"));
    }
    let asked = now.unwrap_or(asked);
    let near = nearest(&asked, numbers.iter().map(String::as_str));
    let meant = match near.or_else(|| only_one_of_name(&asked, &numbers)) {
        Some(known) => format!("; did you mean `{known}`?"),
        None => format!("; it has {} and {} more", SHOWN.join(", "), numbers.len() - SHOWN.len()),
    };
    refused(format!("--target {field}: no summary.json has such a number{meant}"))
}

/// The one path that ends with the same name as another; none where several do.
fn only_one_of_name<'a>(path: &str, of: &'a [String]) -> Option<&'a str> {
    let last = |path: &str| path.rsplit('.').next().unwrap_or_default().to_owned();
    let name = last(path);
    let mut found = of.iter().filter(|known| last(known) == name);
    let one = found.next()?;
    found.next().is_none().then_some(one.as_str())
}

/// Checks that a scenario measures the target, as far as its stages say so; or what it would need.
pub(super) fn measured(target: &CalibrationTarget, scenario: &Scenario) -> Result<(), StudyError> {
    let has = |name: &str| scenario.stages.iter().any(|stage| stage.name() == name);
    // Plate and base stay with a specimen that is begun with; what is measured during a stage does
    // not.
    let begun_after = scenario.begin.as_ref().map_or(&[][..], |begin| begin.after.as_slice());
    let was = |name: &str| has(name) || begun_after.iter().any(|stage| stage == name);
    let vibrates = ("a stage `vibrate`", has("vibrate"));
    let plate = ("a stage `place_top_plate`", was("place_top_plate"));
    let pours = ("a stage `pour`", has("pour"));
    // Voids are counted within the cylinder's walls, up to the surface.
    let is_in_cylinder = scenario.pieces.is_empty() && !was("slow_pluviation");
    let in_cylinder = ("a specimen in the cylinder", is_in_cylinder);
    let needs: &[(&str, bool)] = match numbered(&target.field).split(['.', '[']).next() {
        Some("settlement_mm") => &[plate, vibrates],
        Some("surface_settlement_mm" | "vibrations") => &[vibrates],
        Some("poured_height_mm" | "poured_void_ratio") => &[pours],
        Some("angle_of_repose") => &[("a stage `slow_pluviation`", was("slow_pluviation"))],
        Some("laboratory") => &[("`pieces`", !scenario.pieces.is_empty())],
        Some("void_ratio" | "porosity" | "core") => &[in_cylinder],
        Some("relative_density") => {
            &[("`index_densities`", scenario.index_densities.is_some()), in_cylinder]
        }
        _ => &[],
    };
    let missing: Vec<&str> = needs.iter().filter(|(_, is)| !is).map(|(what, _)| *what).collect();
    if missing.is_empty() {
        return Ok(());
    }
    refused(format!(
        "--target {}: the scenario `{}` does not measure it: that needs {}",
        target.field,
        scenario.name,
        missing.join(" and ")
    ))
}

/// Numbers that are named where nothing is near.
const SHOWN: [&str; 5] = [
    "standing_height_mm.mean_surface",
    "void_ratio",
    "settlement_mm.final",
    "angle_of_repose.degrees",
    "coordination_number",
];

/// A path whose elements of lists are all alike: `a[2].b` and `a.2.b` are `a[0].b`.
fn numbered(path: &str) -> String {
    let steps = path.split(['.', '[', ']']).map(str::trim).filter(|step| !step.is_empty());
    steps.fold(String::new(), |path, step| match step.parse::<usize>() {
        Ok(_) => path + "[0]",
        Err(_) if path.is_empty() => step.to_owned(),
        Err(_) => path + "." + step,
    })
}

/// The path of every number that a summary may hold, in their order.
fn summary_numbers() -> Vec<String> {
    let schema = schemars::schema_for!(Summary).to_value();
    let mut numbers = Vec::new();
    add_numbers(&schema, &schema, String::new(), &mut numbers);
    numbers
}

fn add_numbers(schema: &Value, root: &Value, path: String, numbers: &mut Vec<String>) {
    if let Some(name) = schema["$ref"].as_str().and_then(|r| r.strip_prefix("#/$defs/")) {
        add_numbers(&root["$defs"][name], root, path, numbers);
        return;
    }
    for choice in ["anyOf", "oneOf"].iter().filter_map(|of| schema[of].as_array()).flatten() {
        add_numbers(choice, root, path.clone(), numbers);
    }
    let is = |kind: &str| match &schema["type"] {
        Value::Array(kinds) => kinds.iter().any(|k| k == kind),
        one => one == kind,
    };
    if (is("number") || is("integer")) && !numbers.contains(&path) {
        numbers.push(path.clone());
    }
    for (field, of) in schema["properties"].as_object().into_iter().flatten() {
        let path = if path.is_empty() { field.clone() } else { format!("{path}.{field}") };
        add_numbers(of, root, path, numbers);
    }
    if schema["items"].is_object() {
        add_numbers(&schema["items"], root, format!("{path}[0]"), numbers);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenario::BeginSpec;

    #[test]
    fn targets_are_fields_and_numbers() {
        let target: CalibrationTarget = "settlement_mm.final=12.5".parse().expect("a target");
        assert_eq!((target.field.as_str(), target.wanted), ("settlement_mm.final", 12.5));
        for text in ["", "a", "a=", "a=b", "=1", "a=nan", "a=inf"] {
            let refused = text.parse::<CalibrationTarget>();
            assert!(refused.is_err(), "`{text}` must be refused");
        }
        assert!(CalibrationTarget::angle_of_repose(38.4).is_ok());
        for degrees in [0.0, 90.0, -3.0, f64::NAN] {
            assert!(CalibrationTarget::angle_of_repose(degrees).is_err(), "{degrees}");
        }
    }

    /// Law: a misspelt result is reported before anything runs, one that a summary may hold is not.
    #[test]
    fn results_that_no_summary_has_are_refused() {
        let of = |field: &str| format!("{field}=1").parse::<CalibrationTarget>().expect("a target");
        for field in [
            ANGLE_OF_REPOSE,
            "standing_height_mm.mean_surface",
            "settlement_mm.final",
            "settlement_mm.after_each_period[3]",
            "settlement_mm.after_each_period.3",
            "grains.in_cylinder",
            "void_ratio",
            "vibrations[0].settling.time_s",
            "solver_residual.p99",
        ]
        .into_iter()
        .chain(SHOWN)
        {
            assert!(known(&of(field)).is_ok(), "law: `{field}` is a number of summaries");
        }
        for (field, meant) in [
            ("standing_height_mm.mean_surfase", "`standing_height_mm.mean_surface`"),
            ("void-ratio", "`void_ratio`"),
            ("settlement_mm", "settlement_mm"),
            ("guards.speed.worst", "now called `checks.speed.worst`"),
            ("control.duration_s", "now called `rest_test.duration_s`"),
            ("control.creep_um_per_s", "did you mean `creep_um_per_s`"),
            ("contact_path", "now called `contact_solver`, which is no number"),
            ("control", "now called `rest_test`, which is no number"),
            ("scenario", "it has"),
            ("colour", "it has"),
        ] {
            let said = known(&of(field)).expect_err("no number").to_string();
            assert!(said.contains(field) && said.contains(meant), "law: `{field}`, got `{said}`");
        }
    }

    /// Law: a result that no stage of the scenario gives is refused, one that a stage gives is not.
    #[test]
    fn results_that_no_stage_gives_are_refused() {
        let of = |field: &str| format!("{field}=1").parse::<CalibrationTarget>().expect("a target");
        let path =
            |name| concat!(env!("CARGO_MANIFEST_DIR"), "/scenarios/quick/").to_owned() + name;
        let scenario = |name| {
            let loaded = crate::grains::load_scenario(path(name).as_ref(), &[]);
            loaded.expect("a shipped scenario").scenario
        };
        let (vibration, repose) = (scenario("vibration.json"), scenario("repose.json"));
        for (field, needs) in [
            ("settlement_mm.final", "`place_top_plate` and a stage `vibrate`"),
            ("surface_settlement_mm.final", "a stage `vibrate`"),
            ("vibrations[0].settling.time_s", "a stage `vibrate`"),
            ("poured_void_ratio", "a stage `pour`"),
            ("void_ratio", "a specimen in the cylinder"),
            ("core.void_ratio", "a specimen in the cylinder"),
        ] {
            let said = measured(&of(field), &repose).expect_err("not measured").to_string();
            assert!(said.contains(field) && said.contains(needs), "law: `{field}`, got `{said}`");
            assert!(measured(&of(field), &vibration).is_ok(), "law: `{field}` is measured there");
        }
        let said = measured(&of(ANGLE_OF_REPOSE), &vibration).expect_err("no pile").to_string();
        assert!(said.contains("`slow_pluviation`"), "law: what a pile needs, got `{said}`");
        for field in [ANGLE_OF_REPOSE, "coordination_number", "overlap.p99_percent"] {
            assert!(measured(&of(field), &repose).is_ok(), "law: `{field}` is measured there");
        }
        let laboratory = scenario("../laboratory/oedometer.json");
        let said = measured(&of("porosity"), &laboratory).expect_err("no walls").to_string();
        assert!(said.contains("in the cylinder"), "law: regions have void ratios, got `{said}`");
        let of_region = of("laboratory.regions[0].void_ratio");
        assert!(measured(&of_region, &laboratory).is_ok(), "law: that of a region is measured");
    }

    /// Law: plate and base of the specimen that is begun with count, its pouring and vibration do
    /// not: this run has no rows of them.
    #[test]
    fn what_a_specimen_brings_along_is_measured() {
        let of = |field: &str| format!("{field}=1").parse::<CalibrationTarget>().expect("a target");
        let begun = |after: &[&str], stage: Value| {
            let mut scenario = crate::study::tests::bare_scenario();
            scenario.stages = vec![serde_json::from_value(stage).expect("a stage")];
            scenario.begin = Some(BeginSpec {
                specimen: "run".to_owned(),
                stage: None,
                after: after.iter().map(|name| (*name).to_owned()).collect(),
                key: None,
                specimen_sha256: None,
                taken_over: Vec::new(),
            });
            scenario
        };
        let vibrate = serde_json::json!({
            "stage": "vibrate", "frequency_hz": 3, "amplitude_mm": 10, "duration_s": 2
        });
        let rest = serde_json::json!({ "stage": "rest", "duration_s": 1 });
        let plated = ["fill_funnel", "pour", "place_top_plate", "vibrate"];
        let shaken = begun(&plated, vibrate);
        assert!(measured(&of("settlement_mm.final"), &shaken).is_ok(), "law: the plate is there");
        let pile = begun(&["slow_pluviation"], rest.clone());
        assert!(measured(&of(ANGLE_OF_REPOSE), &pile).is_ok(), "law: the pile is there");
        let at_rest = begun(&plated, rest);
        for (field, needs) in [
            ("settlement_mm.final", "a stage `vibrate`"),
            ("surface_settlement_mm.final", "a stage `vibrate`"),
            ("poured_void_ratio", "a stage `pour`"),
        ] {
            let said = measured(&of(field), &at_rest).expect_err("not measured").to_string();
            assert!(said.contains(needs), "law: `{field}` needs {needs}, got `{said}`");
            let plate = said.contains("place_top_plate");
            assert!(!plate, "law: the plate is there already, got `{said}`");
        }
    }

    #[test]
    fn units_are_those_of_the_names() {
        for (field, unit) in [
            ("standing_height_mm.mean_surface", "mm"),
            ("settlement_mm.after_5_s", "mm"),
            ("settlement_mm.share_after_5_s", ""),
            ("settlement_mm.after_each_period[1]", "mm"),
            ("angle_of_repose.degrees", "°"),
            ("void_ratio", ""),
            ("creep_um_per_s", "µm/s"),
            ("overlap.p99_percent", "%"),
            ("grains.count", ""),
            ("grains.mass_g", "g"),
            ("coordination_number", ""),
        ] {
            let target: CalibrationTarget = format!("{field}=1").parse().expect("a target");
            assert_eq!(target.unit(), unit, "unit of {field}");
        }
    }

    #[test]
    fn results_are_read_or_told_missing() {
        let summary = serde_json::json!({ "a": { "b": 7, "c": null }, "d": null, "e": "x" });
        for (field, expected) in [
            ("a.b", Reading::Number(7.0)),
            ("a.c", Reading::NotMeasured),
            ("d", Reading::NotMeasured),
            ("d.f", Reading::NotMeasured),
            ("e", Reading::Missing),
            ("a", Reading::Missing),
            ("g.h", Reading::Missing),
        ] {
            let target: CalibrationTarget = format!("{field}=1").parse().expect("a target");
            assert_eq!(target.read(&summary), expected, "{field}");
        }
        let target: CalibrationTarget = "z=1".parse().expect("a target");
        let said = target.not_there(&summary, Reading::Missing).to_string();
        assert!(said.contains("`z`") && said.contains("it has a.b"), "{said}");
    }

    #[test]
    fn ranges_run_upwards() {
        let range: Interval = "0.2..1.2".parse().expect("a range");
        assert_eq!((range.low, range.high), (0.2, 1.2));
        assert_eq!("-3..-1".parse(), Ok(Interval::new(-3.0, -1.0)));
        for text in ["1.2..0.2", "1..1", "1", "..", "a..b", "0..inf"] {
            assert!(text.parse::<Interval>().is_err(), "`{text}` must be refused");
        }
    }

    #[test]
    fn unknowns_are_numbers_of_the_scenario() {
        let scenario: Scenario = serde_json::from_value(serde_json::json!({
            "name": "s", "grains": { "file": "g.json" },
            "stages": [{ "stage": "pour", "falling_height_mm": 50 }]
        }))
        .expect("a scenario");
        for (field, whole) in [
            (GRAIN_FRICTION, false),
            ("engine.native.iterations", true),
            ("stages[0].falling_height_mm", false),
        ] {
            assert_eq!(takes_whole(field, &scenario).expect("a number"), whole, "{field}");
        }
        for (field, words) in [
            ("contact.colour", "no such field"),
            ("contact.grain_grain_frction", "did you mean `contact.grain_grain_friction`"),
            ("engine.manifold.sweeps", "now called `engine.native.iterations`"),
            ("control_s", "now called `rest_test_s`"),
            ("name", "no number there"),
            ("seed", "samples"),
            ("configuration", "samples"),
            ("a..b", "no path"),
        ] {
            let said = takes_whole(field, &scenario).expect_err("refused").to_string();
            assert!(said.contains(words) && said.contains(field), "{field}: {said}");
        }
    }
}
