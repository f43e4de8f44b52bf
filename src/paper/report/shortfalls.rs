//! What falls short, said from the data.

use super::sections::paper_value;
use super::*;
use crate::paper::uncertainty::{MODES, settlements};
use crate::record::left_out_with_reasons;
use crate::report::with_unit;

/// One sentence or two a shortfall; never empty, for the paper's figures are
/// never available.
pub(super) fn list(input: &ReportInput) -> Vec<String> {
    let study = &input.study;
    let mut found = Vec::new();
    found.extend(missing(study));
    found.extend(claims_missed(input));
    found.extend(left_out(study));
    found.extend(creep(study, &input.standard));
    found.extend(creep_beside_settlement(study));
    found.extend(overlap(study, &input.standard));
    found.extend(grains_lost(study));
    found.extend(plate_and_surface(study));
    found.push(
        "The paper's figures were not available to us (only its text was). Its laboratory ranges of \
         the standing height (Figure 7) and of the intermittent settlement (Figure 10), its sieve \
         curve and its funnel are therefore not compared with anything; the claims that need them \
         read “not stated”."
            .to_owned(),
    );
    found
}

fn names(runs: &[&RunRecord]) -> String {
    const MOST: usize = 6;
    let mut names: Vec<&str> = runs.iter().take(MOST).map(|r| r.name.as_str()).collect();
    let more = format!("{} more", runs.len().saturating_sub(MOST));
    if runs.len() > MOST {
        names.push(&more);
    }
    names.join(", ")
}

fn missing(study: &StudyView) -> Option<String> {
    let heights =
        if study.quick { study.falling_heights_mm() } else { FALLING_HEIGHTS_MM.to_vec() };
    let mut missing = Vec::new();
    for c in study.configurations() {
        for &fh in &heights {
            if study.pluviation(c, fh).is_none() {
                let fh = number(fh / 10.0, 0);
                missing.push(format!("pluviation from {fh} cm (configuration {c})"));
            }
        }
        for (kind, name) in MODES {
            if study.vibration(kind, c).is_none() {
                missing.push(format!("{name} vibration (configuration {c})"));
            }
        }
    }
    (!missing.is_empty()).then(|| format!("Not run: {}.", missing.join("; ")))
}

fn claims_missed(input: &ReportInput) -> Vec<String> {
    input
        .claims
        .iter()
        .filter(|c| c.verdict == Verdict::Outside)
        .filter_map(|c| {
            let ours = with_unit(&compact(c.ours?), &c.unit);
            let expected = match c.read_as {
                Some(band) if band.low < band.high => from_to(band.low, band.high),
                Some(band) => compact(band.low),
                // The angle of repose has no band.
                None => paper_value(c)?,
            };
            let statement = c.statement.trim_end_matches('.');
            Some(format!("{statement}: expected {expected}, found {ours}."))
        })
        .collect()
}

/// Which runs are left out of means, each with why.
fn left_out(study: &StudyView) -> Option<String> {
    let named = study.runs.iter().map(|r| (r.name.as_str(), &r.summary));
    let each = left_out_with_reasons(named);
    left_out_in_words(each.len(), study.runs.len())
        .map(|said| format!("{said}, ranges and claims: {}.", each.join(", ")))
}

fn creep(study: &StudyView, standard: &Standard) -> Vec<String> {
    let mut found = Vec::new();
    let without: Vec<&RunRecord> =
        study.runs.iter().filter(|r| r.summary.creep_um_per_s.is_none()).collect();
    if !without.is_empty() {
        found.push(format!(
            "Without a rest test, and so without a measure of numerical creep: {}.",
            names(&without)
        ));
    }
    let limit = standard.creep_um_per_s;
    let of = |r: &RunRecord| r.summary.creep_um_per_s.unwrap_or(0.0);
    // Written so that NaN counts as too much.
    let beyond: Vec<&RunRecord> = study.runs.iter().filter(|r| !(of(r).abs() < limit)).collect();
    if let Some(worst) = beyond.iter().max_by(|a, b| of(a).abs().total_cmp(&of(b).abs())) {
        found.push(format!(
            "{} of {} runs have numerical creep beyond the standard of {limit} µm/s ({} in 20 s): {}; \
             the worst is {} with {} µm/s.",
            beyond.len(),
            study.runs.len(),
            format_args!("{} mm", number(20e-3 * limit, 1)),
            names(&beyond),
            worst.name,
            number(of(worst), 1),
        ));
    }
    found
}

