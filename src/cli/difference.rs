//! Where what is asked for differs from what a folder holds.

use serde_json::Value;

use crate::study::WORDS;

/// The first field in which two values differ; text for the reader does not count.
pub(super) fn first_difference(path: &str, a: &Value, b: &Value) -> Option<String> {
    let within = |field: &str| match path {
        "" => field.to_owned(),
        path => format!("{path}.{field}"),
    };
    match (a, b) {
        (Value::Object(one), Value::Object(two)) => {
            let fields = one.keys().chain(two.keys().filter(|key| !one.contains_key(*key)));
            let mut fields = fields.filter(|f| !path.is_empty() || !WORDS.contains(&f.as_str()));
            // What is not there is as good as null.
            let of = |value: &serde_json::Map<String, Value>, field: &str| {
                value.get(field).cloned().unwrap_or_default()
            };
            fields.find_map(|f| first_difference(&within(f), &of(one, f), &of(two, f)))
        }
        (Value::Array(one), Value::Array(two)) if one.len() == two.len() => {
            let mut pairs = one.iter().zip(two).enumerate();
            pairs.find_map(|(n, (a, b))| first_difference(&format!("{path}[{n}]"), a, b))
        }
        // 20 and 20.0 are one number.
        (Value::Number(one), Value::Number(two)) if one.as_f64() == two.as_f64() => None,
        (a, b) => (a != b).then(|| path.to_owned()),
    }
}
