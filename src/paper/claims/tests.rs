//! Claims on made-up runs whose answers are known.

use super::*;
use crate::measure::{Interval, testing::assert_near};
use crate::paper::{ClaimKind, Departs, Departure, Verdict, canned};
use crate::record::SecondarySieve;

fn claim(study: &StudyView, id: &str) -> Claim {
    let found: Vec<Claim> = claims(study).into_iter().filter(|c| c.id == id).collect();
    assert_eq!(found.len(), 1, "expected one claim `{id}`, got {}", found.len());
    found.into_iter().next().expect("just counted")
}

fn near(what: &str, expected: f64, got: Option<f64>, tolerance: f64) {
    assert_near(what, expected, got.expect("a number"), tolerance);
}

#[test]
fn identifiers_are_unique_and_every_claim_has_a_source() {
    let runs = canned::valid_runs();
    let claims = claims(&canned::study(&runs));
    let mut ids: Vec<&str> = claims.iter().map(|c| c.id.as_str()).collect();
    ids.sort_unstable();
    ids.dedup();
    assert_eq!(ids.len(), claims.len(), "an id occurs twice");
    for c in &claims {
        assert!(c.source.starts_with("Section") && !c.statement.is_empty(), "{c:?}");
    }
}

#[test]
fn the_paper_itself_is_within() {
    let runs = canned::valid_runs();
    let study = canned::study(&runs);
    for id in
        ["grain-count", "total-mass", "grains-in-100-g", "solid-density", "poorly-graded-gravel"]
    {
        let c = claim(&study, id);
        assert_eq!(c.verdict, Verdict::Within, "{c:?}");
    }
    near("tan 38.40°", 0.792_590, claim(&study, "friction-is-tangent-of-repose").ours, 1e-6);
}

#[test]
fn grains_that_are_not_the_papers_are_outside() {
    let runs = canned::valid_runs();
    let mut study = canned::study(&runs);
    study.grain_count = 1000;
    study.gradation.uscs = "GW".into();
    study.solids_volume_cm3 *= 1.01;
    for id in ["grain-count", "grains-in-100-g", "solid-density", "poorly-graded-gravel"] {
        let c = claim(&study, id);
        assert_eq!(c.verdict, Verdict::Outside, "{c:?}");
    }
    assert_eq!(claim(&study, "no-crushing").verdict, Verdict::Outside, "1456 grains became 1000");
}

#[test]
fn grains_that_changed_or_are_lost_are_no_proof_that_none_was_crushed() {
    let claim_of = |change: &dyn Fn(&mut SecondarySieve)| {
        let mut runs = canned::valid_runs();
        let analysis = runs[3].summary.sieve_analysis.as_mut().expect("sieved");
        change(analysis.secondary.as_mut().expect("sieved anew"));
        claim(&canned::study(&runs), "no-crushing")
    };
    let c = claim_of(&|_| ());
    assert_eq!((c.verdict, c.ours), (Verdict::Within, Some(0.0)), "none changed: {c:?}");
    let c = claim_of(&|s| s.changed = 2);
    assert_eq!((c.verdict, c.ours), (Verdict::Outside, Some(2.0)), "two changed: {c:?}");
    let c = claim_of(&|s| s.lost = 1);
    assert_eq!((c.verdict, c.ours), (Verdict::Outside, Some(1.0)), "one is lost: {c:?}");
    assert!(!c.note.contains("kept every one"), "law: one was not kept: {}", c.note);
    let c = claim_of(&|s| (s.changed, s.largest_change_percent) = (1, None));
    assert!(c.note.contains("The largest change is no number."), "law: said, got {}", c.note);
    let c = claim_of(&|s| s.spilled = 1);
    assert_eq!(c.verdict, Verdict::Within, "what spilled is accounted for: {c:?}");
    let mut runs = canned::valid_runs();
    runs[3].summary.sieve_analysis.as_mut().expect("sieved").secondary = None;
    let c = claim(&canned::study(&runs), "no-crushing");
    assert_eq!((c.verdict, c.ours), (Verdict::NotRun, None), "one was not sieved anew: {c:?}");
    assert_eq!(c.reason, "not measured", "law: why: {c:?}");
    let none = claim(&canned::study(&[]), "no-crushing").note;
    for found in ["The largest change is", "every one as it was made"] {
        assert!(!none.contains(found), "law: nothing is found of no run: {none}");
    }
    assert!(c.note.contains("Not measured"), "{}", c.note);
}

