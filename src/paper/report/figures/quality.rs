//! Numerical creep and overlap of every run beside the accuracy standard.

use super::*;
use crate::report::Axis;

/// Height given to a run, in SVG units.
const ROW: u32 = 66;

/// A plot with a row a run, and some value of each.
fn by_run(runs: &[RunRecord], x: Axis) -> Plot {
    Plot::of_rows(x, runs.iter().map(|r| r.name.clone()).collect(), ROW)
}

fn add_dots(
    plot: &mut Plot,
    runs: &[RunRecord],
    n: usize,
    label: &str,
    value: impl Fn(&RunRecord) -> Option<f64>,
) {
    let points = runs.iter().enumerate().filter_map(|(i, r)| Some((value(r)?, i as f64)));
    plot.add(label, Look::points(n), points.collect());
}

pub(super) fn creep(study: &StudyView, standard: &Standard) -> Result<Figure, ReportError> {
    let runs = study.runs;
    let limit = standard.creep_um_per_s;
    let mut plot = by_run(runs, Axis::linear("Numerical creep of the resting specimen (µm/s)"));
    plot.mark_bounds(&format!("Standard: within ±{limit} µm/s"), limit);
    let label = "Sinking rate of the mean grain height";
    add_dots(&mut plot, runs, 0, label, |r| r.summary.creep_um_per_s);
    let table = table!(runs.iter().map(|r| (r, r.summary.rest_test)), |(r, c)| {
        "run" => &r.name,
        "creep_um_per_s" => r.summary.creep_um_per_s,
        "rest_test_s" => c.map(|c| c.duration_s),
        "mean_grain_height_drop_mm" => c.and_then(|c| c.mean_grain_height_drop_mm),
        "mean_surface_drop_mm" => c.and_then(|c| c.mean_surface_drop_mm),
        "plate_drop_mm" => c.and_then(|c| c.plate_drop_mm),
    });
    let found = match Interval::of(runs.iter().filter_map(|r| r.summary.creep_um_per_s)) {
        Some(i) if i.low.abs().max(i.high.abs()) < 0.05 => {
            "Found: less than 0.05 µm/s in every rest test.".to_owned()
        }
        Some(i) => format!("Found: {} to {} µm/s.", number(i.low, 1), number(i.high, 1)),
        None => "No run had a rest test.".to_owned(),
    };
    let caption = format!(
        "Numerical creep in the rest test: each finished specimen is left alone, nothing moves, and its \
         mean grain height should stay where it is. Dotted: the accuracy standard, ±{limit} µm/s, which \
         is {} mm in 20 s. {found}",
        number(limit * 20e-3, 1)
    );
    Figure::new(
        "quality-creep",
        "Numerical creep of the specimens at rest",
        caption,
        &[plot],
        &table,
    )
}

pub(super) fn overlap(study: &StudyView, standard: &Standard) -> Result<Figure, ReportError> {
    let runs = study.runs;
    let (mean_limit, p99_limit) = (standard.overlap_mean_percent, standard.overlap_p99_percent);
    let mut plot = by_run(runs, Axis::logarithmic("Overlap (% of the equivalent diameter)"));
    for (label, at) in [("mean", mean_limit), ("99th percentile", p99_limit)] {
        plot.mark_upright(&format!("Standard: {label} below {at} %"), [at]);
    }
    add_dots(&mut plot, runs, 0, "Mean", |r| Some(r.summary.overlap.mean_percent));
    add_dots(&mut plot, runs, 1, "99th percentile", |r| Some(r.summary.overlap.p99_percent));
    add_dots(&mut plot, runs, 5, "Largest", |r| Some(r.summary.overlap.max_percent));
    let table = table!(runs.iter().map(|r| (r, r.summary.overlap)), |(r, o)| {
        "run" => &r.name,
        "pairs" => o.pairs,
        "mean_percent" => o.mean_percent,
        "p99_percent" => o.p99_percent,
        "max_percent" => o.max_percent,
        "max_mm" => o.max_mm,
    });
    let caption = format!(
        "Overlap of touching grains at the end of each run, measured outside the engine from the \
         exact shapes: penetration depth over the mean equivalent diameter of the two grains. \
         The accuracy standard: dotted for the mean, {mean_limit} %; dashed and dotted for the 99th \
         percentile, {p99_limit} %."
    );
    Figure::new("quality-overlap", "Overlap of the grains", caption, &[plot], &table)
}
