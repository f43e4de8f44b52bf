//! Whether finished specimens can stand with the friction they have.

use std::{
    path::PathBuf,
    sync::{Arc, atomic::AtomicBool},
};

use pluvia::{
    export::{MadeBy, Scene},
    grains::generate,
    protocol::{Moment, Observer, Setup, run},
    scenario::{GrainsSpec, StageSpec, load},
    specimen::{Specimen, SpecimenState},
    world,
};
use serde::Serialize;

use super::{
    pours::Engine,
    program::{Program, number},
};

/// Largest gap in m of a contact point that may bear something.
const GAP: f64 = 5e-5;
/// Simulated time in s of rest before a specimen is taken.
const REST: f64 = 1.0;

/// A specimen and the least friction with which it can stand.
#[derive(Debug, Clone, Serialize)]
pub struct Certificate {
    pub specimen: String,
    pub engine: &'static str,
    pub grains: u64,
    /// Contact points with gaps up to `gap_mm`.
    pub contacts: u64,
    pub gap_mm: f64,
    /// Friction coefficient between its grains, and the least with which forces in
    /// the cones carry the weights; `null` where none is.
    pub friction: f64,
    pub least_friction: Option<f64>,
    /// Grains that no friction holds: they fall, or stand on what is out of reach.
    pub fall: u64,
    /// It needs no more friction than it has.
    pub stands: bool,
}

struct Nobody;

impl Observer for Nobody {
    fn observe(&mut self, _: &Specimen, _: Moment) {}
}

/// Pours a specimen of a scenario with each engine and asks of it.
pub fn certify(name: &str, scenario: &str, engines: &[Engine]) -> Result<Vec<Certificate>, String> {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(scenario);
    let scenario = load(&path, &[]).map_err(|e| format!("{e:?}"))?.scenario;
    let GrainsSpec::Sieved(spec) = &scenario.grains else {
        return Err(format!("{}: grains of a sieve table are needed", path.display()));
    };
    let grains = Arc::new(generate(spec, scenario.seed).map_err(|e| e.to_string())?);
    let mut finder = Program::start(&["contacts", &GAP.to_string()])?;
    let mut judge = Program::certificate()?;
    let mut certificates = Vec::new();
    for &engine in engines {
        let Some(settings) = engine.settings() else { continue };
        eprintln!("{name}, {} ...", engine.name());
        let mut setup = Setup::new(&scenario).map_err(|e| e.to_string())?;
        setup.engine = settings;
        let state = SpecimenState::before_everything(grains.grains.len());
        let mut specimen = Specimen { grains: grains.clone(), state };
        for stage in [
            StageSpec::FillFunnel { time_limit_s: 4.0 },
            StageSpec::Pour { falling_height_mm: 50.0, time_limit_s: 5.0 },
            StageSpec::Rest { duration_s: REST },
        ] {
            let go_on = AtomicBool::new(false);
            specimen = run(&setup, &world::create, specimen, &stage, None, &mut Nobody, &go_on)
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
        let friction = scene
            .pairs
            .iter()
            .find(|p| p.between == [world::Material::Grain; 2])
            .map_or(f64::NAN, |p| p.friction);
        let contacts = finder.ask(&serde_json::to_value(&scene).map_err(|e| e.to_string())?)?;
        let answer = judge.ask(&contacts)?;
        let factor = answer["least_factor"].as_f64();
        let certificate = Certificate {
            specimen: name.to_owned(),
            engine: engine.name(),
            grains: number(&answer, "grains")? as u64,
            contacts: number(&answer, "contacts")? as u64,
            gap_mm: 1e3 * GAP,
            friction,
            least_friction: factor.map(|f| f * friction),
            fall: number(&answer, "fall")? as u64,
            stands: factor.is_some_and(|f| f <= 1.0),
        };
        eprintln!("    {}", super::table::certificate(&certificate));
        certificates.push(certificate);
    }
    Ok(certificates)
}
