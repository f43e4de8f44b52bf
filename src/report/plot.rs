//! A plot: frame, axes, curves, bands, markers and a legend, drawn as SVG.
//!
//! Everything is placed in SVG units by [`Axis`]; plotters writes the SVG.
//! What has no place (NaN, a logarithm of zero) is left out.

mod pen;

use plotters::style::RGBColor;

use super::*;

/// How a series looks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Look {
    /// Colour of line and markers.
    pub colour: RGBColor,
    /// Dash pattern; `None` without a line.
    pub line: Option<Dash>,
    /// Width of the line.
    pub width: u32,
    /// Shape of the markers; `None` without.
    pub marker: Option<Marker>,
    /// Distance of markers in SVG units along x; `None` marks every point.
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

    /// Small markers alone, of many points.
    pub fn dots(n: usize) -> Self {
        Self::points(n).thin()
    }

    /// A dashed line: a law, or what others measured.
    pub fn law(n: usize) -> Self {
        Self::line(n).dash(style::DASHED)
    }

    /// A line with a marker here and there, so that several can be told apart.
    pub fn spaced(n: usize) -> Self {
        Self::marked(n).every(style::MARKER_SPACING)
    }

    /// Thin rings where single runs are.
    pub fn rings() -> Self {
        Self { line: None, ..Self::of(style::LIMIT).thin().marker(Marker::Ring) }
    }

    /// The n-th mark across the frame: a limit, or an event.
    fn mark(n: usize) -> Self {
        let dash = if n.is_multiple_of(2) { style::DOTTED } else { style::DASH_DOTTED };
        Self { width: 4, ..Self::of(style::LIMIT).dash(dash) }
    }

    /// The same, dashed so.
    pub fn dash(self, dash: Dash) -> Self {
        Self { line: Some(dash), ..self }
    }

    /// The same in thin lines and small markers.
    pub fn thin(self) -> Self {
        Self { width: style::THIN, ..self }
    }

    /// The same with markers of a shape.
    pub fn marker(self, marker: Marker) -> Self {
        Self { marker: Some(marker), ..self }
    }

    /// With markers at a distance in SVG units.
    pub fn every(self, spacing: f64) -> Self {
        Self { marker_spacing: Some(spacing), ..self }
    }
}

/// A series of points.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// Its entry in the legend; empty for none.
    pub label: String,
    /// How it looks.
    pub look: Look,
    /// Points in values of the axes.
    pub points: Vec<(f64, f64)>,
}

/// A horizontal band.
#[derive(Debug, Clone, PartialEq)]
pub struct BandArea {
    /// Its entry in the legend.
    pub label: String,
    /// Ends on the vertical axis.
    pub between: (f64, f64),
}

/// The area between two curves.
#[derive(Debug, Clone, PartialEq)]
pub struct Envelope {
    /// Its entry in the legend.
    pub label: String,
    /// Places on the horizontal axis with the lower and the upper value there.
    pub edges: Vec<(f64, f64, f64)>,
}

/// A straight line across the frame, marking a limit or an event.
#[derive(Debug, Clone, PartialEq)]
pub struct Mark {
    /// Its entry in the legend; empty for none.
    pub label: String,
    /// Value on its axis.
    pub at: f64,
    /// Whether it stands upright (a value of the horizontal axis).
    pub upright: bool,
}

/// Everything in one plot.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Plot {
    /// Horizontal axis.
    pub x: Axis,
    /// Vertical axis.
    pub y: Axis,
    /// Names in place of numbers on the horizontal axis, one a tick; ticks divide it evenly.
    pub x_names: Option<Vec<String>>,
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
    /// Space left of the frame in SVG units, at least.
    least_left: i32,
}

impl Plot {
    /// An empty plot.
    pub fn new(x: Axis, y: Axis) -> Self {
        Self { x, y, frame_height: style::FRAME_HEIGHT, ..Self::default() }
    }

    /// An empty plot of settlement over time, drawn downwards, the way the plate goes.
    pub fn of_settlement() -> Self {
        Self::new(
            Axis::linear("Time since vibration began (s)").from_zero(),
            Axis::linear("Settlement (mm)").from_zero().reversed(),
        )
    }

