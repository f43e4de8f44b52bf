//! Claims on made-up runs whose answers are known.

use super::*;
use crate::paper::{Interval, Verdict, canned};
use crate::record::SecondarySieve;

fn claim(study: &StudyView, id: &str) -> Claim {
    let found: Vec<Claim> = claims(study).into_iter().filter(|c| c.id == id).collect();
    assert_eq!(found.len(), 1, "expected one claim `{id}`, got {}", found.len());
    found.into_iter().next().expect("just counted")
}

fn near(what: &str, expected: f64, got: Option<f64>, tolerance: f64) {
    let close = got.is_some_and(|g| (g - expected).abs() <= tolerance);
    assert!(close, "{what}: expected {expected} ± {tolerance}, got {got:?}");
}

#[test]
fn the_comparison_can_fail_both_ways() {
    for wrong in [Some(1.0 - 1e-3), Some(1.0 + 1e-3), None, Some(f64::NAN)] {
        let outcome = std::panic::catch_unwind(|| near("must fail", 1.0, wrong, 1e-6));
        assert!(outcome.is_err(), "{wrong:?} is not 1 ± 1e-6");
    }
}

#[test]
fn identifiers_are_unique_and_every_claim_has_a_source() {
    let runs = canned::runs();
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
    let runs = canned::runs();
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
    let runs = canned::runs();
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
        let mut runs = canned::runs();
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
    let c = claim_of(&|s| s.spilled = 1);
    assert_eq!(c.verdict, Verdict::Within, "what spilled is accounted for: {c:?}");
    let mut runs = canned::runs();
    runs[3].summary.sieve_analysis.as_mut().expect("sieved").secondary = None;
    let c = claim(&canned::study(&runs), "no-crushing");
    assert_eq!((c.verdict, c.ours), (Verdict::Outside, None), "one was not sieved anew: {c:?}");
    assert!(c.note.contains("Not measured"), "{}", c.note);
}

#[test]
fn both_curves_must_be_poorly_graded() {
    let runs = canned::runs();
    let mut study = canned::study(&runs);
    study.generated.as_mut().expect("generated").uscs = "GW".into();
    let c = claim(&study, "poorly-graded-gravel");
    assert_eq!(c.verdict, Verdict::Outside, "well graded as generated: {c:?}");
}

#[test]
fn standing_heights_fall_by_what_they_were_made_to() {
    let runs = canned::runs();
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

#[test]
fn a_height_that_rises_is_not_hidden() {
    let mut runs = canned::runs();
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
    let runs = canned::runs();
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
fn shares_are_percent_with_a_stated_reading() {
    let runs = canned::runs();
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
        assert!(
            !needs_runs || c.verdict != Verdict::Within && c.note.contains("Not run"),
            "without runs: {c:?}"
        );
        if c.id.starts_with("continuous-final") {
            assert!(needs_runs && c.verdict == Verdict::Outside, "{c:?}");
        }
    }
    // One configuration of three done: the count stays below the three expected.
    let one: Vec<_> = canned::runs().into_iter().filter(|r| r.configuration == 1).collect();
    study = canned::study(&one);
    for id in ["standing-height-falls", "denser-after-vibration", "plate-moves-down"] {
        let c = claim(&study, id);
        assert_eq!(c.verdict, Verdict::Outside, "two configurations are missing: {c:?}");
        assert!(c.note.contains("Not run"), "{c:?}");
    }
}

#[test]
fn looser_after_vibration_is_outside() {
    let mut runs = canned::runs();
    let run = runs.iter_mut().find(|r| r.summary.poured_void_ratio.is_some()).expect("a run");
    run.summary.void_ratio = Some(1.2);
    let c = claim(&canned::study(&runs), "denser-after-vibration");
    assert_eq!((c.verdict, c.ours), (Verdict::Outside, Some(5.0)), "{c:?}");
}

#[test]
fn the_lost_band_of_figure_10_is_not_replaced() {
    let mut runs = canned::runs();
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
    let runs = canned::runs();
    let c = claim(&canned::study(&runs), "plate-monitored-every-0.08-s");
    near("interval in s", 0.08, c.ours, 1e-9);
    assert_eq!(c.verdict, Verdict::Within);
}

#[test]
fn values_that_are_no_numbers_do_not_panic_or_pass() {
    let mut runs = canned::runs();
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
