//! JSON Schema of the scenario file, for editors that check and complete.

use serde_json::{Map, Value, json};

use super::{
    Scenario,
    automatic::{AUTOMATIC, AUTOMATIC_OF_STAGES},
};

/// The JSON Schema (draft 2020-12) of a scenario file.
///
/// It is that of [`Scenario`] with what only files have: `$schema`, and
/// `extends`. A file that extends another may leave out whatever the other
/// one gives.
pub fn schema() -> Value {
    let mut schema = typed();
    let Some(root) = schema.as_object_mut() else { return schema };
    let required = root.remove("required");
    if let Some(defs) = root.get_mut("$defs").and_then(Value::as_object_mut) {
        let mut properties = Map::new();
        for variant in ["MeshGrains", "SievedGrains", "GrainsFile"] {
            if let Some(Value::Object(fields)) = defs.get(variant).map(|d| &d["properties"]) {
                properties.extend(fields.clone());
            }
        }
        let change = json!({
            "description": "What differs from the grains of the scenario that is extended.",
            "type": "object",
            "properties": properties,
            "additionalProperties": false,
        });
        defs.insert("GrainsChange".into(), change);
    }
    if let Some(properties) = root.get_mut("properties").and_then(Value::as_object_mut) {
        let grains = "#/$defs/GrainsChange";
        properties.insert("grains".into(), json!({ "$ref": grains }));
        let of_schema = "Where this file's JSON Schema lies, for editors; not read.";
        let schema_field = json!({ "description": of_schema, "type": "string" });
        properties.insert("$schema".into(), schema_field);
        let extends = json!({
            "description": "Path, relative to this file, of a scenario from which everything not \
                            given here is taken. Objects are merged field by field, lists replaced.",
            "type": "string",
        });
        properties.insert("extends".into(), extends);
    }
    root.insert("if".into(), json!({ "not": { "required": ["extends"] } }));
    // What begins with another run's specimen has its grains.
    let begun: Vec<&Value> =
        required.iter().filter_map(Value::as_array).flatten().filter(|r| *r != "grains").collect();
    let complete = json!({
        "if": { "required": ["begin"] },
        "then": { "required": begun },
        "else": {
            "required": required,
            "properties": { "grains": { "$ref": "#/$defs/GrainsSpec" } },
        },
    });
    root.insert("then".into(), complete);
    schema
}

/// The schema of the type, as its definition declares it.
pub(super) fn typed() -> Value {
    let mut schema = schemars::schema_for!(Scenario).to_value();
    let mark = |part: &mut Value, fields: &[&str]| {
        for field in fields {
            if let Some(field) = part["properties"].get_mut(field).and_then(Value::as_object_mut) {
                field.insert("x-automatic".into(), true.into());
            }
        }
    };
    for (name, fields) in AUTOMATIC {
        mark(&mut schema["$defs"][name], fields);
    }
    for stage in schema["$defs"]["StageSpec"]["oneOf"].as_array_mut().into_iter().flatten() {
        mark(stage, &AUTOMATIC_OF_STAGES);
    }
    schema
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
