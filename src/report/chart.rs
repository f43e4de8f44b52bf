//! A chart of laws and measurements: plots below each other, and the table of their points.

use super::{Figure, ReportError, plot::Plot};

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
    pub panels: Vec<Plot>,
}

impl Chart {
    /// A chart of these panels.
    pub fn new(stem: &str, title: &str, caption: &str, panels: Vec<Plot>) -> Self {
        let [stem, title, caption] = [stem, title, caption].map(str::to_owned);
        Self { stem, title, caption, panels }
    }

    /// The figure, and the table of its points: a column for each panel.
    ///
    /// # Errors
    /// [`ReportError::Figure`].
    pub fn figure(&self) -> Result<Figure, ReportError> {
        let x = self.panels.first().map_or("", |panel| panel.x.name.as_str());
        let names = self.panels.iter().map(|panel| panel.y.name.as_str());
        let columns: Vec<&str> = ["curve", x].into_iter().chain(names).collect();
        Figure::of_curves(&self.stem, &self.title, &self.caption, &self.panels, &columns)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::{Axis, Look};

    fn rates() -> Chart {
        let mut panel = Plot::new(
            Axis::linear("Opening (mm)").from_zero(),
            Axis::linear("Rate (g/s)").from_zero(),
        );
        panel.mark_level("Asked for", 700.0);
        panel.add("Measured", Look::points(0), vec![(45.0, 200.0), (90.0, 1300.0)]);
        panel.add("Law", Look::law(0), vec![(40.0, 150.0), (90.0, 1400.0)]);
        Chart::new("rates", "Rates", "Rates of openings.", vec![panel])
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
        let mut below =
            Plot::new(Axis::linear("Opening (mm)").from_zero(), Axis::linear("Void ratio"));
        below.add("Measured", Look::line(0), vec![(45.0, 0.71), (90.0, 0.74)]);
        let (x, y) = below.scales();
        assert_eq!(x.from, 0.0, "law: from nothing where that is asked for");
        assert!(y.from >= 0.7, "law: else by the values, got {}", y.from);
        chart.panels.push(below);
        let figure = chart.figure().expect("it can be drawn");
        let table = String::from_utf8(figure.csv).expect("text");
        assert!(table.starts_with("curve,Opening (mm),Rate (g/s),Void ratio\n"), "{table}");
        assert!(table.contains("\nLaw,90,1400,\nMeasured,45,,0.71\n"), "law: {table}");
        assert_eq!(figure.svg.matches("Opening (mm)").count(), 2, "law: an axis each");
    }

    #[test]
    fn logarithmic_axes_end_at_decades() {
        let mut panel = Plot::new(Axis::logarithmic("x"), Axis::linear("y"));
        panel.add("", Look::marked(0), vec![(12.5, 0.9), (200.0, 0.8)]);
        let (x, _) = panel.scales();
        assert_eq!((x.from, x.to), (10.0, 1000.0), "law: 10 to 1000");
    }
}
