//! The page of a comparison of engines.

use super::*;
use crate::record::{Summary, left_out_with_reasons};
use crate::world::BackendInfo;

/// `compare.json`, and what only its page needs.
#[derive(Debug, Clone, Serialize)]
pub struct CompareRecord {
    /// Name of the scenario.
    pub scenario: String,
    /// The engines, the first one's specimen being handed on.
    pub backends: Vec<BackendInfo>,
    /// Stages of the scenario run before the specimen is handed on.
    pub handed_on_after_stages: usize,
    /// One entry a run.
    pub runs: Vec<CompareRun>,
    /// One entry a quantity: the first engine's value and the others'.
    pub quantities: Vec<ComparedQuantity>,
    /// Whether every quantity with a band lies within it; null where the bands are not judged.
    pub within_bands: Option<bool>,
    /// Why the bands are not judged: the runs that are left out of means, with the reasons, or that
    /// there is no band for what the runs measure.
    pub not_judged: Option<String>,
    /// Whether no band is missed and every engine's own run counts in means.
    #[serde(skip)]
    pub as_expected: bool,
    /// Whether the scenario vibrates the specimen.
    #[serde(skip)]
    pub vibrated: bool,
    /// The accuracy standard.
    #[serde(skip)]
    pub standard: Standard,
}

