//! The contact problems that the native solver meets, and how near it comes to
//! their exact solutions.

use std::{
    fs::File,
    io::Write,
    path::{Path, PathBuf},
    sync::{Arc, Mutex, atomic::AtomicBool},
};

use pluvia::{
    geometry::{Pose, Vector},
    grains::{generate, streams},
    protocol::{Moment, Observer, Setup, run},
    scenario::{EngineSettings, GrainsSpec, StageSpec, StrokeReading, load},
    specimen::{Specimen, SpecimenState},
    world::{
        Body, BodyId, Contact, EffectiveSettings, PairCoefficients, PairTable, RememberedContact,
        Snapshot, World, WorldError,
        bullet::{BulletBackend, SubstepRecord},
    },
};
use serde::Serialize;
use serde_json::{Value, json};

use super::program::{Program, number};

/// Simulated time in s in which instants of a scene are drawn.
const POURING: f64 = 1.0;
const SHAKING: f64 = 2.0;
const RESTING: f64 = 0.5;

/// How near the native solver comes in one scene.
#[derive(Debug, Clone, Serialize)]
pub struct Nearness {
    pub scene: String,
    pub grains: usize,
    /// Contact points, mean of the instants.
    pub contacts: f64,
    pub engine: String,
    pub instants: usize,
    /// Over all touched bodies of all instants; see docs/referee.md.
    pub velocity_error_median_percent: f64,
    pub velocity_error_p99_percent: f64,
    pub velocity_error_worst_percent: f64,
    /// The worst of the instants: residual of the reference, and of what was found.
    pub reference_residual: f64,
    pub engine_residual: f64,
    /// 99th percentile of the distance between the exact solutions found from the
    /// native one and from nothing, the worst of the instants: beyond rounding
    /// where there is more than one.
    pub other_solution_p99_percent: f64,
    /// How far the velocities are from those that the impulses give, the worst.
    pub inconsistency: f64,
}

/// What is recorded of the worlds of a stage.
#[derive(Default)]
struct Tap {
    due: Vec<u64>,
    step: u64,
    records: Vec<(u64, SubstepRecord)>,
}

/// A world that hands over its contact problem in the steps that are due.
struct Tapped {
    world: BulletBackend,
    tap: Arc<Mutex<Tap>>,
}

impl World for Tapped {
    fn add(&mut self, body: &Body) -> Result<BodyId, WorldError> {
        self.world.add(body)
    }
    fn remove(&mut self, id: BodyId) -> Result<(), WorldError> {
        self.world.remove(id)
    }
    fn drive(&mut self, id: BodyId, pose_at_end_of_step: &Pose) -> Result<(), WorldError> {
        self.world.drive(id, pose_at_end_of_step)
    }
    fn step(&mut self) -> Result<(), WorldError> {
        self.world.step()?;
        let mut tap = self.tap.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        tap.step += 1;
        if tap.due.contains(&tap.step) {
            let step = tap.step;
            tap.records.push((step, self.world.recorded_substep()));
        }
        Ok(())
    }
    fn time_step(&self) -> f64 {
        self.world.time_step()
    }
    fn read(&self, into: &mut Snapshot) {
        self.world.read(into);
    }
    fn contacts(&self, into: &mut Vec<Contact>) {
        self.world.contacts(into);
    }
    fn remember(&self, into: &mut Vec<RememberedContact>) {
        self.world.remember(into);
    }
    fn recall(&mut self, contacts: &[RememberedContact]) -> Result<(), WorldError> {
        self.world.recall(contacts)
    }
    fn corners(&self, into: &mut Vec<Option<Vec<Vector>>>) {
        self.world.corners(into);
    }
    fn pair_coefficients(&self, a: BodyId, b: BodyId) -> Result<PairCoefficients, WorldError> {
        self.world.pair_coefficients(a, b)
    }
    fn effective(&self) -> EffectiveSettings {
        self.world.effective()
    }
}

struct Nobody;

impl Observer for Nobody {
    fn observe(&mut self, _: &Specimen, _: Moment) {}
}

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
    /// Iterations a sub-step of the native solver in place of its default.
    pub iterations: Option<u32>,
    /// Keep the problems themselves, too.
    pub keep: bool,
}

