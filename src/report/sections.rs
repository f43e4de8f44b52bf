//! The tables of the report.

use maud::{Markup, html};

use super::{
    Choice, Column, ReportInput,
    html::{glue, name},
};
use crate::{
    paper::{
        Claim, ClaimKind, Interval, NotValid, PaperValue, StudyView, Verdict,
        text::{compact, number},
    },
    plain::plain,
    record::{AngleOfRepose, NO_VALID_RUN, RunKind, RunRecord, Settlement, left_out_in_words},
};

/// Class and name of a verdict.
fn verdict(verdict: Verdict) -> (&'static str, &'static str) {
    match verdict {
        Verdict::Within => ("within", "✓ within"),
        Verdict::Outside => ("outside", "✗ outside"),
        Verdict::NotStated => ("not_stated", "– not stated"),
        Verdict::NotRun => ("not_stated", "– not run"),
        Verdict::NotComparable => ("not_stated", "– not comparable"),
    }
}

/// A verdict with why there is none, in words.
pub(super) fn verdict_badge(of: Verdict, reason: &str) -> Markup {
    let (class, name) = verdict(of);
    html! {
        span.verdict.(class) { (name) }
        @if !reason.is_empty() && !name.ends_with(reason) {
            " " span.soft.reason { (glue(reason)) }
        }
    }
}

/// The claims as a table, results first, with a tally of the results above; what other engines
/// made of them in a column each.
pub(super) fn claims(claims: &[Claim], beside: &[Column]) -> Markup {
    let count = |v| claims.iter().filter(|c| c.kind == ClaimKind::Result && c.verdict == v).count();
    let kinds = [
        (ClaimKind::Result, "Results"),
        (ClaimKind::NoNumber, "Statements without a number in the paper's text"),
        (ClaimKind::Input, "Inputs, and what follows from them"),
    ];
    html! {
        ul.tally {
            @for v in [Verdict::Within, Verdict::Outside, Verdict::NotRun, Verdict::NotComparable] {
                @let (class, name) = verdict(v);
                li { span.verdict.(class) { (name) ": " (count(v)) } }
            }
        }
        p.soft {
            "Counted are the results alone. “Within”: our number lies where the paper's is read to lie. "
            "“Outside”: it does not. “Not run”: it was not measured. “Not comparable”: it was, but on a "
            "smaller specimen, or in runs that do not count; what such runs show stands in "
            "brackets. “Not stated”: the text gives no number; ours is for information. Ours is of the runs "
            "that count (docs/accuracy.md)."
            @if !beside.is_empty() {
                " The last columns are the same programme by other engines or settings."
            }
        }
        table.claims.cards {
            thead { tr {
                th { "Statement" } th.n { "Paper" } th.n { "Ours" } th { "Verdict" }
                @for column in beside { th.n { (name(&column.label)) } }
            } }
            @for (kind, title) in kinds {
                @let of_kind: Vec<&Claim> = claims.iter().filter(|c| c.kind == kind).collect();
                @if !of_kind.is_empty() {
                    tbody {
                        tr.kind { th scope="rowgroup" colspan=(4 + beside.len()) { (title) } }
                        @for claim in of_kind { (claim_row(claim, beside)) }
                    }
                }
            }
        }
    }
}

