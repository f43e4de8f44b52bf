//! How sure the study's numbers are: intervals over the configurations, whether the standing height
//! falls with the falling height, and what the laboratory's scatter is known to be.

mod placements;
#[cfg(test)]
mod tests;

pub use placements::{PlacementScatter, SpecimenPlacements};
pub(super) use placements::{SETTLEMENT_OF_PLATE, SHARE_AFTER_5_S, scatter as placement_scatter};

use super::view::is_poured_from;
use super::*;
use crate::measure::{
    inference::{page_test, values_needed},
    statistics::least_squares_slope,
};
use crate::report::settlement::SETTLEMENTS;

/// Confidence of every interval and test.
pub const CONFIDENCE: f64 = 0.95;
/// Probability with which the configurations asked for would find the trend.
pub const POWER: f64 = 0.8;

/// `uncertainty.json`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Uncertainty {
    /// Confidence of every interval.
    pub confidence: f64,
    /// What was measured in every configuration.
    pub quantities: Vec<Quantity>,
    /// Whether the standing height falls with the falling height.
    pub trend: Trend,
    /// The settlements, each with its own numerical creep beside it. It is never subtracted.
    pub settlements: Vec<SettledRun>,
    /// Scatter of specimens and of placements of the plate, told apart; empty where the plate
    /// was laid once.
    pub placements: Vec<PlacementScatter>,
    /// What is known of the laboratory's scatter.
    pub laboratory: Vec<LaboratoryScatter>,
}

/// One quantity over the configurations.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Quantity {
    /// What was measured.
    pub name: String,
    /// Unit of its values.
    pub unit: String,
    /// Falling height in mm, where grains were poured for it.
    pub falling_height_mm: Option<f64>,
    /// One value a configuration.
    pub values: Vec<f64>,
    /// The runs they are from.
    pub runs: Vec<String>,
    /// Runs that have it and are left out, as they do not count in means.
    pub left_out: Vec<String>,
    /// Their mean; null without any.
    pub mean: Option<f64>,
    /// Smallest and largest.
    pub range: Option<Interval>,
    /// Standard deviation of a single configuration; null of fewer than two.
    pub standard_deviation: Option<f64>,
    /// Confidence interval of the mean, by Student's t; null of fewer than two.
    pub interval: Option<Interval>,
    /// Why there is no interval, or what to mind; empty where nothing is.
    pub note: String,
}

/// Tests of the fall of standing height with falling height.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Trend {
    /// Least squares slope of each configuration, in mm per cm.
    pub slopes_mm_per_cm: Vec<f64>,
    /// The configurations they are of: those poured from every height.
    pub configurations: Vec<u32>,
    /// Configurations that are left out, not every run of theirs counting.
    pub left_out: Vec<u32>,
    /// Mean slope and its interval, in mm per cm.
    pub slope: Option<SlopeTest>,
    /// Page's trend test by ranks.
    pub page: Option<RankTest>,
    /// Configurations with which a t-test at the confidence finds the measured
    /// slope with a probability of 80 %, were the measured scatter the true one;
    /// null of fewer than three configurations.
    pub configurations_needed: Option<usize>,
    /// The result in words.
    pub verdict: String,
}

/// One-sample t-test of the slopes.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct SlopeTest {
    /// Mean slope in mm per cm.
    pub mean_mm_per_cm: f64,
    /// Its confidence interval.
    pub interval: Interval,
    /// Student's t; null where the slopes do not differ at all.
    pub t: Option<f64>,
    /// Degrees of freedom.
    pub freedom: f64,
    /// Two-sided p-value of no slope.
    pub p: f64,
}

/// Page's test.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct RankTest {
    /// Page's L, with the heights from the highest fall to the lowest.
    pub l: f64,
    /// Configurations.
    pub configurations: usize,
    /// Falling heights.
    pub heights: usize,
    /// Exact one-sided p-value of no fall.
    pub p: f64,
}

