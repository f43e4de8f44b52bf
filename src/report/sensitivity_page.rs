//! `sensitivity.md`: the tables of a sensitivity study.

use super::{
    Effect, Figure, ParameterRow, Sensitivity,
    calibration::with_unit,
    convergence_page::{estimate, specimen},
    page::{Block, Page},
    sensitivity::ranked,
    table::{Cell, Table, dash, missing, plus_minus, table},
};
use crate::{
    measure::Estimate,
    paper::text::{compact, number},
    record::VariationRow,
};

/// The page.
pub(super) fn page(of: &Sensitivity, figure: Figure) -> Page {
    let intro = format!(
        "{}, {} configuration{}. Each parameter is varied by itself, all others at their defaults. \
         Differences in mm ± standard error, paired by configuration: runs of a pair have the same \
         grains in the same order. A packing is chaotic, so that pairs scatter; \"~\" marks an effect \
         that lies inside that scatter: the 95 % confidence interval (Student's t) of its largest \
         difference holds zero. Grains outside are those that do not lie in the cylinder at the end: a \
         jam in the funnel lowers the specimen by what is stuck there. Runs that are not valid, or short \
         of grains, are left out of every difference with their pair (docs/accuracy.md), and counted.",
        specimen(&of.scenario, of.grains, of.quick),
        of.configurations,
        if of.configurations == 1 { "" } else { "s" },
    );
    let default = of.default.as_ref().map(without_a_change).unwrap_or_default();
    let effects = |effect| [Block::Table(effects(of, effect))];
    let ranges = table!(&of.parameters, |p| {
        "parameter" => &p.title,
        "from" => with_unit(&compact(p.low), &p.unit),
        "default" => with_unit(&compact(p.default), &p.unit),
        "to" => with_unit(&compact(p.high), &p.unit),
        "why" => &p.reason,
    });
    Page::new("Sensitivity", [Block::Text(intro), Block::Text(default)])
        .figures("figure", "Figure", [figure])
        .section("height", "Height after pouring", effects(|r| r.height))
        .section("plate", "Settlement of the plate", effects(|r| r.plate))
        .section("surface", "Settlement of the mean surface", effects(|r| r.surface))
        .section("ranges", "Ranges", [Block::Table(ranges)])
}

/// Results of the scenario as it is.
fn without_a_change(default: &VariationRow) -> String {
    let spread = |e: Option<Estimate>| {
        let Some(e) = e else { return missing(default.has_no_valid_run()) };
        let deviation = e.standard_error.map(|error| error * (e.count as f64).sqrt());
        let deviation = deviation.map(|s| format!(" (standard deviation {})", number(s, 1)));
        format!("{}{}", number(e.mean, 1), deviation.unwrap_or_default())
    };
    let left_out = match default.left_out {
        0 => String::new(),
        n => format!("; left out of these means: {n} of {} runs", default.runs),
    };
    format!(
        "Without a change, over configurations, in mm: height {}, settlement of the plate {}, of the \
         surface {}{left_out}.",
        spread(default.poured_height_mm),
        spread(default.plate_settlement_mm),
        spread(default.surface_settlement_mm),
    )
}

fn effects(of: &Sensitivity, effect: fn(&ParameterRow) -> Effect) -> Table {
    let default_left_out = of.default.as_ref().is_some_and(|d| d.left_out > 0);
    let rows = ranked(&of.parameters, effect).into_iter().map(|row| (row, effect(row)));
    let change = |row: &ParameterRow, e: Option<Estimate>, shown: fn(Estimate) -> String| match e {
        Some(e) => shown(e),
        None if row.left_out > 0 && row.valid == 0 => missing(true),
        None if row.left_out > 0 || default_left_out => "no valid pair".to_owned(),
        None => dash(),
    };
    let mm = |e: Estimate| estimate(e, 1);
    let per_unit = |e: Estimate| plus_minus(e.mean, e.standard_error, compact);
    table!(rows, |(row, e)| {
        "parameter" => &row.title,
        "range" => with_unit(&range(row), &row.unit),
        "at the low end" => Cell::number(change(row, e.low_mm, mm)),
        "at the high end" => Cell::number(change(row, e.high_mm, mm)),
        "over the range" => Cell::number(change(row, e.range_mm, mm)),
        "for one unit" => Cell::number(change(row, e.per_unit_mm, per_unit)),
        "remarks" => remarks(row, &e),
    })
}

fn range(row: &ParameterRow) -> String {
    format!("{} to {}", compact(row.low), compact(row.high))
}

fn remarks(row: &ParameterRow, effect: &Effect) -> String {
    let scatter = match effect.inside_scatter {
        Some(true) => Some("~".to_owned()),
        Some(false) => None,
        None => Some("scatter unknown".to_owned()),
    };
    let failed = (row.failed > 0).then(|| format!("{} failed", row.failed));
    let left_out = (row.left_out > 0).then(|| format!("{} left out", row.left_out));
    let outside = row.grains_outside.filter(|g| *g >= 0.5);
    let outside = outside.map(|g| format!("grains outside: {}", number(g, 1)));
    [failed, left_out, scatter, outside].into_iter().flatten().collect::<Vec<_>>().join(", ")
}
