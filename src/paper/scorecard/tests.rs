//! Scorecards of made-up studies whose answers are known.

use super::{
    headline::{CALIBRATED, MOVES_QUICK_SETTLEMENT, MOVES_SETTLEMENT},
    *,
};
use crate::paper::{
    canned, claims,
    constants::{GRAIN_COUNT, TOTAL_MASS_G},
};
use crate::record::{RunKind, RunRecord};

fn card(study: &StudyView) -> Scorecard {
    scorecard(study, &claims(study))
}

/// All that the card says above its rows, as one line.
fn words(card: &Scorecard) -> String {
    format!("{} {}", card.paragraph, card.reasons).replace('\n', " ")
}

fn row<'a>(card: &'a Scorecard, id: &str) -> &'a ScoreRow {
    card.rows.iter().find(|r| r.id == id).unwrap_or_else(|| panic!("no row `{id}`: {card:#?}"))
}

/// A run likewise, with another placement of the plate, which settles by a number of mm.
fn placed_anew(run: &RunRecord, mm: f64) -> RunRecord {
    let mut run = run.clone();
    run.kind = RunKind::VibrationPlacement;
    run.name = format!("{}-at-{mm}", run.name);
    run.summary.settlement_mm.as_mut().expect("vibrated").final_mm = mm;
    run
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
    let text = &words(&card);
    let counted = "Reproduced: gravel that falls from higher stands lower (3 of 3 configurations);";
    assert!(text.starts_with(counted), "law: a count without its mean: {text}");
    // The made-up plates move as much in the middle of a period.
    let ends = row(&card, "intermittent-fluctuation-at-ends");
    assert_eq!(ends.in_words, "0 of 3 configurations; ratio 0.97 [0.97 … 0.97]", "{ends:?}");
    assert_eq!(ends.decided, Some(true), "law: the ratio is below 1 with its interval: {ends:?}");
    let missed = format!(
        "Not reproduced: the plate moves most as a period begins and ends (only {}).",
        ends.in_words
    );
    assert!(text.contains(&missed), "{text}");
    assert!(text.contains("All 18 runs are valid"), "{text}");
}

/// Law: the tally counts rows, each once however many configurations there are, and a row that is
/// not decided neither as within nor as outside; what is no result changes nothing of it.
#[test]
fn the_tally_is_of_rows() {
    let runs = canned::valid_runs();
    let mut study = canned::study(&runs);
    let before = card(&study);
    // The third configuration settles by 20 mm, beyond 19.61; no period has its ends apart.
    let expected = ResultCounts { within: 11, outside: 2, not_run: 0, not_comparable: 0 };
    assert_eq!(before.results, expected, "law: entries of claims.json");
    let begins = ["Reproduced: ", "Not reproduced: ", "Not decided "];
    let begins_so = |line: &str| begins.iter().any(|begin| line.starts_with(begin));
    assert!(before.paragraph.lines().all(begins_so), "law: verdicts alone: {}", before.paragraph);
    assert!(!before.paragraph.contains("rows: "), "law: the tally is below: {}", before.paragraph);
    let expected =
        RowCounts { within: 4, outside: 1, not_decided: 1, not_stated: 1, ..RowCounts::default() };
    assert_eq!(before.tally, expected, "law: rows");
    assert!(
        words(&before).ends_with("7 rows: 4 within, 1 outside, 1 not decided, 1 not stated."),
        "{}",
        words(&before)
    );
    study.grain_count = 1000;
    study.gradation.uscs = "GW".into();
    assert_eq!(card(&study).tally, expected, "law: wrong inputs are no missed result");
    let two: Vec<RunRecord> = runs.into_iter().filter(|r| r.configuration < 3).collect();
    let of_two = card(&StudyView { configurations: 2, ..canned::study(&two) });
    assert_eq!(of_two.rows.len(), before.rows.len(), "law: as many rows of two as of three");
    assert!(words(&of_two).contains("7 rows: "), "{}", words(&of_two));
}

