//! `pluvia info` prints versions, engines with their precision, features and cores.

use super::*;
use crate::study::STAGE_FORMAT;

/// Print versions, the engines with their precision, features, number of cores
#[derive(Debug, Args)]
#[command(after_help = "\
Example:
  pluvia info --json")]
pub(super) struct InfoArgs {}

pub(super) fn run(_: &InfoArgs, context: &Context) -> Result<ExitStatus, CliError> {
    let features = [
        ("double-precision", cfg!(feature = "double-precision")),
        ("rapier", cfg!(feature = "rapier")),
    ];
    let features: Vec<&str> =
        features.into_iter().filter_map(|(name, on)| on.then_some(name)).collect();
    let backends: Vec<BackendInfo> =
        world::built_in().iter().map(|&backend| world::info(backend)).collect();
    let (pluvia, cores) = (env!("CARGO_PKG_VERSION"), available_cores());
    let target = format!("{}-{}", std::env::consts::ARCH, std::env::consts::OS);
    let mut text = format!("pluvia    {pluvia} for {target}\n");
    for BackendInfo { name, version, precision } in &backends {
        text += &format!("backend   {name} {version}, {precision} precision\n");
    }
    let shown = if features.is_empty() { "none".into() } else { features.join(", ") };
    text += &format!("features  {shown}\ncores     {cores}\n");
    text += &format!("format    {STAGE_FORMAT} of stored stages\n");
    let info = json!({
        "pluvia": pluvia,
        "backends": backends,
        "features": features,
        "target": target,
        "cores": cores,
        "stage_format": STAGE_FORMAT,
    });
    context.done_asked(&text, &info)
}
