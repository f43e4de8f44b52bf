//! Draws a plot: bands and areas first, then axes, curves, and the legend below.

use plotters::{
    prelude::*,
    style::text_anchor::{HPos, VPos},
};

use super::{Look, Plot};
use crate::report::{
    axis::Scale,
    sheet::{Drawn, Place, Sheet, drawn, whole},
    style::{self, INK, Marker},
};

impl Plot {
    /// The plot as SVG.
    ///
    /// # Errors
    /// A sentence on what plotters could not draw.
    pub fn svg(&self) -> Result<String, String> {
        let (x, y) = self.scales();
        let y_numbers = self.y_numbers(&y);
        // How far the number of a tick at the right end reaches over it; names stay below their share.
        let is_at_end = |tick: &f64| x.place(*tick).is_some_and(|place| place > 0.98);
        let at_end = x.ticks.iter().filter(|t| self.x_names.is_none() && is_at_end(t));
        let over = at_end.map(|t| (width(&x.number(*t)) / 2.0) as i32 + 10).max().unwrap_or(0);
        let frame = Frame {
            left: self.left(),
            right: style::WIDTH as i32 - over.max(style::RIGHT),
            top: style::TOP,
            bottom: style::TOP + self.frame_height as i32,
        };
        let rows = self.legend_rows();
        let legend_top = frame.bottom + style::BELOW;
        let height = legend_top + rows.len() as i32 * LEGEND_ROW + 20;
        drawn(height, |sheet| {
            let x_numbers = self.x_numbers(&x, f64::from(frame.right - frame.left));
            let pen = Pen { sheet, frame, plot: self, x, y, x_numbers, y_numbers };
            pen.bands()?;
            pen.envelopes()?;
            pen.grid()?;
            pen.marks()?;
            pen.axes()?;
            for series in &self.series {
                let places = series.points.iter().filter_map(|&(x, y)| pen.place(x, y));
                pen.look(&series.look, &places.collect::<Vec<_>>())?;
            }
            pen.legend(&rows, legend_top)
        })
    }

    /// Space left of the frame in SVG units, for numbers and the vertical axis' name.
    pub(in crate::report) fn left(&self) -> i32 {
        let numbers = self.y_numbers(&self.scales().1);
        let widest = numbers.iter().map(|number| width(number)).fold(0.0, f64::max);
        let name = if self.y.name.is_empty() { 0 } else { style::UPRIGHT_NAME };
        (widest as i32 + name + 50).max(style::LEFT).max(self.least_left)
    }

    /// What stands at each tick of the vertical axis.
    fn y_numbers(&self, y: &Scale) -> Vec<String> {
        let names = self.y_names.clone();
        names.unwrap_or_else(|| y.ticks.iter().map(|t| y.number(*t)).collect())
    }

    /// What stands at each tick of the horizontal axis, and its size: numbers, or names that stand
    /// beside each other. Names that would have to be too small are numbered and cut off.
    fn x_numbers(&self, x: &Scale, width: f64) -> (Vec<String>, f64) {
        const SHARE: f64 = 0.94;
        let Some(names) = &self.x_names else {
            return (x.ticks.iter().map(|t| x.number(*t)).collect(), style::NUMBERS);
        };
        let room = SHARE * width / names.len().max(1) as f64;
        let sizes = names.iter().map(|name| style::fitting(name, style::NUMBERS, room));
        let size = sizes.fold(style::NUMBERS, f64::min);
        if size >= style::LEAST {
            return (names.clone(), size);
        }
        let most = (room / style::text_width("x", style::LEAST)) as usize;
        let cut = |(n, name): (usize, &String)| {
            let numbered = format!("{} {name}", n + 1);
            if numbered.chars().count() <= most {
                return numbered;
            }
            numbered.chars().take(most.saturating_sub(1)).chain(['…']).collect()
        };
        (names.iter().enumerate().map(cut).collect(), style::LEAST)
    }

    /// Legend entries, wrapped to the width of the figure; one that is longer stands alone, in
    /// several rows.
    fn legend_rows(&self) -> Vec<Vec<Entry>> {
        let bands = self.bands.iter().map(|b| (&b.label, Key::Band));
        let areas = self.envelopes.iter().map(|e| (&e.label, Key::Envelope));
        let marks = self.looks_of_marks().into_iter();
        let marks = marks.map(|(m, look)| (&m.label, Key::Look(look)));
        let series = self.series.iter().map(|s| (&s.label, Key::Look(s.look)));
        let across = f64::from(style::WIDTH - 2 * LEGEND_SIDE);
        let room = across - f64::from(KEY_WIDTH + KEY_GAP);
        let mut rows: Vec<Vec<Entry>> = Vec::new();
        let mut used = f64::INFINITY;
        let all = series.chain(areas).chain(bands).chain(marks);
        for (label, key) in all.filter(|(label, _)| !label.is_empty()) {
            let lines = style::wrapped(label, style::NUMBERS, room);
            let is_parted = lines.len() > 1;
            for (n, label) in lines.into_iter().enumerate() {
                let entry = Entry { label, key: (n == 0).then_some(key) };
                let width = entry.width();
                if is_parted || used + width > across {
                    rows.push(Vec::new());
                    used = 0.0;
                }
                used += width;
                if let Some(row) = rows.last_mut() {
                    row.push(entry);
                }
            }
            if is_parted {
                used = f64::INFINITY;
            }
        }
        rows
    }
}

