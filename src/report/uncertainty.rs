//! The report's section on how sure its numbers are.

use maud::{Markup, html};

use super::html::glue;
use crate::paper::{
    Interval, Uncertainty,
    text::number,
    uncertainty::{LaboratoryScatter, PlacementScatter, Quantity, SettledRun, Trend, p_value},
};
use crate::record::NO_VALID_RUN;

/// Interval, tests, creep and the laboratory's scatter.
pub(super) fn section(of: &Uncertainty) -> Markup {
    html! {
        p { (glue(&of.trend.verdict)) }
        p.soft {
            "Intervals are those of the mean over the configurations, by Student's t, 95 % confidence. "
            "SD: standard deviation of a single configuration. Runs that are not valid, or short of grains, are left "
            "out (docs/accuracy.md). The same as numbers: "
            a href="uncertainty.json" { "uncertainty.json" } "."
        }
        div.scroll { table {
            thead { tr {
                th { "Quantity" } th.n { "Configurations" } th.n { "Mean" } th.n { "Range" }
                th.n { "SD" } th.n { "95 % confidence" } th { "Mind" }
            } }
            tbody { @for q in &of.quantities { (quantity_row(q)) } }
        } }
        h3 { "Does the standing height fall with the falling height?" }
        (trend(&of.trend))
        @if !of.placements.is_empty() {
            h3 { "Scatter of specimens and of placements of the plate" }
            p.soft {
                "The same poured specimens, each under plates laid anew with a drawn offset and rotation, "
                "shaken continuously. Standard deviations with their 95 % intervals, by a one-way analysis "
                "of variance with random specimens; the interval of the mean holds both."
            }
            (placements(&of.placements))
        }
        h3 { "Settlement beside what the specimen creeps by itself" }
        p.soft {
            "Creep is that of the second half of the rest test, and what it would make over as "
            "long as the vibration took. It is shown, and not subtracted: a shaken specimen need not "
            "creep as a resting one does."
        }
        (settlements(&of.settlements))
        h3 { "The laboratory's scatter" }
        (laboratory(&of.laboratory))
    }
}

fn range(interval: Option<Interval>, decimals: usize) -> String {
    interval.map_or("–".to_owned(), |i| {
        format!("{} to {}", number(i.low, decimals), number(i.high, decimals))
    })
}

fn optional(value: Option<f64>, decimals: usize) -> String {
    value.map_or("–".to_owned(), |v| number(v, decimals))
}

fn quantity_row(q: &Quantity) -> Markup {
    html! { tr {
        th scope="row" { (q.name) ", " (q.unit) }
        td.n { (q.values.len()) }
        td.n {
            @if q.mean.is_none() && !q.left_out.is_empty() { (NO_VALID_RUN) }
            @else { (optional(q.mean, 1)) }
        }
        td.n { (range(q.range, 1)) }
        td.n { (optional(q.standard_deviation, 1)) }
        td.n { (range(q.interval, 1)) }
        td { (glue(&q.note)) }
    } }
}

fn placements(of: &[PlacementScatter]) -> Markup {
    let with = |value: Option<f64>, ends: Option<Interval>| {
        value.map_or("–".to_owned(), |v| format!("{} ({})", number(v, 2), range(ends, 2)))
    };
    html! {
        div.scroll { table {
            thead { tr {
                th { "Quantity" } th.n { "Specimens" } th.n { "Placements" } th.n { "Mean" }
                th.n { "Between specimens" } th.n { "Between placements" } th.n { "p" } th { "Mind" }
            } }
            tbody { @for q in of { tr {
                th scope="row" { (q.name) ", " (q.unit) }
                td.n { (q.specimens.iter().filter(|s| !s.values.is_empty()).count()) }
                td.n { (q.specimens.iter().map(|s| s.values.len()).sum::<usize>()) }
                td.n { (with(q.mean, q.interval)) }
                td.n { (with(q.standard_deviation_of_specimens, q.interval_of_specimens)) }
                td.n { (with(q.standard_deviation_of_placements, q.interval_of_placements)) }
                td.n { (q.p_of_equal_specimens.map_or("–".to_owned(), p_value)) }
                td { (glue(&q.note)) }
            } } }
        } }
    }
}

