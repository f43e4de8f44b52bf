//! How the cost of a step grows with the number of grains and falls with threads, and
//! where it goes: one specimen of 364 and of 1456 settled grains, and 4, 16 and 64
//! cylinders of 364 grains beside each other in one world, so that nothing differs but the
//! number; on one thread and on two, at rest, shaken and poured, and shaken while all cores are
//! busy. Writes `out/bench.json`.

#[allow(dead_code)] // each benchmark uses a part of it
mod common;

use std::{
    collections::HashMap,
    fs,
    path::Path,
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    time::{Duration, Instant},
};

use criterion::{Criterion, SamplingMode, Throughput, criterion_group, criterion_main};
use pluvia::{
    geometry::{Pose, Vector},
    motion::TableMotion,
    protocol::Setup,
    record::{create_folder, write_json},
    scenario::StageSpec,
    specimen::Other,
    specimen::{Fate, Party, Specimen},
    world::{
        self, Body, BodyId, BodyState, Material, Motion, PhaseTimes, RememberedContact, World,
    },
};
use serde_json::{Value, json};

use common::{FALLING_HEIGHT_MM, QUARTER, WHOLE, filled, scenario, settled, stage};

/// Cylinders in a world.
const COPIES: [usize; 4] = [1, 4, 16, 64];

/// Distance between the axes of neighbouring cylinders in m.
const PITCH: f64 = 0.2;

/// Threads of a world.
const THREADS: [u32; 2] = [1, 2];

/// Simulated time in s of a measured pour.
const POUR: f64 = 0.5;

/// Steps that a state is held before it is measured.
const BEFORE: usize = 48;

/// Cylinders of grains on a table that moves along x.
struct Cylinders {
    world: Box<dyn World + Send>,
    walls: Vec<(BodyId, Pose)>,
    time: f64,
}

impl Cylinders {
    fn new(setup: &Setup, specimen: &Specimen, copies: usize) -> Self {
        let gravity = Vector::new(0.0, 0.0, -setup.gravity);
        let mut world = world::create(&setup.engine, gravity, &setup.pairs).expect("a world");
        let mut walls = Vec::new();
        let mut contacts = Vec::new();
        let side = (copies as f64).sqrt().ceil() as usize;
        for copy in 0..copies {
            let away = Vector::new(PITCH * (copy % side) as f64, PITCH * (copy / side) as f64, 0.0);
            let mut ids = HashMap::new();
            for (n, piece) in setup.cylinder.pieces.iter().enumerate() {
                let mut pose = piece.pose;
                pose.translation.vector += away;
                let id = world
                    .add(&Body {
                        shape: piece.shape.clone(),
                        motion: Motion::Driven,
                        material: Material::Wall,
                        state: BodyState::at_rest(pose),
                    })
                    .expect("a wall");
                walls.push((id, pose));
                ids.insert(Party::Other(Other::Cylinder(n)), id);
            }
            let grains = specimen.grains.grains.iter().zip(&specimen.state.bodies);
            for (n, (grain, s)) in grains.enumerate().filter(|(_, (_, s))| s.fate == Fate::Present)
            {
                let mut state = s.body;
                state.pose.translation.vector += away;
                let motion = Motion::Free { mass: grain.mass, inertia: grain.inertia };
                // Of its own, as in a specimen of so many grains.
                let shape = Arc::new((*grain.shape).clone());
                let body = Body { shape, motion, material: Material::Grain, state };
                ids.insert(Party::Grain(n), world.add(&body).expect("a grain"));
            }
            contacts.extend(specimen.state.contacts.iter().filter_map(|c| {
                Some(RememberedContact {
                    a: *ids.get(&c.between[0])?,
                    b: *ids.get(&c.between[1])?,
                    point: c.point_m + away,
                    normal: c.normal,
                    force: c.force_n,
                    feature: c.feature,
                })
            }));
        }
        world.recall(&contacts).expect("contacts");
        Self { world, walls, time: 0.0 }
    }

    fn steps(&mut self, count: usize, motion: Option<&TableMotion>) -> Duration {
        let mut spent = Duration::ZERO;
        for _ in 0..count {
            self.time += self.world.time_step();
            if let Some(motion) = motion {
                let x = motion.displacement(self.time).x;
                for (id, pose) in &self.walls {
                    let mut pose = *pose;
                    pose.translation.vector.x += x;
                    self.world.drive(*id, &pose).expect("a wall");
                }
            }
            let begun = Instant::now();
            self.world.step().expect("a step");
            spent += begun.elapsed();
        }
        spent
    }
}

/// Memory that this process holds, in bytes.
fn resident() -> Option<f64> {
    let statm = fs::read_to_string("/proc/self/statm").ok()?;
    Some(statm.split_whitespace().nth(1)?.parse::<f64>().ok()? * 4096.0)
}

/// Steps measured, half a cycle of the shaking.
const MEASURED: usize = 80;

/// Rounds through all sizes.
const ROUNDS: usize = 3;

