//! The page of interpretations, as Markdown and as HTML.

use maud::html;

use super::table::decimals;
use super::*;
use crate::report::{html::name, quality::sentence_of_left_out};

/// What a reader must know of every column, with its own numbers.
fn belief(c: &InterpretationColumn, standard: Standard) -> String {
    let met = c.meeting_standard();
    if c.runs.is_empty() {
        return "No run could be made.".to_owned();
    }
    if met == c.runs.len() {
        let said = sentence_of_left_out(c.left_out(), c.runs.len(), "");
        let runs = match met {
            1 => "The one run meets".to_owned(),
            met => format!("All {met} runs meet"),
        };
        return format!("{runs} the accuracy standard.{said}");
    }
    let worst = |value: &dyn Fn(&RunRecord) -> f64| {
        c.runs.iter().map(value).filter(|v| v.is_finite()).fold(0.0, f64::max)
    };
    let creep = if c.runs.iter().all(|r| r.summary.creep_um_per_s.is_none()) {
        "numerical creep was not measured".to_owned()
    } else {
        format!(
            "a specimen left alone sinks or rises by up to {} µm/s ({})",
            compact(worst(&|r| r.summary.creep_um_per_s.unwrap_or(0.0).abs())),
            standard.creep_um_per_s
        )
    };
    format!(
        "{met} of {} {} the accuracy standard: grains overlap by up to {} % of their \
         diameter on average ({} % allowed) and {} % at the 99th percentile ({} %), and {creep}. \
         Where it agrees with the paper, grains that sink into each other may be what agrees.",
        counted(c.runs.len(), "run"),
        in_number(met, "meets", "meet"),
        number(worst(&|r| r.summary.overlap.mean_percent), 2),
        standard.overlap_mean_percent,
        number(worst(&|r| r.summary.overlap.p99_percent), 2),
        standard.overlap_p99_percent,
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
         in {}. A cell is the mean over the runs that have it, with the smallest \
         and the largest in brackets. Runs that do not count in means (docs/accuracy.md) are left \
         out of it, and counted; where no run is valid, the mean is of those that are not, and \
         marked “not valid”: the two never stand in one mean. Under “Credibility” all numbers but \
         the void ratio are of all runs, which are judged by them. Under “The paper's statements” \
         a cell is what the statement is judged by, a count or the largest value for some. “All” \
         stands for the number of what a statement is of, where columns differ in it. ✓ and ✗: \
         the paper's statement is met, or it is not.",
        counted(configurations as usize, "configuration")
    )
}

pub(super) fn page(
    columns: &[InterpretationColumn],
    rows: &[InterpretationRow],
    figures: Vec<Figure>,
    standard: Standard,
) -> Page {
    let subject = "What the authors of Izadi & Bezuijen (2014) may have meant or typed where the text \
                   leaves it open.";
    let quick = match columns.iter().any(|c| c.quick) {
        true => {
            "This is the quick study: fewer grains than the paper's. Its heights and settlements are \
             not comparable with the paper."
        }
        false => "",
    };
    let head = [
        Block::Soft(subject.to_owned()),
        Block::Banner(quick.to_owned()),
        Block::Lead(how_read(columns)),
    ];
    let each = columns.iter().flat_map(|c| about(c, standard));
    Page::new("The paper's interpretations side by side", head)
        .section("table", "Side by side", [Block::Table(table(columns, rows))])
        .figures("curves", "Curves", figures)
        .section("interpretations", "The interpretations", each)
}

fn about(c: &InterpretationColumn, standard: Standard) -> Vec<Block> {
    let anchor = html! { span id={ "interpretation-" (c.name) } {} };
    let failures = c.failures.iter().map(|f| format!("{} failed: {}", f.run, f.reason));
    let warnings = c.warnings.iter().map(|warning| format!("Warning: {warning}"));
    vec![
        Block::Html(anchor),
        Block::Heading(format!("{}: {}", c.name, c.title)),
        Block::Text(c.meaning.clone()),
        Block::Text(belief(c, standard)),
        Block::Soft(format!("Source: {} Settings: {}", c.source, c.settings)),
        Block::List(failures.chain(warnings).collect()),
    ]
}

fn table(columns: &[InterpretationColumn], rows: &[InterpretationRow]) -> Table {
    let link = |c: &InterpretationColumn| {
        let shown = html! { a href={ "#interpretation-" (c.name) } { (name(&c.name)) } };
        Cell::from(&c.name).on_page(&shown)
    };
    let header = [Cell::default(), "Paper".into()];
    let mut table = Table::new(header.into_iter().chain(columns.iter().map(link)));
    let mut part = "";
    for of in rows {
        if of.part != part {
            part = &of.part;
            table.part(part);
        }
        let unit = if of.unit.is_empty() { String::new() } else { format!(", {}", of.unit) };
        let mut cells = row![format!("{}{unit}", of.quantity), &of.paper];
        cells.extend(of.cells.iter().map(|cell| shown(cell, decimals(of))));
        table.row(cells);
    }
    table.class("interpretations")
}

/// A cell: on a page its verdict and what to mind stand apart from its number.
fn shown(cell: &InterpretationCell, decimals: Option<usize>) -> Cell {
    let verdict = cell.verdict.filter(|_| cell.value.is_some()).map_or("", mark);
    let mind = cell.mark();
    let in_brackets = if mind.is_empty() { String::new() } else { format!("({mind}) ") };
    let text = format!("{} {in_brackets}{verdict}", cell.text(decimals));
    let class = if cell.verdict == Some(Verdict::Within) { "within" } else { "outside" };
    let alone = InterpretationCell { spread: None, ..cell.clone() };
    let end = |v: f64| InterpretationCell { value: Some(v), ..Default::default() }.text(decimals);
    Cell::number(text.trim_end()).on_page(&html! {
        (alone.text(decimals))
        @if !verdict.is_empty() { " " span.verdict.(class) { (verdict) } }
        @if let Some(s) = cell.spread {
            br; span.soft { "[" (end(s.low)) " … " (end(s.high)) "]" }
        }
        @if cell.not_valid { br; span.verdict.outside { (mind) } }
        @else if !mind.is_empty() { br; span.soft { (mind) } }
    })
}
