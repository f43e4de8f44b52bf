//! A scenario that runs in a second: a few grains, poured and shaken.

use serde_json::{Value, json};

/// Gravel of a mass in g, shaken for whole cycles of 0.25 s, then left alone.
pub fn scenario(mass_g: f64, shaken_s: f64, control_s: f64) -> Value {
    json!({
        "name": "small",
        "grains": {
            "total_mass_g": mass_g, "density_kg_per_m3": 2673.9,
            "sieve_table": [{ "passing_mm": 12.5, "retained_mm": 10, "mass_percent": 100 }]
        },
        "stages": [
            { "stage": "fill_funnel" },
            { "stage": "pour", "falling_height_mm": 0 },
            { "stage": "place_top_plate" },
            { "stage": "vibrate", "frequency_hz": 4, "amplitude_mm": 10, "duration_s": shaken_s },
        ],
        "control_s": control_s
    })
}