#[test]
fn both_curves_must_be_poorly_graded() {
    let runs = canned::valid_runs();
    let mut study = canned::study(&runs);
    study.generated.as_mut().expect("generated").uscs = "GW".into();
    let c = claim(&study, "poorly-graded-gravel");
    assert_eq!(c.verdict, Verdict::Outside, "well graded as generated: {c:?}");
}

#[test]
fn standing_heights_fall_by_what_they_were_made_to() {
    let runs = canned::valid_runs();
    let study = canned::study(&runs);
    let c = claim(&study, "standing-height-falls");
    assert_eq!((c.verdict, c.ours), (Verdict::Within, Some(3.0)), "{c:?}");
    near(
        "slope in mm per cm",
        canned::SLOPE_MM_PER_CM,
        claim(&study, "standing-height-slope").ours,
        1e-9,
    );
    assert_eq!(claim(&study, "standing-height-slope").verdict, Verdict::NotStated);
    let range = claim(&study, "standing-height-reproducible");
    near("range over configurations", 2.0 * canned::CONFIGURATION_STEP_MM, range.ours, 1e-9);
}

/// Law: the slope is that of configurations with every falling height, as its note says.
#[test]
fn a_configuration_without_every_height_has_no_part_in_the_slope() {
    let mut runs = canned::valid_runs();
    runs.retain(|run| {
        let is_of_third = run.kind == RunKind::Pluviation && run.configuration == 3;
        !is_of_third || run.falling_height_mm < 150.0
    });
    // What is left of it rises by much more than the others fall.
    for run in runs.iter_mut().filter(|r| r.configuration == 3) {
        run.summary.standing_height_mm.mean_surface += run.falling_height_mm;
    }
    let study = canned::study(&runs);
    assert_eq!(trend(&study).configurations, [1, 2], "law: those with every height");
    let c = claim(&study, "standing-height-slope");
    near("slope of the others in mm per cm", canned::SLOPE_MM_PER_CM, c.ours, 1e-9);
    let ends = c.spread.map(|of| (of.low, of.high)).expect("two slopes");
    for end in [ends.0, ends.1] {
        near("either slope in mm per cm", canned::SLOPE_MM_PER_CM, Some(end), 1e-9);
    }
}

#[test]
fn a_height_that_rises_is_not_hidden() {
    let mut runs = canned::valid_runs();
    let run = runs
        .iter_mut()
        .find(|r| r.configuration == 2 && r.falling_height_mm == 200.0)
        .expect("a run");
    run.summary.standing_height_mm.mean_surface = 170.0;
    let c = claim(&canned::study(&runs), "standing-height-falls");
    assert_eq!((c.verdict, c.ours), (Verdict::Outside, Some(2.0)), "{c:?}");
}

#[test]
fn settlements_are_judged_run_by_run() {
    let runs = canned::valid_runs();
    let study = canned::study(&runs);
    // Configurations settle by 16, 18 and 20 mm.
    for (configuration, expected) in
        [(1, Verdict::Within), (2, Verdict::Within), (3, Verdict::Outside)]
    {
        let c = claim(&study, &format!("continuous-final-settlement-{configuration}"));
        let made = canned::final_settlement_mm(configuration);
        near("final settlement", made, c.ours, 1e-9);
        assert_eq!(c.verdict, expected, "14 ≤ {made} ≤ 19.61: {c:?}");
        assert_eq!(c.runs.len(), 1, "read from one run: {c:?}");
    }
}

#[test]
fn shares_are_percent_with_a_stated_interpretation() {
    let runs = canned::valid_runs();
    let study = canned::study(&runs);
    let c = claim(&study, "continuous-share-after-5-s-1");
    near("share in percent", 100.0 * canned::SHARE_AFTER_5_S, c.ours, 1e-9);
    assert_eq!(c.read_as, Some(Interval::new(75.0, 85.0)), "{c:?}");
    assert_eq!(c.verdict, Verdict::Within, "{c:?}");
    let c = claim(&study, "intermittent-share-in-first-period-1");
    near("share in percent", 85.0, c.ours, 1e-9);
}

