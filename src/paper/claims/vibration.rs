//! Claims on vibration: section 4, Figures 8, 9 and 10.

use super::*;
use crate::paper::{
    bands::FINAL_SETTLEMENT_MM,
    constants::{FREQUENCY_HZ, MONITORING_INTERVAL_S},
    fluctuation::rms_about_running_mean,
    view::{shaken_curve, shaken_periods},
};

/// Time in s after a period's start and before its end that counts as "right
/// at the end and at the beginning". Ours: one and a half cycles.
const EDGE_S: f64 = 0.5;

pub(super) fn claims(study: &StudyView) -> Vec<Claim> {
    let mut claims = vec![denser(study), plate_down(study), placed_gently(study)];
    claims.extend(study.configurations().map(|c| final_settlement(study, c)));
    claims.extend(study.configurations().map(|c| share_after_5_s(study, c)));
    claims.push(fluctuation(study));
    claims.push(monitoring(study));
    claims.extend(study.configurations().map(|c| share_in_first_period(study, c)));
    claims.push(intermittent_range(study));
    claims.push(below_minimum(study));
    claims.push(edges(study));
    claims
}

fn vibrated<'a>(study: &'a StudyView) -> impl Iterator<Item = &'a RunRecord> {
    study.runs.iter().filter(|r| r.kind.is_vibration())
}

/// The plate's settlement curve until the shaking ends.
fn curve(run: &RunRecord) -> Vec<(f64, f64)> {
    shaken_curve(run, |r| r.settlement_mm)
}

/// "It changes by 1 to 2 mm." in the reader's numbers; empty without values.
fn between(
    what: &str,
    decimals: usize,
    unit: &str,
    values: impl IntoIterator<Item = f64>,
) -> String {
    Interval::of(values).map_or(String::new(), |i| {
        let (low, high) = (number(i.low, decimals), number(i.high, decimals));
        format!("{what} {low} to {high}{unit}.")
    })
}

/// A statement that every vibration run shows or not. `shows` is `None` where
/// the run does not tell.
fn every_run(study: &StudyView, draft: Draft, shows: impl Fn(&RunRecord) -> Option<bool>) -> Draft {
    let told: Vec<(&RunRecord, bool)> =
        vibrated(study).filter_map(|r| shows(r).map(|s| (r, s))).collect();
    let yes = told.iter().filter(|t| t.1).count();
    // Of a run that is left out nothing is expected, also where it does not tell.
    let left_out = study.left_out.iter().filter(|r| r.kind.is_vibration()).count();
    let expected = (2 * study.configurations as usize).saturating_sub(left_out);
    let missing = if told.is_empty() { 0 } else { expected.saturating_sub(told.len()) };
    let not_run = if missing > 0 { format!("Not run: {missing}.") } else { String::new() };
    // Where no run tells, all of them were run and do not; one that is left out is named as such.
    let is_named = |r: &&RunRecord| told.is_empty() || !r.counts_in_means() || shows(r).is_some();
    let runs: Vec<&RunRecord> = vibrated(study).filter(is_named).collect();
    draft
        .paper(&Stated::Count(expected))
        .ours((!told.is_empty()).then_some(yes as f64))
        .runs(runs)
        .missing(missing)
        .note(not_run)
}

fn denser(study: &StudyView) -> Claim {
    let before_after = |r: &RunRecord| Some((r.summary.poured_void_ratio?, r.summary.void_ratio?));
    let change = |r: &RunRecord| before_after(r).map(|(before, after)| after - before);
    let draft = Draft::of("denser-after-vibration");
    every_run(study, draft, |r| before_after(r).map(|(before, after)| after < before))
        .note(between("It changes by", 3, "", vibrated(study).filter_map(change)))
        .judge()
}

