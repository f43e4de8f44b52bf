//! How figures look: a journal's style, white ground, thin axes, curves that
//! can be told apart without colour.

use plotters::style::RGBColor;

/// Width of a figure in SVG units, and of its PNG in pixels. The engine of the
/// SVG rounds to whole units; at this size a unit is a third of a point in a
/// printed column.
pub const WIDTH: u32 = 2000;
/// Height of the plotted frame.
pub const FRAME_HEIGHT: u32 = 1060;
/// Least space left of the frame, for numbers and the vertical axis' name.
pub const LEFT: i32 = 210;
/// Space that the vertical axis' name takes.
pub const UPRIGHT_NAME: i32 = 70;
/// Space right of the frame.
pub const RIGHT: i32 = 50;
/// Space above the frame.
pub const TOP: i32 = 50;
/// Space below the frame for numbers and the horizontal axis' name.
pub const BELOW: i32 = 170;

/// Size of numbers, in SVG units.
pub const NUMBERS: f64 = 44.0;
/// Size of axis names.
pub const NAMES: f64 = 48.0;
/// Least size of names that stand in the place of numbers.
pub const LEAST: f64 = 20.0;
/// Width of axes and ticks.
pub const THIN: u32 = 3;
/// Width of curves.
pub const CURVE: u32 = 6;
/// Length of a tick.
pub const TICK: i32 = 16;
/// Half the size of a marker.
pub const MARKER: i32 = 15;
/// The same on thin curves.
pub const SMALL_MARKER: i32 = 10;
/// Distance of markers along a curve of many points.
pub const MARKER_SPACING: f64 = 170.0;

/// Axes, text.
pub const INK: RGBColor = RGBColor(25, 25, 25);
/// Grid lines.
pub const GRID: RGBColor = RGBColor(228, 228, 228);
/// Ground of a laboratory band.
pub const BAND: RGBColor = RGBColor(222, 222, 222);
/// Hatching of a laboratory band.
pub const HATCH: RGBColor = RGBColor(150, 150, 150);
/// Ground of the area between the lowest and the highest of several curves.
pub const ENVELOPE: RGBColor = RGBColor(198, 222, 238);
/// Lines of limits and of events.
pub const LIMIT: RGBColor = RGBColor(110, 110, 110);

/// Colours that colour-blind readers tell apart, after Okabe & Ito (2008); brown in the place of their
/// orange, which is their vermilion to one who sees no green, and too pale for thin lines.
const COLOURS: [RGBColor; 6] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 130, 95),
    RGBColor(170, 70, 130),
    RGBColor(0, 0, 0),
    RGBColor(110, 75, 0),
];

/// The colour of the n-th curve, counted from 0.
pub fn colour(n: usize) -> RGBColor {
    COLOURS[n % COLOURS.len()]
}

/// The shape of the n-th curve's markers. Where colours begin anew, markers go
/// on by one, so that no two of 36 curves look alike.
pub fn marker(n: usize) -> Marker {
    const MARKERS: [Marker; 6] = [
        Marker::Disc,
        Marker::Square,
        Marker::Triangle,
        Marker::Diamond,
        Marker::Cross,
        Marker::Ring,
    ];
    MARKERS[(n + n / MARKERS.len()) % MARKERS.len()]
}

/// Shape of a marker.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Marker {
    /// Filled circle.
    Disc,
    /// Filled square.
    Square,
    /// Filled triangle.
    Triangle,
    /// Filled square on its corner.
    Diamond,
    /// Two lines.
    Cross,
    /// Open circle.
    Ring,
}

/// Dash pattern of a curve: lengths drawn and left out, in SVG units; empty is solid.
pub type Dash = &'static [f64];
/// A line without gaps.
pub const SOLID: Dash = &[];
/// For what goes with a solid curve.
pub const DASHED: Dash = &[28.0, 18.0];
/// For limits.
pub const DOTTED: Dash = &[6.0, 12.0];
/// For limits beside dotted ones.
pub const DASH_DOTTED: Dash = &[28.0, 12.0, 6.0, 12.0];

/// Width of a text in SVG units. Estimated for DejaVu Sans, whose mean
/// character is 0.6 of its size; wide rather than narrow.
pub fn text_width(text: &str, size: f64) -> f64 {
    0.6 * size * text.chars().count() as f64
}

/// A text in lines that fit into a length in SVG units: parted between words, and within those that
/// are longer.
pub fn wrapped(text: &str, size: f64, room: f64) -> Vec<String> {
    let most = ((room / text_width("x", size)) as usize).max(1);
    let length = |text: &str| text.chars().count();
    if length(text) <= most {
        return vec![text.to_owned()];
    }
    let mut lines: Vec<String> = Vec::new();
    for word in text.split(' ') {
        let letters: Vec<char> = word.chars().collect();
        for (n, piece) in letters.chunks(most).enumerate() {
            let piece: String = piece.iter().collect();
            let fits = |line: &String| n == 0 && length(line) + 1 + length(&piece) <= most;
            if lines.last().is_some_and(fits)
                && let Some(line) = lines.last_mut()
            {
                line.push(' ');
                line.push_str(&piece);
            } else {
                lines.push(piece);
            }
        }
    }
    lines
}

