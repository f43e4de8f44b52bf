//! Laboratories of pieces: on a world that follows a script, and in the engine.

use super::testing::*;
use super::*;
use crate::motion::{Path, PieceMotion};
use crate::plain::four_digits;
use crate::scenario::Scenario;
use crate::specimen::GrainState;
use crate::world::scripted::ScriptedWorld;

fn scenario() -> Scenario {
    scenario_of(json!({
        "grains": {
            "total_mass_g": 40, "density_kg_per_m3": 2673.9,
            "sieve_table": [
                { "passing_mm": 12.5, "retained_mm": 10, "mass_percent": 50 },
                { "passing_mm": 10, "retained_mm": 8, "mass_percent": 50 }
            ]
        },
        "pieces": [
            { "name": "box", "shape": { "box": { "inner_mm": [60, 60, 60] } } },
            { "name": "gate", "shape": { "plate": { "size_mm": [10, 10, 10] } }, "at_mm": [200, 0, 0] }
        ]
    }))
}

fn specimen() -> Specimen {
    specimen_of(&scenario(), 1)
}

fn carry_out(specimen: Specimen, stage: &StageSpec) -> Result<StageOutcome, StageError> {
    let make = scripted_worlds(|| ScriptedWorld::still(STEP));
    run_stage(&scenario(), &make, specimen, stage, None, &mut ())
}

fn in_engine(specimen: Specimen, stage: &StageSpec) -> StageOutcome {
    let make = &crate::world::create;
    run_stage(&scenario(), make, specimen, stage, None, &mut ()).expect("it runs")
}

fn present(specimen: &Specimen) -> Vec<usize> {
    specimen.present().collect()
}

/// Law: grains are followed as far down as a piece is moved, also by 64 cycles, and as far as a
/// pressed one has sunk, with which grains go.
#[test]
fn pieces_reach_as_low_as_they_are_moved_and_have_sunk() {
    let setup = Setup::new(&scenario()).expect("a laboratory");
    let mut state = laboratory::begun(&setup, specimen()).state;
    let pieces_of = |state: &SpecimenState, drive: Option<Drive>| {
        let mut world = ScriptedWorld::still(STEP);
        let mut parties = HashMap::new();
        Pieces::add(&mut world, &setup, state, &state.pieces, drive, &mut parties).expect("pieces")
    };
    let still = pieces_of(&state, None).lowest(&state);
    near("the box where it stands, m", still, -setup.pieces[0].radius, 1e-12);
    let path = Path::Sine { amplitude: Vector::new(0.0, 0.0, 0.08), frequency: 64.0 };
    let motion = PieceMotion { path, duration: 1.0, ramp: 0.0 };
    let shaken = pieces_of(&state, Some(Drive { pieces: vec![0], motion })).lowest(&state);
    near("the box in its lowest place, m", shaken, still - 0.08, 1e-12);
    let press = PressState { direction: -Vector::z(), mass_kg: 0.2, ..PressState::default() };
    state.pieces[1].press = Some(press);
    let pieces = pieces_of(&state, None);
    near("the pressed gate stands above, m", pieces.lowest(&state), still, 1e-12);
    state.pieces[1].pose.translation.vector.z -= 0.5;
    let sunk = -0.5 - setup.pieces[1].radius;
    near("the gate has sunk, m", pieces.lowest(&state), sunk, 1e-12);
}

/// Law: a message on a load of sand that is not reached has its digits.
#[test]
fn what_a_small_load_lacks_has_digits() {
    let press = PressState { force_n: 1.25e-5, target_n: 2e-4, ..PressState::default() };
    let told = laboratory::lacking("lid", press).expect("law: it is lacking");
    let expected = "`lid` is pressed with 0.0000125 N of the 0.0002 asked for";
    assert_eq!(told, expected, "law: not 0 N of 0");
}

