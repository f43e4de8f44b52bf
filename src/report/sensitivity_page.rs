//! `sensitivity.md`: the tables of a sensitivity study.

use std::fmt::Write;

use super::{
    Effect, ParameterRow, Sensitivity, convergence_page::estimate, figures::Figure,
    sensitivity::ranked,
};
use crate::measure::Estimate;
use crate::paper::text::{compact, number};

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
         there.\n\n",
        of.scenario,
        if of.quick { ", the smaller specimen" } else { "" },
        of.configurations,
        if of.configurations == 1 { "" } else { "s" },
    );
    if let Some(default) = &of.default {
        let spread = |e: Option<Estimate>| {
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
             of the surface {}.\n\n",
            spread(default.poured_height_mm),
            spread(default.plate_settlement_mm),
            spread(default.surface_settlement_mm),
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
    for row in ranked(&of.parameters, effect) {
        let e = effect(row);
        let mark = match e.inside_scatter {
            Some(true) => Some("~".to_owned()),
            Some(false) => None,
            None => Some("scatter unknown".to_owned()),
        };
        let failed = (row.failed > 0).then(|| format!("{} failed", row.failed));
        let outside = row.grains_outside.filter(|g| *g >= 0.5);
        let outside = outside.map(|g| format!("grains outside: {}", number(g, 1)));
        let remarks: Vec<String> = [failed, mark, outside].into_iter().flatten().collect();
        let _ = writeln!(
            text,
            "| {} | {} to {}{} | {} | {} | {} | {} | {} |",
            row.title,
            compact(row.low),
            compact(row.high),
            unit(row),
            estimate(e.low_mm, 1),
            estimate(e.high_mm, 1),
            estimate(e.range_mm, 1),
            per_unit(e.per_unit_mm),
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