/// Time in s of one step.
fn spent(before: PhaseTimes, after: PhaseTimes) -> [f64; 4] {
    [
        after.broadphase_s - before.broadphase_s,
        after.collision_s - before.collision_s,
        after.solver_s - before.solver_s,
        after.integration_s - before.integration_s,
    ]
}

/// What is measured: a specimen, and how often it stands in the world.
struct Size<'a> {
    setup: &'a Setup,
    specimen: &'a Specimen,
    copies: usize,
}

impl Size<'_> {
    fn grains(&self) -> usize {
        self.specimen.present().count() * self.copies
    }

    fn on(&self, threads: u32) -> Setup {
        let mut setup = self.setup.clone();
        setup.engine.manifold.threads = Some(threads);
        setup
    }
}

/// Memory in KiB that a world holds for each grain. Only of the first world: what one
/// gives back is not given back to the system, and the next takes it from there.
fn memory(size: &Size) -> Option<f64> {
    let before = resident()?;
    let mut cylinders = Cylinders::new(size.setup, size.specimen, size.copies);
    cylinders.steps(BEFORE, None);
    let each = (resident()? - before) / 1024.0 / size.grains() as f64;
    println!("rest, {} grains: {each:.1} KiB a grain", size.grains());
    Some(each)
}

/// A row of `out/bench.json`.
fn row(size: &Size, state: &str, threads: u32, phases: [f64; 4], kib: Option<f64>) -> Value {
    let step: f64 = phases.iter().sum();
    let grains = size.grains();
    println!(
        "{state}, {grains} grains in {} specimens, {threads} threads: {:.2} ms a step, {:.2} µs a \
         grain-step; broadphase {:.2}, collision {:.2}, solver {:.2}, integration {:.2} ms",
        size.copies,
        step * 1e3,
        step * 1e6 / grains as f64,
        phases[0] * 1e3,
        phases[1] * 1e3,
        phases[2] * 1e3,
        phases[3] * 1e3,
    );
    json!({
        "grains": grains,
        "specimens": size.copies,
        "state": state,
        "threads": threads,
        "ms_per_step": step * 1e3,
        "us_per_grain_step": step * 1e6 / grains as f64,
        "phases": {
            "broadphase_ms": phases[0] * 1e3,
            "collision_ms": phases[1] * 1e3,
            "solver_ms": phases[2] * 1e3,
            "integration_ms": phases[3] * 1e3,
        },
        "memory_kib_per_grain": kib,
    })
}

/// Where the time of a step goes, at rest or shaken, by size and threads.
///
/// Other programs on the machine make single times longer by tens of percent.
/// A world that begins alike does the same in every step: the sizes are
/// measured in turns, and of each step and phase the shortest time counts.
fn phases(sizes: &[Size], kib: &[Option<f64>], motion: &TableMotion, rounds: usize) -> Vec<Value> {
    let mut rows = Vec::new();
    for (state, motion) in [("rest", None), ("shaken", Some(motion))] {
        // The largest, shaken, would take an hour.
        let measured = |size: &usize| motion.is_none() || sizes[*size].grains() < 10_000;
        let cases: Vec<(usize, u32)> = (0..sizes.len())
            .filter(measured)
            .flat_map(|size| THREADS.map(|threads| (size, threads)))
            .collect();
        let mut least = vec![[[f64::INFINITY; 4]; MEASURED]; cases.len()];
        for _ in 0..rounds {
            for (least, (size, threads)) in least.iter_mut().zip(&cases) {
                let size = &sizes[*size];
                let mut cylinders = Cylinders::new(&size.on(*threads), size.specimen, size.copies);
                cylinders.steps(BEFORE, motion);
                for least in least {
                    let before = cylinders.world.phases().expect("an engine that tells phases");
                    cylinders.steps(1, motion);
                    let after = cylinders.world.phases().expect("an engine that tells phases");
                    for (least, now) in least.iter_mut().zip(spent(before, after)) {
                        *least = least.min(now);
                    }
                }
            }
        }
        for (least, (size, threads)) in least.iter().zip(&cases) {
            let phase = |p| least.iter().map(|step| step[p]).sum::<f64>() / MEASURED as f64;
            let phases = [phase(0), phase(1), phase(2), phase(3)];
            rows.push(row(&sizes[*size], state, *threads, phases, kib[*size]));
        }
    }
    rows
}

/// The beginning of a pour. The engine's time in a stage is not split into phases.
fn pours(size: &Size, filled: &Specimen, rounds: usize) -> Vec<Value> {
    let spec = StageSpec::Pour { falling_height_mm: FALLING_HEIGHT_MM, time_limit_s: POUR };
    THREADS
        .iter()
        .map(|&threads| {
            let setup = size.on(threads);
            let step = (0..rounds)
                .map(|_| {
                    let outcome = stage(&setup, filled.clone(), &spec);
                    outcome.engine_time.as_secs_f64() / outcome.steps as f64
                })
                .fold(f64::INFINITY, f64::min);
            let grains = size.grains();
            println!("pour, {grains} grains, {threads} threads: {:.2} ms a step", step * 1e3);
            json!({
                "grains": grains, "specimens": 1, "state": "pour", "threads": threads,
                "ms_per_step": step * 1e3, "us_per_grain_step": step * 1e6 / grains as f64,
                "phases": {}, "memory_kib_per_grain": null,
            })
        })
        .collect()
}