fn creep_beside_settlement(study: &StudyView) -> Option<String> {
    let shares = settlements(study).into_iter().filter_map(|run| {
        // A specimen that rises at rest is as far from its settlement as one that sinks.
        let (creep_mm, plate_mm) = (run.creep_over_vibration_mm?.abs(), run.plate_mm?);
        let percent = 100.0 * creep_mm / plate_mm.abs();
        percent.is_finite().then_some((percent, creep_mm, plate_mm, run.run))
    });
    let (percent, creep_mm, plate_mm, run) = shares.max_by(|a, b| a.0.total_cmp(&b.0))?;
    let plate_mm = number(plate_mm, 2);
    let share = if creep_mm < 5e-4 {
        format!("{} mm of {plate_mm} mm", thousandths(creep_mm))
    } else {
        format!("at most {} mm of {plate_mm} mm, {} %", thousandths(creep_mm), number(percent, 2))
    };
    Some(format!(
        "How much of the settlement could be numerical creep: {share}, in {run} (that of the resting \
         specimen, up or down, times the length of the vibration). Under vibration it may be \
         larger than at rest; no rest test shows that."
    ))
}

fn overlap(study: &StudyView, standard: &Standard) -> Option<String> {
    let beyond: Vec<&RunRecord> = study
        .runs
        .iter()
        .filter(|r| {
            let o = &r.summary.overlap;
            let is_met = o.mean_percent < standard.overlap_mean_percent
                && o.p99_percent < standard.overlap_p99_percent;
            // Without grains nothing overlaps.
            !(o.mean_percent.is_nan() || is_met)
        })
        .collect();
    let of = |r: &RunRecord| r.summary.overlap;
    let worst = beyond.iter().max_by(|a, b| of(a).p99_percent.total_cmp(&of(b).p99_percent))?;
    let o = of(worst);
    Some(format!(
        "{} of {} runs overlap beyond the standard (mean {} %, 99th percentile {} %): {}; the \
         worst is {} with {} % and {} %, at most {} mm.",
        beyond.len(),
        study.runs.len(),
        standard.overlap_mean_percent,
        standard.overlap_p99_percent,
        names(&beyond),
        worst.name,
        number(o.mean_percent, 2),
        number(o.p99_percent, 2),
        number(o.max_mm, 2),
    ))
}

fn grains_lost(study: &StudyView) -> Vec<String> {
    let total = |of: fn(&RunRecord) -> usize| {
        let runs: Vec<&RunRecord> = study.runs.iter().filter(|r| of(r) > 0).collect();
        let grains = counted(runs.iter().map(|r| of(r)).sum::<usize>(), "grain");
        (!runs.is_empty()).then_some((grains, runs))
    };
    let lacking = |fate: &str, (grains, runs): (String, Vec<&RunRecord>)| {
        let lost =
            runs.iter().map(|r| r.summary.grains.mass_g - r.summary.grains.mass_in_cylinder_g);
        format!(
            "{grains} {fate} ({} of {}); a cylinder lacks at most {} g of its grains. Void ratios \
             count only what is in the cylinder.",
            runs.len(),
            counted(study.runs.len(), "run"),
            number(lost.fold(0.0, f64::max), 1)
        )
    };
    let escaped = total(|r| r.summary.grains.escaped).map(|(grains, runs)| {
        let runs = names(&runs);
        format!("{grains} passed through a wall or the floor, which no grain should: {runs}.")
    });
    // What rolls off a pile's base is no loss of a cylinder's.
    let spilled = total(|r| if r.kind == RunKind::Repose { 0 } else { r.summary.grains.spilled });
    let spilled = spilled.map(|lost| lacking("fell over the rim", lost));
    let left = total(|r| r.summary.grains.left_in_funnel);
    let left = left.map(|lost| lacking("stayed in the funnel", lost));
    [escaped, spilled, left].into_iter().flatten().collect()
}

/// The two ways to read a settlement differ; by how much.
fn plate_and_surface(study: &StudyView) -> Option<String> {
    let difference = |r: &RunRecord| {
        let s = &r.summary;
        let (plate, surface) = (s.settlement_mm.as_ref()?, s.surface_settlement_mm.as_ref()?);
        Some(plate.final_mm - surface.final_mm).filter(|d| d.is_finite())
    };
    let (run, largest) = study
        .runs
        .iter()
        .filter_map(|r| Some((r, difference(r)?)))
        .max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))?;
    Some(format!(
        "The plate's settlement and that of the mean surface differ by up to {} mm ({}): the plate \
         rests tilted on the highest grains, so that how it was laid down moves its settlement.",
        number(largest.abs(), 1),
        run.name
    ))
}
