//! What each factor of a sweep moves, and how two of them act together.

use super::{Figure, Table, cell};
use crate::{
    measure::statistics::mean,
    report::{
        MAIN_OUTCOMES, OUTCOMES, ReportError, Sweep, SweepEffect, SweepFactor, SweepRun,
        axis::Axis,
        plot::{Look, Plot, Series, stacked},
        style::{self, Dash, Marker},
        sweep::shown,
    },
};

/// Height of a panel, in SVG units.
const PANEL: u32 = 560;

/// Most pairs of factors that get a figure.
const MOST_PAIRS: usize = 10;

/// The figures of a sweep: one a factor, one a pair of factors.
///
/// # Errors
/// [`ReportError::Figure`].
pub(in crate::report) fn of_sweep(of: &Sweep) -> Result<Vec<Figure>, ReportError> {
    let mut figures = Vec::new();
    for (n, factor) in of.factors.iter().enumerate() {
        figures.extend(effect_figure(of, n, factor)?);
    }
    if of.design == "grid" {
        let pairs =
            (0..of.factors.len()).flat_map(|a| (a + 1..of.factors.len()).map(move |b| (a, b)));
        for (a, b) in pairs.take(MOST_PAIRS) {
            figures.extend(pair_figure(of, a, b)?);
        }
    }
    Ok(figures)
}

/// A name for files: what is no letter or digit becomes a dash.
fn stem(kind: &str, path: &str) -> String {
    let plain = path.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '-' });
    format!("{kind}-{}", plain.collect::<String>())
}

/// The horizontal axis of a factor; where values are no numbers, their places.
fn axis(factor: &SweepFactor) -> Axis {
    let numbers = factor.values.iter().map(|v| factor.number(v));
    if factor.numeric {
        return Axis::linear(&factor.path, numbers);
    }
    let names: Vec<String> =
        factor.values.iter().enumerate().map(|(n, v)| format!("{} {}", n + 1, shown(v))).collect();
    let mut axis = Axis::with_ticks(
        &format!("{}: {}", factor.path, names.join(", ")),
        &numbers.collect::<Vec<_>>(),
    );
    (axis.from, axis.to) = (axis.from - 0.5, axis.to + 0.5);
    axis
}

fn look(colour: usize, line: Option<Dash>, marker: Option<Marker>) -> Look {
    Look { colour: style::colour(colour), line, width: style::CURVE, marker, marker_spacing: None }
}

fn failed(figure: &str) -> impl Fn(String) -> ReportError + use<> {
    let figure = figure.to_owned();
    move |reason| ReportError::Figure { figure: figure.clone(), reason }
}

