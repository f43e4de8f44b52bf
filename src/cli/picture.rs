//! `pluvia picture` makes a picture or an animation of a run, or a picture of grains alone.

use super::*;
use crate::export::{FramesRead, Playback, read_playback, stage_at_rest};
use crate::grains;
use crate::picture::{
    Animation, Background, ColourBy, LOOSE_VIEW, SIDES, Shot, View, Walls, animate, at,
    loose_grains, picture,
};
use crate::scenario::gathered;

/// Make a picture or an animation of a run, or a picture of grains alone
#[derive(Debug, Args)]
#[command(after_help = "\
Pictures are PNG, animations animated PNG, which browsers play. docs/pictures.md shows some.

Examples:
  pluvia picture out/first --out out/first.png
  pluvia picture out/first --stage pour --time 0.9 --colour-by speed --cylinder cut \\
      --out out/pour.png
  pluvia picture out/shaken --stage vibrate --colour-by displacement --cylinder hidden \\
      --out out/moved.png
  pluvia picture out/grains/grains.json --out out/grains.png
  pluvia picture out/first --stage pour --animate out/pour-moving.png")]
pub(super) struct PictureArgs {
    /// Folder of a run, as `pluvia run` and `pluvia reproduce` leave it, or a file `grains.json`
    #[arg(value_name = "RUN_DIR|GRAINS.json")]
    subject: PathBuf,
    /// File for the picture; its folder is created if needed, and an existing file is kept
    #[arg(long, value_name = "FILE.png", required_unless_present = "animate")]
    out: Option<PathBuf>,
    /// File for an animation instead
    #[arg(long, value_name = "FILE.png", conflicts_with_all = ["out", "time", "grains"])]
    animate: Option<PathBuf>,
    /// Replace the file if it exists already
    #[arg(long)]
    force: bool,
    /// The stage: its number from 0, its name, or `rest_test`. Its end is shown; animated, all of
    /// it. By default the last stage, from whose beginning displacement counts, not the rest test,
    /// in which nothing moves; animated, every stage
    #[arg(long, allow_negative_numbers = true)]
    stage: Option<String>,
    /// The time to show, in s since the run began (of a stage that kept no frames, only the end
    /// can be shown)
    #[arg(long, value_name = "S", value_parser = number, allow_negative_numbers = true)]
    time: Option<f64>,
    /// Show the run's grains alone, in rows by sieve fraction
    #[arg(long)]
    grains: bool,
    /// What the colours show
    #[arg(long, value_enum, default_value_t = ColourBy::Fraction)]
    colour_by: ColourBy,
    /// How cylinder and funnel are shown
    #[arg(long, value_enum, default_value_t = Walls::Transparent)]
    cylinder: Walls,
    /// Azimuth of the camera, counter-clockwise from the front; at 0 the table shakes from left to
    /// right [default: 25; 0 for grains alone]
    #[arg(long, value_name = "DEG", value_parser = number, allow_negative_numbers = true)]
    azimuth: Option<f64>,
    /// Elevation of the camera above the horizon [default: 18; 60 for grains alone]
    #[arg(long, value_name = "DEG", value_parser = number, allow_negative_numbers = true)]
    elevation: Option<f64>,
    /// Width in pixels [default: 1600; animated 640]
    #[arg(long, value_name = "PX", value_parser = whole(*SIDES.start(), *SIDES.end()),
          allow_negative_numbers = true)]
    width: Option<u32>,
    /// Height in pixels [default: three quarters of the width; five eighths for grains alone;
    /// animated as the width]
    #[arg(long, value_name = "PX", value_parser = whole(*SIDES.start(), *SIDES.end()),
          allow_negative_numbers = true)]
    height: Option<u32>,
    /// Background
    #[arg(long, value_enum, default_value_t = Background::White)]
    background: Background,
    /// Leave out the key and the notes beside the picture
    #[arg(long)]
    no_key: bool,
    /// Simulated time between two frames of an animation; frames are kept at every sample
    #[arg(
        long,
        value_name = "S",
        default_value_t = 0.08,
        value_parser = number,
        conflicts_with = "out",
        allow_negative_numbers = true
    )]
    every: f64,
    /// Frames per second of an animation
    #[arg(long, value_name = "N", default_value_t = 12, conflicts_with = "out",
          value_parser = whole(1_u16, 60), allow_negative_numbers = true)]
    frames_per_second: u16,
    /// Largest size of an animation; checked before it is made
    #[arg(
        long,
        value_name = "MB",
        default_value_t = 25.0,
        value_parser = number,
        conflicts_with = "out",
        allow_negative_numbers = true
    )]
    limit_mb: f64,
}

#[derive(Default, Serialize)]
struct Made {
    scenario: Option<String>,
    stage: Option<String>,
    time_s: Option<f64>,
    frames: Option<usize>,
    #[serde(serialize_with = "json_path")]
    file: PathBuf,
    bytes: usize,
}

impl PictureArgs {
    /// The shot that the options ask for, where they leave open: from a view, and so
    /// high by its width.
    fn shot(&self, view: View, high: f64) -> Shot {
        let width = self.width.unwrap_or(if self.animate.is_some() { 640 } else { 1600 });
        let high = (high * f64::from(width)) as u32;
        Shot {
            width,
            height: self.height.unwrap_or(high),
            view: View {
                azimuth_deg: self.azimuth.unwrap_or(view.azimuth_deg),
                elevation_deg: self.elevation.unwrap_or(view.elevation_deg),
            },
            walls: self.cylinder,
            colour_by: self.colour_by,
            background: self.background,
            notes: !self.no_key,
        }
    }
}

