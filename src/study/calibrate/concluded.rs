//! From a search to what is said of it.

use super::{
    ANGLE_OF_REPOSE, CalibrationOptions, GRAIN_FRICTION,
    kept::{CONFIDENCE, Kept},
    line::in_result,
    search::{Answer, Question},
};
use crate::measure::inference::MeanTest;
use crate::paper::{Interval, constants::FRICTION_RATIO, text::compact};
use crate::report::{
    Calibration, CalibrationEnding as Ending, CalibrationRun, CalibrationSolution,
    CalibrationValue, FrictionIdentity, target_in_words, unknown_in_words, with_unit,
};
use crate::scenario::Scenario;

/// Puts a calibration together.
pub(super) fn conclude(
    options: &CalibrationOptions,
    scenario: &Scenario,
    question: &Question,
    answer: Answer,
) -> Calibration {
    let unit = options.target.unit();
    let (low, high) = question.between;
    // A slope that cannot be told from zero reaches anything anywhere.
    let told = |ending| ending != Ending::Flat;
    let solution = answer.fit.filter(|_| told(answer.ending)).map(|fit| CalibrationSolution {
        value: fit.x,
        interval_95: fit.interval.map(|(low, high)| Interval::new(low, high)),
        result_half_width_95: fit.half_width_there,
        interval_in_result: in_result(&fit),
        slope: fit.slope,
        slope_half_width_95: fit.slope_half_width,
        centre: fit.centre,
        level: fit.level,
        curvature_p: fit.curvature_p,
        configurations: fit.blocks,
    });
    let values = answer.kept.table(&answer.fitted);
    let mut runs = answer.kept.runs.clone();
    runs.sort_by(|a, b| a.value.total_cmp(&b.value).then(a.configuration.cmp(&b.configuration)));
    let mut found = Calibration {
        scenario: scenario.name.clone(),
        target: options.target.field().to_owned(),
        unit: unit.to_owned(),
        wanted: question.wanted,
        unknown: options.unknown.clone(),
        between: Interval::new(low, high),
        ending: answer.ending,
        statement: String::new(),
        solution,
        tolerance: answer.tolerance,
        tolerance_given: question.tolerance.is_some(),
        scatter: answer.scatter,
        replicates: question.replicates,
        most_runs: question.most_runs,
        notes: answer.notes,
        identity: identity(options, question, &answer.kept, solution),
        values,
        runs,
    };
    found.statement = statement(&found);
    let notes = notes(&found, &answer.kept);
    found.notes.extend(notes);
    found
}

/// A mean with half its interval and unit: `20.1 ± 0.5°`.
fn with_half_width(mean: f64, half: Option<f64>, unit: &str) -> String {
    let decimals =
        half.filter(|h| *h > 0.0).map_or(2, |h| (1.0 - h.log10().floor()).clamp(0.0, 6.0) as usize);
    let number = |v: f64| crate::paper::text::number(v, decimals);
    match half {
        Some(half) => with_unit(&format!("{} ± {}", number(mean), number(half)), unit),
        None => with_unit(&compact(mean), unit),
    }
}

/// `an angle of repose of 60°`, `settlement_mm.final = 9 mm`.
fn wanted_in_words(of: &Calibration) -> String {
    let wanted = with_unit(&compact(of.wanted), &of.unit);
    match target_in_words(&of.target) {
        field if field == of.target => format!("{field} = {wanted}"),
        words => format!("an {words} of {wanted}"),
    }
}

fn at(value: &CalibrationValue, unit: &str) -> String {
    let mean = value.mean.map_or_else(
        || "without results".to_owned(),
        |mean| with_half_width(mean, value.half_width_95, unit),
    );
    format!("at {} it is {mean}", compact(value.value))
}

