//! The page of a comparison of engines.

use std::path::Path;

use maud::{DOCTYPE, Markup, html};
use serde::Serialize;

use super::{
    Figure, ReportError, Standard, figures, html::figure_block, html::glue, html::head, html::name,
};
use crate::{
    paper::text::number,
    plain::plain,
    record::{RunRecord, write_file},
    world::BackendInfo,
};

/// Everything the page is made from.
#[derive(Debug, Clone)]
pub struct Comparison {
    /// Name of the scenario.
    pub scenario: String,
    /// The engines; the first one's specimen is handed to the others.
    pub engines: Vec<BackendInfo>,
    /// Whether the scenario vibrates the specimen.
    pub vibrated: bool,
    /// The accuracy standard.
    pub standard: Standard,
    /// The runs.
    pub runs: Vec<ComparedRun>,
    /// The table.
    pub quantities: Vec<ComparedQuantity>,
}

/// A run of the comparison.
#[derive(Debug, Clone)]
pub struct ComparedRun {
    /// The engine that carried it out, or its last part.
    pub backend: String,
    /// The engine that made its specimen, where that was another one.
    pub specimen_by: Option<String>,
    /// The run.
    pub record: RunRecord,
}

/// A row of the table.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ComparedQuantity {
    /// What is compared.
    pub quantity: String,
    /// Unit of the values; empty for pure numbers.
    pub unit: String,
    /// One value a run, in the order of the runs; null where it has none.
    pub values: Vec<Option<f64>>,
    /// Largest difference between engines that is no finding, in `unit`; null
    /// for what is shown only.
    pub band: Option<f64>,
    /// Whether the engines that made their own specimens lie within the band
    /// of the first.
    pub within_band: Option<bool>,
}

/// Writes `report.html` and `figures/` of a comparison into a folder.
///
/// # Errors
/// [`ReportError`] naming the file or the figure.
pub fn write_comparison(out: &Path, of: &Comparison) -> Result<(), ReportError> {
    let figures = figures::of_comparison(of)?;
    for figure in &figures {
        figure.write(&out.join("figures"))?;
    }
    write_file(&out.join("report.html"), page(of, &figures).as_bytes())?;
    Ok(())
}

fn page(of: &Comparison, figures: &[Figure]) -> String {
    let names: Vec<&str> = of.engines.iter().map(|e| e.name.as_str()).collect();
    let title = format!("{}: {} side by side", plain(&of.scenario), names.join(" and "));
    html! {
        (DOCTYPE)
        html lang="en" {
            (head(&title))
            body {
                header {
                    h1 { (title) }
                    p.soft {
                        @for (i, e) in of.engines.iter().enumerate() {
                            @if i > 0 { "; " } (e.name) " " (e.version) ", " (e.precision) " precision"
                        }
                    }
                    p.lead { (glue(&lead(of))) }
                }
                main {
                    section id="table" { h2 { "Figures" } (table(of)) }
                    section id="curves" {
                        h2 { "Curves" }
                        @for figure in figures { (figure_block(figure)) }
                    }
                    section id="reasons" {
                        h2 { "Why they differ" }
                        ul { @for reason in reasons(of) { li { (glue(&reason)) } } }
                    }
                }
            }
        }
    }
    .into_string()
}

fn lead(of: &Comparison) -> String {
    let mut sentences = vec![
        "Every engine run the whole scenario with the same grains in the same places.".to_owned(),
    ];
    if let Some(handed) = of.runs.iter().find_map(|r| r.specimen_by.as_ref()) {
        let what = if of.vibrated { "vibrated" } else { "left at rest" };
        sentences.push(format!(
            "Then the specimen that {handed} made was {what} by the others too, so that making and \
             carrying on can be told apart."
        ));
    }
    for q in of.quantities.iter().filter(|q| q.within_band.is_some()) {
        let unit = if q.unit.is_empty() { String::new() } else { format!(" {}", q.unit) };
        let verdict = match q.within_band {
            Some(true) => "agree",
            _ => "do NOT agree",
        };
        let own: Vec<String> = of
            .runs
            .iter()
            .zip(&q.values)
            .filter(|(r, _)| r.specimen_by.is_none())
            .map(|(_, v)| v.map_or_else(|| "–".to_owned(), shown))
            .collect();
        sentences.push(format!(
            "They {verdict} on the {}: {}{unit}, band {}{unit}.",
            q.quantity,
            own.join(" and "),
            number(q.band.unwrap_or(0.0), 2)
        ));
    }
    let against = of.runs.iter().filter_map(|r| {
        let why = r.record.summary.why_left_out();
        (!why.is_empty()).then(|| format!("{} ({})", r.record.name, why.join("; ")))
    });
    let against: Vec<String> = against.collect();
    if !against.is_empty() {
        sentences.push(format!(
            "NOT valid or short of grains, and no result to quote: {}.",
            against.join(", ")
        ));
        if of.quantities.iter().all(|q| q.within_band.is_none()) {
            sentences.push("So the bands are not judged.".to_owned());
        }
    }
    sentences.join(" ")
}

