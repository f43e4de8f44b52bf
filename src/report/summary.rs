//! The result in one paragraph, made from the claims and runs.

use super::ReportInput;
use crate::{
    paper::{Claim, Interval, StudyView, Verdict, bands, text::number},
    record::{RunKind, RunRecord, Settlement, left_out_in_words},
};

/// The first paragraph of the report.
pub(super) fn paragraph(input: &ReportInput) -> String {
    let study = &input.study;
    let (runs, left_out) = study.split();
    let counting = &study.of_runs(&runs, &left_out);
    if study.runs.is_empty() {
        return "No run is finished yet; only what needs no run is shown.".to_owned();
    }
    let mut sentences: Vec<String> = Vec::new();
    sentences.extend(falling(input.claims));
    sentences.extend(settling(counting));
    sentences.extend(shares(counting));
    sentences.push(standard(study));
    let said = left_out_in_words(left_out.len(), study.runs.len());
    if !said.is_empty() {
        sentences.push(format!("{said}, ranges and claims, being not valid or short of grains."));
    }
    sentences.push(tally(input.claims));
    sentences.join(" ")
}

fn find<'a>(claims: &'a [Claim], id: &str) -> Option<&'a Claim> {
    claims.iter().find(|c| c.id == id)
}

fn falling(claims: &[Claim]) -> Option<String> {
    let claim = find(claims, "standing-height-falls")?;
    let (count, expected) = (claim.ours?, claim.read_as?.high);
    let slope = find(claims, "standing-height-slope")
        .and_then(|c| c.ours)
        .map(|s| format!(", by {} mm per cm of falling height on average", number(-s, 2)))
        .unwrap_or_default();
    Some(format!(
        "In {} of {} configurations the gravel stands lower when it falls from 20 cm than from 0\
         {slope}.",
        number(count, 0),
        number(expected, 0)
    ))
}

fn range_mm(values: impl IntoIterator<Item = f64>) -> Option<String> {
    Interval::of(values).map(|i| {
        let (low, high) = (number(i.low, 1), number(i.high, 1));
        if low == high { format!("{low} mm") } else { format!("{low} to {high} mm") }
    })
}

fn settlements<'a>(
    study: &'a StudyView,
    kind: RunKind,
) -> impl Iterator<Item = (&'a RunRecord, &'a Settlement)> {
    study.of_kind(kind).filter_map(|r| Some((r, r.summary.settlement_mm.as_ref()?)))
}

fn settling(study: &StudyView) -> Option<String> {
    let finals: Vec<f64> =
        settlements(study, RunKind::VibrationContinuous).map(|s| s.1.final_mm).collect();
    let band = bands::final_settlement_mm().read_as;
    let within = finals.iter().filter(|f| band.contains(**f)).count();
    let surface = range_mm(
        study
            .of_kind(RunKind::VibrationContinuous)
            .filter_map(|r| r.summary.surface_settlement_mm.as_ref())
            .map(|s| s.final_mm),
    )
    .map(|r| format!(" (the surface below it by {r})"))
    .unwrap_or_default();
    Some(format!(
        "Under continuous vibration the top plate settles by {}{surface}; the laboratory found {} \
         to {} mm, and {within} of {} runs end in that range.",
        range_mm(finals.iter().copied())?,
        band.low,
        band.high,
        finals.len()
    ))
}

fn shares(study: &StudyView) -> Option<String> {
    let percent = |values: Vec<f64>| {
        Interval::of(values).map(|i| {
            let (low, high) = (number(100.0 * i.low, 0), number(100.0 * i.high, 0));
            if low == high { format!("{low} %") } else { format!("{low} to {high} %") }
        })
    };
    let continuous = percent(
        settlements(study, RunKind::VibrationContinuous)
            .filter_map(|s| s.1.share_after_5_s)
            .collect(),
    );
    let intermittent = percent(
        settlements(study, RunKind::VibrationIntermittent)
            .filter_map(|s| Some(s.1.after_each_period.first()? / s.1.final_mm))
            .collect(),
    );
    match (continuous, intermittent) {
        (Some(c), Some(i)) => Some(format!(
            "Of the settlement, {c} happen in the first 5 s of continuous vibration (paper: about \
             80 %) and {i} in the first period of intermittent vibration (about 85 %)."
        )),
        (Some(c), None) => Some(format!(
            "Of the settlement, {c} happen in the first 5 s of continuous vibration (paper: about \
             80 %)."
        )),
        (None, Some(i)) => Some(format!(
            "Of the settlement, {i} happen in the first period of intermittent vibration (paper: \
             about 85 %)."
        )),
        (None, None) => None,
    }
}

fn standard(study: &StudyView) -> String {
    let met = study.runs.iter().filter(|r| r.summary.meets_standard).count();
    let all = study.runs.len();
    if met == all {
        return format!("All {all} runs meet the accuracy standard for overlap and creep.");
    }
    format!(
        "{met} of {all} runs meet the accuracy standard for overlap and creep; agreement of the \
         others proves little, because grains that sink into each other settle too."
    )
}

fn tally(claims: &[Claim]) -> String {
    let count = |v| claims.iter().filter(|c| c.verdict == v).count();
    format!(
        "Of the {} statements checked, {} are met, {} are not (or were not run), {} cannot be compared, no \
         run that would show them being valid, and {} have no number in the text to be held against.",
        claims.len(),
        count(Verdict::Within),
        count(Verdict::Outside),
        count(Verdict::NotComparable),
        count(Verdict::NotStated)
    )
}
