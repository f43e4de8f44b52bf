//! `convergence.md`: the tables of a convergence study.

use std::fmt::Write;

use super::{Convergence, ConvergenceRow, Deviation, Deviations, figures::Figure};
use crate::measure::Estimate;
use crate::paper::text::{compact, number};
use crate::record::{NO_VALID_RUN, VariationRow, left_out_in_words};

/// The page.
pub(super) fn page(of: &Convergence, figures: &[Figure]) -> String {
    let mut text = String::from("# Convergence\n\n");
    let grains = of.grains.map_or_else(|| "grains".to_owned(), |n| format!("{n} grains"));
    let _ = write!(
        text,
        "Scenario `{}`, {grains}{}. Heights and settlements in mm, of the mean surface after pouring, \
         of the plate and of the mean surface after 5 s of vibration (at its end, where it is \
         shorter). Means over configurations ± standard error.\n\n",
        of.scenario,
        if of.quick { ", the smaller specimen" } else { "" }
    );
    left_out(&mut text, of);
    cheapest(&mut text, of);
    let mut ladders: Vec<&str> = Vec::new();
    for row in &of.rows {
        if !ladders.contains(&row.ladder.as_str()) {
            ladders.push(&row.ladder);
        }
    }
    for ladder in ladders {
        let rows: Vec<&ConvergenceRow> = of.rows.iter().filter(|r| r.ladder == ladder).collect();
        ladder_table(&mut text, ladder, &rows, several_precisions(of));
    }
    against_the_study(&mut text, of);
    how_to_read(&mut text, of);
    for figure in figures {
        let _ = write!(
            text,
            "\n![{}](figures/{}.png)\n\n{}\n",
            figure.title, figure.stem, figure.caption
        );
    }
    text
}

/// How many runs are left out of the means.
fn left_out(text: &mut String, of: &Convergence) {
    let (left_out, with_result) = of.left_out();
    let said = left_out_in_words(left_out, with_result);
    if !said.is_empty() {
        let _ = write!(text, "**{said}**, being not valid or short of grains.\n\n");
    }
}

fn several_precisions(of: &Convergence) -> bool {
    let first = of.rows.first().map(|r| &r.result.precision);
    of.rows.iter().any(|r| Some(&r.result.precision) != first)
}

/// Ladder, rung and, where there are several, precision.
pub(super) fn setting(row: &ConvergenceRow, precisions: bool) -> String {
    let mut text = format!("{}: {}", row.ladder, row.rung);
    if precisions {
        let _ = write!(text, ", {} precision", row.result.precision);
    }
    text
}

fn cheapest(text: &mut String, of: &Convergence) {
    let said = |number: Option<usize>| {
        let row = number.and_then(|n| of.rows.get(n));
        row.map_or_else(
            || "none".to_owned(),
            |row| {
                let cost = row.result.wall_s_per_simulated_s.map_or(f64::NAN, |c| c.mean);
                let name = setting(row, several_precisions(of));
                let finest = if row.finest_of_study {
                    ", which is what the study itself is held against"
                } else {
                    ""
                };
                format!("**{name}** ({} s a simulated second{finest})", compact(cost))
            },
        )
    };
    let _ = write!(
        text,
        "The whole standard: overlap below {} % in the mean and {} % at its 99th percentile, creep \
         below {} µm/s, the height within {} % and both settlements within {} % of the finest \
         rung, of the setting's own ladder and of the ladder \"{}\".\n\n\
         - cheapest setting that meets it by its means: {}\n\
         - cheapest of which scatter leaves no doubt: {}\n\
         - cheapest that is not shown to miss it: {}\n",
        compact(of.standard.overlap_mean_percent),
        compact(of.standard.overlap_p99_percent),
        compact(of.standard.creep_um_per_s),
        compact(of.height_limit_percent),
        compact(of.settlement_limit_percent),
        of.reference,
        said(of.cheapest.meeting),
        said(of.cheapest.surely_meeting),
        said(of.cheapest.not_shown_to_miss),
    );
}

fn ladder_table(text: &mut String, ladder: &str, rows: &[&ConvergenceRow], precisions: bool) {
    let _ = write!(
        text,
        "\n## {ladder}\n\n| setting | runs; grains outside | height | % | plate | % | surface | % | overlap mean / \
         p99, % | creep, µm/s | s a simulated s | standard |\n|{}\n",
        " --- |".repeat(12)
    );
    for row in rows {
        let v = &row.result;
        let mut name = row.rung.clone();
        if precisions {
            let _ = write!(name, ", {}", v.precision);
        }
        let mut failed =
            if v.failed > 0 { format!(", {} failed", v.failed) } else { String::new() };
        if v.left_out > 0 {
            let _ = write!(failed, ", {} left out", v.left_out);
        }
        let outside = v.grains_outside.filter(|g| g.mean > 0.0);
        let outside = outside.map_or_else(String::new, |g| format!("; {}", number(g.mean, 1)));
        let d = &row.from_ladder;
        let _ = writeln!(
            text,
            "| {name} | {}{failed}{outside} | {} | {} | {} | {} | {} | {} | {} / {} | {} | {} | {} |",
            v.runs,
            length(v, v.poured_height_mm),
            deviation(&d.height, v, v.poured_height_mm, row.finest_of_ladder),
            length(v, v.plate_settlement_mm),
            deviation(&d.plate, v, v.plate_settlement_mm, row.finest_of_ladder),
            length(v, v.surface_settlement_mm),
            deviation(&d.surface, v, v.surface_settlement_mm, row.finest_of_ladder),
            hundredths(v.overlap_mean_percent),
            hundredths(v.overlap_p99_percent),
            hundredths(v.creep_um_per_s),
            mean(v.wall_s_per_simulated_s),
            verdict(row),
        );
    }
}

