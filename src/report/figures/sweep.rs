//! What each factor of a sweep moves, and how two of them act together.

use super::*;

/// Height of a panel, in SVG units.
const PANEL: u32 = 560;

/// Half the width of an interval's end strokes by the distance from the first to the last value.
const STROKE: f64 = 0.01;

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

/// An empty panel of a result over a factor; where values are no numbers, over their names.
fn panel(of: &Sweep, factor: &SweepFactor, outcome: &str) -> Plot {
    let numbers = factor.values.iter().map(|v| factor.number(v));
    let x = if factor.numeric {
        Axis::linear(&factor.path).holding(numbers).clear_of_frame()
    } else {
        let (from, to) = (0.5, factor.values.len() as f64 + 0.5);
        let scale = Scale { from, to, ticks: numbers.collect(), ..Scale::default() };
        Axis::divided(&factor.path, scale)
    };
    let mut plot = Plot::new(x, Axis::linear(in_words(outcome, &of.names)));
    plot.x_names = (!factor.numeric).then(|| factor.values.iter().map(shown).collect());
    plot.frame_height = PANEL;
    plot
}

/// Means, joined where a result can rise or fall from one to the next.
fn means(n: usize, factor: &SweepFactor, marker: Marker) -> Look {
    Look { line: factor.has_slope().then_some(style::SOLID), ..Look::line(n).marker(marker) }
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
    let has_any = |r: &SweepRun| effects.iter().any(|e| r.outcomes.contains_key(&e.outcome));
    let is_left_out = of.left_out().any(|r| is_of_factor(of, n, r) && has_any(r));
    let caption = if factor.sampled {
        let left_out = match is_left_out {
            true => " Crosses: runs left out of the effects, as they do not count in means.",
            false => "",
        };
        format!(
            "Every run at the value that was drawn; all other ranges were drawn from as \
             well.{left_out}{}",
            of_withheld(of)
        )
    } else {
        let left_out = match is_left_out {
            true => "; crosses: runs left out of the means, as they do not count in them",
            false => "",
        };
        let every = match of.design == "one_at_a_time" && of.factors.len() > 1 {
            true => "every run in which all other factors have the scenario's own values",
            false => "every run",
        };
        format!("Rings: {every}{left_out}. {}", of_means(of, &effects))
    };
    let title = format!("What {} moves", factor.path);
    figure_of(&stem("effect", &factor.path), &title, caption, panels, &table)
}

/// What a caption says of the means of some effects, where there are any.
fn of_means(of: &Sweep, effects: &[&SweepEffect]) -> String {
    let withheld = of_withheld(of);
    if effects.iter().all(|effect| effect.means.is_empty()) {
        let realisation = of.realisation();
        return format!("No means: no {realisation} has runs that count at every value.{withheld}");
    }
    let all = counted(of.configurations as usize, of.realisation());
    // Of a realisation that lacks a value, or has one that is left out, none is in a mean.
    let counts = || effects.iter().flat_map(|effect| &effect.means).map(|(_, e)| e.count);
    let over = match (counts().min(), counts().max()) {
        _ if of.runs.len() < of.planned => format!("the {}s run so far", of.realisation()),
        (Some(least), Some(most)) if least < of.configurations as usize => {
            let whole =
                if least == most { least.to_string() } else { format!("{least} to {most}") };
            let why = match effects.iter().any(|effect| effect.withheld > 0) {
                true => "runs that count, or values of theirs",
                false => "runs that count",
            };
            format!("{whole} of {all} (the others lack {why})")
        }
        _ => all,
    };
    let others = match of.design == "grid" && of.factors.len() > 1 {
        true => " and over all values of the other factors",
        false => "",
    };
    let bars = match has_intervals(effects) {
        true => "Bars: the 95 % confidence of the mean by Student's t.",
        false => "No bars: one value gives no interval.",
    };
    let without = effects.iter().filter(|effect| effect.means.is_empty());
    let without: Vec<String> = without.map(|effect| in_words(&effect.outcome, &of.names)).collect();
    let without = match without.is_empty() {
        true => String::new(),
        false => format!(
            " No means of {}: no {} has it at every value.",
            without.join(", "),
            of.realisation()
        ),
    };
    format!("Discs: means over {over}{others}. {bars}{without}{withheld}")
}