/// A settlement with what the specimen sinks at rest by itself.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SettledRun {
    /// Name of the run.
    pub run: String,
    /// Why it is left out of the intervals; empty where it counts.
    pub left_out_of_means: Vec<String>,
    /// Settlement of the plate at the end, in mm.
    pub plate_mm: Option<f64>,
    /// Of the mean surface.
    pub surface_mm: Option<f64>,
    /// Numerical creep in the rest test in µm/s; null where none was run.
    pub creep_um_per_s: Option<f64>,
    /// That numerical creep over as long as the vibration took, in mm.
    pub creep_over_vibration_mm: Option<f64>,
    /// Drop of the plate in the whole rest test, in mm.
    pub rest_test_plate_drop_mm: Option<f64>,
    /// Length of the rest test in s.
    pub rest_test_s: Option<f64>,
}

/// What the paper's text says of the laboratory's scatter.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LaboratoryScatter {
    /// What was measured.
    pub quantity: String,
    /// The range that the text states; null where it states none.
    pub stated_range: Option<Interval>,
    /// Ours, smallest and largest over the configurations.
    pub ours: Option<Interval>,
    /// Unit of both.
    pub unit: String,
    /// What is known and what is not.
    pub note: String,
}

impl Quantity {
    /// Of the runs of a view that have it; those that it leaves out are counted.
    fn of(
        name: String,
        unit: &str,
        falling_height_mm: Option<f64>,
        study: &StudyView,
        value: &dyn Fn(&RunRecord) -> Option<f64>,
    ) -> Self {
        let measured = |runs: &[RunRecord]| -> Vec<(String, f64)> {
            let of = |r: &RunRecord| Some((r.name.clone(), value(r).filter(|v| v.is_finite())?));
            runs.iter().filter_map(of).collect()
        };
        let (runs, values): (Vec<String>, Vec<f64>) = measured(study.runs).into_iter().unzip();
        let left_out: Vec<String> = measured(study.left_out).into_iter().map(|m| m.0).collect();
        let test = MeanTest::of(&values, CONFIDENCE);
        let mut note = match values.len() {
            0 if !left_out.is_empty() => "No valid run.",
            0 => "Not measured.",
            1 => "One configuration: no interval can be given.",
            2 => "Two configurations: the interval is t = 12.7 standard errors to either side.",
            _ => "",
        }
        .to_owned();
        if !left_out.is_empty() {
            let space = if note.is_empty() { "" } else { " " };
            note += &format!("{space}Left out: {}.", left_out.join(", "));
        }
        Self {
            name,
            unit: unit.to_owned(),
            falling_height_mm,
            mean: mean(&values),
            range: Interval::of(values.iter().copied()),
            standard_deviation: test.map(|t| t.standard_deviation),
            interval: test.map(|t| Interval::around(t.estimate.mean, t.half_width)),
            values,
            runs,
            left_out,
            note,
        }
    }
}

/// The uncertainty of a study, of the runs that count in means.
pub fn uncertainty(all: &StudyView) -> Uncertainty {
    let (counting, others) = all.split();
    let study = &all.of_runs(&counting, &others);
    let mut quantities = Vec::new();
    for fh in study.falling_heights_mm() {
        let name = format!("standing height from {} cm", number(fh / MM_IN_CM, 0));
        let height = |r: &RunRecord| is_poured_from(r, fh).then(|| height_mm(r));
        quantities.push(Quantity::of(name, "mm", Some(fh), study, &height));
    }
    for (kind, mode) in MODES {
        for (what, settlement) in SETTLEMENTS {
            let continuous = kind == RunKind::VibrationContinuous;
            let early = |s: &Settlement| {
                if continuous { s.after_5_s } else { s.after_each_period.first().copied() }
            };
            let first = if continuous { "after 5 s" } else { "after the first period" };
            let name = |what_of_it: &str| format!("{mode} vibration, {what}, {what_of_it}");
            let mut add = |name: String, unit, value: &dyn Fn(&Settlement) -> Option<f64>| {
                let of = |r: &RunRecord| value(settlement(r).filter(|_| r.kind == kind)?);
                quantities.push(Quantity::of(name, unit, None, study, &of));
            };
            add(name(first), "mm", &early);
            add(name("final"), "mm", &|s| Some(s.final_mm));
            add(name(&format!("share {first}")), "%", &|s| share_percent(early(s)?, s.final_mm));
        }
    }
    let laboratory = laboratory(&quantities);
    Uncertainty {
        confidence: CONFIDENCE,
        trend: trend(study),
        settlements: settlements(all),
        placements: placements::scatter(all, study),
        laboratory,
        quantities,
    }
}

