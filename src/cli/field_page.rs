//! A JSON Schema as a page for people: a table of fields for every object.

use std::collections::HashSet;

use serde_json::Map;

use super::*;

/// Most headings that Markdown has.
const DEEPEST: usize = 6;

/// Writes the page under the given title. The schema is one of
/// [`crate::scenario`]: objects, references, unions of objects, and strings
/// that are one of several.
pub(super) fn page(title: &str, introduction: &str, schema: &Value) -> String {
    let mut page =
        Page { schema, text: format!("# {title}\n\n{introduction}\n"), told: HashSet::new() };
    page.object("", schema, 1);
    page.text
}

struct Page<'a> {
    schema: &'a Value,
    text: String,
    /// Definitions that have their table.
    told: HashSet<&'a str>,
}

impl<'a> Page<'a> {
    /// The definition that is referred to, with its name; else the value itself.
    fn resolve(&self, value: &'a Value) -> (Option<&'a str>, &'a Value) {
        let Some(name) = value["$ref"].as_str().and_then(|r| r.rsplit('/').next()) else {
            return (None, value);
        };
        // An extending scenario may give some fields of any kind of grains: for a
        // reader they belong to their kinds.
        let name = if name == "GrainsChange" { "GrainsSpec" } else { name };
        (Some(name), &self.schema["$defs"][name])
    }

    /// A table of the fields of an object, then those of the objects in it.
    fn object(&mut self, path: &str, of: &'a Value, depth: usize) {
        let Some(fields) = of["properties"].as_object() else { return };
        let required: HashSet<&str> =
            of["required"].as_array().into_iter().flatten().filter_map(Value::as_str).collect();
        self.text += "\n| field | value | default | meaning |\n| --- | --- | --- | --- |\n";
        for (name, field) in fields {
            let default = match &field["default"] {
                _ if required.contains(name.as_str()) => "must be given".to_owned(),
                // What is in an object has defaults of its own, below.
                Value::Object(_) | Value::Null => String::new(),
                value if field["x-automatic"] == true => format!("automatic (`{value}`)"),
                value => format!("`{value}`"),
            };
            let meaning = self.meaning(field);
            let value = self.value(field);
            self.text += &format!("| `{name}` | {value} | {default} | {meaning} |\n");
        }
        for (name, field) in fields {
            let inner = if path.is_empty() { name.clone() } else { format!("{path}.{name}") };
            self.below(&inner, field, depth + 1);
        }
    }

    /// The sections of what a field holds, where that has fields of its own.
    fn below(&mut self, path: &str, field: &'a Value, depth: usize) {
        let (name, of) = self.resolve(field);
        if of["type"] == "array" {
            return self.below(&format!("{path}[]"), &of["items"], depth);
        }
        let kinds: Vec<&Value> = ["oneOf", "anyOf"]
            .iter()
            .filter_map(|union| of[*union].as_array())
            .flatten()
            .filter(|kind| self.resolve(kind).1["properties"].is_object())
            .collect();
        if kinds.is_empty() && !of["properties"].is_object() {
            return;
        }
        if name.is_some_and(|name| !self.told.insert(name)) {
            return;
        }
        let level = "#".repeat(depth.min(DEEPEST));
        self.text += &format!("\n{level} `{path}`\n\n{}\n", flowing(&of["description"]));
        if kinds.is_empty() {
            return self.object(path, of, depth);
        }
        let level = "#".repeat((depth + 1).min(DEEPEST));
        for kind in kinds {
            let (_, object) = self.resolve(kind);
            let title = match object["properties"]["stage"]["const"].as_str() {
                Some(stage) => format!("`\"stage\": \"{stage}\"`"),
                None => {
                    format!("`{path}`: {}", flowing(&kind["description"]).trim_end_matches('.'))
                }
            };
            self.text += &format!("\n{level} {title}\n");
            if object["description"] != kind["description"] || title.starts_with("`\"") {
                self.text += &format!("\n{}\n", flowing(&object["description"]));
            }
            self.object(path, object, depth + 1);
        }
    }

