//! `convergence.md`: the tables of a convergence study.

use super::{
    Convergence, ConvergenceRow, Deviation, Figure,
    page::{Block, Page},
    table::{Cell, Table, besides, dash, missing, plus_minus, table},
};
use crate::{
    measure::Estimate,
    paper::text::{compact, number},
    record::{VariationRow, left_out_in_words},
};

/// The page.
pub(super) fn page(of: &Convergence, figures: Vec<Figure>) -> Page {
    let specimen = specimen(&of.scenario, of.grains, of.quick);
    let (left_out, with_result) = of.left_out();
    let said = match left_out_in_words(left_out, with_result) {
        said if said.is_empty() => said,
        said => format!("{said}, being not valid or short of grains."),
    };
    let intro = format!(
        "{specimen}. Heights and settlements in mm, of the mean surface after pouring, of the plate and \
         of the mean surface after 5 s of vibration (at its end, where it is shorter). Means over \
         configurations ± standard error."
    );
    let head = [Block::Text(intro), Block::Banner(said)].into_iter().chain(cheapest(of));
    let mut page = Page::new("Convergence", head);
    let ladders: Vec<&str> = of.rows.iter().map(|row| row.ladder.as_str()).collect();
    for (n, ladder) in ladders.iter().enumerate().filter(|(n, l)| !ladders[..*n].contains(l)) {
        let rows: Vec<&ConvergenceRow> = of.rows.iter().filter(|r| r.ladder == *ladder).collect();
        let table = ladder_table(&rows, several_precisions(of));
        page = page.section(&format!("ladder-{n}"), ladder, [Block::Table(table)]);
    }
    let deviations = format!("Deviations from the finest rung of \"{}\".", of.reference);
    page.section(
        "settings",
        "Every setting, the cheapest first",
        [Block::Text(deviations), Block::Table(against_the_study(of))],
    )
    .section("reading", "How to read it", [Block::Text(how_to_read(of))])
    .figures("figures", "Figures", figures)
}

/// Which specimen a study is of.
pub(super) fn specimen(scenario: &str, grains: Option<usize>, quick: bool) -> String {
    let grains = grains.map_or_else(|| "grains".to_owned(), |n| format!("{n} grains"));
    format!("Scenario `{scenario}`, {grains}{}", if quick { ", the smaller specimen" } else { "" })
}

fn several_precisions(of: &Convergence) -> bool {
    let first = of.rows.first().map(|r| &r.result.precision);
    of.rows.iter().any(|r| Some(&r.result.precision) != first)
}

/// A rung, with its precision where there are several.
fn rung(row: &ConvergenceRow, precisions: bool, ending: &str) -> String {
    match precisions {
        true => format!("{}, {}{ending}", row.rung, row.result.precision),
        false => row.rung.clone(),
    }
}

/// A ladder and a rung of it.
fn setting(row: &ConvergenceRow, precisions: bool) -> String {
    format!("{}: {}", row.ladder, rung(row, precisions, " precision"))
}

fn cheapest(of: &Convergence) -> [Block; 2] {
    let said = |number: Option<usize>| {
        let Some(row) = number.and_then(|n| of.rows.get(n)) else { return "none".to_owned() };
        let cost = row.result.wall_s_per_simulated_s.map_or(f64::NAN, |c| c.mean);
        let name = setting(row, several_precisions(of));
        let finest = match row.finest_of_study {
            true => ", which is what all others are compared with",
            false => "",
        };
        format!("**{name}** ({} s a simulated second{finest})", compact(cost))
    };
    let standard = format!(
        "The whole standard: overlap below {} % in the mean and {} % at its 99th percentile, creep below \
         {} µm/s, the height within {} % and both settlements within {} % of the finest rung, of the \
         setting's own ladder and of the ladder \"{}\".",
        compact(of.standard.overlap_mean_percent),
        compact(of.standard.overlap_p99_percent),
        compact(of.standard.creep_um_per_s),
        compact(of.height_limit_percent),
        compact(of.settlement_limit_percent),
        of.reference,
    );
    let settings = [
        ("cheapest setting that meets it by its means", of.cheapest.meeting),
        ("cheapest of which scatter leaves no doubt", of.cheapest.surely_meeting),
        ("cheapest that is not shown to miss it", of.cheapest.not_shown_to_miss),
    ];
    let settings = settings.map(|(what, row)| format!("{what}: {}", said(row)));
    [Block::Text(standard), Block::List(settings.into())]
}