#[test]
fn a_layer_takes_its_own_sieve_fraction_and_the_rest_waits() {
    let lattice = |sizes: [f64; 2]| {
        stage(json!({ "stage": "deposit", "how": "lattice", "at_mm": [0, 0, 100],
            "area_mm": [50, 50], "sizes_mm": sizes, "time_limit_s": 1 }))
    };
    let fine = carry_out(specimen(), &lattice([8.0, 10.0])).expect("a layer").specimen;
    let set = fine.grains.clone();
    let of = |n: &usize| set.grains[*n].fraction;
    assert!(present(&fine).iter().all(|n| of(n) == 1), "law: the finer fraction alone");
    let waiting = fine.state.bodies.iter().filter(|g| g.fate == Fate::Waiting).count();
    assert_eq!(present(&fine).len() + waiting, set.grains.len(), "law: the others wait");
    let refused = carry_out(fine.clone(), &lattice([8.0, 10.0])).expect_err("law: none is left");
    assert!(refused.to_string().contains("waiting"), "{refused}");
    let both = carry_out(fine, &lattice([10.0, 12.5])).expect("a second layer").specimen;
    assert_eq!(present(&both).len(), set.grains.len(), "law: now all of them are there");
    let places: Vec<_> = both.state.bodies.iter().map(|g| g.body.pose.translation.vector).collect();
    for (a, at) in places.iter().enumerate() {
        for (b, other) in places.iter().enumerate().skip(a + 1) {
            let apart = set.grains[a].shape.radius_about_origin()
                + set.grains[b].shape.radius_about_origin();
            assert!((at - other).norm() > apart, "law: grains {a} and {b} begin apart");
        }
    }
}

#[test]
fn rain_falls_at_its_rate_and_only_as_much_as_is_asked_for() {
    let rain = stage(json!({ "stage": "deposit", "at_mm": [0, 0, 100],
        "diameter_mm": 10000, "rate_g_per_s": 20, "mass_g": 15, "time_limit_s": 5 }));
    let outcome = carry_out(specimen(), &rain).expect("rain");
    let set = &outcome.specimen.grains;
    let mass = |n: &usize| set.grains[*n].mass * 1e3;
    let fallen: f64 = present(&outcome.specimen).iter().map(mass).sum();
    let heaviest = set.grains.iter().map(|g| g.mass * 1e3).fold(0.0, f64::max);
    assert!((15.0..15.0 + heaviest).contains(&fallen), "law: 15 g and no grain more, {fallen} g");
    let settle = scenario().settle.hold_s;
    // The last grain is let go at the first check after its time.
    let expected = (fallen - heaviest) / 20.0 + settle;
    assert!(
        (expected..expected + heaviest / 20.0 + 0.2).contains(&outcome.simulated),
        "law: 20 g/s, then at rest for {settle} s; {fallen} g took {} s",
        outcome.simulated
    );
}

/// Keeps which grains were let go, and where.
#[derive(Default)]
struct LetGo(Vec<(usize, Vector)>);

impl Observer for LetGo {
    fn observe(&mut self, _: &Specimen, _: Moment) {}

    fn let_go(&mut self, grain: usize, at: &Vector) {
        self.0.push((grain, *at));
    }
}

/// Law: above a surface the sphere around a grain begins as far as is typed above where it would
/// meet the first one beneath, and not below the area; what stays where it was let go has not sunk.
#[test]
fn a_rain_above_a_surface_follows_what_lies_beneath() {
    let rain = stage(json!({ "stage": "deposit", "at_mm": [0, 0, 20], "diameter_mm": 40,
        "above_surface_mm": 5, "rate_g_per_s": 2, "mass_g": 12, "time_limit_s": 30 }));
    // In this world grains stay where they are let go.
    let make = scripted_worlds(|| ScriptedWorld::still(STEP));
    let mut seen = LetGo::default();
    let outcome = run_stage(&scenario(), &make, specimen(), &rain, None, &mut seen);
    let outcome = outcome.expect("rain");
    let set = &outcome.specimen.grains;
    let clearance = set.rain_clearance();
    let radius = |n: usize| set.grains[n].shape.radius_about_origin() + clearance;
    assert!(seen.0.len() >= 5, "some grains, got {}", seen.0.len());
    let mut over_others = 0;
    for (n, (grain, at)) in seen.0.iter().enumerate() {
        let meets = seen.0[..n].iter().filter_map(|(other, there)| {
            let up = (radius(*grain) + radius(*other)).powi(2);
            let up = up - (at.xy() - there.xy()).norm_squared();
            (up > 0.0).then(|| there.z + up.sqrt() + 0.005)
        });
        let expected = meets.fold(0.02, f64::max);
        over_others += u32::from(expected > 0.02);
        near(&format!("height of grain {n} let go, m"), at.z, expected, 1e-12);
    }
    assert!(over_others > 0, "law: some lie over others");
    let fall = outcome.fall.expect("law: it is known");
    near("mean of what sank, mm", fall.mean_mm, 0.0, 1e-9);
    near("the most that sank, mm", fall.largest_mm, 0.0, 1e-9);
    let from_area = stage(json!({ "stage": "deposit", "at_mm": [0, 0, 90], "diameter_mm": 40,
        "rate_g_per_s": 20, "mass_g": 3, "time_limit_s": 5 }));
    let other = carry_out(specimen(), &from_area).expect("rain");
    assert_eq!(other.fall, None, "law: an area that stays says nothing of a surface");
}