/// How it ended, in a sentence.
fn statement(of: &Calibration) -> String {
    let unknown = unknown_in_words(&of.unknown);
    let wanted = wanted_in_words(of);
    let target = target_in_words(&of.target);
    let range = format!("{}..{}", of.between.low, of.between.high);
    let measured: Vec<&CalibrationValue> = of.values.iter().filter(|v| v.mean.is_some()).collect();
    let ends = || {
        let mut shown: Vec<&CalibrationValue> = Vec::new();
        shown.extend(measured.first().copied());
        // The nearest, where it is neither end.
        let off = |v: &CalibrationValue| v.mean.map_or(f64::INFINITY, |m| (m - of.wanted).abs());
        let nearest = measured.iter().copied().min_by(|a, b| off(a).total_cmp(&off(b)));
        shown.extend(nearest);
        shown.extend(measured.last().copied());
        shown.dedup_by(|a, b| a.value == b.value);
        shown.iter().map(|v| at(v, &of.unit)).collect::<Vec<_>>().join(", ")
    };
    let solved = of.solution.map(|s| {
        let interval = s.interval_95.map_or_else(
            || "no interval: the slope cannot be told from zero".to_owned(),
            |i| format!("95 % confidence {} to {}", compact(i.low), compact(i.high)),
        );
        format!("{} ({interval})", compact(s.value))
    });
    match (of.ending, solved) {
        (Ending::Found, Some(solved)) => {
            format!("{unknown} {solved} gives {wanted}")
        }
        (Ending::RunsUsedUp, Some(solved)) => format!(
            "the {} runs that were allowed are used up: {unknown} {solved} is what they give for \
             {wanted}",
            of.most_runs
        ),
        (Ending::RunsUsedUp | Ending::Found, None) => format!(
            "the {} runs that were allowed are used up before {wanted} was found: {}",
            of.most_runs,
            ends()
        ),
        // A line that reaches it just outside, as far as can be told.
        (Ending::OutOfReach, Some(solved))
            if of
                .solution
                .and_then(|s| s.interval_95)
                .is_some_and(|i| i.low <= of.between.high && of.between.low <= i.high) =>
        {
            format!("{wanted} is reached at the edge of {range} or beyond: {unknown} {solved}")
        }
        (Ending::OutOfReach, _) => {
            format!("no {unknown} in {range} gives {wanted}: {}", ends())
        }
        (Ending::Flat, _) => format!(
            "{target} does not depend on {unknown} in {range} beyond its scatter: {}",
            ends()
        ),
        (Ending::Failed, _) => {
            let failed = of.runs.iter().filter(|r| r.result.is_none()).count();
            format!(
                "too few runs have a result: {failed} of {} failed; the first: {}",
                of.runs.len(),
                of.runs.iter().find_map(|r| r.failure.as_deref()).unwrap_or("none")
            )
        }
    }
}

/// What a reader must know beside.
fn notes(of: &Calibration, kept: &Kept) -> Vec<String> {
    let mut notes = Vec::new();
    if let Some(((rise_from, rise_to), (fall_from, fall_to))) = kept.turn() {
        notes.push(format!(
            "the response turns: it rises from {rise_from} to {rise_to} and falls from {fall_from} \
             to {fall_to}, both beyond scatter; there may be other solutions, also between the \
             values that were tried"
        ));
    } else if kept.differences().is_empty() && kept.usable().len() > 1 {
        notes.push(
            "no two values that were tried differ beyond scatter: more replicates or a wider range \
             may show a response"
                .to_owned(),
        );
    }
    let failed = of.runs.iter().filter(|r| r.result.is_none()).count();
    if failed > 0 && of.ending != Ending::Failed {
        notes.push(format!(
            "{failed} of {} runs have no result and are left out, with their configuration in the \
             line",
            of.runs.len()
        ));
    }
    notes.extend(of_runs(of));
    let Some(solution) = of.solution else { return notes };
    if solution.curvature_p.is_some_and(|p| p < 1.0 - CONFIDENCE) {
        notes.push(
            "the response bends within the values of the line more than scatter explains: the \
             interval does not hold what the bend adds"
                .to_owned(),
        );
    }
    let Interval { low, high } = of.between;
    if !(low..=high).contains(&solution.value) {
        notes.push(format!(
            "the line reaches the wanted result at {}, outside of the range: a wider one may hold it",
            compact(solution.value)
        ));
    } else if solution.interval_95.is_some_and(|i| i.low < low || i.high > high) {
        notes.push("the interval reaches beyond the range that was searched".to_owned());
    }
    if let (Ending::RunsUsedUp, Some(tolerance)) = (of.ending, of.tolerance) {
        notes.push(format!(
            "the tolerance of {} is not met: --most-runs allows more",
            with_unit(&compact(tolerance), &of.unit)
        ));
    }
    notes
}

