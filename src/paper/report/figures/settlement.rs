//! Figures 9 and 10: settlement of the top plate over time.

use super::*;
use crate::report::figures::settlement::{curves, finals};

pub(super) fn continuous(study: &StudyView) -> Result<Figure, ReportError> {
    let runs: Vec<&RunRecord> = study.of_kind(RunKind::VibrationContinuous).collect();
    let band = bands::FINAL_SETTLEMENT_MM;
    // The quick study ends long before the paper's; an empty figure still has the paper's scale.
    let at_least_s = if study.quick && !runs.is_empty() { 0.0 } else { CONTINUOUS_S };
    let (mut plot, table) = curves(&runs, at_least_s);
    let laboratory = if let Some(why) = no_range(study) {
        why
    } else {
        plot.add_band("Laboratory, range of the final settlement", (band.low, band.high));
        format!(
            "Hatched: the laboratory's range of the final settlement, {} to {} mm, as the text gives \
             it; it belongs to the end of the curves, for the plate could not be read during \
             vibration.",
            band.low, band.high
        )
    };
    let caption = format!(
        "Settlement of the top plate under continuous vibration. {laboratory} Thin and dashed: the \
         mean surface of the grains below the plate, which tilts on the highest grains and moves \
         differently. {}",
        finals(&runs)
    );
    let title = "Figure 9. Settlement of the top plate under continuous vibration";
    Figure::new("figure-09-continuous-vibration", title, caption, &[plot], &table)
}

pub(super) fn intermittent(study: &StudyView) -> Result<Figure, ReportError> {
    let runs: Vec<&RunRecord> = study.of_kind(RunKind::VibrationIntermittent).collect();
    let bounds = study.intermittent.period_bounds();
    let end = bounds.last().map_or(20.0, |b| b.1);
    let (mut plot, table) = curves(&runs, end);
    let mut edges: Vec<f64> = bounds.iter().flat_map(|b| [b.0, b.1]).collect();
    edges.dedup_by(|a, b| (*a - *b).abs() < 1e-9);
    plot.mark_upright("Start and end of a period", edges);
    let hundredths = |seconds: f64| without_zeros(&number(seconds, 2)).to_owned();
    let caption = format!(
        "Settlement of the top plate under intermittent vibration: {} periods of {} s, with rests \
         of {} s between them (the length of the rests is ours). Dotted: start and end of each \
         period. Thin and dashed: the mean surface of the grains. The laboratory's range was a \
         grey area in the paper's figure, which was not available to us (only its text was); none is \
         drawn. {}",
        study.intermittent.periods,
        hundredths(study.intermittent.duration),
        hundredths(study.intermittent.rest),
        finals(&runs)
    );
    let title = "Figure 10. Settlement of the top plate under intermittent vibration";
    Figure::new("figure-10-intermittent-vibration", title, caption, &[plot], &table)
}
