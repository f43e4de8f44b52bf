//! What a step costs, and what measuring costs beside it.
//!
//! The specimens are made here: grains of the paper's sieve table, a quarter of
//! its mass in a narrower cylinder and all of it, poured and settled. Compare
//! figures of one run with each other, not with those of another machine or day.

use std::{hint::black_box, sync::Arc, sync::atomic::AtomicBool, time::Duration};

use criterion::{BatchSize, Criterion, criterion_group, criterion_main};
use pluvia::{
    grains::generate,
    measure::{Container, DEFAULT_CELL, HeightMap, TOUCHING_GAP, grain_energy, pairs_within},
    protocol::{Moment, Observer, Setup, run},
    scenario::{
        Backend, ContactPath, EngineSettings, GrainsSpec, ManifoldSettings, Scenario, SievedGrains,
        StageSpec,
    },
    specimen::{Specimen, SpecimenState},
    world,
};

/// Simulated time in s of one measured stage.
const MEASURED: f64 = 0.1;

/// Mass of the paper's specimen in g, and the diameter of its cylinder in mm.
const WHOLE: (f64, f64) = (2343.0, 115.0);
/// A quarter of it, in a cylinder as high.
const QUARTER: (f64, f64) = (585.75, 72.5);

struct Nobody;

impl Observer for Nobody {
    fn observe(&mut self, _: &Specimen, _: Moment) {}
}

fn scenario((mass_g, diameter_mm): (f64, f64)) -> Scenario {
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

/// Engines to compare, and the settings that a step costs with. Bullet's own
/// contacts meet the accuracy standard at no setting; 960 steps of ten
/// iterations are the best of what is commonly used.
fn engines() -> Vec<(&'static str, EngineSettings)> {
    let manifold = EngineSettings::default();
    let threads = ManifoldSettings { threads: 2, ..manifold.manifold.clone() };
    let bullets_own = EngineSettings {
        contact_path: ContactPath::Bullet,
        rate_hz: 960.0,
        iterations: 10,
        ..manifold.clone()
    };
    let rapier = EngineSettings { backend: Backend::Rapier, ..manifold.clone() };
    let two_threads = EngineSettings { manifold: threads, ..manifold.clone() };
    let all = [
        ("manifold", manifold),
        ("manifold, two threads", two_threads),
        ("bullet's own, 960 Hz x 10", bullets_own),
        ("rapier", rapier),
    ];
    all.into_iter().filter(|(_, e)| world::built_in().contains(&e.backend)).collect()
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

/// Grains poured and settled with the default engine.
fn settled(scenario: &Scenario, setup: &Setup) -> Specimen {
    let grains = Arc::new(generate(sieved(scenario), 1).expect("grains"));
    let state = SpecimenState::before_everything(grains.grains.len());
    let mut specimen = Specimen { grains, state };
    for prepare in [
        StageSpec::FillFunnel { time_limit_s: 4.0 },
        StageSpec::Pour { falling_height_mm: 50.0, time_limit_s: 4.0 },
        StageSpec::Rest { duration_s: 0.5 },
    ] {
        specimen = stage(setup, specimen, &prepare);
    }
    specimen
}

/// A tenth of a second at rest and shaken, by every engine: ratios of one run
/// tell which is faster.
fn steps(c: &mut Criterion, size: (f64, f64)) -> (Scenario, Setup, Specimen) {
    let scenario = scenario(size);
    let setup = Setup::new(&scenario).expect("a laboratory");
    let specimen = settled(&scenario, &setup);
    let count = specimen.grains.grains.len();
    let mut group = c.benchmark_group(format!("{MEASURED} s of {count} grains"));
    group.sample_size(10).measurement_time(Duration::from_secs(15));
    let rest = StageSpec::Rest { duration_s: MEASURED };
    let vibrate = StageSpec::Vibrate {
        frequency_hz: 3.0,
        amplitude_mm: 25.0,
        stroke: pluvia::scenario::StrokeReading::HalfStroke,
        duration_s: MEASURED,
        periods: 1,
        rest_s: 0.0,
    };
    for (name, engine) in engines() {
        let setup = Setup { engine, ..setup.clone() };
        for (what, spec) in [("rest", &rest), ("shaken", &vibrate)] {
            group.bench_function(format!("{what}, {name}"), |b| {
                let measured = |s| stage(&setup, s, spec);
                b.iter_batched(|| specimen.clone(), measured, BatchSize::LargeInput)
            });
        }
    }
    group.finish();
    (scenario, setup, specimen)
}

fn benches(c: &mut Criterion) {
    let (scenario, setup, specimen) = steps(c, QUARTER);
    steps(c, WHOLE);
    let container =
        Container { centre_x: 0.0, radius: setup.cylinder.radius, height: setup.cylinder.height };

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

    c.bench_function("generate a quarter of the grains", |b| {
        b.iter(|| generate(black_box(sieved(&scenario)), 1))
    });
}

criterion_group!(all, benches);
criterion_main!(all);
