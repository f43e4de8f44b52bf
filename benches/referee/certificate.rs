//! Whether finished specimens can stand with the friction they have.

use std::{path::Path, sync::atomic::AtomicBool, time::Instant};

use pluvia::{
    export::{MadeBy, Scene},
    grains::load_scenario,
    protocol::{Setup, run},
    record::write_json,
    scenario::{Scenario, StageSpec},
    world,
};
use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::{
    fields::stands,
    kept::{self, Kept, identity},
    pours::Engine,
    program::{self, Program, number},
    steps::specimen,
    tree::root,
};

/// Largest gap in m of a contact point that may bear something.
const GAP: f64 = 5e-5;
/// Distance in m by which an axis between two bodies may fall short of the one of
/// least overlap and bear all the same; the overlap itself where that is larger.
const DOUBT: f64 = 1e-5;
/// Simulated time in s of rest before a specimen is taken.
const REST: f64 = 1.0;

/// Scenarios whose specimens are asked of.
pub const SCENARIOS: [(&str, &str); 2] =
    [("quick", "scenarios/quick/pluviation.json"), ("paper", "scenarios/paper/pluviation.json")];

/// A specimen and the least friction with which it can stand.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Certificate {
    pub specimen: String,
    pub engine: Engine,
    /// Fingerprint of what computed it.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    by: String,
    pub grains: u64,
    /// Contact points with gaps up to `gap_mm`, on every axis that may bear.
    pub contacts: u64,
    pub gap_mm: f64,
    /// Largest friction coefficient in it, that between grains, and the least with which forces in
    /// the cones carry the weights of the grains that do not fall, all pairs' coefficients being
    /// multiplied alike; `null` where none is.
    pub friction: f64,
    pub least_friction: Option<f64>,
    /// The same where 1 % of the grains may be left with more than 1 % of their weight.
    pub least_friction_of_99_percent: Option<f64>,
    /// Grains that no friction holds: they still move, or stand on what is out of reach.
    pub fall: u64,
    /// Other grains that are left with more than 1 % of their weight with the friction
    /// that the specimen has.
    pub unbalanced: u64,
    /// Largest share of its weight that one of them is left with, and share of all
    /// weights together (Euclidean norm).
    pub worst_left_percent: Option<f64>,
    pub left_percent: Option<f64>,
    /// No grain falls, and the others need no more friction than they have.
    pub stands: bool,
    /// Wall time of pouring and of the certificate.
    pub wall_s: f64,
}

/// Pours a specimen of a scenario with each engine and asks of it.
pub fn certify(
    folder: &Path,
    name: &str,
    scenario: &str,
    engines: &[Engine],
) -> Result<Vec<Certificate>, String> {
    let path = root().join(scenario);
    let scenario = load_scenario(&path, &[]).map_err(|e| format!("{e:?}"))?.scenario;
    let us = kept::own_identity()?;
    let judges = [identity(&program::referee())?, identity(&program::certificate())?];
    let by = kept::computed_by(&[&us, &judges[0], &judges[1]], &scenario)?;
    let (mut file, known) = Kept::open(&folder.join("static.jsonl"), |c: &Certificate| c.by == by)?;
    let mut certificates = Vec::new();
    for &engine in engines {
        let kept = known.iter().rfind(|c| c.specimen == name && c.engine == engine);
        let mut certificate = match kept {
            Some(kept) => kept.clone(),
            None => {
                eprintln!("{name} specimen, {} ...", engine.name());
                let begun = Instant::now();
                let scene = poured(&scenario, &path, engine)?;
                let [gap, doubt] = [GAP, DOUBT].map(|x| x.to_string());
                let contacts = Program::referee(&["contacts", &gap, &doubt])?.ask(&scene)?;
                let question = folder.join(format!("static-{name}-{}.json", engine.name()));
                write_json(&question, &contacts).map_err(|e| e.to_string())?;
                let answer = Program::certificate()?.ask(&contacts)?;
                let mut made = judged(name, engine, &answer)?;
                made.by.clone_from(&by);
                made.wall_s = begun.elapsed().as_secs_f64();
                file.keep(&made)?;
                made
            }
        };
        certificate.by.clear();
        certificates.push(certificate);
    }
    Ok(certificates)
}

/// A poured specimen at rest, in the exchange format (docs/exchange.md).
fn poured(scenario: &Scenario, path: &Path, engine: Engine) -> Result<Value, String> {
    let mut specimen = specimen(scenario, path)?;
    let mut setup = Setup::new(scenario).map_err(|e| e.to_string())?;
    setup.engine = engine.settings().ok_or("the referee pours no specimens")?;
    for stage in [
        StageSpec::FillFunnel { time_limit_s: 4.0 },
        StageSpec::Pour { falling_height_mm: 50.0, time_limit_s: 5.0 },
        StageSpec::Rest { duration_s: REST },
    ] {
        let stop = AtomicBool::new(false);
        specimen = run(&setup, &world::create, specimen, &stage, None, &mut (), &stop)
            .map_err(|e| e.to_string())?
            .specimen;
    }
    let made_by = MadeBy {
        program: concat!("pluvia ", env!("CARGO_PKG_VERSION")).to_owned(),
        scenario: scenario.name.clone(),
        stage: "rest".to_owned(),
        time_s: specimen.state.time,
    };
    let scene = Scene::of(&setup, &specimen, None, made_by).map_err(|e| e.to_string())?;
    serde_json::to_value(&scene).map_err(|e| e.to_string())
}

/// What `certificate.py` answers.
fn judged(name: &str, engine: Engine, answer: &Value) -> Result<Certificate, String> {
    let whole = |field: &str| number(answer, field).map(|n| n as u64);
    let fall = whole("fall")?;
    let percent = |field: &str| answer[field].as_f64().map(|share| 100.0 * share);
    Ok(Certificate {
        specimen: name.to_owned(),
        engine,
        by: String::new(),
        grains: whole("grains")?,
        contacts: whole("contacts")?,
        gap_mm: 1e3 * GAP,
        friction: number(answer, "friction")?,
        least_friction: answer["least_friction"].as_f64(),
        least_friction_of_99_percent: answer["least_friction_of_most"].as_f64(),
        fall,
        unbalanced: whole("unbalanced")?,
        worst_left_percent: percent("worst_left"),
        left_percent: percent("left"),
        stands: stands(fall, answer["least_factor"].as_f64()),
        wall_s: 0.0,
    })
}
