//! Specimens that the benchmarks make for themselves: grains of the paper's
//! sieve table, a quarter of its mass in a narrower cylinder or all of it.

use std::{sync::Arc, sync::atomic::AtomicBool};

use pluvia::{
    grains::generate,
    protocol::{Setup, StageOutcome, run},
    scenario::{GrainsSpec, Scenario, SievedGrains, StageSpec},
    specimen::{FunnelState, Specimen, SpecimenState},
    world,
};

/// Mass of the paper's specimen in g, and the diameter of its cylinder in mm.
pub const WHOLE: (f64, f64) = (2343.0, 115.0);
/// A quarter of it, in a cylinder in which it stands as high.
pub const QUARTER: (f64, f64) = (585.75, 72.5);

/// Falling height of the pour in mm.
pub const FALLING_HEIGHT_MM: f64 = 50.0;

/// A scenario without stages, of a mass in g and a cylinder's diameter in mm.
pub fn scenario((mass_g, diameter_mm): (f64, f64)) -> Scenario {
    serde_json::from_value(serde_json::json!({
        "name": "bench",
        "grains": {
            "total_mass_g": mass_g, "density_kg_per_m3": 2673.9,
            "sieve_table": [
                { "passing_mm": 16, "retained_mm": 12.5, "mass_percent": 15 },
                { "passing_mm": 12.5, "retained_mm": 10, "mass_percent": 51.95 },
                { "passing_mm": 10, "retained_mm": 8, "mass_percent": 33.05 }
            ]
        },
        "apparatus": {
            "cylinder": { "inner_diameter_mm": diameter_mm, "height_mm": 200 },
            "funnel": { "opening_diameter_mm": 70, "top_diameter_mm": 260 }
        },
        "stages": []
    }))
    .expect("a scenario")
}

/// Its sieve table.
pub fn sieved(scenario: &Scenario) -> &SievedGrains {
    match &scenario.grains {
        GrainsSpec::Sieved(spec) => spec,
        GrainsSpec::File(_) | GrainsSpec::Meshes(_) => unreachable!("made from a sieve table"),
    }
}

/// A stage run.
pub fn stage(setup: &Setup, specimen: Specimen, stage: &StageSpec) -> StageOutcome {
    run(setup, &world::create, specimen, stage, None, &mut (), &AtomicBool::new(false))
        .expect("a finished stage")
}

/// Grains in the closed funnel, filled with the default engine.
pub fn filled(scenario: &Scenario, setup: &Setup) -> Specimen {
    let grains = Arc::new(generate(sieved(scenario), 1).expect("grains"));
    let state = SpecimenState::before_everything(grains.grains.len());
    let specimen = Specimen { grains, state };
    stage(setup, specimen, &StageSpec::FillFunnel { time_limit_s: 4.0 }).specimen
}

/// Grains of a filled funnel poured and settled.
pub fn settled(setup: &Setup, filled: Specimen) -> Specimen {
    let poured = StageSpec::Pour { falling_height_mm: FALLING_HEIGHT_MM, time_limit_s: 4.0 };
    let specimen = stage(setup, filled, &poured).specimen;
    stage(setup, specimen, &StageSpec::Rest { duration_s: 0.5 }).specimen
}

/// The filled funnel in its place above the cylinder, its lid gone, as the stage `pour` begins.
pub fn lifted(setup: &Setup, mut specimen: Specimen) -> Specimen {
    let opening_height = setup.cylinder.height + 1e-3 * FALLING_HEIGHT_MM;
    let state = &mut specimen.state;
    let rise = state.funnel.map_or(0.0, |funnel| opening_height - funnel.opening_height);
    state.bodies.iter_mut().for_each(|grain| grain.body.pose.translation.z += rise);
    state.contacts.iter_mut().for_each(|contact| contact.point_m.z += rise);
    state.funnel = Some(FunnelState { opening_height, lid: false });
    state.cylinder = true;
    specimen
}
