//! A plot: frame, axes, curves, bands, markers and a legend, drawn as SVG.
//!
//! Everything is placed in SVG units by [`Axis`]; plotters writes the SVG.
//! What has no place (NaN, a logarithm of zero) is left out.

mod areas;

use plotters::{
    coord::Shift,
    prelude::*,
    style::text_anchor::{HPos, Pos, VPos},
};

use super::{
    axis::Axis,
    dash::dashes,
    style::{self, Dash, INK, Marker},
};
use crate::plain::plain_lines;

/// How a series looks.
#[derive(Debug, Clone, Copy)]
pub struct Look {
    /// Colour of line and markers.
    pub colour: RGBColor,
    /// Dash pattern; `None` without a line.
    pub line: Option<Dash>,
    /// Width of the line.
    pub width: u32,
    /// Shape of the markers; `None` without.
    pub marker: Option<Marker>,
    /// A marker at every so many SVG units along x; `None` marks every point.
    pub marker_spacing: Option<f64>,
}

impl Look {
    /// A solid curve in the n-th colour.
    pub fn line(n: usize) -> Self {
        Self::of(style::colour(n))
    }

    /// A solid curve of a colour.
    pub fn of(colour: RGBColor) -> Self {
        let (line, width) = (Some(style::SOLID), style::CURVE);
        Self { colour, line, width, marker: None, marker_spacing: None }
    }

    /// A solid curve with the n-th colour and the n-th marker at every point.
    pub fn marked(n: usize) -> Self {
        Self::line(n).marker(style::marker(n))
    }

    /// The n-th markers in the n-th colour, without a line.
    pub fn points(n: usize) -> Self {
        Self { line: None, ..Self::marked(n) }
    }

    /// Thin rings where single runs are.
    pub fn rings() -> Self {
        Self { line: None, ..Self::of(style::LIMIT).thin().marker(Marker::Ring) }
    }

    pub fn dash(self, dash: Dash) -> Self {
        Self { line: Some(dash), ..self }
    }

    pub fn thin(self) -> Self {
        Self { width: style::THIN, ..self }
    }

    pub fn marker(self, marker: Marker) -> Self {
        Self { marker: Some(marker), ..self }
    }

    /// With a marker at every so many SVG units.
    pub fn every(self, spacing: f64) -> Self {
        Self { marker_spacing: Some(spacing), ..self }
    }
}

/// A series of points.
#[derive(Debug, Clone)]
pub struct Series {
    /// Its entry in the legend; empty for none.
    pub label: String,
    /// How it looks.
    pub look: Look,
    /// Points in values of the axes.
    pub points: Vec<(f64, f64)>,
}

/// A horizontal band.
#[derive(Debug, Clone)]
pub struct BandArea {
    /// Its entry in the legend.
    pub label: String,
    /// Ends on the vertical axis.
    pub between: (f64, f64),
}

/// The area between two curves.
#[derive(Debug, Clone)]
pub struct Envelope {
    /// Its entry in the legend.
    pub label: String,
    /// Places on the horizontal axis with the lower and the upper value there.
    pub edges: Vec<(f64, f64, f64)>,
}

/// A straight line across the frame, marking a limit or an event.
#[derive(Debug, Clone)]
pub struct Mark {
    /// Its entry in the legend; empty for none.
    pub label: String,
    /// Value on its axis.
    pub at: f64,
    /// Whether it stands upright (a value of the horizontal axis).
    pub upright: bool,
}

/// Everything in one plot.
#[derive(Debug, Clone)]
pub struct Plot {
    /// Horizontal axis.
    pub x: Axis,
    /// Vertical axis.
    pub y: Axis,
    /// Names in place of numbers on the vertical axis, one a tick.
    pub y_names: Option<Vec<String>>,
    /// Bands behind everything.
    pub bands: Vec<BandArea>,
    /// Areas between curves, before the bands.
    pub envelopes: Vec<Envelope>,
    /// Lines across the frame.
    pub marks: Vec<Mark>,
    /// The series, drawn in order.
    pub series: Vec<Series>,
    /// Height of the frame in SVG units.
    pub frame_height: u32,
}

/// Why an SVG could not be drawn.
type Failure = DrawingAreaErrorKind<std::io::Error>;
type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;