/// Width in SVG units of what stands at a tick.
fn width(number: &str) -> f64 {
    style::text_width(number, style::NUMBERS)
}

const LEGEND_ROW: i32 = 66;
const LEGEND_SIDE: u32 = 60;
const KEY_WIDTH: i32 = 110;
const KEY_GAP: i32 = 20;
const ENTRY_GAP: f64 = 50.0;

struct Entry {
    label: String,
    /// None in further rows of a long entry.
    key: Option<Key>,
}

#[derive(Clone, Copy)]
enum Key {
    Look(Look),
    Band,
    Envelope,
}

impl Entry {
    fn width(&self) -> f64 {
        f64::from(KEY_WIDTH + KEY_GAP) + style::text_width(&self.label, style::NUMBERS) + ENTRY_GAP
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
    sheet: &'a Sheet<'b>,
    frame: Frame,
    plot: &'a Plot,
    x: Scale,
    y: Scale,
    /// What stands at each tick of the horizontal axis, and its size.
    x_numbers: (Vec<String>, f64),
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

    fn place(&self, x: f64, y: f64) -> Option<(f64, f64)> {
        Some((self.x(x)?, self.y(y)?))
    }

    fn grid(&self) -> Drawn {
        let Frame { left, right, top, bottom } = self.frame;
        for x in self.x.ticks.iter().filter_map(|t| self.x(*t)) {
            self.sheet.path([(x as i32, top), (x as i32, bottom)], style::GRID, 2)?;
        }
        for y in self.y.ticks.iter().filter_map(|t| self.y(*t)) {
            self.sheet.path([(left, y as i32), (right, y as i32)], style::GRID, 2)?;
        }
        Ok(())
    }

    fn marks(&self) -> Drawn {
        let Frame { left, right, top, bottom } = self.frame;
        for (mark, look) in self.plot.looks_of_marks() {
            let ends = if mark.upright {
                self.x(mark.at).map(|x| [(x, f64::from(top)), (x, f64::from(bottom))])
            } else {
                self.y(mark.at).map(|y| [(f64::from(left), y), (f64::from(right), y)])
            };
            if let Some(ends) = ends {
                self.look(&look, &ends)?;
            }
        }
        Ok(())
    }

    fn axes(&self) -> Drawn {
        let Frame { left, right, top, bottom } = self.frame;
        let sheet = self.sheet;
        // Text that hangs from its place.
        let hanging = (HPos::Center, VPos::Top);
        sheet.rectangle([(left, top), (right, bottom)], INK.stroke_width(style::THIN))?;
        for x in self.x.minor.iter().filter_map(|t| self.x(*t)) {
            let x = x as i32;
            sheet.path([(x, bottom), (x, bottom - style::TICK / 2)], INK, style::THIN)?;
        }
        for y in self.y.minor.iter().filter_map(|t| self.y(*t)) {
            let y = y as i32;
            sheet.path([(left, y), (left + style::TICK / 2, y)], INK, style::THIN)?;
        }
        let (x_numbers, size) = &self.x_numbers;
        for (tick, number) in self.x.ticks.iter().zip(x_numbers) {
            let Some(x) = self.x(*tick) else { continue };
            let x = x as i32;
            sheet.path([(x, bottom), (x, bottom - style::TICK)], INK, style::THIN)?;
            sheet.text(number, (x, bottom + 18), *size, hanging)?;
        }
        for (tick, number) in self.y.ticks.iter().zip(&self.y_numbers) {
            let Some(y) = self.y(*tick) else { continue };
            let y = y as i32;
            sheet.path([(left, y), (left + style::TICK, y)], INK, style::THIN)?;
            sheet.text(number, (left - 20, y), style::NUMBERS, (HPos::Right, VPos::Center))?;
        }
        // Names stand at the middle of the frame and reach to the nearer edge of the sheet at most.
        let (across, up) = ((left + right) / 2, (top + bottom) / 2);
        let room = 2 * across.min(style::WIDTH as i32 - across);
        let (name, below) = (&self.plot.x.name, (across, bottom + 92));
        let size = style::fitting(name, style::NAMES, f64::from(room));
        sheet.text(name, below, size, hanging)?;
        let (name, beside) = (&self.plot.y.name, (28, up));
        let size = style::fitting(name, style::NAMES, f64::from(2 * up));
        sheet.turned_text(name, beside, size, hanging, FontTransform::Rotate270)
    }

    fn look(&self, look: &Look, points: &[(f64, f64)]) -> Drawn {
        if let Some(dash) = look.line {
            self.sheet.dashed(points, dash, look.colour, look.width)?;
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

    fn marker(&self, marker: Marker, (x, y): Place, look: &Look) -> Drawn {
        let (sheet, colour) = (self.sheet, look.colour);
        // Thin curves have small markers.
        let r = if look.width > style::THIN { style::MARKER } else { style::SMALL_MARKER };
        match marker {
            Marker::Disc => sheet.circle((x, y), r, colour.filled()),
            Marker::Ring => {
                sheet.circle((x, y), r, WHITE.filled())?;
                sheet.circle((x, y), r, colour.stroke_width(5))
            }
            Marker::Square => {
                let corners = [(x - r, y - r), (x + r, y - r), (x + r, y + r), (x - r, y + r)];
                sheet.polygon(corners, colour)
            }
            Marker::Triangle => {
                let corners = [(x, y - r * 5 / 4), (x + r * 6 / 5, y + r), (x - r * 6 / 5, y + r)];
                sheet.polygon(corners, colour)
            }
            Marker::Diamond => {
                let d = r * 7 / 5;
                sheet.polygon([(x, y - d), (x + d, y), (x, y + d), (x - d, y)], colour)
            }
            Marker::Cross => {
                sheet.path([(x - r, y - r), (x + r, y + r)], colour, 6)?;
                sheet.path([(x - r, y + r), (x + r, y - r)], colour, 6)
            }
        }
    }

    fn legend(&self, rows: &[Vec<Entry>], top: i32) -> Drawn {
        for (i, row) in rows.iter().enumerate() {
            let y = top + i as i32 * LEGEND_ROW + LEGEND_ROW / 2;
            let mut x = LEGEND_SIDE as i32;
            for entry in row {
                let corners = [(x, y - 18), (x + KEY_WIDTH, y + 18)];
                match entry.key {
                    None => {}
                    Some(Key::Band) => self.hatched(corners)?,
                    Some(Key::Envelope) => {
                        self.sheet.rectangle(corners, style::ENVELOPE.filled())?
                    }
                    Some(Key::Look(look)) => {
                        let line = Look { marker: None, ..look };
                        let ends = [x, x + KEY_WIDTH].map(|x| (f64::from(x), f64::from(y)));
                        self.look(&line, &ends)?;
                        if let Some(marker) = look.marker {
                            self.marker(marker, (x + KEY_WIDTH / 2, y), &look)?;
                        }
                    }
                }
                let at = (x + KEY_WIDTH + KEY_GAP, y);
                self.sheet.text(&entry.label, at, style::NUMBERS, (HPos::Left, VPos::Center))?;
                x += entry.width() as i32;
            }
        }
        Ok(())
    }

    fn bands(&self) -> Drawn {
        for band in &self.plot.bands {
            let (Some(a), Some(b)) = (self.y(band.between.0), self.y(band.between.1)) else {
                continue;
            };
            let inside = |y: f64| (y.round() as i32).clamp(self.frame.top, self.frame.bottom);
            let (top, bottom) = (inside(a.min(b)), inside(a.max(b)));
            self.hatched([(self.frame.left, top), (self.frame.right, bottom)])?;
        }
        Ok(())
    }

    /// A grey rectangle, hatched, so that it is seen in print as well.
    fn hatched(&self, corners: [Place; 2]) -> Drawn {
        const SPACING: usize = 40;
        self.sheet.rectangle(corners, style::BAND.filled())?;
        let [(left, top), (right, bottom)] = corners;
        let height = bottom - top;
        for start in ((left - height)..right).step_by(SPACING) {
            // From (start, bottom) up to the right, cut at the sides.
            let cut_left = (left - start).max(0);
            let cut_right = (start + height - right).max(0);
            if cut_left + cut_right < height {
                let from = (start + cut_left, bottom - cut_left);
                let to = (start + height - cut_right, top + cut_right);
                self.sheet.path([from, to], style::HATCH, 2)?;
            }
        }
        Ok(())
    }

    /// Pale areas between a lower and an upper curve.
    fn envelopes(&self) -> Drawn {
        for envelope in &self.plot.envelopes {
            let place = |x: f64, y: f64| self.place(x, y).map(whole);
            let edges: Vec<_> = envelope
                .edges
                .iter()
                .filter_map(|&(x, low, high)| Some((place(x, low)?, place(x, high)?)))
                .collect();
            let low = edges.iter().map(|e| e.0);
            let outline: Vec<Place> = low.chain(edges.iter().rev().map(|e| e.1)).collect();
            if edges.len() > 1 {
                self.sheet.polygon(outline, style::ENVELOPE)?;
            }
        }
        Ok(())
    }
}
