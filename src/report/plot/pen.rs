//! Draws a plot: bands and areas first, then axes, curves, and the legend below.

use plotters::{
    coord::Shift,
    prelude::*,
    style::text_anchor::{HPos, Pos, VPos},
};

use super::{Look, Plot, Series};
use crate::report::{
    axis::Scale,
    dash::dashes,
    style::{self, Dash, INK, Marker},
};

/// Why an SVG could not be drawn.
pub(in crate::report) type Failure = DrawingAreaErrorKind<std::io::Error>;
pub(in crate::report) type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;

impl Plot {
    pub(super) fn draw(&self, svg: &mut String) -> Result<(), Failure> {
        let (x, y) = self.scales();
        let names = self.y_names.clone();
        let y_numbers = names.unwrap_or_else(|| y.ticks.iter().map(|t| y.number(*t)).collect());
        let width = |number: &String| style::text_width(number, style::NUMBERS);
        let widest = y_numbers.iter().map(width).fold(0.0, f64::max);
        // How far the number of a tick at the right end reaches over it.
        let at_end = x.ticks.iter().filter(|t| x.place(**t).is_some_and(|place| place > 0.98));
        let over = at_end.map(|t| (width(&x.number(*t)) / 2.0) as i32 + 10).max().unwrap_or(0);
        let name = if self.y.name.is_empty() { 0 } else { style::UPRIGHT_NAME };
        let left = (widest as i32 + name + 50).max(style::LEFT);
        let frame = Frame {
            left,
            right: style::WIDTH as i32 - over.max(style::RIGHT),
            top: style::TOP,
            bottom: style::TOP + self.frame_height as i32,
        };
        let rows = self.legend_rows();
        let legend_top = frame.bottom + style::BELOW;
        let height = legend_top + rows.len() as i32 * LEGEND_ROW + 20;
        let root = SVGBackend::with_string(svg, (style::WIDTH, height as u32)).into_drawing_area();
        root.fill(&WHITE)?;
        let pen = Pen { root: &root, frame, plot: self, x, y, y_numbers };
        pen.bands()?;
        pen.envelopes()?;
        pen.grid()?;
        pen.marks()?;
        pen.axes()?;
        for series in &self.series {
            pen.series(series)?;
        }
        pen.legend(&rows, legend_top)?;
        root.present()?;
        Ok(())
    }

    /// Legend entries, wrapped to the width of the figure.
    fn legend_rows(&self) -> Vec<Vec<Entry<'_>>> {
        let bands = self.bands.iter().map(|b| Entry { label: &b.label, key: Key::Band });
        let areas = self.envelopes.iter().map(|e| Entry { label: &e.label, key: Key::Envelope });
        let marks = self.marks.iter().map(|m| Entry { label: &m.label, key: Key::Mark });
        let series = self.series.iter().map(|s| Entry { label: &s.label, key: Key::Look(s.look) });
        let mut rows: Vec<Vec<Entry>> = Vec::new();
        let mut used = f64::INFINITY;
        for entry in series.chain(areas).chain(bands).chain(marks).filter(|e| !e.label.is_empty()) {
            let width = entry.width();
            if used + width > f64::from(style::WIDTH - 2 * LEGEND_SIDE) {
                rows.push(Vec::new());
                used = 0.0;
            }
            used += width;
            if let Some(row) = rows.last_mut() {
                row.push(entry);
            }
        }
        rows
    }
}

const LEGEND_ROW: i32 = 66;
const LEGEND_SIDE: u32 = 60;
const KEY_WIDTH: i32 = 110;
const KEY_GAP: i32 = 20;
const ENTRY_GAP: f64 = 50.0;

struct Entry<'a> {
    label: &'a str,
    key: Key,
}

enum Key {
    Look(Look),
    Band,
    Envelope,
    Mark,
}

impl Entry<'_> {
    fn width(&self) -> f64 {
        f64::from(KEY_WIDTH + KEY_GAP) + style::text_width(self.label, style::NUMBERS) + ENTRY_GAP
    }
}

#[derive(Clone, Copy)]
struct Frame {
    left: i32,
    right: i32,
    top: i32,
    bottom: i32,
}

struct Pen<'a, 'b> {
    root: &'a Area<'b>,
    frame: Frame,
    plot: &'a Plot,
    x: Scale,
    y: Scale,
    /// What stands at each tick of the vertical axis.
    y_numbers: Vec<String>,
}

impl Pen<'_, '_> {
    fn x(&self, value: f64) -> Option<f64> {
        let Frame { left, right, .. } = self.frame;
        let place = self.x.place(value)?.clamp(-9.0, 9.0);
        Some(f64::from(left) + place * f64::from(right - left))
    }

    fn y(&self, value: f64) -> Option<f64> {
        let Frame { top, bottom, .. } = self.frame;
        let place = self.y.place(value)?.clamp(-9.0, 9.0);
        Some(f64::from(bottom) - place * f64::from(bottom - top))
    }

    fn line(
        &self,
        from: (i32, i32),
        to: (i32, i32),
        colour: RGBColor,
        width: u32,
    ) -> Result<(), Failure> {
        self.root.draw(&PathElement::new(vec![from, to], colour.stroke_width(width)))
    }

