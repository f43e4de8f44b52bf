//! Conditions that end stages: by themselves, on a scripted world, and in the engine.

use super::ending::{Condition, Ending, Endings, Found, Rule, Subject};
use super::testing::*;
use super::*;
use crate::scenario::Scenario;
use crate::units::to_g;
use crate::world::scripted::ScriptedWorld;

/// Time in s between two looks of conditions by themselves.
const EVERY: f64 = 10.0 / 480.0;

/// Time in s between two looks at a stage with these grains.
fn every() -> f64 {
    let setup = Setup::new(&scenario()).expect("a laboratory");
    super::segments::steps_a_check(&setup, STEP) as f64 * STEP
}

fn scenario() -> Scenario {
    scenario_of(json!({
        "grains": { "total_mass_g": 60, "density_kg_per_m3": 2650 },
        "contact": { "grain_wall_friction": 0.0 },
        "pieces": [
            { "name": "box", "shape": { "box": { "inner_mm": [50, 50, 140] } } },
            { "name": "lid", "shape": { "plate": { "size_mm": [49, 49, 10] } },
              "at_mm": [0, 0, 130] }
        ],
        "measures": {
            "openings": [{ "name": "mouth", "at_mm": [0, 0, 80], "diameter_mm": 200 }],
            "groups": [{ "name": "both", "pieces": ["box", "lid"] }]
        }
    }))
}

fn specimen() -> Specimen {
    specimen_of(&scenario(), 1)
}

/// On a world whose free bodies sink at a speed in m/s.
fn sinking(specimen: Specimen, speed: f64, value: Value) -> StageOutcome {
    let make = scripted_worlds(move || {
        let script = move |_, state: &BodyState, _, dt: f64| {
            let mut next = BodyState::at_rest(state.pose);
            next.linear_velocity.z = -speed;
            next.pose.translation.z -= speed * dt;
            next
        };
        ScriptedWorld::new(STEP, Box::new(script))
    });
    run_stage(&scenario(), &make, specimen, &stage(value), None, &mut ()).expect("it runs")
}

/// Grains at rest above the opening.
fn laid_out() -> Specimen {
    let lattice = json!({ "stage": "deposit", "how": "lattice", "at_mm": [0, 0, 200],
        "area_mm": [50, 50], "time_limit_s": 1 });
    sinking(specimen(), 0.0, lattice).specimen
}

fn of_force(condition: Condition, looks: f64) -> Ending {
    let subject = Subject::Force(vec![0], Vector::z());
    let name = "the force".to_owned();
    Ending { name, subject, condition, window: looks * EVERY }
}

/// The look, from 1, at which a condition holds first, and what was found then.
fn first(ending: &Ending, amounts: &[f64]) -> Option<(usize, f64)> {
    let mut judged = Judged::default();
    let at = amounts.iter().position(|amount| judged.look(ending, *amount, EVERY))?;
    Some((at + 1, judged.last.expect("a number")))
}

/// Law: what is found of a few grains of sand has its digits in messages.
#[test]
fn small_forces_ways_and_flows_are_told_with_their_digits() {
    let none = Found::default;
    for (found, expected) in [
        (Found { force_n: Some(1.2346e-5), ..none() }, "a force of 0.00001235 N"),
        (Found { force_n: Some(24.01), ..none() }, "a force of 24.01 N"),
        (Found { moved_mm: Some(3.21e-4), ..none() }, "0.000321 mm moved"),
        (Found { flow_g_per_s: Some(0.00125), ..none() }, "a flow of 0.00125 g/s"),
    ] {
        let line = UntilFound { found, ..UntilFound::default() }.line();
        assert!(line.contains(expected), "law: `{expected}` is said, got `{line}`");
    }
}

#[test]
fn a_mean_over_the_window_has_to_reach_what_is_wanted() {
    let reaches = of_force(Condition::Reaches(10.0), 4.0);
    // N s of each time between looks, of 10 N and of 20 N.
    let (ten, twenty) = (10.0 * EVERY, 20.0 * EVERY);
    let (at, found) = first(&reaches, &[ten * 1.0001; 9]).expect("it holds");
    assert_eq!(at, 4, "law: not before there is a whole window");
    assert!((found - 10.001).abs() < 1e-9, "law: N s over s, got {found} N");
    let late = [0.0, 0.0, 0.0, 0.0, 0.0, twenty, twenty, twenty];
    assert_eq!(first(&reaches, &late).map(|f| f.0), Some(7), "law: (0 + 0 + 20 + 20)/4 = 10 N");
    assert_eq!(first(&reaches, &[twenty, -twenty, twenty, twenty]).map(|f| f.0), Some(4));
    assert_eq!(first(&reaches, &[ten * 0.9999; 99]), None, "law: no less will do");
}

