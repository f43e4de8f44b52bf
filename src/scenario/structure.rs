//! Checks raw JSON against the schema and says every fault in plain words.
//!
//! The schema's unions are decided first — grains by whether `file` or
//! `meshes` is there, a stage by its `stage`, its `until` by whether it is a list
//! or has `all_of` — and the part is then checked against that
//! variant alone: "not valid under any of the schemas" helps nobody.

use std::collections::HashSet;
use std::sync::LazyLock;

use jsonschema::Validator;
use jsonschema::error::ValidationErrorKind;

use super::*;

/// Elements of the longest list that a scenario may have, the rows of a recorded motion.
const LONGEST_LIST: usize = crate::motion::MOST_ROWS;

/// The outcome of a check; the faults lack their file.
pub(super) struct Checked {
    pub faults: Vec<Fault>,
    /// The value without the fields that no scenario has, and with no elements in
    /// lists that are too long.
    pub cleaned: Value,
}

pub(super) fn check(value: &Value) -> Checked {
    let mut short = value.clone();
    shorten(&mut short);
    let value = &short;
    let mut checked = Checked { faults: Vec::new(), cleaned: value.clone() };
    RULES.root.check(value, "", "", &mut checked);
    // Which pieces there are is not known where they are too many, as where they are no list.
    let is_empty = |of: &Value| of["pieces"].as_array().map(Vec::is_empty);
    if is_empty(value) == Some(false) && is_empty(&checked.cleaned) == Some(true) {
        checked.cleaned["pieces"] = Value::Null;
    }
    if let Some(grains) = value.get("grains").filter(|g| g.is_object()) {
        RULES.grains(grains).check(grains, "grains", "/grains", &mut checked);
    }
    let too_long = checked.cleaned["stages"].as_array().is_some_and(Vec::is_empty);
    let stages = value["stages"].as_array().filter(|_| !too_long);
    for (i, stage) in stages.into_iter().flatten().enumerate() {
        if let Some(rules) = RULES.stage(stage) {
            rules.check(stage, &format!("stages[{i}]"), &format!("/stages/{i}"), &mut checked);
        }
    }
    checked
}

/// Cuts lists off where every list is too long, so that not each of a million elements is looked
/// at.
fn shorten(value: &mut Value) {
    match value {
        Value::Array(list) => {
            list.truncate(LONGEST_LIST + 1);
            list.iter_mut().for_each(shorten);
        }
        Value::Object(fields) => fields.values_mut().for_each(shorten),
        _ => {}
    }
}

/// Checks the JSON of another document against the schema of its type, which
/// has no unions but optional fields.
pub(super) fn check_against(schema: Value, value: &Value) -> Vec<Fault> {
    let mut checked = Checked { faults: Vec::new(), cleaned: value.clone() };
    Part::new(schema).check(value, "", "", &mut checked);
    checked.faults
}

/// What is allowed at a dotted path of a scenario, in plain words; empty
/// where the schema knows nothing of it.
pub(super) fn allowed_at(value: &Value, path: &str) -> String {
    let steps: Vec<&str> = path.split(['.', '[', ']']).filter(|s| !s.is_empty()).collect();
    let (part, steps) = match *steps.as_slice() {
        ["grains", ref rest @ ..] if !rest.is_empty() => (RULES.grains(&value["grains"]), rest),
        ["stages", index, ref rest @ ..] if !rest.is_empty() => {
            let index = index.parse().unwrap_or(usize::MAX);
            match value["stages"].get(index).and_then(|stage| RULES.stage(stage)) {
                Some(part) => (part, rest),
                None => return String::new(),
            }
        }
        ref all => (&RULES.root, all),
    };
    describe(part.at(steps.iter().copied()))
}

static RULES: LazyLock<Rules> = LazyLock::new(Rules::new);

/// The schema taken apart at its unions.
struct Rules {
    root: Part,
    sieved: Part,
    file: Part,
    meshes: Part,
    /// By name, for each kind of `until`.
    stages: Vec<(String, Vec<Part>)>,
}

/// What `until` is in each kind of [`Rules::stages`].
fn kinds_of_until() -> [Value; 3] {
    let list = json!({
        "type": "array", "minItems": 1, "maxItems": 20,
        "items": { "$ref": "#/$defs/ConditionSpec" },
    });
    [json!({ "$ref": "#/$defs/ConditionSpec" }), list, json!({ "$ref": "#/$defs/AllOfSpec" })]
}

