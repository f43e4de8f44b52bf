//! One world with one specimen, in a process of its own: what its steps take, and how much
//! memory it holds.

use std::{
    collections::HashMap,
    fmt,
    path::Path,
    process::Command,
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
};

use clap::ValueEnum;
use pluvia::{
    apparatus::{Funnel, Piece},
    geometry::{Pose, Vector},
    motion::TableMotion,
    protocol::Setup,
    specimen::{Fate, Other, Party, Specimen},
    world::{
        self, Body, BodyId, BodyState, Material, Motion, PhaseTimes, RememberedContact, World,
    },
};
use serde::{Deserialize, Serialize};

use super::specimens::{Stored, setup};

/// First argument of a process that measures.
pub const MEASURE: &str = "measure";

/// Steps that a state is held before it is measured.
const BEFORE: usize = 48;

/// Steps measured: half a cycle of the shaking.
const MEASURED: usize = 80;

/// Steps measured of a pour, up to half a second from its beginning.
const POURED: usize = 192;

/// What a specimen goes through.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ValueEnum)]
#[serde(rename_all = "snake_case")]
#[value(rename_all = "snake_case")]
pub enum State {
    /// It is left alone.
    Rest,
    /// It is on the table, 3 Hz and ±25 mm.
    Shaken,
    /// The lid of the filled funnel is gone.
    Pour,
    /// Shaken, while every core has something else to do.
    ShakenBusy,
    /// Shaken, with one core for all threads.
    ShakenOneCore,
}

impl fmt::Display for State {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.to_possible_value().expect("none is skipped").get_name())
    }
}

impl State {
    fn motion(self) -> Option<TableMotion> {
        let shaking = TableMotion::sine(0.025, 3.0, 1e6);
        (!matches!(self, Self::Rest | Self::Pour)).then_some(shaking)
    }

    fn steps(self) -> usize {
        if self == Self::Pour { POURED } else { MEASURED }
    }
}

/// Wall time of a step in s.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
pub struct Step {
    /// Broadphase, collision, solver, integration.
    pub phases: [f64; 4],
    /// All of it, where the next two were measured.
    pub whole: f64,
    /// Of that, what threads can share.
    pub shared: f64,
    /// What `shared` would take on 2, 8 and 16 threads.
    pub shared_on: [(u32, f64); 3],
}

impl Step {
    fn between(before: &PhaseTimes, after: &PhaseTimes) -> Self {
        let phases = [
            after.broadphase_s - before.broadphase_s,
            after.collision_s - before.collision_s,
            after.solver_s - before.solver_s,
            after.integration_s - before.integration_s,
        ];
        Self {
            phases,
            whole: phases.iter().sum(),
            shared: after.shared_s - before.shared_s,
            shared_on: std::array::from_fn(|n| {
                let (threads, time) = after.shared_on_s[n];
                (threads, time - before.shared_on_s[n].1)
            }),
        }
    }

    /// All of it.
    pub fn took(&self) -> f64 {
        self.phases.iter().sum()
    }

    /// Of the same step in two worlds that begin alike, the shorter time of each phase; and what
    /// threads can share of the shorter one.
    pub fn shorter(&self, other: &Self) -> Self {
        let phases = std::array::from_fn(|n| self.phases[n].min(other.phases[n]));
        Self { phases, ..if other.whole < self.whole { *other } else { *self } }
    }
}

/// What such a process says.
#[derive(Debug, Serialize, Deserialize)]
pub struct Measured {
    pub grains: usize,
    pub rate_hz: f64,
    /// Points that bear something, at the end.
    pub contacts_per_grain: f64,
    /// Of the world alone; `None` where the system does not tell.
    pub memory_kib_per_grain: Option<f64>,
    pub steps: Vec<Step>,
}

/// Has a process of its own measure.
pub fn in_process(specimen: &Path, state: State, threads: u32) -> Result<Measured, String> {
    let program = std::env::current_exe().map_err(|e| e.to_string())?;
    let mut command = if state == State::ShakenOneCore {
        let mut command = Command::new("taskset");
        command.args(["-c", "0"]).arg(program);
        command
    } else {
        Command::new(program)
    };
    command.args([MEASURE.as_ref(), specimen.as_os_str()]);
    command.args([state.to_string(), threads.to_string()]);
    let output = command.output().map_err(|e| format!("{:?}: {e}", command.get_program()))?;
    if !output.status.success() {
        return Err(String::from_utf8_lossy(&output.stderr).into_owned());
    }
    serde_json::from_slice(&output.stdout).map_err(|e| e.to_string())
}

/// Does it: arguments are a file with a specimen, the state and the number of threads.
pub fn measure(args: &[String]) {
    let [file, state, threads] = args else { panic!("three arguments are needed") };
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
        let measured = carry(&setup, &specimen, state);
        over.store(true, Ordering::Relaxed);
        measured
    });
    println!("{}", serde_json::to_string(&measured).expect("numbers"));
}

fn carry(setup: &Setup, specimen: &Specimen, state: State) -> Measured {
    let grains = specimen.present().count();
    let before = resident();
    let mut laboratory = Laboratory::new(setup, specimen);
    let motion = state.motion();
    for _ in 0..BEFORE {
        laboratory.step(motion.as_ref());
    }
    let held = resident().zip(before).map(|(now, before)| now - before);
    let phases = |world: &dyn World| world.phases().expect("an engine that tells phases");
    let steps = (0..state.steps())
        .map(|_| {
            let before = phases(&*laboratory.world);
            laboratory.step(motion.as_ref());
            Step::between(&before, &phases(&*laboratory.world))
        })
        .collect();
    let mut contacts = Vec::new();
    laboratory.world.remember(&mut contacts);
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
        let wall = |piece: &Piece, motion| Body {
            shape: piece.shape.clone(),
            motion,
            material: Material::Wall,
            state: BodyState::at_rest(piece.pose),
        };
        let mut walls = Vec::new();
        for (n, piece) in setup.cylinder.pieces.iter().enumerate() {
            let id = world.add(&wall(piece, Motion::Kinematic)).expect("a wall");
            ids.insert(Party::Other(Other::Cylinder(n)), id);
            walls.push((id, piece.pose));
        }
        if let Some(funnel) = specimen.state.funnel {
            let funnel = Funnel::new(&setup.funnel, funnel.opening_height, 0.0).expect("a funnel");
            for (n, piece) in funnel.pieces.iter().enumerate() {
                let id = world.add(&wall(piece, Motion::Static)).expect("a piece of the funnel");
                ids.insert(Party::Other(Other::Funnel(n)), id);
            }
        }
        let grains = specimen.grains.grains.iter().zip(&specimen.state.bodies).enumerate();
        for (n, (grain, state)) in grains.filter(|(_, (_, s))| s.fate == Fate::Present) {
            let body = Body {
                // Of its own, as in a specimen that was poured.
                shape: Arc::new((*grain.shape).clone()),
                motion: Motion::Free { mass: grain.mass, inertia: grain.inertia },
                material: Material::Grain,
                state: state.body,
            };
            ids.insert(Party::Grain(n), world.add(&body).expect("a grain"));
        }
        let remembered = specimen.state.contacts.iter().filter_map(|c| {
            Some(RememberedContact {
                a: *ids.get(&c.between[0])?,
                b: *ids.get(&c.between[1])?,
                point: c.point_m,
                normal: c.normal,
                force: c.force_n,
                warm_start: c.warm_start,
                feature: c.feature,
            })
        });
        world.recall(&remembered.collect::<Vec<_>>()).expect("contacts");
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
