//! `pluvia info`

use serde_json::json;

use super::{CliError, Context, Ended, cores, print, print_json};
use crate::scenario::Backend;

/// Print versions, the engine with its precision, and the number of cores.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example:\n  pluvia info --json")]
pub struct Arguments {}

pub(super) fn run(context: &Context) -> Result<Ended, CliError> {
    let engine = crate::world::info(Backend::Bullet);
    let features: &[&str] =
        if cfg!(feature = "double-precision") { &["double-precision"] } else { &[] };
    if context.json {
        print_json(&json!({
            "pluvia": env!("CARGO_PKG_VERSION"),
            "backends": [engine],
            "features": features,
            "target": format!("{}-{}", std::env::consts::ARCH, std::env::consts::OS),
            "cores": cores(),
        }));
    } else {
        print(&format!(
            "pluvia    {}\nengine    {} {}, {} precision\nfeatures  {}\nmachine   {} {}, {} cores",
            env!("CARGO_PKG_VERSION"),
            engine.name,
            engine.version,
            engine.precision,
            if features.is_empty() { "none".to_owned() } else { features.join(", ") },
            std::env::consts::ARCH,
            std::env::consts::OS,
            cores()
        ));
    }
    Ok(Ended::Well)
}
