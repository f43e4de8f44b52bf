//! Many small pours by every engine and by the referee, and whether they are the
//! same in the mean.

use std::{
    collections::HashMap,
    fs::{File, OpenOptions},
    io::{BufRead, BufReader, Write},
    path::Path,
};

use pluvia::{
    measure::inference::t_quantile,
    scenario::{Backend, ContactPath, EngineSettings},
};
use serde::{Deserialize, Serialize};

use super::{
    heap::{self, Recipe},
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
/// Pours of our own solver for one of the referee's: they cost so much less, and
/// the scatter of a difference is that of both.
const OURS_FOR_ONE: u64 = 3;
/// Half width of what counts as equivalent, in %.
const MARGIN_PERCENT: f64 = 0.5;

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
            Self::Stock => Some(EngineSettings { contact_path: ContactPath::Bullet, ..defaults }),
        }
    }
}

/// One pour, as it is kept in `pours.jsonl`.
#[derive(Debug, Clone, Serialize, Deserialize)]
struct Poured {
    engine: Engine,
    friction: f64,
    restitution: f64,
    seed: u64,
    /// Program that computed it.
    by: String,
    height_m: f64,
    coordination: f64,
    sliding: Option<f64>,
    deepest_overlap_m: f64,
    outside: u64,
    /// Of the referee: share of the steps above the tolerance, and the worst.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    unsolved: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    worst_residual: Option<f64>,
}

/// One engine's pours of one kind, beside the referee's.
#[derive(Debug, Clone, Serialize)]
pub struct Cell {
    pub engine: Engine,
    pub friction: f64,
    pub restitution: f64,
    pub realisations: usize,
    pub height_mean_mm: f64,
    pub height_standard_error_mm: f64,
    /// Of the mean height to the referee's, in % of it, with its standard error
    /// and its 90 % interval; `null` for the referee.
    pub difference_percent: Option<f64>,
    pub difference_standard_error_percent: Option<f64>,
    pub difference_interval_percent: Option<[f64; 2]>,
    /// Two one-sided t-tests at 5 %: the interval lies within ±0.5 %.
    pub equivalent_within_0_5_percent: Option<bool>,
    /// Of the heights of the same seeds by this engine and the referee.
    pub correlation: Option<f64>,
    pub coordination_mean: f64,
    pub coordination_standard_error: f64,
    pub sliding_share: Option<f64>,
    pub deepest_overlap_mm: f64,
    pub outside: u64,
    /// Of the referee: mean share of steps above its tolerance.
    pub unsolved_share: Option<f64>,
}

/// Pours that were kept, by engine, friction, restitution and seed.
struct Store {
    file: File,
    known: HashMap<(Engine, u64, u64, u64), Poured>,
    identities: HashMap<Engine, String>,
}

impl Store {
    fn open(path: &Path) -> Result<Self, String> {
        let told = |e: std::io::Error| format!("{}: {e}", path.display());
        let us = program::identity(&std::env::current_exe().map_err(|e| e.to_string())?)?;
        let referee = program::identity(&program::file())?;
        let identities: HashMap<_, _> = Engine::ALL
            .into_iter()
            .map(|e| (e, if e == Engine::Referee { referee.clone() } else { us.clone() }))
            .collect();
        let mut known = HashMap::new();
        if path.exists() {
            for line in BufReader::new(File::open(path).map_err(told)?).lines() {
                // A line that a stopped run left unfinished is no pour.
                let line = line.map_err(told)?;
                let Ok(poured) = serde_json::from_str::<Poured>(&line) else { continue };
                if identities[&poured.engine] == poured.by {
                    known.insert(key(&poured), poured);
                }
            }
        }
        let file = OpenOptions::new().create(true).append(true).open(path).map_err(told)?;
        Ok(Self { file, known, identities })
    }

    fn keep(&mut self, poured: Poured) -> Result<(), String> {
        let line = serde_json::to_string(&poured).map_err(|e| e.to_string())?;
        writeln!(self.file, "{line}").map_err(|e| e.to_string())?;
        self.known.insert(key(&poured), poured);
        Ok(())
    }

    fn of(&self, engine: Engine, recipe: &Recipe, count: u64) -> Vec<&Poured> {
        (0..count)
            .filter_map(|seed| {
                let (friction, restitution) = (recipe.friction, recipe.restitution);
                self.known.get(&(engine, friction.to_bits(), restitution.to_bits(), seed))
            })
            .collect()
    }
}

fn key(p: &Poured) -> (Engine, u64, u64, u64) {
    (p.engine, p.friction.to_bits(), p.restitution.to_bits(), p.seed)
}

/// Pours `count` realisations of each kind with the referee and as many or more
/// with the engines; those in `folder` are taken from there.
pub fn compare(folder: &Path, count: u64, cells: &[(f64, f64)]) -> Result<Vec<Cell>, String> {
    let mut store = Store::open(&folder.join("pours.jsonl"))?;
    let mut judged = Vec::new();
    for &(restitution, friction) in cells {
        let recipe = Recipe {
            grains: GRAINS,
            width: WIDTH,
            friction,
            restitution,
            restitution_threshold: EngineSettings::default().restitution_velocity_threshold_m_per_s,
        };
        for engine in Engine::ALL {
            let wanted = if engine == Engine::Native { OURS_FOR_ONE * count } else { count };
            pour_missing(&mut store, engine, &recipe, wanted)?;
        }
        let referee = store.of(Engine::Referee, &recipe, count);
        for engine in Engine::ALL {
            let poured = store.of(engine, &recipe, OURS_FOR_ONE * count);
            let cell = judge(&recipe, engine, &poured, &referee);
            eprintln!("    {}", super::table::cell(&cell));
            judged.push(cell);
        }
    }
    Ok(judged)
}

