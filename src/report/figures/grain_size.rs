//! Figure 1: grain size distribution curve.

use super::{Figure, Table, cell};
use crate::{
    paper::{StudyView, text::number},
    report::{
        ReportError,
        axis::Axis,
        plot::{Look, Plot, Series},
        style,
    },
};

pub(super) fn figure(study: &StudyView) -> Result<Figure, ReportError> {
    let sizes = study.sieve.iter().chain(&study.sieved_grains).map(|p| p.0);
    let x = Axis::logarithmic("Grain size (mm)", sizes);
    let y = Axis::with_ticks("Mass passing (%)", &[0.0, 20.0, 40.0, 60.0, 80.0, 100.0]);
    let mut plot = Plot::new(x, y);
    let look = |n: usize, line| Look {
        colour: style::colour(n),
        line: Some(line),
        width: style::CURVE,
        marker: Some(style::marker(n)),
        marker_spacing: None,
    };
    let curves = [
        ("Sieve data the grains are made from", look(0, style::SOLID), &study.sieve),
        ("Generated grains, sieved", look(1, style::DASHED), &study.sieved_grains),
    ];
    let mut table = Table::new(&["curve", "size_mm", "passing_percent"]);
    for (label, look, points) in curves.into_iter().filter(|c| !c.2.is_empty()) {
        plot.series.push(Series { label: label.to_owned(), look, points: points.clone() });
        for &(size, passing) in points {
            table.row([label.to_owned(), cell(size), cell(passing)]);
        }
    }
    let g = &study.gradation;
    let caption = format!(
        "Grain size distribution of the simulated gravel: {}, D10 {} mm, D30 {} mm, D60 {} mm, Cu \
         {}, Cc {}. The paper's curve is lost; this one is ours, chosen so that the numbers of the \
         text (1456 grains of 2343 g, 55 to 65 in 100 g, poorly graded) come out.",
        g.uscs,
        number(g.d10_mm, 2),
        number(g.d30_mm, 2),
        number(g.d60_mm, 2),
        number(g.cu, 2),
        number(g.cc, 2),
    );
    Figure::new(
        "figure-01-grain-size-distribution",
        "Figure 1. Grain size distribution",
        caption,
        &plot,
        &table,
    )
}