impl Rules {
    fn new() -> Self {
        let mut root = schema::typed();
        let mut defs = root["$defs"].take();
        choices_to_enums(&mut defs);
        let part = |mut schema: Value| {
            schema["$defs"] = defs.clone();
            Part::new(schema)
        };
        let mut stages = Vec::new();
        for variant in defs["StageSpec"]["oneOf"].as_array().into_iter().flatten() {
            if let Some(name) = variant["properties"]["stage"]["const"].as_str() {
                let with = |until| {
                    let mut variant = variant.clone();
                    variant["properties"]["until"] = until;
                    part(variant)
                };
                let kinds = match variant["properties"].get("until") {
                    Some(_) => kinds_of_until().map(with).into(),
                    None => vec![part(variant.clone())],
                };
                stages.push((name.to_owned(), kinds));
            }
        }
        let names: Vec<&str> = stages.iter().map(|(name, _)| name.as_str()).collect();
        root["properties"]["grains"] = json!({
            "type": "object",
            "x-allowed": "an object with `total_mass_g`, `density_kg_per_m3` and `sieve_table`, \
                          with `file`, or with `meshes`",
        });
        root["properties"]["stages"]["items"] = json!({
            "type": "object",
            "x-allowed": "an object with the field `stage`",
            "required": ["stage"],
            "properties": { "stage": { "enum": names } },
        });
        Self {
            root: part(root),
            sieved: part(defs["SievedGrains"].clone()),
            file: part(defs["GrainsFile"].clone()),
            meshes: part(defs["MeshGrains"].clone()),
            stages,
        }
    }

    fn grains(&self, grains: &Value) -> &Part {
        if grains.get("file").is_some() {
            &self.file
        } else if grains.get("meshes").is_some() {
            &self.meshes
        } else {
            &self.sieved
        }
    }

    fn stage(&self, stage: &Value) -> Option<&Part> {
        let name = stage.get("stage")?.as_str()?;
        let until = &stage["until"];
        let kind = match until.is_array() {
            true => 1,
            false => 2 * usize::from(until.get("all_of").is_some()),
        };
        let (_, kinds) = self.stages.iter().find(|(known, _)| known == name)?;
        kinds.get(kind).or(kinds.first())
    }
}

/// `oneOf` of constants, which carries a description of each, as a plain `enum`.
fn choices_to_enums(defs: &mut Value) {
    for def in defs.as_object_mut().into_iter().flat_map(|defs| defs.values_mut()) {
        let Some(choices) = def["oneOf"].as_array() else { continue };
        let constants: Option<Vec<Value>> =
            choices.iter().map(|choice| choice.get("const").cloned()).collect();
        if let Some(constants) = constants {
            *def = json!({ "enum": constants });
        }
    }
}

/// One schema without unions.
struct Part {
    schema: Value,
    validator: Validator,
}

impl Part {
    fn new(schema: Value) -> Self {
        let validator =
            jsonschema::validator_for(&schema).expect("the types give a sound JSON Schema");
        Self { schema, validator }
    }

    /// Checks a value that stands at a path of the scenario, given both
    /// dotted and as a JSON pointer.
    fn check(&self, value: &Value, path: &str, pointer: &str, into: &mut Checked) {
        let mut too_long = Vec::new();
        for error in self.validator.iter_errors(value) {
            let inner = error.instance_path().as_str();
            let steps: Vec<String> = inner
                .split('/')
                .skip(1)
                .map(|step| step.replace("~1", "/").replace("~0", "~"))
                .collect();
            let here = dotted(path, value, &steps);
            let schema = self.at(steps.iter().map(String::as_str));
            let mut add = |path: String, found: String, allowed: String, message: String| {
                into.faults.push(Fault::new(message, found, allowed).at(path));
            };
            match error.kind() {
                ValidationErrorKind::AdditionalProperties { unexpected } => {
                    let mut known = fields(schema);
                    // What a file extends has been read, and taken out, before.
                    if here.is_empty() && known.contains(&"stages") {
                        known.push("extends");
                    }
                    let called = |new: &str| format!("this field is now called `{new}`");
                    for name in unexpected {
                        let now = renamed::field(&here, name);
                        let message = now.map(called).unwrap_or_else(|| {
                            let near = did_you_mean(name, known.iter().copied(), '`');
                            match name.is_empty() {
                                true => "the field has no name".to_owned(),
                                false => format!("there is no such field{near}"),
                            }
                        });
                        let (path, value) = (field_path(&here, name), &error.instance()[name]);
                        add(path.clone(), shown(value), listed(&known), message);
                        let Some(now) = now else { continue };
                        let group = self.at(steps.iter().map(String::as_str).chain([now]));
                        let old_names = renamed::old_names(value, &path, &field_path(&here, now));
                        for old in old_names.into_iter().filter(|old| old.choice.is_none()) {
                            let new = old.is.rsplit('.').next().unwrap_or_default();
                            add(old.was, shown(old.value), listed(&fields(group)), called(new));
                        }
                    }
                    let gone: HashSet<&str> = unexpected.iter().map(String::as_str).collect();
                    let parent = into.cleaned.pointer_mut(&format!("{pointer}{inner}"));
                    if let Some(Value::Object(parent)) = parent {
                        parent.retain(|name, _| !gone.contains(name.as_str()));
                    }
                }
                ValidationErrorKind::Required { property } => {
                    let name = property.as_str().unwrap_or_default();
                    let field = self.at(steps.iter().map(String::as_str).chain([name]));
                    let message = "the field is missing".into();
                    add(field_path(&here, name), String::new(), describe(field), message);
                }
                kind => {
                    if let ValidationErrorKind::MaxItems { .. } = kind {
                        // What it means is not asked: that takes as long as the list is.
                        let list = into.cleaned.pointer_mut(&format!("{pointer}{inner}"));
                        list.and_then(Value::as_array_mut).into_iter().for_each(Vec::clear);
                        too_long.push(format!("{here}["));
                    }
                    let message = in_words(kind).map_or_else(|| error.to_string(), str::to_owned);
                    let word = error.instance().as_str();
                    let now = word.and_then(|word| renamed::choice(&here, word));
                    let message = match (now, kind, word) {
                        (Some(new), ..) => format!("this choice is now called \"{new}\""),
                        (None, ValidationErrorKind::Enum { options }, Some(word)) => {
                            let known = options.as_array().into_iter().flatten();
                            message + &did_you_mean(word, known.filter_map(Value::as_str), '"')
                        }
                        _ => message,
                    };
                    add(here, shown(error.instance()), describe(schema), message);
                }
            }
        }
        // Of a list that is too long nothing else is said.
        into.faults.retain(|f| !too_long.iter().any(|list| f.path.starts_with(list.as_str())));
    }

