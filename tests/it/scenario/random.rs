//! Scenarios drawn at random: each loads and makes sound grains, or is refused
//! with faults that name their place.

use pluvia::grains::{GrainsError, generate};
use pluvia::scenario::{GrainsSpec, ScenarioErrors};
use proptest::prelude::*;
use serde_json::{Value, json};

use super::load_text;

/// A number about `around`, over two decades, or now and then anything at all.
fn number(around: f64) -> impl Strategy<Value = f64> {
    prop_oneof![
        12 => (-1.0..1.0f64).prop_map(move |x| around * 10f64.powf(x)),
        1 => any::<f64>().prop_filter("JSON has no others", |x| x.is_finite()),
    ]
}

/// A sieve table whose shares add up, finer and finer.
fn table() -> impl Strategy<Value = Value> {
    let row = (1.05..1.6f64, 0.05..1.0f64);
    (4.0..16.0f64, proptest::collection::vec(row, 1..5)).prop_map(|(finest, rows)| {
        let all: f64 = rows.iter().map(|(_, share)| share).sum();
        let mut retained = finest;
        let mut table = Vec::new();
        for (ratio, share) in rows {
            let passing = retained * ratio;
            table.push(json!({
                "passing_mm": passing, "retained_mm": retained, "mass_percent": share / all * 100.0
            }));
            retained = passing;
        }
        table.reverse();
        Value::Array(table)
    })
}

prop_compose! {
    fn scenario()(
        mass in number(20.0),
        density in number(2500.0),
        table in table(),
        seed in any::<u64>(),
        configuration in 0u32..5,
        diameter in number(100.0),
        height in number(200.0),
        gravity in number(9.81),
        friction in number(0.5),
        rate in number(480.0),
        fall in number(50.0),
    ) -> Value {
        json!({
            "name": "random",
            "seed": seed,
            "configuration": configuration,
            "gravity_m_per_s2": gravity,
            "grains": {
                "total_mass_g": mass, "density_kg_per_m3": density, "sieve_table": table
            },
            "apparatus": { "cylinder": { "inner_diameter_mm": diameter, "height_mm": height } },
            "contact": { "grain_grain_friction": friction },
            "engine": { "rate_hz": rate },
            "stages": [
                { "stage": "fill_funnel" },
                { "stage": "pour", "falling_height_mm": fall },
            ],
        })
    }
}

/// Any JSON at all.
fn any_json() -> impl Strategy<Value = Value> {
    let leaf = prop_oneof![
        Just(Value::Null),
        any::<bool>().prop_map(Value::from),
        any::<i64>().prop_map(Value::from),
        any::<f64>().prop_map(|x| json!(x)),
        ".{0,12}".prop_map(Value::from),
    ];
    leaf.prop_recursive(4, 32, 6, |inner| {
        prop_oneof![
            proptest::collection::vec(inner.clone(), 0..6).prop_map(Value::from),
            proptest::collection::vec(("[a-z_]{1,9}", inner), 0..6)
                .prop_map(|fields| Value::Object(fields.into_iter().collect())),
        ]
    })
}

/// More grains than these take too long here.
const MOST: usize = 150;

fn refused_with_places(errors: &ScenarioErrors) {
    let faults = errors.faults();
    assert!(!faults.is_empty(), "law: a scenario that is refused has a fault");
    for fault in faults {
        assert!(!fault.message.is_empty() && fault.to_string().lines().count() == 1, "{fault:?}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 96, failure_persistence: None, ..Default::default() })]

    #[test]
    fn a_random_scenario_makes_sound_grains_or_is_refused(value in scenario()) {
        let scenario = match load_text(&value.to_string(), &[]) {
            Ok(scenario) => scenario,
            Err(errors) => {
                refused_with_places(&errors);
                return Ok(());
            }
        };
        let GrainsSpec::Sieved(sieved) = &scenario.grains else { panic!("sieved grains") };
        let count = pluvia::grains::ParticleSizeDistribution::new(sieved)
            .map(|psd| psd.fractions.iter().map(|f| f.grains).sum::<usize>());
        prop_assume!(!matches!(count, Ok(count) if count > MOST));
        match generate(sieved, scenario.seed) {
            Ok(set) => {
                prop_assert_eq!(set.grains.len(), count.expect("it was counted"));
                let mass: f64 = set.grains.iter().map(|g| g.mass).sum();
                let asked = sieved.total_mass_g * 1e-3;
                prop_assert!(
                    (mass / asked - 1.0).abs() < 1e-6,
                    "law: grains weigh what was asked for, expected {} kg, got {} kg, tolerance 1e-6",
                    asked,
                    mass
                );
                for grain in &set.grains {
                    prop_assert!(grain.mass > 0.0 && grain.shape.vertices().len() >= 4);
                    prop_assert!(grain.inertia.iter().all(|i| i.is_finite() && *i > 0.0));
                }
            }
            Err(error) => {
                let _: &GrainsError = &error;
                prop_assert!(!error.to_string().is_empty());
            }
        }
    }

    #[test]
    fn any_json_is_answered(value in any_json()) {
        if let Err(errors) = load_text(&value.to_string(), &[]) {
            refused_with_places(&errors);
        }
    }
}
