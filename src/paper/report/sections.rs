//! The tables of the report.

use maud::{Markup, html};

use super::*;
use crate::report::html::{glue, name};

fn verdict(verdict: Verdict) -> (&'static str, &'static str) {
    match verdict {
        Verdict::Within => ("within", "✓ within"),
        Verdict::Outside => ("outside", "✗ outside"),
        Verdict::NotStated => ("not_stated", "– not stated"),
        Verdict::NotRun => ("not_stated", "– not run"),
        Verdict::NotComparable => ("not_stated", "– not comparable"),
    }
}

/// A verdict, with what makes it where it is not obvious.
fn verdict_badge(of: Verdict, reason: &str) -> Markup {
    let (class, name) = verdict(of);
    html! {
        span.verdict.(class) { (name) }
        @if !reason.is_empty() && !name.ends_with(reason) {
            " " span.soft.reason { (glue(reason)) }
        }
    }
}

/// The verdict of a row; "not decided" where intervals leave it open.
fn row_badge(row: &ScoreRow) -> Markup {
    match row.stands() {
        Some(verdict) => verdict_badge(verdict, &row.reason),
        None => html! { span.verdict.not_stated { "? not decided" } },
    }
}

/// How many runs a number is without.
fn left_out(count: usize) -> Markup {
    html! { @if count > 0 { " " span.unit { "(left out: " (count) ")" } } }
}

fn number_on_page(shown: &Markup) -> Cell {
    Cell::number("").on_page(shown)
}

/// The results that decide.
pub(super) fn scorecard(card: &Scorecard) -> Vec<Block> {
    let table = table!(&card.rows, |row| {
        "Statement" => Cell::default().on_page(&html! {
            @match row.claims.first() {
                Some(claim) => { a href={ "#claim-" (claim) } { (row.statement) } }
                None => { (row.statement) }
            }
            " " span.soft { (row.source) }
        }),
        "Paper" => number_on_page(&html! { (glue(&row.paper)) }),
        "Ours" => number_on_page(&html! {
            (glue(&row.in_words)) (left_out(row.left_out))
            @if !row.note.is_empty() { " " span.soft.reason { (glue(&row.note)) } }
        }),
        "Verdict" => Cell::default().on_page(&row_badge(row)),
    });
    let reading = html! {
        p.soft {
            "Means over the configurations, each a new random arrangement of the same grains, with "
            "the 95 % confidence interval of the mean in brackets. “Within”: the mean lies within "
            "the range taken for the paper's number; of a count: all show it; of the angle: the "
            "interval contains the paper's. “Not decided”: the interval reaches across an end of "
            "the paper's range, that of what is counted does not confirm the count, or one run has "
            "none. Every statement by itself: "
            a href="#claims" { "table" } "."
        }
    };
    vec![Block::Table(table.class("claims cards scorecard")), Block::Html(reading)]
}

/// Every statement of the paper, what was found, and what other engines and settings found.
pub(super) fn claims(claims: &[Claim], beside: &[Column]) -> Vec<Block> {
    let count = |v| claims.iter().filter(|c| c.kind == ClaimKind::Result && c.verdict == v).count();
    let tally = html! {
        ul.tally {
            @for v in [Verdict::Within, Verdict::Outside, Verdict::NotRun, Verdict::NotComparable] {
                @let (class, name) = verdict(v);
                li { span.verdict.(class) { (name) ": " (count(v)) } }
            }
        }
    };
    let mut reading =
        "Results are counted, a statement on each configuration once for each; the scorecard counts \
         it once. “Within”: our number lies within the range taken for the \
         paper's. “Outside”: it does not. “Not run”: it was not measured. “Not comparable”: it \
         was, but on a smaller specimen, or in runs that do not count; what such runs show stands \
         in brackets. “Not stated”: the text gives no number; ours is for information. Ours is of \
         the runs that count (docs/accuracy.md)."
            .to_owned();
    if !beside.is_empty() {
        reading += " The last columns are the same programme by other engines or settings.";
    }
    let header = ["Statement", "Paper", "Ours", "Verdict"].into_iter();
    let mut table = Table::new(header.chain(beside.iter().map(|c| c.label.as_str())));
    for (kind, title) in [
        (ClaimKind::Result, "Results"),
        (ClaimKind::NoNumber, "Statements without a number in the paper's text"),
        (ClaimKind::Input, "Inputs, and what follows from them"),
    ] {
        let mut of_kind = claims.iter().filter(|c| c.kind == kind).peekable();
        if of_kind.peek().is_some() {
            table.part(title);
        }
        of_kind.for_each(|claim| table.row(claim_row(claim, beside)));
    }
    vec![Block::Html(tally), Block::Soft(reading), Block::Table(table.class("claims cards"))]
}

