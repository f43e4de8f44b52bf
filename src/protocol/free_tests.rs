//! Pieces that move freely, and pieces of several parts that are pressed, in the engine.

use super::testing::*;
use super::*;
use crate::scenario::Scenario;
use crate::world::scripted::ScriptedWorld;

/// A box with a steel-like block above its floor, a vane and a few grains that wait.
fn scenario() -> Scenario {
    scenario_of(json!({
        "grains": { "total_mass_g": 60, "density_kg_per_m3": 2650 },
        "pieces": [
            { "name": "box", "shape": { "box": { "inner_mm": [80, 80, 140] } } },
            { "name": "block", "shape": { "plate": { "size_mm": [40, 30, 20] } },
              "at_mm": [3, -2, 70], "rotation_deg": [3, 4, 5] },
            { "name": "vane", "shape": { "vane": { "diameter_mm": 50, "height_mm": 40 } },
              "at_mm": [0, 0, 115] }
        ]
    }))
}

fn before_everything() -> Specimen {
    specimen_of(&scenario(), 1)
}

fn try_go(specimen: Specimen, value: Value) -> Result<StageOutcome, StageError> {
    run_stage(&scenario(), &crate::world::create, specimen, &stage(value), None, &mut ())
}

fn go(specimen: Specimen, value: Value) -> StageOutcome {
    try_go(specimen, value).expect("it runs")
}

fn release(names: &[&str], mass_g: f64) -> Value {
    json!({ "stage": "release", "pieces": names, "mass_g": mass_g, "time_limit_s": 4 })
}

/// Law: a block that is let go falls, comes to rest flat on the floor, which carries its weight;
/// on a second one as well.
#[test]
fn what_is_let_go_falls_and_is_carried_by_other_pieces() {
    let _turn = crate::world::shared_turn();
    let outcome = go(before_everything(), release(&["block"], 500.0));
    assert!(outcome.warnings.is_empty(), "law: it settles, {:?}", outcome.warnings);
    let [floor, block, _] = outcome.specimen.state.pieces[..] else { panic!("three pieces") };
    let free = block.free.expect("free");
    let weight = 0.5 * 9.81;
    near("the floor carries it, N", -floor.force_n.z, weight, 2e-3 * weight);
    near("as it is carried, N", block.force_n.z, weight, 2e-3 * weight);
    // On the springs of its four corners.
    let spring = scenario().engine.native.contact_stiffness_n_per_m;
    let sunk = weight / (4.0 * spring) * 1e3;
    near("flat on the floor, mm", block.pose.translation.z * 1e3, 10.0 - sunk, 2e-3);
    let up = block.pose.rotation * Vector::z();
    near("upright", up.z, 1.0, 1e-6);
    let centre = free.body.pose.translation.vector - block.pose.translation.vector;
    near("its frame is in its middle", centre.norm(), 0.0, 1e-12);
    assert!(free.body.linear_velocity.norm() < 1e-3, "law: at rest");
    // Loss of what it had: m g times its way.
    let fallen = weight * (0.070 - block.pose.translation.z);
    let balance = outcome.watch.balance;
    near("impacts and friction take what it had, J", balance.dissipated, fallen, 0.01 * fallen);
    near("nothing is put in, J", balance.input, 0.0, 1e-3 * fallen);

    // A free piece of five parts on a free block, carried by both.
    let outcome = go(outcome.specimen, release(&["vane"], 200.0));
    let [floor, block, vane] = outcome.specimen.state.pieces[..] else { panic!("three pieces") };
    let both = 0.7 * 9.81;
    near("the floor carries both, N", -floor.force_n.z, both, 5e-3 * both);
    let sum = floor.force_n + block.force_n + vane.force_n;
    near("there are no grains to carry, N", sum.norm(), 0.0, 5e-3 * both);
    assert!(block.free.is_some(), "law: it stays free");

    // Held where it is, it is lifted.
    let lift = json!({ "stage": "move", "pieces": ["block"],
        "velocity_mm_per_s": [0, 0, 0.001], "duration_s": 0.05 });
    let outcome = go(outcome.specimen, lift);
    let [_, block, vane] = outcome.specimen.state.pieces[..] else { panic!("three pieces") };
    assert!(block.free.is_none() && vane.free.is_some(), "law: what is moved is not free");
}

