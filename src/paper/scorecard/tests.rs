//! Scorecards of made-up studies whose answers are known.

use super::*;
use crate::paper::{canned, claims};

fn card(study: &StudyView) -> Scorecard {
    scorecard(study, &claims(study))
}

fn row<'a>(card: &'a Scorecard, id: &str) -> &'a ScoreRow {
    card.rows.iter().find(|r| r.id == id).unwrap_or_else(|| panic!("no row `{id}`: {card:#?}"))
}

/// Law: six to eight rows; a row's number is the mean of its runs with their interval.
#[test]
fn rows_are_means_with_intervals() {
    let runs = canned::valid_runs();
    let card = card(&canned::study(&runs));
    assert!((6..=8).contains(&card.rows.len()), "got {}", card.rows.len());
    // Configurations settle by 16, 18 and 20 mm: mean 18, s = 2, t(0.975, 2) = 4.3027.
    let settled = row(&card, "continuous-final-settlement");
    assert_eq!((settled.ours, settled.count), (Some(18.0), 3), "{settled:?}");
    let half = 4.302_653 * 2.0 / 3f64.sqrt();
    let interval = settled.interval.expect("three values");
    assert!((interval.high - 18.0 - half).abs() < 1e-4, "law: 18 ± {half}, got {interval:?}");
    assert_eq!(settled.verdict, Verdict::Within, "14 ≤ 18 ≤ 19.61: {settled:?}");
    assert_eq!(settled.decided, Some(false), "law: 13 to 23 reaches across 14 and 19.61");
    assert_eq!(settled.paper, "14 to 19.61 mm");
    assert_eq!(settled.in_words, "18.0 mm [13.0 … 23.0]");
    let falls = row(&card, "standing-height-falls");
    assert!(
        falls.in_words.starts_with("3 of 3 configurations; \u{2212}0.40 mm per cm"),
        "{falls:?}"
    );
    let range = row(&card, "intermittent-in-laboratory-range");
    assert_eq!((range.verdict, range.paper.as_str()), (Verdict::NotStated, "–"), "{range:?}");
    let text = &card.paragraph;
    assert!(text.starts_with("Reproduced: gravel that falls from higher stands lower"), "{text}");
    // The made-up plates move as much in the middle of a period.
    let missed = "Not reproduced: the plate moves most as a period begins and ends (0 of 3 configurations only).";
    assert!(text.contains(missed) && !text.contains("The text leaves open"), "{text}");
    assert!(text.contains("All 18 runs are valid"), "{text}");
}

/// Law: the tally counts results alone; what is no result changes nothing of it.
#[test]
fn inputs_are_not_counted() {
    let runs = canned::valid_runs();
    let mut study = canned::study(&runs);
    let before = card(&study);
    // The third configuration settles by 20 mm, beyond 19.61; no period has its ends apart.
    let expected = ResultCounts { within: 11, outside: 2, not_run: 0, not_comparable: 0 };
    assert_eq!(before.results, expected);
    study.grain_count = 1000;
    study.gradation.uscs = "GW".into();
    assert_eq!(card(&study).results, expected, "law: wrong inputs are no missed result");
    assert!(
        before.paragraph.ends_with("13 results: 11 within, 2 outside."),
        "{}",
        before.paragraph
    );
}

/// Law: a verdict by a range is decided where the whole interval lies on its side, within and
/// outside; one run decides nothing, and what is not decided is neither reproduced nor missed.
#[test]
fn a_wide_interval_decides_nothing() {
    let of = |settled: &[f64]| {
        let mut runs = canned::valid_runs();
        let mut given = settled.iter();
        runs.retain_mut(|run| {
            if run.kind != RunKind::VibrationContinuous {
                return true;
            }
            let Some(&mm) = given.next() else { return false };
            run.summary.settlement_mm.as_mut().expect("vibrated").final_mm = mm;
            true
        });
        let card = card(&canned::study(&runs));
        let settled = row(&card, "continuous-final-settlement").clone();
        (settled.verdict, settled.decided, card.paragraph)
    };
    for (settled, verdict, decided, list) in [
        (&[16.9, 17.0, 17.1][..], Verdict::Within, true, "Reproduced"),
        (&[12.0, 17.0, 22.0], Verdict::Within, false, "Not decided"),
        (&[17.0], Verdict::Within, false, "Not decided"),
        (&[11.9, 12.0, 12.1], Verdict::Outside, true, "Not reproduced"),
        (&[8.0, 13.0, 18.0], Verdict::Outside, false, "Not decided"),
    ] {
        let got = of(settled);
        assert_eq!((got.0, got.1), (verdict, Some(decided)), "law: of {settled:?} mm");
        let sentence = got.2.split(". ").find(|s| s.contains("settlement of the plate after 20 s"));
        let sentence = sentence.unwrap_or_else(|| panic!("it is said: {}", got.2));
        assert!(sentence.starts_with(list), "law: {settled:?} mm under {list}, got {sentence}");
    }
}