fn claim_row(claim: &Claim, beside: &[Column]) -> Vec<Cell> {
    // The interval is worth a line where it is not what the paper prints.
    let read_as = claim.read_as.filter(|i| {
        i.high - i.low > 1e-3 * i.high.abs().max(1.0)
            && !matches!(claim.paper, Some(PaperValue::Range(_)))
    });
    let statement = html! {
        span id={ "claim-" (claim.id) } { (claim.statement) } " " span.soft { (claim.source) }
        @if !claim.note.is_empty() || !claim.runs.is_empty() {
            details {
                summary { "How read" }
                span.soft {
                    (glue(&claim.note))
                    @if !claim.runs.is_empty() { " Runs: " (name(&claim.runs.join(", "))) "." }
                }
            }
        }
    };
    let paper = html! {
        (paper_value(claim).unwrap_or_else(dash))
        @if let Some(value) = claim.paper { (unit_after(paper_unit(value, &claim.unit))) }
        @if let Some(i) = read_as { " " span.unit { "(read as " (from_to(i.low, i.high)) ")" } }
    };
    let ours = html! {
        (value_or_not_valid(claim.ours, claim.spread, claim.not_valid, &claim.unit))
        (left_out(claim.left_out.len()))
    };
    let mut cells = row![
        Cell::default().on_page(&statement),
        number_on_page(&paper),
        number_on_page(&ours),
        Cell::default().on_page(&verdict_badge(claim.verdict, &claim.reason)),
    ];
    cells.extend(beside.iter().map(|column| {
        let same = column.claims.iter().find(|other| other.id == claim.id);
        let Some(found) = same else { return Cell::number(dash()) };
        let (class, name) = verdict(found.verdict);
        let is_judged = matches!(found.verdict, Verdict::Within | Verdict::Outside);
        number_on_page(&html! {
            (value_or_not_valid(found.ours, found.spread, found.not_valid, &claim.unit)) " "
            @if found.ours.is_some() && is_judged {
                span.verdict.(class) title=(name) { (name.chars().take(1).collect::<String>()) }
            }
        })
    }));
    cells
}

/// What the paper gives, in words.
pub(super) fn paper_value(claim: &Claim) -> Option<String> {
    Some(match claim.paper? {
        PaperValue::Value { value } => compact(value),
        PaperValue::Range(i) => from_to(i.low, i.high),
    })
}

/// A value, or in brackets what runs show that are not valid.
fn value_or_not_valid(
    ours: Option<f64>,
    spread: Option<Interval>,
    not_valid: Option<NotValid>,
    unit: &str,
) -> Markup {
    match (ours, not_valid) {
        (None, Some(of)) => html! {
            (NO_VALID_RUN) " "
            span.soft { "(not valid: " (value(Some(of.value), unit, of.spread)) ")" }
        },
        _ => value(ours, unit, spread),
    }
}

/// A unit as it follows a number; nothing of what has none.
fn unit_after(unit: &str) -> Markup {
    html! {
        @if unit != "–" {
            @if unit != "°" { " " }
            span.unit { (unit) }
        }
    }
}

/// The unit of the paper's number: the simulation's, without what it is a share of.
fn paper_unit(of: PaperValue, unit: &str) -> &str {
    let unit = unit.split_once(" of ").map_or(unit, |(unit, _)| unit);
    match of {
        PaperValue::Value { value } => unit_of(value, unit),
        PaperValue::Range(_) => unit,
    }
}

/// A value with its unit and, where several make it, its spread.
fn value(value: Option<f64>, unit: &str, spread: Option<Interval>) -> Markup {
    let Some(value) = value else { return html! { "–" } };
    html! {
        (compact(value)) (unit_after(unit_of(value, unit)))
        @if let Some(s) = spread.filter(|s| s.high > s.low) {
            " " span.unit { "[" (compact(s.low)) " … " (compact(s.high)) "]" }
        }
    }
}

