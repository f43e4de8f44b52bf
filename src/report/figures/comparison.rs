//! Curves of several engines in one frame.

use super::{Figure, Table, cell};
use crate::{
    record::SeriesRow,
    report::{
        ComparedRun, Comparison, ReportError,
        axis::Axis,
        plot::{Look, Plot, Series},
        style,
    },
};

/// Heights, energy and, where vibrated, settlement.
///
/// # Errors
/// [`ReportError::Figure`].
pub(in crate::report) fn of_comparison(of: &Comparison) -> Result<Vec<Figure>, ReportError> {
    let mut figures = vec![
        overlaid(
            of,
            "compare-height",
            "Mean height of the grains",
            "Mean height of the grains in the cylinder over the time of each run; dashed where the \
             specimen came from another engine.",
            ("Time (s)", "Mean grain height (mm)", "mean_grain_height_mm"),
            false,
            |r| (r.grains_in_cylinder > 0).then_some((r.time_s, r.mean_grain_height_mm)),
        )?,
        overlaid(
            of,
            "compare-energy",
            "Kinetic energy",
            "Kinetic energy of grains and plate relative to the table.",
            ("Time (s)", "Kinetic energy (J)", "kinetic_energy_j"),
            true,
            |r| Some((r.time_s, r.kinetic_energy_j)),
        )?,
    ];
    if of.vibrated {
        figures.push(overlaid(
            of,
            "compare-settlement",
            "Settlement of the mean surface",
            "Drop of the mean surface since the vibration began, at the times of each run.",
            ("Time (s)", "Settlement of the surface (mm)", "surface_settlement_mm"),
            false,
            |r| r.surface_settlement_mm.map(|s| (r.time_s, s)),
        )?);
        figures.push(overlaid(
            of,
            "compare-plate",
            "Settlement of the top plate",
            "Drop of the plate's centre since the vibration began, at the times of each run.",
            ("Time (s)", "Settlement of the plate (mm)", "settlement_mm"),
            false,
            |r| r.settlement_mm.map(|s| (r.time_s, s)),
        )?);
    }
    Ok(figures)
}

fn overlaid(
    of: &Comparison,
    stem: &str,
    title: &str,
    caption: &str,
    (x, y, column): (&str, &str, &'static str),
    decades: bool,
    point: impl Fn(&SeriesRow) -> Option<(f64, f64)>,
) -> Result<Figure, ReportError> {
    let curves: Vec<(&ComparedRun, Vec<(f64, f64)>)> =
        of.runs.iter().map(|r| (r, r.record.series.iter().filter_map(&point).collect())).collect();
    let all = || curves.iter().flat_map(|(_, points)| points);
    let values = all().map(|p| p.1).chain((!decades).then_some(0.0));
    let vertical = if decades { Axis::logarithmic(y, values) } else { Axis::linear(y, values) };
    let mut plot = Plot::new(Axis::linear(x, all().map(|p| p.0)), vertical);
    let mut table = Table::new(&["run", "time_s", column]);
    for (n, (run, points)) in curves.into_iter().enumerate() {
        for (time, value) in &points {
            table.row([run.record.name.clone(), cell(*time), cell(*value)]);
        }
        let handed = run.specimen_by.is_some();
        plot.series.push(Series {
            label: run.record.name.clone(),
            look: Look {
                colour: style::colour(n),
                line: Some(if handed { style::DASHED } else { style::SOLID }),
                width: style::CURVE,
                marker: None,
                marker_spacing: None,
            },
            points,
        });
    }
    Figure::new(stem, title, caption.to_owned(), &plot, &table)
}
