//! `pluvia export`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use serde::Serialize;

use super::{CliError, Context, ExitStatus, output_folder};
use crate::export::{
    ExportError, apparatus_obj, contacts_csv, grains_csv, grains_obj, pairs_csv, read_run,
};
use crate::record::{FileError, write_file};

/// Write a run's specimen for other programs
#[derive(Debug, Args)]
#[command(after_help = "\
Leaves in DIR, in SI units:
  json  scene.json: all that another engine needs to carry on (docs/exchange.md)
  csv   grains.csv, contacts.csv (loaded contacts), pairs.csv (touching grains with their gaps)
  obj   grains.obj, apparatus.obj: one object a body, in world coordinates

Examples:
  pluvia export out/first --format json --out out/first-for-others
  pluvia export out/reproduce/runs/pluviation-c1-fh050 --format obj --stage pour --out out/meshes")]
pub(super) struct ExportArgs {
    /// Folder of a run, as `pluvia run` and `pluvia reproduce` leave it
    #[arg(value_name = "RUN_DIR")]
    run: PathBuf,
    /// What to write
    #[arg(long, value_enum)]
    format: Format,
    /// The stage at whose end to take the specimen: its number from 0, its name, or `control`;
    /// the last one if left out
    #[arg(long)]
    stage: Option<String>,
    /// Folder for the files; it is made if needed
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Format {
    /// Grains, apparatus and motion for other physics engines
    Json,
    /// Tables of grains, contacts and touching pairs
    Csv,
    /// Meshes in their places, Wavefront OBJ
    Obj,
}

/// What was written.
#[derive(Serialize)]
struct Written {
    scenario: String,
    stage: String,
    time_s: f64,
    grains: usize,
    files: Vec<PathBuf>,
}

pub(super) fn run(args: &ExportArgs, context: &Context) -> Result<ExitStatus, CliError> {
    let run = read_run(&args.run, args.stage.as_deref())?;
    output_folder::prepare(&args.out)?;
    let manifest = args.run.join("manifest.json");
    let apparatus = |reason| ExportError::Apparatus { manifest: manifest.clone(), reason };
    let table = |name: &'static str, content: Result<Vec<u8>, csv::Error>| {
        let content = content.map_err(|e| FileError::new("write", &args.out.join(name), e))?;
        Ok::<_, FileError>((name, content))
    };
    let contents = match args.format {
        Format::Json => {
            let scene = run.scene().map_err(apparatus)?;
            let path = args.out.join("scene.json");
            let mut text =
                serde_json::to_vec(&scene).map_err(|e| FileError::new("write", &path, e))?;
            text.push(b'\n');
            vec![("scene.json", text)]
        }
        Format::Csv => vec![
            table("grains.csv", grains_csv(&run.specimen))?,
            table("contacts.csv", contacts_csv(&run.setup, &run.specimen))?,
            table("pairs.csv", pairs_csv(&run.specimen))?,
        ],
        Format::Obj => {
            let walls = apparatus_obj(&run.setup, &run.specimen).map_err(apparatus)?;
            let grains = grains_obj(&run.specimen);
            vec![("grains.obj", grains.into_bytes()), ("apparatus.obj", walls.into_bytes())]
        }
    };
    let mut files = Vec::new();
    for (name, content) in contents {
        let path = args.out.join(name);
        write_file(&path, &content)?;
        files.push(path);
    }
    let written = Written {
        scenario: run.made_by.scenario,
        stage: run.made_by.stage,
        time_s: run.made_by.time_s,
        grains: run.specimen.present().count(),
        files,
    };
    let mut text = format!(
        "{}: {} grains at the end of {}, {:.3} s\n",
        written.scenario, written.grains, written.stage, written.time_s
    );
    for file in &written.files {
        text += &format!("{}\n", file.display());
    }
    context.print(&text, &written)?;
    Ok(ExitStatus::Done)
}
