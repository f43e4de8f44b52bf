//! What each factor of a sweep moves, and how two of them act together.

use super::Figure;
use crate::{
    measure::statistics::mean,
    report::{
        ReportError, Sweep, SweepEffect, SweepFactor, SweepPoint, SweepRun,
        axis::{Axis, Scale},
        plot::{Look, Plot, with_one_legend},
        style::{self, Marker},
        sweep::shown,
        sweep_outcomes::{in_words, main_outcomes},
        table::{Table, row},
    },
};

/// Height of a panel, in SVG units.
const PANEL: u32 = 560;

/// Most pairs of factors that get a figure.
const MOST_PAIRS: usize = 10;

/// The figures of a sweep: one a factor, one a pair of factors.
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
        return Axis::linear(&factor.path).holding(numbers);
    }
    let names: Vec<String> =
        factor.values.iter().enumerate().map(|(n, v)| format!("{} {}", n + 1, shown(v))).collect();
    let (from, to) = (0.5, names.len() as f64 + 0.5);
    let scale = Scale { from, to, ticks: numbers.collect(), ..Scale::default() };
    Axis::divided(format!("{}: {}", factor.path, names.join(", ")), scale)
}

/// Means, joined where values are numbers.
fn means(n: usize, factor: &SweepFactor, marker: Marker) -> Look {
    Look { line: factor.numeric.then_some(style::SOLID), ..Look::line(n).marker(marker) }
}

/// What a factor moves: of every result all runs, and their means.
fn effect_figure(
    of: &Sweep,
    n: usize,
    factor: &SweepFactor,
) -> Result<Option<Figure>, ReportError> {
    let effects: Vec<&SweepEffect> =
        of.effects.iter().filter(|e| e.factor == factor.path).collect();
    let mut table = Table::new(["outcome", "value", "mean", "low", "high", "configurations"]);
    for effect in &effects {
        for (value, e) in &effect.means {
            table.row(row![&effect.outcome, shown(value), e.mean, e.t_low, e.t_high, e.count]);
        }
    }
    let panels = effects.iter().map(|effect| effect_panel(of, n, factor, effect));
    let caption = if factor.sampled {
        "Every run at the value that was drawn; all other ranges were drawn from as well. Crosses: runs \
         left out of the effects, as they do not count in means."
            .to_owned()
    } else {
        format!(
            "Rings: every run; crosses: runs left out of the means, as they do not count in \
             them. Discs: means over {} configurations{}, with the 95 % confidence of the mean by \
             Student's t.",
            of.configurations,
            if of.design == "grid" { " and over all values of the other factors" } else { "" }
        )
    };
    let title = format!("What {} moves", factor.path);
    figure_of(&stem("effect", &factor.path), &title, caption, panels, &table)
}

/// A figure, where it has panels.
fn figure_of(
    stem: &str,
    title: &str,
    caption: String,
    panels: impl IntoIterator<Item = Plot>,
    table: &Table,
) -> Result<Option<Figure>, ReportError> {
    let panels = with_one_legend(panels);
    (!panels.is_empty()).then(|| Figure::new(stem, title, caption, &panels, table)).transpose()
}

fn effect_panel(of: &Sweep, n: usize, factor: &SweepFactor, effect: &SweepEffect) -> Plot {
    let of_point = |point: &str| of.points.iter().find(|p| p.point == point);
    let is_shown = |point: &str| {
        // Points at which another factor differs say nothing of this one.
        of.design != "one_at_a_time"
            || of_point(point).is_some_and(|p| {
                let base = &of.points[0].values;
                p.values.iter().zip(base).enumerate().all(|(k, (v, b))| k == n || v == b)
            })
    };
    let at = |r: &SweepRun| Some((factor.number(&r.values[n]), *r.outcomes.get(&effect.outcome)?));
    let runs = of.runs.iter().filter(|r| is_shown(&r.point));
    let (counting, left_out): (Vec<&SweepRun>, Vec<&SweepRun>) =
        runs.partition(|r| r.counts_in_means());
    let of_values = || effect.means.iter().map(|(v, e)| (factor.number(v), e));
    let mean_points = of_values().map(|(at, e)| (at, e.mean));
    let bars = of_values().filter_map(|(at, e)| Some([(at, e.t_low?), (at, e.t_high?)]));
    let mut plot = Plot::new(axis(factor), Axis::linear(in_words(&effect.outcome, &of.names)));
    plot.frame_height = PANEL;
    plot.add_some("Single runs", Look::rings(), counting.into_iter().filter_map(at));
    let left_out = left_out.into_iter().filter_map(at);
    plot.add_some("Left out of the means", Look::rings().marker(Marker::Cross), left_out);
    bars.for_each(|bar| plot.add("", Look::line(0), bar.to_vec()));
    plot.add_some("Means, 95 % confidence", means(0, factor, Marker::Disc), mean_points);
    plot
}

/// How two factors act together: of every result its means over one, a curve a value of the other.
fn pair_figure(of: &Sweep, a: usize, b: usize) -> Result<Option<Figure>, ReportError> {
    let (first, second) = (&of.factors[a], &of.factors[b]);
    let mut table = Table::new(["outcome", "first", "second", "mean"]);
    let has = |path: &&str| of.points.iter().any(|p| p.outcomes.contains_key(*path));
    let outcomes: Vec<&str> = main_outcomes(&of.runs).into_iter().filter(has).collect();
    let mut panels = Vec::new();
    for path in outcomes {
        let mut plot = Plot::new(axis(first), Axis::linear(in_words(path, &of.names)));
        plot.frame_height = PANEL;
        for (k, value) in second.values.iter().enumerate() {
            let mut points = Vec::new();
            for at in &first.values {
                let there = |p: &&SweepPoint| p.values[a] == *at && p.values[b] == *value;
                let results = of.points.iter().filter(there);
                let results = results.filter_map(|p| Some(p.outcomes.get(path)?.mean));
                let Some(middle) = mean(&results.collect::<Vec<f64>>()) else { continue };
                points.push((first.number(at), middle));
                table.row(row![path, shown(at), shown(value), middle]);
            }
            let label = format!("{} = {}", second.path, shown(value));
            plot.add_some(label, means(k, first, style::marker(k)), points);
        }
        panels.push(plot);
    }
    let caption = "Means over configurations, and over all values of any further factor. Lines that \
                   run beside each other: the two factors act each by itself.";
    let stem = stem("pair", &format!("{}-{}", first.path, second.path));
    let title = format!("{} and {} together", first.path, second.path);
    figure_of(&stem, &title, caption.to_owned(), panels, &table)
}