fn claim_row(claim: &Claim, beside: &[Column]) -> Markup {
    let paper = match claim.paper {
        None => "–".to_owned(),
        Some(PaperValue::Value { value }) => compact(value),
        Some(PaperValue::Range(i)) => format!("{} to {}", compact(i.low), compact(i.high)),
    };
    // The interval is worth a line where it is not what the paper prints.
    let read_as = claim.read_as.filter(|i| {
        i.high - i.low > 1e-3 * i.high.abs().max(1.0)
            && !matches!(claim.paper, Some(PaperValue::Range(_)))
    });
    html! {
        tr id={ "claim-" (claim.id) } {
            td {
                (claim.statement) " " span.soft { (claim.source) }
                @if !claim.note.is_empty() || !claim.runs.is_empty() {
                    details {
                        summary { "How read" }
                        span.soft {
                            (glue(&claim.note))
                            @if !claim.runs.is_empty() { " Runs: " (name(&claim.runs.join(", "))) "." }
                        }
                    }
                }
            }
            td.n data-label="Paper" {
                (paper)
                @if let Some(i) = read_as {
                    " " span.unit { "(read as " (compact(i.low)) " to " (compact(i.high)) ")" }
                }
            }
            td.n data-label="Ours" {
                (value_or_not_valid(claim.ours, claim.spread, claim.not_valid, &claim.unit))
                @if !claim.left_out.is_empty() {
                    " " span.unit { "(left out: " (claim.left_out.len()) ")" }
                }
            }
            td { (verdict_badge(claim.verdict, &claim.reason)) }
            @for column in beside {
                td.n data-label=(plain(&column.label)) {
                    @match column.claims.get(&claim.id) {
                        None => { "–" }
                        Some(found) => {
                            (value_or_not_valid(found.ours, found.spread, found.not_valid, &claim.unit)) " "
                            @let (class, name) = verdict(found.verdict);
                            @if found.ours.is_some()
                                && matches!(found.verdict, Verdict::Within | Verdict::Outside) {
                                span.verdict.(class) title=(name) {
                                    (name.chars().take(1).collect::<String>())
                                }
                            }
                        }
                    }
                }
            }
        }
    }
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

/// A value with its unit and, where several make it, its spread.
fn value(value: Option<f64>, unit: &str, spread: Option<Interval>) -> Markup {
    html! {
        @match value {
            None => { "–" }
            Some(value) => {
                (compact(value)) " "
                @if unit != "–" { span.unit { (unit) } }
                @if let Some(s) = spread {
                    @if s.high > s.low {
                        " " span.unit { "[" (compact(s.low)) " … " (compact(s.high)) "]" }
                    }
                }
            }
        }
    }
}

/// One line a run.
pub(super) fn runs(study: &StudyView) -> Markup {
    html! {
        @if study.runs.is_empty() {
            p { "No run is finished." }
        } @else {
            (counting(study))
            p.soft {
                "Heights in mm above the floor: mean of the surface, its 95th percentile, highest "
                "point of any grain. e: void ratio to the mean surface. Settlement in mm at the end, "
                "of the plate and of the mean surface, and the plate's share after 5 s. Overlap in % of "
                "the equivalent diameter. Creep in µm/s, and the drop of the mean grain height in the "
                "rest test in µm over its length. Z: mean number of grains touching a grain. Grains "
                "through a wall / over the rim / left in the funnel are listed as lost."
            }
            div.scroll { table {
                thead { tr {
                    th { "Run" } th.n { "FH, cm" }
                    th.n { "Mean" } th.n { "p95" } th.n { "Highest" } th.n { "e" }
                    th.n { "Plate" } th.n { "Surface" } th.n { "In 5 s" }
                    th.n { "Overlap mean / p99 / max" }
                    th.n { "Creep" } th.n { "RestTest" } th.n { "Z" }
                    th.n { "Lost" } th { "Standard" } th { "Valid" } th.n { "Wall time" }
                } }
                tbody { @for run in study.runs.iter().filter(|r| r.kind != RunKind::Repose) {
                    (run_row(run))
                } }
            } }
            (piles(study))
        }
    }
}

/// One line a pile; nothing without any.
fn piles(study: &StudyView) -> Markup {
    let piles: Vec<&RunRecord> = study.of_kind(RunKind::Repose).collect();
    if piles.is_empty() {
        return html! {};
    }
    html! {
        h3 { "Piles" }
        p.soft {
            "Angle of repose with the 95 % confidence interval of that pile's mean slope, standard "
            "deviation over sectors of 10°, and the slope of the cone of the same volume and height. "
            "Height and radius in mm. Grains fallen off the base."
        }
        div.scroll { table {
            thead { tr {
                th { "Run" } th.n { "Angle" } th.n { "95 %" } th.n { "Sectors" } th.n { "By volume" }
                th.n { "Height" } th.n { "Radius" } th.n { "Fallen off" }
                th.n { "Overlap mean / p99 / max" } th.n { "Creep" } th { "Standard" } th { "Valid" }
                th.n { "Wall time" }
            } }
            tbody { @for run in piles { (pile_row(run)) } }
        } }
    }
}

fn pile_row(run: &RunRecord) -> Markup {
    let s = &run.summary;
    let of = |value: fn(&AngleOfRepose) -> f64| {
        s.angle_of_repose.as_ref().map_or("–".to_owned(), |a| number(value(a), 1))
    };
    let o = s.overlap;
    let overlaps = [o.mean_percent, o.p99_percent, o.max_percent].map(|v| number(v, 2));
    html! {
        tr {
            th scope="row" { (name(&run.name)) }
            td.n { (of(|a| a.degrees)) "°" }
            td.n { (of(|a| a.confidence_low_degrees)) " to " (of(|a| a.confidence_high_degrees)) "°" }
            td.n { (of(|a| a.standard_deviation_degrees)) "°" }
            td.n { (of(|a| a.by_volume_degrees)) "°" }
            td.n { (of(|a| a.pile_height_mm)) }
            td.n { (of(|a| a.base_radius_mm)) }
            td.n { (s.grains.spilled) }
            td.n { (overlaps.join(" / ")) }
            td.n { (s.creep_um_per_s.map_or("–".to_owned(), |c| number(c, 1))) }
            td { (standard_badge(s.meets_standard)) }
            td { (valid_badge(run)) }
            td.n { (wall_time(s.wall_s)) }
        }
    }
}

fn standard_badge(met: bool) -> Markup {
    let (class, name) = if met { ("within", "✓ met") } else { ("outside", "✗ not met") };
    html! { span.verdict.(class) { (name) } }
}

/// Whether a run is valid and counts in means, with what is against it.
fn valid_badge(run: &RunRecord) -> Markup {
    let against = run.summary.why_left_out();
    let (class, name) = match (run.summary.valid, against.is_empty()) {
        (true, true) => ("within", "✓ valid"),
        (true, false) => ("outside", "✗ left out of means"),
        (false, _) => ("outside", "✗ not valid"),
    };
    html! {
        span.verdict.(class) { (name) }
        @if !against.is_empty() { br; span.soft { (glue(&against.join("; "))) } }
    }
}

/// How many runs count in means, and which do not.
fn counting(study: &StudyView) -> Markup {
    let left_out: Vec<&str> =
        study.runs.iter().filter(|r| !r.counts_in_means()).map(|r| r.name.as_str()).collect();
    let said = left_out_in_words(left_out.len(), study.runs.len());
    html! {
        @if said.is_empty() {
            p { "All " (study.runs.len()) " runs are valid and count in means." }
        } @else {
            p.banner { (said) ", ranges and claims: " (left_out.join(", ")) "." }
        }
    }
}

fn run_row(run: &RunRecord) -> Markup {
    let s = &run.summary;
    let optional = |v: Option<f64>, decimals| v.map_or("–".to_owned(), |v| number(v, decimals));
    let end = |s: &Option<Settlement>| optional(s.as_ref().map(|s| s.final_mm), 2);
    let share = s.settlement_mm.as_ref().and_then(|s| s.share_after_5_s).map(|s| 100.0 * s);
    let rest_test = s.rest_test.map_or("–".to_owned(), |c| {
        let um = 1e3 * c.mean_grain_height_drop_mm;
        format!("{} in {} s", number(um, 1), number(c.duration_s, 1))
    });
    let o = s.overlap;
    let overlaps = [o.mean_percent, o.p99_percent, o.max_percent].map(|v| number(v, 2));
    html! {
        tr {
            th scope="row" { (name(&run.name)) }
            td.n { (number(run.falling_height_mm / 10.0, 0)) }
            td.n { (number(s.standing_height_mm.mean_surface, 1)) }
            td.n { (number(s.standing_height_mm.p95, 1)) }
            td.n { (number(s.standing_height_mm.highest, 1)) }
            td.n { (optional(s.void_ratio, 3)) }
            td.n { (end(&s.settlement_mm)) }
            td.n { (end(&s.surface_settlement_mm)) }
            td.n { (optional(share, 0)) @if share.is_some() { " %" } }
            td.n { (overlaps.join(" / ")) }
            td.n { (optional(s.creep_um_per_s, 1)) }
            td.n { (rest_test) }
            td.n { (number(s.coordination_number, 2)) }
            td.n { (s.grains.escaped) " / " (s.grains.spilled) " / " (s.grains.left_in_funnel) }
            td { (standard_badge(s.meets_standard)) }
            td { (valid_badge(run)) }
            td.n { (wall_time(s.wall_s)) }
        }
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

/// What was chosen where the paper is silent.
pub(super) fn choices(choices: &[Choice]) -> Markup {
    html! {
        table.cards {
            thead { tr { th { "Parameter" } th { "Value" } th { "Why" } th { "What it moves" } } }
            tbody { @for c in choices { tr {
                td { strong { (c.parameter) } }
                td data-label="Value" { (c.value) }
                td data-label="Why" { (c.reason) }
                td data-label="What it moves" { (c.sensitivity) }
            } } }
        }
    }
}

/// What was watched while the runs went on, in a line each where something was found.
fn checks(input: &ReportInput) -> Markup {
    let runs = input.study.runs;
    let line = |run: &RunRecord| match &run.summary.checks {
        Some(checks) => (checks.passed, checks.line()),
        None => (None, "not watched, being stored before checks were".to_owned()),
    };
    let lines: Vec<(&str, Option<bool>, String)> = runs
        .iter()
        .map(|run| {
            let (passed, line) = line(run);
            (run.name.as_str(), passed, line)
        })
        .collect();
    let passed = lines.iter().filter(|(_, passed, _)| *passed == Some(true)).count();
    html! {
        p { (passed) " of " (lines.len()) " runs passed every check: numbers, grains, walls, speeds, energy, overlap and creep are watched while a run goes on (docs/accuracy.md)." }
        @if passed < lines.len() {
            ul { @for (run, _, line) in lines.iter().filter(|(_, p, _)| *p != Some(true)) {
                li { strong { (name(run)) } ": " bdi { (glue(line)) } }
            } }
        }
    }
}

/// Versions, settings, warnings.
pub(super) fn provenance(input: &ReportInput) -> Markup {
    let mut warnings: Vec<(&str, String)> =
        input.warnings.iter().map(|w| ("study", w.clone())).collect();
    for run in input.study.runs {
        warnings.extend(run.summary.warnings.iter().map(|w| (run.name.as_str(), w.clone())));
    }
    html! {
        table.cards { tbody { @for (what, value) in input.provenance {
            tr { td { strong { (what) } } td { code { (name(value)) } } }
        } } }
        details {
            summary { "Engine settings, as read back from the engine (" (input.effective.len()) ")" }
            table { tbody { @for (name, value) in input.effective {
                tr { td { code { (name) } } td { code { (value.to_string()) } } }
            } } }
        }
        h3 { "Checks" }
        (checks(input))
        h3 { "Warnings" }
        @if warnings.is_empty() {
            p { "None." }
        } @else {
            ul { @for (source, text) in &warnings { li { strong { (name(source)) } ": " bdi { (glue(text)) } } } }
        }
    }
}
