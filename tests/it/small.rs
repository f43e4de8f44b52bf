//! Scenarios that run in a second: a few grains, poured and shaken, or only poured.

use serde_json::{Value, json};

/// Gravel of 10 to 12.5 mm, of a mass in g.
pub fn gravel(mass_g: f64) -> Value {
    json!({
        "total_mass_g": mass_g, "density_kg_per_m3": 2673.9,
        "sieve_table": [{ "passing_mm": 12.5, "retained_mm": 10, "mass_percent": 100 }]
    })
}

/// Grains of 8 to 10 mm, of a mass in g.
pub fn fine(mass_g: f64) -> Value {
    json!({
        "total_mass_g": mass_g, "density_kg_per_m3": 2650,
        "sieve_table": [{ "passing_mm": 10, "retained_mm": 8, "mass_percent": 100 }]
    })
}

/// Puts fields into an object; null takes one away.
pub fn put(object: &mut Value, fields: &Value) {
    let object = object.as_object_mut().expect("an object");
    for (name, field) in fields.as_object().expect("fields") {
        if field.is_null() {
            // In this way the others keep their order.
            object.retain(|other, _| other != name);
        } else {
            object.insert(name.clone(), field.clone());
        }
    }
}

/// Gravel of a mass in g, shaken for whole cycles of 0.25 s, then left alone.
pub fn scenario(mass_g: f64, shaken_s: f64, rest_test_s: f64) -> Value {
    json!({
        "name": "small",
        "grains": gravel(mass_g),
        "stages": [
            { "stage": "fill_funnel" },
            { "stage": "pour", "falling_height_mm": 0 },
            { "stage": "place_top_plate" },
            { "stage": "vibrate", "frequency_hz": 4, "amplitude_mm": 10, "duration_s": shaken_s },
        ],
        "rest_test_s": rest_test_s
    })
}

/// Gravel of a mass in g poured through a wide funnel: a layer whose height
/// depends on how many grains there are. Its rest test makes it valid.
pub fn layer(mass_g: f64) -> Value {
    json!({
        "name": "small",
        "grains": gravel(mass_g),
        "apparatus": {
            "cylinder": { "inner_diameter_mm": 75, "height_mm": 120 },
            "funnel": { "opening_diameter_mm": 72, "top_diameter_mm": 140 }
        },
        "engine": { "rate_hz": 240 },
        "stages": [
            { "stage": "fill_funnel", "time_limit_s": 1 },
            { "stage": "pour", "falling_height_mm": 0, "time_limit_s": 1.5 }
        ],
        "rest_test_s": 0.4
    })
}
