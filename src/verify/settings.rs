//! The engines and settings on which every case is run.

use crate::scenario::{Backend, ContactSolver, EngineSettings};
use crate::world;

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
    let stock =
        EngineSettings { contact_solver: ContactSolver::Stock, ..EngineSettings::default() };
    let precision = match world::info(Backend::Bullet).precision.as_str() {
        "single" => "-single",
        _ => "",
    };
    let mut settings = vec![
        Setting { name: format!("stock{precision}"), engine: stock.clone() },
        Setting {
            name: format!("stock-960{precision}"),
            engine: EngineSettings { rate_hz: 960.0, ..stock.clone() },
        },
    ];
    for rate_hz in [240.0, 480.0, 1000.0] {
        settings.push(Setting {
            name: format!("native-{rate_hz}{precision}"),
            engine: EngineSettings {
                contact_solver: ContactSolver::Native,
                rate_hz,
                ..stock.clone()
            },
        });
    }
    if world::built_in().contains(&Backend::Rapier) {
        settings.push(Setting {
            name: "rapier".to_owned(),
            engine: EngineSettings { backend: Backend::Rapier, ..stock },
        });
    }
    settings
}