/// Law: a block that lies on another piece, some 0.1 mm deep in the springs of its corners, may be
/// held and let go again, and pressed along the floor; not into the floor. Nothing is let go within
/// another piece.
#[test]
fn what_lies_on_a_piece_does_not_stand_in_it() {
    let _turn = crate::world::shared_turn();
    let lies = go(before_everything(), release(&["block"], 500.0)).specimen;
    let place = |specimen: &Specimen| specimen.state.pieces[1].pose.translation.vector;
    let hold = json!({ "stage": "press", "loads": [{ "piece": "block", "locked": true }] });
    let held = go(lies.clone(), hold).specimen;
    assert!(held.state.pieces[1].is_held(), "law: it is held");
    let again = go(held.clone(), release(&["block"], 500.0)).specimen;
    let sunk = place(&again) - place(&held);
    near("let go again it stays where it is, m", sunk.norm(), 0.0, 5e-5);

    let press = |direction: [f64; 3]| {
        json!({ "stage": "press", "ramp_s": 0.01, "time_limit_s": 0.3,
            "loads": [{ "piece": "block", "direction": direction, "force_n": 1 }] })
    };
    let slid = go(lies.clone(), press([0.0, 1.0, 0.0])).specimen;
    let moved = place(&slid) - place(&lies);
    assert!(moved.y > 5e-3, "law: it moves along the floor, got {moved} m");
    let got = try_go(lies, press([0.0, 0.0, -1.0]));
    let told = got.expect_err("law: no grains carry it").to_string();
    assert!(told.contains("`block` was pressed into `box`"), "law: who and where, got {told}");

    let mut deep = held;
    deep.state.pieces[1].pose.translation.vector.z -= 1e-3;
    let got = try_go(deep, release(&["block"], 500.0));
    let told = got.expect_err("law: it stands in the floor").to_string();
    assert!(told.contains("`block` stands in `box`"), "law: who and where, got {told}");
}

/// Law: an interrupted stage ends with the same bits, in the air, at impact and at rest.
#[test]
fn what_is_let_go_goes_on_from_a_checkpoint_with_the_same_bits() {
    let _turn = crate::world::shared_turn();
    let mut scenario = scenario();
    scenario.engine.native.checkpoint_every_s = Some(0.05);
    let mut value = release(&["block", "vane"], 300.0);
    value["until"] = json!([{ "piece": "block", "moved_mm": 1000 }]);
    same_from_seams(&scenario, &before_everything(), &stage(value), &[0, 1, 3]);
}

/// Law: what falls out of the laboratory ends the run, and says so.
#[test]
fn what_nothing_carries_is_reported() {
    let _turn = crate::world::shared_turn();
    let away = json!({ "stage": "move", "pieces": ["box"], "duration_s": 1,
        "velocity_mm_per_s": [300, 0, 0] });
    let moved = go(before_everything(), away).specimen;
    let got = try_go(moved, release(&["block"], 500.0));
    let told = got.expect_err("nothing carries it").to_string();
    assert!(told.contains("`block` fell below all other pieces"), "law: {told}");
    let got = try_go(before_everything(), release(&["block", "vane", "box"], 500.0));
    let told = got.expect_err("nothing carries them").to_string();
    assert!(told.contains("nothing is left that could carry"), "law: {told}");
}

