//! Pictures of a run: its grains, the apparatus, the filled funnel, the specimen and its vibration.

use std::path::Path;

use super::loose;
use super::sheet::sheet;
use super::*;
use crate::export::{FramesRead, read_playback};
use crate::report::Picture;
use crate::specimen::FunnelState;

/// Width of these pictures in pixels.
const WIDTH: u32 = 1400;
/// Panels in a row.
const COLUMNS: u32 = 2;
/// From where apparatus and specimens are seen: nearly level, so that heights can be compared.
const LEVEL: View = View { azimuth_deg: 20.0, elevation_deg: 16.0 };
/// How high the funnel hangs over the cylinder where no pouring tells, in m.
const LIFTED: f64 = 0.05;
/// How all of them are made.
const MADE: &str = "Cast ray by ray from the simulated shapes in their simulated places; walls are \
                    drawn thinner than simulated, their inner faces where they are.";

/// The grains, the filled funnel and the specimen at its end, before and after
/// vibration where there was one, from the folder of any run.
///
/// # Errors
/// When the run cannot be read or a picture cannot be drawn.
pub fn of_run(folder: &Path) -> Result<Vec<Picture>, PictureError> {
    let run = read_playback(folder, FramesRead::Ends, None)?;
    let mut pictures = vec![grains(&run, "picture-grains", "Grains")?];
    pictures.extend(funnel(&run, "picture-funnel", "Grains in the funnel")?);
    match vibration(&run, "picture-vibration", "Before and after vibration")? {
        Some(shaken) => pictures.push(shaken),
        None => pictures.push(specimen(&run)?),
    }
    Ok(pictures)
}

fn finished(
    stem: &str,
    title: &str,
    caption: String,
    image: &Image,
) -> Result<Picture, PictureError> {
    let png = image.to_png(Background::White)?;
    Ok(Picture { stem: stem.to_owned(), title: title.to_owned(), caption, png })
}

/// Grains of each sieve fraction.
pub(crate) fn grains(run: &Playback, stem: &str, title: &str) -> Result<Picture, PictureError> {
    let shot = Shot { width: WIDTH, height: 760, view: loose::VIEW, ..Shot::default() };
    let image = loose_grains(&run.grains, &shot)?;
    let caption = format!(
        "Grains of each sieve fraction, at most {} rows of it, evenly picked and laid on their largest \
         face; {} were made. Colours: sieve fraction.",
        loose::ROWS,
        run.grains.grains.len()
    );
    finished(stem, title, caption, &image)
}

/// The pieces alone: cylinder, and above it funnel and lid.
pub(crate) fn apparatus(run: &Playback, stem: &str, title: &str) -> Result<Picture, PictureError> {
    let poured = run.stages.iter().flat_map(|s| &s.frames).filter(|f| f.cylinder);
    let hung = poured.filter_map(|f| f.funnel).map(|f| f.opening_height).next();
    let opening_height = hung.unwrap_or(run.setup.cylinder.height + LIFTED);
    let built_in = run.setup.pieces.is_empty();
    let frame = Frame {
        cylinder: built_in,
        funnel: built_in.then_some(FunnelState { opening_height, lid: true }),
        pieces: run.setup.pieces.iter().map(|piece| Some(piece.at)).collect(),
        ..Frame::default()
    };
    let notes = Notes {
        things: vec![
            (Colour::WALL, "walls".into()),
            (Colour::SECTION, "cut".into()),
            (Colour::FLOOR, "floor, lid".into()),
        ],
        ..Notes::default()
    };
    let mut scenes = Vec::new();
    for (walls, name) in [(Walls::Transparent, "(a) as glass"), (Walls::Cut, "(b) cut away")] {
        scenes.push((scene_of(&run.setup, &run.grains, &frame, walls, &LEVEL, &[])?, name));
    }
    let points = scenes[0].0.outline();
    let image = sheet(&exposed(run, &scenes, &points), COLUMNS, WIDTH, Some(&notes))?;
    let (cylinder, funnel) = (&run.setup.cylinder, &run.setup.funnel);
    let caption = format!(
        "Funnel, lid and cylinder: the cylinder {} mm wide and {} mm high inside, the funnel opening \
         {} mm wide and {} mm above its floor. {MADE}",
        number(to_mm(2.0 * cylinder.radius)),
        number(to_mm(cylinder.height)),
        number(funnel.opening_diameter_mm),
        number(to_mm(opening_height)),
    );
    finished(stem, title, caption, &image)
}

/// How many panels stand in a row.
fn columns(panels: usize) -> u32 {
    COLUMNS.min(panels.max(1) as u32)
}

