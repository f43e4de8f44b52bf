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
    let x = Axis::linear(capital(unknown)).holding([low, high]).clear_of_frame();
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
        plot.add("Line through the nearest values", Look::line(0), line.into());
        if let Some(i) = solution.interval_95.filter(|i| i.low <= high && i.high >= low) {
            let drawn = [i.low.max(low), i.high.min(high)].map(|x| (x, of.wanted));
            plot.add("", Look::line(1), drawn.into());
            let stroke = 0.012 * plot_height(of);
            // An end beyond the values searched is not seen.
            for x in [i.low, i.high].into_iter().filter(|x| (low..=high).contains(x)) {
                let ends = vec![(x, of.wanted - stroke), (x, of.wanted + stroke)];
                plot.add("", Look::line(1), ends);
            }
        }
        if (low..=high).contains(&solution.value) {
            let label = match solution.interval_95 {
                Some(_) => "Found, with its 95 % confidence",
                None => "Found, without an interval",
            };
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
    let left_out = match of.runs.iter().any(CalibrationRun::is_left_out) {
        true => "; crosses: runs left out",
        false => "",
    };
    let line = match of.solution {
        Some(_) => " The line goes through the values nearest to the solution.",
        None => "",
    };
    let interval = beyond(of);
    let caption = format!(
        "Rings: every run{left_out}. Discs: means.{line}{interval} The same realisations stand at \
         every value.{identity} {}.",
        capital(&of.statement)
    );
    Figure::new("calibration", &title, caption, &[plot], &table)
}

/// What a caption says of an interval that reaches beyond the values searched.
fn beyond(of: &Calibration) -> &'static str {
    let Some(interval) = of.solution.and_then(|solution| solution.interval_95) else { return "" };
    let (low, high) = (of.between.low, of.between.high);
    if interval.high < low || interval.low > high {
        " The 95 % confidence interval lies outside of the values searched and is not drawn."
    } else if interval.low < low || interval.high > high {
        " The 95 % confidence interval goes on beyond the values searched, where it has no stroke at \
         its end."
    } else {
        ""
    }
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

#[cfg(test)]
mod tests {
    use super::*;

    /// A value of 0.6 between 0.2 and 1.0, with an interval or without.
    fn found(interval_95: Option<Interval>) -> Calibration {
        let runs = [(0.2, 24.0), (1.0, 26.0)].map(|(value, result)| CalibrationRun {
            result: Some(result),
            ..CalibrationRun::new(value, 1, "run")
        });
        Calibration {
            scenario: "s".to_owned(),
            target: "standing_height_mm.mean_surface".to_owned(),
            unit: "mm".to_owned(),
            wanted: 25.0,
            unknown: "contact.restitution".to_owned(),
            between: Interval::new(0.2, 1.0),
            ending: CalibrationEnding::Found,
            statement: "it is 0.6".to_owned(),
            solution: Some(CalibrationSolution {
                value: 0.6,
                interval_95,
                result_half_width_95: 0.1,
                interval_in_result: None,
                slope: 2.5,
                slope_half_width_95: 0.5,
                centre: 0.6,
                level: 25.0,
                curvature_p: None,
                configurations: 2,
            }),
            tolerance: None,
            tolerance_given: false,
            scatter: None,
            replicates: 1,
            most_runs: 16,
            notes: Vec::new(),
            identity: None,
            values: Vec::new(),
            runs: runs.to_vec(),
        }
    }

    /// Law: legend and caption speak of what is drawn: of an interval and of runs left out where
    /// there are any.
    #[test]
    fn the_legend_has_an_interval_where_there_is_one() {
        let mut of = found(None);
        let without = of_calibration(&of).expect("a figure");
        assert!(without.svg.contains("Found, without an interval"), "law: there is none");
        assert!(!without.svg.contains("95 %"), "law: and nothing says so");
        assert!(!without.caption.contains("crosses"), "law: no run is left out");
        of.runs[0].left_out_of_means = Some("not valid".to_owned());
        let spoilt = of_calibration(&of).expect("a figure");
        assert!(spoilt.caption.contains("crosses: runs left out"), "law: one is");
        let with = of_calibration(&found(Some(Interval::new(0.5, 0.7)))).expect("a figure");
        assert!(with.svg.contains("Found, with its 95 % confidence"), "law: there is one");
    }

    /// Law: an interval ends with a stroke where it ends; one that goes on beyond the values searched
    /// has none there, one beside them is not drawn, and the caption says so.
    #[test]
    fn an_interval_beyond_the_values_has_no_end() {
        let figure = |interval: Option<(f64, f64)>| {
            let interval = interval.map(|(low, high)| Interval::new(low, high));
            of_calibration(&found(interval)).expect("a figure")
        };
        let lines = |figure: &Figure| figure.svg.matches("<polyline").count();
        let none = figure(None);
        for (interval, expected, words) in [
            ((0.5, 0.7), 3, ""),
            ((0.1, 0.7), 2, "goes on beyond the values searched"),
            ((0.5, f64::INFINITY), 2, "goes on beyond the values searched"),
            ((f64::NEG_INFINITY, f64::INFINITY), 1, "goes on beyond the values searched"),
            ((1.2, 1.4), 0, "lies outside of the values searched"),
        ] {
            let got = figure(Some(interval));
            let more = lines(&got) - lines(&none);
            assert_eq!(more, expected, "law: the line and strokes of {interval:?}");
            assert!(got.caption.contains(words), "law: of {interval:?} `{words}`: {}", got.caption);
            let said = got.caption.contains("values searched");
            assert_eq!(said, !words.is_empty(), "law: only of such: {}", got.caption);
        }
    }
}
