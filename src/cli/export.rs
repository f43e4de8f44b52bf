//! `pluvia export` writes a run's specimen, or how it moved, in formats that other programs read.

use super::*;
use crate::export::{
    DEFAULT_EVERY, Exported, Moments, VTK_LISTS, apparatus_obj, contacts_csv, glb, grains_csv,
    grains_obj, grains_ply, grains_stl, pairs_csv, read_at_rest, read_moments, read_run,
    stage_at_rest, write_vtk,
};
use crate::specimen::{Fate, SpecimenState};

/// Write a run's specimen, or how it moved, for other programs
#[derive(Debug, Args)]
#[command(after_help = "\
Leaves in DIR, in SI units; tables in mm, g, N and what their headers say:
  json  scene.json: all that another engine needs to continue (docs/exchange.md)
  csv   grains.csv, contacts.csv (loaded contacts), pairs.csv (touching grains with their gaps)
  obj   grains.obj, apparatus.obj: one object per body, in world coordinates
  stl   grains.stl: the triangles of all grains where they are
  ply   grains.ply: their faces, numbered by grain
  vtk   for ParaView: grains.pvd and apparatus.pvd with a .vtp file every S seconds and at the end
        of each stage; contacts.pvd and force_chains.pvd at those ends (docs/export.md)
  glb   for Blender and browsers: specimen.glb, with --animate also how everything moved

Examples:
  pluvia export out/first --format json --out out/first-for-others
  pluvia export out/first --format vtk --every 0.2 --out out/paraview
  pluvia export out/first --format glb --stage pour --animate --out out/blender
  pluvia export out/reproduce/runs/pluviation-c1-fh050 --format obj --stage pour --out out/meshes")]
pub(super) struct ExportArgs {
    /// Folder of a run, as `pluvia run` and `pluvia reproduce` leave it
    #[arg(value_name = "RUN_DIR")]
    run: PathBuf,
    /// What to write
    #[arg(long, value_enum)]
    format: Format,
    /// The stage to take, at its end: its number from 0, its name, or `rest_test`; by default the
    /// specimen at rest, at the end of the rest test or, without one, of the last stage. vtk and
    /// --animate show motion: by default every stage, without the rest test, in which nothing moves
    #[arg(long, allow_negative_numbers = true)]
    stage: Option<String>,
    /// Least time between two frames in simulated seconds, for vtk and --animate [default: 0.4 for
    /// vtk, every frame for --animate; frames are kept at every sample]
    #[arg(long, value_name = "S", value_parser = seconds, allow_negative_numbers = true)]
    every: Option<f64>,
    /// With glb: how everything moved, as an animation
    #[arg(long)]
    animate: bool,
    /// Folder for the files, created if needed
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Replace files of another export in that folder
    #[arg(long)]
    force: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Format {
    /// Grains, apparatus and motion for other physics engines
    Json,
    /// Tables of grains, contacts and touching pairs
    Csv,
    /// Meshes in their places, Wavefront OBJ
    Obj,
    /// Triangles of the grains in their places, STL
    Stl,
    /// Faces of the grains in their places, PLY
    Ply,
    /// Frames, contacts and force chains for ParaView
    Vtk,
    /// One binary glTF file, still or moving
    Glb,
}

fn seconds(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(value) if value > 0.0 && f64::is_finite(value) => Ok(value),
        _ => Err("expected a number of seconds above 0".to_owned()),
    }
}

#[derive(Default, Serialize)]
struct Written {
    scenario: String,
    /// The stage at whose end the specimen is, or which the frames end with.
    stage: String,
    time_s: f64,
    /// Grains that take part at that end; with an animation, at any time.
    grains: usize,
    /// Moments of the run; 1 for a specimen that does not move.
    moments: usize,
    bytes: u64,
    #[serde(serialize_with = "json_paths")]
    files: Vec<PathBuf>,
    /// Number of further files, which those above name.
    more_files: usize,
}

pub(super) fn run(args: &ExportArgs, context: &Context) -> Result<ExitStatus, CliError> {
    let moving = args.format == Format::Vtk || args.animate;
    if args.animate && args.format != Format::Glb {
        return Err(CliError::Usage("--animate needs --format glb".to_owned()));
    }
    if args.every.is_some() && !moving {
        let what = "--every needs --format vtk or --animate";
        return Err(CliError::Usage(what.to_owned()));
    }
    context.stop_without_stages();
    refuse_others(args)?;
    let written = match args.format {
        Format::Vtk => frames(args, context)?,
        Format::Glb => scene(args, context)?,
        _ => specimen(args, context)?,
    };
    let mut text = format!(
        "{}: {} at the end of {}, {:.3} s\n",
        written.scenario,
        counted(written.grains, "grain"),
        written.stage,
        written.time_s
    );
    for file in &written.files {
        text += &format!("{}\n", plain_path(file));
    }
    let files = written.files.len() + written.more_files;
    text += &format!("{}, {}", counted(files, "file"), size(written.bytes));
    if written.moments > 1 {
        text += &format!(", {} moments", written.moments);
    }
    context.done(&text, &written)
}

/// A number of bytes for people.
fn size(bytes: u64) -> String {
    match bytes {
        1_000_000.. => format!("{:.1} MB", bytes as f64 / 1e6),
        _ => format!("{} kB", bytes.div_ceil(1000)),
    }
}

/// Refuses a folder of another command: at first, and again just before files are written, as
/// another command may have begun there while they were made.
fn refuse_others(args: &ExportArgs) -> Result<(), FileError> {
    asked::refuse(&args.out, "export")
}