/// Looks at random instants of pouring, shaking and rest.
pub fn look(how: &Looking, name: &str, scenario: &str) -> Result<Vec<Nearness>, String> {
    let Looking { folder, instants, iterations, keep } = *how;
    let engine = iterations.map_or("native".into(), |n| format!("native, {n} iterations"));
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(scenario);
    let scenario = load(&path, &[]).map_err(|e| format!("{e:?}"))?.scenario;
    let GrainsSpec::Sieved(spec) = &scenario.grains else {
        return Err(format!("{}: grains of a sieve table are needed", path.display()));
    };
    let mut setup = Setup::new(&scenario).map_err(|e| e.to_string())?;
    if let Some(iterations) = iterations {
        setup.engine.manifold.sweeps = iterations;
    }
    let grains = Arc::new(generate(spec, scenario.seed).map_err(|e| e.to_string())?);
    let mut specimen =
        Specimen { state: SpecimenState::before_everything(grains.grains.len()), grains };
    let shake = StageSpec::Vibrate {
        frequency_hz: 3.0,
        amplitude_mm: 25.0,
        stroke: StrokeReading::HalfStroke,
        duration_s: SHAKING,
        periods: 1,
        rest_s: 0.0,
        ramp_s: 0.0,
    };
    let pour = StageSpec::Pour { falling_height_mm: 50.0, time_limit_s: 5.0 };
    let stages = [
        (None, StageSpec::FillFunnel { time_limit_s: 4.0 }),
        (Some(("pour", POURING)), pour),
        (None, StageSpec::PlaceTopPlate { time_limit_s: 2.0 }),
        (Some(("shaken", SHAKING)), shake),
        (Some(("rest", RESTING)), StageSpec::Rest { duration_s: RESTING }),
    ];
    let mut program = Program::start(&["steps"])?;
    let file = |kind: &str| {
        let path = folder.join(format!("{kind}-{name}-{}.jsonl", iterations.unwrap_or(0)));
        File::create(&path).map_err(|e| format!("{}: {e}", path.display()))
    };
    let mut kept = file("steps")?;
    let mut problems = if keep { Some(file("problems")?) } else { None };
    let mut found = Vec::new();
    for (scene, stage) in stages {
        let tap = Arc::new(Mutex::new(Tap::default()));
        if let Some((scene, duration)) = scene {
            let scene = format!("{name} {scene}");
            let steps = duration * setup.engine.rate_hz;
            let mut rng = streams::stream(scenario.seed, &scene);
            let due = (0..instants).map(|_| 1 + (steps * streams::uniform(&mut rng)) as u64);
            tap.lock().unwrap_or_else(std::sync::PoisonError::into_inner).due = due.collect();
            eprintln!("{scene}: {instants} instants ...");
        }
        let make = |settings: &EngineSettings, gravity: Vector, pairs: &PairTable| {
            let mut world = BulletBackend::new(settings, gravity, pairs)?;
            if scene.is_some() {
                world.record_substeps();
            }
            Ok(Box::new(Tapped { world, tap: tap.clone() }) as Box<dyn World + Send>)
        };
        let go_on = AtomicBool::new(false);
        specimen = run(&setup, &make, specimen, &stage, None, &mut Nobody, &go_on)
            .map_err(|e| e.to_string())?
            .specimen;
        let Some((scene, _)) = scene else { continue };
        let records = std::mem::take(
            &mut tap.lock().unwrap_or_else(std::sync::PoisonError::into_inner).records,
        );
        let mut answers = Vec::new();
        for (step, record) in &records {
            let scene = format!("{name} {scene}");
            let time = *step as f64 / setup.engine.rate_hz;
            let problem = as_json(&scene, time, &setup.engine, record);
            if let Some(file) = &mut problems {
                writeln!(file, "{problem}").map_err(|e| e.to_string())?;
            }
            let answer = program.ask(&problem)?;
            let percent = |field: &str| Ok::<_, String>(100.0 * number(&answer, field)?);
            eprintln!(
                "    {:.3} s, {} contact points: median {:.3} %, p99 {:.2} %, residual {:.0e}",
                number(&answer, "time_s")?,
                number(&answer, "contacts")?,
                percent("velocity_error_median")?,
                percent("velocity_error_p99")?,
                number(&answer, "residual")?,
            );
            writeln!(kept, "{answer}").map_err(|e| e.to_string())?;
            answers.push(answer);
        }
        if !answers.is_empty() {
            let grains = specimen.grains.grains.len();
            found.push(nearness(format!("{name} {scene}"), &engine, grains, &answers)?);
        }
    }
    Ok(found)
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
        // Approach velocity and restitution belong to what follows this problem.
        .map(|c| [&c[..32], &c[34..]].concat())
        .collect();
    let substeps = f64::from(engine.manifold.substeps(engine.rate_hz));
    json!({
        "scene": scene, "engine": "native", "time_s": time,
        "step_s": 1.0 / (engine.rate_hz * substeps), "bodies": bodies, "contacts": contacts,
    })
}

fn nearness(
    scene: String,
    engine: &str,
    grains: usize,
    answers: &[Value],
) -> Result<Nearness, String> {
    let mut errors: Vec<f64> = answers
        .iter()
        .flat_map(|a| a["velocity_errors"].as_array().into_iter().flatten())
        .filter_map(Value::as_f64)
        .collect();
    errors.sort_by(f64::total_cmp);
    let percentile = |share: f64| {
        let rank = (share * errors.len() as f64).ceil().max(1.0) as usize;
        errors.get(rank - 1).map_or(f64::NAN, |e| 100.0 * e)
    };
    let worst = |field: &str| -> Result<f64, String> {
        answers.iter().try_fold(0.0_f64, |w, a| Ok(w.max(number(a, field)?)))
    };
    let contacts: f64 = answers.iter().filter_map(|a| a["contacts"].as_f64()).sum();
    Ok(Nearness {
        scene,
        grains,
        contacts: (contacts / answers.len() as f64).round(),
        engine: engine.to_owned(),
        instants: answers.len(),
        velocity_error_median_percent: percentile(0.5),
        velocity_error_p99_percent: percentile(0.99),
        velocity_error_worst_percent: percentile(1.0),
        reference_residual: worst("residual")?,
        engine_residual: worst("residual_given")?,
        other_solution_p99_percent: 100.0 * worst("afresh_p99")?,
        inconsistency: worst("inconsistency")?,
    })
}