/// Law: in the engine, grains let go 20 mm farther above a surface sink 20 mm farther in the mean,
/// whatever they roll and sink then; and they go on from a checkpoint with the same bits.
#[test]
fn a_rain_above_a_surface_falls_as_far_as_typed_and_goes_on_with_the_same_bits() {
    let mut scenario = scenario();
    scenario.engine.native.checkpoint_every_s = Some(0.5);
    let rain = |above_mm: f64| {
        stage(json!({ "stage": "deposit", "at_mm": [0, 0, 15.0 + above_mm], "diameter_mm": 55,
            "above_surface_mm": above_mm, "rate_g_per_s": 20, "time_limit_s": 30 }))
    };
    let (near, _) = same_from_seams(&scenario, &specimen(), &rain(5.0), &[]);
    let (far, _) = same_from_seams(&scenario, &specimen(), &rain(25.0), &[]);
    let falls = [near, far].map(|outcome| outcome.fall.expect("law: it is known"));
    assert!(falls.iter().all(|fall| 0.0 < fall.mean_mm && fall.mean_mm <= fall.largest_mm));
    let more = falls[1].mean_mm - falls[0].mean_mm;
    assert!(
        (more - 20.0).abs() < 5.0,
        "law: 20 mm more, got {more} mm of {falls:?}, tolerance 5 mm"
    );
}

/// Law: a deposit whose grains find no place ends when everything has been at rest for a while, and
/// says so; one that goes on from a checkpoint ends at the same time.
#[test]
fn a_deposit_without_room_ends_long_before_its_limit() {
    // In this world grains stay where they are let go: there is room for a few.
    let rain = stage(json!({ "stage": "deposit", "at_mm": [0, 0, 100],
        "area_mm": [30, 30], "rate_g_per_s": 80, "time_limit_s": 600 }));
    let outcome = carry_out(specimen(), &rain).expect("rain");
    assert!((1.0..3.0).contains(&outcome.simulated), "law: not 600 s, got {} s", outcome.simulated);
    let all = outcome.specimen.grains.grains.len();
    let waiting = outcome.specimen.state.bodies.iter().filter(|g| g.fate == Fate::Waiting).count();
    assert!((1..all).contains(&waiting), "law: {waiting} of {all} wait still");
    let [told] = &outcome.warnings[..] else { panic!("one warning, got {:?}", outcome.warnings) };
    let end =
        format!("the stage ended after {:.2} s, before its limit of 600 s: ", outcome.simulated);
    assert!(told.starts_with(&end), "law: when it ended, got {told}");
    let left = format!("no place was free for the next of {waiting} grains");
    assert!(told.contains(&left), "law: and why, got {told}");
    assert!(told.ends_with("still to come"), "law: no piece is in the way, got {told}");
    let beside = json!({ "name": "insert", "shape": { "plate": { "size_mm": [40, 40, 20] } },
        "at_mm": [0, 0, 100] });
    let mut scenario = scenario();
    scenario.pieces.push(serde_json::from_value(beside).expect("a piece"));
    let make = scripted_worlds(|| ScriptedWorld::still(STEP));
    let outcome = run_stage(&scenario, &make, specimen(), &rain, None, &mut ()).expect("rain");
    let [told] = &outcome.warnings[..] else { panic!("one warning, got {:?}", outcome.warnings) };
    assert!(told.ends_with("; pieces in its area: `insert`"), "law: it is named, got {told}");
    // So low that grains at rest on the floor are in the way of others.
    scenario.pieces.pop();
    scenario.engine.native.checkpoint_every_s = Some(0.5);
    let low = stage(json!({ "stage": "deposit", "at_mm": [0, 0, 12],
        "area_mm": [40, 40], "rate_g_per_s": 200, "time_limit_s": 60 }));
    // A checkpoint keeps how long nothing moved.
    let (whole, _) = same_from_seams(&scenario, &specimen(), &low, &[]);
    assert!(whole.simulated < 20.0, "law: not 60 s, got {} s", whole.simulated);
}