/// The specimen at the end of a stage, whole files at once.
fn specimen(args: &ExportArgs, context: &Context) -> Result<Written, CliError> {
    let run = match args.stage.as_deref() {
        Some(asked) => read_run(&args.run, Some(asked))?,
        None => read_at_rest(&args.run)?,
    };
    output_folder::prepare(&args.out)?;
    let contents = contents(args, &run)?;
    context.go_on()?;
    refuse_others(args)?;
    let files = output_folder::write_files(&args.out, &contents, args.force)?;
    Ok(Written {
        scenario: run.made_by.scenario,
        stage: run.made_by.stage,
        time_s: run.made_by.time_s,
        grains: run.specimen.present().count(),
        moments: 1,
        bytes: contents.iter().map(|(_, content)| content.len() as u64).sum(),
        files,
        more_files: 0,
    })
}

fn contents(args: &ExportArgs, run: &Exported) -> Result<Vec<(&'static str, Vec<u8>)>, CliError> {
    let apparatus = |reason| ExportError::apparatus(&args.run, reason);
    Ok(match args.format {
        Format::Json => {
            let text = serde_json::to_string(&run.scene().map_err(apparatus)?);
            let text = text.map(|text| format!("{text}\n").into_bytes());
            vec![made(args, "scene.json", text)?]
        }
        Format::Csv => vec![
            made(args, "grains.csv", grains_csv(&run.specimen))?,
            made(args, "contacts.csv", contacts_csv(&run.setup, &run.specimen))?,
            made(args, "pairs.csv", pairs_csv(&run.specimen))?,
        ],
        Format::Obj => {
            let walls = apparatus_obj(&run.setup, &run.specimen).map_err(apparatus)?;
            let grains = grains_obj(&run.specimen);
            vec![("grains.obj", grains.into_bytes()), ("apparatus.obj", walls.into_bytes())]
        }
        Format::Stl => vec![made(args, "grains.stl", grains_stl(&run.specimen))?],
        Format::Ply => vec![made(args, "grains.ply", grains_ply(&run.specimen))?],
        // These show stages, not one specimen.
        Format::Vtk | Format::Glb => Vec::new(),
    })
}

/// A file with its name.
fn made<E: ToString>(
    args: &ExportArgs,
    name: &'static str,
    content: Result<Vec<u8>, E>,
) -> Result<(&'static str, Vec<u8>), FileError> {
    let content = content.map_err(|why| FileError::new("write", &args.out.join(name), why))?;
    Ok((name, content))
}

/// What is said of the last stage of what was written.
fn of_end(moments: &Moments) -> Written {
    let (stage, end) = match moments.stages.last() {
        Some(stage) => (stage.name.clone(), Some(&stage.end)),
        None => Default::default(),
    };
    let present =
        |end: &SpecimenState| end.bodies.iter().filter(|b| b.fate == Fate::Present).count();
    Written {
        scenario: moments.scenario.clone(),
        stage,
        time_s: end.map_or(0.0, |end| end.time),
        grains: end.map_or(0, present),
        ..Written::default()
    }
}

/// Frames for ParaView.
fn frames(args: &ExportArgs, context: &Context) -> Result<Written, CliError> {
    const ID: u64 = 0;
    let moments = read_moments(&args.run, args.stage.as_deref())?;
    output_folder::prepare(&args.out)?;
    if !args.force {
        output_folder::refuse_any(&args.out, &VTK_LISTS)?;
    }
    refuse_others(args)?;
    let every = args.every.unwrap_or(DEFAULT_EVERY);
    let count = moments.thinned(every).len();
    context.progress.begin_pieces(ID, "moments", count);
    let files = write_vtk(&moments, every, &args.out, |done, _| {
        context.progress.update(ID, done as f64, "");
        !context.is_stopped()
    });
    context.progress.end_stage(ID);
    let files = files?.ok_or(CliError::Stopped)?;
    Ok(Written {
        moments: count,
        bytes: files.bytes,
        more_files: files.data.len(),
        files: files.lists,
        ..of_end(&moments)
    })
}

/// One glTF file.
fn scene(args: &ExportArgs, context: &Context) -> Result<Written, CliError> {
    // A still picture shows one end alone.
    let at_rest = if args.animate { None } else { stage_at_rest(&args.run)? };
    let mut moments = read_moments(&args.run, args.stage.as_deref().or(at_rest))?;
    let every = args.animate.then_some(args.every.unwrap_or(0.0));
    if !args.animate {
        moments.stages.drain(..moments.stages.len().saturating_sub(1));
    }
    let made = glb(&moments, every).map_err(|e| CliError::Usage(e.to_string()))?;
    context.go_on()?;
    output_folder::prepare(&args.out)?;
    refuse_others(args)?;
    let bytes = made.bytes.len() as u64;
    let file = [("specimen.glb", made.bytes)];
    Ok(Written {
        grains: made.grains,
        moments: made.keys.max(1),
        bytes,
        files: output_folder::write_files(&args.out, &file, args.force)?,
        ..of_end(&moments)
    })
}

#[cfg(test)]
mod tests {
    use super::size;

    /// Law: no file that is there has a size of 0.
    #[test]
    fn small_files_have_a_size() {
        for (bytes, expected) in
            [(1, "1 kB"), (26_550, "27 kB"), (999_999, "1000 kB"), (1_230_000, "1.2 MB")]
        {
            assert_eq!(size(bytes), expected, "{bytes} bytes");
        }
    }
}