#[test]
fn missing_runs_never_read_as_within() {
    let none = [];
    let mut study = canned::study(&none);
    for c in claims(&study) {
        let needs_runs = c.ours.is_none();
        assert!(!needs_runs || c.note.contains("Not run"), "without runs: {c:?}");
        if needs_runs && c.kind != ClaimKind::NoNumber {
            assert_eq!(
                c.verdict,
                Verdict::NotRun,
                "law: what was not measured misses nothing: {c:?}"
            );
        }
        if c.id.starts_with("continuous-final") {
            assert!(needs_runs && c.kind == ClaimKind::Result, "{c:?}");
        }
    }
    // One configuration of three done: the count stays below the three expected.
    let one: Vec<_> = canned::valid_runs().into_iter().filter(|r| r.configuration == 1).collect();
    study = canned::study(&one);
    for id in ["standing-height-falls", "denser-after-vibration", "plate-moves-down"] {
        let c = claim(&study, id);
        assert_eq!(c.verdict, Verdict::NotRun, "two configurations are missing: {c:?}");
        assert!(c.note.contains("Not run") && c.reason.contains("not run"), "{c:?}");
    }
    // Of the one that was done the height rises: that is a miss, whatever the others would show.
    let mut rises = one.clone();
    let low = rises.iter_mut().find(|r| r.falling_height_mm == 200.0).expect("a run");
    low.summary.standing_height_mm.mean_surface = 170.0;
    let c = claim(&canned::study(&rises), "standing-height-falls");
    assert_eq!(c.verdict, Verdict::Outside, "law: what was run and misses is outside: {c:?}");
}

/// Law: what was run and does not tell is not measured, which is not a run that is missing.
#[test]
fn what_was_run_and_does_not_tell_is_not_measured() {
    let mut runs = canned::valid_runs();
    for run in &mut runs {
        run.series.clear();
    }
    let c = claim(&canned::study(&runs), "intermittent-fluctuation-at-ends");
    assert_eq!((c.verdict, c.reason.as_str()), (Verdict::NotRun, "not measured"), "{c:?}");
    for run in &mut runs {
        run.summary.void_ratio = None;
    }
    let c = claim(&canned::study(&runs), "denser-after-vibration");
    assert_eq!((c.verdict, c.reason.as_str()), (Verdict::NotRun, "not measured"), "{c:?}");
    assert_eq!(c.runs.len(), 6, "law: the runs that would tell: {c:?}");
    for run in &mut runs {
        run.summary.standing_height_mm.mean_surface = f64::NAN;
    }
    let c = claim(&canned::study(&runs), "standing-height-falls");
    assert_eq!((c.verdict, c.reason.as_str()), (Verdict::NotRun, "not measured"), "{c:?}");
    assert_eq!(c.runs.len(), 6, "law: likewise, from 0 and from 20 cm: {c:?}");
    let mut spoilt = runs.clone();
    for run in &mut spoilt {
        (run.summary.meets_standard, run.summary.valid) = (false, false);
    }
    let c = claim(&canned::study(&spoilt), "standing-height-falls");
    assert_eq!((c.verdict, c.left_out.len()), (Verdict::NotComparable, 6), "law: {c:?}");
    let c = claim(&canned::study(&runs[..4]), "intermittent-fluctuation-at-ends");
    assert_eq!((c.verdict, c.reason.as_str()), (Verdict::NotRun, "not run"), "{c:?}");
}

/// Law: a run that is left out is not called missing where it does not tell, as one whose void
/// ratio is withheld because most of its grains hang in the funnel; it is named.
#[test]
fn a_jam_that_does_not_tell_is_left_out_and_not_missing() {
    let mut runs = canned::valid_runs();
    let name = "vibration-intermittent-c2";
    let jammed = runs.iter_mut().find(|r| r.name == name).expect("a run");
    jammed.summary.grains.missing = Some(900);
    (jammed.summary.void_ratio, jammed.summary.poured_void_ratio) = (None, None);
    jammed.series.clear();
    for (id, expected) in
        [("denser-after-vibration", 5.0), ("intermittent-fluctuation-at-ends", 2.0)]
    {
        let c = claim(&canned::study(&runs), id);
        assert_eq!(c.read_as.map(|of| of.high), Some(expected), "law: of the others: {c:?}");
        assert!(!c.note.contains("Not run") && c.reason.is_empty(), "law: it was run: {c:?}");
        assert_eq!(c.left_out, [name], "law: named: {c:?}");
    }
}

