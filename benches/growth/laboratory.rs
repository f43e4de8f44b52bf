//! One world with one specimen, in a process of its own: an apparatus that is stepped and measured.

use std::{
    collections::HashMap,
    io,
    path::Path,
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
};

use clap::ValueEnum;
use pluvia::{
    apparatus::Funnel,
    geometry::{Pose, Vector},
    motion::TableMotion,
    protocol::{Setup, free_grain, remembered, wall_piece},
    specimen::{Fate, Other, Party, Specimen},
    world::{self, Body, BodyId, Motion, World},
};

use super::{
    measured::{Measured, State, Step},
    process::{BESIDE, Beside},
    specimens::{Stored, setup},
};

/// Steps that a state is held before it is measured.
const BEFORE: usize = 48;

/// Measures: arguments are a file with a specimen, the state, the number of threads and, of a world
/// that is measured at once with others, [`BESIDE`].
pub fn measure(args: &[String]) {
    let (file, state, threads, is_beside) = match args {
        [file, state, threads] => (file, state, threads, false),
        [file, state, threads, beside] if beside == BESIDE => (file, state, threads, true),
        _ => panic!("three arguments are needed, and `{BESIDE}`"),
    };
    let state = State::from_str(state, false).expect("a state");
    let stored = Stored::read(Path::new(file));
    let mut setup = setup(stored.size);
    setup.engine.native.threads = Some(threads.parse().expect("a number of threads"));
    let specimen = stored.specimen();
    let over = AtomicBool::new(false);
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let busy = if state == State::ShakenBusy { cores } else { 0 };
    let measured = std::thread::scope(|scope| {
        for _ in 0..busy {
            scope.spawn(|| {
                while !over.load(Ordering::Relaxed) {
                    std::hint::spin_loop();
                }
            });
        }
        let measured = carry(&setup, &specimen, state, is_beside);
        over.store(true, Ordering::Relaxed);
        measured
    });
    println!("{}", serde_json::to_string(&measured).expect("numbers"));
}

fn carry(setup: &Setup, specimen: &Specimen, state: State, is_beside: bool) -> Measured {
    let grains = specimen.present().count();
    let before = resident();
    let mut laboratory = Laboratory::new(setup, specimen);
    let motion = state.motion();
    for _ in 0..BEFORE {
        laboratory.step(motion.as_ref());
    }
    let held = resident().zip(before).map(|(now, before)| now - before);
    let phases = |world: &dyn World| world.phases().expect("an engine that tells phases");
    let beside = is_beside.then(|| {
        Beside::begin(io::BufReader::new(io::stdin()), io::stdout()).expect("all are ready")
    });
    let steps = (0..state.steps())
        .map(|_| {
            let before = phases(&*laboratory.world);
            laboratory.step(motion.as_ref());
            Step::between(&before, &phases(&*laboratory.world))
        })
        .collect();
    let mut contacts = Vec::new();
    laboratory.world.remember(&mut contacts);
    if let Some(beside) = beside {
        beside.stay_busy(|| laboratory.step(motion.as_ref())).expect("the others are done");
    }
    Measured {
        grains,
        rate_hz: 1.0 / laboratory.world.time_step(),
        contacts_per_grain: contacts.len() as f64 / grains as f64,
        memory_kib_per_grain: held.map(|bytes| bytes / 1024.0 / grains as f64),
        steps,
    }
}

/// Memory that this process holds, in bytes.
fn resident() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:"))?;
    Some(1024.0 * line.split_whitespace().next()?.parse::<f64>().ok()?)
}

/// A specimen in its cylinder on a table that moves along x.
struct Laboratory {
    world: Box<dyn World + Send>,
    walls: Vec<(BodyId, Pose)>,
    time: f64,
}

impl Laboratory {
    fn new(setup: &Setup, specimen: &Specimen) -> Self {
        let gravity = Vector::new(0.0, 0.0, -setup.gravity);
        let mut world = world::create(&setup.engine, gravity, &setup.pairs).expect("a world");
        let mut ids = HashMap::new();
        let mut walls = Vec::new();
        for (n, piece) in setup.cylinder.pieces.iter().enumerate() {
            let id = world.add(&wall_piece(piece, Motion::Kinematic)).expect("a wall");
            ids.insert(Party::Other(Other::Cylinder(n)), id);
            walls.push((id, piece.pose));
        }
        if let Some(funnel) = specimen.state.funnel {
            let funnel = Funnel::new(&setup.funnel, funnel.opening_height, 0.0).expect("a funnel");
            for (n, piece) in funnel.pieces.iter().enumerate() {
                let wall = wall_piece(piece, Motion::Static);
                let id = world.add(&wall).expect("a piece of the funnel");
                ids.insert(Party::Other(Other::Funnel(n)), id);
            }
        }
        let grains = specimen.grains.grains.iter().zip(&specimen.state.bodies).enumerate();
        for (n, (grain, state)) in grains.filter(|(_, (_, s))| s.fate == Fate::Present) {
            // Of its own, as in a specimen that was poured.
            let shape = Arc::new((*grain.shape).clone());
            let body = Body { shape, ..free_grain(grain, state.body) };
            ids.insert(Party::Grain(n), world.add(&body).expect("a grain"));
        }
        world.recall(&remembered(&specimen.state.contacts, &ids)).expect("contacts");
        Self { world, walls, time: 0.0 }
    }

    fn step(&mut self, motion: Option<&TableMotion>) {
        self.time += self.world.time_step();
        if let Some(motion) = motion {
            let shift = motion.displacement(self.time);
            for (id, pose) in &self.walls {
                let mut pose = *pose;
                pose.translation.vector += shift;
                self.world.drive(*id, &pose).expect("a wall");
            }
        }
        self.world.step().expect("a step");
    }
}
