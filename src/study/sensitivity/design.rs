//! The design of a sensitivity study: which parameters are varied, one at a time, and how far.

use super::*;
use crate::scenario::renamed_field;

/// Name of the variation that changes nothing.
pub(super) const DEFAULT: &str = "default";

/// A sensitivity study as its file describes it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SensitivityDesign {
    /// What the study is for.
    #[serde(default)]
    pub description: String,
    /// The specimen.
    pub full: SpecimenDesign,
    /// A smaller one, for `--quick`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub quick: Option<SpecimenDesign>,
    /// The parameters, each varied by itself.
    #[schemars(length(min = 1, max = 1000))]
    pub parameters: Vec<ParameterDesign>,
}

/// One parameter and its range.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ParameterDesign {
    /// Short name; begins the names of runs.
    #[schemars(length(min = 1, max = 40))]
    pub name: String,
    /// What it is, for tables and figures.
    #[schemars(length(min = 1, max = 60))]
    pub title: String,
    /// Unit of its values; empty where it has none.
    #[serde(default)]
    pub unit: String,
    /// Why it is varied so far and no further.
    #[schemars(length(min = 1))]
    pub reason: String,
    /// Path of its value in the scenario, as in `--set`; left out where the
    /// ends are made by changes of several values.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub path: Option<String>,
    /// The low end; that of the default where only higher values are of interest.
    pub low: f64,
    /// The scenario's own value, which it must be. With `path` it may be left
    /// out: it is then read from the scenario.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub default: Option<f64>,
    /// The high end.
    pub high: f64,
    /// Changes that make the low end, each `path=value`, in place of `path`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub low_changes: Vec<String>,
    /// Changes that make the high end.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub high_changes: Vec<String>,
    /// The low end on the smaller specimen, where it is another.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub quick_low: Option<f64>,
    /// The smaller specimen's own value, where it is another.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub quick_default: Option<f64>,
    /// The high end on the smaller specimen, where it is another.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub quick_high: Option<f64>,
    /// Whether it is also varied with `--quick`.
    #[serde(default = "yes")]
    pub quick: bool,
}

/// A parameter that was checked, with what makes its ends.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Parameter {
    /// Short name.
    pub name: String,
    /// What it is, for tables and figures.
    pub title: String,
    /// Unit of its values; empty where it has none.
    pub unit: String,
    /// Why it is varied so far and no further.
    pub reason: String,
    /// Path of its value in the scenario; empty where several are changed.
    pub path: String,
    /// The low end.
    pub low: f64,
    /// The scenario's own value.
    pub default: f64,
    /// The high end.
    pub high: f64,
    /// What makes the low end, each `path=value`; nothing where it is the default.
    pub low_changes: Vec<String>,
    /// What makes the high end.
    pub high_changes: Vec<String>,
}

/// Which of a parameter's values.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::study) enum End {
    /// The least.
    Low,
    /// The scenario's own.
    Default,
    /// The largest.
    High,
}

impl Parameter {
    /// Name of the variation at one of its ends; [`DEFAULT`] where that is the
    /// scenario's own value.
    pub(super) fn variation(&self, end: End) -> String {
        match end {
            End::Low if self.low != self.default => format!("{}-low", self.name),
            End::High if self.high != self.default => format!("{}-high", self.name),
            End::Low | End::Default | End::High => DEFAULT.to_owned(),
        }
    }
}

/// A design ready to be run.
#[derive(Debug)]
pub(in crate::study) struct Designed {
    pub chosen: Chosen,
    pub parameters: Vec<Parameter>,
    pub varied: Varied,
}

/// Reads a design; tells all its faults, or else all of the scenarios it makes. `more` are changes
/// that every run has beside those of the design.
pub(in crate::study) fn read(
    file: &Path,
    quick: bool,
    more: &[Override],
) -> Result<Designed, ScenarioErrors> {
    let design: SensitivityDesign = load_document(file)?;
    let mut faults = Faults::of(file);
    let chosen = faults.chosen(&design.full, design.quick.as_ref(), quick);
    let Some(mut chosen) = chosen else { return Err(faults.into_error()) };
    chosen.common.extend_from_slice(more);
    let scenario = match load_scenario(&chosen.scenario, &chosen.common) {
        Ok(loaded) => serde_json::to_value(&loaded.scenario).unwrap_or(Value::Null),
        Err(errors) => return Err(faults.with(errors)),
    };
    let mut names = vec![DEFAULT];
    let mut parameters = Vec::new();
    let mut variations = vec![Variation::new(DEFAULT, DEFAULT, Vec::new())];
    for (index, parameter) in design.parameters.iter().enumerate() {
        let at = format!("parameters[{index}]");
        faults.name(&format!("{at}.name"), &parameter.name, &mut names);
        if quick && !parameter.quick {
            continue;
        }
        if let Some((made, ends)) = ends(&mut faults, &at, parameter, quick, &scenario) {
            variations.extend(ends);
            parameters.push(made);
        }
    }
    let varied = faults.load(&chosen, variations)?;
    Ok(Designed { chosen, parameters, varied })
}