impl Plot {
    /// An empty plot.
    pub fn new(x: Axis, y: Axis) -> Self {
        Self {
            x,
            y,
            y_names: None,
            bands: Vec::new(),
            envelopes: Vec::new(),
            marks: Vec::new(),
            series: Vec::new(),
            frame_height: style::FRAME_HEIGHT,
        }
    }

    /// An empty plot with a named row for each of some things, from the top, and so much height
    /// for each.
    pub fn of_rows(x: Axis, names: Vec<String>, height: u32) -> Self {
        let count = names.len().max(1);
        let frame_height = (height * count as u32).max(3 * height);
        Self { y_names: Some(names), frame_height, ..Self::new(x, Axis::rows(count)) }
    }

    /// Adds a series.
    pub fn add(&mut self, label: impl Into<String>, look: Look, points: Vec<(f64, f64)>) {
        self.series.push(Series { label: label.into(), look, points });
    }

    /// Adds an entry to the legend that explains a look.
    pub fn add_key(&mut self, label: &str, look: Look) {
        self.add(label, look, Vec::new());
    }

    /// Adds a series, and its entry in the legend, where it has points.
    pub fn add_some(&mut self, label: impl Into<String>, look: Look, points: Vec<(f64, f64)>) {
        if !points.is_empty() {
            self.add(label, look, points);
        }
    }

    /// Adds an upright line from one value to another, with a stroke of this half width at
    /// either end.
    pub fn add_interval(
        &mut self,
        label: &str,
        look: Look,
        (at, low, high): (f64, f64, f64),
        stroke: f64,
    ) {
        self.add(label, look, vec![(at, low), (at, high)]);
        for end in [low, high] {
            self.add("", look, vec![(at - stroke, end), (at + stroke, end)]);
        }
    }

    /// Marks a value of the vertical axis.
    pub fn mark_level(&mut self, label: impl Into<String>, at: f64) {
        self.marks.push(Mark { label: label.into(), at, upright: false });
    }

    /// Marks a value of the horizontal axis.
    pub fn mark_upright(&mut self, label: impl Into<String>, at: f64) {
        self.marks.push(Mark { label: label.into(), at, upright: true });
    }

    /// Hatches the laboratory's range on the vertical axis.
    pub fn add_band(&mut self, label: &str, between: (f64, f64)) {
        self.bands.push(BandArea { label: label.to_owned(), between });
    }

    /// The plot as SVG.
    ///
    /// # Errors
    /// A sentence on what plotters could not draw.
    pub fn svg(&self) -> Result<String, String> {
        let mut svg = String::new();
        self.draw(&mut svg).map_err(|e| e.to_string())?;
        // Labels hold names; some characters of them no XML file may hold.
        Ok(plain_lines(&svg).into_owned())
    }

    /// What stands at the i-th tick of the vertical axis.
    fn y_number(&self, i: usize) -> String {
        match &self.y_names {
            Some(names) => names.get(i).cloned().unwrap_or_default(),
            None => self.y.ticks.get(i).map_or(String::new(), |t| self.y.number(*t)),
        }
    }

    /// How far the number of a tick at the right end reaches over it.
    fn last_number_over(&self) -> i32 {
        let at_end = |tick: &&f64| self.x.place(**tick).is_some_and(|place| place > 0.98);
        let width = |tick: &f64| style::text_width(&self.x.number(*tick), style::NUMBERS);
        self.x.ticks.iter().filter(at_end).map(|t| (width(t) / 2.0) as i32 + 10).max().unwrap_or(0)
    }

