//! A chart of points and curves that others than a study's report draw: a figure of its own.

use super::{
    Figure, ReportError,
    axis::Axis,
    figures,
    plot::{Look, Mark, Plot, Series},
    style,
};

/// How the points of a curve are drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CurveStyle {
    /// Markers alone.
    Points,
    /// Markers along a line.
    Measured,
    /// A dashed line: a law, or what others measured.
    Law,
}

/// A curve, or a cloud of points.
#[derive(Debug, Clone, PartialEq)]
pub struct ChartCurve {
    /// Its name in the key, and in the table.
    pub name: String,
    /// How it is drawn.
    pub style: CurveStyle,
    /// Number of its colour and marker: what belongs together has the same.
    pub kind: usize,
    /// Points.
    pub points: Vec<(f64, f64)>,
}

/// A chart.
#[derive(Debug, Clone, PartialEq)]
pub struct LawChart {
    /// Name of its files, without extension.
    pub stem: String,
    /// Title.
    pub title: String,
    /// What is to be seen.
    pub caption: String,
    /// Name and unit of the horizontal axis.
    pub x: String,
    /// Name and unit of the vertical axis.
    pub y: String,
    /// A level line, with its name: a value that is asked for.
    pub wanted: Option<(String, f64)>,
    /// Curves, drawn in order.
    pub curves: Vec<ChartCurve>,
}

impl LawChart {
    /// The figure, and the table of its points.
    ///
    /// # Errors
    /// [`ReportError::Figure`].
    pub fn figure(&self) -> Result<Figure, ReportError> {
        let points = || self.curves.iter().flat_map(|curve| &curve.points);
        let level = self.wanted.iter().map(|wanted| wanted.1);
        // Both axes begin at nothing: the lengths of curves are to be compared.
        let x = Axis::linear(&self.x, points().map(|p| p.0).chain([0.0]));
        let y = Axis::linear(&self.y, points().map(|p| p.1).chain(level).chain([0.0]));
        let mut plot = Plot::new(x, y);
        if let Some((label, at)) = &self.wanted {
            plot.marks.push(Mark { label: label.clone(), at: *at, upright: false });
        }
        for curve in &self.curves {
            let (line, marker) = match curve.style {
                CurveStyle::Points => (None, Some(style::marker(curve.kind))),
                CurveStyle::Measured => (Some(style::SOLID), Some(style::marker(curve.kind))),
                CurveStyle::Law => (Some(style::DASHED), None),
            };
            let look = Look {
                colour: style::colour(curve.kind),
                line,
                width: style::CURVE,
                marker,
                marker_spacing: None,
            };
            let (label, points) = (curve.name.clone(), curve.points.clone());
            plot.series.push(Series { label, look, points });
        }
        figures::of_chart(self, &plot)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_chart_shows_every_point_and_gives_it_in_its_table() {
        let curve = |name: &str, style, points: &[(f64, f64)]| ChartCurve {
            name: name.to_owned(),
            style,
            kind: 0,
            points: points.to_vec(),
        };
        let chart = LawChart {
            stem: "rates".into(),
            title: "Rates".into(),
            caption: "Rates of openings.".into(),
            x: "Opening (mm)".into(),
            y: "Rate (g/s)".into(),
            wanted: Some(("Asked for".into(), 700.0)),
            curves: vec![
                curve("Measured", CurveStyle::Points, &[(45.0, 200.0), (90.0, 1300.0)]),
                curve("Law", CurveStyle::Law, &[(40.0, 150.0), (90.0, 1400.0)]),
            ],
        };
        let figure = chart.figure().expect("it can be drawn");
        let table = String::from_utf8(figure.csv).expect("text");
        assert_eq!(
            table,
            "curve,Opening (mm),Rate (g/s)\nMeasured,45,200\nMeasured,90,1300\nLaw,40,150\n\
             Law,90,1400\n",
            "law: every point of every curve stands in the table"
        );
        for label in ["Measured", "Law", "Asked for", "Opening (mm)", "Rate (g/s)"] {
            assert!(figure.svg.contains(label), "law: the figure names `{label}`");
        }
    }
}