#[test]
fn a_flow_falls_below_only_what_it_was_above() {
    let below = of_force(Condition::FallsBelow(1.0), 2.0);
    let g = EVERY;
    assert_eq!(first(&below, &[0.0; 50]), None, "law: what has not begun does not fall");
    assert_eq!(first(&below, &[0.5 * g; 50]), None, "law: nor what never was above");
    let flow = [0.0, 3.0 * g, 3.0 * g, 3.0 * g, g, 0.5 * g, 0.0];
    assert_eq!(first(&below, &flow), Some((6, 0.75)), "law: (1 + ½)/2 < 1");
}

#[test]
fn what_is_steady_changes_little_from_window_to_window() {
    let steady = of_force(Condition::Steady(0.05), 2.0);
    let n = EVERY;
    let rising: Vec<f64> = (1..=200).map(|k| f64::from(k) * n).collect();
    // Means of looks k−1, k and k−3, k−2: (k − ½) and (k − 2½), so 2/(k − ½) ≤ 0.05.
    let (at, change) = first(&steady, &rising).expect("it holds");
    assert_eq!(at, 41, "law: k ≥ 40.5, found a change of {change}");
    assert!((change - 2.0 / 40.5).abs() < 1e-12, "law: 2/40.5, got {change}");
    assert_eq!(first(&steady, &[0.0; 99]), None, "law: nothing is no steady force");
    assert_eq!(first(&steady, &[-n; 9]).map(|f| f.0), Some(4), "law: after two windows");
}

/// Law: v (t − r/2) ≥ 19.9 mm holds from 0.249 s on, and first at the look T after that; the
/// motion then dies away in r = 0.1 s and has gone v T.
#[test]
fn a_motion_ends_by_its_way_and_dies_away() {
    let lower = |moved_mm: f64, piece: &str| {
        json!({ "stage": "move", "pieces": ["lid"], "ramp_s": 0.1, "time_limit_s": 2,
            "velocity_mm_per_s": [0, 0, -100], "until": { "piece": piece, "moved_mm": moved_mm } })
    };
    let at = (0.249 / every()).ceil() * every();
    for (piece, wanted) in [("lid", 19.9), ("both", 9.95)] {
        let outcome = sinking(laid_out(), 0.0, lower(wanted, piece));
        let found = outcome.until.expect("a condition");
        assert!(found.reached && outcome.warnings.is_empty(), "law: {found:?}");
        let held = found.at_s.expect("a time");
        assert!((held - at).abs() < 1e-9, "law: the first look after 0.249 s, of {piece}, {held}");
        let (moved, share) = (found.found.moved_mm.expect("a displacement"), wanted / 19.9);
        let expected = 100.0 * (at - 0.05) * share;
        assert!((moved - expected).abs() < 1e-9, "law: v (T − r/2), got {moved} mm");
        assert!((outcome.simulated - at - 0.1).abs() < 1e-9, "law: T + r, {} s", outcome.simulated);
        let z = outcome.specimen.state.pieces[1].pose.translation.z;
        assert!((z - 0.13 + 0.1 * at).abs() < 1e-12, "law: v T below 130 mm, got {z} m");
    }
    let outcome = sinking(laid_out(), 0.0, lower(500.0, "lid"));
    let found = outcome.until.expect("a condition");
    assert!(!found.reached && (outcome.simulated - 2.0).abs() < 1e-9, "law: its limit of time");
    let told = outcome.warnings.iter().any(|text| text.contains("`until` was not reached"));
    assert!(told, "law: it is said, got {:?}", outcome.warnings);
}

/// Law: half a turn is reached by a rotation that no look meets there, at the first look after it.
#[test]
fn half_a_turn_ends_a_motion_though_no_look_meets_it() {
    let turn = json!({ "stage": "move", "pieces": ["box", "lid"], "time_limit_s": 3,
        "rotation": { "axis": [0, 0, 1], "deg_per_s": -100 },
        "until": { "piece": "box", "turned_deg": 180 } });
    let outcome = sinking(laid_out(), 0.0, turn);
    let found = outcome.until.expect("a condition");
    let at = (1.8 / every()).ceil() * every();
    assert!((at - 1.8).abs() > 1e-3, "the check sees a look after it");
    let held = found.at_s.unwrap_or(f64::NAN);
    assert!((held - at).abs() < 1e-9, "law: the first look after 1.8 s, got {found:?}");
    let turned = found.found.turned_deg.expect("an angle");
    assert!((turned - 100.0 * at).abs() < 1e-6, "law: ω t, got {turned} degrees");
}