/// Law: what was chosen is an input, what could have come out otherwise a result.
#[test]
fn inputs_are_no_results() {
    let runs = canned::valid_runs();
    let claims = claims(&canned::study(&runs));
    let of = |kind| -> Vec<&str> {
        claims.iter().filter(|c| c.kind == kind).map(|c| c.id.as_str()).collect()
    };
    let inputs = [
        "grain-count",
        "total-mass",
        "grains-in-100-g",
        "solid-density",
        "poorly-graded-gravel",
        "friction-is-tangent-of-repose",
        "no-crushing",
        "plate-monitored-every-0.08-s",
    ];
    assert_eq!(of(ClaimKind::Input), inputs);
    assert_eq!(of(ClaimKind::Result).len(), 1 + 2 + 3 * 3 + 1, "{:?}", of(ClaimKind::Result));
    for c in &claims {
        let unstated = c.kind == ClaimKind::NoNumber;
        assert_eq!(c.paper.is_none(), unstated, "law: no number, no comparison: {c:?}");
        assert_eq!(c.verdict == Verdict::NotStated, unstated, "law: {c:?}");
    }
}

/// Law: the quick study compares nothing that depends on the full size, says why, and still
/// compares what does not; what was not run stays not run.
#[test]
fn the_quick_study_compares_nothing_of_the_full_size() {
    let mut runs = canned::valid_runs();
    runs.retain(|r| r.name != "vibration-continuous-c3");
    let mut study = canned::study(&runs);
    let full = claims(&study);
    study.quick = true;
    study.grain_count = 364;
    let quick = claims(&study);
    for (c, full) in quick.iter().zip(&full) {
        let judged = |v| matches!(v, Verdict::Within | Verdict::Outside);
        if c.full_size && judged(full.verdict) {
            assert_eq!(c.verdict, Verdict::NotComparable, "law: {c:?}");
            assert!(c.reason.contains("364 grains instead of 1456"), "law: in words: {c:?}");
            assert!(c.ours.is_some(), "law: shown all the same: {c:?}");
        } else if c.id != "grains-in-100-g" && c.id != "no-crushing" {
            assert_eq!(c.verdict, full.verdict, "law: {c:?}");
        }
    }
    let of = |id: &str| quick.iter().find(|c| c.id == id).map(|c| c.verdict);
    assert_eq!(of("grain-count"), Some(Verdict::NotComparable));
    assert_eq!(of("continuous-final-settlement-1"), Some(Verdict::NotComparable));
    assert_eq!(of("continuous-final-settlement-3"), Some(Verdict::NotRun));
    assert_eq!(of("solid-density"), Some(Verdict::Within));
    let below = |of: &[Claim]| {
        let found = of.iter().find(|c| c.id == "intermittent-case-below-minimum");
        found.expect("a claim").clone()
    };
    assert_eq!((below(&full).ours, below(&quick).ours), (Some(0.0), None), "law: not counted");
    let why = "Not compared: 364 grains instead of 1456, shaken for less time.";
    assert!(below(&quick).note.ends_with(why), "law: why, got {}", below(&quick).note);
    assert!(
        full.iter().all(|c| !c.reason.contains("instead of")),
        "law: the paper's own is compared"
    );
}

/// Law: of a changed specimen or programme nothing is compared that depends on the change, with the
/// reason; all else is.
#[test]
fn a_changed_programme_compares_nothing_that_depends_on_the_change() {
    let runs = canned::valid_runs();
    let study = canned::study(&runs);
    let verdict = |study: &StudyView, id: &str| claim(study, id).verdict;
    for (of, not) in [
        (Departs::Grains, [true, true, true]),
        (Departs::Cylinder, [false, true, true]),
        (Departs::Shaking, [false, false, true]),
    ] {
        let words = "another value".to_owned();
        let changed = StudyView { departures: vec![Departure { of, words }], ..study.clone() };
        let ids = ["grain-count", "standing-height-falls", "continuous-final-settlement-1"];
        for (id, not) in ids.into_iter().zip(not) {
            let c = claim(&changed, id);
            let expected = if not { Verdict::NotComparable } else { verdict(&study, id) };
            assert_eq!(c.verdict, expected, "law: {id} of {of:?}: {c:?}");
            let reason = if not { "another value" } else { "" };
            assert_eq!((c.reason.as_str(), c.is_missed() && not), (reason, false), "law: {c:?}");
        }
        let same = verdict(&changed, "solid-density");
        assert_eq!(same, verdict(&study, "solid-density"), "law: whatever its size");
    }
}

