//! The table of interpretations as Markdown and as a page.

use std::fmt::Write as _;

use maud::{DOCTYPE, Markup, html};

use super::{InterpretationCell, InterpretationColumn, InterpretationRow, table::decimals};
use crate::{
    paper::{Verdict, text::number},
    record::left_out_in_words,
    report::{
        Figure, Standard,
        html::{figure_block, glue, head, name},
    },
};

/// What a reader must know of every column, with its own numbers.
fn belief(c: &InterpretationColumn, standard: Standard) -> String {
    let met = c.runs.iter().filter(|r| r.summary.meets_standard).count();
    if c.runs.is_empty() {
        return "No run could be made.".to_owned();
    }
    if met == c.runs.len() {
        let left_out = c.runs.iter().filter(|r| !r.counts_in_means()).count();
        let said = match left_out_in_words(left_out, c.runs.len()) {
            said if said.is_empty() => said,
            said => format!(" {said}."),
        };
        return format!("All {met} runs meet the accuracy standard.{said}");
    }
    let worst = |value: &dyn Fn(&super::InterpretationRun) -> f64| {
        c.runs.iter().map(value).filter(|v| v.is_finite()).fold(0.0, f64::max)
    };
    format!(
        "{met} of {} runs meet the accuracy standard: grains overlap by up to {} % of their \
         diameter on average ({} % allowed) and {} % at the 99th percentile ({} %), and a specimen \
         left alone sinks by up to {} µm/s ({}). Where it agrees with the paper, grains that sink \
         into each other may be what agrees.",
        c.runs.len(),
        number(worst(&|r| r.summary.overlap.mean_percent), 2),
        standard.overlap_mean_percent,
        number(worst(&|r| r.summary.overlap.p99_percent), 1),
        standard.overlap_p99_percent,
        number(worst(&|r| r.summary.creep_um_per_s.unwrap_or(0.0).abs()), 0),
        standard.creep_um_per_s,
    )
}

fn mark(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Within => "✓",
        Verdict::Outside => "✗",
        Verdict::NotStated | Verdict::NotRun | Verdict::NotComparable => "",
    }
}

fn how_read(columns: &[InterpretationColumn]) -> String {
    let configurations = columns.iter().map(|c| c.configurations).max().unwrap_or(0);
    format!(
        "Every column is the same programme with the same grains under another interpretation of the paper, \
         in {configurations} {}. A cell is the mean over the runs that have it, with the smallest \
         and the largest in brackets. Runs that are not valid, or short of grains, are left out of it, and counted; where \
         no run is valid, the mean is of those that are not, and marked “not valid”: the two never stand in one mean. ✓ and ✗: the paper's statement is met, or it is not.",
        if configurations == 1 { "configuration" } else { "configurations" }
    )
}

/// `interpretations.md`.
pub(super) fn markdown(
    columns: &[InterpretationColumn],
    rows: &[InterpretationRow],
    standard: Standard,
) -> String {
    let safe = |text: &str| text.replace('|', "\\|").replace('\n', " ");
    let mut out =
        format!("# The paper's interpretations side by side\n\n{}\n\n", how_read(columns));
    for c in columns {
        let _ = writeln!(
            out,
            "- **{}** — {}. {} {} Source: {}",
            c.name,
            c.title,
            c.meaning,
            belief(c, standard),
            c.source
        );
        for f in &c.failures {
            let _ = writeln!(out, "  - {} failed: {}", f.run, f.reason);
        }
    }
    let names: Vec<&str> = columns.iter().map(|c| c.name.as_str()).collect();
    let _ = writeln!(out, "\n| | paper | {} |", names.join(" | "));
    let _ = writeln!(out, "| --- | --- |{}", " ---: |".repeat(names.len()));
    let mut part = "";
    for row in rows {
        if row.part != part {
            part = &row.part;
            let _ = writeln!(out, "| **{}** | |{}", safe(part), " |".repeat(names.len()));
        }
        let unit = if row.unit.is_empty() { String::new() } else { format!(", {}", row.unit) };
        let cells: Vec<String> = row
            .cells
            .iter()
            .map(|cell| {
                let verdict = cell.verdict.filter(|_| cell.value.is_some()).map_or("", mark);
                let mind = cell.mark();
                let mind = if mind.is_empty() { mind } else { format!("({mind}) ") };
                safe(format!("{} {mind}{verdict}", cell.text(decimals(&row.unit))).trim_end())
            })
            .collect();
        let _ = writeln!(
            out,
            "| {}{unit} | {} | {} |",
            safe(&row.quantity),
            safe(&row.paper),
            cells.join(" | ")
        );
    }
    out
}

