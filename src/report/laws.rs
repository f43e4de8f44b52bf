//! The page of the analytical benchmarks: a table of cases and settings, and a
//! figure a case.

use std::path::Path;

use maud::html;

use super::{
    Figure, ReportError,
    axis::Axis,
    page::{Block, Page},
    plot::{Look, Plot},
    style,
    table::{Cell, Table, dash, row, table},
    text::{compact, listed},
};
use crate::measure::Interval;

/// A benchmark with what each engine made of it.
#[derive(Debug, Clone, PartialEq)]
pub struct LawCase {
    /// Name, also of the figure's files.
    pub id: String,
    /// What is done.
    pub title: String,
    /// The law.
    pub law: String,
    /// Where law, expected value and tolerance come from.
    pub source: String,
    /// What is measured.
    pub quantity: String,
    /// Name and unit of the figure's horizontal axis.
    pub x: String,
    /// Name and unit of the figure's vertical axis.
    pub y: String,
    /// One row a setting.
    pub rows: Vec<LawRow>,
    /// Curves of all settings and of the law.
    pub curves: Vec<LawCurve>,
}

/// What one engine made of a law.
#[derive(Debug, Clone, PartialEq)]
pub struct LawRow {
    /// Name of the setting.
    pub setting: String,
    /// Engine, version and precision.
    pub engine: String,
    /// What the law says.
    pub expected: f64,
    /// What was measured, if anything.
    pub got: Option<f64>,
    /// Largest difference that passes.
    pub tolerance: f64,
    /// Unit of the three.
    pub unit: String,
    /// Verdict in words.
    pub verdict: String,
    /// Whether the law is met.
    pub met: bool,
    /// Whether that was expected.
    pub as_expected: bool,
    /// Reasons and remarks.
    pub remarks: Vec<String>,
}

/// A curve of a case's figure.
#[derive(Debug, Clone, PartialEq)]
pub struct LawCurve {
    /// The setting that gave it; `None` for the law's.
    pub setting: Option<String>,
    /// Its name.
    pub name: String,
    /// Points.
    pub points: Vec<(f64, f64)>,
}

/// Writes `report.html` and `figures/` of a verification into a folder.
///
/// # Errors
/// [`ReportError`] naming the file or the figure.
pub fn write_laws(out: &Path, cases: &[LawCase]) -> Result<(), ReportError> {
    let figures = cases.iter().map(figure).collect::<Result<Vec<_>, _>>()?;
    page(cases, figures).write(out, &["report.html"])
}

fn page(cases: &[LawCase], figures: Vec<Figure>) -> Page {
    let rows = || cases.iter().flat_map(|c| &c.rows);
    let met = rows().filter(|r| r.met).count();
    let unexpected = cases.iter().filter(|c| c.rows.iter().any(|r| !r.as_expected));
    let unexpected: Vec<String> = unexpected.map(|c| c.id.clone()).collect();
    let lead = format!(
        "Of {} runs of analytical benchmarks, {met} meet the known solution within the stated \
         tolerance. {} do not, for reasons that are known and given below; {}.",
        rows().count(),
        rows().filter(|r| !r.met && r.as_expected).count(),
        match unexpected.len() {
            0 => "no outcome is unexpected".to_owned(),
            n => format!("{n} cases have an unexpected outcome"),
        }
    );
    let unexpected = listed("Unexpected:", &unexpected);
    let each = cases.iter().zip(figures).flat_map(|(case, figure)| one(case, figure));
    let head = [Block::Lead(lead), Block::Banner(unexpected)];
    Page::new("Analytical benchmarks and what engines make of them", head)
        .section("table", "All cases", [Block::Table(table(cases))])
        .section("cases", "Case by case", each)
}

fn badge(row: &LawRow) -> Cell {
    let class = match (row.met, row.as_expected) {
        (true, true) => "within",
        (false, true) => "not_stated",
        (_, false) => "outside",
    };
    Cell::badge(class, &row.verdict)
}

fn value(value: f64) -> String {
    if value != 0.0 && (value.abs() < 1e-3 || value.abs() >= 1e6) {
        format!("{value:.2e}")
    } else {
        compact(value)
    }
}

fn table(cases: &[LawCase]) -> Table {
    let rows = cases.iter().flat_map(|c| c.rows.iter().enumerate().map(move |(i, r)| (c, i, r)));
    table!(rows, |(case, i, row)| {
        "Case" => Cell::default().on_page(&html! {
            @if i == 0 { a href={ "#" (case.id) } { (case.id) } }
        }),
        "Setting" => &row.setting,
        "Expected" => Cell::number(value(row.expected)),
        "Got" => Cell::number(row.got.map_or_else(dash, value)),
        "Tolerance" => Cell::number(value(row.tolerance)),
        "Unit" => &row.unit,
        "Verdict" => badge(row),
    })
}

/// A case with what every engine made of it.
fn one(case: &LawCase, figure: Figure) -> [Block; 4] {
    let found = table!(&case.rows, |row| {
        "Setting" => &row.setting,
        "Engine" => &row.engine,
        "Got" => Cell::number(row.got.map_or_else(dash, value)),
        "Expected" => Cell::number(format!("{} ± {}", value(row.expected), value(row.tolerance))),
        "Unit" => &row.unit,
        "Verdict" => badge(row),
        "Remarks" => row.remarks.join(". "),
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

fn figure(case: &LawCase) -> Result<Figure, ReportError> {
    // Errors over scales of length: both over many decades.
    let axis = |name: &str, value: fn(&(f64, f64)) -> f64| {
        let values = case.curves.iter().flat_map(|c| &c.points).map(value);
        let decades = Interval::of(values).is_some_and(|r| r.low > 0.0 && r.high / r.low > 1e3);
        Axis::scaled(decades && !name.contains("(s)"), name)
    };
    let mut plot = Plot::new(axis(&case.x, |p| p.0), axis(&case.y, |p| p.1));
    let mut settings: Vec<&str> = Vec::new();
    let mut table = Table::new(["setting", "curve", "x", "y"]);
    for curve in &case.curves {
        let Some(setting) = curve.setting.as_deref() else { continue };
        let known = settings.iter().position(|s| *s == setting);
        let n = known.unwrap_or_else(|| {
            settings.push(setting);
            settings.len() - 1
        });
        let label = if known.is_none() { setting } else { "" };
        plot.add(label, Look::spaced(n).thin(), thinned(&curve.points));
    }
    // The law is drawn over the engines' curves.
    if let Some(law) = case.curves.iter().find(|c| c.setting.is_none()) {
        plot.add(&law.name, Look::of(style::INK).dash(style::DASHED), thinned(&law.points));
    }
    for curve in &case.curves {
        let setting = curve.setting.as_deref().unwrap_or("law");
        for (x, y) in thinned(&curve.points) {
            table.row(row![setting, &curve.name, x, y]);
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