/// Law: a configuration that lacks a height does not show each step, and is not counted.
#[test]
fn a_step_that_is_missing_is_not_taken() {
    let mut runs = canned::valid_runs();
    let of = |runs: &[RunRecord]| claim(&canned::study(runs), "standing-height-monotone");
    let whole = of(&runs);
    assert!(whole.note.starts_with("Of 3."), "law: all three: {}", whole.note);
    // The second stands higher from 10 cm than from 5.
    let higher = runs.iter_mut().find(|r| r.name == "pluviation-fh10-c2").expect("a run");
    higher.summary.standing_height_mm.mean_surface += 50.0;
    assert_eq!((whole.ours, of(&runs).ours), (Some(3.0), Some(2.0)), "law: it rises once");
    runs.retain(|r| r.name != "pluviation-fh10-c2");
    let two = of(&runs);
    assert_eq!(two.ours, Some(2.0), "law: of the others, not of a step from 5 to 20 cm: {two:?}");
    assert!(two.note.starts_with("Of 2."), "law: as many: {}", two.note);
}

/// Law: what the quick study is too short to show is no miss of a strict reader; of the paper's own
/// programme it is one.
#[test]
fn what_the_quick_study_is_too_short_for_is_no_miss() {
    let mut runs = canned::valid_runs();
    for settled in runs.iter_mut().filter_map(|run| run.summary.settlement_mm.as_mut()) {
        settled.share_after_5_s = None;
    }
    let study = canned::study(&runs);
    let quick = StudyView { quick: true, grain_count: 364, ..study.clone() };
    let is_missed = |of: &StudyView| claim(of, "continuous-share-after-5-s-1").is_missed();
    assert_eq!((is_missed(&study), is_missed(&quick)), (true, false), "law: full size, quick");
}

#[test]
fn looser_after_vibration_is_outside() {
    let mut runs = canned::valid_runs();
    let run = runs.iter_mut().find(|r| r.summary.poured_void_ratio.is_some()).expect("a run");
    run.summary.void_ratio = Some(1.2);
    let c = claim(&canned::study(&runs), "denser-after-vibration");
    assert_eq!((c.verdict, c.ours), (Verdict::Outside, Some(5.0)), "{c:?}");
}

#[test]
fn the_band_of_figure_10_is_not_replaced() {
    let mut runs = canned::valid_runs();
    for run in &mut runs {
        if run.kind == crate::record::RunKind::VibrationIntermittent && run.configuration == 1 {
            run.summary.settlement_mm.as_mut().expect("vibrated").final_mm = 12.46;
        }
    }
    let c = claim(&canned::study(&runs), "intermittent-case-below-minimum");
    assert_eq!((c.verdict, c.ours, c.paper), (Verdict::NotStated, Some(1.0), None), "{c:?}");
    assert!(c.note.contains("11 % (configuration 1)"), "1 − 12.46/14 = 11 %: {}", c.note);
}

#[test]
fn sampling_is_the_papers() {
    let runs = canned::valid_runs();
    let c = claim(&canned::study(&runs), "plate-monitored-every-0.08-s");
    near("interval in s", 0.08, c.ours, 1e-9);
    assert_eq!(c.verdict, Verdict::Within);
}

#[test]
fn values_that_are_no_numbers_do_not_panic_or_pass() {
    let mut runs = canned::valid_runs();
    for run in &mut runs {
        run.summary.standing_height_mm.mean_surface = f64::NAN;
        run.summary.void_ratio = Some(f64::NAN);
        run.series.clear();
        if let Some(s) = &mut run.summary.settlement_mm {
            s.final_mm = f64::NAN;
            s.share_after_5_s = Some(f64::NAN);
        }
    }
    let claims = claims(&canned::study(&runs));
    let json = serde_json::to_string(&claims).expect("NaN never reaches JSON");
    assert!(!json.contains("NaN"), "a claim shows NaN");
    for c in claims.iter().filter(|c| c.id.starts_with("continuous-") || c.id.starts_with("denser"))
    {
        assert_ne!(c.verdict, Verdict::Within, "{c:?}");
    }
}

