//! Many small pours by every engine and by the referee.

use std::{
    collections::{HashMap, HashSet},
    path::Path,
    time::Instant,
};

use pluvia::{
    scale::{self, Scale},
    scenario::{Backend, ContactSolver, EngineSettings},
    units::from_mm,
    world::{Body, BodyState},
};
use serde::{Deserialize, Serialize};

use super::{
    cells::{Cell, judge},
    crew,
    kept::{self, Kept, fingerprint, identity},
    packing::{self, Recipe},
    program::{self, Program, number},
};

/// Grains of a pour, and the inner width of their box in m.
const GRAINS: usize = 30;
const WIDTH: f64 = 0.035;
/// Simulated time in s.
const DURATION: f64 = 1.5;
/// The referee's step in s, and the residual to which it solves each.
const STEP: f64 = 5e-4;
const TOLERANCE: f64 = 1e-4;

/// Coefficients of restitution and friction of the pours.
pub const RESTITUTIONS: [f64; 2] = [0.0, 0.315];
pub const FRICTIONS: [f64; 3] = [0.0, 0.4, 0.793];

/// Who pours.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Engine {
    Referee,
    Native,
    Rapier,
    Stock,
}

impl Engine {
    pub const ALL: [Self; 4] = [Self::Referee, Self::Native, Self::Rapier, Self::Stock];

    pub fn name(self) -> &'static str {
        match self {
            Self::Referee => "referee",
            Self::Native => "native",
            Self::Rapier => "rapier",
            Self::Stock => "stock",
        }
    }

    /// Defaults of the program, as everywhere; `None` for the referee.
    pub fn settings(self) -> Option<EngineSettings> {
        let defaults = EngineSettings::default();
        match self {
            Self::Referee => None,
            Self::Native => Some(defaults),
            Self::Rapier => Some(EngineSettings { backend: Backend::Rapier, ..defaults }),
            Self::Stock => {
                Some(EngineSettings { contact_solver: ContactSolver::Stock, ..defaults })
            }
        }
    }
}

/// One pour, as it is kept in `pours.jsonl`.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Poured {
    pub engine: Engine,
    pub friction: f64,
    pub restitution: f64,
    pub seed: u64,
    /// Fingerprint of what computed it.
    by: String,
    /// Mean height of the grains' centres of mass.
    pub height_m: f64,
    pub coordination: f64,
    pub sliding: Option<f64>,
    pub deepest_overlap_m: f64,
    pub outside: u64,
    pub wall_s: f64,
    /// Of the referee: share of the steps above the tolerance, and the worst residual.
    pub unsolved: Option<f64>,
    pub worst_residual: Option<f64>,
    /// Of the referee: largest energy that a step gained, over what the fall set free.
    pub energy_gain: Option<f64>,
}

/// One engine, friction coefficient, coefficient of restitution, and seed.
type Key = (Engine, u64, u64, u64);

impl Poured {
    fn key(&self) -> Key {
        (self.engine, self.friction.to_bits(), self.restitution.to_bits(), self.seed)
    }
}

/// Pours that were kept, and the programs that compute more of them.
struct Store {
    file: Kept,
    known: HashMap<Key, Poured>,
    engines: String,
    referee: String,
}

impl Store {
    fn open(path: &Path) -> Result<Self, String> {
        let engines = kept::own_identity()?;
        let referee = identity_of_referee()?;
        let (file, parts) = Kept::open(path, |p: &Poured| {
            p.by == if p.engine == Engine::Referee { &*referee } else { &*engines }
        })?;
        let known = parts.into_iter().map(|p| (p.key(), p)).collect();
        Ok(Self { file, known, engines, referee })
    }

    fn by(&self, engine: Engine) -> String {
        if engine == Engine::Referee { &self.referee } else { &self.engines }.clone()
    }

    fn of(&self, engine: Engine, recipe: &Recipe, count: u64) -> Vec<&Poured> {
        let (friction, restitution) = (recipe.friction.to_bits(), recipe.restitution.to_bits());
        (0..count)
            .filter_map(|seed| self.known.get(&(engine, friction, restitution, seed)))
            .collect()
    }

    fn keep(&mut self, poured: Poured) -> Result<(), String> {
        self.file.keep(&poured)?;
        self.known.insert(poured.key(), poured);
        Ok(())
    }
}

/// The referee's program and what it is asked: its pours stay when only Pluvia
/// changes, unless grains then begin elsewhere.
fn identity_of_referee() -> Result<String, String> {
    let recipe = recipe(0.0, 0.0);
    let grains = packing::start(&recipe, 0)?;
    let states: Vec<_> = grains.iter().map(|g| g.state).collect();
    let question = packing::as_json(&recipe, &grains, &states).to_string();
    let file = identity(&program::referee())?;
    let arguments = arguments().join(" ");
    Ok(fingerprint(&[file.as_bytes(), question.as_bytes(), arguments.as_bytes()]))
}