fn pour_missing(
    store: &mut Store,
    engine: Engine,
    recipe: &Recipe,
    wanted: u64,
) -> Result<(), String> {
    let (e, mu) = (recipe.restitution, recipe.friction);
    let missing: Vec<u64> = (0..wanted)
        .filter(|seed| !store.known.contains_key(&(engine, mu.to_bits(), e.to_bits(), *seed)))
        .collect();
    if missing.is_empty() {
        return Ok(());
    }
    eprintln!("{} pours {} times, e {e}, mu {mu} ...", engine.name(), missing.len());
    let arguments = [STEP, DURATION, TOLERANCE].map(|x| x.to_string());
    let command: Vec<&str> = match engine {
        Engine::Referee => {
            ["pour"].into_iter().chain(arguments.iter().map(String::as_str)).collect()
        }
        _ => vec!["measure"],
    };
    let mut program = Program::start(&command)?;
    for seed in missing {
        let grains = heap::start(recipe, seed)?;
        let begun: Vec<_> = grains.iter().map(|g| g.state).collect();
        let (states, sliding) = match engine.settings() {
            None => (begun, None),
            Some(settings) => {
                let ended = heap::pour(recipe, &grains, &settings, DURATION)?;
                (ended.states, ended.sliding)
            }
        };
        let answer = program.ask(&heap::as_json(recipe, &grains, &states))?;
        store.keep(Poured {
            engine,
            friction: mu,
            restitution: e,
            seed,
            by: store.identities[&engine].clone(),
            height_m: number(&answer, "mean_height_m")?,
            coordination: number(&answer, "coordination")?,
            sliding: sliding.or(answer["sliding"].as_f64()),
            deepest_overlap_m: number(&answer, "deepest_overlap_m")?,
            outside: answer["outside"].as_u64().unwrap_or(0),
            unsolved: answer["unsolved"].as_f64(),
            worst_residual: answer["worst_residual"].as_f64(),
        })?;
    }
    Ok(())
}

/// Mean, and its variance.
fn mean_of(values: impl Iterator<Item = f64>) -> (f64, f64, f64) {
    let values: Vec<f64> = values.collect();
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let squares: f64 = values.iter().map(|v| (v - mean) * (v - mean)).sum();
    (mean, squares / (n - 1.0) / n, n)
}

fn judge(recipe: &Recipe, engine: Engine, poured: &[&Poured], referee: &[&Poured]) -> Cell {
    let (mean, variance, n) = mean_of(poured.iter().map(|p| p.height_m));
    let (truth, truth_variance, m) = mean_of(referee.iter().map(|p| p.height_m));
    let (coordination, coordination_variance, _) = mean_of(poured.iter().map(|p| p.coordination));
    let slid: Vec<f64> = poured.iter().filter_map(|p| p.sliding).collect();
    let mut cell = Cell {
        engine,
        friction: recipe.friction,
        restitution: recipe.restitution,
        realisations: poured.len(),
        height_mean_mm: 1e3 * mean,
        height_standard_error_mm: 1e3 * variance.sqrt(),
        difference_percent: None,
        difference_standard_error_percent: None,
        difference_interval_percent: None,
        equivalent_within_0_5_percent: None,
        correlation: None,
        coordination_mean: coordination,
        coordination_standard_error: coordination_variance.sqrt(),
        sliding_share: (!slid.is_empty()).then(|| slid.iter().sum::<f64>() / slid.len() as f64),
        deepest_overlap_mm: 1e3 * poured.iter().map(|p| p.deepest_overlap_m).fold(0.0, f64::max),
        outside: poured.iter().map(|p| p.outside).sum(),
        unsolved_share: (engine == Engine::Referee)
            .then(|| mean_of(poured.iter().filter_map(|p| p.unsolved)).0),
    };
    if engine != Engine::Referee && n > 1.0 && m > 1.0 {
        // Welch: the heights of one seed by two engines are as good as independent
        // (`correlation`), and the scatters differ.
        let both = variance + truth_variance;
        let freedom = both * both
            / (variance * variance / (n - 1.0) + truth_variance * truth_variance / (m - 1.0));
        let difference = 100.0 * (mean - truth) / truth;
        let error = 100.0 * both.sqrt() / truth;
        let half = t_quantile(0.95, freedom).unwrap_or(f64::INFINITY) * error;
        cell.difference_percent = Some(difference);
        cell.difference_standard_error_percent = Some(error);
        cell.difference_interval_percent = Some([difference - half, difference + half]);
        cell.equivalent_within_0_5_percent = Some(difference.abs() + half < MARGIN_PERCENT);
        cell.correlation = Some(correlation(poured, referee));
    }
    cell
}

fn correlation(poured: &[&Poured], referee: &[&Poured]) -> f64 {
    let by_seed: HashMap<u64, f64> = referee.iter().map(|p| (p.seed, p.height_m)).collect();
    let pairs: Vec<(f64, f64)> = poured
        .iter()
        .filter_map(|p| by_seed.get(&p.seed).map(|truth| (p.height_m, *truth)))
        .collect();
    let n = pairs.len() as f64;
    let (a, b) = pairs.iter().fold((0.0, 0.0), |s, p| (s.0 + p.0 / n, s.1 + p.1 / n));
    let sum =
        |f: &dyn Fn(f64, f64) -> f64| -> f64 { pairs.iter().map(|p| f(p.0 - a, p.1 - b)).sum() };
    sum(&|x, y| x * y) / (sum(&|x, _| x * x) * sum(&|_, y| y * y)).sqrt()
}
