//! The page of the analytical benchmarks: a table of cases and settings, and a
//! figure a case; and the same as `verify.csv`.

use std::path::Path;

use maud::html;

use super::{Case, Verdict};
use crate::measure::Interval;
use crate::plain::{counted, in_number};
use crate::report::{
    Axis, Figure, Look, Plot, ReportError,
    page::{Block, Page},
    style,
    table::{Cell, Table, dash, row, table},
    text::{compact, listed},
};

/// A case with what every engine made of it.
type Found<'a> = (&'a Case, Vec<&'a Verdict>);

/// `verify.csv`: one row a case and setting.
pub(super) fn rows<'a>(verdicts: impl IntoIterator<Item = &'a Verdict>) -> Table {
    table!(verdicts, |v| {
        "case" => &v.id,
        "setting" => &v.setting,
        "engine" => engine(v),
        "expected" => v.expected,
        "tolerance" => v.tolerance,
        "got" => v.got,
        "unit" => &v.unit,
        "status" => v.status.words(),
    })
}

/// Writes `report.html` and `figures/` of a verification into a folder.
pub(super) fn write(out: &Path, cases: &[Case], verdicts: &[Verdict]) -> Result<(), ReportError> {
    let of_each = cases.iter().map(|case| {
        let of_case: Vec<&Verdict> = verdicts.iter().filter(|v| v.id == case.id).collect();
        (case, of_case)
    });
    let found: Vec<Found> = of_each.collect();
    let figures = found.iter().map(figure).collect::<Result<Vec<_>, _>>()?;
    page(&found, figures).write(out, &["report.html"])
}

fn page(cases: &[Found], figures: Vec<Figure>) -> Page {
    let rows = || cases.iter().flat_map(|(_, verdicts)| verdicts);
    let met = rows().filter(|v| v.pass).count();
    let unexpected = cases.iter().filter(|(_, of)| of.iter().any(|v| !v.status.as_expected()));
    let unexpected: Vec<String> = unexpected.map(|(case, _)| case.id.clone()).collect();
    let missed = rows().filter(|v| !v.pass && v.status.as_expected()).count();
    let lead = format!(
        "Of {} of analytical benchmarks, {met} {} the known solution within the stated \
         tolerance. {missed} {} not, for reasons that are known and given below; {}.",
        counted(rows().count(), "run"),
        in_number(met, "meets", "meet"),
        in_number(missed, "does", "do"),
        match unexpected.len() {
            0 => "no outcome is unexpected".to_owned(),
            n => {
                let have = in_number(n, "has", "have");
                format!("{} {have} an unexpected outcome", counted(n, "case"))
            }
        }
    );
    let unexpected = listed("Unexpected:", &unexpected);
    let each = cases.iter().zip(figures).flat_map(|(found, figure)| one(found, figure));
    let head = [Block::Lead(lead), Block::Banner(unexpected)];
    Page::new("Analytical benchmarks and what engines make of them", head)
        .section("table", "All cases", [Block::Table(all(cases))])
        .section("cases", "Case by case", each)
}

/// Engine, version and precision.
fn engine(of: &Verdict) -> String {
    format!("{} {}, {}", of.backend, of.version, of.precision)
}

fn badge(of: &Verdict) -> Cell {
    let class = match (of.pass, of.status.as_expected()) {
        (true, true) => "within",
        (false, true) => "not_stated",
        (_, false) => "outside",
    };
    Cell::badge(class, of.status.words())
}

fn value(value: f64) -> String {
    if value != 0.0 && (value.abs() < 1e-3 || value.abs() >= 1e6) {
        format!("{value:.2e}").replace('-', "\u{2212}")
    } else {
        compact(value)
    }
}

fn all(cases: &[Found]) -> Table {
    let rows = cases
        .iter()
        .flat_map(|(case, verdicts)| verdicts.iter().enumerate().map(move |(i, v)| (case, i, v)));
    table!(rows, |(case, i, v)| {
        "Case" => Cell::default().on_page(&html! {
            @if i == 0 { a href={ "#" (case.id) } { (case.id) } }
        }),
        "Setting" => &v.setting,
        "Expected" => Cell::number(value(v.expected)),
        "Got" => Cell::number(v.got.map_or_else(dash, value)),
        "Tolerance" => Cell::number(value(v.tolerance)),
        "Unit" => &v.unit,
        "Verdict" => badge(v),
    })
}

