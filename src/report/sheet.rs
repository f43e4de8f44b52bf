//! The sheet that figures are drawn on, as SVG: lines, dashed ones too, shapes and text. Plotters
//! writes the SVG; it draws only solid lines, and only between whole places.

use plotters::{
    coord::Shift,
    prelude::*,
    style::text_anchor::{HPos, Pos, VPos},
};

use super::style::{self, Dash, INK};
use crate::plain::plain_lines;

/// Whether something could be drawn.
pub type Drawn = Result<(), DrawingAreaErrorKind<std::io::Error>>;
/// A place in SVG units from the upper left corner.
pub type Place = (i32, i32);

/// A white sheet, as wide as figures are.
pub struct Sheet<'a>(DrawingArea<SVGBackend<'a>, Shift>);

/// What is drawn on a sheet of a height in SVG units.
///
/// # Errors
/// A sentence on what plotters could not draw.
pub fn drawn(height: i32, draw: impl FnOnce(&Sheet) -> Drawn) -> Result<String, String> {
    let mut svg = String::new();
    let backend = SVGBackend::with_string(&mut svg, (style::WIDTH, height as u32));
    let sheet = Sheet(backend.into_drawing_area());
    let done = sheet.0.fill(&WHITE).and_then(|()| draw(&sheet)).and_then(|()| sheet.0.present());
    drop(sheet);
    done.map_err(|e| e.to_string())?;
    // Labels hold names; some characters of them no XML file may hold.
    Ok(plain_lines(&svg).into_owned())
}

impl Sheet<'_> {
    /// Draws a solid line through places.
    pub fn path(&self, places: impl Into<Vec<Place>>, colour: RGBColor, width: u32) -> Drawn {
        self.0.draw(&PathElement::<Place>::new(places, colour.stroke_width(width)))
    }

    /// Draws a line in a dash pattern through points.
    pub fn dashed(&self, points: &[(f64, f64)], dash: Dash, colour: RGBColor, width: u32) -> Drawn {
        dashes(points, dash).into_iter().try_for_each(|piece| {
            self.path(piece.into_iter().map(whole).collect::<Vec<Place>>(), colour, width)
        })
    }

    /// Fills a polygon.
    pub fn polygon(&self, corners: impl Into<Vec<Place>>, colour: RGBColor) -> Drawn {
        self.0.draw(&Polygon::<Place>::new(corners, colour.filled()))
    }

    /// Draws or fills a rectangle, given by two opposite corners.
    pub fn rectangle(&self, corners: [Place; 2], style: ShapeStyle) -> Drawn {
        self.0.draw(&Rectangle::new(corners, style))
    }

    /// Draws or fills a circle.
    pub fn circle(&self, centre: Place, radius: i32, style: ShapeStyle) -> Drawn {
        self.0.draw(&Circle::new(centre, radius, style))
    }

    /// Writes a text of a size in SVG units; the anchor says which part of it stands at the place.
    pub fn text(&self, text: &str, at: Place, size: f64, anchor: (HPos, VPos)) -> Drawn {
        self.turned_text(text, at, size, anchor, FontTransform::None)
    }

    /// The same, turned.
    pub fn turned_text(
        &self,
        text: &str,
        at: Place,
        size: f64,
        (across, up): (HPos, VPos),
        turned: FontTransform,
    ) -> Drawn {
        // Plotters writes its own size over 1.24.
        let font = ("sans-serif", size * 1.24).into_font().transform(turned);
        let style = font.color(&INK).pos(Pos::new(across, up));
        self.0.draw(&Text::new(text.to_owned(), at, style))
    }
}

/// The nearest whole place.
pub fn whole((x, y): (f64, f64)) -> Place {
    (x.round() as i32, y.round() as i32)
}

/// Cuts a path into the pieces that a dash pattern leaves of it.
fn dashes(points: &[(f64, f64)], dash: Dash) -> Vec<Vec<(f64, f64)>> {
    if dash.is_empty() || dash.iter().any(|d| *d <= 0.0) {
        return if points.len() > 1 { vec![points.to_vec()] } else { Vec::new() };
    }
    let mut pieces = Vec::new();
    let mut piece: Vec<(f64, f64)> = points.first().copied().into_iter().collect();
    let (mut index, mut left) = (0usize, dash[0]);
    for w in points.windows(2) {
        let (mut a, b) = (w[0], w[1]);
        loop {
            let length = (b.0 - a.0).hypot(b.1 - a.1);
            let drawn = index % 2 == 0;
            if length <= left {
                left -= length;
                if drawn {
                    piece.push(b);
                }
                break;
            }
            let share = left / length;
            let cut = (a.0 + share * (b.0 - a.0), a.1 + share * (b.1 - a.1));
            if drawn {
                piece.push(cut);
                pieces.push(std::mem::take(&mut piece));
            } else {
                piece = vec![cut];
            }
            index += 1;
            left = dash[index % dash.len()];
            a = cut;
        }
    }
    if piece.len() > 1 && index % 2 == 0 {
        pieces.push(piece);
    }
    pieces
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dashes_follow_the_path_round_its_corners() {
        let path = [(0.0, 0.0), (10.0, 0.0), (10.0, 10.0)];
        let got = dashes(&path, &[6.0, 6.0]);
        let expected = vec![vec![(0.0, 0.0), (6.0, 0.0)], vec![(10.0, 2.0), (10.0, 8.0)]];
        assert_eq!(got, expected, "6 on, 6 off along 20 (got left, expected right)");
        assert_eq!(dashes(&path, style::SOLID), vec![path.to_vec()], "solid is one piece");
        assert!(dashes(&[(1.0, 1.0)], style::SOLID).is_empty(), "a point is no line");
        assert!(dashes(&[], &[6.0, 6.0]).is_empty());
    }
}