/// What single runs have against them.
fn of_runs(of: &Calibration) -> Vec<String> {
    let all = of.runs.len();
    let count = |is: &dyn Fn(&CalibrationRun) -> bool| of.runs.iter().filter(|r| is(r)).count();
    let mut notes = Vec::new();
    let hanging = count(&|r| r.left_in_funnel.is_some_and(|n| n > 0));
    if hanging > 0 {
        let most = of.runs.iter().filter_map(|r| r.left_in_funnel).max().unwrap_or(0);
        notes.push(format!(
            "grains were left hanging in the funnel in {hanging} of {all} runs, {most} at most: \
             results of runs that lack grains scatter the more"
        ));
    }
    let escaped = count(&|r| r.escaped.is_some_and(|n| n > 0));
    if escaped > 0 {
        notes.push(format!("grains passed a wall in {escaped} of {all} runs"));
    }
    let short = count(&|r| r.meets_standard == Some(false));
    if short > 0 {
        notes.push(format!(
            "{short} of {all} runs do not meet the accuracy standard for overlap and creep \
             (docs/accuracy.md), or did not measure creep"
        ));
    }
    notes
}

/// Holds the assumption that angle of repose and angle of friction are the
/// same against the runs at the friction that it gives.
fn identity(
    options: &CalibrationOptions,
    question: &Question,
    kept: &Kept,
    solution: Option<CalibrationSolution>,
) -> Option<FrictionIdentity> {
    if options.target.field() != ANGLE_OF_REPOSE || options.unknown != GRAIN_FRICTION {
        return None;
    }
    let friction = question.wanted.to_radians().tan();
    let tried = question.rounded(friction);
    let differences: Vec<f64> =
        kept.results(tried).iter().map(|angle| angle - tried.atan().to_degrees()).collect();
    let test = MeanTest::of(&differences, CONFIDENCE);
    Some(FrictionIdentity {
        friction,
        friction_angle_found_degrees: solution.map(|s| s.value.atan().to_degrees()),
        tried,
        degrees_there: kept.mean(tried),
        difference_degrees: test.map(|t| t.mean),
        difference_half_width_95: test.map(|t| t.half_width),
        p: test.map(|t| t.p),
        inside_interval: solution
            .and_then(|s| s.interval_95)
            .map(|i| i.low <= friction && friction <= i.high),
        paper_friction: FRICTION_RATIO,
    })
}

#[cfg(test)]
mod tests {
    use std::sync::{Arc, atomic::AtomicBool};

    use super::*;
    use crate::protocol::Silent;
    use crate::study::RunOptions;

    fn options(target: &str) -> CalibrationOptions {
        CalibrationOptions {
            scenario: "s.json".into(),
            changes: Vec::new(),
            target: target.parse().expect("a target"),
            unknown: GRAIN_FRICTION.to_owned(),
            between: "0.1..1.5".parse().expect("a range"),
            replicates: 3,
            tolerance: None,
            most_runs: None,
            run: RunOptions {
                out: "out".into(),
                jobs: 1,
                frames: false,
                cancel: Arc::new(AtomicBool::new(false)),
                progress: Arc::new(Silent),
            },
        }
    }

    /// Three configurations at each value, `around` apart.
    fn concluded(target: &str, ending: Ending, means: &[(f64, f64)], around: f64) -> Calibration {
        let options = options(target);
        let question = Question {
            wanted: options.target.wanted(),
            between: (0.1, 1.5),
            replicates: 3,
            tolerance: None,
            most_runs: 48,
            whole: false,
            also: None,
        };
        let runs = means.iter().flat_map(|(value, mean)| {
            (1..=3).map(move |configuration| CalibrationRun {
                result: Some(mean + around * (f64::from(configuration) - 2.0)),
                left_in_funnel: Some(u64::from(configuration == 2)),
                meets_standard: Some(configuration != 3),
                ..CalibrationRun::new(*value, configuration, "run")
            })
        });
        let kept = Kept { runs: runs.collect() };
        let fitted: Vec<f64> = means.iter().map(|m| m.0).collect();
        let found = matches!(ending, Ending::Found | Ending::RunsUsedUp);
        let answer = Answer {
            ending,
            fit: found.then(|| kept.fit(&fitted, question.wanted)).flatten(),
            fitted,
            tolerance: Some(1.0),
            scatter: Some(around),
            notes: Vec::new(),
            kept,
        };
        let scenario = serde_json::json!({
            "name": "s", "grains": { "file": "g.json" }, "stages": [{ "stage": "fill_funnel" }]
        });
        let scenario = serde_json::from_value(scenario).expect("a scenario");
        conclude(&options, &scenario, &question, answer)
    }

