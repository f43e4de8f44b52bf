//! `pluvia info` prints versions, engines with their precision, features and cores.

use super::*;
use crate::study::STAGE_FORMAT;

/// Print versions, the engines with their precision, features, number of cores
#[derive(Debug, Args)]
#[command(after_help = "\
Example:
  pluvia info --json")]
pub(super) struct InfoArgs {}

#[derive(Serialize)]
struct Info {
    /// Version of the program.
    pluvia: &'static str,
    /// The engines it can use.
    backends: Vec<BackendInfo>,
    /// Cargo features it was built with.
    features: Vec<&'static str>,
    /// Processor and operating system it was built for.
    target: String,
    /// Threads that can run at the same time.
    cores: usize,
    /// Of stored stages: it rises whenever results change.
    stage_format: u32,
}

pub(super) fn run(_: &InfoArgs, context: &Context) -> Result<ExitStatus, CliError> {
    let features = [
        ("double-precision", cfg!(feature = "double-precision")),
        ("rapier", cfg!(feature = "rapier")),
    ];
    let features = features.into_iter().filter_map(|(name, on)| on.then_some(name)).collect();
    let info = Info {
        pluvia: env!("CARGO_PKG_VERSION"),
        backends: world::built_in().iter().map(|&backend| world::info(backend)).collect(),
        features,
        target: format!("{}-{}", std::env::consts::ARCH, std::env::consts::OS),
        cores: available_cores(),
        stage_format: STAGE_FORMAT,
    };
    let mut text = format!("pluvia    {} for {}\n", info.pluvia, info.target);
    for backend in &info.backends {
        text += &format!(
            "backend   {} {}, {} precision\n",
            backend.name, backend.version, backend.precision
        );
    }
    let features = if info.features.is_empty() { "none".into() } else { info.features.join(", ") };
    text += &format!("features  {features}\ncores     {}\n", info.cores);
    text += &format!("format    {} of stored stages\n", info.stage_format);
    context.print_asked(&text, &info)?;
    Ok(ExitStatus::Done)
}
