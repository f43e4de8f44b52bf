//! Pictures side by side, with letters, colour key and notes.

use std::fmt::Write;

use super::*;
use crate::plain::without_zeros;
use crate::report::draw_svg;

/// Share of the width of a sheet that the key takes.
const KEY_SHARE: f64 = 0.215;
/// Size of text by the width of the key's column.
const TEXT: f64 = 0.076;
/// Mean width of a letter by its size; wide rather than narrow.
const LETTER: f64 = 0.6;

/// Most letters of a line at the foot; more would have to be too small to be read.
const LETTERS: usize = 28;
/// Most lines that one of them is wrapped to.
const MOST_LINES: usize = 4;

/// What stands beside a picture.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Notes {
    /// The colours.
    pub key: Key,
    /// More colours, of things that are no grains.
    pub things: Vec<(Colour, String)>,
    /// Lines at the foot.
    pub lines: Vec<String>,
}

/// Width of the picture itself on a sheet of a width; all of it without notes.
pub fn picture_width(width: u32, notes: bool) -> u32 {
    if notes { width - (KEY_SHARE * f64::from(width)) as u32 } else { width }
}

/// Panels of one size in rows, named by letters where there are names,
/// with notes on the right.
pub fn sheet(
    panels: &[(Image, String)],
    columns: u32,
    width: u32,
    notes: Option<&Notes>,
) -> Result<Image, PictureError> {
    let Some((first, _)) = panels.first() else { return Ok(Image::clear(width.max(1), 1)) };
    let rows = (panels.len() as u32).div_ceil(columns);
    let size = TEXT * KEY_SHARE * f64::from(width);
    let named = panels.iter().any(|(_, name)| !name.is_empty());
    let name_height = if named { (2.2 * size) as u32 } else { 0 };
    let height = rows * (first.height + name_height);
    let mut out = Image::clear(width, height);
    let mut svg = format!(
        r#"<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" font-family="sans-serif" fill="{INK}">"#
    );
    for (n, (panel, name)) in panels.iter().enumerate() {
        let n = n as u32;
        let (x, y) = (n % columns * first.width, n / columns * (first.height + name_height));
        out.lay(panel, x, y);
        let middle = f64::from(x) + f64::from(first.width) / 2.0;
        text(&mut svg, middle, f64::from(y + first.height) + 1.4 * size, size, "middle", name);
    }
    if let Some(notes) = notes {
        let left = f64::from(picture_width(width, true));
        column(&mut svg, notes, left, f64::from(width) - left, f64::from(height));
    }
    svg.push_str("</svg>");
    let (w, h, bytes) = draw_svg(&svg).map_err(PictureError::Drawing)?;
    out.lay(&Image::from_rgba(w, h, &bytes), 0, 0);
    Ok(out)
}

const INK: &str = "#191919";
const SOFT: &str = "#5a6068";

fn text(svg: &mut String, x: f64, y: f64, size: f64, anchor: &str, words: &str) {
    let words = words.replace('&', "&amp;").replace('<', "&lt;");
    // Writing into a string cannot fail.
    let _ = write!(
        svg,
        r#"<text x="{x:.1}" y="{y:.1}" font-size="{size:.1}" text-anchor="{anchor}">{words}</text>"#
    );
}

fn swatch(svg: &mut String, x: f64, y: f64, side: f64, colour: Colour) {
    let fill = colour.to_hex();
    let _ = write!(
        svg,
        r##"<rect x="{x:.1}" y="{y:.1}" width="{side:.1}" height="{side:.1}" rx="{:.1}" fill="{fill}" stroke="{SOFT}" stroke-width="1"/>"##,
        side / 8.0
    );
}