/// The programme's vibrations.
pub(super) const MODES: [(RunKind, &str); 2] = [
    (RunKind::VibrationContinuous, "continuous"),
    (RunKind::VibrationIntermittent, "intermittent"),
];

/// Settlement of every vibrated run, beside what its specimen sinks at rest by itself.
pub(crate) fn settlements(study: &StudyView) -> Vec<SettledRun> {
    MODES.iter().flat_map(|(kind, _)| study.of_kind(*kind)).map(settled).collect()
}

fn settled(run: &RunRecord) -> SettledRun {
    let s = &run.summary;
    let duration = s.shaken_s().map(|(first, last)| last - first);
    SettledRun {
        run: run.name.clone(),
        left_out_of_means: s.why_left_out(),
        plate_mm: plate(run).map(|s| s.final_mm),
        surface_mm: surface(run).map(|s| s.final_mm),
        creep_um_per_s: s.creep_um_per_s,
        creep_over_vibration_mm: s.creep_um_per_s.zip(duration).map(|(c, t)| 1e-3 * c * t),
        rest_test_plate_drop_mm: s.rest_test.and_then(|c| c.plate_drop_mm),
        rest_test_s: s.rest_test.map(|c| c.duration_s),
    }
}

/// Whether the standing height falls with the falling height.
///
/// A configuration is one block: it is poured from every height, so that its
/// own level falls out of the comparison.
pub fn trend(study: &StudyView) -> Trend {
    let heights = study.falling_heights_mm();
    let mut configurations = Vec::new();
    let mut left_out = Vec::new();
    let mut curves: Vec<Vec<(f64, f64)>> = Vec::new();
    for c in study.configurations() {
        let curve = study.standing_heights(c).into_iter().map(|(fh, mm)| (fh / MM_IN_CM, mm));
        let curve: Vec<(f64, f64)> = curve.collect();
        // One without every height would weigh the heights unequally.
        if curve.len() == heights.len() && curve.len() >= 2 {
            configurations.push(c);
            curves.push(curve);
        } else if heights.iter().any(|fh| study.leaves_out_pluviation(c, *fh)) {
            left_out.push(c);
        }
    }
    let slopes: Vec<f64> = curves.iter().filter_map(|c| least_squares_slope(c)).collect();
    let test = MeanTest::of(&slopes, CONFIDENCE);
    let slope = test.map(|t| SlopeTest {
        mean_mm_per_cm: t.estimate.mean,
        interval: Interval::around(t.estimate.mean, t.half_width),
        t: Some(t.t).filter(|t| t.is_finite()),
        freedom: t.freedom,
        p: t.p,
    });
    // From the highest fall to the lowest the standing height is expected to rise.
    let rows: Vec<Vec<f64>> =
        curves.iter().map(|c| c.iter().rev().map(|p| p.1).collect()).collect();
    let page = page_test(&rows).map(|t| RankTest {
        l: t.l,
        configurations: rows.len(),
        heights: heights.len(),
        p: t.p,
    });
    let needed = test.filter(|t| t.estimate.count >= 3 && t.standard_deviation > 0.0);
    let configurations_needed = needed
        .and_then(|t| values_needed(t.estimate.mean / t.standard_deviation, CONFIDENCE, POWER));
    let mut verdict = in_words(&slopes, slope.as_ref(), page.as_ref(), configurations_needed);
    if !left_out.is_empty() {
        let numbers: Vec<String> = left_out.iter().map(u32::to_string).collect();
        verdict += &format!(
            " Left out, as not all of its runs count: configuration {}.",
            numbers.join(", ")
        );
    }
    Trend {
        slopes_mm_per_cm: slopes,
        configurations,
        left_out,
        slope,
        page,
        configurations_needed,
        verdict,
    }
}

