//! Pieces that are pressed, in the engine.

use super::testing::*;
use super::*;
use crate::scenario::Scenario;

/// A smooth box of 50 mm with a lid that fills it, and a few grains.
fn scenario() -> Scenario {
    scenario_of(json!({
        "grains": { "total_mass_g": 60, "density_kg_per_m3": 2650 },
        "contact": { "grain_wall_friction": 0.0 },
        "pieces": [
            { "name": "box", "shape": { "box": { "inner_mm": [50, 50, 140] } } },
            { "name": "lid", "shape": { "plate": { "size_mm": [49, 49, 10] } },
              "at_mm": [0, 0, 130] }
        ]
    }))
}

fn before_everything() -> Specimen {
    specimen_of(&scenario(), 1)
}

/// Keeps what it is shown.
#[derive(Default)]
struct Seen {
    /// Time in s, speed of the lid downwards in m/s, force that presses it in N.
    lid: Vec<(f64, f64, f64)>,
    /// How many of these there were before it bore anything.
    approach: usize,
}

impl Observer for Seen {
    fn observe(&mut self, specimen: &Specimen, moment: Moment) {
        let Some(lid) = specimen.state.pieces.get(1) else { return };
        if let Some(press) = lid.press {
            self.approach += usize::from(self.approach == self.lid.len() && lid.force_n.z == 0.0);
            self.lid.push((moment.stage_time, press.speed_m_per_s, press.force_n));
        }
    }
}

fn go_in(scenario: &Scenario, specimen: Specimen, value: Value) -> (StageOutcome, Seen) {
    let (make, mut seen) = (&crate::world::create, Seen::default());
    let outcome = run_stage(scenario, make, specimen, &stage(value), None, &mut seen);
    (outcome.expect("it runs"), seen)
}

fn go(specimen: Specimen, value: Value) -> (StageOutcome, Seen) {
    go_in(&scenario(), specimen, value)
}

fn filled() -> Specimen {
    filled_with(1)
}

fn filled_with(seed: u64) -> Specimen {
    let rain = json!({ "stage": "deposit", "at_mm": [0, 0, 85], "area_mm": [10, 10],
        "rate_g_per_s": 200, "time_limit_s": 4 });
    go(specimen_of(&scenario(), seed), rain).0.specimen
}

fn median<const N: usize>(mut values: [f64; N]) -> f64 {
    values.sort_by(f64::total_cmp);
    values[N / 2]
}

fn press(stress_kpa: f64) -> Value {
    json!({ "stage": "press", "time_limit_s": 4,
        "loads": [{ "piece": "lid", "stress_kpa": stress_kpa }] })
}

#[test]
fn the_floor_bears_the_pressed_stress_and_the_weight_of_the_grains() {
    let _turn = crate::world::shared_turn();
    let (outcome, seen) = go(filled(), press(10.0));
    let state = &outcome.specimen.state;
    let force = 10e3 * 0.049 * 0.049;
    let weight: f64 = {
        let set = &outcome.specimen.grains.grains;
        outcome.specimen.present().map(|n| set[n].mass * 9.81).sum()
    };
    let [floor, lid] = [state.pieces[0], state.pieces[1]];
    near("stress times area on the lid, N", lid.force_n.z, force, 0.01 * force);
    near("all on the box, N", -floor.force_n.z, force + weight, 0.01 * force);
    let aside = (floor.force_n + lid.force_n).xy().norm();
    near("nothing sideways together, N", aside, 0.0, 0.01 * force);
    assert!(
        outcome.warnings.is_empty(),
        "law: it settles, and no energy is without a source, {:?}",
        outcome.warnings
    );
    assert_eq!(outcome.watch.energy.beyond, 0, "law: as the watch has it");
    let approach = seen.lid[..seen.approach].iter();
    let fastest = approach.map(|(_, speed, _)| *speed).fold(0.0, f64::max);
    assert!((0.0499..0.0501).contains(&fastest), "law: it approaches with 50 mm/s, got {fastest}");
    let moved = lid.pose.translation.vector;
    assert!(moved.z < 0.13, "law: it came down, {moved:?}");
    assert_eq!(moved.xy(), Vector::zeros().xy(), "law: and nowhere else");
}

/// Law: a warning says how much there is of a load that the time limit cuts off; none of a whole one.
#[test]
fn a_load_that_is_not_reached_is_told() {
    let _turn = crate::world::shared_turn();
    let mut short = press(10.0);
    short["time_limit_s"] = json!(0.3);
    short["ramp_s"] = json!(3);
    let told = go(filled(), short).0.warnings.join("; ");
    assert!(
        told.contains("`lid` is pressed with ") && told.contains("of the 24.01 asked"),
        "{told}"
    );
    let whole = go(filled(), press(10.0)).0.warnings;
    assert!(whole.is_empty(), "law: the whole load is on it, {whole:?}");
}