/// Law: what misses is said with its side and what the runs say of why.
#[test]
fn what_is_missed_is_said_with_a_reason() {
    let mut runs = canned::valid_runs();
    for run in runs.iter_mut().filter(|r| r.kind == RunKind::VibrationContinuous) {
        run.summary.settlement_mm.as_mut().expect("vibrated").final_mm = 6.0;
    }
    let card = card(&canned::study(&runs));
    let settled = row(&card, "continuous-final-settlement");
    assert_eq!((settled.verdict, settled.beyond), (Verdict::Outside, -8.0), "{settled:?}");
    for said in [
        "Not reproduced: settlement of the plate after 20 s of vibration (6.0 mm [6.0 … 6.0], less than \
         the paper's 14 to 19.61 mm);",
        // 0.8 µm/s for 20 s.
        "Numerical creep accounts for at most 0.02 mm",
        "The text leaves open",
    ] {
        assert!(card.paragraph.contains(said), "law: `{said}` in {}", card.paragraph);
    }
}

/// Law: nothing of the quick study reads as reproduced or missed but what does not depend on the
/// full size, and its reason is said once.
#[test]
fn the_quick_study_says_why_it_compares_nothing() {
    let runs = canned::valid_runs();
    let study = StudyView { quick: true, grain_count: 364, ..canned::study(&runs) };
    let card = card(&study);
    assert_eq!(card.results.outside, 0, "{:?}", card.results);
    let settled = row(&card, "continuous-final-settlement");
    assert_eq!(
        (settled.verdict, settled.ours),
        (Verdict::NotComparable, Some(18.0)),
        "{settled:?}"
    );
    assert!(settled.reason.contains("364 grains instead of 1456"), "{settled:?}");
    let text = &card.paragraph;
    assert!(text.starts_with("This is the quick study, of 364 grains"), "{text}");
    assert!(!text.contains("Not reproduced"), "{text}");
    assert!(text.contains("Nothing that could be compared is missed"), "{text}");
    assert_eq!(text.matches("Not compared").count(), 1, "law: one reason, one sentence: {text}");
}

/// Law: runs left out are counted in their row and make no mean; what was not run is not run.
#[test]
fn what_is_left_out_or_missing_is_no_result() {
    // The third configuration is not valid.
    let runs = canned::runs();
    let of_two = card(&canned::study(&runs));
    let settled = row(&of_two, "continuous-final-settlement");
    assert_eq!((settled.ours, settled.count, settled.left_out), (Some(17.0), 2, 1), "{settled:?}");
    assert!(of_two.paragraph.contains("6 of 18 runs with a result are left out of means"));
    let poured: Vec<_> =
        canned::valid_runs().into_iter().filter(|r| r.kind == RunKind::Pluviation).collect();
    let poured = card(&canned::study(&poured));
    let settled = row(&poured, "continuous-final-settlement");
    assert_eq!((settled.verdict, settled.ours), (Verdict::NotRun, None), "{settled:?}");
    assert!(poured.paragraph.contains("Not run: gravel is denser"), "{}", poured.paragraph);
    assert!(!poured.paragraph.contains("Not reproduced"), "{}", poured.paragraph);
    let none = card(&canned::study(&[]));
    assert!(none.paragraph.starts_with("No run is finished yet"), "{}", none.paragraph);
    let spoilt: Vec<_> = runs.into_iter().filter(|r| r.configuration == 3).collect();
    let spoilt = card(&StudyView { configurations: 3, ..canned::study(&spoilt) });
    let settled = row(&spoilt, "continuous-final-settlement");
    assert_eq!((settled.verdict, settled.ours), (Verdict::NotComparable, None), "{settled:?}");
}