/// One panel of several.
fn panel_shot(walls: Walls, panels: usize) -> Shot {
    let whole = Shot { width: WIDTH, ..Shot::default() }.camera_width();
    let width = whole / columns(panels);
    Shot { width, height: width, view: LEVEL, walls, notes: false, ..Shot::default() }
}

/// Scenes as panels of one height, just high enough for these points.
fn exposed(run: &Playback, scenes: &[(Scene, &str)], points: &[Point]) -> Vec<(Image, String)> {
    let mut shot = panel_shot(Walls::default(), scenes.len());
    let high = aspect(points, &shot.view).clamp(0.4, 1.6);
    shot.height = (high * f64::from(shot.width)) as u32;
    let depth = glass_depth(&run.setup);
    let panel =
        |(scene, name): &(Scene, &str)| (expose(scene, points, &shot, depth), (*name).to_owned());
    scenes.iter().map(panel).collect()
}

/// Moments in panels that share one framing; their caption begins with `what`.
fn of_moments(
    run: &Playback,
    stem: &str,
    title: &str,
    shown: &[(At, Walls, &str)],
    what: &str,
) -> Result<Picture, PictureError> {
    let mut scenes = Vec::new();
    let mut points: Vec<Point> = Vec::new();
    let mut notes = Notes::default();
    for (at, walls, name) in shown {
        let (scene, said) = stage_scene(run, *at, &panel_shot(*walls, shown.len()), None)?;
        points.extend(scene.outline());
        notes = Notes { lines: vec![run.scenario.clone()], ..said };
        scenes.push((scene, *name));
    }
    notes.things.extend(key_of_walls(run, shown));
    let panels = exposed(run, &scenes, &points);
    let image = sheet(&panels, columns(panels.len()), WIDTH, Some(&notes))?;
    finished(stem, title, format!("{what} Colours: sieve fraction. {MADE}"), &image)
}

/// What the key says of walls where any are cut: pieces of a laboratory are shown whole or not at all,
/// and have no sections.
fn key_of_walls(run: &Playback, shown: &[(At, Walls, &str)]) -> Vec<(Colour, String)> {
    let is_cut = shown.iter().any(|s| s.1 == Walls::Cut);
    let wall = is_cut.then(|| (Colour::WALL, "wall".to_owned()));
    let has_sections = is_cut && run.setup.pieces.is_empty();
    let section = has_sections.then(|| (Colour::SECTION, "wall, cut".to_owned()));
    wall.into_iter().chain(section).collect()
}

/// The end of a stage; none where the run has no such stage.
fn end_of(run: &Playback, stage: &str) -> Option<At> {
    at(run, Some(stage), None).ok()
}

/// The filled funnel; none where the run fills none.
pub(crate) fn funnel(
    run: &Playback,
    stem: &str,
    title: &str,
) -> Result<Option<Picture>, PictureError> {
    let Some(filled) = end_of(run, "fill_funnel") else { return Ok(None) };
    let shown =
        [(filled, Walls::Transparent, "(a) as glass"), (filled, Walls::Cut, "(b) cut away")];
    let what = "Grains at rest in the funnel before pouring, the lid closed: (a) through its wall, \
                (b) with the near half of the wall cut away.";
    of_moments(run, stem, title, &shown, what).map(Some)
}

/// The specimen before and after vibration; none where the run has none.
pub(crate) fn vibration(
    run: &Playback,
    stem: &str,
    title: &str,
) -> Result<Option<Picture>, PictureError> {
    let Some(after) = end_of(run, "vibrate") else { return Ok(None) };
    let before = after.stage.checked_sub(1).and_then(|n| end_of(run, &n.to_string()));
    let Some(before) = before else { return Ok(None) };
    let shown = [
        (before, Walls::Hidden, "(a) before, wall left out"),
        (after, Walls::Hidden, "(b) after, wall left out"),
        (before, Walls::Cut, "(c) before, wall cut away"),
        (after, Walls::Cut, "(d) after, wall cut away"),
    ];
    let time = |at: At| number(frame_at(run, at).time);
    let what = format!(
        "The specimen before vibration (t = {} s) and after it (t = {} s), on one scale: (a) and (b) \
         without the cylinder's wall; (c) and (d) with the near half of the wall cut away.",
        time(before),
        time(after)
    );
    of_moments(run, stem, title, &shown, &what).map(Some)
}

fn specimen(run: &Playback) -> Result<Picture, PictureError> {
    let (shown, what) = shown_of_end(run, at(run, None, None)?);
    of_moments(run, "picture-specimen", "The specimen", &shown, what)
}