/// Law: grains that sink at v pass the opening at (z − z₀)/v, and a flow over a window of n looks
/// has fallen below next to nothing at the n-th look without one.
#[test]
fn a_flow_ends_a_stage_when_the_last_grain_has_passed() {
    let before = laid_out();
    let heights: Vec<f64> =
        before.present().map(|n| before.state.bodies[n].body.pose.translation.z).collect();
    let (speed, looks) = (0.7, (0.21 / every()).round());
    let last = heights.iter().map(|z| ((z - 0.08) / (speed * every())).ceil()).fold(0.0, f64::max);
    let value = json!({ "stage": "remove", "pieces": ["box"], "time_limit_s": 5,
        "until": { "opening": "mouth", "flow_below_g_per_s": 0.1, "window_s": 0.21 } });
    let outcome = sinking(before.clone(), speed, value);
    let found = outcome.until.expect("a condition");
    let expected = (last + looks) * every();
    assert!(
        found.reached && (outcome.simulated - expected).abs() < 1e-9,
        "law: {expected} s, got {} s, {found:?}",
        outcome.simulated
    );
    assert_eq!(found.found.flow_g_per_s, Some(0.0), "law: nothing passes any more");
    // Over a longer window, in which a good part of the mass passes: the lid is in the way of the
    // others, which this world lets through it.
    let total = to_g(before.grains.total_mass());
    let value = json!({ "stage": "remove", "pieces": ["box"], "time_limit_s": 5,
        "until": { "opening": "mouth", "flow_below_g_per_s": total * 0.1, "window_s": 1.0 } });
    let found = sinking(before, speed, value).until.expect("a condition");
    assert!(found.reached, "law: above a tenth of the mass a second, then below it: {found:?}");
}

/// Law: of a list any condition ends the stage, of `all_of` only all at the same look; each is
/// named, with what was found of it.
#[test]
fn any_of_several_conditions_ends_a_stage_or_all_of_them() {
    let lower = |until: Value| {
        let value = json!({ "stage": "move", "pieces": ["lid"], "ramp_s": 0.1,
            "time_limit_s": 2, "velocity_mm_per_s": [0, 0, -100], "until": until });
        sinking(laid_out(), 0.0, value)
    };
    let way = |mm: f64| json!({ "piece": "lid", "moved_mm": mm });
    let force = json!({ "piece": "both", "direction": [0, 0, 1], "force_n": 1 });
    let at = |mm: f64| ((mm / 100.0 + 0.05) / every()).ceil() * every();
    let held = |outcome: &StageOutcome| {
        let found = outcome.until.as_ref().expect("conditions");
        let each = found.conditions.iter().map(|of| of.reached).collect::<Vec<_>>();
        (found.at_s.map(|at| (at * 1e6).round()), each)
    };
    let expected = |mm: f64| Some((at(mm) * 1e6).round());
    for (until, ends, each) in [
        (json!([way(30.0), force, way(10.0)]), 10.0, vec![false, false, true]),
        (json!({ "all_of": [way(30.0), way(10.0)] }), 30.0, vec![true, true]),
    ] {
        let outcome = lower(until);
        assert_eq!(held(&outcome), (expected(ends), each), "law: {:?}", outcome.until);
        assert!(outcome.warnings.is_empty(), "law: it held, {:?}", outcome.warnings);
        let found = outcome.until.expect("conditions");
        let moved = found.conditions[0].found.moved_mm.expect("a displacement");
        let expected = 100.0 * (at(ends) - 0.05);
        assert!((moved - expected).abs() < 1e-9, "law: its last value, got {moved} mm");
        let line = found.line();
        assert!(line.contains("held after") && line.contains("`moved_mm` of `lid` with"), "{line}");
        assert_eq!(found.all_of, each_held(&found), "law: {line}");
    }
    let outcome = lower(json!({ "all_of": [way(30.0), force] }));
    assert_eq!(held(&outcome), (None, vec![true, false]), "law: {:?}", outcome.until);
    let told = &outcome.warnings[0];
    assert!(
        told.contains("all at the same time") && told.contains("`force_n` of `both`"),
        "{told}"
    );
}