/// The column of notes.
fn column(svg: &mut String, notes: &Notes, left: f64, width: f64, height: f64) {
    // No taller than the sheet: title, steps, things and lines in rows.
    let key = &notes.key;
    let bar_rows = if key.upper.is_some() { 9.0 } else { 0.0 };
    let lines: Vec<String> = notes.lines.iter().flat_map(|line| wrapped(line)).collect();
    let rows = key.title.len() + key.steps.len() + notes.things.len() + lines.len();
    let room = height / (1.75 * (rows as f64 + bar_rows + 4.0));
    let size = (TEXT * width).min(room);
    let (x, line) = (left + 0.06 * width, 1.55 * size);
    let mut y = 2.0 * line;
    for title in &key.title {
        text(svg, x, y, fitting(title, 1.02 * size, width), "start", title);
        y += line;
    }
    y += 0.3 * line;
    if let Some(upper) = key.upper {
        bar(svg, x, y - 0.6 * line, 8.0 * line, size, upper, key.beyond);
        y += 9.0 * line;
    }
    for (colour, name) in key.steps.iter().chain(&notes.things) {
        swatch(svg, x, y - 0.95 * size, 1.15 * size, *colour);
        let name_size = fitting(name, size, width - 1.8 * size);
        text(svg, x + 1.8 * size, y, name_size, "start", name);
        y += line;
    }
    let mut y = height - line * (lines.len() as f64 - 0.2);
    svg.push_str(&format!(r#"<g fill="{SOFT}">"#));
    for words in &lines {
        text(svg, x, y, fitting(words, 0.86 * size, width), "start", words);
        y += line;
    }
    svg.push_str("</g>");
}

/// A line at the foot in pieces that can be read, parted at a space or a dash where there is one; what
/// is left of a very long one is cut off.
fn wrapped(line: &str) -> Vec<String> {
    let mut pieces = Vec::new();
    let mut rest: Vec<char> = line.chars().collect();
    while rest.len() > LETTERS && pieces.len() + 1 < MOST_LINES {
        let parts = rest[..LETTERS].iter().rposition(|c| " -_/".contains(*c));
        let end = parts.filter(|at| *at >= LETTERS / 2).map_or(LETTERS, |at| at + 1);
        let piece: String = rest.drain(..end).collect();
        pieces.push(piece.trim_end().to_owned());
    }
    if rest.len() > LETTERS {
        rest.truncate(LETTERS - 1);
        rest.push('…');
    }
    pieces.push(rest.into_iter().collect());
    pieces
}

/// A size at which a text fits into a width, at most the given one.
fn fitting(words: &str, size: f64, width: f64) -> f64 {
    let letters = words.chars().count().max(1) as f64;
    size.min(0.92 * width / (LETTER * letters))
}

/// What stands at a tick of a scale whose ticks are a step apart: three decimals, or as many as
/// tell two ticks apart.
fn tick(value: f64, step: f64) -> String {
    const MOST: f64 = 7.0;
    let decimals = (-step.log10().floor()).max(3.0);
    if decimals > MOST && value != 0.0 {
        return format!("{value:.1e}");
    }
    let decimals = decimals.min(MOST) as usize;
    without_zeros(&format!("{value:.decimals$}")).to_owned()
}

/// A continuous scale from 0 at the foot to its upper end.
fn bar(svg: &mut String, x: f64, y: f64, height: f64, size: f64, upper: f64, beyond: bool) {
    const STOPS: u32 = 32;
    let width = 1.3 * size;
    svg.push_str(r#"<linearGradient id="scale" x1="0" y1="1" x2="0" y2="0">"#);
    for n in 0..=STOPS {
        let share = f64::from(n) / f64::from(STOPS);
        let colour = scale(share).to_hex();
        let _ = write!(svg, r#"<stop offset="{share:.4}" stop-color="{colour}"/>"#);
    }
    let _ = write!(
        svg,
        r##"</linearGradient><rect x="{x:.1}" y="{y:.1}" width="{width:.1}" height="{height:.1}" fill="url(#scale)"/>"##
    );
    const TICKS: u32 = 5;
    for n in 0..=TICKS {
        let share = f64::from(n) / f64::from(TICKS);
        let at = y + height * (1.0 - share);
        let _ = write!(
            svg,
            r#"<path d="M{:.1} {at:.1}h{:.1}" stroke="{INK}" stroke-width="1.5"/>"#,
            x + width,
            0.4 * size
        );
        let more = if n == TICKS && beyond { "≥ " } else { "" };
        let words = format!("{more}{}", tick(share * upper, upper / f64::from(TICKS)));
        text(svg, x + width + 0.7 * size, at + 0.35 * size, size, "start", &words);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn dark(image: &Image, columns: std::ops::Range<u32>) -> usize {
        let pixel = |(n, p): (usize, &[f32; 4])| {
            columns.contains(&(n as u32 % image.width)) && p[3] > 0.5 && p[1] < 0.3
        };
        image.pixels.iter().enumerate().filter(|&p| pixel(p)).count()
    }

    #[test]
    fn panels_stand_in_rows_and_notes_beside_them() {
        let width = 400;
        let left = picture_width(width, true);
        let panel = || (Image::clear(left / 2, 100), "(a) before".to_owned());
        let key = Key {
            title: vec!["Speed <b> & more".to_owned()],
            upper: Some(2.5),
            beyond: true,
            ..Key::default()
        };
        let notes = Notes { key, lines: vec!["t = 1 s".to_owned()], ..Notes::default() };
        let got = sheet(&[panel(), panel(), panel()], 2, width, Some(&notes)).expect("a sheet");
        assert_eq!(got.width, width);
        assert!(got.height > 200 && got.height < 260, "two rows with names, got {}", got.height);
        assert!(dark(&got, 0..left) > 20, "names are drawn");
        assert!(dark(&got, left..width) > 40, "the key is drawn");
        let bare = sheet(&[(Image::clear(width, 50), String::new())], 1, width, None);
        let bare = bare.expect("a sheet");
        assert_eq!((bare.width, bare.height, dark(&bare, 0..width)), (400, 50, 0), "no notes");
    }

    /// Law: no two ticks of a scale read alike, however small it is: displacements in a rest test are
    /// micrometres.
    #[test]
    fn ticks_of_a_scale_differ() {
        for upper in [2.5e4, 20.0, 2.5, 0.05, 0.0025, 2e-4, 1e-6, 2.5e-9] {
            let all: Vec<String> =
                (0..=5).map(|n| tick(f64::from(n) / 5.0 * upper, upper / 5.0)).collect();
            let told: std::collections::BTreeSet<&String> = all.iter().collect();
            assert_eq!(told.len(), all.len(), "law: up to {upper}, got {all:?}");
            for (n, words) in all.iter().enumerate() {
                let expected = n as f64 / 5.0 * upper;
                let got: f64 = words.parse().expect("a number");
                let off = (got - expected).abs();
                assert!(off <= 1e-9 * upper, "law: expected {expected}, got {got}, {all:?}");
            }
        }
        assert_eq!([16.0, 0.5].map(|v| tick(v, 4.0)), ["16", "0.5"], "law: no needless zeros");
    }

    /// Law: a long name stands in lines that can be read, no letter of it lost; only a very long one is
    /// cut off.
    #[test]
    fn long_lines_are_wrapped() {
        assert_eq!(wrapped("quick-vibration"), ["quick-vibration"], "law: a short one stays");
        let name = "gravel-of-the-northern-quarry-second-sample-with-a-long-name";
        let pieces = wrapped(name);
        let expected = ["gravel-of-the-northern-", "quarry-second-sample-with-a-", "long-name"];
        assert_eq!(pieces, expected, "law: parted at dashes");
        let endless = wrapped(&"a".repeat(500));
        assert_eq!(endless.len(), MOST_LINES, "law: no more lines than there is room for");
        assert!(endless.iter().all(|piece| piece.chars().count() <= LETTERS), "{endless:?}");
        assert!(endless[MOST_LINES - 1].ends_with('…'), "law: what is cut off is marked");
    }

    #[test]
    fn long_words_get_smaller() {
        assert_eq!(fitting("ab", 10.0, 100.0), 10.0);
        let small = fitting("a very long line of words", 10.0, 100.0);
        assert!(small * LETTER * 25.0 <= 100.0, "law: it fits, got {small}");
    }
}
