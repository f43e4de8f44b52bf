//! What a step costs, and what measuring costs beside it.
//!
//! The specimen is made here: grains of the paper's sieve table, a quarter of
//! its mass, poured into a narrower cylinder and settled. Compare figures of
//! one run with each other, not with those of another machine or day.

use std::{hint::black_box, sync::Arc, sync::atomic::AtomicBool, time::Duration};

use criterion::{BatchSize, Criterion, criterion_group, criterion_main};
use pluvia::{
    grains::generate,
    measure::{Container, DEFAULT_CELL, HeightMap, TOUCHING_GAP, grain_energy, pairs_within},
    protocol::{Moment, Observer, Setup, run},
    scenario::{GrainsSpec, Scenario, SievedGrains, StageSpec},
    specimen::{Specimen, SpecimenState},
    world,
};

/// Simulated time in s of one measured stage.
const MEASURED: f64 = 0.1;

struct Nobody;

impl Observer for Nobody {
    fn observe(&mut self, _: &Specimen, _: Moment) {}
}

fn scenario() -> Scenario {
    serde_json::from_value(serde_json::json!({
        "name": "bench",
        "grains": {
            "total_mass_g": 585.75, "density_kg_per_m3": 2673.9,
            "sieve_table": [
                { "passing_mm": 16, "retained_mm": 12.5, "mass_percent": 15 },
                { "passing_mm": 12.5, "retained_mm": 10, "mass_percent": 51.95 },
                { "passing_mm": 10, "retained_mm": 8, "mass_percent": 33.05 }
            ]
        },
        "apparatus": {
            "cylinder": { "inner_diameter_mm": 72.5, "height_mm": 130 },
            "funnel": { "opening_diameter_mm": 70, "top_diameter_mm": 200 }
        },
        "stages": []
    }))
    .expect("a scenario")
}

fn sieved(scenario: &Scenario) -> &SievedGrains {
    match &scenario.grains {
        GrainsSpec::Sieved(spec) => spec,
        GrainsSpec::File(_) => unreachable!("made from a sieve table"),
    }
}

fn stage(setup: &Setup, specimen: Specimen, stage: &StageSpec) -> Specimen {
    run(setup, &world::create, specimen, stage, &mut Nobody, &AtomicBool::new(false))
        .expect("a finished stage")
        .specimen
}

fn benches(c: &mut Criterion) {
    let scenario = scenario();
    let setup = Setup::new(&scenario).expect("a laboratory");
    let grains = Arc::new(generate(sieved(&scenario), 1).expect("grains"));
    let state = SpecimenState::before_everything(grains.grains.len());
    let mut specimen = Specimen { grains, state };
    for prepare in [
        StageSpec::FillFunnel { time_limit_s: 4.0 },
        StageSpec::Pour { falling_height_mm: 50.0, time_limit_s: 4.0 },
    ] {
        specimen = stage(&setup, specimen, &prepare);
    }
    let container =
        Container { centre_x: 0.0, radius: setup.cylinder.radius, height: setup.cylinder.height };

    let mut group = c.benchmark_group("365 grains");
    group.sample_size(10).measurement_time(Duration::from_secs(20));
    let rest = StageSpec::Rest { duration_s: MEASURED };
    group.bench_function("0.1 s at rest", |b| {
        b.iter_batched(|| specimen.clone(), |s| stage(&setup, s, &rest), BatchSize::LargeInput)
    });
    let vibrate = StageSpec::Vibrate {
        frequency_hz: 3.0,
        amplitude_mm: 25.0,
        stroke: pluvia::scenario::StrokeReading::HalfStroke,
        duration_s: MEASURED,
        periods: 1,
        rest_s: 0.0,
    };
    group.bench_function("0.1 s shaken", |b| {
        b.iter_batched(|| specimen.clone(), |s| stage(&setup, s, &vibrate), BatchSize::LargeInput)
    });
    group.finish();

    let mut group = c.benchmark_group("measures");
    group.bench_function("height map", |b| {
        b.iter(|| HeightMap::of(black_box(&specimen), &container, DEFAULT_CELL))
    });
    let members = container.members(&specimen);
    group.bench_function("exact overlap of all pairs", |b| {
        b.iter(|| pairs_within(black_box(&specimen), &members, TOUCHING_GAP))
    });
    let still = pluvia::geometry::Vector::zeros();
    group.bench_function("energy", |b| b.iter(|| grain_energy(black_box(&specimen), 9.81, &still)));
    group.finish();

    c.bench_function("generate 365 grains", |b| {
        b.iter(|| generate(black_box(sieved(&scenario)), 1))
    });
}

criterion_group!(all, benches);
criterion_main!(all);
