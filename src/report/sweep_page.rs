//! The page of a sweep, as Markdown and as HTML.

use super::{
    Figure, Sweep, SweepEffect, SweepEstimate, SweepPoint, SweepRun,
    page::{Block, Page},
    sweep::shown,
    sweep_outcomes::{in_words, main_outcomes},
    table::{Cell, Table, besides, counted, dash, missing, plus_minus, row, table},
};
use crate::{paper::text::compact, plain::plain, record::left_out_in_words};

const HOW_TO_READ: &str = "Every point is run in the same configurations, each a new random \
     arrangement of the same grains. Intervals are 95 % confidence intervals of the mean over \
     configurations, by Student's t; sweep.json has those of the bootstrap as well. A change for \
     one unit is the slope of a line through each configuration's own results, its mean and \
     interval over configurations; where values were drawn from ranges, it is the coefficient in a \
     linear model of all of them. The test by ranks (Page 1963) asks whether results rise or fall \
     from value to value without assuming a line. A run is valid if it meets the accuracy standard \
     and no run-time check found anything. Means and effects leave out runs that are not valid, \
     and runs of which too many grains are missing (docs/accuracy.md); each point says how many. \
     Configurations needed: the number that would show a slope of this size among this scatter with \
     a probability of 80 %.";

pub(super) fn page(of: &Sweep, figures: Vec<Figure>) -> Page {
    let failed = of.failed().count();
    let done = of.runs.len() - failed;
    // What has run out of a laboratory is valid without an end to judge.
    let is_below = |r: &&SweepRun| r.meets_standard == Some(false) && r.valid != Some(true);
    let below = of.runs.iter().filter(is_below).count();
    let not_valid = of.runs.iter().filter(|r| r.valid == Some(false)).count();
    let is_found = |r: &&SweepRun| r.meets_standard == Some(true) && r.valid == Some(false);
    let found = of.runs.iter().filter(is_found).count();
    let left_out = of.left_out().count();
    let say = |count: usize, text: String| if count > 0 { text } else { String::new() };
    let lead = format!(
        "{} points in {}: {done} of {} runs have results{}{}{}{}{}.",
        of.points.len(),
        counted(of.configurations as usize, "configuration"),
        of.planned,
        say(failed, format!(", {failed} failed")),
        say(
            below,
            format!(
                "; {below} {} meet the accuracy standard for overlap and numerical creep",
                if below == 1 { "does not" } else { "do not" }
            )
        ),
        say(
            found,
            format!(
                "; in {found} {} a run-time check found something",
                if found == 1 { "that does" } else { "that do" }
            )
        ),
        say(not_valid, format!("; not valid: {not_valid} of {done}")),
        left_out_in_words(left_out, done).map_or(String::new(), |said| format!("; {said}")),
    );
    let is_well = failed == 0 && not_valid == 0 && left_out == 0;
    let why_left_out = reasons(of, of.left_out(), |r| r.left_out_of_means.as_ref());
    let why_failed = reasons(of, of.failed(), |r| r.failure.as_ref());
    Page::new(format!("Sweep of {}", plain(&of.scenario)), [Block::lead(lead, is_well)])
        .section("effects", "What each factor moves", [Block::Table(effects(of))])
        .section("points", "Points", [Block::Table(points(of))])
        .section("left-out", "Runs left out of means", [Block::Table(why_left_out)])
        .section("failures", "Runs without result", [Block::Table(why_failed)])
        .figures("figures", "Figures", figures)
        .section("reading", "How to read it", [Block::Text(HOW_TO_READ.to_owned())])
}

fn probability(p: Option<f64>) -> Cell {
    match p {
        Some(p) if p < 0.001 => Cell::number("< 0.001"),
        p => Cell::fixed(p, 3),
    }
}

fn effects(of: &Sweep) -> Table {
    table!(&of.effects, |e| {
        "factor" => &e.factor,
        "result" => in_words(&e.outcome, &of.names),
        "change for one unit" => Cell::number(slope(e)),
        "p" => probability(e.slope_p),
        "p by ranks" => probability(e.page_p),
        "configurations needed" => match e.configurations_needed {
            Some(n) => Cell::from(n),
            None => Cell::number(dash()),
        },
    })
}

fn slope(of: &SweepEffect) -> String {
    match of.slope.map(|slope| plus_minus(slope, of.slope_half_width, compact)) {
        Some(shown) if of.left_out > 0 => format!("{shown} (left out: {})", of.left_out),
        Some(shown) => shown,
        None if of.left_out > 0 && of.runs > 0 => "too few valid runs".to_owned(),
        None => missing(of.left_out > 0),
    }
}

fn estimate(of: &SweepPoint, e: Option<&SweepEstimate>) -> Cell {
    let shown = e.map(|e| plus_minus(e.mean, e.t_high.map(|high| high - e.mean), compact));
    let none = || missing(of.left_out > 0 && of.left_out == of.runs);
    Cell::number(shown.unwrap_or_else(none))
}

fn points(of: &Sweep) -> Table {
    let outcomes = main_outcomes(&of.runs);
    let factors = of.factors.iter().map(|f| f.path.clone());
    let counts = ["runs", "valid", "left out"].map(str::to_owned);
    let words = outcomes.iter().map(|path| in_words(path, &of.names));
    let first = ["point".to_owned()].into_iter();
    let mut table = Table::new(first.chain(factors).chain(counts).chain(words));
    for p in &of.points {
        let mut cells = row![&p.point];
        cells.extend(p.values.iter().map(|value| Cell::from(shown(value))));
        let runs = format!("{}{}", p.runs, besides(p.failed, "failed"));
        cells.extend(row![runs, p.valid, p.left_out]);
        cells.extend(outcomes.iter().map(|path| estimate(p, p.outcomes.get(*path))));
        table.row(cells);
    }
    table
}

/// Runs with a reason each.
fn reasons<'a>(
    of: &Sweep,
    runs: impl Iterator<Item = &'a SweepRun>,
    why: impl Fn(&SweepRun) -> Option<&String>,
) -> Table {
    let values = |r: &SweepRun| {
        let each = of.factors.iter().zip(&r.values);
        each.map(|(f, v)| format!("{}={}", f.path, shown(v))).collect::<Vec<_>>().join(" ")
    };
    table!(runs, |r| {
        "run" => &r.run,
        "values" => values(r),
        "why" => why(r),
    })
}
