//! Figures 9 and 10: settlement of the top plate over time.

use super::Figure;
use crate::{
    paper::{Interval, StudyView, bands, settlement_curve, text::number},
    record::{RunKind, RunRecord, SeriesRow},
    report::{
        ReportError,
        mean_settlement::SETTLEMENTS,
        plot::{Look, Plot},
        quality::found_in,
        style,
        table::{Table, table},
    },
};

pub(super) fn continuous(study: &StudyView) -> Result<Figure, ReportError> {
    let runs: Vec<&RunRecord> = study.of_kind(RunKind::VibrationContinuous).collect();
    let band = bands::FINAL_SETTLEMENT_MM;
    let (mut plot, table) = curves(&runs, 20.0);
    plot.add_band("Laboratory, range of the final settlement", (band.low, band.high));
    let caption = format!(
        "Settlement of the top plate under continuous vibration. Hatched: the laboratory's range of \
         the final settlement, {} to {} mm, as the text gives it; it belongs to the end of the \
         curves, for the plate could not be read during vibration. Thin and dashed: the mean \
         surface of the grains below the plate, which tilts on the highest grains and moves \
         differently. {}",
        band.low,
        band.high,
        finals(&runs)
    );
    let title = "Figure 9. Settlement of the top plate under continuous vibration";
    Figure::new("figure-09-continuous-vibration", title, caption, &[plot], &table)
}

pub(super) fn intermittent(study: &StudyView) -> Result<Figure, ReportError> {
    let runs: Vec<&RunRecord> = study.of_kind(RunKind::VibrationIntermittent).collect();
    let bounds = study.intermittent.bounds();
    let end = bounds.last().map_or(20.0, |b| b.1);
    let (mut plot, table) = curves(&runs, end);
    let mut edges: Vec<f64> = bounds.iter().flat_map(|b| [b.0, b.1]).collect();
    edges.dedup_by(|a, b| (*a - *b).abs() < 1e-9);
    plot.mark_upright("Start and end of a period", edges);
    let rest = number(study.intermittent.rest_s, 1);
    let caption = format!(
        "Settlement of the top plate under intermittent vibration: {} periods of {} s, with rests \
         of {rest} s between them (the length of the rests is ours). Dotted: start and end of each \
         period. Thin and dashed: the mean surface of the grains. The laboratory's range was a \
         grey area in the paper's figure, which was not available to us (only its text was); none is \
         drawn. {}",
        study.intermittent.periods,
        (study.intermittent.period_s * 100.0).round() / 100.0,
        finals(&runs)
    );
    let title = "Figure 10. Settlement of the top plate under intermittent vibration";
    Figure::new("figure-10-intermittent-vibration", title, caption, &[plot], &table)
}

/// The settlement of one run, for its own folder; `None` where it was not vibrated.
pub(super) fn of_run(run: &RunRecord) -> Result<Option<Figure>, ReportError> {
    if !run.series.iter().any(is_shaken) {
        return Ok(None);
    }
    let (plot, table) = curves(&[run], 0.0);
    let caption = format!("Settlement under vibration. {}", finals(&[run]));
    Figure::new("settlement", "Settlement under vibration", caption, &[plot], &table).map(Some)
}

/// Whether settlement is measured at a row.
fn is_shaken(row: &SeriesRow) -> bool {
    row.settlement_mm.is_some() || row.surface_settlement_mm.is_some()
}

/// Plate and surface of every run; `at_least_s` is the least length of the time axis.
fn curves(runs: &[&RunRecord], at_least_s: f64) -> (Plot, Table) {
    let mut plot = Plot::of_settlement();
    plot.x = plot.x.holding([at_least_s]);
    // An empty figure still has the laboratory's scale.
    plot.y = plot.y.holding(runs.is_empty().then_some(20.0));
    for (n, run) in runs.iter().enumerate() {
        let look = Look::spaced(n);
        let thin = look.dash(style::DASHED).thin().every(2.5 * style::MARKER_SPACING);
        plot.add("", thin, settlement_curve(run, |row| row.surface_settlement_mm));
        let mark = match (run.counts_in_means(), run.summary.valid) {
            (true, _) => "",
            (false, true) => " (left out)",
            (false, false) => " (not valid)",
        };
        let label = format!("Configuration {}, plate{mark}", run.configuration);
        plot.add(label, look, settlement_curve(run, |row| row.settlement_mm));
    }
    let shaken = runs.iter().flat_map(|run| {
        let rows = run.series.iter().filter(|r| is_shaken(r));
        let start = rows.clone().next().map_or(0.0, |r| r.time_s);
        rows.map(move |r| (run, r, r.time_s - start))
    });
    let table = table!(shaken, |(run, row, time)| {
        "run" => &run.name,
        "configuration" => run.configuration,
        "time_s" => time,
        "plate_settlement_mm" => row.settlement_mm,
        "surface_settlement_mm" => row.surface_settlement_mm,
        "left_out_of_means" => run.summary.why_left_out().join("; "),
    });
    plot.add_key_of_thin("Mean surface (same colours)");
    (plot, table)
}

/// The final settlements in a sentence.
fn finals(runs: &[&RunRecord]) -> String {
    let found = SETTLEMENTS.into_iter().filter_map(|(what, settlement)| {
        let counting = runs.iter().filter(|r| r.counts_in_means());
        let of = Interval::of(counting.filter_map(|r| Some(settlement(r)?.final_mm)))?;
        let (low, high) = (number(of.low, 1), number(of.high, 1));
        let shown = if low == high { low } else { format!("{low} to {high}") };
        Some(format!("of the {what}: {shown} mm"))
    });
    let found: Vec<String> = found.collect();
    let said = (!found.is_empty()).then(|| format!("Final settlement {}.", found.join("; ")));
    found_in(runs, said, "these numbers", "No such run was done.")
}