/// One line a run, and one a pile.
pub(super) fn runs(study: &StudyView) -> Vec<Block> {
    if study.runs.is_empty() {
        return vec![Block::Text("No run is finished.".to_owned())];
    }
    let reading = "Valid: the accuracy standard is met, no run-time check found anything, and grains \
                   had settled where heights and settlement are read. Heights in mm above the \
                   floor: mean of the surface, its 95th percentile, highest \
                   point of any grain. e: void ratio to the mean surface. Settlement in mm at the end, \
                   of the plate and of the mean surface, and the plate's share after 5 s. Overlap in % \
                   of the equivalent diameter. Numerical creep in µm/s, and the drop of the mean grain height \
                   in the rest test in µm over its length. Z: mean number of grains touching a grain. \
                   Grains through a wall / over the rim / left in the funnel are listed as lost.";
    let of_cylinder = study.runs.iter().filter(|r| r.kind != RunKind::Repose);
    let table = table!(of_cylinder.map(|r| (r, &r.summary)), |(run, s)| {
        "Run" => &run.name,
        "Valid" => valid_badge(run),
        "FH, cm" => Cell::fixed(run.falling_height_mm / 10.0, 0),
        "Mean" => Cell::fixed(s.standing_height_mm.mean_surface, 1),
        "p95" => Cell::fixed(s.standing_height_mm.p95, 1),
        "Highest" => Cell::fixed(s.standing_height_mm.highest, 1),
        "e" => Cell::fixed(s.void_ratio, 3),
        "Plate" => Cell::fixed(s.settlement_mm.as_ref().map(|s| s.final_mm), 2),
        "Surface" => Cell::fixed(s.surface_settlement_mm.as_ref().map(|s| s.final_mm), 2),
        "In 5\u{a0}s" => Cell::number(share_after_5_s(run)),
        "Overlap mean / p99 / max" => Cell::number(overlaps(run)),
        "Numerical creep" => Cell::fixed(s.creep_um_per_s, 1),
        "Rest test" => Cell::number(rest_test(run)),
        "Z" => Cell::fixed(s.coordination_number, 2),
        "Lost" => Cell::number(lost(run)),
        "Wall time" => Cell::number(wall_time(s.wall_s)),
    });
    let mut blocks =
        vec![counting(study), Block::Soft(reading.to_owned()), Block::Table(table.class("runs"))];
    blocks.extend(piles(study));
    blocks
}

fn share_after_5_s(run: &RunRecord) -> String {
    let share = run.summary.settlement_mm.as_ref().and_then(|s| s.share_after_5_s);
    share.map_or_else(dash, |share| format!("{} %", number(100.0 * share, 0)))
}

fn overlaps(run: &RunRecord) -> String {
    let o = run.summary.overlap;
    [o.mean_percent, o.p99_percent, o.max_percent].map(|v| number(v, 2)).join(" / ")
}

fn rest_test(run: &RunRecord) -> String {
    run.summary.rest_test.map_or_else(dash, |test| {
        let um = test.mean_grain_height_drop_mm.map_or_else(dash, |mm| number(1e3 * mm, 1));
        format!("{um} in {} s", number(test.duration_s, 1))
    })
}

fn lost(run: &RunRecord) -> String {
    let g = &run.summary.grains;
    format!("{} / {} / {}", g.escaped, g.spilled, g.left_in_funnel)
}

/// One line a pile; nothing without any.
fn piles(study: &StudyView) -> Vec<Block> {
    let reading = "Angle of repose with the 95 % confidence interval of that pile's mean slope, standard \
                   deviation over sectors of 10°, and the slope of the cone of the same volume and \
                   height. Height and radius in mm. Grains fallen off the base.";
    let degrees = |v: Option<f64>| Cell::number(v.map_or_else(dash, |v| number(v, 1) + "°"));
    let of_piles = study.of_kind(RunKind::Repose);
    let of_piles = of_piles.map(|r| (r, &r.summary, r.summary.angle_of_repose.as_ref()));
    let table = table!(of_piles, |(run, s, pile)| {
        "Run" => &run.name,
        "Valid" => valid_badge(run),
        "Angle" => degrees(pile.map(|p| p.degrees)),
        "95 %" => Cell::number(pile.map_or_else(dash, |p| {
            let ends = [p.confidence_low_degrees, p.confidence_high_degrees];
            ends.map(|v| number(v, 1)).join(" to ") + "°"
        })),
        "Sectors" => degrees(pile.map(|p| p.standard_deviation_degrees)),
        "By volume" => degrees(pile.map(|p| p.by_volume_degrees)),
        "Height" => Cell::fixed(pile.map(|p| p.pile_height_mm), 1),
        "Radius" => Cell::fixed(pile.map(|p| p.base_radius_mm), 1),
        "Fallen off" => s.grains.spilled,
        "Overlap mean / p99 / max" => Cell::number(overlaps(run)),
        "Numerical creep" => Cell::fixed(s.creep_um_per_s, 1),
        "Wall time" => Cell::number(wall_time(s.wall_s)),
    });
    if table.is_empty() {
        return Vec::new();
    }
    vec![
        Block::Heading("Piles".to_owned()),
        Block::Soft(reading.to_owned()),
        Block::Table(table.class("runs")),
    ]
}

