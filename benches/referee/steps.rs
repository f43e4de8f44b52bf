//! The contact problems that the native solver meets, and how near it comes to
//! their exact solutions.

use std::{
    collections::BTreeSet,
    path::Path,
    sync::{Arc, Mutex, atomic::AtomicBool},
};

use pluvia::{
    geometry::Vector,
    grains::load_scenario,
    grains::{generate, streams},
    protocol::{Setup, run},
    scenario::{EngineSettings, GrainsSpec, Scenario, StageSpec},
    specimen::{Specimen, SpecimenState},
    world::{PairTable, bullet::SubstepRecord},
};
use serde_json::{Value, json};

use super::{
    crew,
    kept::{self, Kept, identity, last_of_each},
    nearness::{Instant, Nearness, summary},
    program::{self, Program},
    tap::{Tap, Tapped, locked},
    tree::root,
};

/// Simulated time in s in which instants of a scene are drawn.
const POURING: f64 = 1.0;
const SHAKING: f64 = 2.0;
const RESTING: f64 = 0.5;

/// Scenarios whose specimens are looked at.
pub const SCENARIOS: [(&str, &str); 2] = [
    ("quick", "scenarios/quick/vibration.json"),
    ("paper", "scenarios/paper/vibration-continuous.json"),
];

/// How it is looked.
pub struct Looking<'a> {
    /// Folder for what is found at each instant.
    pub folder: &'a Path,
    /// Random instants of each scene.
    pub instants: usize,
    /// Tolerance of the native solver in place of its default.
    pub tolerance: Option<f64>,
    /// Also solve from nothing, to see whether velocities are unique.
    pub twice: bool,
    /// Keep the problems themselves, too.
    pub keep: bool,
    /// Problems that are solved at a time.
    pub jobs: usize,
}

/// A stage of the experiment, and the instants of it that are looked at.
struct Part {
    stage: StageSpec,
    scene: String,
    due: BTreeSet<u64>,
}

/// Looks at random instants of pouring, shaking and rest.
pub fn look(how: &Looking, name: &str, scenario: &str) -> Result<Vec<Nearness>, String> {
    let path = root().join(scenario);
    let scenario = load_scenario(&path, &[]).map_err(|e| format!("{e:?}"))?.scenario;
    let mut setup = Setup::new(&scenario).map_err(|e| e.to_string())?;
    let engine = how.tolerance.map_or("native".into(), |t| format!("native, tolerance {t}"));
    if let Some(tolerance) = how.tolerance {
        setup.engine.native.solver_tolerance = tolerance;
    }
    let mut parts = parts(how.instants, name, scenario.seed, setup.engine.rate_hz);

    let [us, referee] = [kept::own_identity()?, identity(&program::referee())?];
    let by = kept::computed_by(&[&us, &referee], &scenario)?;
    let (mut file, mut instants) = Kept::open(&how.folder.join("steps.jsonl"), |i: &Instant| {
        i.by == by && i.engine == engine && (i.other_solution_p99.is_some() || !how.twice)
    })?;
    let known: BTreeSet<(String, u64)> =
        instants.iter().map(|i| (i.scene.clone(), i.step)).collect();
    let scenes: Vec<(String, BTreeSet<u64>)> =
        parts.iter().map(|p| (p.scene.clone(), p.due.clone())).collect();
    for part in &mut parts {
        part.due.retain(|step| !known.contains(&(part.scene.clone(), *step)));
    }
    // What comes after the last instant that is missing need not be simulated.
    let end = parts.iter().rposition(|p| !p.due.is_empty()).map_or(0, |last| last + 1);
    parts.truncate(end);
    let mut specimen = specimen(&scenario, &path)?;
    for part in parts {
        let records;
        (specimen, records) = recorded(&setup, specimen, &part)?;
        let grains = specimen.grains.grains.len();
        let start = || Program::referee(if how.twice { &["steps", "twice"] } else { &["steps"] });
        let work = |program: &mut Program, (step, record): &(u64, SubstepRecord)| {
            let time = *step as f64 / setup.engine.rate_hz;
            let problem = as_json(&part.scene, time, &setup.engine, record);
            if how.keep {
                let name = format!("problem-{}-{engine}-{step}.json", part.scene);
                let path = how.folder.join(name.replace([' ', ','], "-"));
                std::fs::write(&path, problem.to_string())
                    .map_err(|e| format!("{}: {e}", path.display()))?;
            }
            let answer = program.ask(&problem)?;
            Instant::of(&answer, &part.scene, &engine, *step, &by, grains)
        };
        crew::each(how.jobs, &records, start, work, |_, instant| {
            eprintln!("    {}", super::table::instant(&instant));
            file.keep(&instant)?;
            instants.push(instant);
            Ok(())
        })?;
    }
    // Those of a run without `--twice` may stand before the same with it.
    let instants = last_of_each(instants, |i| (i.step, i.scene.clone()));
    Ok(scenes
        .iter()
        .filter_map(|(scene, due)| {
            let of = |i: &&Instant| i.scene == *scene && due.contains(&i.step);
            summary(scene, &engine, &instants.iter().filter(of).collect::<Vec<_>>())
        })
        .collect())
}

