//! What an experiment runs on: an engine's settings, how its worlds are made,
//! and how the whole laboratory stands in them; the settings on which every case is run.

use super::{VerifyError, scene::Scene, view::View};
use crate::geometry::Vector;
use crate::scenario::{Backend, ContactSolver, EngineSettings};
use crate::world::{self, PairTable, WorldMaker};

/// Gravitational acceleration of the experiments in m/s², as in the scenarios.
pub const GRAVITY: f64 = 9.81;

/// An engine to experiment on.
#[derive(Clone)]
pub struct Bench<'a> {
    /// The engine's settings.
    pub engine: EngineSettings,
    /// How the laboratory stands in the world: every position, velocity and
    /// the gravity of an experiment pass through this view.
    pub view: View,
    /// How many times as large everything is in the engine, times and masses as they belong
    /// to it; experiments do not see it.
    pub larger: f64,
    make: WorldMaker<'a>,
}

impl<'a> Bench<'a> {
    /// An upright laboratory at rest.
    pub fn new(engine: EngineSettings, make: WorldMaker<'a>) -> Self {
        Self { engine, view: View::default(), larger: 1.0, make }
    }

    /// The same at another rate in steps a second.
    pub fn at_rate(&self, rate_hz: f64) -> Self {
        let mut other = self.clone();
        other.engine.rate_hz = rate_hz / self.larger.sqrt();
        other
    }

    /// The same with the laboratory seen otherwise.
    pub fn seen(&self, view: View) -> Self {
        Self { view, ..self.clone() }
    }

    /// The same with another length scale inside the engine.
    pub fn at_length_scale(&self, length_scale: f64) -> Self {
        let mut other = self.clone();
        other.engine.length_scale = length_scale;
        other.engine.rapier.engine_unit_mm = 1e3 / length_scale;
        other
    }

    /// The same with everything so many times as large.
    pub fn enlarged(&self, larger: f64) -> Self {
        let mut other = self.clone();
        other.engine = self.engine.enlarged(larger);
        other.larger = self.larger * larger;
        other
    }

    /// Length of a step in s.
    pub fn time_step(&self) -> f64 {
        1.0 / (self.engine.rate_hz * self.larger.sqrt())
    }

    /// An empty scene under gravity along −z of the laboratory.
    ///
    /// # Errors
    /// [`VerifyError::World`].
    pub fn scene(&self, pairs: &PairTable) -> Result<Scene, VerifyError> {
        self.scene_under(Vector::new(0.0, 0.0, -GRAVITY), pairs)
    }

    /// An empty scene under a gravity (m/s²) given in the laboratory's axes.
    ///
    /// # Errors
    /// [`VerifyError::World`].
    pub fn scene_under(&self, gravity: Vector, pairs: &PairTable) -> Result<Scene, VerifyError> {
        let world = (self.make)(&self.engine, self.view.vector_out(gravity), pairs)?;
        Ok(Scene::new(world, self.view, self.larger))
    }
}

/// An engine with its settings, under a name.
#[derive(Debug, Clone, PartialEq)]
pub struct Setting {
    /// Name, as case files use it: the engine, and the rate where it is not
    /// the default; single precision is named, double is not.
    pub name: String,
    /// What the name stands for.
    pub engine: EngineSettings,
}

/// The settings of this build: stock Bullet contacts at the default rate and
/// at twice that, the native contact solver at three rates, and rapier where
/// it is built in.
pub fn settings() -> Vec<Setting> {
    let engine = |contact_solver, rate_hz| EngineSettings {
        contact_solver,
        rate_hz,
        ..EngineSettings::default()
    };
    let usual = EngineSettings::default().rate_hz;
    let precision = match world::info(Backend::Bullet).precision.as_str() {
        "single" => "-single",
        _ => "",
    };
    let mut settings = vec![
        (format!("stock{precision}"), engine(ContactSolver::Stock, usual)),
        (format!("stock-960{precision}"), engine(ContactSolver::Stock, 960.0)),
    ];
    for rate_hz in [240.0, 480.0, 1000.0] {
        let name = format!("native-{rate_hz}{precision}");
        settings.push((name, engine(ContactSolver::Native, rate_hz)));
    }
    if world::built_in().contains(&Backend::Rapier) {
        let stock = engine(ContactSolver::Stock, usual);
        settings.push(("rapier".to_owned(), EngineSettings { backend: Backend::Rapier, ..stock }));
    }
    settings.into_iter().map(|(name, engine)| Setting { name, engine }).collect()
}