    /// What may be typed.
    fn value(&self, field: &'a Value) -> String {
        let (_, of) = self.resolve(field);
        if let Some(text) = of["const"].as_str() {
            return format!("`\"{text}\"`");
        }
        if let Some(words) = of["enum"].as_array() {
            return words.iter().map(|w| format!("`{w}`")).collect::<Vec<_>>().join(", ");
        }
        let consts = words(of);
        if !consts.is_empty() {
            let consts = consts.iter().map(|(word, _)| format!("`\"{word}\"`"));
            return consts.collect::<Vec<_>>().join(", ");
        }
        match of["type"].as_str() {
            Some("array") => {
                let (_, items) = self.resolve(&of["items"]);
                let things = match items["type"].as_str() {
                    Some("string") => "texts",
                    Some("number" | "integer") => "numbers",
                    _ if !words(items).is_empty() => "texts",
                    _ => "objects",
                };
                match (of["minItems"].as_u64(), of["maxItems"].as_u64()) {
                    (Some(low), Some(high)) if low == high => format!("{low} {things}"),
                    (Some(low), Some(high)) => format!("{low} to {high} {things}"),
                    _ => format!("list of {things}"),
                }
            }
            Some("boolean") => "`true`, `false`".to_owned(),
            Some(kind @ ("number" | "integer")) => {
                let kind = if kind == "integer" { "whole number" } else { "number" };
                let limits = limits(of.as_object());
                if limits.is_empty() { kind.to_owned() } else { format!("{kind}, {limits}") }
            }
            Some("string") => "text".to_owned(),
            _ if is_list_too(of) => "object or list of objects, below".to_owned(),
            _ => "object, below".to_owned(),
        }
    }

    /// What the field is for, and what each of its words means.
    fn meaning(&self, field: &'a Value) -> String {
        let (_, of) = self.resolve(field);
        let said = if field["description"].is_string() { field } else { of };
        let mut text = flowing(&said["description"]);
        for (word, meaning) in words(of) {
            text += &format!("<br>`\"{word}\"`: {}", flowing(meaning));
        }
        text.replace('|', "\\|")
    }
}

/// Whether a union of objects has a list among its kinds.
fn is_list_too(of: &Value) -> bool {
    of["anyOf"].as_array().into_iter().flatten().any(|kind| kind["type"] == "array")
}

/// The words that a string may be, with their meanings.
fn words(of: &Value) -> Vec<(&str, &Value)> {
    let kinds = of["oneOf"].as_array().into_iter().flatten();
    kinds.filter_map(|kind| Some((kind["const"].as_str()?, &kind["description"]))).collect()
}

fn limits(of: Option<&Map<String, Value>>) -> String {
    let bound = |name: &str| of.and_then(|of| of.get(name)).map(Value::to_string);
    let plain = |text: String| text.strip_suffix(".0").map_or(text.clone(), str::to_owned);
    let named = [
        ("minimum", "at least"),
        ("exclusiveMinimum", "above"),
        ("maximum", "at most"),
        ("exclusiveMaximum", "below"),
    ];
    let parts = named
        .iter()
        .filter_map(|(name, word)| bound(name).map(|value| format!("{word} {}", plain(value))));
    parts.collect::<Vec<_>>().join(", ")
}

/// A doc comment in one line; links to items of the program as plain names.
fn flowing(text: &Value) -> String {
    let text = text.as_str().unwrap_or_default().split_whitespace().collect::<Vec<_>>().join(" ");
    text.replace("[`", "`").replace("`]", "`")
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn every_kind_of_field_has_its_row() {
        let schema = json!({
            "properties": {
                "name": { "type": "string", "description": "What it\nis called." },
                "size_mm": { "type": "number", "description": "How large.", "default": 2.0,
                             "exclusiveMinimum": 0.0, "maximum": 10.0 },
                "kind": { "$ref": "#/$defs/Kind" },
                "parts": { "type": "array", "minItems": 1, "maxItems": 3,
                           "items": { "$ref": "#/$defs/Part" }, "description": "Its parts." },
            },
            "required": ["name"],
            "$defs": {
                "Kind": { "description": "Which kind.", "oneOf": [
                    { "type": "string", "const": "round", "description": "A ball." },
                    { "type": "string", "const": "flat", "description": "A | plate." }] },
                "Part": { "description": "A part.", "properties": {
                    "solid": { "type": "boolean", "default": true, "description": "See [`Part`]." } } },
            },
        });
        let text = page("Things", "All of them.", &schema);
        for line in [
            "# Things",
            "| `name` | text | must be given | What it is called. |",
            "| `size_mm` | number, above 0, at most 10 | `2.0` | How large. |",
            "| `kind` | `\"round\"`, `\"flat\"` |  | Which kind.<br>`\"round\"`: A ball.<br>\
             `\"flat\"`: A \\| plate. |",
            "| `parts` | 1 to 3 objects |  | Its parts. |",
            "## `parts[]`",
            "| `solid` | `true`, `false` | `true` | See `Part`. |",
        ] {
            assert!(text.lines().any(|l| l == line), "law: there is a line {line}, got\n{text}");
        }
    }
}
