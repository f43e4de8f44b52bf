//! Curves of several engines in one frame.

use super::Figure;
use crate::{
    record::SeriesRow,
    report::{
        Comparison, ReportError,
        axis::Axis,
        plot::{Look, Plot},
        style,
        table::{Table, row},
    },
};

/// What a figure shows of every run, over its time.
struct Shown {
    stem: &'static str,
    title: &'static str,
    caption: &'static str,
    axis: &'static str,
    column: &'static str,
    is_log: bool,
    needs_vibration: bool,
    value: fn(&SeriesRow) -> Option<f64>,
}

const SHOWN: [Shown; 4] = [
    Shown {
        stem: "compare-height",
        title: "Mean height of the grains",
        caption: "Mean height of the grains in the cylinder over the time of each run; dashed where \
                  the specimen came from another engine.",
        axis: "Mean grain height (mm)",
        column: "mean_grain_height_mm",
        is_log: false,
        needs_vibration: false,
        value: |r| (r.grains_in_cylinder > 0).then_some(r.mean_grain_height_mm),
    },
    Shown {
        stem: "compare-energy",
        title: "Kinetic energy",
        caption: "Kinetic energy of grains and plate relative to the table.",
        axis: "Kinetic energy (J)",
        column: "kinetic_energy_j",
        is_log: true,
        needs_vibration: false,
        value: |r| Some(r.kinetic_energy_j),
    },
    Shown {
        stem: "compare-settlement",
        title: "Settlement of the mean surface",
        caption: "Drop of the mean surface since the vibration began, at the times of each run.",
        axis: "Settlement of the surface (mm)",
        column: "surface_settlement_mm",
        is_log: false,
        needs_vibration: true,
        value: |r| r.surface_settlement_mm,
    },
    Shown {
        stem: "compare-plate",
        title: "Settlement of the top plate",
        caption: "Drop of the plate's centre since the vibration began, at the times of each run.",
        axis: "Settlement of the plate (mm)",
        column: "settlement_mm",
        is_log: false,
        needs_vibration: true,
        value: |r| r.settlement_mm,
    },
];

/// Heights, energy and, where vibrated, settlement.
///
/// # Errors
/// [`ReportError::Figure`].
pub(in crate::report) fn of_comparison(of: &Comparison) -> Result<Vec<Figure>, ReportError> {
    let shown = SHOWN.iter().filter(|shown| of.vibrated || !shown.needs_vibration);
    shown.map(|shown| overlaid(of, shown)).collect()
}

fn overlaid(of: &Comparison, shown: &Shown) -> Result<Figure, ReportError> {
    let point = |r: &SeriesRow| Some((r.time_s, (shown.value)(r)?));
    let curves: Vec<Vec<(f64, f64)>> =
        of.runs.iter().map(|r| r.record.series.iter().filter_map(point).collect()).collect();
    let all = || curves.iter().flatten();
    let values = all().map(|p| p.1).chain((!shown.is_log).then_some(0.0));
    let y = Axis::scaled(shown.is_log, shown.axis, values);
    let mut plot = Plot::new(Axis::linear("Time (s)", all().map(|p| p.0)), y);
    let mut table = Table::new(["run", "time_s", shown.column]);
    for (n, (run, points)) in of.runs.iter().zip(&curves).enumerate() {
        for (time, value) in points {
            table.row(row![&run.record.name, *time, *value]);
        }
        let is_handed = run.specimen_by.is_some();
        let dash = if is_handed { style::DASHED } else { style::SOLID };
        plot.add(&run.record.name, Look::line(n).dash(dash), points.clone());
    }
    Figure::new(shown.stem, shown.title, shown.caption, &[plot], &table)
}