fn arguments() -> [String; 4] {
    let [step, duration, tolerance] = [STEP, DURATION, TOLERANCE].map(|x| x.to_string());
    ["pour".to_owned(), step, duration, tolerance]
}

/// What is poured, with the native solver's rule of impacts at its defaults.
fn recipe(restitution: f64, friction: f64) -> Recipe {
    let native = EngineSettings::default();
    let threshold = native.restitution_velocity_threshold_m_per_s;
    let substep_rate = native.rate_hz * f64::from(native.native.substeps(native.rate_hz));
    let scale = Scale::of_smallest(from_mm(native.grain_size_mm), Scale::PAPER.gravity);
    Recipe {
        grains: GRAINS,
        width: WIDTH,
        friction,
        restitution,
        restitution_threshold: threshold,
        closed_gap: scale::CLOSED_GAP.at(&scale),
        // Half of what a body at the threshold goes in a sub-step (`cpp/contact_kernels.h`):
        // the same length here, although the referee's step is shorter.
        met_gap: threshold / substep_rate / 2.0,
    }
}

/// Pours `count` realisations of each kind with the referee and with each engine,
/// `jobs` at a time; those kept in `folder` are taken from there.
/// Calls `progress` with all that is known so far after each kind.
pub fn compare(
    folder: &Path,
    count: u64,
    jobs: usize,
    kinds: &[(f64, f64)],
    mut progress: impl FnMut(&[Cell]) -> Result<(), String>,
) -> Result<Vec<Cell>, String> {
    let mut store = Store::open(&folder.join("pours.jsonl"))?;
    let mut cells = Vec::new();
    for &(restitution, friction) in kinds {
        let recipe = recipe(restitution, friction);
        for engine in Engine::ALL {
            pour_missing(&mut store, engine, &recipe, count, jobs)?;
        }
        let referee = store.of(Engine::Referee, &recipe, count);
        cells.extend(
            Engine::ALL
                .map(|engine| judge(&recipe, engine, &store.of(engine, &recipe, count), &referee)),
        );
        progress(&cells)?;
    }
    Ok(cells)
}

fn pour_missing(
    store: &mut Store,
    engine: Engine,
    recipe: &Recipe,
    count: u64,
    jobs: usize,
) -> Result<(), String> {
    let known: HashSet<u64> = store.of(engine, recipe, count).iter().map(|p| p.seed).collect();
    let missing: Vec<u64> = (0..count).filter(|seed| !known.contains(seed)).collect();
    let (e, mu) = (recipe.restitution, recipe.friction);
    if !missing.is_empty() {
        eprintln!("e {e}, mu {mu}: {} {} pours ...", missing.len(), engine.name());
    }
    let by = store.by(engine);
    let start = || match engine {
        Engine::Referee => Program::referee(&arguments().each_ref().map(String::as_str)),
        _ => Program::referee(&["measure"]),
    };
    let work = |program: &mut Program, seed: &u64| {
        let begun = Instant::now();
        let grains = packing::start(recipe, *seed)?;
        let (states, sliding) = poured_by(engine, recipe, &grains)?;
        let answer = program.ask(&packing::as_json(recipe, &grains, &states))?;
        let number = |field: &str| number(&answer, field);
        Ok(Poured {
            engine,
            friction: mu,
            restitution: e,
            seed: *seed,
            by: by.clone(),
            height_m: number("mean_height_m")?,
            coordination: number("coordination")?,
            // Without friction every contact slides as it likes.
            sliding: sliding.or(answer["sliding"].as_f64()).filter(|_| mu > 0.0),
            deepest_overlap_m: number("deepest_overlap_m")?,
            outside: number("outside")? as u64,
            wall_s: begun.elapsed().as_secs_f64(),
            unsolved: answer["unsolved"].as_f64(),
            worst_residual: answer["worst_residual"].as_f64(),
            energy_gain: answer["energy_gain"].as_f64(),
        })
    };
    crew::each(jobs, &missing, start, work, |_, poured| store.keep(poured))
}

/// How an engine's pour ended; for the referee, who pours when it is asked, how it begins.
fn poured_by(
    engine: Engine,
    recipe: &Recipe,
    grains: &[Body],
) -> Result<(Vec<BodyState>, Option<f64>), String> {
    let Some(settings) = engine.settings() else {
        return Ok((grains.iter().map(|g| g.state).collect(), None));
    };
    let ended = packing::pour(recipe, grains, &settings, DURATION)?;
    Ok((ended.states, ended.sliding))
}