fn effect_figure(
    of: &Sweep,
    n: usize,
    factor: &SweepFactor,
) -> Result<Option<Figure>, ReportError> {
    let effects: Vec<&SweepEffect> =
        of.effects.iter().filter(|e| e.factor == factor.path).collect();
    if effects.is_empty() {
        return Ok(None);
    }
    let stem = stem("effect", &factor.path);
    let fail = failed(&stem);
    let mut table = Table::new(&["outcome", "value", "mean", "low", "high", "configurations"]);
    let mut panels = Vec::new();
    for (index, effect) in effects.iter().enumerate() {
        let of_point = |point: &str| of.points.iter().find(|p| p.point == point);
        let shown_here = |point: &str| {
            // Points at which another factor differs say nothing of this one.
            of.design != "one_at_a_time"
                || of_point(point).is_some_and(|p| {
                    let base = &of.points[0].values;
                    p.values.iter().zip(base).enumerate().all(|(k, (v, b))| k == n || v == b)
                })
        };
        let shown_runs = |counting: bool| -> Vec<(f64, f64)> {
            let here = of.runs.iter().filter(|r| shown_here(&r.point));
            let these = here.filter(|r| r.counts_in_means() == counting);
            let at = |r: &SweepRun| {
                Some((factor.number(&r.values[n]), *r.outcomes.get(&effect.outcome)?))
            };
            these.filter_map(at).collect()
        };
        let (runs, left_out) = (shown_runs(true), shown_runs(false));
        let means: Vec<(f64, f64)> =
            effect.means.iter().map(|(v, e)| (factor.number(v), e.mean)).collect();
        let bars: Vec<[(f64, f64); 2]> = effect
            .means
            .iter()
            .filter_map(|(v, e)| {
                let at = factor.number(v);
                Some([(at, e.t_low?), (at, e.t_high?)])
            })
            .collect();
        let all =
            runs.iter().chain(&left_out).chain(&means).chain(bars.iter().flatten()).map(|p| p.1);
        let mut plot = Plot::new(
            axis(factor),
            Axis::linear(crate::report::sweep::in_words(&effect.outcome), all),
        );
        plot.frame_height = PANEL;
        let last = index + 1 == effects.len();
        let label = |text: &str| if last { text.to_owned() } else { String::new() };
        let mut add = |label: String, look: Look, points: Vec<(f64, f64)>| {
            if !points.is_empty() {
                plot.series.push(Series { label, look, points });
            }
        };
        let ring =
            Look { colour: style::LIMIT, width: style::THIN, ..look(0, None, Some(Marker::Ring)) };
        add(label("Single runs"), ring, runs);
        let cross = Look { marker: Some(Marker::Cross), ..ring };
        add(label("Left out of the means"), cross, left_out);
        for bar in bars {
            add(String::new(), look(0, Some(style::SOLID), None), bar.to_vec());
        }
        let line = factor.numeric.then_some(style::SOLID);
        add(label("Means, 95 % confidence"), look(0, line, Some(Marker::Disc)), means);
        for (value, e) in &effect.means {
            table.row([
                effect.outcome.clone(),
                shown(value),
                cell(e.mean),
                cell(e.t_low),
                cell(e.t_high),
                e.count.to_string(),
            ]);
        }
        panels.push(plot.svg().map_err(&fail)?);
    }
    let caption = if factor.sampled {
        "Every run at the value that was drawn; all other ranges were drawn from as well. Crosses: runs \
         left out of the effects, not being valid or short of grains."
            .to_owned()
    } else {
        format!(
            "Rings: every run; crosses: runs left out of the means, not being valid or short of grains. Discs: means over {} configurations{}, with the 95 % confidence of the \
             mean by Student's t.",
            of.configurations,
            if of.design == "grid" { " and over all values of the other factors" } else { "" }
        )
    };
    Ok(Some(Figure {
        title: format!("What {} moves", factor.path),
        caption,
        svg: stacked(&panels).map_err(&fail)?,
        csv: table.csv().map_err(|e| fail(e.to_string()))?,
        stem,
    }))
}

fn pair_figure(of: &Sweep, a: usize, b: usize) -> Result<Option<Figure>, ReportError> {
    let (first, second) = (&of.factors[a], &of.factors[b]);
    let stem = stem("pair", &format!("{}-{}", first.path, second.path));
    let fail = failed(&stem);
    let mut table = Table::new(&["outcome", "first", "second", "mean"]);
    let outcomes: Vec<&(&str, &str)> = OUTCOMES[..MAIN_OUTCOMES]
        .iter()
        .filter(|(path, _)| of.points.iter().any(|p| p.outcomes.contains_key(*path)))
        .collect();
    let mut panels = Vec::new();
    for (index, (path, words)) in outcomes.iter().enumerate() {
        let mut series = Vec::new();
        for (k, value) in second.values.iter().enumerate() {
            let mut points = Vec::new();
            for at in &first.values {
                let of: Vec<f64> = of
                    .points
                    .iter()
                    .filter(|p| p.values[a] == *at && p.values[b] == *value)
                    .filter_map(|p| Some(p.outcomes.get(*path)?.mean))
                    .collect();
                let Some(middle) = mean(&of) else { continue };
                points.push((first.number(at), middle));
                table.row([(*path).to_owned(), shown(at), shown(value), cell(middle)]);
            }
            let last = index + 1 == outcomes.len();
            let label =
                if last { format!("{} = {}", second.path, shown(value)) } else { String::new() };
            let line = first.numeric.then_some(style::SOLID);
            series.push(Series { label, look: look(k, line, Some(style::marker(k))), points });
        }
        let all: Vec<f64> = series.iter().flat_map(|s| s.points.iter().map(|p| p.1)).collect();
        let mut plot = Plot::new(axis(first), Axis::linear(words, all));
        plot.frame_height = PANEL;
        plot.series = series.into_iter().filter(|s| !s.points.is_empty()).collect();
        panels.push(plot.svg().map_err(&fail)?);
    }
    if panels.is_empty() {
        return Ok(None);
    }
    Ok(Some(Figure {
        title: format!("{} and {} together", first.path, second.path),
        caption: "Means over configurations, and over all values of any further factor. Lines that run beside each \
                  other: the two factors act each by itself."
            .to_owned(),
        svg: stacked(&panels).map_err(&fail)?,
        csv: table.csv().map_err(|e| fail(e.to_string()))?,
        stem,
    }))
}
