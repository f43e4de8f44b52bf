//! Settings of our engines as one process hands them to another, and whether its world has them.

use pluvia::{scenario::EngineSettings, world::EffectiveSettings};

/// As arguments: JSON, which leaves out the number of threads, and that number.
pub fn words(settings: &EngineSettings) -> Result<[String; 2], String> {
    let json = serde_json::to_string(settings).map_err(|e| e.to_string())?;
    Ok([json, settings.native.threads.unwrap_or(1).to_string()])
}

/// Of such arguments.
pub fn settings(json: &str, threads: &str) -> Result<EngineSettings, String> {
    let mut settings: EngineSettings = serde_json::from_str(json).map_err(|e| e.to_string())?;
    let threads: u32 = threads.parse().map_err(|e| format!("{threads}: {e}"))?;
    settings.native.threads = Some(threads);
    Ok(settings)
}

/// Whether a world has the threads that these settings ask for, as read back from it; an engine
/// that does not say has one.
pub fn check_threads(
    settings: &EngineSettings,
    read_back: &EffectiveSettings,
) -> Result<(), String> {
    let asked = settings.native.threads.unwrap_or(1);
    let held = read_back.get("threads").and_then(serde_json::Value::as_f64).unwrap_or(1.0);
    if held == f64::from(asked) {
        return Ok(());
    }
    Err(format!("the world has {held} threads, asked for are {asked}"))
}
