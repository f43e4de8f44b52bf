//! The figures of a single run, for its own folder.

use super::{Figure, Table, cell, settlement};
use crate::{
    record::{RunRecord, SeriesRow},
    report::{
        ReportError,
        axis::Axis,
        plot::{Look, Mark, Plot, Series},
        style,
    },
};

const MARKER_SPACING: f64 = 170.0;

/// `heights`, `energy` and, where the run was vibrated, `settlement`.
///
/// # Errors
/// [`ReportError::Figure`].
pub(in crate::report) fn of_run(run: &RunRecord) -> Result<Vec<Figure>, ReportError> {
    let mut figures = vec![heights(run)?, energy(run)?];
    figures.extend(settlement::of_run(run)?);
    Ok(figures)
}

fn curve(
    run: &RunRecord,
    n: usize,
    label: &str,
    value: impl Fn(&SeriesRow) -> Option<f64>,
) -> Series {
    let points: Vec<(f64, f64)> = run
        .series
        .iter()
        .filter_map(|r| Some((r.time_s, value(r)?)))
        .filter(|(t, v)| t.is_finite() && v.is_finite())
        .collect();
    // A curve that is not there has no place in the legend.
    let label = if points.is_empty() { "" } else { label };
    Series {
        label: label.to_owned(),
        look: Look {
            colour: style::colour(n),
            line: Some(style::SOLID),
            width: style::CURVE,
            marker: Some(style::marker(n)),
            marker_spacing: Some(MARKER_SPACING),
        },
        points,
    }
}

/// Time axis and the beginning of every stage but the first.
fn over_time(run: &RunRecord, y: Axis) -> Plot {
    let x = Axis::linear("Time (s)", run.series.iter().map(|r| r.time_s).chain([0.0]));
    let mut plot = Plot::new(x, y);
    for rows in run.series.windows(2).filter(|w| w[1].stage != w[0].stage) {
        let label = if plot.marks.is_empty() { "Beginning of a stage" } else { "" };
        plot.marks.push(Mark { label: label.into(), at: rows[1].time_s, upright: true });
    }
    plot
}

fn heights(run: &RunRecord) -> Result<Figure, ReportError> {
    let series = [
        curve(run, 0, "Mean surface", |r| Some(r.mean_surface_mm)),
        curve(run, 1, "Mean height of the grains", |r| Some(r.mean_grain_height_mm)),
        curve(run, 2, "Lower face of the plate", |r| r.plate_height_mm),
        curve(run, 3, "Top of the pile above its base", |r| r.pile_height_mm),
    ];
    let values = series.iter().flat_map(|s| s.points.iter().map(|p| p.1)).chain([0.0]);
    let mut plot = over_time(run, Axis::linear("Height above the floor (mm)", values));
    plot.series.extend(series);
    let mut table = Table::new(&[
        "time_s",
        "stage",
        "mean_surface_mm",
        "mean_grain_height_mm",
        "plate_height_mm",
        "grains_in_cylinder",
        "pile_height_mm",
    ]);
    for r in &run.series {
        table.row([
            cell(r.time_s),
            r.stage.to_string(),
            cell(r.mean_surface_mm),
            cell(r.mean_grain_height_mm),
            cell(r.plate_height_mm),
            r.grains_in_cylinder.to_string(),
            cell(r.pile_height_mm),
        ]);
    }
    let caption = "Heights over the time of the run.".to_owned();
    Figure::new("heights", "Heights over time", caption, &plot, &table)
}

fn energy(run: &RunRecord) -> Result<Figure, ReportError> {
    let mut series = curve(run, 0, "", |r| Some(r.kinetic_energy_j));
    series.look.marker = None;
    let y = Axis::logarithmic("Kinetic energy (J)", series.points.iter().map(|p| p.1));
    let mut plot = over_time(run, y);
    plot.series.push(series);
    let mut table = Table::new(&["time_s", "stage", "kinetic_energy_j", "largest_speed_m_per_s"]);
    for r in &run.series {
        table.row([
            cell(r.time_s),
            r.stage.to_string(),
            cell(r.kinetic_energy_j),
            cell(r.largest_speed_m_per_s),
        ]);
    }
    let caption = "Kinetic energy of grains and plate relative to the table.".to_owned();
    Figure::new("energy", "Kinetic energy over time", caption, &plot, &table)
}
