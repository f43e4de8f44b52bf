//! The page of a comparison of engines.

use std::path::Path;

use serde::Serialize;

use super::{
    Figure, ReportError, Standard, figures,
    page::{Block, Page},
    table::{Cell, Table, dash, row},
};
use crate::{paper::text::number, plain::plain, record::RunRecord, world::BackendInfo};

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
    page(of, figures::of_comparison(of)?).write(out, &["report.html"])
}

fn page(of: &Comparison, figures: Vec<Figure>) -> Page {
    let names: Vec<&str> = of.engines.iter().map(|e| e.name.as_str()).collect();
    let title = format!("{}: {} side by side", plain(&of.scenario), names.join(" and "));
    let engine = |e: &BackendInfo| format!("{} {}, {} precision", e.name, e.version, e.precision);
    let engines: Vec<String> = of.engines.iter().map(engine).collect();
    let standard = format!(
        "Wall times can be compared only between runs that meet the accuracy standard (overlap mean \
         below {} %, 99th percentile below {} %, creep below {} µm/s): a step that lets grains overlap \
         more is cheaper, not better.",
        of.standard.overlap_mean_percent,
        of.standard.overlap_p99_percent,
        of.standard.creep_um_per_s
    );
    Page::new(title, [Block::Soft(engines.join("; ")), Block::Lead(lead(of))])
        .section("table", "Figures", [Block::Table(table(of)), Block::Soft(standard)])
        .figures("curves", "Curves", figures)
        .section("reasons", "Why they differ", [Block::List(reasons(of))])
}

/// What the engines come to, and whether they agree.
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

fn table(of: &Comparison) -> Table {
    let names = of.runs.iter().map(|run| run.record.name.as_str());
    let header = ["Quantity", "Unit"].into_iter().chain(names).chain(["Band", "Agree"]);
    let mut table = Table::new(header);
    for q in &of.quantities {
        let mut cells = row![&q.quantity, &q.unit];
        let of_run = |v: &Option<f64>| Cell::number(v.map_or_else(dash, shown));
        cells.extend(q.values.iter().map(of_run));
        cells
            .push(Cell::number(q.band.map_or_else(String::new, |b| format!("± {}", number(b, 2)))));
        cells.push(match q.within_band {
            Some(true) => Cell::badge("within", "✓ yes"),
            Some(false) => Cell::badge("outside", "✗ no"),
            None => Cell::default(),
        });
        table.row(cells);
    }
    let mut add = |what: &str, said: fn(&RunRecord) -> &'static str| {
        let mut cells = row![what, ""];
        cells.extend(of.runs.iter().map(|run| Cell::number(said(&run.record))));
        cells.extend(row!["", ""]);
        table.row(cells);
    };
    add("accuracy standard", |r| if r.summary.meets_standard { "met" } else { "not met" });
    add("valid", |r| if r.summary.valid { "yes" } else { "NOT valid" });
    table
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
