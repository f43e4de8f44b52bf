//! How the cost of a step grows with the number of grains, and where it goes:
//! 1, 4, 16 and 64 cylinders of 364 settled grains beside each other in one
//! world, so that nothing differs but the number.

#[allow(dead_code)] // each benchmark uses a part of it
mod common;

use std::{
    collections::HashMap,
    fs,
    sync::Arc,
    time::{Duration, Instant},
};

use criterion::{Criterion, SamplingMode, Throughput, criterion_group, criterion_main};
use pluvia::{
    apparatus::TableMotion,
    geometry::{Pose, Vector},
    protocol::Setup,
    specimen::Other,
    specimen::{Fate, Party, Specimen},
    world::{
        self, Body, BodyId, BodyState, Material, Motion, PhaseTimes, RememberedContact, World,
    },
};

use common::{QUARTER, filled, scenario, settled};

/// Cylinders in a world.
const COPIES: [usize; 4] = [1, 4, 16, 64];

/// Distance between the axes of neighbouring cylinders in m.
const PITCH: f64 = 0.2;

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
                let x = motion.displacement(self.time);
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
const ROUNDS: usize = 6;

/// Time in s of one step.
fn spent(before: PhaseTimes, after: PhaseTimes) -> [f64; 4] {
    [
        after.broadphase_s - before.broadphase_s,
        after.collision_s - before.collision_s,
        after.solver_s - before.solver_s,
        after.integration_s - before.integration_s,
    ]
}

/// Memory of the largest world. It must be the first of all: what a world gives
/// back is not given back to the system, and the next one takes it from there.
fn memory(setup: &Setup, specimen: &Specimen) {
    let copies = COPIES[COPIES.len() - 1];
    let grains = specimen.present().count() * copies;
    let before = resident();
    let mut cylinders = Cylinders::new(setup, specimen, copies);
    cylinders.steps(BEFORE, None);
    if let (Some(before), Some(after)) = (before, resident()) {
        let each = (after - before) / 1024.0 / grains as f64;
        println!("rest, {grains} grains: {each:.1} KiB a grain");
    }
}

/// Where the time of a step goes, by the number of grains.
///
/// Other programs on the machine make single times longer by tens of percent.
/// A world that begins alike does the same in every step: the sizes are
/// measured in turns, and of each step and phase the shortest time counts.
fn phases(setup: &Setup, specimen: &Specimen, motion: &TableMotion) {
    // Criterion's `--quick`: one round, without the largest.
    let quick = std::env::args().any(|a| a == "--quick");
    let (rounds, sizes) = if quick { (2, 3) } else { (ROUNDS, COPIES.len()) };
    for (what, motion) in [("rest", None), ("shaken", Some(motion))] {
        let mut least = vec![[[f64::INFINITY; 4]; MEASURED]; sizes];
        for _ in 0..rounds {
            for (least, copies) in least.iter_mut().zip(COPIES) {
                let mut cylinders = Cylinders::new(setup, specimen, copies);
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
        let mut first = f64::NAN;
        for (least, copies) in least.iter().zip(COPIES) {
            let grains = specimen.present().count() * copies;
            let phase = |p: usize| {
                let sum: f64 = least.iter().map(|step| step[p]).sum();
                sum / (MEASURED * grains) as f64 * 1e9
            };
            let all: f64 = (0..4).map(phase).sum();
            if first.is_nan() {
                first = all;
            }
            println!(
                "{what}, {grains} grains, ns a grain-step: broadphase {:.0}, collision {:.0}, \
                 solver {:.0}, integration {:.0}, all {all:.0}, {:.2} times the first",
                phase(0),
                phase(1),
                phase(2),
                phase(3),
                all / first,
            );
        }
    }
}

fn growth(c: &mut Criterion) {
    let scenario = scenario(QUARTER);
    let setup = Setup::new(&scenario).expect("a laboratory");
    let specimen = settled(&setup, filled(&scenario, &setup));
    let shaking = TableMotion {
        amplitude: 0.025,
        frequency: 3.0,
        duration: 1e6,
        periods: 1,
        rest: 0.0,
        ramp: 0.0,
    };
    memory(&setup, &specimen);
    phases(&setup, &specimen, &shaking);
    let mut group = c.benchmark_group("a step");
    group.sample_size(10).sampling_mode(SamplingMode::Flat);
    group.warm_up_time(Duration::from_millis(1)).measurement_time(Duration::from_secs(10));
    for copies in COPIES {
        let grains = specimen.present().count() * copies;
        group.throughput(Throughput::Elements(grains as u64));
        for (what, motion) in [("rest", None), ("shaken", Some(&shaking))] {
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