#[test]
fn a_lid_that_nothing_carries_is_an_error_that_names_both_pieces() {
    let _turn = crate::world::shared_turn();
    let (make, press) = (&crate::world::create, stage(press(10.0)));
    let got = run_stage(&scenario(), make, before_everything(), &press, None, &mut ());
    let told = got.expect_err("law: it ends").to_string();
    assert!(told.contains("`lid` was pressed into `box`"), "law: who and where, got {told}");
}

/// Law: of a wall that is moved into a pressed lid both are named, and it is not said that no grains
/// carried the lid.
#[test]
fn a_wall_that_is_moved_into_a_pressed_lid_is_named() {
    let _turn = crate::world::shared_turn();
    let pressed = go(filled(), press(10.0)).0.specimen;
    let aside = stage(json!({ "stage": "move", "pieces": ["box"], "duration_s": 0.3,
        "velocity_mm_per_s": [20, 0, 0] }));
    let make = &crate::world::create;
    let got = run_stage(&scenario(), make, pressed, &aside, None, &mut ());
    let told = got.expect_err("law: it ends").to_string();
    let both = "`lid`, which is pressed, and `box`, which this stage moves, got into each other";
    assert!(told.contains(both), "law: who and where, got {told}");
}

#[test]
fn a_pressed_lid_goes_on_from_a_checkpoint_with_the_same_bits() {
    let _turn = crate::world::shared_turn();
    let (filled, mut scenario) = (filled(), scenario());
    scenario.engine.native.checkpoint_every_s = Some(0.25);
    let (whole, _) = same_from_seams(&scenario, &filled, &stage(press(10.0)), &[0]);
    let (other, _) = go_in(&scenario, filled, press(11.0));
    assert!(other.specimen.state != whole.specimen.state, "the comparison can fail");
}

#[test]
fn a_lid_stays_pressed_until_it_is_locked_or_moved() {
    let _turn = crate::world::shared_turn();
    let pressed = go(filled(), press(5.0)).0.specimen;
    let rest = json!({ "stage": "rest", "duration_s": 0.2 });
    let rested = go(pressed.clone(), rest).0.specimen;
    let force = 5e3 * 0.049 * 0.049;
    near("still pressed, N", rested.state.pieces[1].force_n.z, force, 0.01 * force);
    let again = go(rested.clone(), press(5.0)).0;
    assert!(again.warnings.is_empty(), "law: the same load again is reached, {:?}", again.warnings);
    let more = go(rested, press(8.0)).0.specimen;
    let sunk = |s: &Specimen| s.state.pieces[1].pose.translation.z;
    assert!(sunk(&more) < sunk(&pressed), "law: more stress, deeper");
    let lock = json!({ "stage": "press", "time_limit_s": 2,
        "loads": [{ "piece": "lid", "locked": true }] });
    let locked = go(more.clone(), lock).0.specimen;
    assert_eq!(locked.state.pieces[1].pose, more.state.pieces[1].pose, "law: it stays");
    assert_eq!(locked.state.pieces[1].press, None, "law: and is pressed no more");
    let raise = json!({ "stage": "move", "pieces": ["lid"],
        "velocity_mm_per_s": [0, 0, 20], "travel_mm": 5 });
    let raised = go(more.clone(), raise).0.specimen;
    near("raised by 5 mm", sunk(&raised) - sunk(&more), 0.005, 1e-9);
    assert_eq!(raised.state.pieces[1].press, None, "law: what is moved is not pressed");
    let all = json!({ "stage": "move", "velocity_mm_per_s": [0, 0, 10],
        "travel_mm": 1, "settle_limit_s": 2 });
    let lifted = go(more, all).0.specimen;
    assert!(lifted.state.pieces[1].press.is_some(), "law: all that stand, less what is pressed");
    near("pressed on the way, N", lifted.state.pieces[1].force_n.z, 8e3 * 0.049 * 0.049, 0.2);
}

