//! `sensitivity.md`: the tables of a sensitivity study.

use std::fmt::Write;

use super::{
    Effect, ParameterRow, Sensitivity, convergence_page::estimate, figures::Figure,
    sensitivity::ranked,
};
use crate::measure::Estimate;
use crate::paper::text::{compact, number};
use crate::record::NO_VALID_RUN;

/// The page.
pub(super) fn page(of: &Sensitivity, figure: &Figure) -> String {
    let mut text = String::from("# Sensitivity\n\n");
    let grains = of.grains.map_or_else(|| "grains".to_owned(), |n| format!("{n} grains"));
    let _ = write!(
        text,
        "Scenario `{}`, {grains}{}, {} configuration{}. Each parameter is varied by itself, all \
         others at their defaults. Differences in mm ± standard error, paired by configuration: \
         runs of a pair have the same grains in the same order. A packing is chaotic, so that \
         pairs scatter; \"~\" marks an effect that lies inside that scatter: the 95 % confidence \
         interval (Student's t) of its largest difference holds zero. Grains outside are those that do \
         not lie in the cylinder at the end: a jam in the funnel lowers the specimen by what hangs \
         there. Runs that are not valid, or short of grains, are left out of every difference with their pair \
         (docs/accuracy.md), and counted.\n\n",
        of.scenario,
        if of.quick { ", the smaller specimen" } else { "" },
        of.configurations,
        if of.configurations == 1 { "" } else { "s" },
    );
    if let Some(default) = &of.default {
        let spread = |e: Option<Estimate>| {
            if e.is_none() && default.has_no_valid_run() {
                return NO_VALID_RUN.to_owned();
            }
            let deviation =
                e.and_then(|e| Some((e.mean, e.standard_error? * (e.count as f64).sqrt())));
            deviation.map_or_else(
                || estimate(e, 1),
                |(mean, s)| format!("{} (standard deviation {})", number(mean, 1), number(s, 1)),
            )
        };
        let _ = write!(
            text,
            "Without a change, over configurations, in mm: height {}, settlement of the plate {}, \
             of the surface {}{}.\n\n",
            spread(default.poured_height_mm),
            spread(default.plate_settlement_mm),
            spread(default.surface_settlement_mm),
            if default.left_out > 0 {
                format!("; left out of these means: {} of {} runs", default.left_out, default.runs)
            } else {
                String::new()
            },
        );
    }
    let _ =
        write!(text, "![{}](figures/{}.png)\n\n{}\n", figure.title, figure.stem, figure.caption);
    table(&mut text, "Height after pouring", of, |r| r.height);
    table(&mut text, "Settlement of the plate", of, |r| r.plate);
    table(&mut text, "Settlement of the mean surface", of, |r| r.surface);
    text += "\n## Ranges\n\n| parameter | from | default | to | why |\n| --- | --- | --- | --- | --- \
             |\n";
    for row in &of.parameters {
        let unit = unit(row);
        let _ = writeln!(
            text,
            "| {} | {}{unit} | {}{unit} | {}{unit} | {} |",
            row.title,
            compact(row.low),
            compact(row.default),
            compact(row.high),
            row.reason
        );
    }
    text
}

fn unit(row: &ParameterRow) -> String {
    if row.unit.is_empty() { String::new() } else { format!(" {}", row.unit) }
}

fn table(text: &mut String, title: &str, of: &Sensitivity, effect: fn(&ParameterRow) -> Effect) {
    let _ = write!(
        text,
        "\n## {title}\n\n| parameter | range | at the low end | at the high end | over the range | \
         for one unit | |\n|{}\n",
        " --- |".repeat(7)
    );
    let default_left_out = of.default.as_ref().is_some_and(|d| d.left_out > 0);
    for row in ranked(&of.parameters, effect) {
        let e = effect(row);
        let mark = match e.inside_scatter {
            Some(true) => Some("~".to_owned()),
            Some(false) => None,
            None => Some("scatter unknown".to_owned()),
        };
        let failed = (row.failed > 0).then(|| format!("{} failed", row.failed));
        let left_out = (row.left_out > 0).then(|| format!("{} left out", row.left_out));
        let change = |e: Option<Estimate>, shown: fn(Option<Estimate>) -> String| match e {
            None if row.left_out > 0 && row.valid == 0 => NO_VALID_RUN.to_owned(),
            None if row.left_out > 0 || default_left_out => "no valid pair".to_owned(),
            e => shown(e),
        };
        let mm = |e| change(e, |e| estimate(e, 1));
        let outside = row.grains_outside.filter(|g| *g >= 0.5);
        let outside = outside.map(|g| format!("grains outside: {}", number(g, 1)));
        let remarks: Vec<String> =
            [failed, left_out, mark, outside].into_iter().flatten().collect();
        let _ = writeln!(
            text,
            "| {} | {} to {}{} | {} | {} | {} | {} | {} |",
            row.title,
            compact(row.low),
            compact(row.high),
            unit(row),
            mm(e.low_mm),
            mm(e.high_mm),
            mm(e.range_mm),
            change(e.per_unit_mm, per_unit),
            remarks.join(", "),
        );
    }
}

/// Slopes have any size.
fn per_unit(estimate: Option<Estimate>) -> String {
    let Some(e) = estimate else { return "–".to_owned() };
    match e.standard_error {
        Some(error) => format!("{} ± {}", compact(e.mean), compact(error)),
        None => compact(e.mean),
    }
}