/// Every setting against the study's finest, the cheapest first.
fn against_the_study(text: &mut String, of: &Convergence) {
    // A setting may stand in several ladders.
    let mut rows: Vec<&ConvergenceRow> = Vec::new();
    for row in &of.rows {
        if !rows.iter().any(|known| known.same_setting(row)) {
            rows.push(row);
        }
    }
    let cost = |r: &ConvergenceRow| r.result.wall_s_per_simulated_s.map_or(f64::MAX, |c| c.mean);
    rows.sort_by(|a, b| cost(a).total_cmp(&cost(b)));
    let _ = write!(
        text,
        "\n## Every setting, the cheapest first\n\nDeviations from the finest rung of \"{}\".\n\n| \
         setting | s a simulated s | height, % | plate, % | surface, % | largest error over its \
         limit | standard |\n|{}\n",
        of.reference,
        " --- |".repeat(7)
    );
    for row in rows {
        let Deviations { height, plate, surface } = &row.from_study;
        let v = &row.result;
        let _ = writeln!(
            text,
            "| {} | {} | {} | {} | {} | {} | {} |",
            setting(row, several_precisions(of)),
            mean(row.result.wall_s_per_simulated_s),
            deviation(height, v, v.poured_height_mm, row.finest_of_study),
            deviation(plate, v, v.plate_settlement_mm, row.finest_of_study),
            deviation(surface, v, v.surface_settlement_mm, row.finest_of_study),
            row.error_over_limit.map_or_else(|| "–".to_owned(), compact),
            verdict(row),
        );
    }
}

fn how_to_read(text: &mut String, of: &Convergence) {
    let _ = write!(
        text,
        "\n## How to read it\n\n\
         A packing is chaotic: one bit changed gives another packing. Deviations are means over \
         configurations, paired, with their standard error. \"~\" marks a deviation that lies \
         inside the scatter: its 95 % confidence interval (Student's t) holds zero. **Bold** is \
         beyond the limit of {} % (height) or {} % (settlements); \"?\" says that scatter leaves \
         open whether it is. What has no ± stands on one run, which tells nothing of scatter. \"reference\" is the finest rung, \
         from which nothing can deviate: what its own ladder does not refine may still be wrong. \
         Left out are runs with a result that are not valid, or short of grains (docs/accuracy.md): heights, \
         settlements and deviations are without them; overlap, creep, grains outside and times are of all \
         runs, or a setting would pass by what it spoils. A setting with a run in which a run-time check \
         found something misses the standard, as one with a run that failed. Grains outside are those that do not lie in the cylinder at the end, in \
         the mean over runs: a jam in the funnel lowers the specimen by what hangs there. \
         Creep is without its sign. \"standard\" takes everything together, with the \
         deviations from both references.\n",
        compact(of.height_limit_percent),
        compact(of.settlement_limit_percent)
    );
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

fn mean(estimate: Option<Estimate>) -> String {
    estimate.map_or_else(|| "–".to_owned(), |e| compact(e.mean))
}

fn hundredths(estimate: Option<Estimate>) -> String {
    estimate.map_or_else(|| "–".to_owned(), |e| number(e.mean, 2))
}

/// Mean ± standard error; the mean alone of a single run.
pub(super) fn estimate(estimate: Option<Estimate>, decimals: usize) -> String {
    let Some(e) = estimate else { return "–".to_owned() };
    match e.standard_error {
        Some(error) => format!("{} ± {}", number(e.mean, decimals), number(error, decimals)),
        None => number(e.mean, decimals),
    }
}

/// A mean length of a setting, or why there is none.
fn length(of: &VariationRow, mean: Option<Estimate>) -> String {
    if mean.is_none() && of.has_no_valid_run() {
        return NO_VALID_RUN.to_owned();
    }
    estimate(mean, 1)
}

/// The deviation of a mean `own` of a setting, or why there is none.
fn deviation(d: &Deviation, of: &VariationRow, own: Option<Estimate>, reference: bool) -> String {
    if own.is_none() && of.has_no_valid_run() {
        return NO_VALID_RUN.to_owned();
    }
    if reference {
        return "reference".to_owned();
    }
    let Some(percent) = d.percent else {
        // Its own runs count, and none of the reference's of the same configurations.
        return if own.is_some() { "no valid pair" } else { "–" }.to_owned();
    };
    let mut text = estimate(Some(percent), 1);
    if d.within == Some(false) {
        text = format!("**{text}**");
    }
    if d.inside_scatter == Some(true) {
        text += " ~";
    }
    if d.open == Some(true) {
        text += " ?";
    }
    text
}
