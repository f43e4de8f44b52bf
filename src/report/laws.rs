//! The page of the verification suite: a table of cases and settings, and a
//! figure a case.

use std::path::Path;

use maud::{DOCTYPE, Markup, PreEscaped, html};

use super::{Figure, ReportError, figures, html::glue, html::head};
use crate::{paper::text::compact, record::write_file};

/// A law with what each engine made of it.
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
    let mut drawn = Vec::new();
    for case in cases {
        let figure = figures::of_law(case)?;
        figure.write(&out.join("figures"))?;
        drawn.push(figure);
    }
    write_file(&out.join("report.html"), page(cases, &drawn).as_bytes())?;
    Ok(())
}

fn page(cases: &[LawCase], figures: &[Figure]) -> String {
    let rows = || cases.iter().flat_map(|c| &c.rows);
    let met = rows().filter(|r| r.met).count();
    let unexpected: Vec<&LawCase> =
        cases.iter().filter(|c| c.rows.iter().any(|r| !r.as_expected)).collect();
    html! {
        (DOCTYPE)
        html lang="en" {
            (head("Exact laws and what engines make of them"))
            body {
                header {
                    h1 { "Exact laws and what engines make of them" }
                    p.lead {
                        "Of " (rows().count()) " experiments, " (met) " obey their law within the stated "
                        "tolerance. " (rows().filter(|r| !r.met && r.as_expected).count()) " do not, for "
                        "reasons that are known and given below"
                        @if unexpected.is_empty() { "; none is a surprise." }
                        @else { "; " (unexpected.len()) " cases came out otherwise than expected." }
                    }
                    @if !unexpected.is_empty() {
                        p.banner {
                            "Unexpected: "
                            @for (i, case) in unexpected.iter().enumerate() {
                                @if i > 0 { ", " }
                                a href={ "#" (case.id) } { (case.id) }
                            }
                        }
                    }
                }
                main {
                    section id="table" { h2 { "All cases" } (table(cases)) }
                    section id="cases" {
                        h2 { "Case by case" }
                        @for (case, figure) in cases.iter().zip(figures) { (one(case, figure)) }
                    }
                }
            }
        }
    }
    .into_string()
}

fn badge(row: &LawRow) -> Markup {
    let class = match (row.met, row.as_expected) {
        (true, true) => "within",
        (false, true) => "not_stated",
        (_, false) => "outside",
    };
    html! { span.verdict.(class) { (row.verdict) } }
}

fn value(value: f64) -> String {
    if value != 0.0 && (value.abs() < 1e-3 || value.abs() >= 1e6) {
        format!("{value:.2e}")
    } else {
        compact(value)
    }
}

fn table(cases: &[LawCase]) -> Markup {
    html! {
        div.scroll { table {
            thead { tr {
                th { "Case" } th { "Setting" } th.n { "Expected" } th.n { "Got" }
                th.n { "Tolerance" } th { "Unit" } th { "Verdict" }
            } }
            tbody {
                @for case in cases { @for (i, row) in case.rows.iter().enumerate() {
                    tr {
                        th { @if i == 0 { a href={ "#" (case.id) } { (case.id) } } }
                        td { (row.setting) }
                        td.n { (value(row.expected)) }
                        td.n { @match row.got { Some(got) => (value(got)), None => "–" } }
                        td.n { (value(row.tolerance)) }
                        td { (row.unit) }
                        td { (badge(row)) }
                    }
                } }
            }
        } }
    }
}

fn one(case: &LawCase, figure: &Figure) -> Markup {
    let file = |extension: &str| format!("figures/{}.{extension}", figure.stem);
    html! {
        figure id=(case.id) {
            h3 { (case.title) }
            p { "Law: " (glue(&case.law)) ". Measured: " (glue(&case.quantity)) "." }
            p.soft { (glue(&case.source)) }
            div.sheet role="img" aria-label=(case.title) { (PreEscaped(figure.svg.as_str())) }
            figcaption {
                @for row in &case.rows {
                    p {
                        (badge(row)) " " strong { (row.setting) } " (" (row.engine) "): got "
                        @match row.got { Some(got) => (value(got)), None => "nothing" }
                        " " (row.unit) ", expected " (value(row.expected)) " ± " (value(row.tolerance))
                        @for remark in &row.remarks { ". " (glue(remark)) }
                    }
                }
                span.soft.files {
                    a href=(file("svg")) { "SVG" } " · "
                    a href=(file("png")) { "PNG" } " · "
                    a href=(file("csv")) { "numbers (CSV)" }
                }
            }
        }
    }
}
