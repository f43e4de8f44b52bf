//! What a reader should know of scenarios before they are run.

use super::*;
use crate::apparatus::RigidPiece;
use crate::grains::Grain;
use crate::scenario::LoadSpec;

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
/// than the longest of them, and such as none passes.
pub(super) fn of_grains(scenario: &Scenario, grains: &GrainSet) -> Vec<String> {
    [narrow_openings(scenario, grains), low_openings(scenario, grains)].concat()
}

/// Openings of a laboratory that lie where grains that fall have been taken away, while no stage
/// moves its pieces, lets them go, or presses them up, down or about an axis.
fn low_openings(scenario: &Scenario, grains: &GrainSet) -> Vec<String> {
    // Grains are followed below a pressed piece that sinks, too.
    let may_sink = |load: &LoadSpec| load.moment_n_m.is_some() || load.direction[2] != 0.0;
    let moves = |stage: &StageSpec| match stage {
        StageSpec::Move(_) | StageSpec::Release(_) => true,
        StageSpec::Press(press) => press.loads.iter().any(may_sink),
        _ => false,
    };
    if scenario.begin.is_some() || scenario.stages.iter().any(moves) {
        return Vec::new();
    }
    let pieces = scenario.pieces.iter().filter_map(|piece| RigidPiece::new(piece).ok());
    let lowest = pieces.map(|piece| piece.at.translation.z - piece.radius);
    let Some(lowest) = lowest.min_by(f64::total_cmp) else { return Vec::new() };
    let followed = to_mm(lowest - grains.of_size(&scale::FALL_BELOW));
    let openings = scenario.measures.openings.iter().enumerate();
    let low = openings.filter_map(|(k, opening)| {
        let across = crate::protocol::opening(opening).direction.xy().norm();
        let highest = opening.at_mm[2] + across * opening.diameter_mm / 2.0;
        let message = "grains that fall are taken away before they pass the opening";
        let allowed = format!("a place above {followed:.0} mm");
        let found = format!("{:?}", opening.at_mm);
        let fault = Fault::new(message, found, allowed).at(format!("measures.openings[{k}].at_mm"));
        (highest < followed).then(|| fault.to_string())
    });
    low.collect()
}

/// Openings of the funnel and the cylinder that are shorter than the longest grain.
fn narrow_openings(scenario: &Scenario, grains: &GrainSet) -> Vec<String> {
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

    /// Law: an opening below the place at which fallen grains are taken away is reported, where pieces
    /// stay where they are.
    #[test]
    fn openings_that_no_grain_comes_to_are_warned_of() {
        let mut hopper = scenario(serde_json::json!({}), 0.5);
        // Within 100 mm of z = 100 mm, and grains of up to 16 mm are followed 50 mm farther down.
        let plate = serde_json::json!([{ "name": "plate", "at_mm": [0, 0, 100],
            "shape": { "plate": { "size_mm": [160, 120, 0.01] } } }]);
        hopper.pieces = serde_json::from_value(plate).expect("pieces");
        let at = |z: f64| {
            serde_json::json!({ "name": format!("z{z}"), "at_mm": [0, 0, z],
            "diameter_mm": 20 })
        };
        let upright = serde_json::json!({ "name": "upright", "at_mm": [0, 0, -55],
            "diameter_mm": 20, "direction": [1, 0, 0] });
        let openings = serde_json::json!({ "openings": [at(-45.0), at(-55.0), upright] });
        hopper.measures = serde_json::from_value(openings).expect("openings");
        let crate::scenario::GrainsSpec::Sieved(sieved) = &hopper.grains else { panic!("sieved") };
        let grains = crate::grains::generate(sieved, 1).expect("grains");
        let told = of_grains(&hopper, &grains);
        let sound = told.len() == 1
            && told[0].starts_with("measures.openings[1].at_mm: ")
            && told[0].contains("above -50 mm");
        assert!(sound, "law: the one below −50 mm, got {told:?}");
        let load = |direction: [f64; 3]| {
            let load =
                serde_json::json!({ "piece": "plate", "force_n": 5, "direction": direction });
            serde_json::json!({ "stage": "press", "loads": [load] })
        };
        let down = serde_json::json!({ "stage": "move", "velocity_mm_per_s": [0, 0, -10],
            "travel_mm": 90 });
        for (stage, expected) in [
            (down, 0),
            (load([0.0, 0.0, -1.0]), 0),
            (load([0.0, 0.0, 1.0]), 0),
            (load([1.0, 0.0, 0.0]), 1),
        ] {
            hopper.stages = serde_json::from_value(serde_json::json!([stage])).expect("stages");
            let told = of_grains(&hopper, &grains);
            assert_eq!(
                told.len(),
                expected,
                "law: none where the plate may sink, {stage}: {told:?}"
            );
        }
    }
}