    #[test]
    fn what_is_out_of_reach_is_said_with_what_was_measured() {
        let means = [(0.1, 20.1), (0.7926, 35.0), (1.5, 43.2)];
        let of = concluded("angle_of_repose.degrees=60", Ending::OutOfReach, &means, 0.2);
        // Half the interval of three values 0.2 apart: 4.303 · 0.2/√3.
        assert_eq!(
            of.statement,
            "no friction between grains in 0.1..1.5 gives an angle of repose of 60°: at 0.1 it is \
             20.10 ± 0.50°, at 1.5 it is 43.20 ± 0.50°"
        );
        for words in ["hanging in the funnel in 3 of 9 runs", "3 of 9 runs do not meet"] {
            assert!(of.notes.iter().any(|n| n.contains(words)), "`{words}`: {:?}", of.notes);
        }
        assert!(!of.notes.iter().any(|n| n.contains("wall")), "none escaped: {:?}", of.notes);
        let of = concluded("void_ratio=0.2", Ending::Flat, &[(0.1, 0.9), (1.5, 0.9)], 0.01);
        assert!(of.statement.starts_with("void_ratio does not depend on"), "{}", of.statement);
        assert!(of.notes.iter().any(|n| n.contains("no two values")), "{:?}", of.notes);
        let of = concluded("settlement_mm.final=9", Ending::Found, &[(0.1, 8.0), (1.5, 10.0)], 0.1);
        assert!(of.statement.ends_with("gives settlement_mm.final = 9 mm"), "{}", of.statement);
        assert_eq!(of.identity, None, "only angles of repose have the identity");
    }

    #[test]
    fn the_identity_is_held_against_the_runs_at_its_friction() {
        let differs = [(0.5, 30.0), (0.7926, 34.0), (1.2, 40.0)];
        let of = concluded("angle_of_repose.degrees=38.4", Ending::Found, &differs, 0.2);
        let identity = of.identity.expect("an angle of repose by friction");
        assert!((identity.friction - 0.792_590).abs() < 1e-6, "law: tan 38.4°");
        assert_eq!((identity.tried, identity.paper_friction), (0.7926, 0.793));
        let difference = identity.difference_degrees.expect("three runs");
        assert!((difference + 4.4).abs() < 1e-3, "law: 34 − 38.4; got {difference}");
        assert!(identity.p.is_some_and(|p| p < 0.001), "4.4 ± 0.5 is no chance: {identity:?}");
        assert_eq!(identity.inside_interval, Some(false), "{:?}", of.solution);
        let angle = identity.friction_angle_found_degrees.expect("a solution");
        assert!(angle > 45.0, "law: atan of more than 1; got {angle}");
        let same = [(0.5, 30.0), (0.7926, 38.45), (1.2, 48.0)];
        let of = concluded("angle_of_repose.degrees=38.4", Ending::Found, &same, 0.5);
        let identity = of.identity.expect("an angle of repose by friction");
        assert!(identity.p.is_some_and(|p| p > 0.5), "0.05 ± 1.2 may be chance: {identity:?}");
        assert_eq!(identity.inside_interval, Some(true), "{:?}", of.solution);
    }

    #[test]
    fn means_have_as_many_digits_as_their_interval() {
        for (mean, half, expected) in [
            (20.123, Some(0.512), "20.12 ± 0.51°"),
            (20.123, Some(5.12), "20.1 ± 5.1°"),
            (20.123, Some(51.2), "20 ± 51°"),
            (20.123, None, "20.12°"),
            (20.123, Some(0.0), "20.12 ± 0.00°"),
        ] {
            assert_eq!(with_half_width(mean, half, "°"), expected, "{mean} and {half:?}");
        }
    }
}
