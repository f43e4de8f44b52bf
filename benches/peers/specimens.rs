//! The specimens: the paper's grains in the funnel, and poured and settled.

use clap::ValueEnum;
use pluvia::{
    export::{MadeBy, Scene},
    motion::TableMotion,
    protocol::Setup,
    scenario::{Scenario, StageSpec},
    specimen::Specimen,
};

use super::common::{self, filled, lifted, settled, stage};

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
/// Friction of every pair in the pour: with 0.793 on walls nearly all grains stay in the funnel.
const POURED_FRICTION: f64 = 0.5;
const RESTITUTION: f64 = 0.315;

/// Simulated time in s in which a specimen comes to rest with these.
const SETTLING: f64 = 0.5;

/// A scene of each kind.
pub struct Scenes {
    pub rest: Scene,
    pub shaken: Scene,
    pub pour: Scene,
}

/// The benchmarks' specimen.
fn scenario(size: Size) -> Scenario {
    common::scenario(match size {
        Size::Quarter => common::QUARTER,
        Size::Whole => common::WHOLE,
    })
}

/// The same with one friction and restitution for every pair.
fn uniform(mut scenario: Scenario, friction: f64) -> Scenario {
    scenario.contact = serde_json::from_value(serde_json::json!({
        "grain_grain_friction": friction, "grain_wall_friction": friction,
        "grain_plate_friction": friction, "plate_wall_friction": friction,
        "restitution": RESTITUTION
    }))
    .expect("coefficients");
    scenario
}

/// Makes the scenes with Pluvia's default engine. All engines begin with the
/// same poses and velocities, and none with any memory of contacts.
pub fn make(size: Size) -> Result<Scenes, String> {
    let poured_by = scenario(size);
    let pouring = Setup::new(&poured_by).map_err(|e| e.to_string())?;
    let laboratory =
        |friction| Setup::new(&uniform(poured_by.clone(), friction)).map_err(|e| e.to_string());
    let (setup, funnel) = (laboratory(FRICTION)?, laboratory(POURED_FRICTION)?);
    let scene = |setup: &Setup, specimen: &Specimen, stage: &str, motion: Option<TableMotion>| {
        let made_by = MadeBy {
            program: concat!("pluvia ", env!("CARGO_PKG_VERSION")).to_owned(),
            scenario: poured_by.name.clone(),
            stage: stage.to_owned(),
            time_s: specimen.state.time,
        };
        let mut scene =
            Scene::of(setup, specimen, motion.as_ref(), made_by).map_err(|e| e.to_string())?;
        scene.contacts.clear();
        Ok::<_, String>(scene)
    };
    let filled = filled(&poured_by, &pouring);
    let pour = scene(&funnel, &lifted(&funnel, filled.clone()), "fill_funnel", None)?;
    let settled = settled(&pouring, filled);
    let settled = stage(&setup, settled, &StageSpec::Rest { duration_s: SETTLING }).specimen;
    // It goes on shaking for as long as an engine is let run.
    let motion = TableMotion::sine(0.025, 3.0, 600.0);
    Ok(Scenes {
        rest: scene(&setup, &settled, "rest", None)?,
        shaken: scene(&setup, &settled, "rest", Some(motion))?,
        pour,
    })
}