fn plate_down(study: &StudyView) -> Claim {
    let draft = Draft::of("plate-moves-down");
    let finals = vibrated(study).filter_map(|r| plate(r).map(|s| s.final_mm));
    every_run(study, draft, |r| plate(r).map(|s| s.final_mm > 0.0))
        .note(between("It settles by", 1, " mm", finals))
        .judge()
}

fn placed_gently(study: &StudyView) -> Claim {
    let drop = |r: &RunRecord| {
        let first = r.series.iter().find(|s| s.settlement_mm.is_some())?;
        Some(r.summary.poured_height_mm?.mean_surface - first.mean_surface_mm?)
    };
    let drops: Vec<f64> = vibrated(study).filter_map(drop).filter(|d| d.is_finite()).collect();
    Draft::of("plate-placed-without-settlement")
        .ours(drops.iter().copied().reduce(f64::max))
        .spread(drops)
        .runs(vibrated(study))
        .judge()
}

fn final_settlement(study: &StudyView, configuration: u32) -> Claim {
    let run = study.vibration(RunKind::VibrationContinuous, configuration);
    let note = |what: &str, value: Option<f64>, unit: &str| {
        value.map_or_else(String::new, |v| format!("{what} {} {unit}.", number(v, 1)))
    };
    let plate_moving = run.and_then(plate).and_then(|s| s.end_of_shaking);
    let surface = run.and_then(surface).map(|s| s.final_mm);
    let creep = run.and_then(|r| r.summary.creep_um_per_s);
    Draft::of_configuration("continuous-final-settlement", configuration)
        .ours(run.and_then(plate).map(|s| s.final_mm))
        .runs(run)
        .note(note("At the end of shaking it was", plate_moving, "mm"))
        .note(note("The mean surface of the grains settled by", surface, "mm"))
        .note(note("Numerical creep in the rest test:", creep, "µm/s"))
        .judge()
}

fn share_after_5_s(study: &StudyView, configuration: u32) -> Claim {
    let run = study.vibration(RunKind::VibrationContinuous, configuration);
    let share = run.and_then(plate).and_then(|s| s.share_after_5_s).map(|s| 100.0 * s);
    Draft::of_configuration("continuous-share-after-5-s", configuration)
        .ours(share)
        .runs(run)
        .judge()
}

fn share_in_first_period(study: &StudyView, configuration: u32) -> Claim {
    let run = study.vibration(RunKind::VibrationIntermittent, configuration);
    let share =
        run.and_then(plate).and_then(|s| share_percent(*s.after_each_period.first()?, s.final_mm));
    Draft::of_configuration("intermittent-share-in-first-period", configuration)
        .ours(share)
        .runs(run)
        .judge()
}

/// Fluctuation in mm of a run's plate while it is shaken.
fn run_fluctuation(run: &RunRecord) -> Option<f64> {
    let periods = shaken_periods(run);
    rms_about_running_mean(&curve(run), 1.0 / FREQUENCY_HZ, |t| {
        periods.iter().any(|&(a, b)| (a..=b).contains(&t))
    })
}

fn fluctuation(study: &StudyView) -> Claim {
    let all: Vec<f64> = vibrated(study).filter_map(run_fluctuation).collect();
    Draft::of("plate-fluctuates").ours(mean(&all)).spread(all).runs(vibrated(study)).judge()
}

fn monitoring(study: &StudyView) -> Claim {
    let interval = |r: &RunRecord| {
        let curve = curve(r);
        let (first, last) = (curve.first()?.0, curve.last()?.0);
        (curve.len() > 1).then(|| (last - first) / (curve.len() - 1) as f64)
    };
    let intervals: Vec<f64> = vibrated(study).filter_map(interval).collect();
    // The run furthest from the paper's interval speaks for all.
    let worst = intervals.iter().copied().max_by(|a, b| {
        (a - MONITORING_INTERVAL_S).abs().total_cmp(&(b - MONITORING_INTERVAL_S).abs())
    });
    Draft::of("plate-monitored-every-0.08-s")
        .ours(worst)
        .spread(intervals)
        .runs(vibrated(study))
        .judge()
}

