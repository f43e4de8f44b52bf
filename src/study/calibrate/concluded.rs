//! From a search to what is said of it.

use super::search::Answer;
use super::*;
use crate::record::left_out_in_words;
use crate::report::{
    CalibrationSolution, FrictionIdentity, PUBLISHED_FRICTION, table::mean_within, target_in_words,
    unknown_in_words, with_unit,
};

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
        target: options.target.field.clone(),
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
        replicates: question.realisations,
        most_runs: question.most_runs,
        notes: answer.notes,
        identity: identity(options, question, &answer.kept, solution),
        values,
        runs,
    };
    found.statement = statement(&found);
    let notes = notes(&found, &answer.kept);
    found.notes.extend(notes);
    // Which values a search ended with is said; without a solution no line goes through them.
    if found.solution.is_none() {
        found.values.iter_mut().for_each(|value| value.in_fit = false);
    }
    found
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
        |mean| with_unit(&mean_within(mean, value.half_width_95), unit),
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
            || "no interval: the slope does not differ significantly from zero".to_owned(),
            |i| format!("95 % confidence {} to {}", compact(i.low), compact(i.high)),
        );
        format!("{} ({interval})", compact(s.value))
    });
    match (of.ending, solved) {
        (Ending::Found, Some(solved)) => {
            format!("{unknown} {solved} gives {wanted}")
        }
        (Ending::RunsUsedUp, Some(solved)) => {
            format!("{}: {unknown} {solved} is what they give for {wanted}", runs_used_up(of))
        }
        (Ending::RunsUsedUp | Ending::Found, None) => {
            format!("{} before {wanted} was found: {}", runs_used_up(of), ends())
        }
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
        (Ending::Flat, _) => format!("{}: {}", flat(of, target, unknown, &range), ends()),
        (Ending::Failed, _) => {
            let count = |is: fn(&CalibrationRun) -> bool| of.runs.iter().filter(|r| is(r)).count();
            format!(
                "too few runs have a result that counts: {} of {} failed, {} are left out; the first: {}",
                count(|r| r.result.is_none()),
                of.runs.len(),
                count(CalibrationRun::is_left_out),
                of.runs
                    .iter()
                    .find_map(|r| r.failure.as_deref().or(r.left_out_of_means.as_deref()))
                    .unwrap_or("none")
            )
        }
    }
}

/// Where a response is flat: in the whole range, or among the values of the line alone.
fn flat(of: &Calibration, target: &str, unknown: &str, range: &str) -> String {
    let wanted = with_unit(&compact(of.wanted), &of.unit);
    let is_nowhere = Kept { runs: of.runs.clone() }.differences().is_empty();
    let line: Vec<f64> = of.values.iter().filter(|v| v.in_fit).map(|v| v.value).collect();
    match line.as_slice() {
        _ if is_nowhere => {
            format!("{target} does not depend on {unknown} in {range} beyond its scatter")
        }
        [first, .., last] => format!(
            "{target} does not depend on {unknown} beyond its scatter from {} to {}, where {wanted} \
             may be reached",
            compact(*first),
            compact(*last)
        ),
        _ => format!(
            "too few values of {unknown} have results that count where {wanted} may be reached"
        ),
    }
}