    /// An empty plot of standing heights over falling heights from 0 to a highest in cm; markers at
    /// the ends stand clear of the frame.
    pub fn of_standing_heights(highest: f64) -> Self {
        let ticks = (0..=4).map(|i| f64::from(i) * highest / 4.0).collect();
        let (from, to) = (-0.05 * highest, 1.05 * highest);
        let x = Scale { from, to, ticks, ..Scale::default() };
        Self::new(Axis::divided("Falling height (cm)", x), Axis::linear("Standing height (mm)"))
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

    /// Adds an entry to the legend for thin dashed curves, where there are any curves.
    pub fn add_key_of_thin(&mut self, label: &str) {
        if !self.series.is_empty() {
            self.add(label, Look::of(style::INK).dash(style::DASHED).thin(), Vec::new());
        }
    }

    /// Adds a series, and its entry in the legend, where it has points.
    pub fn add_some(
        &mut self,
        label: impl Into<String>,
        look: Look,
        points: impl IntoIterator<Item = (f64, f64)>,
    ) {
        let points: Vec<(f64, f64)> = points.into_iter().collect();
        if !points.is_empty() {
            self.add(label, look, points);
        }
    }

    /// Adds a line between two ends, and at each end a stroke that reaches `dx` and `dy` to both
    /// sides, in values of the axes.
    pub fn add_interval(
        &mut self,
        label: &str,
        look: Look,
        ends: [(f64, f64); 2],
        (dx, dy): (f64, f64),
    ) {
        self.add(label, look, ends.to_vec());
        for (x, y) in ends {
            self.add("", look, vec![(x - dx, y - dy), (x + dx, y + dy)]);
        }
    }

    /// Marks a value of the vertical axis.
    pub fn mark_level(&mut self, label: impl Into<String>, at: f64) {
        self.marks.push(Mark { label: label.into(), at, upright: false });
    }

    /// Marks values of the horizontal axis, with one entry in the legend.
    pub fn mark_upright(&mut self, label: &str, values: impl IntoIterator<Item = f64>) {
        let labels = std::iter::once(label).chain(std::iter::repeat(""));
        for (label, at) in labels.zip(values) {
            self.marks.push(Mark { label: label.to_owned(), at, upright: true });
        }
    }

    /// Marks how far a value may be from zero to either side, with one entry in the legend. The
    /// horizontal axis reaches beyond both, so that neither lies on the frame.
    pub fn mark_bounds(&mut self, label: &str, most: f64) {
        const BEYOND: f64 = 1.1;
        self.mark_upright(label, [most, -most]);
        self.x = std::mem::take(&mut self.x).holding([BEYOND * most, -BEYOND * most]);
    }

    /// Hatches the laboratory's range on the vertical axis.
    pub fn add_band(&mut self, label: &str, between: (f64, f64)) {
        self.bands.push(BandArea { label: label.to_owned(), between });
    }

    /// The marks, each with its look: those of one entry in the legend look alike, those of the next
    /// do not.
    fn looks_of_marks(&self) -> Vec<(&Mark, Look)> {
        let mut entries = 0usize;
        let marks = self.marks.iter().map(|mark| {
            entries += usize::from(!mark.label.is_empty());
            (mark, Look::mark(entries.saturating_sub(1)))
        });
        marks.collect()
    }

    /// Both axes, divided for all that is drawn.
    pub(super) fn scales(&self) -> (Scale, Scale) {
        let points = self.series.iter().flat_map(|series| &series.points);
        let edges = self.envelopes.iter().flat_map(|envelope| &envelope.edges);
        let bands = self.bands.iter().flat_map(|band| [band.between.0, band.between.1]);
        let marks = |upright| self.marks.iter().filter(move |m| m.upright == upright).map(|m| m.at);
        let x = points.clone().map(|p| p.0).chain(edges.clone().map(|e| e.0)).chain(marks(true));
        let y = points.map(|p| p.1).chain(edges.flat_map(|e| [e.1, e.2])).chain(bands);
        (self.x.scale(x), self.y.scale(y.chain(marks(false))))
    }
}

/// Plots over the same quantity, to stand one below the other: their horizontal axes reach to what any
/// of them draws, and their frames begin at the same place.
pub fn aligned(mut plots: Vec<Plot>) -> Vec<Plot> {
    if plots.len() < 2 {
        return plots;
    }
    let points = plots.iter().flat_map(|plot| &plot.series).flat_map(|series| &series.points);
    let marks = plots.iter().flat_map(|plot| &plot.marks).filter(|mark| mark.upright);
    let drawn: Vec<f64> = points.map(|p| p.0).chain(marks.map(|mark| mark.at)).collect();
    let left = plots.iter().map(Plot::left).max().unwrap_or(0);
    for plot in &mut plots {
        plot.x = std::mem::take(&mut plot.x).holding(drawn.iter().copied());
        plot.least_left = left;
    }
    plots
}

/// Plots that are read alike, one below the other, with one legend: that of the last, which has the
/// entries of all others, too.
pub fn with_one_legend(plots: impl IntoIterator<Item = Plot>) -> Vec<Plot> {
    let mut plots: Vec<Plot> = plots.into_iter().collect();
    let Some(mut last) = plots.pop() else { return plots };
    for series in plots.iter_mut().flat_map(|plot| &mut plot.series) {
        let label = std::mem::take(&mut series.label);
        let is_known = |known: &Series| known.label == label;
        if !label.is_empty() && !last.series.iter().any(is_known) {
            last.add(label, series.look, Vec::new());
        }
    }
    plots.push(last);
    plots
}

/// Plots as one SVG, one below the other; else a sentence on what could not be drawn.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_to_draw_is_still_a_plot() {
        let mut plot = Plot::new(Axis::linear("x"), Axis::logarithmic("y"));
        let look = Look::of(style::INK).dash(style::DASHED).thin().marker(Marker::Cross);
        for points in [vec![], vec![(f64::NAN, 1.0)], vec![(0.5, 0.0)], vec![(1e300, 1e300)]] {
            plot.add("a < b & c", look, points);
        }
        plot.add_band("band", (f64::NAN, 1.0));
        let svg = plot.svg().expect("drawn");
        assert!(svg.contains("a &lt; b &amp; c"), "labels are escaped");
        assert!(!svg.contains("NaN"), "no NaN reaches the file");
    }

    /// Law: one legend explains all that is drawn, each thing once, also what the last plot lacks.
    #[test]
    fn one_legend_is_of_all_plots() {
        let plot = |labels: &[&str]| {
            let mut plot = Plot::new(Axis::linear("x"), Axis::linear("y"));
            for (n, label) in labels.iter().enumerate() {
                plot.add(*label, Look::points(n), vec![(0.0, 1.0)]);
            }
            plot
        };
        let labels = |plot: &Plot| -> Vec<String> {
            let labels = plot.series.iter().map(|series| series.label.clone());
            labels.filter(|label| !label.is_empty()).collect()
        };
        let got = with_one_legend([plot(&["runs", "", "left out"]), plot(&["means", "runs"])]);
        assert!(labels(&got[0]).is_empty(), "law: the first has no legend: {:?}", got[0].series);
        assert_eq!(labels(&got[1]), ["means", "runs", "left out"], "law: the last has all of it");
        let added: Vec<&Series> = got[1].series.iter().skip(2).collect();
        assert!(matches!(added[..], [alone] if alone.points.is_empty()), "law: a key: {added:?}");
        let same = with_one_legend([plot(&["runs"]), plot(&["runs"])]);
        assert_eq!(same[1], plot(&["runs"]), "law: what has all entries stays as it is");
        assert!(with_one_legend([]).is_empty(), "law: nothing has none");
    }

    /// Law: entries of the legend end on the sheet, however long they are, as pixels of DejaVu Sans
    /// show; all of their words are there.
    #[test]
    fn long_entries_of_a_legend_stay_on_the_sheet() {
        let long = "pieces.0.shape.hopper.outlet_diameter_mm = wide opening of the northern quarry's \
                    second silo, as measured in the spring before its walls were lined";
        let path = "grains.cells.".repeat(12);
        let mut plot = Plot::new(Axis::linear("x"), Axis::linear("y"));
        for (n, label) in [long, "short", path.as_str()].into_iter().enumerate() {
            plot.add(label, Look::marked(n), vec![(0.0, 1.0), (1.0, 2.0)]);
        }
        let svg = plot.svg().expect("drawn");
        let (width, height, pixels) = crate::report::png::draw(&svg).expect("pixels");
        let below = plot.frame_height + (style::TOP + style::BELOW) as u32;
        let is_dark = |(x, y): &(u32, u32)| pixels[(4 * (y * width + x)) as usize] < 128;
        let places = (below..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        let end = places.filter(is_dark).map(|(x, _)| x).max().unwrap_or(0);
        assert!((1500..1980).contains(&end), "law: ink ends before 1980 of {width}, got {end}");
        for word in long.replace('\'', "&apos;").split(' ') {
            assert!(svg.contains(word), "law: `{word}` is written");
        }
    }

    /// Law: bounds stand inside of the frame, where all values are within them and where none is.
    #[test]
    fn bounds_are_not_on_the_frame() {
        for values in [vec![], vec![(0.01, 0.0)], vec![(-4.9, 0.0), (40.0, 1.0)]] {
            let mut plot = Plot::new(Axis::linear("x"), Axis::linear("y"));
            plot.add("", Look::points(0), values.clone());
            plot.mark_bounds("Standard", 5.0);
            let (x, _) = plot.scales();
            let places = [-5.0, 5.0].map(|bound| x.place(bound).expect("a place"));
            let inside = places.iter().all(|place| (0.01..=0.99).contains(place));
            assert!(inside, "law: by a hundredth at least, of {values:?} got {places:?}");
        }
    }

    /// Law: two limits in one figure can be told apart in it as in its legend; the two sides of one
    /// look alike.
    #[test]
    fn marks_of_two_entries_do_not_look_alike() {
        let mut plot = Plot::new(Axis::linear("x"), Axis::linear("y"));
        plot.mark_upright("1 %", [1.0, -1.0]);
        plot.mark_upright("5 %", [5.0, -5.0]);
        let looks: Vec<Look> = plot.looks_of_marks().into_iter().map(|(_, look)| look).collect();
        assert_eq!([looks[0], looks[2]], [looks[1], looks[3]], "law: both sides of one limit");
        assert_ne!(looks[0].line, looks[2].line, "law: the second limit is dashed otherwise");
    }
}
