//! Uncertainty of made-up studies.

use super::*;
use crate::measure::testing::assert_near as near;
use crate::paper::canned;

#[test]
fn intervals_are_students_of_the_configurations() {
    let runs = canned::valid_runs();
    let found = uncertainty(&canned::study(&runs));
    // 16, 18, 20 mm: mean 18, s = 2, half width 4.30265 · 2/√3.
    let plate = found
        .quantities
        .iter()
        .find(|q| q.name == "continuous vibration, plate, final")
        .expect("the plate");
    near("the mean", 18.0, plate.mean.expect("a mean"), 1e-12);
    near("s", 2.0, plate.standard_deviation.expect("s"), 1e-12);
    let interval = plate.interval.expect("an interval");
    near("the upper end", 18.0 + 4.302_653 * 2.0 / 3f64.sqrt(), interval.high, 1e-5);
    near("the lower end", 18.0 - 4.302_653 * 2.0 / 3f64.sqrt(), interval.low, 1e-5);
    let heights = found.quantities.iter().filter(|q| q.falling_height_mm.is_some()).count();
    assert_eq!(heights, 4, "one a falling height");
    assert_eq!(found.settlements.len(), 6, "every vibrated run");
    let first = &found.settlements[0];
    // 0.8 µm/s over 20 s; the settlement stays as it is.
    near("creep over the vibration", 0.016, first.creep_over_vibration_mm.expect("mm"), 1e-4);
    near("the settlement, nothing taken off", 16.0, first.plate_mm.expect("mm"), 1e-12);
}

/// Canned heights with scatter on top; (configuration, height in cm) to mm.
fn scattered(slope: f64, noise: impl Fn(u32, f64) -> f64) -> Vec<RunRecord> {
    let mut runs = canned::valid_runs();
    for run in &mut runs {
        let fh = run.falling_height_mm / MM_IN_CM;
        run.summary.standing_height_mm.mean_surface =
            160.0 + slope * fh + noise(run.configuration, fh);
    }
    runs
}

#[test]
fn a_trend_is_found_where_there_is_one() {
    let runs = scattered(-0.4, |c, fh| 0.01 * f64::from(c) * fh);
    let trend = uncertainty(&canned::study(&runs)).trend;
    // Slopes −0.39, −0.38, −0.37.
    near("the mean slope", -0.38, trend.slope.expect("a test").mean_mm_per_cm, 1e-9);
    near("t", -0.38 / (0.01 / 3f64.sqrt()), trend.slope.expect("a test").t.expect("t"), 1e-6);
    let page = trend.page.expect("a test");
    near("L", 90.0, page.l, 1e-9);
    near("p of L", 24f64.powi(-3), page.p, 1e-12);
    // t = −65.8 with 2 of freedom.
    for said in [
        "(t-test of 3 slopes, p below 0.001)",
        "Page's L is 90.0 (p below 0.001)",
        "Both say that it falls",
        " configurations would be enough to show it with a probability of 80 %.",
    ] {
        assert!(trend.verdict.contains(said), "law: expected `{said}`, got `{}`", trend.verdict);
    }
    assert!(trend.configurations_needed.is_some_and(|n| n <= 3), "{trend:?}");
}

#[test]
fn no_trend_is_found_where_there_is_none_or_the_other() {
    let flat = scattered(0.0, |c, fh| if c == 2 { 0.1 * fh } else { -0.06 * fh });
    let trend = uncertainty(&canned::study(&flat)).trend;
    assert!(trend.verdict.contains("not shown"), "{}", trend.verdict);
    assert!(trend.verdict.contains("(t-test of 3 slopes, p = 0."), "{}", trend.verdict);
    assert!(trend.configurations_needed.is_some_and(|n| n > 3), "{trend:?}");
    assert!(trend.verdict.contains(" configurations would show it with"), "{}", trend.verdict);
    // Slopes that scatter about a rise: more of them would show no fall.
    let unclear = scattered(0.0, |c, fh| if c == 2 { 0.1 * fh } else { -0.04 * fh });
    let trend = uncertainty(&canned::study(&unclear)).trend;
    let said = " configurations would show that it rises with a probability of 80 %.";
    assert!(trend.verdict.ends_with(said), "law: expected `{said}`, got `{}`", trend.verdict);
    let rising = scattered(0.4, |c, fh| 0.01 * f64::from(c) * fh);
    let trend = uncertainty(&canned::study(&rising)).trend;
    assert!(trend.verdict.contains("rises, against the paper"), "{}", trend.verdict);
    let said = " configurations would be enough to show that it rises with";
    assert!(trend.verdict.contains(said), "law: expected `{said}`, got `{}`", trend.verdict);
    near("p of L, rising", 1.0, trend.page.expect("a test").p, 1e-9);
}