/// Whether a run is valid and counts in means, with what is against it.
fn valid_badge(run: &RunRecord) -> Cell {
    let against = run.summary.why_left_out();
    let (class, name) = match (run.summary.valid, against.is_empty()) {
        (true, true) => ("within", "✓ valid"),
        (true, false) => ("outside", "✗ left out of means"),
        (false, _) => ("outside", "✗ not valid"),
    };
    Cell::default().on_page(&html! {
        span.verdict.(class) { (name) }
        @if !against.is_empty() { br; span.soft { (glue(&against.join("; "))) } }
    })
}

/// How many runs count in means, and which do not.
fn counting(study: &StudyView) -> Block {
    let left_out: Vec<&str> =
        study.runs.iter().filter(|r| !r.counts_in_means()).map(|r| r.name.as_str()).collect();
    let all = study.runs.len();
    match left_out_in_words(left_out.len(), all) {
        None if all == 1 => Block::Text("The one run is valid and counts in means.".to_owned()),
        None => Block::Text(format!("All {all} runs are valid and count in means.")),
        Some(said) => Block::Banner(format!("{said}, ranges and claims: {}.", left_out.join(", "))),
    }
}

/// Wall time in the unit a person would use.
fn wall_time(seconds: f64) -> String {
    match seconds {
        s if s < 100.0 => format!("{} s", number(s, 1)),
        s if s < 6000.0 => format!("{} min", number(s / 60.0, 1)),
        s => format!("{} h", number(s / 3600.0, 1)),
    }
}

/// A name in bold, as the first cell of a card.
fn strong(text: &str) -> Cell {
    Cell::from(text).on_page(&html! { strong { (text) } })
}

fn code(text: &str) -> Cell {
    Cell::from(text).on_page(&html! { code { (name(text)) } })
}

/// What was chosen where the paper is silent.
pub(super) fn choices(choices: &[Choice]) -> Block {
    let table = table!(choices, |choice| {
        "Parameter" => strong(&choice.parameter),
        "Value" => &choice.value,
        "Why" => &choice.reason,
        "What it moves" => &choice.sensitivity,
    });
    Block::Table(table.class("cards"))
}

/// What was watched while the runs went on, in a line each where something was found.
fn checks(runs: &[RunRecord]) -> Vec<Block> {
    let said = |run: &RunRecord| match &run.summary.checks {
        Some(checks) if checks.passed == Some(true) => None,
        Some(checks) => Some(format!("{}: {}", run.name, checks.line())),
        None => Some(format!("{}: not watched, being stored before checks were", run.name)),
    };
    let said: Vec<String> = runs.iter().filter_map(said).collect();
    let passed = format!(
        "{} of {} passed every check: numbers, grains, walls, speeds, energy, overlap and numerical \
         creep are watched while a run goes on (docs/accuracy.md).",
        runs.len() - said.len(),
        counted(runs.len(), "run")
    );
    vec![Block::Heading("Checks".to_owned()), Block::Text(passed), Block::List(said)]
}

/// Versions, settings, checks, warnings.
pub(super) fn provenance(input: &ReportInput) -> Vec<Block> {
    let runs = input.study.runs;
    let of_runs = runs.iter().flat_map(|run| {
        run.summary.warnings.iter().map(|warning| format!("{}: {warning}", run.name))
    });
    let of_study = input.warnings.iter().map(|warning| format!("study: {warning}"));
    let mut warnings: Vec<String> = of_study.chain(of_runs).collect();
    if warnings.is_empty() {
        warnings.push("None.".to_owned());
    }
    let versions = table!(input.provenance, |(what, value)| {
        "" => strong(what),
        "" => code(value),
    });
    let settings = table!(input.effective, |(name, value)| {
        "" => code(name),
        "" => code(&value.to_string()),
    });
    let settings = html! {
        details {
            summary { "Engine settings, as read back from the engine (" (input.effective.len()) ")" }
            (settings.class("cards").html())
        }
    };
    let mut blocks = vec![Block::Table(versions.class("cards")), Block::Html(settings)];
    blocks.extend(checks(runs));
    blocks.extend([Block::Heading("Warnings".to_owned()), Block::List(warnings)]);
    blocks
}
