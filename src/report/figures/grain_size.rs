//! Figure 1: grain size distribution curve.

use super::Figure;
use crate::{
    paper::{StudyView, gradation_in_words},
    report::{
        ReportError,
        axis::{Axis, Scale},
        plot::{Look, Plot},
        style,
        table::{Table, row},
    },
};

/// Openings of sieves in a decade (ISO 565, series R 10).
const OPENINGS: [f64; 10] = [1.0, 1.25, 1.6, 2.0, 2.5, 3.15, 4.0, 5.0, 6.3, 8.0];

/// Most openings that are numbered; wider axes are numbered as others are.
const MOST_OPENINGS: usize = 12;

/// A logarithmic axis from the opening of one sieve to that of another,
/// numbered at the openings between.
fn size_axis(sizes: impl Iterator<Item = f64>) -> Axis {
    let name = "Grain size (mm)";
    let (low, high) =
        sizes.fold((f64::INFINITY, 0.0_f64), |(low, high), s| (low.min(s), high.max(s)));
    if !(low > 0.0 && low < high) {
        return Axis::logarithmic(name);
    }
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

/// The paper's Figure 1, of a study.
pub(super) fn figure(study: &StudyView) -> Result<Figure, ReportError> {
    let (plot, table) = draw(&study.sieve, &study.sieved_grains);
    let made = study.generated.as_ref().map_or_else(String::new, |made| {
        format!(
            " The grains generated from it, each through the virtual sieve (the smallest square \
             opening that it passes in any orientation): {}.",
            gradation_in_words(made)
        )
    });
    let caption = format!(
        "Grain size distribution of the simulated gravel, as specified: {}.{made} The paper's \
         curve was not available to us (only its text was); the specified one is ours, chosen so that the numbers of the text (1456 \
         grains of 2343 g, 55 to 65 in 100 g, poorly graded) come out.",
        gradation_in_words(&study.gradation),
    );
    Figure::new(
        "figure-01-grain-size-distribution",
        "Figure 1. Grain size distribution",
        caption,
        &[plot],
        &table,
    )
}

/// Specified against generated.
fn draw(specified: &[(f64, f64)], generated: &[(f64, f64)]) -> (Plot, Table) {
    let x = size_axis(specified.iter().chain(generated).map(|p| p.0));
    let y = Axis::with_ticks("Mass passing (%)", &[0.0, 20.0, 40.0, 60.0, 80.0, 100.0]);
    let mut plot = Plot::new(x, y);
    let curves = [
        ("Sieve data the grains are made from", Look::marked(0), specified),
        ("Generated grains, sieved", Look::spaced(1).dash(style::DASHED), generated),
    ];
    let mut table = Table::new(["curve", "size_mm", "passing_percent"]);
    for (label, look, points) in curves.into_iter().filter(|c| !c.2.is_empty()) {
        plot.add(label, look, points.to_vec());
        for &(size, passing) in points {
            table.row(row![label, size, passing]);
        }
    }
    (plot, table)
}

/// The curves of a single run's grains, in its own folder. `words` says
/// what is read off each curve.
pub(in crate::report) fn of_grains(
    specified: &[(f64, f64)],
    generated: &[(f64, f64)],
    words: &str,
) -> Result<Figure, ReportError> {
    let (plot, table) = draw(specified, generated);
    let caption = format!(
        "Grain size distribution of the grains, each through the virtual sieve (the smallest \
         square opening that it passes in any orientation). {words}"
    );
    Figure::new("grain-size-distribution", "Grain size distribution", caption, &[plot], &table)
}