#[test]
fn too_few_configurations_are_said_to_be_too_few() {
    for (configurations, interval, needed) in [(1, false, false), (2, true, false), (3, true, true)]
    {
        let mut runs = scattered(-0.4, |c, fh| 0.1 * f64::from(c) * fh);
        runs.retain(|r| r.configuration <= configurations);
        let found = uncertainty(&canned::study(&runs));
        let height = &found.quantities[0];
        assert_eq!(height.interval.is_some(), interval, "{configurations}: {height:?}");
        assert_eq!(height.note.contains("no interval"), !interval, "{height:?}");
        assert_eq!(found.trend.slope.is_some(), interval, "{configurations}");
        assert_eq!(found.trend.configurations_needed.is_some(), needed, "{configurations}");
    }
    let none = uncertainty(&canned::study(&[]));
    assert!(none.trend.verdict.starts_with("No configuration"), "{}", none.trend.verdict);
}

#[test]
fn what_the_laboratory_did_not_state_is_not_made_up() {
    let runs = canned::valid_runs();
    let found = uncertainty(&canned::study(&runs)).laboratory;
    let stated: Vec<bool> = found.iter().map(|l| l.stated_range.is_some()).collect();
    assert_eq!(stated, [false, true, false], "law: the text states one range only");
    assert_eq!(found[1].stated_range, Some(Interval::new(14.0, 19.61)));
    assert_eq!(found[1].ours, Some(Interval::new(16.0, 20.0)));
}

/// Law: a plate that rose has no share of a settlement; its height still counts.
#[test]
fn what_rose_has_no_share() {
    let mut runs = canned::valid_runs();
    for run in runs.iter_mut().filter(|r| r.configuration == 1) {
        if let Some(settled) = &mut run.summary.settlement_mm {
            (settled.final_mm, settled.share_after_5_s) = (-2.0, None);
        }
    }
    let study = canned::study(&runs);
    let counted = |name: &str| {
        let found = uncertainty(&study).quantities.into_iter().find(|q| q.name == name);
        found.unwrap_or_else(|| panic!("no {name}")).values.len()
    };
    for (name, expected) in [
        ("continuous vibration, plate, final", 3),
        ("continuous vibration, plate, share after 5 s", 2),
        ("intermittent vibration, plate, share after the first period", 2),
    ] {
        assert_eq!(counted(name), expected, "law: {name}");
    }
    let claims = crate::paper::claims(&study);
    let share = claims.iter().find(|c| c.id == "intermittent-share-in-first-period-1");
    assert_eq!(share.expect("a claim").verdict, Verdict::NotRun, "law: it tells nothing");
}

/// Law: intervals and slopes are of the runs that count; what is left out is named.
#[test]
fn what_is_not_valid_is_left_out_of_intervals_and_slopes() {
    let of = |spoil: &dyn Fn(&mut RunRecord)| {
        let mut runs = canned::valid_runs();
        runs.iter_mut().for_each(spoil);
        uncertainty(&canned::study(&runs))
    };
    let plate = |found: &Uncertainty| {
        let of = |q: &&Quantity| q.name == "continuous vibration, plate, final";
        found.quantities.iter().find(of).expect("the plate").clone()
    };
    let good = of(&|_| {});
    assert_eq!(plate(&good).left_out, Vec::<String>::new(), "law: nothing is left out");
    assert_eq!((plate(&good).mean, good.trend.left_out.len()), (Some(18.0), 0));
    let spoil = |run: &mut RunRecord| {
        if run.configuration == 3 {
            run.summary.grains.missing = Some(500);
        }
    };
    let found = of(&spoil);
    assert_eq!(plate(&found).mean, Some(17.0), "law: 16 and 18 mm, not 20");
    assert_eq!(plate(&found).left_out, ["vibration-continuous-c3"], "law: named");
    assert_eq!((found.trend.configurations, found.trend.left_out), (vec![1, 2], vec![3]));
    assert!(found.trend.verdict.contains("Left out"), "{}", found.trend.verdict);
    let counting: Vec<bool> =
        found.settlements.iter().map(|s| s.left_out_of_means.is_empty()).collect();
    assert_eq!(counting.iter().filter(|c| **c).count(), 4, "law: six runs are shown, four count");
    assert_eq!(found.laboratory[1].ours, Some(Interval::new(16.0, 18.0)), "law: the range, too");
    let none = of(&|run| run.summary.valid = false);
    assert_eq!((plate(&none).mean, plate(&none).left_out.len()), (None, 3), "nothing of nothing");
    assert!(plate(&none).note.starts_with("No valid run."), "{}", plate(&none).note);
}