/// Three decimals, none for counts.
fn shown(value: f64) -> String {
    number(value, if value.fract() == 0.0 { 0 } else { 3 })
}

fn table(of: &Comparison) -> Markup {
    html! {
        div.scroll { table {
            thead { tr {
                th { "Quantity" } th { "Unit" }
                @for run in &of.runs { th.n { (name(&run.record.name)) } }
                th.n { "Band" } th { "Agree" }
            } }
            tbody {
                @for q in &of.quantities { tr {
                    th { (q.quantity) }
                    td { (q.unit) }
                    @for value in &q.values {
                        td.n { @match value { Some(v) => (shown(*v)), None => "–" } }
                    }
                    td.n { @match q.band { Some(b) => { "± " (number(b, 2)) }, None => "" } }
                    td { @match q.within_band {
                        Some(true) => span.verdict.within { "✓ yes" },
                        Some(false) => span.verdict.outside { "✗ no" },
                        None => "",
                    } }
                } }
                tr {
                    th { "accuracy standard" } td {}
                    @for run in &of.runs {
                        td.n { (if run.record.summary.meets_standard { "met" } else { "not met" }) }
                    }
                    td {} td {}
                }
                tr {
                    th { "valid" } td {}
                    @for run in &of.runs {
                        td.n { (if run.record.summary.valid { "yes" } else { "NOT valid" }) }
                    }
                    td {} td {}
                }
            }
        } }
        p.soft {
            "Wall times can be compared only between runs that meet the accuracy standard (overlap "
            "mean below " (of.standard.overlap_mean_percent) " %, 99th percentile below "
            (of.standard.overlap_p99_percent) " %, creep below " (of.standard.creep_um_per_s)
            " µm/s): a step that lets grains overlap more is cheaper, not better."
        }
    }
}

/// What is known of the differences, with this comparison's own numbers.
fn reasons(of: &Comparison) -> Vec<String> {
    let mut reasons = Vec::new();
    for run in &of.runs {
        let s = &run.record.summary;
        let creep = s.creep_um_per_s.map_or_else(
            || "its creep was not measured".to_owned(),
            |c| format!("it sinks by {} µm/s at rest", number(c, 1)),
        );
        reasons.push(format!(
            "{}: overlap {} % on average, {} % at the 99th percentile; {creep}; {} grains touch a \
             grain.",
            run.record.name,
            number(s.overlap.mean_percent, 2),
            number(s.overlap.p99_percent, 2),
            number(s.coordination_number, 2)
        ));
    }
    reasons.push(
        "Overlap makes a packing look denser than it is: grains that share space need less of it. \
         A height is comparable only between runs whose overlaps are both small."
            .to_owned(),
    );
    if of.runs.iter().any(|r| r.backend == "bullet" && r.record.summary.contact_solver == "stock") {
        reasons.push(
            "stock Bullet contacts lose 15 % of the normal and all of the friction impulses at \
             every step, while contact points come and go; twenty iterations cannot build up the \
             network of forces anew, so that grains slip a little for ever. That is its creep."
                .to_owned(),
        );
    }
    if of.runs.iter().any(|r| r.backend == "rapier") {
        reasons.push(
            "Rapier's contacts are springs and dampers: a grain sinks in until the spring carries \
             it, by g/(2πf)² for a contact frequency f, and the more the more grains stand on it."
                .to_owned(),
        );
    }
    reasons
}