fn one((case, verdicts): &Found, figure: Figure) -> [Block; 4] {
    let found = table!(verdicts, |v| {
        "Setting" => &v.setting,
        "Engine" => engine(v),
        "Got" => Cell::number(v.got.map_or_else(dash, value)),
        "Expected" => Cell::number(format!("{} ± {}", value(v.expected), value(v.tolerance))),
        "Unit" => &v.unit,
        "Verdict" => badge(v),
        "Remarks" => v.remarks(),
    });
    [
        Block::Figure(figure),
        Block::Text(format!("Known solution: {}.", case.law)),
        Block::Soft(case.source.clone()),
        Block::Table(found),
    ]
}

/// Points of a curve that are drawn and tabulated.
const MOST_POINTS: usize = 1500;

fn figure((case, verdicts): &Found) -> Result<Figure, ReportError> {
    let outcomes =
        || verdicts.iter().filter_map(|v| Some((v.setting.as_str(), v.outcome.as_ref()?)));
    // With the setting that gave it; none of the law's.
    let curves = || {
        outcomes().flat_map(|(setting, of)| {
            of.curves.iter().map(move |curve| ((!curve.law).then_some(setting), curve))
        })
    };
    // Errors over scales of length: both over many decades.
    let axis = |name: &str, value: fn(&(f64, f64)) -> f64| {
        let values = curves().flat_map(|(_, curve)| &curve.points).map(value);
        let decades = Interval::of(values).is_some_and(|r| r.low > 0.0 && r.high / r.low > 1e3);
        Axis::scaled(decades && !name.contains("(s)"), name)
    };
    let (x, y) = outcomes().next().map_or(("", ""), |(_, of)| (of.x.as_str(), of.y.as_str()));
    let mut plot = Plot::new(axis(x, |p| p.0), axis(y, |p| p.1));
    let mut settings: Vec<&str> = Vec::new();
    let mut table = Table::new(["setting", "curve", "x", "y"]);
    for (setting, curve) in curves() {
        let Some(setting) = setting else { continue };
        let known = settings.iter().position(|s| *s == setting);
        let n = known.unwrap_or_else(|| {
            settings.push(setting);
            settings.len() - 1
        });
        let label = if known.is_none() { setting } else { "" };
        plot.add(label, Look::spaced(n).thin(), thinned(&curve.points));
    }
    // The law is drawn over the engines' curves.
    if let Some((_, law)) = curves().find(|(setting, _)| setting.is_none()) {
        plot.add(&law.name, Look::of(style::INK).dash(style::DASHED), thinned(&law.points));
    }
    for (setting, curve) in curves() {
        for (x, y) in thinned(&curve.points) {
            table.row(row![setting.unwrap_or("law"), &curve.name, x, y]);
        }
    }
    let measured = format!("Measured: {}.", case.quantity);
    Figure::new(&case.id, &case.title, measured, &[plot], &table)
}

fn thinned(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let every = points.len().div_ceil(MOST_POINTS).max(1);
    let last = points.len().saturating_sub(1);
    let kept = points.iter().enumerate().filter(|(i, _)| i % every == 0 || *i == last);
    kept.map(|(_, point)| *point).collect()
}

#[cfg(test)]
mod tests {
    use super::value;

    /// Law: a page writes one minus sign, in an exponent, too.
    #[test]
    fn exponents_have_the_minus_of_other_numbers() {
        for (number, expected) in [
            (5.13e-12, "5.13e\u{2212}12"),
            (-2.0e-4, "\u{2212}2.00e\u{2212}4"),
            (-0.5, "\u{2212}0.5"),
            (0.0, "0"),
        ] {
            assert_eq!(value(number), expected, "law: of {number}");
        }
    }
}