/// The size at which a text fits into a length in SVG units, at most the given one. What would fit in
/// common letters keeps it; what is made smaller has room for wide ones.
pub fn fitting(text: &str, size: f64, room: f64) -> f64 {
    // Mean width of words by their size.
    const COMMON: f64 = 0.54;
    if COMMON * size * text.chars().count() as f64 <= room {
        size
    } else {
        size.min((room / text_width(text, 1.0)).floor())
    }
}

#[cfg(test)]
mod tests {
    use super::{COLOURS, NAMES, RGBColor, colour, fitting, marker, text_width, wrapped};

    /// Law: a text that fits is one line; of a longer one every line fits, and no letter is lost.
    #[test]
    fn long_texts_are_parted_into_lines() {
        let room = text_width("abcdefgh", NAMES);
        for (text, expected) in [
            ("ab  cd", &["ab  cd"][..]),
            ("abcd efg", &["abcd efg"]),
            ("abcd efgh ij", &["abcd", "efgh ij"]),
            ("a bcdefghijkl m", &["a", "bcdefghi", "jkl m"]),
            ("", &[""]),
        ] {
            let got = wrapped(text, NAMES, room);
            assert_eq!(got, expected, "law: the lines of `{text}` (got left, expected right)");
        }
    }

    /// Law: a text that fits keeps its size, a longer one is made to fit.
    #[test]
    fn long_texts_get_smaller() {
        let usual = "Angle of repose (degrees)";
        assert_eq!(fitting(usual, NAMES, 660.0), NAMES, "law: `{usual}` fits into a panel");
        let long = "Void ratio of lower-half-of-the-box";
        let size = fitting(long, NAMES, 660.0);
        let got = text_width(long, size);
        assert!(got <= 660.0 && got > 600.0, "law: `{long}` fills 660, got {got} at {size}");
    }

    /// What eyes without the pigment for long waves, and those without that for middle ones, make of
    /// linear intensities (Machado, Oliveira & Fernandes 2009).
    const WITHOUT_RED: [[f64; 3]; 3] = [
        [0.152_286, 1.052_583, -0.204_868],
        [0.114_503, 0.786_281, 0.099_216],
        [-0.003_882, -0.048_116, 1.051_998],
    ];
    const WITHOUT_GREEN: [[f64; 3]; 3] = [
        [0.367_322, 0.860_646, -0.227_968],
        [0.280_085, 0.672_501, 0.047_413],
        [-0.011_820, 0.042_940, 0.968_881],
    ];
    /// From linear intensities to CIE XYZ over those of white (IEC 61966-2-1).
    const TO_XYZ: [[f64; 3]; 3] =
        [[0.4339, 0.3763, 0.1899], [0.2126, 0.7152, 0.0722], [0.0177, 0.1095, 0.8728]];

    fn times(matrix: [[f64; 3]; 3], v: [f64; 3]) -> [f64; 3] {
        matrix.map(|row| row.iter().zip(v).map(|(a, b)| a * b).sum())
    }

    /// A colour in CIELAB, where distances are those that the eye sees.
    fn seen(colour: RGBColor, eye: [[f64; 3]; 3]) -> [f64; 3] {
        let linear = [colour.0, colour.1, colour.2].map(|byte| {
            let c = f64::from(byte) / 255.0;
            if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
        });
        let [x, y, z] = times(TO_XYZ, times(eye, linear)).map(|share| {
            if share > 0.008_856 { share.cbrt() } else { 7.787 * share + 16.0 / 116.0 }
        });
        [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
    }

    /// Law: no two colours look alike to those who see no red or no green; a just noticeable difference
    /// is about 2.
    #[test]
    fn colour_blind_readers_tell_curves_apart() {
        for (name, eye) in [("red", WITHOUT_RED), ("green", WITHOUT_GREEN)] {
            for (a, b) in (0..COLOURS.len()).flat_map(|a| (0..a).map(move |b| (a, b))) {
                let [p, q] = [a, b].map(|n| seen(colour(n), eye));
                let apart = p.iter().zip(q).map(|(p, q)| (p - q).powi(2)).sum::<f64>().sqrt();
                assert!(apart > 15.0, "law: without {name}, {a} and {b} 15 apart, got {apart:.1}");
            }
        }
    }

    #[test]
    fn no_two_of_many_curves_look_alike() {
        let look = |n: usize| {
            let c = colour(n);
            ((c.0, c.1, c.2), marker(n))
        };
        for (a, b) in (0..36).flat_map(|a| (0..a).map(move |b| (a, b))) {
            assert_ne!(look(a), look(b), "law: curves {a} and {b} differ in colour or marker");
        }
    }
}