/// One run of a comparison.
#[derive(Debug, Clone, Serialize)]
pub struct CompareRun {
    /// Its name, also of its folder.
    pub name: String,
    /// The engine that carried it out, or its last part.
    pub backend: String,
    /// The engine that made the specimen it began with; null when it made its own.
    pub specimen_by: Option<String>,
    /// Wall time over simulated time of all its stages, those of the engine that made its specimen
    /// among them.
    pub wall_s_per_simulated_s: f64,
    /// Its figures.
    pub summary: Summary,
    /// Its course.
    #[serde(skip)]
    pub series: Vec<SeriesRow>,
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

/// Writes `compare.json`, `report.html` and `figures/` of a comparison into a folder.
///
/// # Errors
/// [`ReportError`] naming the file or the figure.
pub fn write_comparison(out: &Path, of: &CompareRecord) -> Result<(), ReportError> {
    write_json(&out.join("compare.json"), of)?;
    page(of, figures(of)?).write(out, &["report.html"])
}

fn page(of: &CompareRecord, figures: Vec<Figure>) -> Page {
    let names: Vec<&str> = of.backends.iter().map(|e| e.name.as_str()).collect();
    let title = format!("{}: {} side by side", plain(&of.scenario), names.join(" and "));
    let engine = |e: &BackendInfo| format!("{} {}, {} precision", e.name, e.version, e.precision);
    let engines: Vec<String> = of.backends.iter().map(engine).collect();
    let standard = format!(
        "Wall times can be compared only between runs that meet the accuracy standard (overlap mean \
         below {} %, 99th percentile below {} %, numerical creep below {} µm/s): a step that lets grains \
         overlap more is cheaper, not better.",
        of.standard.overlap_mean_percent,
        of.standard.overlap_p99_percent,
        compact(of.standard.creep_um_per_s)
    );
    Page::new(title, [Block::Soft(engines.join("; ")), Block::Lead(lead(of))])
        .section("table", "Numbers", [Block::Table(table(of)), Block::Soft(standard)])
        .figures("curves", "Figures", figures)
        .section("reasons", "Why they differ", [Block::List(reasons(of))])
}

/// What the engines come to, and whether they agree.
fn lead(of: &CompareRecord) -> String {
    let mut sentences = vec![
        "Every engine ran the whole scenario with the same grains in the same places.".to_owned(),
    ];
    if let Some(handed) = of.runs.iter().find_map(|r| r.specimen_by.as_ref()) {
        let what = if of.vibrated { "vibrated" } else { "left at rest" };
        sentences.push(format!(
            "Then the specimen that {handed} made was {what} by the others, too: this separates the \
             making of a specimen from what follows."
        ));
    }
    for q in of.quantities.iter().filter(|q| q.within_band.is_some()) {
        let unit = if q.unit.is_empty() { String::new() } else { format!(" {}", q.unit) };
        let verdict = match q.within_band {
            Some(true) => "agree",
            _ => "do NOT agree",
        };
        let own = of.runs.iter().zip(&q.values).filter(|(r, _)| r.specimen_by.is_none());
        let own: Vec<String> = own.map(|(_, v)| v.map_or_else(dash, shown)).collect();
        sentences.push(format!(
            "They {verdict} on the {}: {}{unit}, band {}{unit}.",
            q.quantity,
            own.join(" and "),
            number(q.band.unwrap_or(0.0), 2)
        ));
    }
    let named = of.runs.iter().map(|r| (r.name.as_str(), &r.summary));
    let against = left_out_with_reasons(named);
    if !against.is_empty() {
        sentences
            .push(format!("NOT counted in means, and no result to quote: {}.", against.join(", ")));
    }
    if let Some(why) = &of.not_judged {
        // Which runs are left out has been said.
        let no_band = format!("No band is judged: {why}.");
        let said = if of.as_expected { no_band } else { "So the bands are not judged.".to_owned() };
        sentences.push(said);
    }
    sentences.join(" ")
}

/// Three decimals, none for counts.
fn shown(value: f64) -> String {
    number(value, if value.fract() == 0.0 { 0 } else { 3 })
}

fn table(of: &CompareRecord) -> Table {
    let names = of.runs.iter().map(|run| run.name.as_str());
    let header = ["Quantity", "Unit"].into_iter().chain(names).chain(["Band", "Agree"]);
    let mut table = Table::new(header);
    // What no run has, as the angle of repose of a cylinder, is no row.
    for q in of.quantities.iter().filter(|q| q.values.iter().any(Option::is_some)) {
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
    let mut add = |what: &str, said: fn(&Summary) -> &'static str| {
        let mut cells = row![what, ""];
        cells.extend(of.runs.iter().map(|run| Cell::number(said(&run.summary))));
        cells.extend(row!["", ""]);
        table.row(cells);
    };
    add("accuracy standard", |s| if s.meets_standard { "met" } else { "not met" });
    add("valid", |s| if s.valid { "yes" } else { "NOT valid" });
    table
}

/// How grains overlap, sink and touch.
fn packing(of: &Summary) -> String {
    let Some(overlap) = of.overlap.known() else { return "no grain is left".to_owned() };
    let creep = of.creep_um_per_s.map_or_else(
        || "its numerical creep was not measured".to_owned(),
        |c| format!("its numerical creep is {} µm/s", number(c, 1)),
    );
    format!(
        "overlap {} % on average, {} % at the 99th percentile; {creep}; {} grains touch a grain",
        number(overlap.mean_percent, 2),
        number(overlap.p99_percent, 2),
        number(of.coordination_number, 2)
    )
}

/// What is known of the differences, with this comparison's own numbers.
fn reasons(of: &CompareRecord) -> Vec<String> {
    let packed = of.runs.iter().map(|run| format!("{}: {}.", run.name, packing(&run.summary)));
    let mut reasons: Vec<String> = packed.collect();
    reasons.push(
        "Overlap makes a packing look denser than it is: grains that share space need less of it. \
         A height is comparable only between runs whose overlaps are both small."
            .to_owned(),
    );
    if of.runs.iter().any(|r| r.backend == "bullet" && r.summary.contact_solver == "stock") {
        reasons.push(
            "stock Bullet contacts lose 15 % of the normal and all of the friction impulses at \
             every step, while contact points come and go; twenty iterations cannot build up the \
             network of forces anew, so that grains slip a little for ever. That is its numerical creep."
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

/// What a figure shows of every run, over its time.
struct Shown {
    stem: &'static str,
    title: &'static str,
    caption: &'static str,
    axis: &'static str,
    column: &'static str,
    is_log: bool,
    /// Whether it is drawn downwards, the way the plate goes, as in every other figure over time.
    is_down: bool,
    value: fn(&SeriesRow) -> Option<f64>,
}

const SHOWN: [Shown; 4] = [
    Shown {
        stem: "compare-height",
        title: "Mean height of the grains",
        caption: "Mean height of the grains in place over the time of each run; dashed where the \
                  specimen came from another engine.",
        axis: "Mean grain height (mm)",
        column: "mean_grain_height_mm",
        is_log: false,
        is_down: false,
        value: |r| r.mean_grain_height_mm.filter(|_| r.grains_in_cylinder > 0),
    },
    Shown {
        stem: "compare-energy",
        title: "Kinetic energy",
        caption: "Kinetic energy of grains and plate relative to the table.",
        axis: "Kinetic energy (J)",
        column: "kinetic_energy_j",
        is_log: true,
        is_down: false,
        value: |r| Some(r.kinetic_energy_j),
    },
    Shown {
        stem: "compare-settlement",
        title: "Settlement of the mean surface",
        caption: "Drop of the mean surface since the vibration began, at the times of each run.",
        axis: "Settlement of the surface (mm)",
        column: "surface_settlement_mm",
        is_log: false,
        is_down: true,
        value: |r| r.surface_settlement_mm,
    },
    Shown {
        stem: "compare-plate",
        title: "Settlement of the top plate",
        caption: "Drop of the plate's centre since the vibration began, at the times of each run.",
        axis: "Settlement of the plate (mm)",
        column: "settlement_mm",
        is_log: false,
        is_down: true,
        value: |r| r.settlement_mm,
    },
];

/// Heights, energy and, where vibrated, settlement.
fn figures(of: &CompareRecord) -> Result<Vec<Figure>, ReportError> {
    SHOWN.iter().filter_map(|shown| overlaid(of, shown).transpose()).collect()
}

/// What the runs show, where they do.
fn overlaid(of: &CompareRecord, shown: &Shown) -> Result<Option<Figure>, ReportError> {
    let point = |r: &SeriesRow| Some((r.time_s, (shown.value)(r)?));
    let y = Axis::scaled(shown.is_log, shown.axis).from_zero();
    let y = if shown.is_down { y.reversed() } else { y };
    let mut plot = Plot::new(Axis::linear("Time (s)"), y);
    for (n, run) in of.runs.iter().enumerate() {
        let is_handed = run.specimen_by.is_some();
        let dash = if is_handed { style::DASHED } else { style::SOLID };
        let points = run.series.iter().filter_map(point).collect();
        plot.add(&run.name, Look::spaced(n).dash(dash), points);
    }
    let has_points = plot.series.iter().any(|series| !series.points.is_empty());
    let columns = ["run", "time_s", shown.column];
    let figure = || Figure::of_curves(shown.stem, shown.title, shown.caption, &[plot], &columns);
    has_points.then(figure).transpose()
}

#[cfg(test)]
mod tests {
    use roxmltree::Document;

    use super::*;
    use crate::record::{Overlap, canned};

    const STANDARD: Standard =
        Standard { overlap_mean_percent: 0.5, overlap_p99_percent: 3.0, creep_um_per_s: 5.0 };

    /// Law: a run whose grains have left says so, in the place of numbers that it does not have.
    #[test]
    fn a_run_without_grains_says_so() {
        let summary = canned::valid_runs()[0].summary.clone();
        let text = packing(&summary);
        assert!(text.contains(" % on average"), "law: grains overlap by a number, got `{text}`");
        let left = Summary {
            overlap: Overlap::of_none(),
            coordination_number: f64::NAN,
            creep_um_per_s: None,
            ..summary
        };
        assert_eq!(packing(&left), "no grain is left", "law: left what is said, right expected");
    }

    /// Law: the table of numbers is called so, and has no row of what no run has.
    #[test]
    fn the_table_has_what_the_runs_have() {
        let quantity = |quantity: &str, value| ComparedQuantity {
            quantity: quantity.to_owned(),
            unit: "mm".to_owned(),
            values: vec![value],
            band: None,
            within_band: None,
        };
        let of = CompareRecord {
            scenario: "s".to_owned(),
            backends: Vec::new(),
            handed_on_after_stages: 0,
            runs: Vec::new(),
            quantities: vec![quantity("a height", Some(24.5)), quantity("a settlement", None)],
            within_bands: None,
            not_judged: None,
            as_expected: true,
            vibrated: false,
            standard: STANDARD,
        };
        let page = page(&of, Vec::new()).markdown();
        for (said, expected) in
            [("## Numbers", true), ("| a height |", true), ("a settlement", false)]
        {
            assert_eq!(page.contains(said), expected, "law: `{said}` (got left), page:\n{page}");
        }
    }

    /// Law: settlement is drawn downwards, as in every other figure over time; heights are not.
    #[test]
    fn settlement_is_drawn_downwards() {
        let run = canned::runs().remove(4);
        let of = CompareRecord {
            scenario: "s".to_owned(),
            backends: Vec::new(),
            handed_on_after_stages: 0,
            runs: vec![CompareRun {
                name: "bullet".to_owned(),
                backend: "bullet".to_owned(),
                specimen_by: None,
                wall_s_per_simulated_s: 1.0,
                summary: run.summary,
                series: run.series,
            }],
            quantities: Vec::new(),
            within_bands: None,
            not_judged: None,
            as_expected: true,
            vibrated: true,
            standard: STANDARD,
        };
        for (stem, expected) in [("compare-plate", true), ("compare-height", false)] {
            let shown = SHOWN.iter().find(|shown| shown.stem == stem).expect("a figure");
            let figure = overlaid(&of, shown).expect("drawn").expect("it has points");
            assert!(figure.svg.contains("<circle"), "law: curves have markers, not colours alone");
            let svg = Document::parse(&figure.svg).expect("XML");
            // Numbers beside the frame end at its side.
            let ticks: Vec<(f64, f64)> = svg
                .descendants()
                .filter(|node| node.attribute("text-anchor") == Some("end"))
                .filter_map(|node| {
                    let number = node.text()?.trim().parse().ok()?;
                    Some((number, node.attribute("y")?.parse().ok()?))
                })
                .collect();
            let place = |wanted: f64| ticks.iter().find(|t| t.0 == wanted).map(|t| t.1);
            let largest = ticks.iter().map(|t| t.0).fold(0.0, f64::max);
            let is_down = place(0.0) < place(largest);
            assert_eq!(is_down, expected, "law: {stem}, 0 above (got left) of {ticks:?}");
        }
    }
}