/// Law: with placements of the plate the row is judged by the mean over specimens of their means
/// over placements, with the interval that holds both scatters; without, it says that there is one.
#[test]
fn placements_judge_the_settlement_where_there_are_any() {
    let mut runs = canned::valid_runs();
    let one = card(&canned::study(&runs));
    let settled = row(&one, "continuous-final-settlement");
    assert!(settled.note.starts_with("One placement of the plate per specimen."), "{settled:?}");
    let placed = runs.iter().filter(|r| r.kind == RunKind::VibrationContinuous);
    let placed: Vec<RunRecord> = placed
        .zip([[10.0, 12.0], [16.0, 18.0], [20.0, 22.0]])
        .flat_map(|(run, finals)| finals.map(|mm| placed_anew(run, mm)))
        .collect();
    runs.extend(placed);
    let card = card(&canned::study(&runs));
    let settled = row(&card, "continuous-final-settlement");
    // Means of 11, 17 and 21 mm: 16.33, s = 5.033, half width 4.30265 · 5.033/√3.
    let interval = settled.interval.expect("three specimens");
    let (expected, half) = (49.0 / 3.0, 4.302_653 * (76.0_f64 / 3.0).sqrt() / 3f64.sqrt());
    let mean = settled.ours.expect("a mean");
    assert!((mean - expected).abs() < 1e-9, "law: {expected}, got {mean}, tolerance 1e-9");
    assert!((interval.high - mean - half).abs() < 1e-3, "law: ±{half}, got {interval:?}");
    assert_eq!((settled.count, settled.left_out), (6, 0), "{settled:?}");
    assert!(settled.note.contains("3 specimens' means over 6 placements"), "{}", settled.note);
    assert_eq!(settled.stands(), None, "law: 3.8 to 28.8 mm decides nothing");
    let other = row(&card, "intermittent-in-laboratory-range");
    assert!(other.note.contains("One placement"), "law: it has no others: {other:?}");
}

/// Law: placements that count judge the row also where no run of the programme's own plate does.
#[test]
fn placements_judge_where_no_run_of_the_programme_counts() {
    let mut runs = canned::valid_runs();
    let own = runs.iter().filter(|r| r.kind == RunKind::VibrationContinuous).cloned();
    let placed: Vec<RunRecord> =
        own.zip([17.0, 17.1, 17.2]).map(|(run, mm)| placed_anew(&run, mm)).collect();
    for run in runs.iter_mut().filter(|r| r.kind == RunKind::VibrationContinuous) {
        run.summary.grains.missing = Some(300);
    }
    let alone = card(&canned::study(&runs));
    let settled = row(&alone, "continuous-final-settlement");
    assert_eq!((settled.verdict, settled.ours), (Verdict::NotComparable, None), "{settled:?}");
    runs.extend(placed);
    let judged = card(&canned::study(&runs));
    let settled = row(&judged, "continuous-final-settlement");
    assert_eq!(settled.verdict, Verdict::Within, "law: 14 ≤ 17.1 ≤ 19.61: {settled:?}");
    assert_eq!((settled.count, settled.reason.as_str()), (3, ""), "{settled:?}");
    let quick = card(&StudyView { quick: true, grain_count: 364, ..canned::study(&runs) });
    let settled = row(&quick, "continuous-final-settlement");
    assert_eq!(settled.verdict, Verdict::NotComparable, "law: of full size alone: {settled:?}");
}

/// Law: the angle's row says by what it is judged, with the half width, within and outside.
#[test]
fn the_angle_says_that_scatter_helps_it() {
    let of = |degrees: [f64; 3]| {
        let mut runs = canned::valid_runs();
        runs.extend((1..).zip(degrees).map(|(c, degrees)| canned::pile(c, Some(degrees))));
        card(&canned::study(&runs))
    };
    // 38 ± 4.30265 · 1/√3 = 38 ± 2.5.
    let near = of([37.0, 38.0, 39.0]);
    let angle = row(&near, "angle-of-repose");
    assert_eq!((angle.verdict, angle.decided), (Verdict::Within, None), "{angle:?}");
    assert!(angle.note.contains("±2.5°") && angle.note.contains("more easily"), "{angle:?}");
    let said = "our interval of ±2.5° holds the paper's 38.40°";
    assert!(words(&near).contains(said), "{}", words(&near));
    for missed in [of([43.0, 44.0, 45.0]), of([33.0, 34.0, 35.0])] {
        assert_eq!(row(&missed, "angle-of-repose").verdict, Verdict::Outside);
        let text = &words(&missed);
        assert!(text.contains(CALIBRATED), "law: why, above and below 38.40°: {text}");
    }
}