    fn draw(&self, svg: &mut String) -> Result<(), Failure> {
        let widest = (0..self.y.ticks.len())
            .map(|i| style::text_width(&self.y_number(i), style::NUMBERS))
            .fold(0.0, f64::max);
        let name = if self.y.name.is_empty() { 0 } else { style::UPRIGHT_NAME };
        let left = (widest as i32 + name + 50).max(style::LEFT);
        let frame = Frame {
            left,
            right: style::WIDTH as i32 - self.last_number_over().max(style::RIGHT),
            top: style::TOP,
            bottom: style::TOP + self.frame_height as i32,
        };
        let rows = self.legend_rows();
        let legend_top = frame.bottom + style::BELOW;
        let height = legend_top + rows.len() as i32 * LEGEND_ROW + 20;
        let root = SVGBackend::with_string(svg, (style::WIDTH, height as u32)).into_drawing_area();
        root.fill(&WHITE)?;
        let pen = Pen { root: &root, frame, plot: self };
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

/// Plots as one SVG, one below the other.
///
/// # Errors
/// A sentence on what could not be drawn.
pub fn stacked(plots: &[Plot]) -> Result<String, String> {
    if let [alone] = plots {
        return alone.svg();
    }
    let (mut inside, mut top) = (String::new(), 0);
    for plot in plots {
        let panel = plot.svg()?;
        let height = panel.split_once(" height=\"").and_then(|(_, rest)| rest.split_once('"'));
        let height: u32 = height
            .and_then(|(number, _)| number.parse().ok())
            .ok_or_else(|| "a panel has no height".to_owned())?;
        inside += &panel.replacen("<svg ", &format!("<svg y=\"{top}\" "), 1);
        top += height;
    }
    let width = style::WIDTH;
    Ok(format!(
        "<svg width=\"{width}\" height=\"{top}\" viewBox=\"0 0 {width} {top}\" \
         xmlns=\"http://www.w3.org/2000/svg\">\n{inside}</svg>\n"
    ))
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
}

impl Pen<'_, '_> {
    fn x(&self, value: f64) -> Option<f64> {
        let Frame { left, right, .. } = self.frame;
        let place = self.plot.x.place(value)?.clamp(-9.0, 9.0);
        Some(f64::from(left) + place * f64::from(right - left))
    }

    fn y(&self, value: f64) -> Option<f64> {
        let Frame { top, bottom, .. } = self.frame;
        let place = self.plot.y.place(value)?.clamp(-9.0, 9.0);
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
        for x in self.plot.x.ticks.iter().filter_map(|t| self.x(*t)) {
            self.line((x as i32, top), (x as i32, bottom), style::GRID, 2)?;
        }
        for y in self.plot.y.ticks.iter().filter_map(|t| self.y(*t)) {
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
        for x in self.plot.x.minor.iter().filter_map(|t| self.x(*t)) {
            let x = x as i32;
            self.line((x, bottom), (x, bottom - style::TICK / 2), INK, style::THIN)?;
        }
        for y in self.plot.y.minor.iter().filter_map(|t| self.y(*t)) {
            self.line((left, y as i32), (left + style::TICK / 2, y as i32), INK, style::THIN)?;
        }
        for tick in &self.plot.x.ticks {
            let Some(x) = self.x(*tick) else { continue };
            let x = x as i32;
            self.line((x, bottom), (x, bottom - style::TICK), INK, style::THIN)?;
            let number = self.plot.x.number(*tick);
            self.text(&number, (x, bottom + 18), style::NUMBERS, (HPos::Center, VPos::Top))?;
        }
        for (i, tick) in self.plot.y.ticks.iter().enumerate() {
            let Some(y) = self.y(*tick) else { continue };
            let y = y as i32;
            self.line((left, y), (left + style::TICK, y), INK, style::THIN)?;
            let number = self.plot.y_number(i);
            self.text(&number, (left - 20, y), style::NUMBERS, (HPos::Right, VPos::Center))?;
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
                self.marker(marker, (x.round() as i32, y.round() as i32), look)?;
            }
        }
        Ok(())
    }

    fn dashed(&self, points: &[(f64, f64)], dash: Dash, stroke: ShapeStyle) -> Result<(), Failure> {
        for piece in dashes(points, dash) {
            let path: Vec<(i32, i32)> =
                piece.iter().map(|p| (p.0.round() as i32, p.1.round() as i32)).collect();
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
}

/// A text style whose size in the SVG is `size`: plotters writes its own size
/// over 1.24.
pub(super) fn font(
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_to_draw_is_still_a_plot() {
        let mut plot = Plot::new(Axis::linear("x", []), Axis::logarithmic("y", []));
        let look = Look::of(INK).dash(style::DASHED).thin().marker(Marker::Cross);
        for points in [vec![], vec![(f64::NAN, 1.0)], vec![(0.5, 0.0)], vec![(1e300, 1e300)]] {
            plot.add("a < b & c", look, points);
        }
        plot.add_band("band", (f64::NAN, 1.0));
        let svg = plot.svg().expect("drawn");
        assert!(svg.contains("a &lt; b &amp; c"), "labels are escaped");
        assert!(!svg.contains("NaN"), "no NaN reaches the file");
    }
}
