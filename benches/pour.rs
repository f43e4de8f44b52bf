//! What a step costs with each engine, and what measuring costs beside it.
//!
//! Compare figures of one run with each other, not with those of another
//! machine or day.

#[allow(dead_code)] // each benchmark uses a part of it
mod common;

use std::{hint::black_box, time::Duration};

use criterion::{BatchSize, Criterion, criterion_group, criterion_main};
use pluvia::{
    grains::generate,
    measure::{Container, HeightMap, grain_energy, height_cell, pairs_within, touching_gap},
    protocol::Setup,
    scenario::{Backend, ContactSolver, EngineSettings, NativeSettings, Scenario, StageSpec},
    specimen::Specimen,
    world,
};

use common::{FALLING_HEIGHT_MM, QUARTER, WHOLE, filled, scenario, settled, sieved, stage};

/// Simulated time in s of one measured stage: half a cycle of shaking, after
/// which the table is in the middle again and does not jump back to it.
const MEASURED: f64 = 1.0 / 6.0;

/// Engines to compare, and the settings that a step costs with. Stock Bullet
/// contacts meet the accuracy standard at no setting; 960 steps of ten
/// iterations are the best of what is commonly used.
fn engines() -> Vec<(&'static str, EngineSettings)> {
    let native = EngineSettings::default();
    let threads = NativeSettings { threads: Some(2), ..native.native.clone() };
    let stock = EngineSettings {
        contact_solver: ContactSolver::Stock,
        rate_hz: 960.0,
        iterations: 10,
        ..native.clone()
    };
    let rapier = EngineSettings { backend: Backend::Rapier, ..native.clone() };
    let two_threads = EngineSettings { native: threads, ..native.clone() };
    let all = [
        ("native", native),
        ("native, two threads", two_threads),
        ("stock Bullet, 960 Hz x 10", stock),
        ("rapier", rapier),
    ];
    all.into_iter().filter(|(_, e)| world::built_in().contains(&e.backend)).collect()
}

/// A sixth of a second at rest, shaken and pouring, by every engine: ratios of
/// one run tell which is faster.
fn steps(c: &mut Criterion, size: (f64, f64)) -> (Scenario, Setup, Specimen) {
    let scenario = scenario(size);
    let setup = Setup::new(&scenario).expect("a laboratory");
    let full = filled(&scenario, &setup);
    let specimen = settled(&setup, full.clone());
    let count = specimen.grains.grains.len();
    let mut group = c.benchmark_group(format!("a sixth of a second of {count} grains"));
    group.sample_size(10).measurement_time(Duration::from_secs(15));
    let rest = StageSpec::Rest { duration_s: MEASURED };
    let vibrate = StageSpec::sine(3.0, 25.0, MEASURED, 0.0);
    let pour = StageSpec::Pour { falling_height_mm: FALLING_HEIGHT_MM, time_limit_s: MEASURED };
    // stock Bullet contacts take half an hour for the whole specimen, which `make bench-peers` has.
    let left_out =
        |engine: &EngineSettings| size == WHOLE && engine.contact_solver == ContactSolver::Stock;
    for (name, engine) in engines().into_iter().filter(|(_, engine)| !left_out(engine)) {
        let setup = Setup { engine, ..setup.clone() };
        let scenes = [
            ("rest", &rest, &specimen),
            ("shaken", &vibrate, &specimen),
            ("pouring", &pour, &full),
        ];
        for (what, spec, from) in scenes {
            group.bench_function(format!("{what}, {name}"), |b| {
                let measured = |s| stage(&setup, s, spec);
                b.iter_batched(|| from.clone(), measured, BatchSize::LargeInput)
            });
        }
    }
    group.finish();
    driver(&setup, &specimen, &vibrate);
    (scenario, setup, specimen)
}

/// What the driver (bridge, checks, readings) takes beside the engine, by six
/// times the measured stage, so that making the world counts for little.
fn driver(setup: &Setup, specimen: &Specimen, spec: &StageSpec) {
    let mut longer = spec.clone();
    let StageSpec::Vibrate(vibrate) = &mut longer else { return };
    vibrate.duration_s = vibrate.duration_s.map(|d| 6.0 * d);
    let begun = std::time::Instant::now();
    let outcome = stage(setup, specimen.clone(), &longer);
    let (all, engine) = (begun.elapsed().as_secs_f64(), outcome.engine_time.as_secs_f64());
    println!(
        "{} grains, {:.1} s shaken: driver {:.2} % of the engine's time",
        specimen.grains.grains.len(),
        outcome.simulated,
        (all / engine - 1.0) * 100.0,
    );
}

fn benches(c: &mut Criterion) {
    let (scenario, setup, specimen) = steps(c, QUARTER);
    if !std::env::args().any(|arg| arg == "--quick") {
        steps(c, WHOLE);
    }
    let container =
        Container { centre_x: 0.0, radius: setup.cylinder.radius, height: setup.cylinder.height };

    let mut group = c.benchmark_group("measures");
    group.bench_function("height map", |b| {
        b.iter(|| HeightMap::of(black_box(&specimen), &container, height_cell(&specimen.grains)))
    });
    let members = container.members(&specimen);
    group.bench_function("exact overlap of all pairs", |b| {
        b.iter(|| pairs_within(black_box(&specimen), &members, touching_gap(&specimen.grains)))
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