/// Law: the friction that a pile of 38.40° needs is quoted as it was measured.
#[test]
fn the_calibrated_friction_is_that_of_the_calibration() {
    let text = include_str!("../../../docs/results/calibration/calibrate.json");
    let found: serde_json::Value = serde_json::from_str(text).expect("JSON");
    let solution = &found["solution"];
    let number = |of: &serde_json::Value| format!("{:.2}", of.as_f64().expect("a number"));
    let [low, high] = ["low", "high"].map(|end| number(&solution["interval_95"][end]));
    let value = number(&solution["value"]);
    assert_eq!(found["wanted"], 38.4, "law: the angle");
    // The pile has the same share of the paper's mass and of its grains.
    assert_eq!(found["scenario"], "quick-repose", "law: the pile");
    let text = include_str!("../../../scenarios/quick/repose.json");
    let pile: serde_json::Value = serde_json::from_str(text).expect("JSON");
    let mass_g = pile["grains"]["total_mass_g"].as_f64().expect("a mass");
    let grains = GRAIN_COUNT as f64 * mass_g / TOTAL_MASS_G;
    let tangent = 38.4_f64.to_radians().tan();
    for said in [
        format!("of {value} "),
        format!("{low} to {high}"),
        format!(" {grains:.0} grains"),
        format!("angle, {tangent:.3}, as"),
    ] {
        assert!(CALIBRATED.contains(&said), "law: `{said}` in {CALIBRATED}");
    }
}

/// Law: what is said to move the settlement and its shares at full size did so beyond scatter,
/// what is said to have shown no effect did not, and specimens with the paper's share in the first
/// period are as many as are said.
#[test]
fn what_moves_the_settlement_is_as_it_was_measured() {
    let text = include_str!("../../../docs/results/joint/targets.json");
    let found: serde_json::Value = serde_json::from_str(text).expect("JSON");
    let target = |runs: &str, result: &str| {
        let all = found["targets"].as_array().expect("targets");
        let wanted = all.iter().find(|t| t["runs"] == runs && t["result"] == result);
        wanted.unwrap_or_else(|| panic!("{runs}: {result}"))
    };
    let number = |of: &serde_json::Value| of.as_f64().expect("a number");
    let effect = |of: &serde_json::Value, factor: &str| {
        let [change, half] = [0_usize, 1].map(|n| number(&of["effects"][factor][n]));
        (change, change.abs() > half)
    };
    let settled = target("continuous", "settlement_mm.final");
    let early = target("continuous", "settlement_mm.after_5_s");
    let first = target("intermittent", "settlement_mm.after_each_period.0");
    for (of, sign) in [(settled, -1.0), (early, -1.0), (first, 1.0)] {
        let (change, beyond) = effect(of, "stages.3.ramp_s");
        assert!(beyond, "law: a gradual start and stop moves it, got {change} of {of}");
        assert!(sign * change > 0.0, "law: it has the sign {sign}, got {change} of {of}");
        for factor in [
            "contact.grain_grain_friction",
            "grains.cells.relaxation_steps",
            "stages.3.amplitude_mm",
            "stages.3.crank_to_rod",
        ] {
            let (change, beyond) = effect(of, factor);
            assert!(!beyond, "law: {factor} shows none, got {change} of {of}");
        }
    }
    let [low, high] = ["low", "high"].map(|end| number(&first[end]));
    let text = include_str!("../../../docs/results/joint/intermittent-1.csv");
    let mut table = csv::Reader::from_reader(text.as_bytes());
    let header = table.headers().expect("a header").clone();
    // Specimens with the paper's share, and all: started at once, and gradually.
    let mut counts = [[0; 2]; 2];
    for record in table.records() {
        let record = record.expect("a row");
        let value = |name: &str| -> f64 {
            let place = header.iter().position(|n| n == name).expect("a column");
            record[place].parse().expect("a number")
        };
        let in_first = value("settlement_mm.after_each_period.0");
        let share = 100.0 * in_first / value("settlement_mm.final");
        let of = &mut counts[usize::from(value("stages.3.ramp_s") > 0.0)];
        of[0] += usize::from((low..=high).contains(&share));
        of[1] += 1;
    }
    let [[none, of], [some, of_as_many]] = counts;
    assert_eq!(none, 0, "law: without it none");
    for said in [format!("with it {some} of {of_as_many} "), format!("without it none of {of},")] {
        assert!(MOVES_SETTLEMENT.contains(&said), "law: `{said}` in {MOVES_SETTLEMENT}");
    }
}