fn finals<'a>(study: &'a StudyView) -> Vec<(&'a RunRecord, f64)> {
    let intermittent = study.of_kind(RunKind::VibrationIntermittent);
    let finals = intermittent.filter_map(|r| Some((r, plate(r)?.final_mm)));
    finals.filter(|f| f.1.is_finite()).collect()
}

fn intermittent_range(study: &StudyView) -> Claim {
    let finals = finals(study);
    let values: Vec<f64> = finals.iter().map(|f| f.1).collect();
    Draft::of("intermittent-in-laboratory-range")
        .ours(mean(&values))
        .spread(values)
        .runs(finals.iter().map(|f| f.0))
        .judge()
}

fn below_minimum(study: &StudyView) -> Claim {
    let minimum = FINAL_SETTLEMENT_MM.low;
    let finals = finals(study);
    let below: Vec<&(&RunRecord, f64)> = finals.iter().filter(|f| f.1 < minimum).collect();
    let in_words = |(r, s): &&(&RunRecord, f64)| {
        let percent = 100.0 * (1.0 - s / minimum);
        format!("{} % (configuration {})", number(percent, 0), r.configuration)
    };
    const ID: &str = "intermittent-case-below-minimum";
    let is_compared = why_not_comparable(study, ID).is_none();
    let by: Vec<String> = below.iter().filter(|_| is_compared).map(in_words).collect();
    Draft::of(ID)
        .ours((!finals.is_empty()).then_some(below.len() as f64))
        .runs(finals.iter().map(|f| f.0))
        .note(listed("They stay below it by", &by))
        .judge()
}

/// Fluctuation at the starts and ends of the periods over that in their middle.
pub(in crate::paper) fn edge_ratio(study: &StudyView, run: &RunRecord) -> Option<f64> {
    let bounds = study.intermittent.period_bounds();
    let curve = curve(run);
    let near = |t: f64| {
        bounds.iter().any(|&(a, b)| t - a <= EDGE_S && t >= a || b - t <= EDGE_S && t <= b)
    };
    let shaken = |t: f64| bounds.iter().any(|&(a, b)| (a..=b).contains(&t));
    let window = 1.0 / FREQUENCY_HZ;
    let edge = rms_about_running_mean(&curve, window, near)?;
    let middle = rms_about_running_mean(&curve, window, |t| shaken(t) && !near(t))?;
    (middle > 0.0).then(|| edge / middle)
}

fn edges(study: &StudyView) -> Claim {
    let intermittent = |r: &&RunRecord| r.kind == RunKind::VibrationIntermittent;
    let ratio = |r: &RunRecord| edge_ratio(study, r);
    let ratios: Vec<(&RunRecord, f64)> =
        study.runs.iter().filter(intermittent).filter_map(|r| Some((r, ratio(r)?))).collect();
    // Of a run that is left out nothing is expected, also where it does not tell.
    let left_out = study.left_out.iter().filter(intermittent).count();
    let expected = (study.configurations as usize).saturating_sub(left_out);
    let more: Vec<u32> = ratios.iter().filter(|r| r.1 > 1.0).map(|r| r.0.configuration).collect();
    let mut draft = Draft::of("intermittent-fluctuation-at-ends")
    .paper(&Stated::Count(expected))
    .ours((!ratios.is_empty()).then_some(more.len() as f64))
    .runs(study.of_kind(RunKind::VibrationIntermittent))
    .note(format!(
        "Counted are the runs whose fluctuation in the first and last {EDGE_S} s of the periods \
         exceeds that in their middle."
    ))
    .note(between("The ratio of the two is", 2, "", ratios.iter().map(|r| r.1)));
    if !more.is_empty() {
        draft = draft.note(format!("So in {}.", list(&more)));
    }
    draft.missing(expected.saturating_sub(ratios.len())).judge()
}
