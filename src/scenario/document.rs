//! Other files that people write, checked as scenarios are: against the schema
//! of their type, all faults at once.

use std::path::Path;

use schemars::{JsonSchema, SchemaGenerator};
use serde::de::DeserializeOwned;
use serde_json::{Value, json};

use super::{Fault, ScenarioErrors, source, structure};

/// The JSON Schema (draft 2020-12) of such a file.
pub fn document_schema<T: JsonSchema>() -> Value {
    let mut schema = typed::<T>();
    if let Some(properties) = schema["properties"].as_object_mut() {
        let of_schema = "Where this file's JSON Schema lies, for editors; not read.";
        let schema_field = json!({ "description": of_schema, "type": "string" });
        properties.insert("$schema".into(), schema_field);
    }
    schema
}

fn typed<T: JsonSchema>() -> Value {
    SchemaGenerator::default().into_root_schema_for::<T>().to_value()
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
    faults.extend(structure::check_against(typed::<T>(), &value));
    let named = |fault: Fault| Fault { file: file.display().to_string(), ..fault };
    if faults.is_empty() {
        match serde_path_to_error::deserialize::<_, T>(&value) {
            Ok(document) => return Ok(document),
            Err(error) => faults.push(Fault {
                path: error.path().to_string(),
                message: format!("the value cannot be used: {}", error.inner()),
                ..Fault::default()
            }),
        }
    }
    Err(ScenarioErrors::Faults(faults.into_iter().map(named).collect()))
}