    /// The schema of what stands at the end of a path; `null` where there is none.
    fn at<'a>(&self, path: impl Iterator<Item = &'a str>) -> &Value {
        path.fold(self.resolved(&self.schema), |schema, step| {
            let field = &schema["properties"][step];
            self.resolved(if field.is_null() { &schema["items"] } else { field })
        })
    }

    fn resolved<'a>(&'a self, schema: &'a Value) -> &'a Value {
        let Some(name) = schema["$ref"].as_str().and_then(|r| r.strip_prefix("#/$defs/")) else {
            return schema;
        };
        &self.schema["$defs"][name]
    }
}

/// Dotted path of what stands at `steps` inside the value at `path`.
fn dotted(path: &str, value: &Value, steps: &[String]) -> String {
    let mut path = path.to_owned();
    let mut at = value;
    for step in steps {
        at = match at {
            Value::Array(items) => {
                path = format!("{path}[{step}]");
                step.parse().ok().and_then(|i: usize| items.get(i)).unwrap_or(&Value::Null)
            }
            other => {
                path = field_path(&path, step);
                &other[step.as_str()]
            }
        };
    }
    path
}

/// A question for the nearest of the words that are known, between marks; empty where none is near.
fn did_you_mean<'a>(word: &str, known: impl IntoIterator<Item = &'a str>, mark: char) -> String {
    let near = nearest(word, known).map(|near| format!(", did you mean {mark}{near}{mark}?"));
    near.unwrap_or_default()
}

fn in_words(kind: &ValidationErrorKind) -> Option<&'static str> {
    use ValidationErrorKind as Kind;
    Some(match kind {
        Kind::Type { .. } => "the value has the wrong type",
        Kind::Minimum { .. }
        | Kind::Maximum { .. }
        | Kind::ExclusiveMinimum { .. }
        | Kind::ExclusiveMaximum { .. } => "the value is out of range",
        Kind::MinItems { .. } => "the list is too short",
        Kind::MaxItems { .. } => "the list is too long",
        Kind::MinLength { .. } => "the text is too short",
        Kind::MaxLength { .. } => "the text is too long",
        Kind::Enum { .. } | Kind::Constant { .. } => "there is no such choice",
        _ => return None,
    })
}

/// The fields of an object that people type: without those that are filled in when a scenario is
/// loaded.
fn fields(schema: &Value) -> Vec<&str> {
    let all = schema["properties"].as_object().into_iter().flatten();
    all.filter(|(_, of)| of["x-filled-in"] != true).map(|(name, _)| name.as_str()).collect()
}

fn listed(names: &[&str]) -> String {
    match names {
        [] => "no field".into(),
        [one] => format!("the field `{one}`"),
        [all @ .., last] => format!("the fields `{}` and `{last}`", all.join("`, `")),
    }
}