    fn text(
        &self,
        text: &str,
        at: (i32, i32),
        size: f64,
        anchor: (HPos, VPos),
    ) -> Result<(), Failure> {
        self.root.draw(&Text::new(text.to_owned(), at, font(size, anchor, FontTransform::None)))
    }

    fn grid(&self) -> Result<(), Failure> {
        let Frame { left, right, top, bottom } = self.frame;
        for x in self.x.ticks.iter().filter_map(|t| self.x(*t)) {
            self.line((x as i32, top), (x as i32, bottom), style::GRID, 2)?;
        }
        for y in self.y.ticks.iter().filter_map(|t| self.y(*t)) {
            self.line((left, y as i32), (right, y as i32), style::GRID, 2)?;
        }
        Ok(())
    }

    fn marks(&self) -> Result<(), Failure> {
        let Frame { left, right, top, bottom } = self.frame;
        for mark in &self.plot.marks {
            let ends = if mark.upright {
                self.x(mark.at).map(|x| [(x, f64::from(top)), (x, f64::from(bottom))])
            } else {
                self.y(mark.at).map(|y| [(f64::from(left), y), (f64::from(right), y)])
            };
            if let Some(ends) = ends {
                self.dashed(&ends, style::DOTTED, style::LIMIT.stroke_width(4))?;
            }
        }
        Ok(())
    }

    fn axes(&self) -> Result<(), Failure> {
        let Frame { left, right, top, bottom } = self.frame;
        let frame = Rectangle::new([(left, top), (right, bottom)], INK.stroke_width(style::THIN));
        self.root.draw(&frame)?;
        for x in self.x.minor.iter().filter_map(|t| self.x(*t)) {
            let x = x as i32;
            self.line((x, bottom), (x, bottom - style::TICK / 2), INK, style::THIN)?;
        }
        for y in self.y.minor.iter().filter_map(|t| self.y(*t)) {
            self.line((left, y as i32), (left + style::TICK / 2, y as i32), INK, style::THIN)?;
        }
        for tick in &self.x.ticks {
            let Some(x) = self.x(*tick) else { continue };
            let x = x as i32;
            self.line((x, bottom), (x, bottom - style::TICK), INK, style::THIN)?;
            let number = self.x.number(*tick);
            self.text(&number, (x, bottom + 18), style::NUMBERS, (HPos::Center, VPos::Top))?;
        }
        for (tick, number) in self.y.ticks.iter().zip(&self.y_numbers) {
            let Some(y) = self.y(*tick) else { continue };
            let y = y as i32;
            self.line((left, y), (left + style::TICK, y), INK, style::THIN)?;
            self.text(number, (left - 20, y), style::NUMBERS, (HPos::Right, VPos::Center))?;
        }
        let middle = ((left + right) / 2, bottom + 92);
        self.text(&self.plot.x.name, middle, style::NAMES, (HPos::Center, VPos::Top))?;
        let upright = font(style::NAMES, (HPos::Center, VPos::Top), FontTransform::Rotate270);
        let at = (28, (top + bottom) / 2);
        self.root.draw(&Text::new(self.plot.y.name.clone(), at, upright))
    }

    fn series(&self, series: &Series) -> Result<(), Failure> {
        let points: Vec<(f64, f64)> =
            series.points.iter().filter_map(|&(x, y)| Some((self.x(x)?, self.y(y)?))).collect();
        self.look(&series.look, &points)
    }

    fn look(&self, look: &Look, points: &[(f64, f64)]) -> Result<(), Failure> {
        if let Some(dash) = look.line {
            self.dashed(points, dash, look.colour.stroke_width(look.width))?;
        }
        let Some(marker) = look.marker else { return Ok(()) };
        // Curves begin in one point; their markers do not.
        let first = points.first().zip(look.marker_spacing).map(|(p, spacing)| p.0 + 0.5 * spacing);
        let mut next = first.unwrap_or(f64::NEG_INFINITY);
        for &(x, y) in points {
            if x >= next {
                next = look.marker_spacing.map_or(f64::NEG_INFINITY, |spacing| x + spacing);
                self.marker(marker, whole((x, y)), look)?;
            }
        }
        Ok(())
    }

    fn dashed(&self, points: &[(f64, f64)], dash: Dash, stroke: ShapeStyle) -> Result<(), Failure> {
        for piece in dashes(points, dash) {
            let path: Vec<(i32, i32)> = piece.into_iter().map(whole).collect();
            self.root.draw(&PathElement::new(path, stroke))?;
        }
        Ok(())
    }

