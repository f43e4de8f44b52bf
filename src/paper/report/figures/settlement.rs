//! Figures 9 and 10: settlement of the top plate over time.

use crate::{
    paper::{StudyView, bands},
    record::{RunKind, RunRecord},
    report::{
        Figure, ReportError,
        figures::settlement::{curves, finals},
        text::number,
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
