//! Claims on pluviation: section 4, Figure 7.

use super::*;

pub(super) fn claims(study: &StudyView) -> Vec<Claim> {
    vec![falls(study), monotone(study), slope(study), within_laboratory(study), reproducible(study)]
}

fn falls(study: &StudyView) -> Claim {
    let (lowest, highest) = (FALLING_HEIGHTS_MM[0], FALLING_HEIGHTS_MM[3]);
    let known_height = |r: &&RunRecord| height_mm(r).is_finite();
    let end = |c, fh| study.pluviation(c, fh).filter(known_height);
    let ends = |c| Some((end(c, lowest)?, end(c, highest)?));
    let known: Vec<(u32, &RunRecord, &RunRecord)> =
        study.configurations().filter_map(|c| ends(c).map(|(a, b)| (c, a, b))).collect();
    // Of a configuration that is left out nothing is expected.
    let left_out = |c: u32| [lowest, highest].iter().any(|fh| study.leaves_out_pluviation(c, *fh));
    let missing = study.configurations().filter(|c| ends(*c).is_none() && !left_out(*c));
    let missing: Vec<u32> = missing.collect();
    let drop = |a: &RunRecord, b: &RunRecord| height_mm(a) - height_mm(b);
    let falling = known.iter().filter(|(_, a, b)| drop(a, b) > 0.0).count();
    let drops: Vec<String> = known
        .iter()
        .map(|(c, a, b)| format!("{} mm (configuration {c})", number(drop(a, b), 1)))
        .collect();
    let not_run = match (missing.is_empty(), known.is_empty()) {
        (false, false) => format!("Not run: {}.", list(&missing)),
        _ => String::new(),
    };
    // Where no run tells, those that were done are named: they were run, and have no height.
    let both = |c| Some([study.pluviation(c, lowest)?, study.pluviation(c, highest)?]);
    let runs: Vec<&RunRecord> = match known.is_empty() {
        true => study.configurations().filter_map(both).flatten().collect(),
        false => known.iter().flat_map(|(_, a, b)| [*a, *b]).collect(),
    };
    Draft::of("standing-height-falls")
        .paper(&Stated::Count(known.len() + missing.len()))
        .ours((!known.is_empty()).then_some(falling as f64))
        .runs(runs)
        .note(listed("From 0 to 20 cm it falls by", &drops))
        .note(not_run)
        .missing(missing.len())
        .judge()
}

fn monotone(study: &StudyView) -> Claim {
    let heights = study.falling_heights_mm().len();
    let curves = study.configurations().map(|c| study.standing_heights(c));
    // One without every height does not show every step.
    let curves: Vec<_> = curves.filter(|c| c.len() >= 2 && c.len() == heights).collect();
    let count = curves.iter().filter(|c| c.windows(2).all(|w| w[1].1 < w[0].1)).count();
    Draft::of("standing-height-monotone")
        .ours((!curves.is_empty()).then_some(count as f64))
        .runs(study.of_kind(RunKind::Pluviation))
        .note(format!(
            "Of {}. The text states the trend, not that every step follows it; one step is of the \
         size of the scatter.",
            curves.len()
        ))
        .judge()
}

fn slope(study: &StudyView) -> Claim {
    let trend = trend(study);
    Draft::of("standing-height-slope")
        .ours(mean(&trend.slopes_mm_per_cm))
        .spread(trend.slopes_mm_per_cm)
        .runs(study.of_kind(RunKind::Pluviation))
        .note(trend.verdict)
        .judge()
}

fn within_laboratory(study: &StudyView) -> Claim {
    let heights = study.values(RunKind::Pluviation, |r| Some(height_mm(r)));
    Draft::of("standing-height-in-laboratory-range")
        .ours(mean(&heights))
        .spread(heights)
        .runs(study.of_kind(RunKind::Pluviation))
        .judge()
}

fn reproducible(study: &StudyView) -> Claim {
    let range = |fh: f64| {
        let heights = study.configurations().filter_map(|c| study.pluviation(c, fh).map(height_mm));
        let heights: Vec<f64> = heights.filter(|h| h.is_finite()).collect();
        let range = Interval::of(heights.iter().copied())?;
        (heights.len() >= 2).then_some((fh, range.high - range.low))
    };
    let ranges: Vec<_> = study.falling_heights_mm().into_iter().filter_map(range).collect();
    let in_words =
        |(fh, r): &(f64, f64)| format!("{} mm at {} cm", number(*r, 1), number(fh / 10.0, 0));
    let each: Vec<String> = ranges.iter().map(in_words).collect();
    Draft::of("standing-height-reproducible")
        .ours(ranges.iter().map(|r| r.1).reduce(f64::max))
        .spread(ranges.iter().map(|r| r.1))
        .runs(study.of_kind(RunKind::Pluviation))
        .note(listed("By falling height:", &each))
        .judge()
}
