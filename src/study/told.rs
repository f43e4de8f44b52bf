//! What a reader should know of scenarios before they are run.

use super::*;
use crate::grains::Grain;

/// Reports what is typed in scenarios and does not suit their grains: each distinct warning once,
/// in the order of the scenarios, however many of them share it.
pub fn tell_warnings<'a>(
    scenarios: impl IntoIterator<Item = &'a Scenario>,
    progress: &dyn Progress,
) {
    let of = |scenario: &'a Scenario| [warnings(scenario), lids::too_wide(scenario)].concat();
    let told = scenarios.into_iter().flat_map(of).map(|said| format!("warning: {said}"));
    each_once(told).iter().for_each(|text| progress.message(text));
}

/// What a reader should know of a scenario once its grains are there: openings that are shorter
/// than the longest of them.
pub(super) fn of_grains(scenario: &Scenario, grains: &GrainSet) -> Vec<String> {
    if !scenario.stages.iter().any(|s| s.name() == "pour") {
        return Vec::new();
    }
    let radius = |g: &Grain| g.shape.radius_about_origin();
    let longest = 2.0 * to_mm(grains.grains.iter().map(radius).fold(0.0, f64::max));
    let apparatus = &scenario.apparatus;
    [
        ("apparatus.funnel.opening_diameter_mm", apparatus.funnel.opening_diameter_mm),
        ("apparatus.cylinder.inner_diameter_mm", apparatus.cylinder.inner_diameter_mm),
    ]
    .into_iter()
    .filter(|(_, opening)| *opening < longest)
    .map(|(field, opening)| {
        format!(
            "{field}: {opening} mm are less than the longest grain, which is up to {longest:.1} mm \
             long: grains may not get through"
        )
    })
    .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::tests::Heard;

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
        let told = heard.told();
        assert_eq!(told.len(), 2, "law: two distinct warnings among five scenarios: {told:?}");
        assert!(told[0].starts_with("warning: engine.native.substep_rate_hz"), "{told:?}");
        assert!(told[1].starts_with("warning: engine.rate_hz"), "{told:?}");
        let heard = Heard::default();
        tell_warnings([&plain], &heard);
        assert!(heard.told().is_empty(), "law: nothing to tell");
    }

    /// Law: an opening shorter than the longest grain is reported once the grains are there.
    #[test]
    fn openings_shorter_than_the_longest_grain_are_told() {
        let mut pour = scenario(serde_json::json!({}), 0.5);
        pour.stages = serde_json::from_value(serde_json::json!([
            { "stage": "fill_funnel" }, { "stage": "pour", "falling_height_mm": 0 }
        ]))
        .expect("stages");
        let crate::scenario::GrainsSpec::Sieved(sieved) = &pour.grains else { panic!("sieved") };
        let grains = crate::grains::generate(sieved, 1).expect("grains");
        assert!(of_grains(&pour, &grains).is_empty(), "law: the paper's openings are wide enough");
        pour.apparatus.funnel.opening_diameter_mm = 10.0;
        let told = of_grains(&pour, &grains);
        assert!(
            told.len() == 1 && told[0].contains("funnel.opening_diameter_mm: 10 mm"),
            "law: it is reported with its field, got {told:?}"
        );
    }
}