/// Law: a lid that was locked, or moved, is pressed on from what it bears: the load neither vanishes
/// nor begins anew from nothing, so the specimen stays as it was under the same load: in the median of
/// three, for one that has come near to a rearrangement may go on with it.
#[test]
fn a_locked_lid_is_pressed_on_from_what_it_bears() {
    let _turn = crate::world::shared_turn();
    let height = |s: &Specimen| s.state.pieces[1].pose.translation.z;
    let force = 8e3 * 0.049 * 0.049;
    let moved = [1, 2, 3].map(|seed| {
        let pressed = go(filled_with(seed), press(8.0)).0.specimen;
        let lock = json!({ "stage": "press", "time_limit_s": 2,
            "loads": [{ "piece": "lid", "locked": true }] });
        let locked = go(pressed.clone(), lock).0.specimen;
        let (again, seen) = go(locked, press(8.0));
        let least = seen.lid.iter().map(|(.., force)| *force).fold(f64::MAX, f64::min);
        assert!(least > 0.9 * force, "law: the load of {force} N stays, got {least} N");
        (height(&again.specimen) - height(&pressed)).abs()
    });
    near("the lid stays, m", median(moved), 0.0, 2e-5);
}

/// Law: the springs of contacts give back what they hold where a held lid is raised, which is no
/// unexplained gain of energy.
#[test]
fn grains_under_a_lid_that_is_raised_give_back_what_they_hold() {
    let _turn = crate::world::shared_turn();
    let pressed = go(filled(), press(50.0)).0.specimen;
    let raise = json!({ "stage": "move", "pieces": ["lid"],
        "velocity_mm_per_s": [0, 0, 2], "travel_mm": 0.5, "ramp_s": 0.05 });
    let raised = go(pressed, raise).0;
    assert_eq!(raised.watch.energy.beyond, 0, "law: none is unexplained, {:?}", raised.warnings);
}

/// Law: a lid that is relieved of its load stays where grains last touched it. How far the springs
/// of contacts throw grains up is chance: the median of five specimens counts.
#[test]
fn a_lid_without_load_does_not_fly_away() {
    let _turn = crate::world::shared_turn();
    let height = |s: &Specimen| s.state.pieces[1].pose.translation.z;
    let (mut risen, mut more) = ([0.0; 5], [0.0; 5]);
    for (n, seed) in (1..).take(5).enumerate() {
        let pressed = go(filled_with(seed), press(8.0)).0.specimen;
        let free = go(pressed.clone(), press(0.0)).0.specimen;
        let rest = json!({ "stage": "rest", "duration_s": 0.5 });
        let later = go(free.clone(), rest).0.specimen;
        (risen[n], more[n]) = (height(&free) - height(&pressed), height(&later) - height(&free));
    }
    near("it stays, m", median(more), 0.0, 1e-6);
    near("near to where it was, m", median(risen), 0.0, 3e-3);
}

/// A vane stands in the middle of the box while grains fall around it, and is turned.
fn vane() -> Scenario {
    let mut scenario = scenario();
    let vane = json!({ "name": "lid", "at_mm": [0, 0, 40],
        "shape": { "plate": { "size_mm": [30, 4, 70] } } });
    scenario.pieces[1] = serde_json::from_value(vane).expect("a piece");
    scenario
}

#[test]
fn grains_resist_the_moment_that_turns_a_vane_and_an_interruption_changes_nothing() {
    let _turn = crate::world::shared_turn();
    let mut scenario = vane();
    let rain = json!({ "stage": "deposit", "at_mm": [0, 0, 110], "area_mm": [34, 34],
        "rate_g_per_s": 150, "time_limit_s": 4 });
    let filled = go_in(&scenario, before_everything(), rain).0.specimen;
    scenario.engine.native.checkpoint_every_s = Some(0.25);
    let moment = 1.5e-3;
    let turn = json!({ "stage": "press", "time_limit_s": 4, "ramp_s": 0.3,
        "loads": [{ "piece": "lid", "moment_n_m": moment, "axis": [0, 0, -2],
                    "about_mm": [0, 0, 0] }] });
    let (whole, _) = same_from_seams(&scenario, &filled, &stage(turn), &[0]);
    assert!(whole.warnings.is_empty(), "law: the grains hold it, {:?}", whole.warnings);
    let piece = whole.specimen.state.pieces[1];
    near("the grains resist, N m", piece.moment_n_m.z, moment, 0.03 * moment);
    let turned = piece.press.and_then(|press| press.turns).expect("it turns").turned_rad;
    let (_, _, yaw) = piece.pose.rotation.euler_angles();
    near("turned as its pose says, rad", -yaw, turned, 1e-9);
    assert!(turned > 1e-5 && turned < 1.0, "law: until they do, got {turned} rad");
    near("and nowhere else, m", piece.pose.translation.vector.xy().norm(), 0.0, 1e-9);
}