/// A p-value for readers.
pub(crate) fn p_value(p: f64) -> String {
    if p < 0.001 { "below 0.001".to_owned() } else { number(p, 3) }
}

/// The same within a sentence, with its name: "p = 0.012", "p below 0.001".
pub(crate) fn p_in_words(p: f64) -> String {
    let is = if p < 0.001 { "" } else { "= " };
    format!("p {is}{}", p_value(p))
}

fn in_words(
    slopes: &[f64],
    slope: Option<&SlopeTest>,
    page: Option<&RankTest>,
    needed: Option<usize>,
) -> String {
    let level = 1.0 - CONFIDENCE;
    let Some(slope) = slope else {
        return format!(
            "{} poured from every height: whether the standing height falls with the falling height \
             cannot be distinguished from scatter.",
            if slopes.is_empty() { "No configuration was" } else { "Only one configuration was" }
        );
    };
    let mut text = format!(
        "The standing height changes by {} mm per cm of falling height, 95 % confidence {} to {} \
         (t-test of {} slopes, {})",
        number(slope.mean_mm_per_cm, 3),
        number(slope.interval.low, 3),
        number(slope.interval.high, 3),
        slopes.len(),
        p_in_words(slope.p)
    );
    if let Some(page) = page {
        text +=
            &format!("; by ranks alone Page's L is {} ({})", number(page.l, 1), p_in_words(page.p));
    }
    text += match (slope.mean_mm_per_cm < 0.0, slope.p < level, page.map(|p| p.p < level)) {
        (true, true, Some(true)) => ". Both say that it falls.",
        (true, true, None) => ". It falls.",
        (true, true, Some(false)) => ". The slopes say that it falls, the ranks are not enough.",
        (true, false, Some(true)) => {
            ". The ranks say that it falls; by how much is not known to this confidence."
        }
        (false, true, _) => ". It rises, against the paper.",
        _ => ". That it falls is not shown.",
    };
    match needed {
        Some(n) => {
            let would = match (n > slopes.len(), slope.mean_mm_per_cm > 0.0) {
                (true, false) => "show it with",
                (false, false) => "be enough to show it with",
                (true, true) => "show that it rises with",
                (false, true) => "be enough to show that it rises with",
            };
            text += &format!(
                " Were the measured slope and scatter the true ones, {n} configurations would {would} \
                 a probability of 80 %."
            );
        }
        None if slopes.len() < 3 => {
            text += " At least three configurations are needed to estimate how many would show it.";
        }
        None => {}
    }
    text
}

fn laboratory(quantities: &[Quantity]) -> Vec<LaboratoryScatter> {
    let ours = |name: &str| quantities.iter().find(|q| q.name == name).and_then(|q| q.range);
    let poured = quantities.iter().filter(|q| q.falling_height_mm.is_some());
    let widest =
        poured.filter_map(|q| q.range).max_by(|a, b| (a.high - a.low).total_cmp(&(b.high - b.low)));
    let of = |quantity: &str, stated_range, ours, note: &str| LaboratoryScatter {
        quantity: quantity.to_owned(),
        stated_range,
        ours,
        unit: "mm".to_owned(),
        note: note.to_owned(),
    };
    vec![
        of(
            "standing height; ours: the falling height with the widest range",
            None,
            widest,
            "49 tests from four heights. Their range was drawn in Figure 7 alone, which was not \
             available to us (only the paper's text was); the text states no number and no standard \
             deviation.",
        ),
        of(
            "final settlement of the plate, continuous",
            Some(bands::FINAL_SETTLEMENT_MM),
            ours("continuous vibration, plate, final"),
            "Smallest and largest of some of 33 vibration tests; how many were continuous, their mean \
             and their standard deviation are not stated, so that no interval of the laboratory's \
             mean can be given. A range grows with the number of tests: that of a few configurations \
             is narrower by itself.",
        ),
        of(
            "final settlement of the plate, intermittent",
            None,
            ours("intermittent vibration, plate, final"),
            "The range was drawn in Figure 10 alone, which was not available to us (only the paper's \
             text was); the text says that one of the paper's simulations ended 11 % below its lower \
             end.",
        ),
    ]
}