    fn marker(&self, marker: Marker, (x, y): (i32, i32), look: &Look) -> Result<(), Failure> {
        let colour = look.colour;
        // Thin curves have small markers.
        let r = if look.width > style::THIN { style::MARKER } else { style::SMALL_MARKER };
        let polygon =
            |points: Vec<(i32, i32)>| self.root.draw(&Polygon::new(points, colour.filled()));
        match marker {
            Marker::Disc => self.root.draw(&Circle::new((x, y), r, colour.filled())),
            Marker::Ring => {
                self.root.draw(&Circle::new((x, y), r, WHITE.filled()))?;
                self.root.draw(&Circle::new((x, y), r, colour.stroke_width(5)))
            }
            Marker::Square => {
                polygon(vec![(x - r, y - r), (x + r, y - r), (x + r, y + r), (x - r, y + r)])
            }
            Marker::Triangle => {
                polygon(vec![(x, y - r * 5 / 4), (x + r * 6 / 5, y + r), (x - r * 6 / 5, y + r)])
            }
            Marker::Diamond => {
                let d = r * 7 / 5;
                polygon(vec![(x, y - d), (x + d, y), (x, y + d), (x - d, y)])
            }
            Marker::Cross => {
                self.line((x - r, y - r), (x + r, y + r), colour, 6)?;
                self.line((x - r, y + r), (x + r, y - r), colour, 6)
            }
        }
    }

    fn legend(&self, rows: &[Vec<Entry>], top: i32) -> Result<(), Failure> {
        for (i, row) in rows.iter().enumerate() {
            let y = top + i as i32 * LEGEND_ROW + LEGEND_ROW / 2;
            let mut x = LEGEND_SIDE as i32;
            for entry in row {
                let (from, to) = (f64::from(x), f64::from(x + KEY_WIDTH));
                let y0 = f64::from(y);
                match entry.key {
                    Key::Band => self.hatched((x, y - 18), (x + KEY_WIDTH, y + 18))?,
                    Key::Envelope => {
                        let corners = [(x, y - 18), (x + KEY_WIDTH, y + 18)];
                        self.root.draw(&Rectangle::new(corners, style::ENVELOPE.filled()))?;
                    }
                    Key::Mark => {
                        let stroke = style::LIMIT.stroke_width(4);
                        self.dashed(&[(from, y0), (to, y0)], style::DOTTED, stroke)?;
                    }
                    Key::Look(look) => {
                        let line = Look { marker: None, ..look };
                        self.look(&line, &[(from, y0), (to, y0)])?;
                        if let Some(marker) = look.marker {
                            self.marker(marker, (x + KEY_WIDTH / 2, y), &look)?;
                        }
                    }
                }
                let at = (x + KEY_WIDTH + KEY_GAP, y);
                self.text(entry.label, at, style::NUMBERS, (HPos::Left, VPos::Center))?;
                x += entry.width() as i32;
            }
        }
        Ok(())
    }

    fn bands(&self) -> Result<(), Failure> {
        for band in &self.plot.bands {
            let (Some(a), Some(b)) = (self.y(band.between.0), self.y(band.between.1)) else {
                continue;
            };
            let inside = |y: f64| (y.round() as i32).clamp(self.frame.top, self.frame.bottom);
            let (top, bottom) = (inside(a.min(b)), inside(a.max(b)));
            self.hatched((self.frame.left, top), (self.frame.right, bottom))?;
        }
        Ok(())
    }

    /// A grey rectangle, hatched, so that it is seen in print as well.
    fn hatched(&self, upper_left: (i32, i32), lower_right: (i32, i32)) -> Result<(), Failure> {
        const SPACING: usize = 40;
        self.root.draw(&Rectangle::new([upper_left, lower_right], style::BAND.filled()))?;
        let ((left, top), (right, bottom)) = (upper_left, lower_right);
        let height = bottom - top;
        for start in ((left - height)..right).step_by(SPACING) {
            // From (start, bottom) up to the right, cut at the sides.
            let cut_left = (left - start).max(0);
            let cut_right = (start + height - right).max(0);
            if cut_left + cut_right < height {
                let from = (start + cut_left, bottom - cut_left);
                let to = (start + height - cut_right, top + cut_right);
                self.line(from, to, style::HATCH, 2)?;
            }
        }
        Ok(())
    }

    /// Pale areas between a lower and an upper curve.
    fn envelopes(&self) -> Result<(), Failure> {
        for envelope in &self.plot.envelopes {
            let place = |x: f64, y: f64| Some(whole((self.x(x)?, self.y(y)?)));
            let edges: Vec<_> = envelope
                .edges
                .iter()
                .filter_map(|&(x, low, high)| Some((place(x, low)?, place(x, high)?)))
                .collect();
            let low = edges.iter().map(|e| e.0);
            let outline: Vec<(i32, i32)> = low.chain(edges.iter().rev().map(|e| e.1)).collect();
            if edges.len() > 1 {
                self.root.draw(&Polygon::new(outline, style::ENVELOPE.filled()))?;
            }
        }
        Ok(())
    }
}

/// The nearest whole point: plotters has no others.
pub(in crate::report) fn whole((x, y): (f64, f64)) -> (i32, i32) {
    (x.round() as i32, y.round() as i32)
}

/// A text style whose size in the SVG is `size`: plotters writes its own size
/// over 1.24.
pub(in crate::report) fn font(
    size: f64,
    anchor: (HPos, VPos),
    transform: FontTransform,
) -> TextStyle<'static> {
    ("sans-serif", size * 1.24)
        .into_font()
        .transform(transform)
        .color(&INK)
        .pos(Pos::new(anchor.0, anchor.1))
}
