//! Claims on vibration: section 4, Figures 8, 9 and 10.

use crate::paper::text::number;
use crate::paper::{
    Band, Claim, StudyView,
    bands::{self, Interval},
    claim::Draft,
    claims::list,
    constants::{FREQUENCY_HZ, MONITORING_INTERVAL_S, ONE_CASE_BELOW_MINIMUM_PERCENT},
    fluctuation::rms_about_running_mean,
    view::{shaken_curve, shaken_periods},
};
use crate::record::{RunKind, RunRecord, Settlement};

const CONTINUOUS: &str = "Section 4, Figure 9";
const INTERMITTENT: &str = "Section 4, Figure 10";

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

fn plate(run: &RunRecord) -> Option<&Settlement> {
    run.summary.settlement_mm.as_ref()
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
    // Of a run that is left out nothing is expected.
    let left_out =
        study.left_out.iter().filter(|r| r.kind.is_vibration() && shows(r).is_some()).count();
    let expected = (2 * study.configurations as usize).saturating_sub(left_out);
    let mut draft = draft
        .paper(Band::count(expected))
        .ours((!told.is_empty()).then_some(yes as f64), "vibration runs")
        .runs(told.iter().map(|t| t.0))
        .note("Expected is one continuous and one intermittent run of each configuration.");
    let missing = expected.saturating_sub(told.len());
    if !told.is_empty() && missing > 0 {
        draft = draft.missing(missing).note(format!("Not run: {missing}."));
    }
    draft
}

fn denser(study: &StudyView) -> Claim {
    let before_after = |r: &RunRecord| Some((r.summary.poured_void_ratio?, r.summary.void_ratio?));
    let change = |r: &RunRecord| before_after(r).map(|(before, after)| after - before);
    let draft = Draft::new(
        "denser-after-vibration",
        "Section 4, Figure 8",
        "A denser configuration of gravels is achieved after vibration.",
    );
    every_run(study, draft, |r| before_after(r).map(|(before, after)| after < before))
        .note("Density is read from the void ratio.")
        .note(between("It changes by", 3, "", vibrated(study).filter_map(change)))
        .judge()
}

fn plate_down(study: &StudyView) -> Claim {
    let draft = Draft::new(
        "plate-moves-down",
        "Section 4, Figure 8",
        "Downward displacement of the top plate is quite evident.",
    );
    let finals = vibrated(study).filter_map(|r| plate(r).map(|s| s.final_mm));
    every_run(study, draft, |r| plate(r).map(|s| s.final_mm > 0.0))
        .note(between("It settles by", 1, " mm", finals))
        .judge()
}

fn placed_gently(study: &StudyView) -> Claim {
    let drop = |r: &RunRecord| {
        let first = r.series.iter().find(|s| s.settlement_mm.is_some())?;
        Some(r.summary.poured_height_mm?.mean_surface - first.mean_surface_mm)
    };
    let drops: Vec<f64> = vibrated(study).filter_map(drop).filter(|d| d.is_finite()).collect();
    Draft::new(
        "plate-placed-without-settlement",
        "Section 3",
        "The top plate falls slowly on the gravels to avoid dynamic effects and extra settlement.",
    )
    .ours(drops.iter().copied().reduce(f64::max), "mm")
    .spread(drops)
    .runs(vibrated(study))
    .note(
        "Ours is the largest drop of the mean surface from the end of pouring to the beginning of \
         vibration.",
    )
    .judge()
}