/// What a schema allows, in plain words.
fn describe(schema: &Value) -> String {
    if let Some(said) = schema["x-allowed"].as_str() {
        return said.to_owned();
    }
    if let Some(options) = schema["enum"].as_array() {
        let options: Vec<String> = options.iter().map(Value::to_string).collect();
        return options.join(" or ");
    }
    // Whole numbers as they are: the largest have no value with a point.
    let limit = |key: &str| {
        let whole = schema[key].as_u64().map(|x| x.to_string());
        whole.or_else(|| schema[key].as_f64().map(|x| x.to_string()))
    };
    match schema["type"].as_str() {
        Some(kind @ ("number" | "integer")) => {
            let kind = if kind == "integer" { "a whole number" } else { "a number" };
            let low = limit("exclusiveMinimum").map(|x| format!("above {x}"));
            let low = low.or_else(|| limit("minimum").map(|x| format!("of at least {x}")));
            let high = limit("maximum").map(|x| format!("at most {x}"));
            match (low, high) {
                (Some(low), Some(high)) => format!("{kind} {low} and {high}"),
                (Some(low), None) => format!("{kind} {low}"),
                (None, Some(high)) => format!("{kind} of {high}"),
                (None, None) => kind.to_owned(),
            }
        }
        Some("string") => match (limit("minLength"), limit("maxLength")) {
            (Some(low), Some(high)) => format!("a text of {low} to {high} letters"),
            (Some(_), None) => "a text that is not empty".into(),
            _ => "a text".into(),
        },
        Some("boolean") => "true or false".into(),
        Some("array") => match (limit("minItems"), limit("maxItems")) {
            (Some(low), Some(high)) if low == high => format!("a list of {low} elements"),
            (Some(low), Some(high)) => format!("a list of {low} to {high} elements"),
            (None, Some(high)) => format!("a list of at most {high} elements"),
            _ => "a list".into(),
        },
        Some("object") => format!("an object with {}", listed(&fields(schema))),
        _ => String::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Law: what is allowed are fields that people type; those that are filled in are known all the
    /// same, as a scenario that was loaded has them.
    #[test]
    fn faults_of_a_beginning_name_the_fields_that_people_type() {
        let faults = |begin: Value| {
            let stages = json!([{ "stage": "rest", "duration_s": 1 }]);
            let grains = json!({ "file": "grains.json" });
            let value = json!({ "name": "a", "grains": grains, "begin": begin, "stages": stages });
            check(&value).faults
        };
        let both = "the fields `specimen` and `stage`";
        let found = faults(json!({ "specimen": "run", "keyy": "a" }));
        let said: Vec<(&str, &str)> =
            found.iter().map(|fault| (fault.path.as_str(), fault.allowed.as_str())).collect();
        assert_eq!(said, [("begin.keyy", both)], "law: those that are typed, got {found:?}");
        let found = faults(json!("run"));
        assert_eq!(found[0].allowed, format!("an object with {both}"), "law: as an object, too");
        let loaded = json!({
            "specimen": "run", "after": ["pour"], "key": "a", "specimen_sha256": "b",
            "taken_over": ["engine.rate_hz"]
        });
        assert!(faults(loaded).is_empty(), "law: a scenario that was loaded before has more");
    }

    #[test]
    fn every_leaf_of_a_scenario_can_be_described() {
        let value = json!({
            "grains": { "sieve_table": [{}] },
            "stages": [{ "stage": "vibrate" }, { "stage": "press", "loads": [{}] }],
        });
        for (path, expected) in [
            ("engine.rate_hz", "a number of at least 30 and at most 100000"),
            ("engine.backend", "\"bullet\" or \"rapier\""),
            ("engine.gyroscopic", "true or false"),
            ("engine.rapier.substeps", "a whole number of at least 1 and at most 1000"),
            ("engine.rapier.contact_frequency_hz", "a number above 0 and at most 1000000"),
            ("engine.rapier.friction_model", "\"coulomb\" or \"simplified\""),
            ("grains.sieve_table[0].passing_mm", "a number above 0 and at most 10000"),
            ("stages[0].periods", "a whole number of at least 1 and at most 1000"),
            ("seed", "a whole number of at least 0 and at most 18446744073709551615"),
            ("stages[0].stroke", "\"half_stroke\" or \"full_stroke\""),
            ("notes", "a list"),
            ("pieces", "a list of at most 100 elements"),
            (
                "begin.stage",
                "a text: the name of a stage, \"rest_test\", or a number from 0 in double quotes, \"0\"",
            ),
            ("stages[1].loads[0].direction", "a list of 3 elements"),
            ("stages[1].loads", "a list of 1 to 100 elements"),
            ("stages[0].nonsense", ""),
            ("stages[7].periods", ""),
        ] {
            let got = allowed_at(&value, path);
            assert_eq!(got, expected, "law: what is allowed at {path}");
        }
    }
}
