//! `pluvia grains` makes only the grains of a scenario and writes them with their sieve analysis.

use super::*;
use crate::grains::{
    GrainShape, MeshRecord, SieveAnalysis, load_grains, write_obj, write_ply, write_stl,
};
use crate::record::{GradationSummary, ShapeSummary, SieveSummary};
use crate::study::{grain_files, make_grains};
use crate::units::{to_cm3, to_g};

/// Make only the grains of a scenario; apparatus, engine and stages are ignored
#[derive(Debug, Args)]
#[command(after_help = "\
Leaves grains.json in DIR. Grains made by a sieve table also have sieve.csv, grains made from meshes
stones.csv with the outcome for each mesh. Another format adds grains.obj, grains.stl or grains.ply,
for programs that show meshes. `pluvia picture DIR/grains.json --out FILE.png` shows the grains.

Examples:
  pluvia grains scenarios/paper/pluviation.json --out out/grains
  pluvia grains scenarios/paper/pluviation.json --format ply --out out/grains
  pluvia grains scenarios/paper/pluviation.json --set grains.cells.flatness=2 --out out/flat")]
pub(super) struct GrainsArgs {
    /// The scenario file
    #[arg(value_name = "SCENARIO.json")]
    scenario: PathBuf,
    /// Format of the grains
    #[arg(long, value_enum, default_value_t = Format::Json)]
    format: Format,
    #[command(flatten)]
    changes: SetArgs,
    /// Folder for the files, created if needed
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Replace other grains in that folder
    #[arg(long)]
    force: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Format {
    /// grains.json alone
    Json,
    /// Wavefront OBJ, one object per grain
    Obj,
    /// Binary STL, all grains in one solid
    Stl,
    /// PLY, faces numbered by grain
    Ply,
}

#[derive(Serialize)]
struct Made {
    scenario: String,
    grains: usize,
    mass_g: f64,
    solids_volume_cm3: f64,
    grains_in_100_g: f64,
    sieve_analysis: SieveSummary,
    shape: Option<ShapeSummary>,
    /// What a reader should know of grains made from meshes.
    notes: Vec<String>,
    #[serde(serialize_with = "json_paths")]
    files: Vec<PathBuf>,
}

pub(super) fn run(args: &GrainsArgs, context: &Context) -> Result<ExitStatus, CliError> {
    context.stop_without_stages();
    let scenario = load_grains(&args.scenario, args.changes.overrides()?)?.scenario;
    asked::refuse(&args.out, "grains")?;
    output_folder::prepare(&args.out)?;
    let set = make_grains(&scenario)?;
    let mut files = grain_files(&scenario, &set)?;
    let mut content = Vec::new();
    let written = match args.format {
        Format::Json => None,
        Format::Obj => Some(("grains.obj", write_obj(&set, &mut content))),
        Format::Stl => Some(("grains.stl", write_stl(&set, &mut content))),
        Format::Ply => Some(("grains.ply", write_ply(&set, &mut content))),
    };
    if let Some((name, written)) = written {
        written.map_err(|error| FileError::new("write", &args.out.join(name), error))?;
        files.push((name, content));
    }
    context.go_on()?;
    // Grains take seconds, in which another command may have begun there.
    asked::refuse(&args.out, "grains")?;
    let files = output_folder::write_files(&args.out, &files, args.force)?;
    let made = Made {
        scenario: scenario.name,
        grains: set.grains.len(),
        mass_g: to_g(set.total_mass()),
        solids_volume_cm3: to_cm3(set.total_volume()),
        grains_in_100_g: set.grains_in_100_g(),
        sieve_analysis: SieveSummary::of(&SieveAnalysis::of(&set), set.specified().as_ref()),
        shape: ShapeSummary::of(&GrainShape::of_all(&set)),
        notes: MeshRecord::notes(&set.meshes),
        files,
    };
    let mut text = format!(
        "{}: {}, {} g, {} cm³ of solids, {:.1} grains in 100 g\n",
        made.scenario,
        counted(made.grains, "grain"),
        grams(made.mass_g),
        grams(made.solids_volume_cm3),
        made.grains_in_100_g
    );
    if let Some(specified) = &made.sieve_analysis.specified {
        text += &format!("specified: {}\n", in_words(specified));
    }
    text += &format!("generated: {}\n", in_words(&made.sieve_analysis.generated));
    if let Some(shape) = &made.shape {
        text += &format!(
            "medians: elongation {:.2}, flatness {:.2}, sphericity {:.2}{}\n",
            shape.elongation.p50,
            shape.flatness.p50,
            shape.sphericity.p50,
            shape.roundness.map_or(String::new(), |r| format!(", roundness {:.2}", r.p50))
        );
    }
    for note in &made.notes {
        text += &format!("{note}\n");
    }
    for file in &made.files {
        text += &format!("{}\n", plain_path(file));
    }
    context.done(&text, &made)
}

/// What is read off a curve, in a line.
fn in_words(of: &GradationSummary) -> String {
    let uscs = &of.uscs;
    let [d10, d30, d50, d60] = [of.d10_mm, of.d30_mm, of.d50_mm, of.d60_mm].map(size);
    let (cu, cc) = (of.coefficient_of_uniformity, of.coefficient_of_curvature);
    format!(
        "D10 {d10} mm, D30 {d30} mm, D50 {d50} mm, D60 {d60} mm, Cu {cu:.2}, Cc {cc:.2}, {uscs}"
    )
}

/// A size in mm to hundredths, of sand to three digits.
fn size(mm: f64) -> String {
    let decimals = (2.0 - mm.log10().floor()).clamp(2.0, 9.0) as usize;
    format!("{mm:.decimals$}")
}

#[cfg(test)]
mod tests {
    use super::size;

    /// Law: sizes of fine sand differ in what is printed.
    #[test]
    fn sizes_of_sand_have_three_digits() {
        for (mm, expected) in
            [(11.2345, "11.23"), (8.1785, "8.18"), (0.17654, "0.177"), (0.071_23, "0.0712")]
        {
            assert_eq!(size(mm), expected, "{mm} mm");
        }
    }
}
