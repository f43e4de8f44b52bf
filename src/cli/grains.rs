//! `pluvia grains`

use std::path::PathBuf;

use clap::ValueEnum;
use serde_json::json;

use super::{CliError, Context, Ended, print, print_json, usable_folder};
use crate::grains::mesh::{write_obj, write_ply, write_stl};
use crate::record::{FileError, write_file};
use crate::scenario::{Override, load};
use crate::study::{make_grains, write_grains};
use crate::units::{to_cm3, to_g};

/// Make only the grains of a scenario.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Example:\n  pluvia grains scenarios/paper/pluviation.json --format obj --out out/grains"
)]
pub struct Arguments {
    /// The scenario file.
    scenario: PathBuf,
    /// Folder for grains.json, sieve.csv and the mesh.
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Write a mesh of all grains beside grains.json.
    #[arg(long, value_enum, default_value = "json")]
    format: Format,
    /// Seed of the random streams, in place of the scenario's.
    #[arg(long)]
    seed: Option<u64>,
    /// Change a value of the scenario; may be given several times.
    #[arg(long = "set", value_name = "PATH=VALUE")]
    set: Vec<Override>,
}

/// Mesh formats.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Format {
    /// No mesh, only grains.json.
    Json,
    /// Wavefront OBJ, one object a grain.
    Obj,
    /// Text STL, one solid a grain.
    Stl,
    /// Text PLY, one mesh with the number of the grain on each face.
    Ply,
}

pub(super) fn run(arguments: &Arguments, context: &Context) -> Result<Ended, CliError> {
    let mut scenario = load(&arguments.scenario, &arguments.set)?.scenario;
    scenario.seed = arguments.seed.unwrap_or(scenario.seed);
    usable_folder(&arguments.out)?;
    let set = make_grains(&scenario)?;
    write_grains(&arguments.out, &scenario, &set)?;
    let mut mesh = Vec::new();
    let (name, written) = match arguments.format {
        Format::Json => ("", Ok(())),
        Format::Obj => ("grains.obj", write_obj(&set, &mut mesh)),
        Format::Stl => ("grains.stl", write_stl(&set, &mut mesh)),
        Format::Ply => ("grains.ply", write_ply(&set, &mut mesh)),
    };
    if !name.is_empty() {
        let path = arguments.out.join(name);
        written.map_err(|e| FileError::new("write", &path, e))?;
        write_file(&path, &mesh)?;
    }
    let (count, mass, volume) = (set.grains.len(), to_g(set.mass()), to_cm3(set.volume()));
    if context.json {
        print_json(&json!({
            "grains": count,
            "mass_g": mass,
            "solids_volume_cm3": volume,
            "grains_in_100_g": set.grains_in_100_g(),
        }));
    } else {
        print(&format!(
            "{count} grains, {mass:.2} g, {volume:.2} cm³, {:.1} grains in 100 g, in {}",
            set.grains_in_100_g(),
            arguments.out.display()
        ));
    }
    Ok(Ended::Well)
}