/// Shaken while all cores have something else to do: threads of one world then share
/// them, and may not wait for each other longer than one of them takes.
fn busy(size: &Size, motion: &TableMotion) -> Vec<Value> {
    let over = AtomicBool::new(false);
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let mut spent = THREADS.map(|_| Duration::ZERO);
    std::thread::scope(|scope| {
        for _ in 0..cores {
            scope.spawn(|| {
                while !over.load(Ordering::Relaxed) {
                    std::hint::spin_loop();
                }
            });
        }
        let mut worlds =
            THREADS.map(|threads| Cylinders::new(&size.on(threads), size.specimen, size.copies));
        for _ in 0..MEASURED {
            for (world, spent) in worlds.iter_mut().zip(&mut spent) {
                *spent += world.steps(1, Some(motion));
            }
        }
        over.store(true, Ordering::Relaxed);
    });
    let grains = size.grains();
    let step = spent.map(|spent| spent.as_secs_f64() / MEASURED as f64);
    println!(
        "shaken, {grains} grains, all cores busy: {} threads take {:.2} times as long as {}",
        THREADS[1],
        step[1] / step[0],
        THREADS[0],
    );
    let row = |(threads, step): (&u32, f64)| {
        json!({
            "grains": grains, "specimens": size.copies, "state": "shaken_busy",
            "threads": threads, "ms_per_step": step * 1e3,
            "us_per_grain_step": step * 1e6 / grains as f64,
            "phases": {}, "memory_kib_per_grain": null,
        })
    };
    THREADS.iter().zip(step).map(row).collect()
}

/// Measures everything and writes `out/bench.json`.
fn table(quarter: (&Setup, &Specimen, &Specimen), motion: &TableMotion) {
    // Criterion's `--quick`: fewer rounds, without the largest sizes and pours.
    let quick = std::env::args().any(|a| a == "--quick");
    let (setup, full, specimen) = quarter;
    let copies = if quick { &COPIES[..3] } else { &COPIES[..] };
    let mut sizes: Vec<Size> =
        copies.iter().rev().map(|&copies| Size { setup, specimen, copies }).collect();
    let mut kib = vec![None; sizes.len()];
    kib[0] = memory(&sizes[0]);
    let whole = scenario(WHOLE);
    let whole_setup = Setup::new(&whole).expect("a laboratory");
    let whole_full = filled(&whole, &whole_setup);
    let whole_specimen = settled(&whole_setup, whole_full.clone());
    sizes.push(Size { setup: &whole_setup, specimen: &whole_specimen, copies: 1 });
    kib.push(None);
    let rounds = if quick { 2 } else { ROUNDS };
    let mut rows = phases(&sizes, &kib, motion, rounds);
    rows.extend(busy(&sizes[sizes.len() - 1], motion));
    if !quick {
        rows.extend(pours(&Size { setup, specimen, copies: 1 }, full, 2));
        rows.extend(pours(&sizes[sizes.len() - 1], &whole_full, 2));
    }
    let out = Path::new("out");
    create_folder(out).expect("a folder for results");
    write_json(&out.join("bench.json"), &rows).expect("results");
}

fn growth(c: &mut Criterion) {
    let scenario = scenario(QUARTER);
    let setup = Setup::new(&scenario).expect("a laboratory");
    let full = filled(&scenario, &setup);
    let specimen = settled(&setup, full.clone());
    let shaking = TableMotion::sine(0.025, 3.0, 1e6);
    table((&setup, &full, &specimen), &shaking);
    let mut group = c.benchmark_group("a step");
    group.sample_size(10).sampling_mode(SamplingMode::Flat);
    group.warm_up_time(Duration::from_millis(1)).measurement_time(Duration::from_secs(10));
    for copies in COPIES {
        let grains = specimen.present().count() * copies;
        group.throughput(Throughput::Elements(grains as u64));
        for (what, motion) in [("rest", None), ("shaken", Some(&shaking))] {
            if motion.is_some() && grains >= 10_000 {
                continue;
            }
            let mut cylinders = Cylinders::new(&setup, &specimen, copies);
            cylinders.steps(BEFORE, motion);
            group.bench_function(format!("{what}, {grains} grains"), |b| {
                b.iter_custom(|count| cylinders.steps(count as usize, motion))
            });
            let begun = Instant::now();
            cylinders.world.read(&mut Vec::new());
            let read = begun.elapsed().as_secs_f64() / grains as f64 * 1e9;
            println!("reading all bodies once: {read:.0} ns a grain");
        }
    }
    group.finish();
}

criterion_group!(all, growth);
criterion_main!(all);