/// `interpretations.html`.
pub(super) fn html(
    columns: &[InterpretationColumn],
    rows: &[InterpretationRow],
    figures: &[Figure],
    standard: Standard,
) -> String {
    let title = "The paper's interpretations side by side";
    html! {
        (DOCTYPE)
        html lang="en" {
            (head(title))
            body {
                header {
                    h1 { (title) }
                    p.soft {
                        "What the authors of Izadi & Bezuijen (2014) may have meant or typed where the "
                        "text leaves it open."
                    }
                    @if columns.iter().any(|c| c.quick) {
                        p.banner {
                            "This is the quick study: fewer grains than the paper's. Its heights and "
                            "settlements are not comparable with the paper."
                        }
                    }
                    p.lead { (glue(&how_read(columns))) }
                }
                main {
                    section id="table" { h2 { "Side by side" } (table(columns, rows)) }
                    section id="curves" {
                        h2 { "Curves" }
                        @for figure in figures { (figure_block(figure)) }
                    }
                    section id="interpretations" {
                        h2 { "The interpretations" }
                        @for c in columns { (about(c, standard)) }
                    }
                }
            }
        }
    }
    .into_string()
}

fn about(c: &InterpretationColumn, standard: Standard) -> Markup {
    html! {
        h3 id={ "interpretation-" (c.name) } { (name(&c.name)) ": " (name(&c.title)) }
        p { (glue(&c.meaning)) }
        p { (glue(&belief(c, standard))) }
        p.soft { "Source: " (glue(&c.source)) " Settings: " code { (name(&c.settings)) } }
        @if !c.failures.is_empty() {
            ul { @for f in &c.failures { li { strong { (name(&f.run)) } " failed: " bdi { (glue(&f.reason)) } } } }
        }
        @if !c.warnings.is_empty() {
            details {
                summary { "Warnings (" (c.warnings.len()) ")" }
                ul { @for w in &c.warnings { li { bdi { (glue(w)) } } } }
            }
        }
    }
}

fn table(columns: &[InterpretationColumn], rows: &[InterpretationRow]) -> Markup {
    let mut parts: Vec<(&str, Vec<&InterpretationRow>)> = Vec::new();
    for row in rows {
        match parts.last_mut() {
            Some((part, of)) if *part == row.part => of.push(row),
            _ => parts.push((&row.part, vec![row])),
        }
    }
    html! {
        div.scroll { table.interpretations {
            thead { tr {
                th { "" } th { "Paper" }
                @for c in columns { th.n { a href={ "#interpretation-" (c.name) } { (name(&c.name)) } } }
            } }
            @for (part, rows) in parts { tbody {
                tr { th.part colspan=(columns.len() + 2) scope="rowgroup" { (part) } }
                @for row in rows { tr {
                    th scope="row" {
                        (row.quantity)
                        @if !row.unit.is_empty() { ", " (row.unit) }
                    }
                    td { (row.paper) }
                    @for cell in &row.cells { (cell_of(row, cell)) }
                } }
            } }
        } }
    }
}

fn cell_of(row: &InterpretationRow, cell: &InterpretationCell) -> Markup {
    let decimals = decimals(&row.unit);
    let alone = InterpretationCell { spread: None, ..cell.clone() };
    html! {
        td.n {
            (alone.text(decimals))
            @if let Some(verdict) =
                cell.verdict.filter(|v| matches!(v, Verdict::Within | Verdict::Outside)) {
                @let class = if verdict == Verdict::Within { "within" } else { "outside" };
                @if cell.value.is_some() { " " span.verdict.(class) { (mark(verdict)) } }
            }
            @if let Some(s) = cell.spread {
                @let shown = |v: f64| InterpretationCell { value: Some(v), ..InterpretationCell::default() }.text(decimals);
                br; span.soft { "[" (shown(s.low)) " … " (shown(s.high)) "]" }
            }
            @let mind = cell.mark();
            @if cell.not_valid { br; span.verdict.outside { (mind) } }
            @else if !mind.is_empty() { br; span.soft { (mind) } }
        }
    }
}