/// A parameter's ends, or its faults.
fn ends(
    faults: &mut Faults,
    at: &str,
    p: &ParameterDesign,
    quick: bool,
    scenario: &Value,
) -> Option<(Parameter, Vec<Variation>)> {
    let of = |full: Option<f64>, small: Option<f64>| if quick { small.or(full) } else { full };
    let (low, high) = (of(Some(p.low), p.quick_low)?, of(Some(p.high), p.quick_high)?);
    let given = of(p.default, p.quick_default);
    let default = match &p.path {
        Some(path) => default_at(faults, at, path, given, scenario)?,
        None => {
            let Some(default) = given else {
                let allowed = "the scenario's own value, where there is no `path`";
                faults.add(&format!("{at}.default"), "", allowed, "the field is missing");
                return None;
            };
            default
        }
    };
    if !(low <= default && default <= high && low < high) {
        faults.add(
            &format!("{at}.low"),
            &format!("{low}, {default}, {high}"),
            "low, default and high in this order, low below high",
            "the range is out of order",
        );
        return None;
    }
    let mut end = |which: &str, value: f64, changes: &[String]| -> Option<Vec<Override>> {
        if value == default {
            return Some(Vec::new());
        }
        let field = format!("{at}.{which}_changes");
        match (&p.path, changes) {
            (Some(path), []) => Some(vec![format!("{path}={value}").parse().ok()?]),
            (None, []) => {
                let allowed = "changes that make this end, or else `path`";
                faults.add(&field, "", allowed, "nothing says how this end is made");
                None
            }
            (Some(_), _) => {
                faults.add(&field, "", "none beside `path`", "`path` already makes this end");
                None
            }
            (None, changes) => Some(faults.changes(&field, changes)),
        }
    };
    let (at_low, at_high) = (end("low", low, &p.low_changes), end("high", high, &p.high_changes));
    let (at_low, at_high) = at_low.zip(at_high)?;
    let texts = |of: &[Override]| of.iter().map(|c| c.text().to_owned()).collect();
    let parameter = Parameter {
        name: p.name.clone(),
        title: p.title.clone(),
        unit: p.unit.clone(),
        reason: p.reason.clone(),
        path: p.path.clone().unwrap_or_default(),
        low,
        default,
        high,
        low_changes: texts(&at_low),
        high_changes: texts(&at_high),
    };
    // An end that is the default is no variation of its own.
    let ends = [(End::Low, at_low), (End::High, at_high)].map(|(end, made)| {
        let name = parameter.variation(end);
        (name != DEFAULT).then(|| Variation::new(name, &p.title, made))
    });
    Some((parameter, ends.into_iter().flatten().collect()))
}

/// The scenario's own value at a path, which must be the one that is given.
fn default_at(
    faults: &mut Faults,
    at: &str,
    path: &str,
    given: Option<f64>,
    scenario: &Value,
) -> Option<f64> {
    let found = format!("\"{path}\"");
    let field = format!("{at}.path");
    let Ok(change) = format!("{path}=0").parse::<Override>() else {
        faults.add(&field, &found, "a path as in --set", "the path cannot be read");
        return None;
    };
    let Some(own) = change.value_before(scenario).and_then(Value::as_f64) else {
        let message = match renamed_field(path) {
            Some(now) => format!("this field is now called `{now}`"),
            None => "the scenario has no number there".to_owned(),
        };
        faults.add(&field, &found, "the path of a number", &message);
        return None;
    };
    match given {
        Some(given) if given != own => {
            faults.add(
                &format!("{at}.default"),
                &given.to_string(),
                &format!("{own}, the scenario's own"),
                "the scenario has another value",
            );
            None
        }
        _ => Some(own),
    }
}