fn ladder_table(rows: &[&ConvergenceRow], precisions: bool) -> Table {
    table!(rows.iter().map(|row| (row, &row.result, row.from_ladder)), |(row, v, from)| {
        "setting" => rung(row, precisions, ""),
        "runs; grains outside" => runs(v),
        "height" => length(v, v.poured_height_mm),
        "%" => deviation(&from.height, v, v.poured_height_mm, row.finest_of_ladder),
        "plate" => length(v, v.plate_settlement_mm),
        "%" => deviation(&from.plate, v, v.plate_settlement_mm, row.finest_of_ladder),
        "surface" => length(v, v.surface_settlement_mm),
        "%" => deviation(&from.surface, v, v.surface_settlement_mm, row.finest_of_ladder),
        "overlap mean / p99, %" => [v.overlap_mean_percent, v.overlap_p99_percent]
            .map(|e| Cell::fixed(mean(e), 2).text)
            .join(" / "),
        "creep, µm/s" => Cell::fixed(mean(v.creep_um_per_s), 2),
        "s a simulated s" => Cell::compact(mean(v.wall_s_per_simulated_s)),
        "standard" => verdict(row),
    })
}

fn runs(v: &VariationRow) -> String {
    let outside = v.grains_outside.filter(|g| g.mean > 0.0);
    let outside = outside.map_or_else(String::new, |g| format!("; {}", number(g.mean, 1)));
    format!("{}{}{}{outside}", v.runs, besides(v.failed, "failed"), besides(v.left_out, "left out"))
}

fn against_the_study(of: &Convergence) -> Table {
    let mut rows = of.settings();
    let cost = |r: &ConvergenceRow| mean(r.result.wall_s_per_simulated_s).unwrap_or(f64::MAX);
    rows.sort_by(|a, b| cost(a).total_cmp(&cost(b)));
    table!(rows.iter().map(|row| (row, &row.result, row.from_study)), |(row, v, from)| {
        "setting" => setting(row, several_precisions(of)),
        "s a simulated s" => Cell::compact(mean(v.wall_s_per_simulated_s)),
        "height, %" => deviation(&from.height, v, v.poured_height_mm, row.finest_of_study),
        "plate, %" => deviation(&from.plate, v, v.plate_settlement_mm, row.finest_of_study),
        "surface, %" => deviation(&from.surface, v, v.surface_settlement_mm, row.finest_of_study),
        "largest error over its limit" => Cell::compact(row.error_over_limit),
        "standard" => verdict(row),
    })
}

fn how_to_read(of: &Convergence) -> String {
    format!(
        "A packing is chaotic: one bit changed gives another packing. Deviations are means over \
         configurations, paired, with their standard error. \"~\" marks a deviation that lies inside the \
         scatter: its 95 % confidence interval (Student's t) holds zero. **Bold** is beyond the limit of \
         {} % (height) or {} % (settlements); \"?\" says that scatter leaves open whether it is. What has \
         no ± stands on one run, which tells nothing of scatter. \"reference\" is the finest rung, from \
         which nothing can deviate: what its own ladder does not refine may still be wrong. Left out are \
         runs with a result that are not valid, or short of grains (docs/accuracy.md): heights, \
         settlements and deviations are without them; overlap, creep, grains outside and times are of \
         all runs, or a setting would pass by what it spoils. A setting with a run in which a run-time \
         check found something misses the standard, as one with a run that failed. Grains outside are \
         those that do not lie in the cylinder at the end, in the mean over runs: a jam in the funnel \
         lowers the specimen by what is stuck there. Creep is without its sign. \"standard\" takes \
         everything together, with the deviations from both references.",
        compact(of.height_limit_percent),
        compact(of.settlement_limit_percent)
    )
}

fn verdict(row: &ConvergenceRow) -> &'static str {
    match (row.meets, row.open) {
        (Some(true), Some(false)) => "met",
        (Some(true), Some(true)) => "met, open",
        (Some(true), None) => "met, scatter unknown",
        (Some(false), _) => "missed",
        (None, _) => "not known",
    }
}

fn mean(estimate: Option<Estimate>) -> Option<f64> {
    estimate.map(|e| e.mean)
}

/// A mean with its standard error.
pub(super) fn estimate(of: Estimate, decimals: usize) -> String {
    plus_minus(of.mean, of.standard_error, |v| number(v, decimals))
}

fn length(of: &VariationRow, mean: Option<Estimate>) -> String {
    mean.map_or_else(|| missing(of.has_no_valid_run()), |e| estimate(e, 1))
}

/// A deviation, bold beyond its limit, marked where scatter explains it or leaves it open.
fn deviation(d: &Deviation, of: &VariationRow, own: Option<Estimate>, reference: bool) -> String {
    match (own, d.percent) {
        (None, _) if of.has_no_valid_run() => missing(true),
        _ if reference => "reference".to_owned(),
        // Its own runs count, and none of the reference's of the same configurations.
        (Some(_), None) => "no valid pair".to_owned(),
        (None, None) => dash(),
        (_, Some(percent)) => {
            let bold = if d.within == Some(false) { "**" } else { "" };
            let scatter = if d.inside_scatter == Some(true) { " ~" } else { "" };
            let open = if d.open == Some(true) { " ?" } else { "" };
            format!("{bold}{}{bold}{scatter}{open}", estimate(percent, 1))
        }
    }
}