fn final_settlement(study: &StudyView, configuration: u32) -> Claim {
    let run = study.vibration(RunKind::VibrationContinuous, configuration);
    let mut draft = Draft::new(
        format!("continuous-final-settlement-{configuration}"),
        CONTINUOUS,
        format!(
            "After 20 s of continuous vibration the top plate has settled by 14 to 19.61 mm \
             (configuration {configuration})."
        ),
    )
    .paper(bands::final_settlement_mm())
    .ours(run.and_then(plate).map(|s| s.final_mm), "mm")
    .runs(run)
    .full_size()
    .note("The range is that of the laboratory tests. Ours is read at rest after the vibration.");
    if let Some(moving) = run.and_then(plate).and_then(|s| s.end_of_shaking) {
        draft = draft.note(format!("At the end of shaking it was {} mm.", number(moving, 1)));
    }
    if let Some(surface) = run.and_then(|r| r.summary.surface_settlement_mm.as_ref()) {
        draft = draft.note(format!(
            "The mean surface of the grains settled by {} mm.",
            number(surface.final_mm, 1)
        ));
    }
    if let Some(creep) = run.and_then(|r| r.summary.creep_um_per_s) {
        draft = draft.note(format!("Creep of the rest test: {} µm/s.", number(creep, 1)));
    }
    draft.judge()
}

fn share_after_5_s(study: &StudyView, configuration: u32) -> Claim {
    let run = study.vibration(RunKind::VibrationContinuous, configuration);
    let share = run.and_then(plate).and_then(|s| s.share_after_5_s).map(|s| 100.0 * s);
    Draft::new(
        format!("continuous-share-after-5-s-{configuration}"),
        CONTINUOUS,
        format!(
            "About 80 % of the settlement occurs in the first five seconds of vibration \
             (configuration {configuration})."
        ),
    )
    .paper(bands::share_after_5_s_percent())
    .ours(share, "% of the final settlement")
    .runs(run)
    .full_size()
    .judge()
}

fn share_in_first_period(study: &StudyView, configuration: u32) -> Claim {
    let run = study.vibration(RunKind::VibrationIntermittent, configuration);
    let share = run.and_then(plate).and_then(|s| {
        let first = s.after_each_period.first()?;
        (s.final_mm != 0.0).then(|| 100.0 * first / s.final_mm)
    });
    Draft::new(
        format!("intermittent-share-in-first-period-{configuration}"),
        INTERMITTENT,
        format!(
            "Around 85 % of the total settlement occurs in the first vibration period \
             (configuration {configuration})."
        ),
    )
    .paper(bands::share_in_first_period_percent())
    .ours(share, "% of the final settlement")
    .runs(run)
    .full_size()
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
    let mean = (!all.is_empty()).then(|| all.iter().sum::<f64>() / all.len() as f64);
    Draft::new(
        "plate-fluctuates",
        CONTINUOUS,
        "The position of the top plate fluctuates during vibration; the fluctuation differs with \
         the interlock of the gravels.",
    )
    .ours(mean, "mm")
    .spread(all)
    .runs(vibrated(study))
    .note(
        "Root mean square deviation of the plate from its running mean over one cycle (1/3 s) \
         while shaken; mean and spread over the runs.",
    )
    .judge()
}

fn monitoring(study: &StudyView) -> Claim {
    let intervals: Vec<f64> = vibrated(study)
        .filter_map(|r| {
            let curve = curve(r);
            let (first, last) = (curve.first()?.0, curve.last()?.0);
            (curve.len() > 1).then(|| (last - first) / (curve.len() - 1) as f64)
        })
        .collect();
    // The run furthest from the paper's interval speaks for all.
    let worst = intervals.iter().copied().max_by(|a, b| {
        (a - MONITORING_INTERVAL_S).abs().total_cmp(&(b - MONITORING_INTERVAL_S).abs())
    });
    Draft::new(
        "plate-monitored-every-0.08-s",
        CONTINUOUS,
        "In the simulations the position of the top plate was monitored every 0.08 seconds.",
    )
    .paper(bands::monitoring_interval_s())
    .ours(worst, "s")
    .spread(intervals)
    .runs(vibrated(study))
    .note("Mean interval between rows of the series, of the run furthest from 0.08 s.")
    .input()
    .judge()
}

