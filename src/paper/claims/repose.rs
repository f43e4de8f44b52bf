//! Claims on the pile of slow pluviation: sections 2 and 3, Figure 2.
//!
//! The paper prints one angle and no scatter. No width is put in the place of
//! one: its number counts as met where the 95 % confidence interval of our mean
//! over the configurations holds it, as a measured mean and a number are
//! compared. One configuration has no such interval, and cannot be compared.

use super::*;

/// Why a single pile is not compared.
const ONE_PILE: &str = "one configuration has no interval";

/// Only where piles were simulated: the paper's simulations have none.
pub(super) fn claims(study: &StudyView) -> Vec<Claim> {
    if !study.runs.iter().chain(study.left_out).any(|r| r.kind == RunKind::Repose) {
        return Vec::new();
    }
    vec![laboratory(study), atan_friction(study)]
}

/// A claim on the mean angle, judged by the interval of the configurations.
fn judged(draft: Draft, study: &StudyView, stated: f64) -> Claim {
    let angles = study.values(RunKind::Repose, angle_of_repose);
    let mean = crate::measure::statistics::mean(&angles);
    let draft = draft.ours(mean).runs(study.of_kind(RunKind::Repose)).spread(angles.clone());
    let mut claim = draft.judge();
    claim.paper = Some(PaperValue::Value { value: stated });
    claim.kind = ClaimKind::Result;
    if let Some(t) = MeanTest::of(&angles, CONFIDENCE) {
        let interval = Interval::around(t.estimate.mean, t.half_width);
        claim.add_note(&format!(
            "Judged by our interval, the paper giving no scatter: mean of {} configurations {}°, 95 % \
             confidence interval {}° to {}°.",
            t.estimate.count,
            number(t.estimate.mean, 1),
            number(interval.low, 1),
            number(interval.high, 1),
        ));
        let holds = interval.contains(stated);
        claim.verdict = if holds { Verdict::Within } else { Verdict::Outside };
    } else if mean.is_some() {
        claim.add_note(
            "One configuration has no interval, and the paper gives no scatter to judge by.",
        );
        claim.not_comparable(ONE_PILE);
    } else {
        // Piles were built, and none had an angle.
        claim.verdict = Verdict::NotRun;
    }
    claim
}

fn laboratory(study: &StudyView) -> Claim {
    let piles = study.of_kind(RunKind::Repose).filter_map(|r| r.summary.angle_of_repose.as_ref());
    let volumes = Interval::of(piles.map(|p| p.by_volume_degrees));
    let by_volume = volumes.map_or_else(String::new, |v| {
        format!("By volume and height ours are {}° to {}°.", number(v.low, 1), number(v.high, 1))
    });
    let draft = Draft::of("angle-of-repose").note(by_volume);
    judged(draft, study, constants::ANGLE_OF_REPOSE_DEG)
}

fn atan_friction(study: &StudyView) -> Claim {
    let friction = study.pile_friction;
    let atan = friction.atan().to_degrees();
    let draft = Draft::of("repose-is-atan-friction").note(format!(
        "Ours is the pile of grains whose surfaces have a friction coefficient of {}, atan {}°. The law \
         cited is of the friction of the whole material, which interlocking and rolling make other \
         than that of two surfaces.",
        number(friction, 3),
        number(atan, 2)
    ));
    judged(draft, study, atan)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::paper::{
        canned::{self, pile},
        claims as all,
    };
    use crate::record::RunRecord;

    fn claim(degrees: &[Option<f64>], id: &str) -> Option<Claim> {
        let runs: Vec<RunRecord> =
            (1..).zip(degrees).map(|(c, degrees)| pile(c, *degrees)).collect();
        all(&canned::study(&runs)).into_iter().find(|c| c.id == id)
    }

    #[test]
    fn the_interval_of_the_configurations_decides() {
        // Mean 38.0, standard error 0.5774, t(2) = 4.303: 35.5 to 40.5.
        let near = [Some(37.0), Some(38.0), Some(39.0)];
        // Mean 33.0: 30.5 to 35.5.
        let far = [Some(32.0), Some(33.0), Some(34.0)];
        for id in ["angle-of-repose", "repose-is-atan-friction"] {
            let within = claim(&near, id).expect("a claim");
            assert_eq!(within.verdict, Verdict::Within, "{within:?}");
            assert_eq!(within.spread, Some(Interval::new(37.0, 39.0)));
            assert!(within.note.contains("35.5° to 40.5°"), "{}", within.note);
            assert_eq!(within.runs.len(), 3);
            let outside = claim(&far, id).expect("a claim");
            assert_eq!(outside.verdict, Verdict::Outside, "{outside:?}");
            assert_eq!(outside.ours, Some(33.0));
        }
        let stated = claim(&near, "angle-of-repose").and_then(|c| c.paper);
        assert_eq!(stated, Some(PaperValue::Value { value: 38.40 }));
    }

    /// Law: a pile that is not valid is left out of mean, interval and verdict.
    #[test]
    fn piles_that_are_not_valid_are_left_out() {
        let of = |spoilt: &[u32]| {
            let degrees = [37.0, 38.0, 39.0, 90.0];
            let mut runs: Vec<RunRecord> =
                (1..).zip(degrees).map(|(c, degrees)| pile(c, Some(degrees))).collect();
            for run in runs.iter_mut().filter(|r| spoilt.contains(&r.configuration)) {
                (run.summary.meets_standard, run.summary.valid) = (false, false);
            }
            let found = all(&canned::study(&runs)).into_iter().find(|c| c.id == "angle-of-repose");
            found.expect("a claim")
        };
        let every = of(&[]);
        assert_eq!((every.ours, every.left_out.len()), (Some(51.0), 0), "law: all four: {every:?}");
        let three = of(&[4]);
        assert_eq!((three.verdict, three.ours), (Verdict::Within, Some(38.0)), "law: {three:?}");
        assert_eq!(three.left_out, ["repose-c4"], "law: it is named");
        let none = of(&[1, 2, 3, 4]);
        assert_eq!((none.verdict, none.ours), (Verdict::NotComparable, None), "law: {none:?}");
        assert!(none.note.contains("No valid run"), "{}", none.note);
        assert_eq!(none.not_valid.map(|n| n.value), Some(51.0), "law: shown apart: {none:?}");
    }

    #[test]
    fn one_pile_is_not_compared_and_none_makes_no_claim() {
        let one = claim(&[Some(38.4)], "angle-of-repose").expect("a claim");
        assert_eq!((one.verdict, one.ours), (Verdict::NotComparable, Some(38.4)), "{one:?}");
        assert_eq!((one.kind, one.reason.as_str()), (ClaimKind::Result, ONE_PILE), "law: said");
        let flat = claim(&[None, None], "angle-of-repose").expect("a claim");
        assert_eq!(
            (flat.verdict, flat.ours),
            (Verdict::NotRun, None),
            "no angle measured: {flat:?}"
        );
        assert_eq!(claim(&[], "angle-of-repose"), None);
    }
}
