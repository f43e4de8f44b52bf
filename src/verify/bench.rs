//! What an experiment runs on: an engine's settings, how its worlds are made,
//! and how the whole laboratory stands in them; the settings on which every case is run.

use super::{VerifyError, scene::Scene, view::View};
use crate::geometry::Vector;
use crate::scenario::{Backend, ContactSolver, EngineSettings, FrictionModel};
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

    /// The same at another rate in steps per second.
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

    /// The same with everything larger by a factor.
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
    /// Name, as case files use it: the engine, the rate in Hz where it is not
    /// the default, and what else differs; single precision is named, double is not.
    pub name: String,
    /// What the name stands for.
    pub engine: EngineSettings,
}

/// The settings of this build: stock Bullet contacts and the native contact solver in the
/// precision that is linked, and rapier where it is built in, each at 240, 480 and 1000 Hz; stock
/// Bullet also at twice the default rate, rapier also with friction at every contact point
/// (`FrictionModel::Coulomb`).
pub fn settings() -> Vec<Setting> {
    let engine = |contact_solver, rate_hz| EngineSettings {
        contact_solver,
        rate_hz,
        ..EngineSettings::default()
    };
    let usual = EngineSettings::default().rate_hz;
    // The default rate is not named.
    let at = |name: &str, rate_hz: f64| {
        if rate_hz == usual { name.to_owned() } else { format!("{name}-{rate_hz}") }
    };
    let precision = match world::info(Backend::Bullet).precision.as_str() {
        "single" => "-single",
        _ => "",
    };
    let mut settings = Vec::new();
    for rate_hz in [usual, 240.0, 960.0, 1000.0] {
        let name = format!("{}{precision}", at("stock", rate_hz));
        settings.push((name, engine(ContactSolver::Stock, rate_hz)));
    }
    for rate_hz in [240.0, 480.0, 1000.0] {
        let name = format!("native-{rate_hz}{precision}");
        settings.push((name, engine(ContactSolver::Native, rate_hz)));
    }
    if world::built_in().contains(&Backend::Rapier) {
        let rapier = |rate_hz| EngineSettings {
            backend: Backend::Rapier,
            ..engine(ContactSolver::Stock, rate_hz)
        };
        for rate_hz in [usual, 240.0, 1000.0] {
            settings.push((at("rapier", rate_hz), rapier(rate_hz)));
        }
        let mut coulomb = rapier(usual);
        coulomb.rapier.friction_model = FrictionModel::Coulomb;
        settings.push(("rapier-coulomb".to_owned(), coulomb));
    }
    settings.into_iter().map(|(name, engine)| Setting { name, engine }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_engine_is_tried_at_three_rates_under_names_of_its_own() {
        let settings = settings();
        for (n, setting) in settings.iter().enumerate() {
            let again = settings[n + 1..].iter().any(|s| s.name == setting.name);
            assert!(!again, "{} is there twice", setting.name);
        }
        let mut engines =
            vec![(Backend::Bullet, ContactSolver::Stock), (Backend::Bullet, ContactSolver::Native)];
        if world::built_in().contains(&Backend::Rapier) {
            engines.push((Backend::Rapier, ContactSolver::Stock));
        }
        for (backend, contact_solver) in engines {
            for rate_hz in [240.0, 480.0, 1000.0] {
                let expected = EngineSettings {
                    backend,
                    contact_solver,
                    rate_hz,
                    ..EngineSettings::default()
                };
                assert!(
                    settings.iter().any(|s| s.engine == expected),
                    "no setting is {backend:?}, {contact_solver:?} at {rate_hz} Hz"
                );
            }
        }
    }
}
