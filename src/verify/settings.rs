//! The engines and settings on which every case is run.

use crate::scenario::{Backend, ContactPath, EngineSettings};
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

/// The settings of this build: Bullet's own contacts at the default rate and
/// at twice that, the contact path `manifold` at three rates, and rapier where
/// it is built in.
pub fn settings() -> Vec<Setting> {
    let stock = EngineSettings { contact_path: ContactPath::Bullet, ..EngineSettings::default() };
    let precision = match world::info(Backend::Bullet).precision.as_str() {
        "single" => "-single",
        _ => "",
    };
    let mut settings = vec![
        Setting { name: format!("bullet{precision}"), engine: stock.clone() },
        Setting {
            name: format!("bullet-960{precision}"),
            engine: EngineSettings { rate_hz: 960.0, ..stock.clone() },
        },
    ];
    for rate_hz in [240.0, 480.0, 1000.0] {
        settings.push(Setting {
            name: format!("manifold-{rate_hz}{precision}"),
            engine: EngineSettings {
                contact_path: ContactPath::Manifold,
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
