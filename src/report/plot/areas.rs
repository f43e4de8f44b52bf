//! What is filled behind the curves of a plot: bands of the laboratory, areas between curves.

use plotters::prelude::*;

use super::{Failure, Pen};
use crate::report::style;

impl Pen<'_, '_> {
    pub(super) fn bands(&self) -> Result<(), Failure> {
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
    pub(super) fn hatched(
        &self,
        upper_left: (i32, i32),
        lower_right: (i32, i32),
    ) -> Result<(), Failure> {
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
    pub(super) fn envelopes(&self) -> Result<(), Failure> {
        for envelope in &self.plot.envelopes {
            let place = |x: f64, y: f64| {
                let (x, y) = (self.x(x)?, self.y(y)?);
                Some((x.round() as i32, y.round() as i32))
            };
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
