//! A run as a moving picture: animated PNG, which browsers and image viewers show.
//!
//! All frames share a palette of 256 colours, and each holds only what has
//! changed since the one before it.

use std::sync::atomic::{AtomicBool, Ordering};

use png::{BitDepth, BlendOp, ColorType, Compression, Encoder};
use rayon::prelude::*;

use super::sheet::sheet;
use super::*;
use crate::protocol::Progress;

/// How a run is shown moving.
#[derive(Debug, Clone, PartialEq)]
pub struct Animation {
    /// Every picture of it.
    pub shot: Shot,
    /// The stage, by number from 0 or name; the whole run if none.
    pub stage: Option<String>,
    /// Simulated time from one frame to the next, in s; frames that were not kept cannot be shown.
    pub every_s: f64,
    /// Frames shown in a second.
    pub frames_per_second: u16,
    /// Largest file, in MB.
    pub limit_mb: f64,
}

/// An animation and how it came out.
#[derive(Debug, Clone, PartialEq)]
pub struct Animated {
    /// The file.
    pub png: Vec<u8>,
    /// Number of frames.
    pub frames: usize,
}

/// Makes an animation; progress tells of frames. It stops soon after `cancel` becomes true.
///
/// # Errors
/// As pictures; and a file that would exceed its limit, judged by three frames
/// before the others are made.
pub fn animate(
    run: &Playback,
    animation: &Animation,
    progress: &dyn Progress,
    cancel: &AtomicBool,
) -> Result<Animated, PictureError> {
    check(animation)?;
    let chosen = chosen(run, animation)?;
    let film = Film::new(run, &chosen, animation)?;
    let ends = [chosen[0], chosen[chosen.len() / 2], chosen[chosen.len() - 1]];
    let first: Vec<Image> = ends.iter().map(|at| film.frame(*at)).collect::<Result<_, _>>()?;
    let palette = Palette::of(&first);
    expect_size(&first, &palette, chosen.len(), animation.limit_mb)?;

    const ID: u64 = 0;
    progress.begin_pieces(ID, "animation", chosen.len());
    let frames = chosen.iter().enumerate().map(|(n, at)| {
        if cancel.load(Ordering::Relaxed) {
            return Err(PictureError::Cancelled);
        }
        let image = film.frame(*at)?;
        progress.update(ID, (n + 1) as f64, &format!("frame {} of {}", n + 1, chosen.len()));
        Ok(palette.indices(&image))
    });
    let size = (animation.shot.width, first[0].height);
    let png = encode(frames, chosen.len(), size, &palette, animation.frames_per_second);
    progress.end_stage(ID);
    Ok(Animated { png: png?, frames: chosen.len() })
}

fn check(animation: &Animation) -> Result<(), PictureError> {
    let Animation { shot, every_s, frames_per_second, limit_mb, .. } = animation;
    let is_time = *every_s > 0.0 && every_s.is_finite();
    let is_rate = (1..=60).contains(frames_per_second);
    let own = [
        fault("every", *every_s, is_time, "a number of seconds above 0"),
        fault("frames-per-second", f64::from(*frames_per_second), is_rate, "1 to 60"),
        fault("limit-mb", *limit_mb, *limit_mb > 0.0, "a number above 0"),
    ];
    refuse(shot.faults().into_iter().chain(own))
}

/// The frames to show: in each interval of `every_s` the first one kept, and the last of all.
fn chosen(run: &Playback, animation: &Animation) -> Result<Vec<At>, PictureError> {
    let only = animation.stage.as_deref().map(|asked| stage_of(run, asked)).transpose()?;
    let all = frames_of(run, only);
    let mut found: Vec<At> = Vec::new();
    let mut due = f64::NEG_INFINITY;
    for &at in &all {
        let time = frame_at(run, at).time;
        // A hair less, for times that are sums of steps.
        if time >= due - 1e-6 {
            found.push(at);
            due = if due.is_finite() { due.max(time - animation.every_s) } else { time };
            due += animation.every_s;
        }
    }
    // A colour that needs a frame before cannot show the first of a stage.
    if animation.shot.colour_by == ColourBy::Speed {
        found.retain(|at| values(&moments(run, *at), ColourBy::Speed).is_ok());
    }
    if let Some(&last) = all.last()
        && found.last().is_some_and(|at| *at != last)
    {
        found.push(last);
    }
    if found.len() < 2 { Err(PictureError::NothingMoves) } else { Ok(found) }
}