/// Law: a deposit says how many grains fell out, and that fewer were there than it asks for; one
/// that gets what it asks for says nothing.
#[test]
fn a_deposit_says_what_is_lost_and_what_it_lacks() {
    let lattice = |z: f64, mass_g: f64| {
        let stage = stage(json!({ "stage": "deposit", "how": "lattice", "at_mm": [0, 0, z],
            "area_mm": [50, 50], "mass_g": mass_g, "time_limit_s": 1 }));
        let mut outcome = carry_out(specimen(), &stage).expect("a deposit");
        outcome.warnings.retain(|text| !text.starts_with("the lattice of the deposit is"));
        outcome
    };
    let outcome = lattice(100.0, 15.0);
    assert_eq!(outcome.warnings, [""; 0], "law: 15 of 40 g fall into the box");
    let outcome = lattice(100.0, 41.0);
    assert_eq!(outcome.warnings, [""; 0], "law: less than a grain short of what was typed");
    let outcome = lattice(100.0, 300.0);
    let told = "asks for 300 g of grains, and only 40 g were waiting";
    assert!(outcome.warnings.iter().any(|text| text.contains(told)), "{:?}", outcome.warnings);
    let outcome = lattice(-1000.0, 15.0);
    let fallen = outcome.specimen.state.bodies.iter().filter(|g| g.fate == Fate::Spilled).count();
    assert!(fallen > 0 && present(&outcome.specimen).is_empty(), "law: all of them fall out");
    let told = format!("{fallen} of {fallen} grains fell out during the deposit");
    assert!(outcome.warnings.iter().any(|text| text.contains(&told)), "{:?}", outcome.warnings);
}

#[test]
fn pieces_move_as_prescribed_stay_there_and_are_removed() {
    let turn = stage(json!({ "stage": "move", "pieces": ["box"], "travel_deg": 90,
        "rotation": { "axis": [0, 0, 2], "about_mm": [100, 0, 0], "deg_per_s": 90 } }));
    let turned = carry_out(specimen(), &turn).expect("it moves");
    assert!((turned.simulated - 1.0).abs() < 1e-9, "law: 90° at 90°/s, {} s", turned.simulated);
    let pieces = &turned.specimen.state.pieces;
    let at = pieces[0].pose * Point::origin();
    assert!((at.coords - Vector::new(0.1, -0.1, 0.0)).norm() < 1e-12, "{at}");
    assert_eq!(pieces[1].pose, Pose::translation(0.2, 0.0, 0.0), "law: the other one stays");
    let remove = stage(json!({ "stage": "remove", "pieces": ["gate"], "time_limit_s": 1 }));
    let without = carry_out(turned.specimen, &remove).expect("removed").specimen;
    assert_eq!(without.state.pieces.iter().map(|p| p.present).collect::<Vec<_>>(), [true, false]);
    let again = carry_out(without, &remove).expect_err("law: it is gone");
    assert!(again.to_string().contains("do not stand"), "{again}");
}

/// Law: what is kept of a stage that fails has pieces where they were at the last look, as the grains,
/// and no contacts: those of the stage's beginning are gone.
#[test]
fn a_moved_piece_is_kept_where_it_was_at_the_last_look() {
    let setup = Setup::new(&scenario()).expect("a laboratory");
    let mut before = laboratory::begun(&setup, specimen());
    before.state.bodies[0].fate = Fate::Present;
    before.state.bodies[0].body.pose = Pose::translation(0.0, 0.0, 0.03);
    before.state.contacts = vec![SavedContact {
        between: [Party::Grain(0), Party::Grain(1)],
        point_m: Vector::zeros(),
        normal: Vector::z(),
        force_n: Vector::zeros(),
        warm_start: 1.0,
        feature: [0, 0],
    }];
    let lift = stage(json!({ "stage": "move", "pieces": ["gate"],
        "velocity_mm_per_s": [0, 0, 20], "duration_s": 1 }));
    let make = scripted_worlds(exploding);
    let failed = run_stage(&scenario(), &make, before, &lift, None, &mut ());
    let error = failed.expect_err("NaN must not pass");
    let StageError::World { last_good, .. } = error else { panic!("{error}") };
    let good = &last_good.state;
    assert!(good.time > 0.0, "expected a look before it failed, got none");
    let (got, expected) = (good.pieces[1].pose.translation.z, 0.02 * good.time);
    near("rise of the gate at the last look, m", got, expected, 1e-12);
    assert!(good.contacts.is_empty(), "law: expected no contacts, got {:?}", good.contacts);
}