fn each_held(found: &UntilFound) -> bool {
    found.conditions.iter().all(|of| of.reached)
}

/// Law: several conditions on forces and flows are each judged by their own.
#[test]
fn conditions_keep_their_own_amounts() {
    let mut judged = Judged::default();
    let each = vec![of_force(Condition::Reaches(10.0), 2.0), of_force(Condition::Steady(0.1), 1.0)];
    let endings = Endings { rule: Rule::All, each };
    let n = EVERY;
    let looks = [[20.0, 1.0], [20.0, 2.0], [0.0, 2.0], [1.0, 2.0], [19.5, 2.1]];
    let ends: Vec<bool> = looks
        .iter()
        .enumerate()
        .map(|(k, [a, b])| judged.look_at_all(&endings, &[a * n, b * n], k as f64, EVERY))
        .collect();
    assert_eq!(ends, [false, false, true, false, true], "law: 20, 10 and 10¼ N, steady at 2");
    let text = serde_json::to_string(&judged).expect("JSON");
    assert_eq!(serde_json::from_str::<Judged>(&text).expect("read"), judged, "law: kept whole");
    assert_eq!(judged.check(), Ok(()));
    judged.each[1].last = Some(f64::NAN);
    assert!(judged.check().is_err(), "law: what is no number is found in each");
}

/// Law: an interrupted stage ends at the same step with the same bits: pressed pieces whose force
/// or way is waited for, and motions that are dying away.
#[test]
fn stages_with_a_condition_go_on_from_a_checkpoint_with_the_same_bits() {
    let _turn = crate::world::shared_turn();
    let mut scenario = scenario();
    let make = &crate::world::create;
    let rain = stage(json!({ "stage": "deposit", "at_mm": [0, 0, 85], "area_mm": [10, 10],
        "rate_g_per_s": 200, "time_limit_s": 4 }));
    let rained = run_stage(&scenario, make, specimen(), &rain, None, &mut ());
    let mut before = rained.expect("it runs").specimen;
    scenario.engine.native.checkpoint_every_s = Some(0.1);
    let press = json!({ "stage": "press", "time_limit_s": 6, "ramp_s": 1,
        "loads": [{ "piece": "lid", "stress_kpa": 20 }],
        "until": { "piece": "lid", "direction": [0, 0, 1], "force_n": 12, "window_s": 0.1 } });
    let shift = json!({ "stage": "move", "pieces": ["box"], "ramp_s": 0.3,
        "velocity_mm_per_s": [0, 0, 20], "time_limit_s": 3, "settle_limit_s": 1,
        "until": { "piece": "lid", "moved_mm": 2 } });
    let recorded = json!({ "stage": "move", "pieces": ["box"], "ramp_s": 0.3,
        "motion_rows": [[0, 0, 0, 0], [1, 0, 0, 15], [3, 0, 0, 20]], "settle_limit_s": 1,
        "until": [{ "piece": "box", "direction": [0, 0, -1], "force_n": 1000 },
            { "piece": "lid", "moved_mm": 2 }] });
    for value in [press, shift, recorded] {
        // What moves may be dying away at the last two.
        let (whole, seams) = same_from_seams(&scenario, &before, &stage(value), &[0]);
        assert!(seams.len() >= 3, "the check sees segments, {}", seams.len());
        let found = whole.until.clone().expect("a condition");
        assert!(found.reached, "law: it is reached, {found:?}");
        if let [force, way] = &found.conditions[..] {
            assert!(!force.reached && way.reached, "law: the displacement is reached, {found:?}");
        } else if let Some(force) = found.found.force_n {
            assert!((12.0..14.0).contains(&force), "law: 12 N and little more, got {force} N");
            let press = whole.specimen.state.pieces[1].press.expect("pressed");
            assert!(press.force_n < press.target_n, "law: before the whole force is on it");
        } else {
            let moved = found.found.moved_mm.expect("a displacement");
            assert!((2.0..2.6).contains(&moved), "law: 2 mm and at most a look, got {moved} mm");
            let way = whole.specimen.state.pieces[0].pose.translation.z;
            assert!(way < from_mm(20.0 * 3.0), "law: before its limit, {way} m");
        }
        before = whole.specimen;
    }
}