/// The stages, with random steps of those that are looked at.
fn parts(instants: usize, name: &str, seed: u64, rate_hz: f64) -> Vec<Part> {
    let shake = StageSpec::sine(3.0, 25.0, SHAKING, 0.0);
    let pour = StageSpec::Pour { falling_height_mm: 50.0, time_limit_s: 5.0 };
    [
        (StageSpec::FillFunnel { time_limit_s: 4.0 }, "funnel", 0.0),
        (pour, "pour", POURING),
        (StageSpec::top_plate(2.0), "plate", 0.0),
        (shake, "shaken", SHAKING),
        (StageSpec::Rest { duration_s: RESTING }, "rest", RESTING),
    ]
    .into_iter()
    .map(|(stage, scene, duration)| {
        let scene = format!("{name} {scene}");
        let steps = (duration * rate_hz).floor();
        let wanted = instants.min(steps as usize);
        let mut rng = streams::stream(seed, &scene);
        let mut due = BTreeSet::new();
        while due.len() < wanted {
            due.insert(1 + (steps * streams::uniform(&mut rng)) as u64);
        }
        Part { stage, scene, due }
    })
    .collect()
}

/// The grains of a scenario before everything.
pub fn specimen(scenario: &Scenario, path: &Path) -> Result<Specimen, String> {
    let GrainsSpec::Sieved(spec) = &scenario.grains else {
        return Err(format!("{}: grains of a sieve table are needed", path.display()));
    };
    let grains = Arc::new(generate(spec, scenario.seed).map_err(|e| e.to_string())?);
    let state = SpecimenState::before_everything(grains.grains.len());
    Ok(Specimen { grains, state })
}

/// Simulates a stage, and records the sub-steps that are due in it.
fn recorded(
    setup: &Setup,
    specimen: Specimen,
    part: &Part,
) -> Result<(Specimen, Vec<(u64, SubstepRecord)>), String> {
    let Part { stage, scene, due } = part;
    match due.len() {
        0 => eprintln!("{scene} ..."),
        count => eprintln!("{scene}: {count} instants ..."),
    }
    let tap = Arc::new(Mutex::new(Tap::default()));
    locked(&tap).due.clone_from(due);
    let make = |settings: &EngineSettings, gravity: Vector, pairs: &PairTable| {
        Tapped::make(settings, gravity, pairs, &tap)
    };
    let stop = AtomicBool::new(false);
    let specimen = run(setup, &make, specimen, stage, None, &mut (), &stop)
        .map_err(|e| e.to_string())?
        .specimen;
    let records = std::mem::take(&mut locked(&tap).records);
    if records.len() < due.len() {
        return Err(format!("{scene} ended before the last of its instants"));
    }
    Ok((specimen, records))
}

/// The problem as the referee reads it (`benches/referee/problem.h`). Bodies turn
/// in it by the root of their inertia times their spin: their inertia is 1.
fn as_json(scene: &str, time: f64, engine: &EngineSettings, record: &SubstepRecord) -> Value {
    let bodies: Vec<Vec<f64>> = record
        .bodies
        .chunks(SubstepRecord::BODY)
        .map(|b| [&b[..1], &[1.0, 1.0, 1.0, 0.0, 0.0, 0.0], &b[1..]].concat())
        .collect();
    let contacts: Vec<Vec<f64>> = record
        .contacts
        .chunks(SubstepRecord::CONTACT)
        // Approach velocity and restitution belong to the impacts, which follow
        // this problem.
        .map(|c| [&c[..32], &c[34..]].concat())
        .collect();
    let substeps = f64::from(engine.native.substeps(engine.rate_hz));
    json!({
        "scene": scene, "engine": "native", "time_s": time,
        "step_s": 1.0 / (engine.rate_hz * substeps), "bodies": bodies, "contacts": contacts,
    })
}
