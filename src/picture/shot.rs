//! One picture of one moment of a run.

use super::paint::paint;
use super::render::render;
use super::sheet::sheet;
use super::*;

/// Smallest and largest side of a picture in pixels.
pub const SIDES: std::ops::RangeInclusive<u32> = 64..=8192;

/// A number as it was typed, of a huge one the power of ten in place of hundreds of digits.
pub(super) fn shown(value: &f64) -> String {
    if value.abs() < 1e15 { value.to_string() } else { format!("{value:e}") }
}

/// What is wrong with the value of an option, and what is allowed; nothing where it is.
pub(super) fn fault(option: &str, value: f64, is_allowed: bool, allowed: &str) -> Option<String> {
    (!is_allowed).then(|| format!("--{option} is {}, it must be {allowed}", shown(&value)))
}

/// Refuses numbers that have a fault, all at once.
pub(super) fn refuse(faults: impl IntoIterator<Item = Option<String>>) -> Result<(), PictureError> {
    let faults: Vec<String> = faults.into_iter().flatten().collect();
    if faults.is_empty() { Ok(()) } else { Err(PictureError::Range(faults.join("\n"))) }
}

/// How a picture is taken.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shot {
    /// Width in pixels, the notes included.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// From where.
    pub view: View,
    /// How cylinder and funnel are shown.
    pub walls: Walls,
    /// What the grains' colours tell.
    pub colour_by: ColourBy,
    /// What lies behind.
    pub background: Background,
    /// Whether a key and notes stand beside the picture.
    pub notes: bool,
}

impl Default for Shot {
    fn default() -> Self {
        Self {
            width: 1600,
            height: 1200,
            view: View::default(),
            walls: Walls::default(),
            colour_by: ColourBy::default(),
            background: Background::default(),
            notes: true,
        }
    }
}

impl Shot {
    /// Whether the numbers make a picture.
    ///
    /// # Errors
    /// [`PictureError::Range`] naming all that do not.
    pub fn check(&self) -> Result<(), PictureError> {
        refuse(self.faults())
    }

    /// What is wrong with each of the numbers.
    pub(super) fn faults(&self) -> [Option<String>; 4] {
        let side = |option: &str, side: u32| {
            fault(option, f64::from(side), SIDES.contains(&side), "64 to 8192 pixels")
        };
        let View { azimuth_deg, elevation_deg } = self.view;
        let is_seen = (-89.0..=89.0).contains(&elevation_deg);
        [
            side("width", self.width),
            side("height", self.height),
            fault("azimuth", azimuth_deg, azimuth_deg.is_finite(), "a number of degrees"),
            fault("elevation", elevation_deg, is_seen, "-89 to 89 degrees"),
        ]
    }

    /// Width in pixels of what the camera sees.
    pub fn camera_width(&self) -> u32 {
        picture_width(self.width, self.notes)
    }
}

/// Grains with their colours and the apparatus at a moment, and what is to be said
/// of it. `upper` ends a continuous scale of colours.
pub(super) fn stage_scene(
    run: &Playback,
    at: At,
    shot: &Shot,
    upper: Option<f64>,
) -> Result<(Scene, Notes), PictureError> {
    let moments = moments(run, at);
    let (colours, key) = paint(&run.grains, &moments, shot.colour_by, upper)?;
    let scene = scene_of(&run.setup, &run.grains, moments.now, shot.walls, &shot.view, &colours)?;
    let mut things = Vec::new();
    if moments.now.top_plate.is_some() {
        things.push((Colour::PLATE, "top plate".to_owned()));
    }
    let stage = run.stages[at.stage].name.replace('_', " ");
    let lines = vec![
        run.scenario.clone(),
        format!("stage: {stage}"),
        format!("t = {} s", number(moments.now.time)),
    ];
    Ok((scene, Notes { key, things, lines }))
}

/// A picture of a moment of a run.
///
/// # Errors
/// Numbers out of range, frames that the colours need and that are missing, text
/// that cannot be drawn.
pub fn picture(run: &Playback, at: At, shot: &Shot) -> Result<Image, PictureError> {
    shot.check()?;
    let (scene, notes) = stage_scene(run, at, shot, None)?;
    let panel = expose(&scene, &scene.outline(), shot, glass_depth(&run.setup));
    sheet(&[(panel, String::new())], 1, shot.width, shot.notes.then_some(&notes))
}

/// What the camera sees with these points in the picture.
pub(super) fn expose(scene: &Scene, points: &[Point], shot: &Shot, glass_depth: f64) -> Image {
    let (width, height) = (shot.camera_width(), shot.height);
    let camera = Camera::framing(points, &shot.view, width, height);
    render(scene, &camera, width, height, glass_depth)
}

#[cfg(test)]
mod tests {
    use super::super::moment::tests::canned;
    use super::*;

    fn small() -> Shot {
        Shot { width: 200, height: 120, ..Shot::default() }
    }

    #[test]
    fn a_moment_is_shown_by_every_colour_and_wall() {
        let run = canned();
        let at = At { stage: 0, frame: 3 };
        let covered = |walls, colour_by| {
            let image =
                picture(&run, at, &Shot { walls, colour_by, ..small() }).expect("a picture");
            assert_eq!((image.width, image.height), (200, 120));
            image.pixels.iter().filter(|p| p[3] > 0.5).count()
        };
        for colour_by in [
            ColourBy::Fraction,
            ColourBy::Displacement,
            ColourBy::Speed,
            ColourBy::Coordination,
            ColourBy::Plain,
        ] {
            let seen = covered(Walls::Transparent, colour_by);
            assert!(seen > 500, "something is seen by {colour_by:?}, got {seen} pixels");
        }
        let [cut, hidden] = [Walls::Cut, Walls::Hidden].map(|w| covered(w, ColourBy::Plain));
        assert!(cut > 500 && hidden > 500, "{cut} and {hidden} pixels");
    }

    #[test]
    fn colours_that_need_frames_say_so() {
        let run = canned();
        let at = At { stage: 1, frame: 0 };
        let shot = |colour_by| Shot { colour_by, ..small() };
        let said = picture(&run, at, &shot(ColourBy::Speed)).expect_err("no frame before");
        assert!(said.to_string().contains("speed") && said.is_usage(), "{said}");
        picture(&run, at, &shot(ColourBy::Displacement)).expect("since the stage before ended");
    }

    #[test]
    fn numbers_out_of_range_are_refused() {
        let shot = |change: &dyn Fn(&mut Shot)| {
            let mut shot = small();
            change(&mut shot);
            shot.check().map_err(|e| e.to_string())
        };
        assert_eq!(shot(&|_| {}), Ok(()));
        for (change, word) in [
            (&(|s: &mut Shot| s.width = 9000) as &dyn Fn(&mut Shot), "width"),
            (&|s: &mut Shot| s.height = 1, "height"),
            (&|s: &mut Shot| s.view.elevation_deg = 90.0, "elevation"),
            (&|s: &mut Shot| s.view.azimuth_deg = f64::NAN, "azimuth"),
        ] {
            let said = shot(change).expect_err("out of range");
            let option = format!("--{word} is ");
            assert!(said.contains(&option), "law: `{option}` is said, got `{said}`");
        }
        let view = View { azimuth_deg: f64::NAN, elevation_deg: 1e300 };
        let said = shot(&|s: &mut Shot| s.view = view);
        assert_eq!(
            said.expect_err("out of range"),
            "--azimuth is NaN, it must be a number of degrees\n\
             --elevation is 1e300, it must be -89 to 89 degrees",
            "law: all at once, and short"
        );
    }
}