/// Law: what is said to move the settlement of the quick specimen's plate is what its page has
/// beyond scatter, and nothing else is.
#[test]
fn what_moves_the_quick_settlement_is_as_its_page_says() {
    let page = include_str!("../../../docs/results/sensitivity-quick.md");
    let (_, table) = page.split_once("## Settlement of the plate").expect("its table");
    let table = table.split("\n## ").next().expect("up to the next heading");
    let rows = table.lines().filter(|line| line.starts_with("| ")).skip(2);
    let beyond: Vec<&str> = rows
        .filter(|row| !row.contains('~'))
        .filter_map(|row| row.split('|').nth(1))
        .map(str::trim)
        .collect();
    assert!(beyond.is_empty(), "law: none, got {beyond:?}");
    let said = "no parameter by itself moves the settlement of the plate beyond scatter";
    assert!(MOVES_QUICK_SETTLEMENT.contains(said), "law: {said}: {MOVES_QUICK_SETTLEMENT}");
}

/// Law: the kept scorecard gives today's reasons for what it misses or leaves open.
#[test]
fn the_kept_scorecard_says_what_is_said_today() {
    let text = include_str!("../../../docs/results/scorecard.json");
    let kept: serde_json::Value = serde_json::from_str(text).expect("JSON");
    let reasons = kept["reasons"].as_str().expect("reasons");
    for said in [MOVES_SETTLEMENT, MOVES_QUICK_SETTLEMENT, CALIBRATED] {
        assert!(reasons.contains(said), "law: expected `{said}`, got `{reasons}`");
    }
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
        (settled.verdict, settled.decided, words(&card))
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
        // One run has no interval that could leave it open.
        assert!(!got.2.contains("intervals leave"), "law: of {settled:?} mm, got {}", got.2);
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
        // 0.8 µm/s for the 23 s of four periods with their rests.
        "Numerical creep at rest: at most 0.80 µm/s; shaken specimens would creep numerically by at \
         most 0.02 mm in the time of their vibration.",
        MOVES_SETTLEMENT,
        MOVES_QUICK_SETTLEMENT,
        "What moves it was not investigated: the plate moves most",
    ] {
        assert!(words(&card).contains(said), "law: `{said}` in {}", words(&card));
    }
    let interlock = "Angular grains interlock";
    assert!(!words(&card).contains(interlock), "law: no pile is missed: {}", words(&card));
}

/// Law: numerical creep is said, whatever the verdicts, from the runs' own rest tests; a reason that
/// several rows share is said once.
#[test]
fn creep_is_said_and_a_shared_reason_once() {
    let mut runs = canned::valid_runs();
    let paragraph = |runs: &[RunRecord]| words(&card(&canned::study(runs)));
    // The settlement of 18 mm is within, and not decided.
    let creep = "Numerical creep at rest: at most 0.80 µm/s";
    assert!(paragraph(&runs).contains(creep), "{}", paragraph(&runs));
    for run in &mut runs {
        run.summary.creep_um_per_s = Some(1e-5);
        if let Some(settled) = &mut run.summary.settlement_mm {
            settled.share_after_5_s = Some(0.5);
            settled.after_each_period.iter_mut().for_each(|mm| *mm *= 0.5);
        }
    }
    let text = paragraph(&runs);
    let creep = "Numerical creep at rest: less than 0.01 µm/s; shaken specimens would creep \
                 numerically by less than 0.01 mm in the time of their vibration.";
    assert!(text.contains(creep), "{text}");
    assert_eq!(text.matches(MOVES_SETTLEMENT).count(), 1, "law: of three rows once: {text}");
    runs.iter_mut().for_each(|run| run.summary.creep_um_per_s = None);
    let text = paragraph(&runs);
    assert!(text.contains("Numerical creep was not measured."), "{text}");
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
    let text = &words(&card);
    assert!(text.starts_with("This is the quick study, of 364 grains"), "{text}");
    assert!(!text.contains("Not reproduced"), "{text}");
    assert!(text.contains("Nothing that could be compared is missed"), "{text}");
    assert_eq!(text.matches("Not compared").count(), 1, "law: one sentence: {text}");
    let said = "gravel that falls from higher stands lower (364 grains instead of 1456); settlement of \
                the plate after 20 s of vibration; share of the settlement in the first 5 s;";
    assert!(text.contains(said), "law: each statement with its own reason: {text}");
    let shared = "(364 grains instead of 1456, shaken for less time)";
    assert_eq!(text.matches(shared).count(), 1, "law: a shared reason once: {text}");
}

