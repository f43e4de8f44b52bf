//! Standing heights with their confidence intervals, and every configuration
//! as a point.

use super::{Figure, Table, cell};
use crate::{
    paper::{StudyView, uncertainty},
    report::{
        ReportError,
        axis::Axis,
        plot::{Look, Plot, Series},
        style::{self, Marker},
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
    let ticks: Vec<f64> = (0..=4).map(|i| f64::from(i) * highest / 4.0).collect();
    let mut x = Axis::with_ticks("Falling height (cm)", &ticks);
    (x.from, x.to) = (-0.05 * highest, 1.05 * highest);
    let ends = heights.iter().flat_map(|(_, q)| {
        q.values.iter().copied().chain(q.interval.iter().flat_map(|i| [i.low, i.high]))
    });
    let mut plot = Plot::new(x, Axis::linear("Standing height (mm)", ends));
    let mut table = Table::new(&[
        "falling_height_mm",
        "configurations",
        "mean_mm",
        "standard_deviation_mm",
        "interval_low_mm",
        "interval_high_mm",
    ]);
    let bar = Look {
        colour: style::colour(0),
        line: Some(style::SOLID),
        width: style::CURVE,
        marker: None,
        marker_spacing: None,
    };
    let mut means = Vec::new();
    let mut single = Vec::new();
    for (cm, q) in &heights {
        let Some(mean) = q.mean else { continue };
        means.push((*cm, mean));
        single.extend(q.values.iter().map(|v| (*cm, *v)));
        table.row([
            cell(q.falling_height_mm),
            q.values.len().to_string(),
            cell(mean),
            cell(q.standard_deviation),
            cell(q.interval.map(|i| i.low)),
            cell(q.interval.map(|i| i.high)),
        ]);
        if let Some(i) = q.interval {
            for points in [
                vec![(*cm, i.low), (*cm, i.high)],
                vec![(cm - STROKE_CM, i.low), (cm + STROKE_CM, i.low)],
                vec![(cm - STROKE_CM, i.high), (cm + STROKE_CM, i.high)],
            ] {
                plot.series.push(Series { label: String::new(), look: bar, points });
            }
        }
    }
    let with_interval = heights.iter().any(|(_, q)| q.interval.is_some());
    if !means.is_empty() {
        let label = if with_interval { "Mean and its 95 % confidence" } else { "Mean" };
        plot.series.push(Series {
            label: label.into(),
            look: Look { marker: Some(Marker::Disc), ..bar },
            points: means,
        });
        plot.series.push(Series {
            label: "Single configurations".into(),
            look: Look {
                colour: style::INK,
                line: None,
                width: style::THIN,
                marker: Some(Marker::Ring),
                marker_spacing: None,
            },
            points: single,
        });
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
        &plot,
        &table,
    )
}
