//! Tests of what is said of targets.

use super::*;

fn found() -> TargetsFound {
    let target = Target {
        runs: "t".to_owned(),
        result: "void_ratio".to_owned(),
        share_of: None,
        low: 0.6,
        high: 0.7,
    };
    let fit = LinearFit {
        count: 12,
        residual_standard_deviation: 0.034_567,
        explained: 0.81,
        predicted: 0.67,
    };
    let at = |friction: f64, height: f64| -> BTreeMap<String, f64> {
        let at = [("friction", friction), ("height", height)];
        at.map(|(name, x)| (name.to_owned(), x)).into()
    };
    let effects = [("friction", (0.097_84, 0.038_99)), ("height", (0.009_282, 1.211))];
    let target = TargetFound {
        target,
        runs_counted: 12,
        runs_left_out: 0,
        runs_without_result: 0,
        runs_meeting: 5,
        share_meeting: [0.19, 0.68],
        specimens: 12,
        values: [0.574_123, 0.746_123],
        fit,
        effects: effects.map(|(name, effect)| (name.to_owned(), effect)).into(),
        ranges: [("friction", [0.3, 0.8]), ("height", [5.0, 30.0])]
            .map(|(name, range)| (name.to_owned(), range))
            .into(),
        freedom: effects.map(|(name, _)| (name.to_owned(), 9.0)).into(),
        within_specimens: Vec::new(),
        best: 0.86,
    };
    let at_best = at(0.579_312, 21.560_1);
    TargetsFound {
        factors: [("friction", [0.3, 0.8]), ("height", [5.0, 30.0])]
            .map(|(name, range)| (name.to_owned(), range))
            .into(),
        targets: vec![target],
        correlations: None,
        pairs: Vec::new(),
        all: Together { targets: vec![0], mean: 0.48, best: 0.6, at: at_best, points: None },
        met_at: vec![MetAt { at: at(0.3, 5.0), values: vec![0.606_812] }],
        searched: 20_000,
    }
}

/// Law: what runs or points have met is not said to be met nowhere or to be excluded, however
/// small the probability by the models is.
#[test]
fn what_was_met_is_not_excluded() {
    let of = |met: usize| {
        let mut found = found();
        found.targets = vec![found.targets[0].clone(), found.targets[0].clone()];
        for target in &mut found.targets {
            (target.best, target.runs_meeting) = (0.01, met);
        }
        let points = PointsMet::new(met, 12, 12);
        found.all = Together { targets: vec![0, 1], best: 0.01, points, ..found.all };
        found.pairs = vec![found.all.clone()];
        found.answer()
    };
    for (met, expected) in [(0, true), (1, false)] {
        let answer = of(met);
        for words in ["Not met anywhere by itself", "Targets that exclude each other"] {
            let got = answer.contains(words);
            assert_eq!(got, expected, "law: `{words}` where {met} of 12 meet them: {answer}");
        }
    }
}

/// Law: that runs which count lack a result is said with their number, and that what is left is no
/// random choice; nothing where all have it.
#[test]
fn runs_without_the_result_are_said() {
    let mut of = found();
    let words = "Runs that count and lack a result";
    let whole = of.page().markdown();
    assert!(!whole.contains(words), "law: all have it, got:\n{whole}");
    (of.targets[0].runs_left_out, of.targets[0].runs_without_result) = (5, 4);
    let page = of.page().markdown();
    for said in [
        "Runs that count and lack a result: t:void_ratio in 4 of 16.",
        "such runs are not random.",
        "| 5, 4 of them without the result |",
    ] {
        assert!(page.contains(said), "law: `{said}`, got:\n{page}");
    }
}

/// Law: a change is of the range that the runs of its target have; where that is not the range that
/// is searched, it is said.
#[test]
fn a_change_over_another_range_says_so() {
    let mut of = found();
    of.factors.insert("friction".to_owned(), [0.3, 1.2]);
    let page = of.page().markdown();
    for said in ["| 0.3 to 1.2 | 0.098 ± 0.039 over 0.3 to 0.8 |", "| 5 to 30 | 0.0 ± 1.2 |"] {
        assert!(page.contains(said), "law: `{said}`, got:\n{page}");
    }
}

/// Law: effects have the second digit of their interval, results that of their scatter, places
/// a twentieth of the range.
#[test]
fn a_page_has_the_digits_that_are_known() {
    let page = found().page().markdown();
    for shown in [
        "0.098 ± 0.039 |",
        "| 0.0 ± 1.2 |",
        "| 0.574 to 0.746 |",
        "| 0.3 | 5 | 0.607 |",
        "at friction 0.58, height 22.",
        "| friction 0.58, height 22 |",
    ] {
        assert!(page.contains(shown), "law: `{shown}` stands in\n{page}");
    }
    let mut exact = found();
    exact.targets[0].fit.residual_standard_deviation = 0.0;
    exact.factors.insert("friction".to_owned(), [0.579_3, 0.579_3]);
    let page = exact.page().markdown();
    assert!(page.contains("| 0.5741 to 0.7461 |"), "law: four digits without scatter\n{page}");
    assert!(page.contains("at friction 0.5793"), "law: and without a range\n{page}");
}
