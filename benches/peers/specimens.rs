//! The specimens: the paper's grains in the funnel, and poured and settled.

use std::sync::{Arc, atomic::AtomicBool};

use clap::ValueEnum;
use pluvia::{
    apparatus::TableMotion,
    export::{MadeBy, Scene},
    grains::generate,
    protocol::{Moment, Observer, Setup, run},
    scenario::{GrainsSpec, Scenario, StageSpec},
    specimen::{FunnelState, Specimen, SpecimenState},
    world,
};

/// How many grains.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Size {
    /// A quarter of the paper's mass in a narrower cylinder as high
    Quarter,
    /// The paper's 2343 g
    Whole,
}

impl std::fmt::Display for Size {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(if *self == Self::Quarter { "quarter" } else { "whole" })
    }
}

/// Friction and restitution of every pair. One value for all, because engines
/// combine the values of two bodies by different rules, and all rules agree
/// where both are alike.
const FRICTION: f64 = 0.793;
const RESTITUTION: f64 = 0.315;

/// Falling height of the pour in m.
const FALL: f64 = 0.05;

/// A scene of each kind.
pub struct Scenes {
    pub rest: Scene,
    pub shaken: Scene,
    pub pour: Scene,
}

struct Nobody;

impl Observer for Nobody {
    fn observe(&mut self, _: &Specimen, _: Moment) {}
}

fn scenario(size: Size) -> Scenario {
    let (mass_g, diameter_mm) = match size {
        Size::Quarter => (585.75, 72.5),
        Size::Whole => (2343.0, 115.0),
    };
    serde_json::from_value(serde_json::json!({
        "name": "peers",
        "grains": {
            "total_mass_g": mass_g, "density_kg_per_m3": 2673.9,
            "sieve_table": [
                { "passing_mm": 16, "retained_mm": 12.5, "mass_percent": 15 },
                { "passing_mm": 12.5, "retained_mm": 10, "mass_percent": 51.95 },
                { "passing_mm": 10, "retained_mm": 8, "mass_percent": 33.05 }
            ]
        },
        "apparatus": {
            "cylinder": { "inner_diameter_mm": diameter_mm, "height_mm": 200 },
            "funnel": { "opening_diameter_mm": 70, "top_diameter_mm": 260 }
        },
        "contact": {
            "grain_grain_friction": FRICTION, "grain_wall_friction": FRICTION,
            "grain_plate_friction": FRICTION, "plate_wall_friction": FRICTION,
            "restitution": RESTITUTION
        },
        "stages": []
    }))
    .expect("a scenario")
}

/// Makes the scenes with Pluvia's default engine. All engines begin with the
/// same poses and velocities, and none with any memory of contacts.
pub fn make(size: Size) -> Result<Scenes, String> {
    let scenario = scenario(size);
    let setup = Setup::new(&scenario).map_err(|e| e.to_string())?;
    let GrainsSpec::Sieved(sieved) = &scenario.grains else { unreachable!("a sieve table") };
    let grains = Arc::new(generate(sieved, scenario.seed).map_err(|e| e.to_string())?);
    let state = SpecimenState::before_everything(grains.grains.len());
    let stage = |specimen: Specimen, spec: &StageSpec| {
        run(&setup, &world::create, specimen, spec, &mut Nobody, &AtomicBool::new(false))
            .map(|outcome| outcome.specimen)
            .map_err(|e| e.to_string())
    };
    let scene = |specimen: &Specimen, stage: &str, motion: Option<TableMotion>| {
        let made_by = MadeBy {
            program: concat!("pluvia ", env!("CARGO_PKG_VERSION")).to_owned(),
            scenario: scenario.name.clone(),
            stage: stage.to_owned(),
            time_s: specimen.state.time,
        };
        let mut scene = Scene::of(&setup, specimen, motion, made_by).map_err(|e| e.to_string())?;
        scene.contacts.clear();
        Ok::<_, String>(scene)
    };
    let filled = stage(Specimen { grains, state }, &StageSpec::FillFunnel { time_limit_s: 4.0 })?;
    let pour = scene(&lifted(&setup, filled.clone()), "fill_funnel", None)?;
    let poured = StageSpec::Pour { falling_height_mm: 1e3 * FALL, time_limit_s: 4.0 };
    let poured = stage(filled, &poured)?;
    let settled = stage(poured, &StageSpec::Rest { duration_s: 0.5 })?;
    // It goes on shaking for as long as an engine is let run.
    let motion =
        TableMotion { amplitude: 0.025, frequency: 3.0, duration: 600.0, periods: 1, rest: 0.0 };
    Ok(Scenes {
        rest: scene(&settled, "rest", None)?,
        shaken: scene(&settled, "rest", Some(motion))?,
        pour,
    })
}

/// The filled funnel in its place above the cylinder, its lid gone, as the
/// stage `pour` begins.
fn lifted(setup: &Setup, mut specimen: Specimen) -> Specimen {
    let opening_height = setup.cylinder.height + FALL;
    let state = &mut specimen.state;
    let was = state.funnel.map_or(opening_height, |f| f.opening_height);
    for grain in &mut state.bodies {
        grain.body.pose.translation.vector.z += opening_height - was;
    }
    state.funnel = Some(FunnelState { opening_height, lid: false });
    state.cylinder = true;
    specimen
}