/// What all frames share.
struct Film<'a> {
    run: &'a Playback,
    shot: &'a Shot,
    // Within this everything is framed.
    points: Vec<Point>,
    // End of a continuous scale of colours.
    upper: Option<f64>,
}

impl<'a> Film<'a> {
    fn new(
        run: &'a Playback,
        chosen: &[At],
        animation: &'a Animation,
    ) -> Result<Self, PictureError> {
        let shot = &animation.shot;
        let mut points: Vec<Point> = Vec::new();
        let mut upper: Option<f64> = None;
        for at in chosen {
            let (scene, _) = stage_scene(run, *at, shot, upper)?;
            points.extend(outermost(&scene.outline(), shot));
            if matches!(shot.colour_by, ColourBy::Displacement | ColourBy::Speed) {
                let end = upper_end(&values(&moments(run, *at), shot.colour_by)?);
                upper = Some(upper.map_or(end, |upper| upper.max(end)));
            }
        }
        Ok(Self { run, shot, points, upper })
    }

    fn frame(&self, at: At) -> Result<Image, PictureError> {
        let (scene, notes) = stage_scene(self.run, at, self.shot, self.upper)?;
        let panel = expose(&scene, &self.points, self.shot, glass_depth(&self.run.setup));
        let notes = self.shot.notes.then_some(&notes);
        sheet(&[(panel, String::new())], 1, self.shot.width, notes)
    }
}

/// The few points that frame all of them: the outermost in 64 directions across the line of sight.
fn outermost(points: &[Point], shot: &Shot) -> Vec<Point> {
    let [right, up, back] = shot.view.axes();
    let directions = (0..64).flat_map(|n| {
        let angle = std::f64::consts::TAU * f64::from(n) / 64.0;
        // Framing weighs what is nearer up to the tangent of half the angle of view.
        [0.0, 0.1, 0.25].map(|near| angle.cos() * right + angle.sin() * up + near * back)
    });
    let farthest = |d: crate::geometry::Vector| {
        let along = |p: &&Point| d.dot(&p.coords);
        points.iter().max_by(|a, b| along(a).total_cmp(&along(b))).copied()
    };
    directions.filter_map(farthest).collect()
}

/// Number of the colour that leaves a pixel as it was.
const SAME: u8 = 0;
/// Number of white.
const WHITE: u8 = 1;
/// Colours found for the rest.
const FOUND: usize = 254;

/// 256 colours and the nearest of them to any other.
struct Palette {
    colours: Vec<u8>,
    // By the six highest bits of red, green and blue.
    nearest: Vec<u8>,
}

impl Palette {
    fn of(images: &[Image]) -> Self {
        let rgba: Vec<u8> = images
            .iter()
            .flat_map(Image::to_rgb)
            .collect::<Vec<u8>>()
            .chunks_exact(3)
            .filter(|p| *p != [255; 3])
            .flat_map(|p| [p[0], p[1], p[2], 255])
            .collect();
        let mut colours = vec![0, 0, 0, 255, 255, 255];
        // The net learns from every tenth pixel; from next to nothing it learns nothing.
        if rgba.len() > 4 * 5000 {
            colours.extend(color_quant::NeuQuant::new(10, FOUND, &rgba).color_map_rgb());
        } else {
            colours.extend(rgba.chunks_exact(4).take(FOUND).flat_map(|p| [p[0], p[1], p[2]]));
        }
        let count = colours.len() / 3;
        let nearest = (0..1_u32 << 18).into_par_iter().map(|bin| {
            let middle = [12, 6, 0].map(|shift| 4 * (bin >> shift & 63) as i32 + 2);
            let off = |n: &usize| -> i32 {
                (0..3).map(|k| (i32::from(colours[3 * n + k]) - middle[k]).pow(2)).sum()
            };
            (usize::from(WHITE)..count).min_by_key(off).unwrap_or(usize::from(WHITE)) as u8
        });
        let nearest = nearest.collect();
        Self { colours, nearest }
    }

