//! Result against the unknown: every run, means, the line, and what was found.

use super::{Figure, Table, cell};
use crate::report::{
    Calibration, ReportError,
    axis::Axis,
    calibration::{target_in_words, with_unit},
    plot::{Look, Mark, Plot, Series},
    style::{self, Marker},
};

/// Points of the curve of the identity.
const PIECES: usize = 60;

/// The figure of a calibration.
///
/// # Errors
/// [`ReportError::Figure`].
pub(in crate::report) fn of_calibration(of: &Calibration) -> Result<Figure, ReportError> {
    let (low, high) = (of.between.low, of.between.high);
    let measured = of.runs.iter().filter_map(|r| Some((r.value, r.counted()?)));
    let points: Vec<(f64, f64)> = measured.collect();
    let left_out = of.runs.iter().filter(|r| r.is_left_out());
    let left_out: Vec<(f64, f64)> = left_out.filter_map(|r| Some((r.value, r.result?))).collect();
    let x = Axis::linear(&capital(of.unknown_in_words()), [low, high]);
    let identity: Vec<(f64, f64)> = match of.identity {
        Some(_) => (0..=PIECES)
            .map(|i| low + (high - low) * i as f64 / PIECES as f64)
            .map(|mu| (mu, mu.atan().to_degrees()))
            .collect(),
        None => Vec::new(),
    };
    let results = points.iter().chain(&left_out).chain(&identity).map(|p| p.1).chain([of.wanted]);
    let y = Axis::linear(&name_of_result(of), results);
    let mut plot = Plot::new(x, y);
    let wanted = crate::paper::text::compact(of.wanted);
    plot.marks.push(Mark {
        label: format!("Wanted: {}", with_unit(&wanted, &of.unit)),
        at: of.wanted,
        upright: false,
    });
    let curve = |colour: usize, line, marker| Look {
        colour: style::colour(colour),
        line,
        width: style::CURVE,
        marker,
        marker_spacing: None,
    };
    let mut add = |label: &str, look: Look, points: Vec<(f64, f64)>| {
        if !points.is_empty() {
            plot.series.push(Series { label: label.to_owned(), look, points });
        }
    };
    add("Angle of friction, atan μ", curve(2, Some(style::DASHED), None), identity);
    let ring = Look {
        colour: style::LIMIT,
        line: None,
        width: style::THIN,
        marker: Some(Marker::Ring),
        marker_spacing: None,
    };
    add("Single runs", ring, points);
    add("Left out", Look { marker: Some(Marker::Cross), ..ring }, left_out);
    let means: Vec<(f64, f64)> =
        of.values.iter().filter_map(|v| Some((v.value, v.mean?))).collect();
    add("Means", curve(0, None, Some(Marker::Disc)), means);
    if let Some(solution) = of.solution {
        let fitted = || of.values.iter().filter(|v| v.in_fit).map(|v| v.value);
        let ends = [
            fitted().fold(solution.value, f64::min).max(low),
            fitted().fold(solution.value, f64::max).min(high),
        ];
        let line = ends.map(|x| (x, solution.level + (x - solution.centre) * solution.slope));
        add("Line", curve(0, Some(style::SOLID), None), line.into());
        if let Some(i) = solution.interval_95 {
            let (a, b) = (i.low.clamp(low, high), i.high.clamp(low, high));
            let stroke = 0.012 * (plot_height(of));
            let bar = curve(1, Some(style::SOLID), None);
            add("", bar, vec![(a, of.wanted), (b, of.wanted)]);
            for end in [a, b] {
                add("", bar, vec![(end, of.wanted - stroke), (end, of.wanted + stroke)]);
            }
        }
        if (low..=high).contains(&solution.value) {
            let label = "Found, with its 95 % confidence";
            let look = curve(1, Some(style::SOLID), Some(Marker::Diamond));
            add(label, look, vec![(solution.value, of.wanted)]);
        }
    }
    let mut table =
        Table::new(&["value", "configuration", "result", "mean", "in_fit", "left_out_of_means"]);
    for run in &of.runs {
        let value = of.values.iter().find(|v| v.value == run.value);
        table.row([
            cell(run.value),
            run.configuration.to_string(),
            cell(run.result),
            cell(value.and_then(|v| v.mean)),
            value.is_some_and(|v| v.in_fit).to_string(),
            run.left_out_of_means.clone().unwrap_or_default(),
        ]);
    }
    let title =
        format!("{} against {}", capital(target_in_words(&of.target)), of.unknown_in_words());
    let identity = if of.identity.is_some() {
        " Dashed: where the angle of repose would be the angle of friction between surfaces."
    } else {
        ""
    };
    let caption = format!(
        "Every run as a ring, a cross where it is left out, means as discs, the line through the values nearest to the solution. \
         The same configurations stand at every value.{identity} {}.",
        capital(&of.statement)
    );
    Figure::new("calibration", &title, caption, &plot, &table)
}

/// How far results reach, for the size of strokes.
fn plot_height(of: &Calibration) -> f64 {
    let results = of.runs.iter().filter_map(|r| r.result).chain([of.wanted]);
    let (low, high) = results
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), r| (low.min(r), high.max(r)));
    high - low
}

/// Name of the vertical axis: the field, and its unit where the name does not
/// say it.
fn name_of_result(of: &Calibration) -> String {
    let words = target_in_words(&of.target);
    match (words == of.target, of.unit.as_str()) {
        (true, _) | (_, "") => capital(words),
        (false, "°") => format!("{} (degrees)", capital(words)),
        (false, unit) => format!("{} ({unit})", capital(words)),
    }
}

/// A sentence's first letter; names of fields stay as they are.
pub(in crate::report) fn capital(text: &str) -> String {
    let field = text.split(' ').next().is_some_and(|word| word.contains(['.', '_']));
    let mut letters = text.chars();
    match letters.next() {
        Some(first) if !field => first.to_uppercase().chain(letters).collect(),
        _ => text.to_owned(),
    }
}