pub(super) fn run(args: &PictureArgs, context: &Context) -> Result<ExitStatus, CliError> {
    context.stop_without_stages();
    let made = match (&args.animate, &args.out) {
        (Some(file), _) => {
            ends_in(file, "--animate", &["png", "apng"])?;
            animation(args, context, file)?
        }
        (None, Some(file)) => {
            ends_in(file, "--out", &["png"])?;
            still(args, context, file)?
        }
        (None, None) => return Err(CliError::Usage("--out or --animate is needed".into())),
    };
    let mut text = String::new();
    if let Some(scenario) = &made.scenario {
        text += scenario;
    }
    if let (Some(stage), Some(time)) = (&made.stage, made.time_s) {
        text += &format!(", {stage}, {time:.3} s");
    }
    if let Some(frames) = made.frames {
        let plays = frames as f64 / f64::from(args.frames_per_second);
        text += &format!(": {}, plays for {}", counted(frames, "frame"), table::duration(plays));
    }
    text += &format!("\n{} ({} kB)\n", plain_path(&made.file), made.bytes.div_ceil(1000));
    context.done(text.trim_start(), &made)
}

/// Whether a subject is no folder of a run, but something that is there.
fn is_file(subject: &Path) -> bool {
    subject.exists() && !subject.is_dir()
}

/// Whether the name of a file ends as an option's must.
pub(super) fn ends_in(file: &Path, option: &str, allowed: &[&str]) -> Result<(), CliError> {
    let extension = file.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    if allowed.contains(&extension.as_str()) {
        return Ok(());
    }
    let allowed = allowed.join(" or .");
    Err(CliError::Usage(format!(
        "{option} is {}, its name must end in .{allowed}",
        plain_path(file)
    )))
}

/// Refuses a file that is there unless it may be replaced, and a folder in its place.
pub(super) fn refuse_existing(file: &Path, force: bool) -> Result<(), FileError> {
    if file.is_dir() {
        return Err(FileError::new("write", file, "it is a folder"));
    }
    if file.exists() && !force {
        let reason = "it exists already; name another, or give --force to replace it";
        return Err(error::refused("write", file, reason));
    }
    Ok(())
}

/// The folder of a file, made and tried before the work; a file that is there is refused unless
/// it may be replaced.
pub(super) fn prepare(file: &Path, force: bool) -> Result<(), FileError> {
    refuse_existing(file, force)?;
    let folder = file.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    output_folder::prepare(folder)
}

fn still(args: &PictureArgs, context: &Context, file: &Path) -> Result<Made, CliError> {
    if args.grains || is_file(&args.subject) {
        return alone(args, context, file);
    }
    let shot = args.shot(View::default(), 0.75);
    shot.check()?;
    let asked = match (&args.stage, args.time) {
        (Some(stage), _) => Some(stage.as_str()),
        // Any stage may have that time, the rest test, too.
        (None, Some(_)) => stage_at_rest(&args.subject)?,
        (None, None) => None,
    };
    let run = read_playback(&args.subject, FramesRead::All, asked)?;
    let shown = at(&run, args.stage.as_deref(), args.time)?;
    prepare(file, args.force)?;
    let png = picture(&run, shown, &shot)?.to_png(shot.background)?;
    context.go_on()?;
    write_file(file, &png)?;
    let stage = &run.stages[shown.stage];
    Ok(Made {
        stage: Some(stage.name.clone()),
        time_s: Some(stage.frames[shown.frame].time),
        ..made(Some(run.scenario), file, &png)
    })
}

fn alone(args: &PictureArgs, context: &Context, file: &Path) -> Result<Made, CliError> {
    if args.stage.is_some() || args.time.is_some() {
        let text = "--stage and --time choose a moment of a run; grains alone have none";
        return Err(CliError::Usage(text.to_owned()));
    }
    let shot = args.shot(LOOSE_VIEW, 0.625);
    shot.check()?;
    let set = if is_file(&args.subject) {
        let json = read_json(&args.subject).map_err(|error| not_grains(&args.subject, error))?;
        grains::from_json(&json).map_err(|e| FileError::unfit(&args.subject, e))?
    } else {
        let Playback { grains, .. } = read_playback(&args.subject, FramesRead::All, None)?;
        (*grains).clone()
    };
    prepare(file, args.force)?;
    let png = loose_grains(&set, &shot)?.to_png(shot.background)?;
    context.go_on()?;
    write_file(file, &png)?;
    Ok(made(None, file, &png))
}

/// Why a file holds no grains: a scenario, from which grains are made, is called so.
fn not_grains(file: &Path, error: FileError) -> FileError {
    let is_scenario = |value: &Value| ["grains", "stages"].iter().any(|f| value.get(f).is_some());
    if !gathered(file).is_ok_and(|value| is_scenario(&value)) {
        return error;
    }
    let why = "it is a scenario; `pluvia grains` makes its grains, in a file `grains.json`, and \
               `pluvia run` a folder, which can be shown";
    FileError::unfit(file, why)
}

fn animation(args: &PictureArgs, context: &Context, file: &Path) -> Result<Made, CliError> {
    let animation = Animation {
        shot: args.shot(View::default(), 1.0),
        stage: args.stage.clone(),
        every_s: args.every,
        frames_per_second: args.frames_per_second,
        limit_mb: args.limit_mb,
    };
    let run = read_playback(&args.subject, FramesRead::All, args.stage.as_deref())?;
    prepare(file, args.force)?;
    let film = animate(&run, &animation, context.progress.as_ref(), &context.cancel)?;
    context.go_on()?;
    write_file(file, &film.png)?;
    Ok(Made { frames: Some(film.frames), ..made(Some(run.scenario), file, &film.png) })
}

fn made(scenario: Option<String>, file: &Path, png: &[u8]) -> Made {
    Made { scenario, file: file.to_owned(), bytes: png.len(), ..Made::default() }
}