    fn indices(&self, image: &Image) -> Vec<u8> {
        let index = |p: &[u8]| match p {
            [255, 255, 255] => WHITE,
            _ => {
                let bits = |k: usize| usize::from(p[k] >> 2);
                self.nearest[bits(0) << 12 | bits(1) << 6 | bits(2)]
            }
        };
        image.to_rgb().chunks_exact(3).map(index).collect()
    }
}

/// Judges the size of the whole by three of its frames.
fn expect_size(
    images: &[Image],
    palette: &Palette,
    frames: usize,
    limit_mb: f64,
) -> Result<(), PictureError> {
    let mut bytes = 0;
    for image in images {
        let one = std::iter::once(Ok(palette.indices(image)));
        bytes += encode(one, 1, (image.width, image.height), palette, 1)?.len();
    }
    // What stands still is left out of all frames but the first.
    let expected_mb = bytes as f64 / images.len() as f64 * frames as f64 / 1e6;
    if expected_mb > limit_mb {
        return Err(PictureError::TooLarge { expected_mb, frames, allowed_mb: limit_mb });
    }
    Ok(())
}

/// The rectangle in which two frames differ: column, row, width, height.
fn changed(before: &[u8], now: &[u8], columns: usize) -> (usize, usize, usize, usize) {
    let (mut left, mut right, mut top, mut bottom) = (usize::MAX, 0, usize::MAX, 0);
    for (n, _) in before.iter().zip(now).enumerate().filter(|(_, (a, b))| a != b) {
        let (x, y) = (n % columns, n / columns);
        (left, right) = (left.min(x), right.max(x));
        (top, bottom) = (top.min(y), bottom.max(y));
    }
    if left == usize::MAX {
        return (0, 0, 1, 1);
    }
    (left, top, right - left + 1, bottom - top + 1)
}

fn encode(
    frames: impl Iterator<Item = Result<Vec<u8>, PictureError>>,
    count: usize,
    (width, height): (u32, u32),
    palette: &Palette,
    per_second: u16,
) -> Result<Vec<u8>, PictureError> {
    let mut file = Vec::new();
    let mut encoder = Encoder::new(&mut file, width, height);
    encoder.set_color(ColorType::Indexed);
    encoder.set_depth(BitDepth::Eight);
    encoder.set_palette(palette.colours.as_slice());
    encoder.set_trns([0].as_slice());
    encoder.set_compression(Compression::High);
    encoder.set_filter(png::Filter::NoFilter);
    encoder.set_animated(count as u32, 0)?;
    encoder.set_frame_delay(1, per_second)?;
    encoder.set_blend_op(BlendOp::Over)?;
    let mut writer = encoder.write_header()?;
    let columns = width as usize;
    let mut before: Option<Vec<u8>> = None;
    for frame in frames {
        let now = frame?;
        match &before {
            None => writer.write_image_data(&now)?,
            Some(before) => {
                let (x, y, w, h) = changed(before, &now, columns);
                writer.set_frame_position(0, 0)?;
                writer.set_frame_dimension(w as u32, h as u32)?;
                writer.set_frame_position(x as u32, y as u32)?;
                let rows = (y..y + h).flat_map(|row| row * columns + x..row * columns + x + w);
                let part: Vec<u8> =
                    rows.map(|n| if now[n] == before[n] { SAME } else { now[n] }).collect();
                writer.write_image_data(&part)?;
            }
        }
        before = Some(now);
    }
    writer.finish()?;
    Ok(file)
}

#[cfg(test)]
mod tests {
    use super::super::moment::tests::canned;
    use super::*;
    use crate::protocol::Silent;