#[test]
fn at_rest_the_box_carries_the_weight_of_the_grains() {
    let rain = stage(json!({ "stage": "deposit", "at_mm": [0, 0, 90],
        "area_mm": [50, 50], "rate_g_per_s": 80 }));
    let poured = in_engine(specimen(), &rain).specimen;
    assert_eq!(present(&poured).len(), poured.grains.grains.len(), "law: nothing gets lost");
    let rested = in_engine(poured, &StageSpec::Rest { duration_s: 1.0 }).specimen;
    let weight = rested.grains.total_mass() * scenario().gravity_m_per_s2;
    let force = rested.state.pieces[0].force_n;
    assert!(
        (-force.z / weight - 1.0).abs() < 0.01 && force.xy().norm() < 0.01 * weight,
        "law: {weight} N downwards, expected within 1 %, got {force:?}"
    );
    assert_eq!(rested.state.pieces[1].force_n, Vector::zeros(), "law: untouched");
    // A box in which they are carried up at a constant speed carries the same.
    let lift = stage(json!({ "stage": "move", "pieces": ["box"],
        "velocity_mm_per_s": [0, 0, 100], "duration_s": 0.8, "ramp_s": 0.1 }));
    let outcome = in_engine(rested, &lift);
    let (lifted, watch) = (outcome.specimen, outcome.watch);
    assert_eq!(present(&lifted).len(), lifted.grains.grains.len(), "law: all come along");
    let way = lifted.state.pieces[0].pose.translation.z;
    assert!((way - 0.07).abs() < 1e-9, "law: v (T − r), got {way} m");
    let lost = watch.energy.worst;
    assert!(lost < 0.05 * weight * way, "law: the box gives the energy, {lost} J unexplained");
}

/// Law: a stage that goes on from a checkpoint ends as one that was never interrupted, grains
/// that are still to be let go and pieces on their way included.
#[test]
fn rain_and_motion_go_on_from_a_checkpoint_with_the_same_bits() {
    let mut scenario = scenario();
    scenario.engine.native.checkpoint_every_s = Some(0.2);
    let rain = stage(json!({ "stage": "deposit", "at_mm": [0, 0, 90],
        "area_mm": [50, 50], "rate_g_per_s": 60 }));
    let turn = stage(json!({ "stage": "move", "pieces": ["box"], "travel_deg": 20,
        "rotation": { "axis": [0, 1, 0], "deg_per_s": 30 }, "ramp_s": 0.1, "settle_limit_s": 1 }));
    let (rained, _) = same_from_seams(&scenario, &specimen(), &rain, &[0]);
    same_from_seams(&scenario, &rained.specimen, &turn, &[0]);
}

/// Law: what grains bear of a piece, against a direction, or as a moment about an axis.
#[test]
fn what_is_borne_counts_against_the_direction() {
    let mut state = PieceState::standing(Pose::translation(0.1, 0.0, 0.0));
    (state.force_n, state.moment_n_m) = (Vector::new(0.0, 0.0, 6.0), Vector::new(0.0, 1.0, 0.0));
    let down = -Vector::z();
    assert_eq!(laboratory::borne(&state, &down, None), 6.0, "law: what pushes up is borne");
    assert_eq!(laboratory::borne(&state, &-down, None), 0.0, "law: what pulls is not");
    // r × F = 0.1 x̂ × 6 ẑ = −0.6 ŷ.
    let got = laboratory::borne(&state, &-Vector::y(), Some(Vector::zeros()));
    assert!((got - 0.4).abs() < 1e-12, "law: 1 − 0.6 N m about the origin, got {got} N m");
}

/// Law: a lattice ends below the first piece over its area; what would begin beyond it lies outside of
/// what is to be filled.
#[test]
fn a_lattice_does_not_go_through_a_piece() {
    let below = stage(json!({ "stage": "deposit", "how": "lattice", "at_mm": [200, 0, -40],
        "area_mm": [8, 8] }));
    let refused = carry_out(specimen(), &below).expect_err("law: the gate is in the way");
    assert!(refused.to_string().contains("room for 1 of"), "law: one below it, got {refused}");
    let allowed = ["`at_mm`", "a larger area", "`mass_g`"];
    let is_said = allowed.iter().all(|words| refused.to_string().contains(words));
    assert!(is_said, "law: with what would help, {allowed:?}, got {refused}");
}

