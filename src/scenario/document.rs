//! Other files that people write, checked as scenarios are: against the schema
//! of their type, all faults at once.

use std::path::Path;

use schemars::{JsonSchema, SchemaGenerator};
use serde::de::DeserializeOwned;

use super::{Fault, ScenarioErrors, source, structure};

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
    let schema = SchemaGenerator::default().into_root_schema_for::<T>().to_value();
    faults.extend(structure::check_against(schema, &value));
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