fn trend(of: &Trend) -> Markup {
    let slopes: Vec<String> = of
        .configurations
        .iter()
        .zip(&of.slopes_mm_per_cm)
        .map(|(c, s)| format!("{} (configuration {c})", number(*s, 3)))
        .collect();
    html! {
        table.cards { tbody {
            tr {
                td { strong { "Slopes, mm per cm of falling height" } }
                td { (if slopes.is_empty() { "–".to_owned() } else { slopes.join(", ") }) }
            }
            tr {
                td { strong { "t-test of the slopes" } }
                td { @match &of.slope {
                    None => "Not possible with fewer than two configurations.",
                    Some(t) => {
                        "mean " (number(t.mean_mm_per_cm, 3)) ", 95 % " (range(Some(t.interval), 3))
                        ", t = " (optional(t.t, 2)) " with " (number(t.freedom, 0))
                        " degrees of freedom, two-sided p = " (p_value(t.p))
                    }
                } }
            }
            tr {
                td { strong { "Page's trend test, ranks only" } }
                td { @match &of.page {
                    None => "Not possible with fewer than two configurations or three heights.",
                    Some(p) => {
                        "L = " (number(p.l, 1)) " for " (p.configurations) " configurations and "
                        (p.heights) " heights, exact one-sided p = " (p_value(p.p))
                    }
                } }
            }
            tr {
                td { strong { "Configurations for 80 % power" } }
                td { @match of.configurations_needed {
                    None => "Not known: it asks for three configurations and a slope that is not 0.",
                    Some(n) => { (n) ", were the measured slope and scatter the true ones" }
                } }
            }
        } }
        p.soft {
            "Sources: Student's one-sample test (1908) of each configuration's least squares slope, "
            "since a configuration is poured from every height; E. B. Page (1963), Ordered hypotheses "
            "for multiple treatments, Journal of the American Statistical Association 58, 216–230; "
            "power of the t-test after Cohen (1988), Statistical Power Analysis for the Behavioral "
            "Sciences. A scatter estimated from three configurations is itself uncertain by a factor of "
            "two and more, and the number of configurations with it."
        }
    }
}

fn settlements(runs: &[SettledRun]) -> Markup {
    html! {
        @if runs.is_empty() {
            p { "No specimen was shaken." }
        } @else {
            div.scroll { table {
                thead { tr {
                    th { "Run" } th.n { "Plate, mm" } th.n { "Mean surface, mm" }
                    th.n { "Creep, µm/s" } th.n { "Creep over the vibration, mm" }
                    th.n { "Plate in the rest test, mm" } th.n { "RestTest, s" }
                } }
                tbody { @for run in runs { tr {
                    th scope="row" {
                        (run.run)
                        @if !run.left_out_of_means.is_empty() { " " span.soft { "(left out)" } }
                    }
                    td.n { (optional(run.plate_mm, 2)) }
                    td.n { (optional(run.surface_mm, 2)) }
                    td.n { (optional(run.creep_um_per_s, 1)) }
                    td.n { (optional(run.creep_over_vibration_mm, 3)) }
                    td.n { (optional(run.rest_test_plate_drop_mm, 3)) }
                    td.n { (optional(run.rest_test_s, 1)) }
                } } }
            } }
        }
    }
}

fn laboratory(of: &[LaboratoryScatter]) -> Markup {
    html! {
        table.cards {
            thead { tr {
                th { "Quantity" } th { "Laboratory, range" } th { "Ours, range" } th { "What is known" }
            } }
            tbody { @for l in of { tr {
                td { strong { (l.quantity) } ", " (l.unit) }
                td data-label="Laboratory" {
                    @match l.stated_range {
                        None => "not stated",
                        Some(i) => { (number(i.low, 2)) " to " (number(i.high, 2)) }
                    }
                }
                td data-label="Ours" { (range(l.ours, 1)) }
                td data-label="What is known" { (glue(&l.note)) }
            } } }
        }
    }
}
