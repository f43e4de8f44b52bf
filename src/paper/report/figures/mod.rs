//! The paper's figures, drawn from our runs, and those that show how far the runs can be trusted.

mod headline;
mod heights;
mod interpretations;
mod quality;
mod settlement;
mod sizes;

use super::*;
use crate::paper::claims::why_not_comparable;
use crate::record::AngleOfRepose;
use crate::report::figures::{by_azimuth, grains::of_shapes};

pub(super) use headline::figure as headline;
pub(super) use interpretations::of_interpretations;

/// Why the quick study has no range of the laboratory beside its settlements.
const NO_RANGE_OF_QUICK: &str = "The laboratory's range is not drawn: the quick study's specimen is \
                                 smaller, and shaken for less time.";

/// Why a study has no range of the laboratory beside its settlements; none where it has.
fn no_range(study: &StudyView) -> Option<String> {
    if study.quick {
        return Some(NO_RANGE_OF_QUICK.to_owned());
    }
    let why = why_not_comparable(study, "continuous-")?;
    Some(format!("The laboratory's range is not drawn: {why}."))
}

/// The figures of a study, in the order of the paper.
pub(super) fn of_study(study: &StudyView, standard: &Standard) -> Result<Vec<Figure>, ReportError> {
    let mut figures = vec![
        sizes::figure(study)?,
        of_shapes(&study.shapes)?,
        heights::over_falling_height(study)?,
    ];
    figures.extend(heights::with_confidence(study)?);
    figures.extend([
        settlement::continuous(study)?,
        settlement::intermittent(study)?,
        quality::creep(study, standard)?,
        quality::overlap(study, standard)?,
    ]);
    let piles = study.of_kind(RunKind::Repose);
    let piles: Vec<(&str, &AngleOfRepose)> = piles
        .filter_map(|r| Some((r.name.as_str(), r.summary.angle_of_repose.as_ref()?)))
        .collect();
    if !piles.is_empty() {
        figures.push(by_azimuth(&piles)?);
    }
    Ok(figures)
}