/// Law: a row of a vibration that is not as long as the paper's says how long ours is.
#[test]
fn a_shorter_vibration_is_named() {
    let mut runs = canned::valid_runs();
    let plain = card(&canned::study(&runs));
    for vibration in runs.iter_mut().flat_map(|run| run.summary.vibrations.iter_mut()) {
        for [begin, end] in &mut vibration.periods_s {
            *end = *begin + 0.1 * (*end - *begin);
        }
    }
    let short = card(&canned::study(&runs));
    for (id, said) in [
        ("continuous-final-settlement", "Ours is shaken for 2 s."),
        ("continuous-share-after-5-s", "Ours is shaken for 2 s."),
        ("intermittent-share-in-first-period", "Ours has periods of 0.5 s."),
        ("intermittent-in-laboratory-range", "Ours has periods of 0.5 s."),
    ] {
        let note = &row(&short, id).note;
        assert!(note.contains(said), "law: `{said}` of {id}, got `{note}`");
        let note = &row(&plain, id).note;
        assert!(!note.contains("Ours "), "law: as long as the paper's, got `{note}` of {id}");
    }
}

/// Law: what runs are too short to show is not called a run that is missing.
#[test]
fn what_the_quick_study_is_too_short_for_says_so() {
    let mut runs = canned::valid_runs();
    for settled in runs.iter_mut().filter_map(|run| run.summary.settlement_mm.as_mut()) {
        settled.share_after_5_s = None;
    }
    let quick = StudyView { quick: true, grain_count: 364, ..canned::study(&runs) };
    let card = card(&quick);
    let share = row(&card, "continuous-share-after-5-s");
    let got = (share.verdict, share.reason.as_str());
    assert_eq!(got, (Verdict::NotRun, "shaken for less time"), "law: {share:?}");
    let said = "Not run: share of the settlement in the first 5 s (shaken for less time).";
    assert!(words(&card).contains(said), "law: `{said}` in {}", words(&card));
}

/// Law: runs left out are counted in their row and make no mean; what was not run is not run.
#[test]
fn what_is_left_out_or_missing_is_no_result() {
    // The third configuration is not valid.
    let runs = canned::runs();
    let of_two = card(&canned::study(&runs));
    let settled = row(&of_two, "continuous-final-settlement");
    assert_eq!((settled.ours, settled.count, settled.left_out), (Some(17.0), 2, 1), "{settled:?}");
    let first = runs.iter().find(|r| !r.counts_in_means()).expect("a run");
    let said = format!(
        "6 of 18 runs with a result are left out of means; the first, {}: {}.",
        first.name,
        first.summary.why_left_out().join("; ")
    );
    assert!(words(&of_two).contains(&said), "law: with a reason: {}", words(&of_two));
    let poured: Vec<_> =
        canned::valid_runs().into_iter().filter(|r| r.kind == RunKind::Pluviation).collect();
    let poured = card(&canned::study(&poured));
    let settled = row(&poured, "continuous-final-settlement");
    assert_eq!((settled.verdict, settled.ours), (Verdict::NotRun, None), "{settled:?}");
    assert!(words(&poured).contains("Not run: gravel is denser"), "{}", words(&poured));
    assert!(!words(&poured).contains("Not reproduced"), "{}", words(&poured));
    let none = card(&canned::study(&[]));
    assert!(words(&none).starts_with("No run is finished yet"), "{}", words(&none));
    let spoilt: Vec<_> = runs.into_iter().filter(|r| r.configuration == 3).collect();
    let spoilt = card(&StudyView { configurations: 3, ..canned::study(&spoilt) });
    assert!(!spoilt.paragraph.is_empty(), "law: something is said: {spoilt:?}");
    let settled = row(&spoilt, "continuous-final-settlement");
    assert_eq!((settled.verdict, settled.ours), (Verdict::NotComparable, None), "{settled:?}");
}
