//! Fields of a scenario's JSON: their paths, and what stands there.

use serde::de::DeserializeOwned;

use super::*;

/// Path of a field of the value at a path.
pub(super) fn field_path(path: &str, field: &str) -> String {
    if path.is_empty() { field.to_owned() } else { format!("{path}.{field}") }
}

/// What a part of a scenario's JSON says; none where it cannot be read, which the schema reports.
pub(super) fn read<T: DeserializeOwned>(value: &Value) -> Option<T> {
    T::deserialize(value).ok()
}

/// A field of an object, `null` where it is missing.
pub(super) fn field<'a>(value: &'a Value, pointer: &str) -> &'a Value {
    value.pointer(pointer).unwrap_or(&Value::Null)
}

/// The elements of a list of an object; none of what is no list.
pub(super) fn elements<'a>(value: &'a Value, name: &str) -> impl Iterator<Item = &'a Value> {
    value[name].as_array().into_iter().flatten()
}

/// The stages of a kind.
pub(super) fn stages_of<'a>(
    value: &'a Value,
    kind: &'static str,
) -> impl Iterator<Item = &'a Value> {
    elements(value, "stages").filter(move |stage| stage["stage"] == kind)
}

/// The JSON pointer of a dotted path.
pub(super) fn pointer(path: &str) -> String {
    format!("/{}", path.replace(['.', '['], "/").replace(']', ""))
}

/// The number at a dotted path; none where there is none.
pub(super) fn number_at(value: &Value, path: &str) -> Option<f64> {
    field(value, &pointer(path)).as_f64()
}