/// That no more runs are allowed, or too few for the next step.
fn runs_used_up(of: &Calibration) -> String {
    let (made, most) = (of.runs.len(), of.most_runs);
    let left = match most.saturating_sub(made) {
        0 => return format!("the {most} runs that were allowed are used up"),
        1 => "1 run is left".to_owned(),
        left => format!("{left} runs are left"),
    };
    format!("{made} of {most} runs were made ({left}, too few for the next step)")
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
            "no two values that were tried differ beyond scatter: more realisations or a wider \
             range may show a response"
                .to_owned(),
        );
    }
    let failed = of.runs.iter().filter(|r| r.result.is_none()).count();
    if failed > 0 && of.ending != Ending::Failed {
        notes.push(format!(
            "{failed} of {} {} no result and {} left out, with their realisation in the line",
            counted(of.runs.len(), "run"),
            in_number(failed, "has", "have"),
            in_number(failed, "is", "are")
        ));
    }
    let left_out: Vec<&CalibrationRun> = of.runs.iter().filter(|r| r.is_left_out()).collect();
    if let (Some(first), true) = (left_out.first(), of.ending != Ending::Failed) {
        notes.push(format!(
            "{}, with their realisation in the line, as runs that failed are; the first, {}: {}",
            left_out_in_words(left_out.len(), of.runs.len() - failed).unwrap_or_default(),
            first.run,
            first.left_out_of_means.as_deref().unwrap_or_default()
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
            "the line reaches the wanted result at {}, outside the range; try a wider range",
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
    let friction = options.friction_of_angle()?;
    let tried = question.rounded(friction);
    let differences: Vec<f64> =
        kept.results(tried).iter().map(|angle| angle - tried.atan().to_degrees()).collect();
    let test = MeanTest::of(&differences, CONFIDENCE);
    Some(FrictionIdentity {
        friction,
        friction_angle_found_degrees: solution.map(|s| s.value.atan().to_degrees()),
        tried,
        degrees_there: kept.mean(tried),
        difference_degrees: test.map(|t| t.estimate.mean),
        difference_half_width_95: test.map(|t| t.half_width),
        p: test.map(|t| t.p),
        inside_interval: solution
            .and_then(|s| s.interval_95)
            .map(|i| i.low <= friction && friction <= i.high),
        paper_friction: PUBLISHED_FRICTION,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::GRAIN_FRICTION;
    use crate::study::tests::bare_scenario;

    fn options(target: &str) -> CalibrationOptions {
        CalibrationOptions {
            scenario: "s.json".into(),
            changes: Vec::new(),
            target: target.parse().expect("a target"),
            unknown: GRAIN_FRICTION.to_owned(),
            between: "0.1..1.5".parse().expect("a range"),
            realisations: 3,
            tolerance: None,
            most_runs: None,
        }
    }

    fn concluded(target: &str, ending: Ending, means: &[(f64, f64)], around: f64) -> Calibration {
        concluded_of(target, ending, means, around, &|_| {})
    }

    /// Three configurations at each value, `around` apart, changed.
    fn concluded_of(
        target: &str,
        ending: Ending,
        means: &[(f64, f64)],
        around: f64,
        change: &dyn Fn(&mut Vec<CalibrationRun>),
    ) -> Calibration {
        let options = options(target);
        let question = Question {
            wanted: options.target.wanted,
            between: (0.1, 1.5),
            realisations: 3,
            tolerance: None,
            most_runs: 48,
            whole: false,
            also: None,
        };
        let runs = means.iter().flat_map(|(value, mean)| {
            (1..=3).map(move |configuration| CalibrationRun {
                result: Some(mean + around * (f64::from(configuration) - 2.0)),
                left_in_funnel: Some(u64::from(configuration == 2)),
                meets_standard: Some(true),
                ..CalibrationRun::new(*value, configuration, "run")
            })
        });
        let mut runs: Vec<CalibrationRun> = runs.collect();
        change(&mut runs);
        let kept = Kept { runs };
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
        conclude(&options, &bare_scenario(), &question, answer)
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
        let said = |of: &Calibration, words: &str| of.notes.iter().any(|n| n.contains(words));
        assert!(said(&of, "hanging in the funnel in 3 of 9 runs"), "{:?}", of.notes);
        assert!(!said(&of, "left out"), "law: every run counts: {:?}", of.notes);
        assert!(!of.notes.iter().any(|n| n.contains("wall")), "none escaped: {:?}", of.notes);
        let of = concluded("void_ratio=0.2", Ending::Flat, &[(0.1, 0.9), (1.5, 0.9)], 0.01);
        assert!(of.statement.starts_with("void_ratio does not depend on"), "{}", of.statement);
        assert!(of.notes.iter().any(|n| n.contains("no two values")), "{:?}", of.notes);
        let of = concluded("settlement_mm.final=9", Ending::Found, &[(0.1, 8.0), (1.5, 10.0)], 0.1);
        assert!(of.statement.ends_with("gives settlement_mm.final = 9 mm"), "{}", of.statement);
        assert_eq!(of.identity, None, "only angles of repose have the identity");
    }

    /// Law: a response is said to be flat where it is: in the range, or among the values of the line,
    /// as at a crest; of fewer than two of these it is not said.
    #[test]
    fn a_flat_response_is_said_to_be_so_where_it_is() {
        let target = "angle_of_repose.degrees=30";
        let means = [(0.1, 20.0), (0.5, 29.9), (0.7, 29.9), (1.5, 10.0)];
        let of = concluded(target, Ending::Flat, &means, 0.5);
        let said = |in_fit: &[f64]| {
            let mut of = of.clone();
            of.values.iter_mut().for_each(|v| v.in_fit = in_fit.contains(&v.value));
            statement(&of)
        };
        let ends = "at 0.1 it is 20.0 ± 1.2°, at 0.5 it is 29.9 ± 1.2°, at 1.5 it is 10.0 ± 1.2°";
        for (in_fit, words) in [
            (
                &[0.5, 0.7][..],
                "angle of repose does not depend on friction between grains beyond its scatter \
                 from 0.5 to 0.7, where 30° may be reached",
            ),
            (
                &[0.5][..],
                "too few values of friction between grains have results that count where 30° may \
                 be reached",
            ),
        ] {
            let expected = format!("{words}: {ends}");
            assert_eq!(said(in_fit), expected, "law: the ends differ by 10°");
        }
        let level = means.map(|(value, _)| (value, 29.0));
        let level = concluded(target, Ending::Flat, &level, 0.5).statement;
        let words = "angle of repose does not depend on friction between grains in 0.1..1.5 beyond";
        assert!(level.starts_with(words), "law: `{words}`, got `{level}`");
        let found =
            concluded("settlement_mm.final=9", Ending::Found, &[(0.1, 8.0), (1.5, 10.0)], 0.1);
        for (of, expected) in [(&of, 0), (&found, 2)] {
            let got = of.values.iter().filter(|v| v.in_fit).count();
            assert_eq!(
                got, expected,
                "law: values of a line only where there is one: {:?}",
                of.ending
            );
        }
    }

    /// Law: the number of runs is that of those made.
    #[test]
    fn runs_that_were_made_are_counted() {
        let means = [(0.1, 8.0), (1.5, 10.0)];
        for (most_runs, expected) in [
            (6, "the 6 runs that were allowed are used up: "),
            (7, "6 of 7 runs were made (1 run is left, too few for the next step): "),
            (9, "6 of 9 runs were made (3 runs are left, too few for the next step): "),
        ] {
            let of = concluded("settlement_mm.final=9", Ending::RunsUsedUp, &means, 0.1);
            let of = Calibration { most_runs, ..of };
            let said = statement(&of);
            assert!(said.starts_with(expected), "law: `{expected}`, got `{said}`");
            let none = statement(&Calibration { solution: None, ..of });
            let expected = expected.replace(": ", " before settlement_mm.final = 9 mm was found: ");
            assert!(none.starts_with(&expected), "law: `{expected}`, got `{none}`");
        }
    }

    /// Law: what is left out changes no mean, line, scatter or identity, and is said with its number.
    #[test]
    fn what_is_left_out_is_said_and_moves_nothing() {
        let target = "angle_of_repose.degrees=38.4";
        let means = [(0.5, 30.0), (0.7926, 38.45), (1.2, 48.0)];
        let good = concluded_of(target, Ending::Found, &means, 0.5, &|_| {});
        // A fourth configuration at every value, far off.
        let spoil = |runs: &mut Vec<CalibrationRun>| {
            runs.extend(means.map(|(value, _)| CalibrationRun {
                result: Some(1e3),
                left_out_of_means: Some("500 of 1456 grains are missing".into()),
                ..CalibrationRun::new(value, 4, "a-jam")
            }));
        };
        let spoilt = concluded_of(target, Ending::Found, &means, 0.5, &spoil);
        assert_eq!(spoilt.solution, good.solution, "law: the same line");
        assert_eq!(spoilt.identity, good.identity, "law: the same identity");
        for (value, known) in spoilt.values.iter().zip(&good.values) {
            assert_eq!(
                (value.mean, value.standard_deviation),
                (known.mean, known.standard_deviation)
            );
            assert_eq!((value.runs, value.left_out, value.failed), (4, 1, 0), "law: counted");
            assert_eq!((known.runs, known.left_out), (3, 0), "law: nothing is left out");
        }
        let words = "3 of 12 runs with a result are left out of means";
        let note = spoilt.notes.iter().find(|n| n.contains(words));
        let note = note.unwrap_or_else(|| panic!("`{words}`: {:?}", spoilt.notes));
        assert!(note.contains("a-jam: 500 of 1456 grains"), "law: the reason stands by: {note}");
        assert!(!good.notes.iter().any(|n| n.contains("left out")), "{:?}", good.notes);
        let all = |runs: &mut Vec<CalibrationRun>| {
            runs.iter_mut().for_each(|r| r.left_out_of_means = Some("not valid".into()));
        };
        let none = concluded_of(target, Ending::Failed, &means, 0.5, &all);
        assert!(none.values.iter().all(|v| v.mean.is_none()), "law: nothing of nothing");
        assert!(
            none.statement.contains("9 are left out; the first: not valid"),
            "{}",
            none.statement
        );
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
}
