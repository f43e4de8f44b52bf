//! The grains: their grain size distribution, and how elongation, flatness and sphericity are spread.

use super::*;
use crate::grains::ShapeRatio;

/// Openings of sieves in a decade (ISO 565, series R 10).
const OPENINGS: [f64; 10] = [1.0, 1.25, 1.6, 2.0, 2.5, 3.15, 4.0, 5.0, 6.3, 8.0];

/// Most openings that are numbered; wider axes are numbered as others are.
const MOST_OPENINGS: usize = 12;

/// A logarithmic axis from the opening of one sieve to that of another,
/// numbered at the openings between.
fn size_axis(sizes: impl Iterator<Item = f64>) -> Axis {
    let name = "Grain size (mm)";
    let range = Interval::of(sizes).filter(|range| range.low > 0.0 && range.low < range.high);
    let Some(Interval { low, high }) = range else { return Axis::logarithmic(name) };
    let first = low.log10().floor() as i32;
    let openings: Vec<f64> =
        (first..=first + 2).flat_map(|decade| OPENINGS.map(|o| o * 10f64.powi(decade))).collect();
    let from = openings.iter().rposition(|o| *o <= low);
    let to = openings.iter().position(|o| *o >= high);
    match from.zip(to).filter(|(from, to)| to - from < MOST_OPENINGS) {
        Some((from, to)) => {
            let ticks = openings[from..=to].to_vec();
            let (from, to) = (openings[from], openings[to]);
            Axis::divided(name, Scale { from, to, log: true, ticks, minor: Vec::new() })
        }
        None => Axis::logarithmic(name),
    }
}

/// Specified against generated.
pub(crate) fn curves(
    stem: &str,
    title: &str,
    caption: String,
    [specified, generated]: [&[(f64, f64)]; 2],
) -> Result<Figure, ReportError> {
    let x = size_axis(specified.iter().chain(generated).map(|p| p.0));
    let y = Axis::with_ticks("Mass passing (%)", &[0.0, 20.0, 40.0, 60.0, 80.0, 100.0]);
    let mut plot = Plot::new(x, y);
    let look = Look::spaced(1).dash(style::DASHED);
    let specified = specified.iter().copied();
    plot.add_some("Sieve data the grains are made from", Look::marked(0), specified);
    plot.add_some("Generated grains, sieved", look, generated.iter().copied());
    Figure::of_curves(stem, title, caption, &[plot], &["curve", "size_mm", "passing_percent"])
}

/// Name, symbol and column of a number.
fn named(ratio: ShapeRatio) -> (&'static str, &'static str) {
    match ratio {
        ShapeRatio::Elongation => ("Elongation L/I", "elongation"),
        ShapeRatio::Flatness => ("Flatness I/S", "flatness"),
        ShapeRatio::Sphericity => ("Sphericity", "sphericity"),
    }
}

/// Distribution of the three numbers over the grains, each counted once.
pub(crate) fn of_shapes(shapes: &[GrainShape]) -> Result<Figure, ReportError> {
    let x = Axis::linear("Ratio (–)").holding([0.0, 1.0]);
    let y = Axis::with_ticks("Grains with less (%)", &[0.0, 20.0, 40.0, 60.0, 80.0, 100.0]);
    let mut plot = Plot::new(x, y);
    let mut table = Table::new(["ratio", "value", "grains_with_at_most_percent"]);
    let mut medians = Vec::new();
    let lines = [style::SOLID, style::DASHED, style::DOTTED];
    for (n, ratio) in ShapeRatio::ALL.into_iter().enumerate() {
        let (label, column) = named(ratio);
        let points = distribution(shapes.iter().map(|s| s.ratio(ratio)));
        for &(value, percent) in &points {
            table.row(row![column, value, percent]);
        }
        let at = |percent| points.iter().find(|p| p.1 >= percent).map_or(f64::NAN, |p| p.0);
        medians.push(format!(
            "{} {} ({} to {})",
            column,
            number(at(50.0), 2),
            number(at(10.0), 2),
            number(at(90.0), 2)
        ));
        plot.add_some(label, Look::spaced(n).dash(lines[n]), points);
    }
    let mean = |value: fn(&GrainShape) -> usize| {
        shapes.iter().map(|s| value(s) as f64).sum::<f64>() / shapes.len() as f64
    };
    let caption = format!(
        "Shape of the {}, by number. L, I and S are the longest, intermediate and shortest \
         side of the box of the smallest volume that holds the grain; elongation is L/I and \
         flatness I/S (after Zingg 1935), sphericity the surface of the sphere of the grain's volume \
         over the grain's surface (Wadell 1932). Median, and 10th to 90th percentile: {}. A grain \
         has {} faces and {} vertices on average.",
        counted(shapes.len(), "grain"),
        medians.join(", "),
        number(mean(|s| s.faces), 1),
        number(mean(|s| s.vertices), 1),
    );
    Figure::new("grain-shape", "Shape of the grains", caption, &[plot], &table)
}

/// Value and percent of the grains that have at most it, ascending.
fn distribution(values: impl Iterator<Item = f64>) -> Vec<(f64, f64)> {
    let mut values: Vec<f64> = values.filter(|v| v.is_finite()).collect();
    values.sort_by(f64::total_cmp);
    let percent = |n: usize| 100.0 * (n + 1) as f64 / values.len() as f64;
    values.iter().enumerate().map(|(n, v)| (*v, percent(n))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A body with the given sides of its box, and the volume and surface of that box.
    fn shape(longest: f64, intermediate: f64, shortest: f64) -> GrainShape {
        GrainShape {
            roundness: 0.0,
            longest,
            intermediate,
            shortest,
            volume: longest * intermediate * shortest,
            surface: 2.0 * (longest * intermediate + intermediate * shortest + shortest * longest),
            faces: 6,
            vertices: 8,
        }
    }

    #[test]
    fn the_curves_are_those_of_the_shapes() {
        let shapes: Vec<GrainShape> = (1..=10).map(|n| shape(10.0, f64::from(n), 0.5)).collect();
        let figure = of_shapes(&shapes).expect("a figure");
        let rows: Vec<csv::StringRecord> = csv::Reader::from_reader(figure.csv.as_slice())
            .records()
            .map(|r| r.expect("a row"))
            .collect();
        assert_eq!(rows.len(), 30, "three numbers of ten grains");
        let elongation: Vec<f64> = rows
            .iter()
            .filter(|r| &r[0] == "elongation")
            .map(|r| r[1].parse().expect("a number"))
            .collect();
        for (n, value) in elongation.iter().enumerate() {
            let expected = 10.0 / (10 - n) as f64;
            assert!((value - expected).abs() < 1e-12, "L/I: expected {expected}, got {value}");
        }
        for said in ["Zingg", "Wadell", "10 grains", "elongation 1.67 (1.00 to 5.00)", "6.0 faces"]
        {
            assert!(figure.caption.contains(said), "{said} is missing: {}", figure.caption);
        }
    }

    #[test]
    fn no_grains_make_an_empty_figure() {
        let figure = of_shapes(&[]).expect("a figure");
        assert!(!figure.svg.contains("NaN"), "no NaN in the drawing");
        assert!(!figure.caption.contains("NaN"), "nor in the caption: {}", figure.caption);
    }
}