fn finals<'a>(study: &'a StudyView) -> Vec<(&'a RunRecord, f64)> {
    study
        .of_kind(RunKind::VibrationIntermittent)
        .filter_map(|r| plate(r).map(|s| (r, s.final_mm)))
        .filter(|f| f.1.is_finite())
        .collect()
}

fn intermittent_range(study: &StudyView) -> Claim {
    let finals = finals(study);
    let mean =
        (!finals.is_empty()).then(|| finals.iter().map(|f| f.1).sum::<f64>() / finals.len() as f64);
    Draft::new(
        "intermittent-in-laboratory-range",
        INTERMITTENT,
        "The simulated settlement under intermittent vibration conforms well to the laboratory \
         data, except for one case.",
    )
    .ours(mean, "mm")
    .spread(finals.iter().map(|f| f.1))
    .runs(finals.iter().map(|f| f.0))
    .note(
        "The laboratory's range stood in Figure 10 alone, which was not available to us (only the \
         paper's text was); ours is the mean and range of the final settlement.",
    )
    .judge()
}

fn below_minimum(study: &StudyView) -> Claim {
    let minimum = bands::final_settlement_mm().read_as.low;
    let finals = finals(study);
    let below: Vec<&(&RunRecord, f64)> = finals.iter().filter(|f| f.1 < minimum).collect();
    let by: Vec<String> = below
        .iter()
        .map(|(r, s)| {
            let percent = 100.0 * (1.0 - s / minimum);
            format!("{} % (configuration {})", number(percent, 0), r.configuration)
        })
        .collect();
    let mut draft = Draft::new(
        "intermittent-case-below-minimum",
        INTERMITTENT,
        format!(
            "In one simulated case the settlement is {ONE_CASE_BELOW_MINIMUM_PERCENT} % less than \
             the minimum of the laboratory results."
        ),
    )
    .ours((!finals.is_empty()).then_some(below.len() as f64), "cases below 14 mm")
    .runs(finals.iter().map(|f| f.0))
    .note(
        "That minimum stood in Figure 10 alone, which was not available to us (only the paper's text \
         was). For comparison only, ours counts the cases below the 14 mm of continuous vibration.",
    );
    if !by.is_empty() {
        draft = draft.note(format!("They stay below it by {}.", by.join(", ")));
    }
    draft.judge()
}

/// Fluctuation at the starts and ends of the periods over that in their middle.
fn edge_ratio(study: &StudyView, run: &RunRecord) -> Option<f64> {
    let bounds = study.intermittent.bounds();
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
    let ratios: Vec<(&RunRecord, f64)> = study
        .of_kind(RunKind::VibrationIntermittent)
        .filter_map(|r| edge_ratio(study, r).map(|x| (r, x)))
        .collect();
    // Of a run that is left out nothing is expected.
    let left_out = study
        .left_out
        .iter()
        .filter(|r| r.kind == RunKind::VibrationIntermittent && edge_ratio(study, r).is_some())
        .count();
    let expected = (study.configurations as usize).saturating_sub(left_out);
    let more: Vec<u32> = ratios.iter().filter(|r| r.1 > 1.0).map(|r| r.0.configuration).collect();
    let mut draft = Draft::new(
        "intermittent-fluctuation-at-ends",
        INTERMITTENT,
        "Major fluctuations of the plate occur right at the end and at the beginning of each \
         vibration period.",
    )
    .paper(Band::count(expected))
    .ours((!ratios.is_empty()).then_some(more.len() as f64), "configurations")
    .runs(study.of_kind(RunKind::VibrationIntermittent))
    .note(format!(
        "Counted are the runs whose fluctuation in the first and last {EDGE_S} s of the periods \
         exceeds that in their middle."
    ))
    .note(between("The ratio of the two is", 2, "", ratios.iter().map(|r| r.1)));
    if !more.is_empty() {
        draft = draft.note(format!("So in {}.", list(&more)));
    }
    draft.missing(expected.saturating_sub(ratios.len())).full_size().judge()
}
