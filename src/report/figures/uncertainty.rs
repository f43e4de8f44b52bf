//! Standing heights with their confidence intervals, and every configuration
//! as a point.

use super::Figure;
use crate::{
    paper::{StudyView, uncertainty},
    report::{
        ReportError,
        axis::Axis,
        plot::{Look, Plot},
        style::{self, Marker},
        table::table,
    },
};

const MM_IN_CM: f64 = 10.0;
/// Half the width of an interval's end stroke, in cm of falling height.
const STROKE_CM: f64 = 0.25;

pub(super) fn figure(study: &StudyView) -> Result<Figure, ReportError> {
    let found = uncertainty(study);
    let heights: Vec<_> = found
        .quantities
        .iter()
        .filter_map(|q| Some((q.falling_height_mm? / MM_IN_CM, q)))
        .collect();
    let highest = heights.iter().map(|h| h.0).fold(20.0, f64::max);
    let x = Axis::falling_heights(highest);
    let mut plot = Plot::new(x, Axis::linear("Standing height (mm)"));
    let mut means = Vec::new();
    let mut single = Vec::new();
    for (cm, q) in &heights {
        let Some(mean) = q.mean else { continue };
        means.push((*cm, mean));
        single.extend(q.values.iter().map(|v| (*cm, *v)));
        if let Some(i) = q.interval {
            plot.add_interval("", Look::line(0), (*cm, i.low, i.high), STROKE_CM);
        }
    }
    let table = table!(heights.iter().filter(|(_, q)| q.mean.is_some()), |(_, q)| {
        "falling_height_mm" => q.falling_height_mm,
        "configurations" => q.values.len(),
        "mean_mm" => q.mean,
        "standard_deviation_mm" => q.standard_deviation,
        "interval_low_mm" => q.interval.map(|i| i.low),
        "interval_high_mm" => q.interval.map(|i| i.high),
    });
    let with_interval = heights.iter().any(|(_, q)| q.interval.is_some());
    if !means.is_empty() {
        let label = if with_interval { "Mean and its 95 % confidence" } else { "Mean" };
        plot.add(label, Look::line(0).marker(Marker::Disc), means);
        let rings = Look { colour: style::INK, ..Look::rings() };
        plot.add("Single configurations", rings, single);
    }
    let bars = if with_interval {
        "Bars: 95 % confidence of the mean over the configurations, by Student's t. They hold for \
         each height by itself; configurations that stand high do so from every height, so that the \
         slope is known better than the bars suggest."
    } else {
        "No bars: fewer than two configurations give no interval."
    };
    let caption = format!("Standing height (mean surface). {bars} {}", found.trend.verdict);
    Figure::new(
        "uncertainty-standing-height",
        "How sure the standing heights are",
        caption,
        &[plot],
        &table,
    )
}
