//! What a reader should know of scenarios before they are run.

use std::collections::BTreeSet;

use crate::protocol::Progress;
use crate::scenario::{Scenario, warnings};

/// Reports what is typed in scenarios and does not suit their grains: each distinct warning once,
/// in the order of the scenarios, however many of them share it.
pub fn tell_warnings<'a>(
    scenarios: impl IntoIterator<Item = &'a Scenario>,
    progress: &dyn Progress,
) {
    let mut told = BTreeSet::new();
    for warning in scenarios.into_iter().flat_map(warnings) {
        let text = format!("warning: {warning}");
        if told.insert(text.clone()) {
            progress.message(&text);
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Mutex;

    use super::*;

    #[derive(Default)]
    struct Heard(Mutex<Vec<String>>);

    impl Progress for Heard {
        fn begin_stage(&self, _: u64, _: &str, _: f64) {}
        fn update(&self, _: u64, _: f64, _: &str) {}
        fn end_stage(&self, _: u64) {}
        fn message(&self, text: &str) {
            self.0.lock().expect("held by one").push(text.to_owned());
        }
    }

    fn scenario(engine: serde_json::Value, friction: f64) -> Scenario {
        serde_json::from_value(serde_json::json!({
            "name": "test",
            "grains": {
                "total_mass_g": 20, "density_kg_per_m3": 2673.9,
                "sieve_table": [{ "passing_mm": 16, "retained_mm": 8, "mass_percent": 100 }]
            },
            "contact": { "grain_grain_friction": friction },
            "engine": engine,
            "stages": []
        }))
        .expect("a scenario")
    }

    #[test]
    fn each_distinct_warning_is_told_once() {
        let soft = |friction| {
            scenario(serde_json::json!({ "native": { "substep_rate_hz": 100 } }), friction)
        };
        let other = scenario(serde_json::json!({ "rate_hz": 100 }), 0.5);
        let plain = scenario(serde_json::json!({}), 0.5);
        let heard = Heard::default();
        tell_warnings([&plain, &soft(0.3), &soft(0.5), &other, &soft(0.3)], &heard);
        let told = heard.0.into_inner().expect("held by none");
        assert_eq!(told.len(), 2, "law: two distinct warnings among five scenarios: {told:?}");
        assert!(told[0].starts_with("warning: engine.native.substep_rate_hz"), "{told:?}");
        assert!(told[1].starts_with("warning: engine.rate_hz"), "{told:?}");
        let heard = Heard::default();
        tell_warnings([&plain], &heard);
        assert!(heard.0.into_inner().expect("held by none").is_empty(), "law: nothing to tell");
    }
}
