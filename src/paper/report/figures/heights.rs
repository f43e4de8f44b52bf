//! Standing height over falling height: every run, and means with their confidence.

use super::*;
use crate::paper::uncertainty;
use crate::report::{quality::found_in, style::Marker};

/// Half the width of an interval's end stroke, in cm of falling height.
const STROKE_CM: f64 = 0.25;

/// Figure 7 of the paper: every run.
pub(super) fn over_falling_height(study: &StudyView) -> Result<Figure, ReportError> {
    let mut runs: Vec<&RunRecord> = study.of_kind(RunKind::Pluviation).collect();
    runs.sort_by(|a, b| {
        let falls = a.falling_height_mm.total_cmp(&b.falling_height_mm);
        a.configuration.cmp(&b.configuration).then(falls)
    });
    let p95 = |r: &RunRecord| r.summary.standing_height_mm.p95;
    let highest_fall =
        runs.iter().map(|r| r.falling_height_mm / MM_IN_CM).fold(20.0, f64::max).min(1e3);
    let mut plot = Plot::of_standing_heights(highest_fall);
    let each = runs.chunk_by(|a, b| a.configuration == b.configuration);
    for (n, of) in each.enumerate() {
        let points = |height: &dyn Fn(&RunRecord) -> f64| {
            of.iter().map(|r| (r.falling_height_mm / MM_IN_CM, height(r))).collect()
        };
        plot.add("", Look::marked(n).dash(style::DASHED).thin(), points(&p95));
        let some_left_out = of.iter().any(|r| !r.counts_in_means());
        let mark = if some_left_out { ", not valid in part" } else { "" };
        let label = format!("Configuration {}{mark}", of[0].configuration);
        plot.add(label, Look::marked(n), points(&height_mm));
    }
    let table = table!(runs.iter().map(|r| (r, r.summary.standing_height_mm)), |(r, height)| {
        "run" => &r.name,
        "configuration" => r.configuration,
        "falling_height_mm" => r.falling_height_mm,
        "mean_surface_mm" => height.mean_surface,
        "p95_mm" => height.p95,
        "highest_mm" => height.highest,
        "void_ratio" => r.summary.void_ratio,
        "left_out_of_means" => r.summary.why_left_out().join("; "),
    });
    plot.add_key_of_thin("95th percentile of the surface (same colours)");
    let counting = runs.iter().filter(|r| r.counts_in_means());
    let range = Interval::of(counting.map(|r| height_mm(r))).map(|i| {
        let (low, high) = (number(i.low, 1), number(i.high, 1));
        format!("The simulated mean surfaces lie between {low} and {high} mm.")
    });
    let range = found_in(&runs, range, "this range", "No pluviation run was done.");
    let caption = format!(
        "Standing height after pluviation over falling height. Solid: mean of the surface over the \
         cylinder's area; dashed: its 95th percentile, nearer to what an eye reads through the \
         wall. {range} The laboratory's range was a grey area in the paper's figure, which was not \
         available to us (only its text was); none is drawn. The paper's text: the standing height decreases as the falling \
         height increases."
    );
    let title = "Figure 7. Standing height after pluviation";
    Figure::new("figure-07-standing-height", title, caption, &[plot], &table)
}

/// Means with their confidence intervals, and every configuration as a point; none where no height
/// has an interval, as of a single configuration.
pub(super) fn with_confidence(study: &StudyView) -> Result<Option<Figure>, ReportError> {
    let found = uncertainty(study);
    let heights: Vec<_> = found
        .quantities
        .iter()
        .filter_map(|q| Some((q.falling_height_mm? / MM_IN_CM, q)))
        .collect();
    if heights.iter().all(|(_, q)| q.interval.is_none()) {
        return Ok(None);
    }
    let highest_fall = heights.iter().map(|h| h.0).fold(20.0, f64::max);
    let mut plot = Plot::of_standing_heights(highest_fall);
    let single = heights.iter().flat_map(|(cm, q)| q.values.iter().map(move |v| (*cm, *v)));
    let rings = Look { colour: style::INK, ..Look::rings() };
    plot.add("Single configurations", rings, single.collect());
    for (cm, interval) in heights.iter().filter_map(|(cm, q)| Some((*cm, q.interval?))) {
        let ends = [(cm, interval.low), (cm, interval.high)];
        plot.add_interval("", Look::line(0), ends, (STROKE_CM, 0.0));
    }
    let means = heights.iter().filter_map(|(cm, q)| Some((*cm, q.mean?)));
    let disc = Look::line(0).marker(Marker::Disc);
    plot.add("Mean and its 95 % confidence", disc, means.collect());
    let table = table!(heights.iter().filter(|(_, q)| q.mean.is_some()), |(_, q)| {
        "falling_height_mm" => q.falling_height_mm,
        "configurations" => q.values.len(),
        "mean_mm" => q.mean,
        "standard_deviation_mm" => q.standard_deviation,
        "interval_low_mm" => q.interval.map(|i| i.low),
        "interval_high_mm" => q.interval.map(|i| i.high),
    });
    let caption = format!(
        "Standing height (mean surface). Bars: 95 % confidence of the mean over the configurations, by \
         Student's t. They hold for each height by itself; configurations that stand high do so from \
         every height, so that the slope is known better than the bars suggest. {}",
        found.trend.verdict
    );
    let title = "How sure the standing heights are";
    Figure::new("uncertainty-standing-height", title, caption, &[plot], &table).map(Some)
}
