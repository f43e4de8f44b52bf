//! JSON Schema of the scenario file, for editors that check and complete; other files that people
//! write, checked against that of their type, all faults at once.

use schemars::{Schema, generate::SchemaSettings, transform::RecursiveTransform};
use serde::de::DeserializeOwned;

use super::*;

/// The JSON Schema (draft 2020-12) of a scenario file.
///
/// It is that of [`Scenario`] with what only files have: `$schema`, and
/// `extends`. A file that extends another may leave out whatever the other
/// one gives.
pub fn schema() -> Value {
    let mut schema = typed();
    let required = schema.as_object_mut().and_then(|root| root.remove("required"));
    let mut of_grains = Map::new();
    for kind in ["MeshGrains", "SievedGrains", "GrainsFile"] {
        let fields = schema["$defs"][kind]["properties"].as_object();
        of_grains.extend(fields.cloned().unwrap_or_default());
    }
    schema["$defs"]["GrainsChange"] = json!({
        "description": "What differs from the grains of the scenario that is extended.",
        "type": "object",
        "properties": of_grains,
        "additionalProperties": false,
    });
    let properties = &mut schema["properties"];
    properties["grains"] = json!({ "$ref": "#/$defs/GrainsChange" });
    properties["$schema"] = schema_field();
    properties["extends"] = json!({
        "description": "Path, relative to this file, of a scenario from which everything not \
                        given here is taken. Objects are merged field by field, lists replaced.",
        "type": "string",
    });
    schema["if"] = json!({ "not": { "required": ["extends"] } });
    // What begins with another run's specimen has its grains.
    let begun: Vec<&Value> =
        required.iter().filter_map(Value::as_array).flatten().filter(|r| *r != "grains").collect();
    schema["then"] = json!({
        "if": { "required": ["begin"] },
        "then": { "required": begun },
        "else": {
            "required": required,
            "properties": { "grains": { "$ref": "#/$defs/GrainsSpec" } },
        },
    });
    schema
}

/// What stands at the top of a file for its editor.
pub(super) fn schema_field() -> Value {
    let of_schema = "Where this file's JSON Schema lies, for editors; not read.";
    json!({ "description": of_schema, "type": "string" })
}

/// The schema of the type, as its definition declares it.
pub(super) fn typed() -> Value {
    let mut schema = schema_of::<Scenario>();
    let referred = |of: &Value, field: &str| {
        let reference = of["properties"][field]["$ref"].as_str().unwrap_or_default();
        reference.trim_start_matches('#').to_owned()
    };
    let mut marked = Vec::new();
    for path in automatic_paths() {
        let (parents, field) = path.rsplit_once('.').unwrap_or(("", path));
        let part = parents.split('.').fold(String::new(), |at, step| {
            schema.pointer(&at).map(|of| referred(of, step)).unwrap_or_default()
        });
        marked.push((part, field));
    }
    let stages = schema["$defs"]["StageSpec"]["oneOf"].as_array().into_iter().flatten();
    for (n, stage) in stages.enumerate() {
        let name = &stage["properties"]["stage"]["const"];
        for (_, path, ..) in fields_of_stages().into_iter().filter(|f| *name == f.0) {
            marked.push(match path.split_once('.') {
                Some((part, field)) => (referred(stage, part), field),
                None => (format!("/$defs/StageSpec/oneOf/{n}"), path),
            });
        }
    }
    for (part, field) in marked {
        let field = schema.pointer_mut(&format!("{part}/properties/{field}"));
        if let Some(Value::Object(field)) = field {
            field.insert("x-automatic".into(), true.into());
        }
    }
    schema
}

/// The JSON Schema (draft 2020-12) of another file that people write, checked as scenarios are.
pub fn document_schema<T: JsonSchema>() -> Value {
    let mut schema = schema_of::<T>();
    schema["properties"]["$schema"] = schema_field();
    schema
}

fn schema_of<T: JsonSchema>() -> Value {
    let settings = SchemaSettings::default().with_transform(RecursiveTransform(without_null));
    settings.into_generator().into_root_schema_for::<T>().to_value()
}

/// A field that need not be given is left out, not `null`.
fn without_null(schema: &mut Schema) {
    let Some(fields) = schema.as_object_mut() else { return };
    if let Some(Value::Array(kinds)) = fields.get("type")
        && let [kind, Value::String(null)] = &kinds[..]
        && null == "null"
    {
        fields["type"] = kind.clone();
    }
    if let Some(Value::Array(choices)) = fields.get("anyOf")
        && let [Value::Object(given), other] = &choices[..]
        && other["type"] == "null"
    {
        let given = given.clone();
        fields.shift_remove("anyOf");
        fields.extend(given);
    }
}

/// Reads a JSON file of a type that has no unions. A `$schema` for editors may
/// stand at its top.
///
/// # Errors
/// [`ScenarioErrors::Unreadable`] for a file that cannot be read, and else
/// [`ScenarioErrors::Faults`] with all faults found.
pub fn load_document<T: JsonSchema + DeserializeOwned>(file: &Path) -> Result<T, ScenarioErrors> {
    let (mut value, mut faults) = source::read_alone(file)?;
    if let Some(fields) = value.as_object_mut() {
        fields.shift_remove("$schema");
    }
    faults.extend(structure::check_against(schema_of::<T>(), &value));
    let named = |fault: Fault| fault.of(file.display());
    if faults.is_empty() {
        match serde_path_to_error::deserialize::<_, T>(&value) {
            Ok(document) => return Ok(document),
            Err(error) => faults.push(unusable(&error, "")),
        }
    }
    Err(ScenarioErrors::Faults(faults.into_iter().map(named).collect()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn valid(file: &Value) -> bool {
        jsonschema::validator_for(&schema()).expect("a sound schema").is_valid(file)
    }

    #[test]
    fn complete_files_need_everything_and_extensions_do_not() {
        let stages = json!([{ "stage": "fill_funnel" }]);
        let grains = json!({ "file": "grains.json" });
        assert!(valid(&json!({ "name": "a", "grains": grains, "stages": stages })));
        assert!(!valid(&json!({ "name": "a", "stages": stages })), "grains are missing");
        assert!(!valid(&json!({ "name": "a", "grains": {}, "stages": stages })), "empty grains");
        assert!(valid(&json!({ "extends": "b.json", "grains": { "total_mass_g": 1 } })));
        assert!(!valid(&json!({ "extends": "b.json", "grains": { "mass": 1 } })), "unknown field");
        assert!(!valid(&json!({ "extends": 1 })), "extends is a text");
        assert!(!valid(&json!({ "extends": "b.json", "gravity_m_per_s2": 0 })), "no gravity");
    }
}
