//! The scorecard as the page's first table.

use maud::{Markup, html};

use super::{html::glue, sections::verdict_badge};
use crate::paper::Scorecard;

/// The rows, and how they are read.
pub(super) fn section(card: &Scorecard) -> Markup {
    html! {
        table.claims.cards.scorecard {
            thead { tr {
                th { "Statement" } th.n { "Paper" } th.n { "Ours" } th { "Verdict" }
            } }
            tbody { @for row in &card.rows { tr {
                td {
                    @match row.claims.first() {
                        Some(claim) => { a href={ "#claim-" (claim) } { (row.statement) } }
                        None => { (row.statement) }
                    }
                    " " span.soft { (row.source) }
                }
                td.n data-label="Paper" { (glue(&row.paper)) }
                td.n data-label="Ours" {
                    (glue(&row.in_words))
                    @if row.left_out > 0 { " " span.unit { "(left out: " (row.left_out) ")" } }
                }
                td {
                    (verdict_badge(row.verdict, &row.reason))
                    @if row.is_undecided() { " " span.soft { "not decided" } }
                }
            } } }
        }
        p.soft {
            "Means over the configurations, each the same grains mixed anew, with the 95 % confidence "
            "interval of the mean in brackets. “Within”: the mean lies where the paper's number is read to "
            "lie; of a count: all show it; of the angle: the interval holds the paper's. “Not decided”: the "
            "interval reaches across an end of the paper's range. Every statement by itself: "
             a href="#claims" { "table" } "."
        }
    }
}