/// What a caption says of results that some runs withhold, where there are any.
fn of_withheld(of: &Sweep) -> String {
    let said = withheld_in_words(of);
    said.map_or(String::new(), |said| format!(" {} runs that count.", capital(&said)))
}

/// Whether any mean of some effects has an interval.
fn has_intervals(effects: &[&SweepEffect]) -> bool {
    effects.iter().flat_map(|effect| &effect.means).any(|(_, e)| e.t_low.is_some())
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

/// Whether a run is drawn over a factor: one at a time those in which another one differs say
/// nothing of it.
fn is_of_factor(of: &Sweep, n: usize, run: &SweepRun) -> bool {
    let point = of.points.iter().find(|p| p.point == run.point);
    of.design != "one_at_a_time"
        || point.is_some_and(|p| {
            let base = &of.points[0].values;
            p.values.iter().zip(base).enumerate().all(|(k, (v, b))| k == n || v == b)
        })
}

fn effect_panel(of: &Sweep, n: usize, factor: &SweepFactor, effect: &SweepEffect) -> Plot {
    let at = |r: &SweepRun| Some((factor.number(&r.values[n]), *r.outcomes.get(&effect.outcome)?));
    let runs = of.runs.iter().filter(|r| is_of_factor(of, n, r));
    let (counting, left_out): (Vec<&SweepRun>, Vec<&SweepRun>) =
        runs.partition(|r| r.counts_in_means());
    let of_values = || effect.means.iter().map(|(v, e)| (factor.number(v), e));
    let mean_points = of_values().map(|(at, e)| (at, e.mean));
    let bars = of_values().filter_map(|(at, e)| Some([(at, e.t_low?), (at, e.t_high?)]));
    let reach = Interval::of(factor.values.iter().map(|v| factor.number(v)));
    let stroke = reach.map_or(0.0, |i| STROKE * (i.high - i.low));
    let mut plot = panel(of, factor, &effect.outcome);
    plot.add_some("Single runs", Look::rings(), counting.into_iter().filter_map(at));
    let left_out = left_out.into_iter().filter_map(at);
    plot.add_some("Left out of the means", Look::rings().marker(Marker::Cross), left_out);
    bars.for_each(|ends| plot.add_interval("", Look::line(0), ends, (stroke, 0.0)));
    let label = if has_intervals(&[effect]) { "Means, 95 % confidence" } else { "Means" };
    plot.add_some(label, means(0, factor, Marker::Disc), mean_points);
    plot
}

/// How two factors act together: of every result its means over one, a curve a value of the other.
fn pair_figure(of: &Sweep, a: usize, b: usize) -> Result<Option<Figure>, ReportError> {
    let (first, second) = (&of.factors[a], &of.factors[b]);
    let mut table = Table::new(["outcome", "first", "second", "mean"]);
    let has = |path: &&str| of.points.iter().any(|p| p.outcomes.contains_key(*path));
    let outcomes: Vec<&str> = main_outcomes(&of.runs).into_iter().filter(has).collect();
    let of_point = |p: &SweepPoint| {
        let counts = outcomes.iter().filter_map(|path| Some(p.outcomes.get(*path)?.count));
        counts.min()
    };
    let fewest = of.points.iter().filter_map(of_point).min();
    let mut panels = Vec::new();
    for path in outcomes {
        let mut plot = panel(of, first, path);
        for (k, value) in second.values.iter().enumerate() {
            let mut points = Vec::new();
            for at in first.rising() {
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
    let all = of.configurations as usize;
    let uneven = match fewest.filter(|fewest| *fewest < all) {
        Some(fewest) => format!(
            " Some points are over {fewest} of {} (the others lack runs that count), which need not \
             be those of the next point.",
            counted(all, of.realisation())
        ),
        None => String::new(),
    };
    let caption = format!(
        "Means over {}s, and over all values of any further factor. Lines that run beside each \
         other: the two factors act each by itself.{uneven}{}",
        of.realisation(),
        of_withheld(of)
    );
    let stem = stem("pair", &format!("{}-{}", first.path, second.path));
    let title = format!("{} and {} together", first.path, second.path);
    figure_of(&stem, &title, caption, panels, &table)
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;
    use crate::{
        record::{LaboratoryNames, Withheld},
        report::SweepEstimate,
    };

    /// A sweep of one field over 1 and 2, in a number of configurations of two.
    fn sweep(configurations: u32) -> Sweep {
        let result = |value: u32, configuration: u32| f64::from(10 * value + configuration);
        let run = |value: u32, configuration: u32| SweepRun {
            run: format!("point-000{value}-c{configuration}"),
            point: format!("point-000{value}"),
            configuration,
            values: vec![value.into()],
            outcomes: BTreeMap::from([("void_ratio".to_owned(), result(value, configuration))]),
            ..SweepRun::counted()
        };
        let mean_of = |value: u32| {
            let values: Vec<f64> = (1..=configurations).map(|c| result(value, c)).collect();
            (value.into(), SweepEstimate::of(&values).expect("values"))
        };
        Sweep {
            scenario: "s".into(),
            design: "grid",
            factors: vec![SweepFactor {
                path: "seed".into(),
                values: vec![1.into(), 2.into()],
                sampled: false,
                numeric: true,
            }],
            configurations: 2,
            planned: 4,
            runs: (1..=configurations).flat_map(|c| [run(1, c), run(2, c)]).collect(),
            points: Vec::new(),
            effects: vec![SweepEffect {
                factor: "seed".into(),
                outcome: "void_ratio".into(),
                means: vec![mean_of(1), mean_of(2)],
                ..SweepEffect::default()
            }],
            specimens: Vec::new(),
            names: LaboratoryNames::default(),
        }
    }

    /// An effect on the void ratio without numbers.
    fn effect_of_voids() -> SweepEffect {
        SweepEffect {
            factor: "seed".into(),
            outcome: "void_ratio".into(),
            ..SweepEffect::default()
        }
    }

    /// Law: a caption speaks of what is drawn: of intervals where there are any, of runs left out and
    /// of other factors likewise, and of the realisations that were run.
    #[test]
    fn a_caption_is_of_what_is_drawn() {
        let figure = |sweep: &Sweep| of_sweep(sweep).expect("figures").remove(0);
        let whole = figure(&sweep(2));
        let expected = "Rings: every run. Discs: means over 2 realisations. Bars: the 95 % \
                        confidence of the mean by Student's t.";
        assert_eq!(whole.caption, expected, "law: nothing is left out, and no other factor");
        assert!(whole.svg.contains("Means, 95 % confidence"), "law: the key likewise");
        let begun = figure(&sweep(1));
        let expected = "Rings: every run. Discs: means over the realisations run so far. No bars: \
                        one value gives no interval.";
        assert_eq!(begun.caption, expected, "law: half of the runs");
        assert!(!begun.svg.contains("95 %"), "law: no interval is drawn");
        let mut spoilt = sweep(2);
        spoilt.runs[0].left_out_of_means = Some("not valid".to_owned());
        assert!(figure(&spoilt).caption.starts_with("Rings: every run; crosses: runs left out"));
        let mut empty = sweep(2);
        empty.effects[0].means.clear();
        let got = figure(&empty).caption;
        assert!(got.contains("No means") && !got.contains("Discs"), "law: none is drawn: {got}");
        let mut fewer = sweep(2);
        fewer.effects[0].means = sweep(1).effects[0].means.clone();
        let got = figure(&fewer).caption;
        let said =
            "Discs: means over 1 of 2 realisations (the others lack runs that count). No bars";
        assert!(got.contains(said), "law: expected `{said}`, got `{got}`");
        let mut partly = sweep(2);
        let why = Withheld { field: "void_ratio".to_owned(), reason: "it is low".to_owned() };
        partly.runs[0].withheld = vec![why];
        partly.runs[0].outcomes.clear();
        let own = partly.effects.remove(0);
        let other = SweepEffect { outcome: "angle_of_repose.degrees".into(), withheld: 0, ..own };
        let lacking = SweepEffect { withheld: 1, means: Vec::new(), ..effect_of_voids() };
        partly.effects = vec![other, lacking];
        let got = figure(&partly).caption;
        for said in [
            "Discs: means over 2 realisations. ",
            " No means of Void ratio: no realisation has it at every value.",
            " Withheld, and not at random: Void ratio in 1 of 4 runs that count.",
        ] {
            assert!(got.contains(said), "law: expected `{said}`, got `{got}`");
        }
        let mut single = sweep(2);
        single.design = "one_at_a_time";
        assert!(figure(&single).caption.starts_with("Rings: every run."), "law: of one factor");
        single.factors.push(SweepFactor { path: "other".into(), ..single.factors[0].clone() });
        let got = figure(&single).caption;
        let said = "Rings: every run in which all other factors have the scenario's own values.";
        assert!(got.starts_with(said), "law: expected `{said}`, got `{got}`");
        let point = |name: &str, values: [u32; 2]| SweepPoint {
            point: name.to_owned(),
            values: values.map(Value::from).into(),
            runs: 2,
            valid: 2,
            left_out: 0,
            failed: 0,
            outcomes: BTreeMap::new(),
        };
        single.points = vec![point("point-0001", [1, 5]), point("point-0002", [1, 6])];
        for (left_out, expected) in [("point-0001", true), ("point-0002", false)] {
            for run in &mut single.runs {
                let is_it = run.point == left_out;
                run.left_out_of_means = is_it.then(|| "not valid".to_owned());
            }
            let got = figure(&single).caption;
            let said = got.contains("crosses");
            assert_eq!(said, expected, "law: crosses where {left_out} is left out: {got}");
        }
        let mut drawn = sweep(2);
        drawn.factors[0].sampled = true;
        assert!(!figure(&drawn).caption.contains("Crosses"), "law: no run is left out");
        drawn.runs[0].left_out_of_means = Some("not valid".to_owned());
        assert!(figure(&drawn).caption.contains("Crosses: runs left out"), "law: one is");
    }

    /// Law: lines go from value to value as these rise, in whatever order they were given.
    #[test]
    fn lines_follow_the_values() {
        let factor = |path: &str, values: &[f64]| SweepFactor {
            path: path.into(),
            values: values.iter().copied().map(Value::from).collect(),
            sampled: false,
            numeric: true,
        };
        let point = |a: f64, b: f64| {
            let estimate = SweepEstimate::of(&[a * a + b]).expect("a value");
            SweepPoint {
                point: String::new(),
                values: vec![a.into(), b.into()],
                runs: 1,
                valid: 1,
                left_out: 0,
                failed: 0,
                outcomes: BTreeMap::from([("void_ratio".to_owned(), estimate)]),
            }
        };
        let pair = |values: &[f64]| {
            let mut of = sweep(2);
            of.factors = vec![factor("a", values), factor("b", &[1.0, 2.0])];
            of.points = values.iter().flat_map(|a| [point(*a, 1.0), point(*a, 2.0)]).collect();
            pair_figure(&of, 0, 1).expect("drawn").expect("a figure").svg
        };
        let is_same = pair(&[0.9, 0.3, 0.6]) == pair(&[0.3, 0.6, 0.9]);
        assert!(is_same, "law: the same lines, whatever the order of the values");
    }

    /// Law: where points lack realisations the caption of two factors says so, and else does not.
    #[test]
    fn means_over_fewer_realisations_are_said() {
        let factor = |path: &str| SweepFactor { path: path.into(), ..sweep(2).factors.remove(0) };
        let point = |a: u32, b: u32, results: &[f64]| SweepPoint {
            point: String::new(),
            values: vec![a.into(), b.into()],
            runs: 2,
            valid: results.len(),
            left_out: 2 - results.len(),
            failed: 0,
            outcomes: BTreeMap::from([(
                "void_ratio".to_owned(),
                SweepEstimate::of(results).expect("a value"),
            )]),
        };
        for (results, expected) in [(&[0.8, 0.9][..], false), (&[0.8], true)] {
            let mut of = sweep(2);
            of.factors = vec![factor("a"), factor("b")];
            of.points = vec![point(1, 1, &[0.7, 0.8]), point(1, 2, &[0.7, 0.8])];
            of.points.extend([point(2, 1, &[0.7, 0.8]), point(2, 2, results)]);
            let got = pair_figure(&of, 0, 1).expect("drawn").expect("a figure").caption;
            let said = "Some points are over 1 of 2 realisations (the others lack runs that count)";
            assert_eq!(got.contains(said), expected, "law: of {results:?}, got `{got}`");
        }
    }

    /// The texts of a figure, each with its size.
    fn texts(svg: &str) -> Vec<(f64, &str)> {
        fn text(part: &str) -> Option<(f64, &str)> {
            let (head, rest) = part.split_once('>')?;
            let (_, size) = head.split_once("font-size=\"")?;
            let (size, _) = size.split_once('"')?;
            Some((size.parse().ok()?, rest.split_once('<')?.0.trim()))
        }
        svg.split("<text ").skip(1).filter_map(text).collect()
    }

    /// Law: names of axes and of values stand on the sheet, however long they are; values that are no
    /// numbers are named at their ticks.
    #[test]
    fn long_names_stay_on_the_sheet() {
        let mut of = sweep(2);
        of.names.regions = vec!["lower-half-of-the-large-shear-box".to_owned()];
        let outcome = "laboratory.regions.0.void_ratio";
        of.effects[0].outcome = outcome.to_owned();
        let values = ["crushed-basalt-of-the-northern-quarry", "river gravel"];
        of.factors[0].values = values.map(Value::from).into();
        of.factors[0].numeric = false;
        for run in &mut of.runs {
            let n = usize::from(run.point == "point-0002");
            run.values = vec![values[n].into()];
            run.outcomes = BTreeMap::from([(outcome.to_owned(), 0.6)]);
        }
        of.effects[0].means.clear();
        let svg = of_sweep(&of).expect("figures").remove(0).svg;
        let written = texts(&svg);
        let name = in_words(outcome, &of.names);
        // A panel is 660 high from its upper edge to the same distance below its middle.
        for (text, room) in [(name.as_str(), 660.0), (values[0], 870.0), (values[1], 870.0)] {
            let found = written.iter().find(|(_, found)| *found == text);
            let Some((size, _)) = found else { panic!("law: `{text}` is written: {written:?}") };
            let got = style::text_width(text, *size);
            assert!(got <= room, "law: `{text}` fits into {room}, got {got} at {size}");
        }
        assert!(written.iter().any(|(_, text)| *text == "seed"), "law: the axis is the field's");
        of.factors[0].values.push("a".repeat(500).into());
        let svg = of_sweep(&of).expect("figures").remove(0).svg;
        let cut = texts(&svg).into_iter().find(|(_, text)| text.starts_with("3 a"));
        let (size, text) = cut.expect("law: a very long value is numbered and cut off");
        let got = style::text_width(text, size);
        assert!(text.ends_with('…') && got <= 580.0, "law: it fits into 580, got {got}: {text}");
    }
}