/// Law: what moves freely has ½ m v² + ½ ω·I ω, a box with m/12 (b² + c²) about each of its axes;
/// what is pressed has ½ m v².
#[test]
fn the_kinetic_energy_of_pieces_is_that_of_their_motion() {
    let setup = Setup::new(&scenario()).expect("a laboratory");
    let begun = laboratory::begun(&setup, before_everything()).state;
    let pieces_of = |state: &SpecimenState| {
        let mut world = ScriptedWorld::still(STEP);
        let mut parties = HashMap::new();
        Pieces::add(&mut world, &setup, state, &state.pieces, None, &mut parties).expect("pieces")
    };
    let (mass, v, spin) = (0.5, Vector::new(0.3, -0.2, 0.7), Vector::new(20.0, -50.0, 30.0));
    let mut state = begun.clone();
    let mut free = released(&setup.pieces[1], &state.pieces[1], mass);
    (free.body.linear_velocity, free.body.angular_velocity) = (v, spin);
    state.pieces[1].free = Some(free);
    let got = Tally::of(pieces_of(&state).free_motion(&state), 0.0).energy;
    let [a, b, c] = [0.04_f64, 0.03, 0.02].map(|side| side * side);
    let moments = Vector::new(b + c, a + c, a + b) * (mass / 12.0);
    let own = state.pieces[1].pose.rotation.inverse() * spin;
    let law = 0.5 * mass * v.norm_squared() + 0.5 * moments.dot(&own.component_mul(&own));
    near("½ m v² + ½ ω·I ω of a free box, J", got, law, 1e-10 * law);

    let mut state = begun;
    state.pieces[1].press = Some(PressState {
        direction: -Vector::z(),
        mass_kg: 0.2,
        speed_m_per_s: -0.1,
        ..PressState::default()
    });
    let (energy, fastest) = pieces_of(&state).pressed_motion(&state).expect("it is pressed");
    near("½ m v² of a pressed one, J", energy, 1e-3, 1e-15);
    near("its speed, m/s", fastest, 0.1, 1e-15);
}

/// Law: a vane is turned by a moment as one body, α = M/I, and a box pressed as one.
#[test]
fn pieces_of_several_parts_are_pressed_as_one() {
    let _turn = crate::world::shared_turn();
    let turn = json!({ "stage": "press", "time_limit_s": 0.5, "ramp_s": 0.001,
        "approach_mm_per_s": 10000, "loads": [{ "piece": "vane", "moment_n_m": 1e-4,
        "axis": [0, 0, 1] }], "until": [{ "piece": "box", "direction": [0, 0, 1], "force_n": 1e6 },
            { "piece": "vane", "turned_deg": 100 }] });
    let outcome = go(before_everything(), turn);
    let setup = Setup::new(&scenario()).expect("a laboratory");
    let mass = setup.pieces[2].volume() * 2700.0;
    let inertia = setup.pieces[2].inertia_about(&Vector::z(), &Default::default(), mass);
    // Four blades of 24 mm from 1 to 25 mm, and the core.
    let blade = 2.0 * 24.0 * 40.0 * 2.7e-6;
    let law = 4.0 * blade * ((24.0 * 24.0 + 4.0) / 12.0 + 13.0 * 13.0)
        + 2.0 * 2.0 * 40.0 * 2.7e-6 * 8.0 / 12.0;
    near("moment of inertia, kg m²", inertia, law * 1e-6, 1e-9 * law);
    let press = outcome.specimen.state.pieces[2].press.expect("pressed");
    let turned = press.turns.expect("turns").turned_rad;
    let time = outcome.simulated;
    near("α t²/2, rad", turned, 0.5 * 1e-4 / inertia * time * time, 0.02 * turned);
    let found = outcome.until.as_ref().expect("conditions");
    assert_eq!(found.conditions[1].found.turned_deg, Some(turned.to_degrees()), "law: {found:?}");
    assert!(found.reached && turned.to_degrees() >= 100.0, "law: its angle, {found:?}");
    let angle = outcome.specimen.state.pieces[2].pose.rotation.scaled_axis().z;
    let whole = 2.0 * std::f64::consts::PI;
    let off = (angle - turned + 0.5 * whole).rem_euclid(whole) - 0.5 * whole;
    near("its pose says so, rad", off, 0.0, 1e-6);
}
