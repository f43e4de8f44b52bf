//! Result against the unknown: every run, means, the line, and what was found.

use super::*;

/// Points of the curve of the identity.
const PIECES: usize = 60;

pub(in crate::report) fn of_calibration(of: &Calibration) -> Result<Figure, ReportError> {
    let (low, high) = (of.between.low, of.between.high);
    let measured = of.runs.iter().filter_map(|r| Some((r.value, r.counted()?)));
    let left_out = of.runs.iter().filter(|r| r.is_left_out());
    let left_out = left_out.filter_map(|r| Some((r.value, r.result?)));
    let means = of.values.iter().filter_map(|v| Some((v.value, v.mean?)));
    let unknown = unknown_in_words(&of.unknown);
    let x = Axis::linear(capital(unknown)).holding([low, high]);
    let mut plot = Plot::new(x, Axis::linear(name_of_result(of)));
    plot.mark_level(format!("Wanted: {}", with_unit(&compact(of.wanted), &of.unit)), of.wanted);
    if of.identity.is_some() {
        let values = (0..=PIECES).map(|i| low + (high - low) * i as f64 / PIECES as f64);
        let angles = values.map(|mu| (mu, mu.atan().to_degrees()));
        plot.add_some("Angle of friction, atan μ", Look::law(2), angles);
    }
    plot.add_some("Single runs", Look::rings(), measured);
    plot.add_some("Left out", Look::rings().marker(Marker::Cross), left_out);
    plot.add_some("Means", Look::points(0), means);
    if let Some(solution) = of.solution {
        let fitted = || of.values.iter().filter(|v| v.in_fit).map(|v| v.value);
        let ends = [
            fitted().fold(solution.value, f64::min).max(low),
            fitted().fold(solution.value, f64::max).min(high),
        ];
        let line = ends.map(|x| (x, solution.level + (x - solution.centre) * solution.slope));
        plot.add("Line", Look::line(0), line.into());
        if let Some(i) = solution.interval_95 {
            let (a, b) = (i.low.clamp(low, high), i.high.clamp(low, high));
            let stroke = 0.012 * plot_height(of);
            let ends = [(a, of.wanted), (b, of.wanted)];
            plot.add_interval("", Look::line(1), ends, (0.0, stroke));
        }
        if (low..=high).contains(&solution.value) {
            let label = "Found, with its 95 % confidence";
            let look = Look::line(1).marker(Marker::Diamond);
            plot.add(label, look, vec![(solution.value, of.wanted)]);
        }
    }
    let rows = of.runs.iter().map(|r| (r, of.values.iter().find(|v| v.value == r.value)));
    let table = table!(rows, |(run, value)| {
        "value" => run.value,
        "configuration" => run.configuration,
        "result" => run.result,
        "mean" => value.and_then(|v| v.mean),
        "in_fit" => value.is_some_and(|v| v.in_fit),
        "left_out_of_means" => run.left_out_of_means.clone(),
    });
    let title = format!("{} against {unknown}", capital(target_in_words(&of.target)));
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
    Figure::new("calibration", &title, caption, &[plot], &table)
}

/// How far results reach, for the size of strokes.
fn plot_height(of: &Calibration) -> f64 {
    let results = of.runs.iter().filter_map(|r| r.result).chain([of.wanted]);
    Interval::of(results).map_or(0.0, |reach| reach.high - reach.low)
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