/// What is shown of the end of a run, and what it is: a pile has no walls that could be left out.
fn shown_of_end(run: &Playback, end: At) -> (Vec<(At, Walls, &'static str)>, &'static str) {
    let frame = frame_at(run, end);
    let has_walls = frame.cylinder || frame.funnel.is_some() || !run.setup.pieces.is_empty();
    if !has_walls {
        return (vec![(end, Walls::Hidden, "")], "The pile at the end of the run.");
    }
    let shown =
        vec![(end, Walls::Hidden, "(a) wall left out"), (end, Walls::Cut, "(b) wall cut away")];
    (shown, "The specimen at the end of the run.")
}

#[cfg(test)]
mod tests {
    use super::super::moment::tests::canned;
    use super::*;
    use crate::plain::assert_holds;
    use crate::protocol::Setup;
    use crate::scenario::Scenario;

    #[test]
    fn a_run_gives_the_pictures_that_its_stages_allow() {
        let mut run = canned();
        let stems = |run: &Playback| -> Vec<String> {
            let funnel = funnel(run, "funnel", "").expect("a picture");
            let shaken = vibration(run, "shaken", "").expect("a picture");
            funnel.into_iter().chain(shaken).map(|p| p.stem).collect()
        };
        assert_eq!(stems(&run), ["funnel"], "law: no vibration, no picture of it");
        run.stages[1].name = "vibrate".to_owned();
        assert_eq!(stems(&run), ["funnel", "shaken"]);
        let after = vibration(&run, "s", "").expect("a picture").expect("there is one");
        assert!(after.caption.contains("t = 0.24 s") && after.caption.contains("t = 1 s"));
        assert!(!after.caption.contains("paper"), "law: of any run, got {}", after.caption);
        let header =
            png::Decoder::new(std::io::Cursor::new(&after.png)).read_info().expect("a PNG");
        assert_eq!(header.info().width, WIDTH);
    }

    /// Law: what has no wall is shown once, and no key says what a cut wall looks like.
    #[test]
    fn a_pile_is_shown_once_and_without_walls() {
        let mut run = canned();
        let walls = |run: &Playback| {
            let end = at(run, None, None).expect("an end");
            shown_of_end(run, end).0.into_iter().map(|(_, walls, _)| walls).collect::<Vec<_>>()
        };
        assert_eq!(walls(&run), [Walls::Hidden, Walls::Cut], "law: of a specimen in its cylinder");
        for frame in run.stages.iter_mut().flat_map(|stage| &mut stage.frames) {
            frame.cylinder = false;
        }
        assert_eq!(walls(&run), [Walls::Hidden], "law: of a pile");
        let picture = specimen(&run).expect("a picture");
        assert!(picture.caption.starts_with("The pile"), "law: named, got {}", picture.caption);
    }

    /// Law: the key names sections where there are any: of walls that are cut, not of the pieces of a
    /// laboratory, which are left out whole.
    #[test]
    fn the_key_names_sections_where_there_are_any() {
        let mut run = canned();
        let end = at(&run, None, None).expect("an end");
        let key = |run: &Playback, walls| -> Vec<String> {
            let things = key_of_walls(run, &[(end, Walls::Hidden, ""), (end, walls, "")]);
            things.into_iter().map(|(_, name)| name).collect()
        };
        assert_eq!(key(&run, Walls::Cut), ["wall", "wall, cut"], "law: of a cylinder");
        assert!(key(&run, Walls::Hidden).is_empty(), "law: no wall is shown");
        let scenario: Scenario = serde_json::from_value(serde_json::json!({
            "name": "plate",
            "grains": { "total_mass_g": 8, "density_kg_per_m3": 2650, "sieve_table":
                [{ "passing_mm": 12.5, "retained_mm": 10, "mass_percent": 100 }] },
            "pieces": [{ "name": "plate", "shape": { "plate": { "size_mm": [90, 90, 10] } } }],
            "stages": [{ "stage": "rest", "duration_s": 1 }],
        }))
        .expect("a scenario");
        run.setup = Setup::new(&scenario).expect("a laboratory");
        assert_eq!(key(&run, Walls::Cut), ["wall"], "law: of a laboratory");
    }

    #[test]
    fn the_apparatus_says_how_large_it_is() {
        let picture = apparatus(&canned(), "apparatus", "").expect("a picture");
        assert_holds(&picture.caption, &["115 mm wide", "200 mm high", "250 mm above"]);
    }
}