    fn animation() -> Animation {
        Animation {
            shot: Shot { width: 160, height: 120, ..Shot::default() },
            stage: None,
            every_s: 0.08,
            frames_per_second: 10,
            limit_mb: 5.0,
        }
    }

    fn going_on() -> AtomicBool {
        AtomicBool::new(false)
    }

    /// Law: an animation that is stopped is none.
    #[test]
    fn an_animation_is_stopped() {
        let stopped = AtomicBool::new(true);
        let made = animate(&canned(), &animation(), &Silent, &stopped);
        let is_stopped = matches!(made, Err(PictureError::Cancelled));
        assert!(is_stopped, "law: expected that it was stopped, got {:?}", made.map(|a| a.frames));
    }

    #[test]
    fn an_animation_plays_every_frame() {
        let run = canned();
        let made = animate(&run, &animation(), &Silent, &going_on()).expect("an animation");
        assert_eq!(made.frames, 5, "law: four frames of one stage, the end of the other");
        let decoder = png::Decoder::new(std::io::Cursor::new(&made.png));
        let mut reader = decoder.read_info().expect("a PNG");
        let control = reader.info().animation_control().expect("animated");
        assert_eq!((control.num_frames, control.num_plays), (5, 0), "law: for ever");
        let mut bytes = vec![0; reader.output_buffer_size().expect("a size")];
        for n in 0..5 {
            reader.next_frame(&mut bytes).unwrap_or_else(|e| panic!("frame {n}: {e}"));
            let control = reader.info().frame_control().expect("a frame");
            assert_eq!((control.delay_num, control.delay_den), (1, 10), "law: 10 a second");
        }
    }

    #[test]
    fn frames_are_taken_as_often_as_asked() {
        let run = canned();
        let count = |every_s, stage: Option<&str>| {
            let stage = stage.map(str::to_owned);
            chosen(&run, &Animation { every_s, stage, ..animation() }).map(|c| c.len())
        };
        assert_eq!(count(0.16, Some("0")).expect("frames"), 3, "0, 0.16 and the last, 0.24");
        assert_eq!(count(0.08, Some("fill_funnel")).expect("frames"), 4);
        assert_eq!(count(10.0, None).expect("frames"), 2, "law: first and last at least");
        let still = count(0.08, Some("pour")).expect_err("one frame does not move");
        assert!(matches!(still, PictureError::NothingMoves), "{still}");
    }

    #[test]
    fn too_large_is_said_before_the_work() {
        let tiny = Animation { limit_mb: 1e-3, ..animation() };
        let error =
            animate(&canned(), &tiny, &Silent, &going_on()).expect_err("a kilobyte is too little");
        let said = error.to_string();
        assert!(said.contains("--every") && said.contains("5 frames"), "{said}");
        for wrong in [
            Animation { every_s: 0.0, ..animation() },
            Animation { frames_per_second: 0, ..animation() },
            Animation { limit_mb: f64::NAN, ..animation() },
        ] {
            let error = animate(&canned(), &wrong, &Silent, &going_on()).expect_err("out of range");
            assert!(matches!(error, PictureError::Range(_)), "{error}");
        }
        let wrong = Animation {
            every_s: -1.0,
            limit_mb: 0.0,
            shot: Shot { height: 1, ..animation().shot },
            ..animation()
        };
        let said =
            animate(&canned(), &wrong, &Silent, &going_on()).expect_err("out of range").to_string();
        for option in ["--height is 1,", "--every is -1,", "--limit-mb is 0,"] {
            assert!(said.contains(option), "law: all at once, `{option}` is missing in `{said}`");
        }
    }

    #[test]
    fn only_what_changed_is_kept() {
        let before = [1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1];
        let mut now = before;
        assert_eq!(changed(&before, &now, 4), (0, 0, 1, 1), "law: a dot when nothing changed");
        (now[5], now[10]) = (2, 3);
        assert_eq!(changed(&before, &now, 4), (1, 1, 2, 2), "law: from (1, 1) to (2, 2)");
    }
}
