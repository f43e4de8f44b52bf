//! A chart of points and curves in panels below each other: of laws and measurements, each panel
//! with axes of its own.

use super::{
    Figure, ReportError,
    axis::Axis,
    plot::{Look, Mark, Plot},
    style,
    table::{Cell, Table},
};

/// How the points of a curve are drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CurveStyle {
    /// Markers alone.
    Points,
    /// Small markers alone, of many points.
    Dots,
    /// Markers along a line.
    Measured,
    /// A line.
    Line,
    /// A line with a marker here and there, so that several can be told apart.
    Marked,
    /// A dashed line: a law, or what others measured.
    Law,
}

/// A curve, or a cloud of points.
#[derive(Debug, Clone, PartialEq)]
pub struct ChartCurve {
    /// Its name in the key, and in the table; empty for none.
    pub name: String,
    /// How it is drawn.
    pub style: CurveStyle,
    /// Number of its colour and marker: what belongs together has the same.
    pub kind: usize,
    /// Points.
    pub points: Vec<(f64, f64)>,
}

/// A straight line across a panel: a value that is asked for, or where something begins.
#[derive(Debug, Clone, PartialEq)]
pub struct ChartMark {
    /// Its name in the key; empty for none.
    pub name: String,
    /// Value on its axis. The vertical axis reaches to it.
    pub at: f64,
    /// Whether it stands upright, at a value of the horizontal axis.
    pub upright: bool,
}

/// A panel.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Panel {
    /// Name and unit of the horizontal axis.
    pub x: String,
    /// Name and unit of the vertical axis.
    pub y: String,
    /// Whether the horizontal and the vertical axes are logarithmic.
    pub log: [bool; 2],
    /// Whether the horizontal and the vertical axes begin at nothing, for lengths to be compared.
    pub from_zero: [bool; 2],
    /// Lines across it.
    pub marks: Vec<ChartMark>,
    /// Curves, drawn in order.
    pub curves: Vec<ChartCurve>,
}

/// A chart that is a figure of its own.
#[derive(Debug, Clone, PartialEq)]
pub struct Chart {
    /// Name of its files, without extension.
    pub stem: String,
    /// Title.
    pub title: String,
    /// What is to be seen.
    pub caption: String,
    /// From above to below; their horizontal axes are the same.
    pub panels: Vec<Panel>,
}

/// Distance of markers along a line of many points, in SVG units.
const MARKER_SPACING: f64 = 170.0;

impl CurveStyle {
    fn look(self, kind: usize) -> Look {
        match self {
            Self::Points => Look::points(kind),
            Self::Dots => Look::points(kind).thin(),
            Self::Measured => Look::marked(kind),
            Self::Line => Look::line(kind),
            Self::Marked => Look::marked(kind).every(MARKER_SPACING),
            Self::Law => Look::line(kind).dash(style::DASHED),
        }
    }
}

impl Panel {
    pub(super) fn plot(&self) -> Plot {
        let points = || self.curves.iter().flat_map(|curve| &curve.points);
        let zero = |n: usize| self.from_zero[n].then_some(0.0);
        let levels = self.marks.iter().filter(|mark| !mark.upright).map(|mark| mark.at);
        let x = Axis::scaled(self.log[0], &self.x, points().map(|p| p.0).chain(zero(0)));
        let y =
            Axis::scaled(self.log[1], &self.y, points().map(|p| p.1).chain(levels).chain(zero(1)));
        let mut plot = Plot::new(x, y);
        for ChartMark { name, at, upright } in &self.marks {
            plot.marks.push(Mark { label: name.clone(), at: *at, upright: *upright });
        }
        for curve in &self.curves {
            plot.add(&curve.name, curve.style.look(curve.kind), curve.points.clone());
        }
        plot
    }
}

impl Chart {
    /// The figure, and the table of its points: a column for each panel.
    ///
    /// # Errors
    /// [`ReportError::Figure`].
    pub fn figure(&self) -> Result<Figure, ReportError> {
        let x = self.panels.first().map_or("", |panel| panel.x.as_str());
        let header: Vec<&str> = ["curve", x]
            .into_iter()
            .chain(self.panels.iter().map(|panel| panel.y.as_str()))
            .collect();
        let mut table = Table::new(header);
        for (n, panel) in self.panels.iter().enumerate() {
            for curve in &panel.curves {
                for (x, y) in &curve.points {
                    let mut row = vec![Cell::from(&curve.name), Cell::from(*x)];
                    row.extend((0..self.panels.len()).map(|k| (k == n).then_some(*y).into()));
                    table.row(row);
                }
            }
        }
        let plots: Vec<Plot> = self.panels.iter().map(Panel::plot).collect();
        Figure::new(&self.stem, &self.title, &self.caption, &plots, &table)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve(name: &str, style: CurveStyle, points: &[(f64, f64)]) -> ChartCurve {
        ChartCurve { name: name.to_owned(), style, kind: 0, points: points.to_vec() }
    }

    fn rates() -> Chart {
        let panel = Panel {
            x: "Opening (mm)".into(),
            y: "Rate (g/s)".into(),
            from_zero: [true; 2],
            marks: vec![ChartMark { name: "Asked for".into(), at: 700.0, upright: false }],
            curves: vec![
                curve("Measured", CurveStyle::Points, &[(45.0, 200.0), (90.0, 1300.0)]),
                curve("Law", CurveStyle::Law, &[(40.0, 150.0), (90.0, 1400.0)]),
            ],
            ..Panel::default()
        };
        Chart {
            stem: "rates".into(),
            title: "Rates".into(),
            caption: "Rates of openings.".into(),
            panels: vec![panel],
        }
    }

    #[test]
    fn a_chart_shows_every_point_and_gives_it_in_its_table() {
        let figure = rates().figure().expect("it can be drawn");
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

    #[test]
    fn a_panel_has_a_column_and_axes_of_its_own() {
        let mut chart = rates();
        let below = Panel {
            y: "Void ratio".into(),
            from_zero: [true, false],
            marks: Vec::new(),
            curves: vec![curve("Measured", CurveStyle::Line, &[(45.0, 0.71), (90.0, 0.74)])],
            ..chart.panels[0].clone()
        };
        let plot = below.plot();
        assert_eq!(plot.x.from, 0.0, "law: from nothing where that is asked for");
        assert!(plot.y.from >= 0.7, "law: else by the values, got {}", plot.y.from);
        chart.panels.push(below);
        let figure = chart.figure().expect("it can be drawn");
        let table = String::from_utf8(figure.csv).expect("text");
        assert!(table.starts_with("curve,Opening (mm),Rate (g/s),Void ratio\n"), "{table}");
        assert!(table.contains("\nLaw,90,1400,\nMeasured,45,,0.71\n"), "law: {table}");
        assert_eq!(figure.svg.matches("Opening (mm)").count(), 2, "law: an axis each");
    }

    #[test]
    fn logarithmic_axes_end_at_decades() {
        let panel = Panel {
            log: [true, false],
            curves: vec![curve("", CurveStyle::Measured, &[(12.5, 0.9), (200.0, 0.8)])],
            ..Panel::default()
        };
        let plot = panel.plot();
        assert_eq!((plot.x.from, plot.x.to), (10.0, 1000.0), "law: 10 to 1000");
    }
}