/// Law: a claim's value is of the runs that count; what is left out is named, and where nothing
/// counts the claim is not comparable, whatever the runs show.
#[test]
fn what_is_not_valid_makes_no_claim() {
    // The third configuration is not valid, the others are.
    let spoilt = canned::runs();
    let study = canned::study(&spoilt);
    let third = claim(&study, "continuous-final-settlement-3");
    assert_eq!((third.verdict, third.ours), (Verdict::NotComparable, None), "{third:?}");
    assert_eq!(third.not_valid.map(|n| n.value), Some(20.0), "law: shown apart: {third:?}");
    assert!(third.note.contains("the accuracy standard is not met"), "law: why: {}", third.note);
    assert!(!third.note.contains("Not run"), "law: it was run: {}", third.note);
    let first = claim(&study, "continuous-final-settlement-1");
    assert_eq!((first.verdict, first.left_out.len()), (Verdict::Within, 0), "{first:?}");
    assert_eq!(first.not_valid, None, "law: a valid run stands alone");

    // Counts: the two that count both fall, and two are expected.
    let falls = claim(&study, "standing-height-falls");
    assert_eq!((falls.verdict, falls.ours), (Verdict::Within, Some(2.0)), "{falls:?}");
    assert!(!falls.note.contains("Not run"), "law: left out is not missing: {}", falls.note);
    let names = ["pluviation-fh00-c3", "pluviation-fh20-c3"];
    assert_eq!(falls.left_out, names, "law: named");
    for id in ["denser-after-vibration", "plate-moves-down"] {
        let c = claim(&study, id);
        assert_eq!((c.verdict, c.ours), (Verdict::Within, Some(4.0)), "of four: {c:?}");
        assert_eq!(c.left_out.len(), 2, "law: both modes of the third: {c:?}");
    }

    // Means and spreads: configurations 1 and 2 stand 0.9 mm apart, 1 and 3 twice that.
    let range = claim(&study, "standing-height-reproducible");
    near("the range of those that count", canned::CONFIGURATION_STEP_MM, range.ours, 1e-9);
    let every = canned::valid_runs();
    let range = claim(&canned::study(&every), "standing-height-reproducible");
    near("the range of all", 2.0 * canned::CONFIGURATION_STEP_MM, range.ours, 1e-9);

    // A jam is left out as well, though the run is valid.
    let mut jammed = canned::valid_runs();
    for run in jammed.iter_mut().filter(|r| r.configuration == 3) {
        run.summary.grains.missing = Some(300);
    }
    let third = claim(&canned::study(&jammed), "continuous-final-settlement-3");
    assert_eq!(third.verdict, Verdict::NotComparable, "{third:?}");
    assert!(third.note.contains("300 of 1456 grains are missing"), "{}", third.note);

    // Where nothing counts nothing reads as within or outside.
    let mut none = canned::valid_runs();
    for run in &mut none {
        (run.summary.meets_standard, run.summary.valid) = (false, false);
    }
    let of_none = claims(&canned::study(&none));
    let valid = claims(&canned::study(&every));
    assert_eq!(of_none.len(), valid.len(), "law: the same claims");
    for (c, valid) in of_none.iter().zip(&valid).filter(|(_, valid)| !valid.runs.is_empty()) {
        assert_eq!((c.ours, c.left_out.len()), (None, valid.runs.len()), "{c:?}");
        let expected = match valid.paper {
            Some(_) => Verdict::NotComparable,
            None => Verdict::NotStated,
        };
        assert_eq!(c.verdict, expected, "law: {c:?}");
        assert_eq!(c.not_valid.map(|n| n.value), valid.ours, "law: the same number, apart: {c:?}");
    }
    // Where all count nothing is left out.
    assert!(valid.iter().all(|c| c.left_out.is_empty() && !c.note.contains("eft out")));
}