/// Law: a lattice has no places beyond the distance up to which bodies are followed, and its refusal
/// names what would make it lower.
#[test]
fn a_lattice_ends_where_bodies_are_no_longer_followed() {
    let areas = [("area_mm", json!([8, 8])), ("diameter_mm", json!(8))];
    for (field, area) in areas {
        // Up to 20 m there are 50 mm, and one grain lies above the other.
        let mut high = json!({ "stage": "deposit", "how": "lattice", "at_mm": [0, 0, 19950],
            "time_limit_s": 1 });
        high[field] = area;
        let refused = carry_out(specimen(), &stage(high)).expect_err("law: there is no room");
        let is_said = matches!(refused, StageError::Placing(_));
        assert!(is_said, "law: grains could not be placed, got {refused}");
        let (told, field) = (refused.to_string(), format!("`{field}`"));
        for words in ["within the 20 m from the origin", "`at_mm`", field.as_str(), "`mass_g`"] {
            assert!(told.contains(words), "law: expected `{words}`, got {told}");
        }
    }
}

/// Law: grains at the top of a lattice of height h land at √(2 g h); that this is more than the
/// smallest grain's size in a step is a warning, and a lattice from which grains land slower has none.
#[test]
fn a_lattice_from_which_grains_land_too_fast_is_warned_of() {
    let mut scenario = scenario();
    // With which 8 mm in a step are 1.92 m/s, a fall of 188 mm.
    scenario.engine.rate_hz = 240.0;
    let lattice = |side_mm: f64| {
        let stage = stage(json!({ "stage": "deposit", "how": "lattice", "at_mm": [0, 0, 100],
            "area_mm": [side_mm, side_mm], "time_limit_s": 1 }));
        // In this world grains stay where they begin.
        let make = scripted_worlds(|| ScriptedWorld::still(STEP));
        let outcome = run_stage(&scenario, &make, specimen(), &stage, None, &mut ());
        let StageOutcome { specimen, warnings, .. } = outcome.expect("a deposit");
        let highest = specimen.present().map(|n| specimen.centroid(n).z).fold(0.1, f64::max);
        (highest - 0.1, warnings)
    };
    let (height, told) = lattice(8.0);
    let speed = (2.0 * scenario.gravity_m_per_s2 * height).sqrt();
    assert!(speed > 1.92, "the check sees a high lattice, {height} m");
    let [told] = &told[..] else { panic!("law: one warning, got {told:?}") };
    let high = format!("is {} mm high", four_digits(height * 1e3));
    let fast = format!("at about {} m/s", four_digits(speed));
    for words in [high.as_str(), fast.as_str(), "size, 8 mm", "`above_surface_mm`"] {
        assert!(told.contains(words), "law: expected `{words}`, got {told}");
    }
    let (height, told) = lattice(160.0);
    assert!(height < 0.188, "the check sees a low lattice, {height} m");
    assert_eq!(told, [""; 0], "law: nothing is said of {height} m");
}

/// Law: of a grain whose centroid is in a piece it is said in which one it was found, not that it
/// went through.
#[test]
fn a_grain_in_a_piece_is_said_to_be_found_there() {
    let setup = Setup::new(&scenario()).expect("a laboratory");
    let mut specimen = laboratory::begun(&setup, specimen());
    let in_gate = BodyState::at_rest(Pose::translation(0.2, 0.0, 0.0));
    specimen.state.bodies[0] = GrainState { body: in_gate, fate: Fate::Present };
    let outcome = carry_out(specimen, &StageSpec::Rest { duration_s: 0.1 }).expect("it rests");
    let fate = outcome.specimen.state.bodies[0].fate;
    assert_eq!(fate, Fate::ThroughWall, "law: no grain gets into a piece");
    let [told] = &outcome.warnings[..] else { panic!("law: once, got {:?}", outcome.warnings) };
    let found = told.starts_with("grain_00000 was found with its centroid in `gate` at 0.0");
    assert!(found && told.ends_with(" s, at (200, 0, 0) mm"), "law: where and when, got `{told}`");
}
