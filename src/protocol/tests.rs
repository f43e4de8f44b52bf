//! The stages, on a world that follows a script.

use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};

use super::testing::*;
use super::*;
use crate::scenario::Scenario;
use crate::specimen::FunnelState;
use crate::world::{World, scripted::ScriptedWorld};

fn scenario() -> Scenario {
    scenario_of(json!({ "grains": { "total_mass_g": 30, "density_kg_per_m3": 2673.9 } }))
}

/// Grains at the given heights above the middle of the cylinder.
fn poured(heights: &[f64]) -> Specimen {
    let mut specimen = specimen_of(&scenario(), 1);
    specimen.state.cylinder = true;
    for (i, grain) in specimen.state.bodies.iter_mut().enumerate() {
        let height = heights.get(i).copied().unwrap_or(0.05);
        grain.body.pose = Pose::translation(0.0, 0.0, height);
    }
    specimen
}

struct Times(Vec<f64>);

impl Observer for Times {
    fn observe(&mut self, _: &Specimen, moment: Moment) {
        self.0.push(moment.stage_time);
    }
}

type Maker = Box<dyn Fn() -> ScriptedWorld + Sync>;

fn carry_out(
    make: Maker,
    specimen: Specimen,
    stage: &StageSpec,
) -> (Result<StageOutcome, StageError>, Vec<f64>) {
    let (scenario, make, mut times) = (scenario(), scripted_worlds(make), Times(Vec::new()));
    (run_stage(&scenario, &make, specimen, stage, None, &mut times), times.0)
}

fn still() -> Maker {
    Box::new(|| ScriptedWorld::still(STEP))
}

/// Nothing gets anywhere, and nothing rests.
fn restless() -> Maker {
    Box::new(|| {
        ScriptedWorld::new(
            STEP,
            Box::new(|_, state, _, _| BodyState {
                linear_velocity: Vector::new(0.03, 0.0, 0.0),
                ..*state
            }),
        )
    })
}

fn rest(duration_s: f64) -> StageSpec {
    StageSpec::Rest { duration_s }
}

fn vibrate(periods: u32, rest_s: f64) -> StageSpec {
    stage(json!({
        "stage": "vibrate", "frequency_hz": 3, "amplitude_mm": 25, "duration_s": 1,
        "periods": periods, "rest_s": rest_s
    }))
}

fn place() -> StageSpec {
    stage(json!({ "stage": "place_top_plate", "time_limit_s": 1 }))
}

#[test]
fn a_rest_lasts_as_long_as_it_says_and_is_observed_every_0_08_s() {
    let (outcome, times) = carry_out(still(), poured(&[]), &rest(1.0));
    let outcome = outcome.expect("rests");
    assert_eq!(outcome.steps, 480);
    let grains = &outcome.specimen.grains.grains;
    let given: Vec<Option<HeldShape>> = grains
        .iter()
        .map(|g| {
            let corners = g.shape.vertices().iter().map(|v| v.coords).collect();
            Some(HeldShape { corners, rounding: 0.0 })
        })
        .collect();
    assert_eq!(outcome.corners, given, "the shapes that the world was given are read back");
    assert!((outcome.specimen.state.time - 1.0).abs() < 1e-12);
    assert_eq!(times.len(), 14, "at the start, 12 times in between, at the end: {times:?}");
    for (i, time) in times[..13].iter().enumerate() {
        let expected = 0.08 * i as f64;
        assert!((time - expected).abs() <= STEP, "expected {expected}, got {time}");
    }
    assert_eq!(times[13], 1.0, "and at the very end");
}

#[test]
fn a_settled_specimen_ends_its_stage_early_and_a_restless_one_does_not() {
    let stage = place();
    let (outcome, _) = carry_out(still(), poured(&[]), &stage);
    let outcome = outcome.expect("settles");
    // Held for 0.25 s from the first look at 0.02 s on.
    assert!((0.26..0.32).contains(&outcome.simulated), "ended after {} s", outcome.simulated);
    assert!(outcome.warnings.is_empty(), "{:?}", outcome.warnings);
    assert!(outcome.settling.is_some_and(|s| s.settled), "law: said, {:?}", outcome.settling);
    let (outcome, _) = carry_out(restless(), poured(&[]), &stage);
    let outcome = outcome.expect("ends at the limit");
    assert!((outcome.simulated - 1.0).abs() < 1e-9);
    let moved = Settling { time_s: outcome.simulated, limit_s: 1.0, settled: false };
    assert_eq!(outcome.settling, Some(moved), "law: and that it did not settle");
    assert!(outcome.warnings.iter().any(|w| w.contains("had not settled")));
}

/// Law: a plate that is seated settles three times; what is said of its settling is of the last,
/// which the limit is of.
#[test]
fn a_seated_plate_settles_within_the_limit_of_its_last_part() {
    let stage =
        stage(json!({ "stage": "place_top_plate", "time_limit_s": 0.5, "seating_load_n": 10 }));
    let (outcome, _) = carry_out(still(), poured(&[]), &stage);
    let outcome = outcome.expect("settles");
    let took = outcome.simulated;
    assert!((0.75..0.96).contains(&took), "law: held for 0.25 s three times, got {took} s");
    let settling = outcome.settling.expect("it is said");
    assert!(settling.settled, "law: a still world settles: {settling:?}");
    let time_s = settling.time_s;
    assert!(
        (0.25..0.32).contains(&time_s),
        "law: of the last part, 0.25 s to 0.32 s, got {time_s} s"
    );
}

/// Law: a weight F on the plate that sinks by h puts F h in, however much the plate itself loses:
/// what is dissipated is what is put in less the gain of grains and plate, whose potential energies
/// fall.
#[test]
fn a_weight_that_sinks_with_the_plate_does_its_work() {
    const SUNK: f64 = 1e-4;
    let worlds = AtomicU32::new(0);
    // The second world is that of the weight: in it all bodies sink for 48 steps.
    let make = move || {
        let sinks = worlds.fetch_add(1, Ordering::Relaxed) == 1;
        ScriptedWorld::new(
            STEP,
            Box::new(move |_, state, step, _| {
                let mut next = BodyState::at_rest(state.pose);
                next.pose.translation.vector.z -=
                    if sinks && step <= 48 { SUNK / 48.0 } else { 0.0 };
                next
            }),
        )
    };
    let stage =
        stage(json!({ "stage": "place_top_plate", "time_limit_s": 0.5, "seating_load_n": 10 }));
    let specimen = poured(&[]);
    let setup = Setup::new(&scenario()).expect("a laboratory");
    let grains: f64 = specimen.grains.grains.iter().map(|grain| grain.mass).sum();
    let lost = (grains + setup.plate.mass) * setup.gravity * SUNK;
    let (outcome, _) = carry_out(Box::new(make), specimen, &stage);
    let balance = outcome.expect("it settles").watch.balance;
    near("work of the weight, J", balance.input, 10.0 * SUNK, 1e-9);
    near("dissipated, J", balance.dissipated, 10.0 * SUNK + lost, 1e-9);
}

#[test]
fn the_table_is_moved_to_the_exact_sinusoid_at_the_end_of_each_step() {
    struct X(Vec<(f64, f64)>);
    impl Observer for X {
        fn observe(&mut self, specimen: &Specimen, moment: Moment) {
            self.0.push((moment.stage_time, specimen.state.table_x));
        }
    }
    let stage = vibrate(2, 0.5);
    let motion = stage.motion().expect("it vibrates");
    let (make, mut seen) = (scripted_worlds(still()), X(Vec::new()));
    let outcome = run_stage(&scenario(), &make, poured(&[]), &stage, None, &mut seen);
    let outcome = outcome.expect("vibrates");
    let settling = outcome.settling.expect("it settles");
    assert!(
        settling.settled && settling.limit_s == 2.0,
        "law: a still world settles: {settling:?}"
    );
    assert!((0.25..0.32).contains(&settling.time_s), "law: held for 0.25 s, {settling:?}");
    let shaken = outcome.simulated - settling.time_s;
    assert!((shaken - 2.5).abs() < 1e-9, "two periods of 1 s and a rest of 0.5 s");
    assert!(outcome.specimen.state.table_x.abs() < 1e-12, "ends where it began");
    let end = seen.0.iter().any(|(time, _)| (time - 2.5).abs() < 1e-9);
    assert!(end, "law: the end of shaking is seen");
    for (time, x) in seen.0 {
        let expected = motion.displacement(time).x;
        near(&format!("x(t) = A sin 2πft at {time} s"), x, expected, 1e-15);
    }
}

#[test]
fn the_plate_is_let_go_just_above_the_highest_grain() {
    let specimen = poured(&[0.12]);
    let highest = specimen.grains.grains[0].shape.bounding_box().1.z + 0.12;
    let (outcome, _) = carry_out(still(), specimen, &place());
    let plate = outcome.expect("placed").specimen.state.top_plate.expect("a plate");
    let gap = plate.pose.translation.z - 0.005 - highest;
    let expected = 1e-4 * 10.0 / 8.0;
    near("0.0125 of the smallest grains, of 10 mm", gap, expected, 1e-12);
    assert_eq!(plate.pose.rotation.angle(), 0.0, "level");
}

/// Grains in a funnel that its lid closes.
fn in_funnel() -> Specimen {
    let mut specimen = poured(&[0.21, 0.25]);
    specimen.state.cylinder = false;
    specimen.state.funnel = Some(FunnelState { opening_height: 0.2, lid: true });
    for grain in &mut specimen.state.bodies[2..] {
        grain.body.pose.translation.vector.z = 0.3;
    }
    specimen
}

#[test]
fn pouring_lifts_the_funnel_and_counts_what_hangs_in_it() {
    let stage = StageSpec::Pour { falling_height_mm: 50.0, time_limit_s: 1.0 };
    let (outcome, _) = carry_out(still(), in_funnel(), &stage);
    let outcome = outcome.expect("poured");
    let state = &outcome.specimen.state;
    assert!(state.cylinder && state.funnel.is_none(), "the funnel is taken away");
    assert!((state.bodies[0].body.pose.translation.z - 0.26).abs() < 1e-12, "lifted by 50 mm");
    assert!(state.bodies.iter().all(|g| g.fate == Fate::LeftInFunnel), "nothing fell");
    let told = |outcome: &StageOutcome| {
        let left = format!("{} grains were left", outcome.specimen.state.bodies.len());
        outcome.warnings.iter().find(|w| w.starts_with(&left)).cloned().unwrap_or_default()
    };
    let at_rest = told(&outcome);
    assert!(at_rest.contains("had come to rest"), "law: it had, got `{at_rest}`");
    let (outcome, _) = carry_out(restless(), in_funnel(), &stage);
    let outcome = outcome.expect("poured");
    let warnings = &outcome.warnings;
    assert!(warnings.iter().any(|w| w.contains("had not settled")), "got {warnings:?}");
    assert!(outcome.settling.is_some_and(|s| !s.settled), "law: said, {:?}", outcome.settling);
    let moving = told(&outcome);
    assert!(
        moving.ends_with("when the stage ended"),
        "law: of grains that move it is not said that they rest, got `{moving}`"
    );
}

/// Law: grains above the rim and below the funnel's opening are said to lie on a heap that the cylinder
/// is too low for, and not to hang in the funnel, which a wider one would help.
#[test]
fn a_heap_above_the_rim_does_not_hang_in_the_funnel() {
    let mut specimen = in_funnel();
    // Lifted by 50 mm, the first lies 10 mm above the rim, at 200 mm, and the rest above the opening.
    let first = &mut specimen.state.bodies[0];
    first.body.pose.translation.vector.z = 0.16;
    let stage = StageSpec::Pour { falling_height_mm: 50.0, time_limit_s: 1.0 };
    let (outcome, _) = carry_out(still(), specimen, &stage);
    let outcome = outcome.expect("poured");
    let bodies = &outcome.specimen.state.bodies;
    assert!(bodies.iter().all(|grain| grain.fate == Fate::LeftInFunnel), "law: the fate stays");
    for expected in [
        format!("{} grains were left hanging in the funnel when", bodies.len() - 1),
        "1 grain lay heaped above the rim when everything had come to rest, and was taken away with \
         the funnel: the cylinder is too low for it"
            .to_owned(),
    ] {
        let said = outcome.warnings.iter().any(|warning| warning.starts_with(&expected));
        assert!(said, "law: expected `{expected}`, got {:?}", outcome.warnings);
    }
}

/// Law: what is taken away with the funnel bears nothing any more: the contacts that a pour leaves are
/// those of grains in the cylinder, and the next stage begins from them.
#[test]
fn contacts_of_what_hangs_in_the_funnel_go_with_it() {
    let _turn = crate::world::shared_turn();
    let mut scenario = scenario();
    // So narrow that all of them hang.
    scenario.apparatus.funnel.opening_diameter_mm = 6.0;
    let run_in_engine = |specimen: Specimen, stage: &StageSpec| {
        run_stage(&scenario, &crate::world::create, specimen, stage, None, &mut ())
            .expect("it runs")
    };
    let fill = StageSpec::FillFunnel { time_limit_s: 4.0 };
    let mut filled = run_in_engine(specimen_of(&scenario, 1), &fill).specimen;
    let is_of =
        |contact: &SavedContact, grain: usize| contact.between.contains(&Party::Grain(grain));
    // One lies in the cylinder already.
    filled.state.contacts.retain(|contact| !is_of(contact, 0));
    assert!(filled.state.contacts.len() > 10, "the check sees contacts in the funnel");
    filled.state.bodies[0].body = BodyState::at_rest(Pose::translation(0.0, 0.0, 0.02));
    let pour = StageSpec::Pour { falling_height_mm: 0.0, time_limit_s: 4.0 };
    let StageOutcome { specimen, corners, .. } = run_in_engine(filled, &pour);
    let state = &specimen.state;
    let hang = state.bodies.iter().filter(|grain| grain.fate == Fate::LeftInFunnel).count();
    assert_eq!(hang, state.bodies.len() - 1, "law: all but one hang in the funnel");
    assert!(!state.contacts.is_empty(), "law: the one that lies in the cylinder bears its weight");
    let gone = state.contacts.iter().filter(|contact| !is_of(contact, 0)).count();
    assert_eq!(gone, 0, "law: no contact of what is gone, of {:?}", state.contacts);
    let held: Vec<bool> = corners.iter().map(Option::is_some).collect();
    let there: Vec<bool> = state.bodies.iter().map(|grain| grain.fate == Fate::Present).collect();
    assert_eq!(held, there, "law: shapes of grains that are there");
}

#[test]
fn grains_that_fall_outside_are_taken_away_and_remembered() {
    let mut specimen = poured(&[]);
    specimen.state.bodies[0].body.pose.translation.vector = Vector::new(0.2, 0.0, 0.1);
    let falling: Maker = Box::new(|| ScriptedWorld::falling(STEP, Vector::new(0.0, 0.0, -9.81)));
    let (outcome, _) = carry_out(falling, specimen, &rest(0.5));
    let outcome = outcome.expect("rests");
    let fates: Vec<Fate> = outcome.specimen.state.bodies.iter().map(|g| g.fate).collect();
    assert_eq!(fates[0], Fate::Spilled, "it was never inside");
    // The others fall through the floor, which this world does not have.
    assert!(fates[1..].iter().all(|f| *f == Fate::ThroughWall), "{fates:?}");
    let through = outcome.warnings.iter().filter(|w| w.contains("passed through a wall")).count();
    assert_eq!(through, fates.len() - 1);
    let named = outcome.warnings.iter().any(|w| w.starts_with("grain_00001 passed through"));
    assert!(named, "law: a grain has the name that tables give it: {:?}", outcome.warnings);
}

/// Law: a plate that has left the cylinder ends the stage, is named, and nothing is called too fast.
#[test]
fn a_plate_that_falls_off_ends_the_stage() {
    let mut specimen = poured(&[0.07]);
    // Beside the grains, in a world without a floor.
    let place = Pose::translation(0.3, 0.0, 0.1);
    specimen.state.top_plate = Some(BodyState::at_rest(place));
    let falling: Maker = Box::new(|| ScriptedWorld::falling(STEP, Vector::new(0.0, 0.0, -9.81)));
    let (outcome, _) = carry_out(falling, specimen, &rest(2.0));
    let StageError::World { source, .. } = outcome.expect_err("law: nothing bears it") else {
        panic!("law: the world has failed")
    };
    let text = source.to_string();
    assert!(text.ends_with("the top plate fell off the cylinder"), "law: what fell, got `{text}`");
}

/// Law: what is found in a stage carries its time in the run, where `view` and `series.csv` have it,
/// not that in the stage.
#[test]
fn findings_carry_the_time_of_the_run() {
    let falling =
        || -> Maker { Box::new(|| ScriptedWorld::falling(STEP, Vector::new(0.0, 0.0, -9.81))) };
    let told = |began_s: f64| {
        let mut specimen = poured(&[]);
        specimen.state.time = began_s;
        let (outcome, _) = carry_out(falling(), specimen, &rest(0.5));
        let warnings = outcome.expect("rests").warnings;
        let through = warnings.iter().find_map(|w| w.split_once("passed through a wall at "));
        let time = through.and_then(|(_, rest)| rest.split_once(" s,")).map(|(time, _)| time);
        time.and_then(|time| time.parse::<f64>().ok()).expect("law: a time")
    };
    near("30 s later in a run that is 30 s older", told(30.0), told(0.0) + 30.0, 1.5e-3);
}

#[test]
fn an_unphysical_world_ends_the_stage_and_keeps_the_last_good_specimen() {
    let (outcome, _) = carry_out(Box::new(exploding), poured(&[0.07]), &rest(1.0));
    let error = outcome.expect_err("NaN must not pass");
    let StageError::World { source, last_good } = error else { panic!("{error}") };
    let text = source.to_string();
    let at = "grain_00000 at (0, 0, 70) mm has a speed of NaN m/s";
    assert!(text.contains(at), "law: a grain that files name, expected `{at}`, got `{text}`");
    let good = &last_good.state;
    assert!(good.time > 0.1 && good.time < 0.22, "kept from before step 100: {} s", good.time);
    assert!(good.bodies.iter().all(|g| g.body.linear_velocity.iter().all(|v| v.is_finite())));
}

/// Law: what is kept of a stage that fails has the table where it was at the last look, as the grains.
#[test]
fn the_table_is_kept_where_it_was_at_the_last_look() {
    let shaking = vibrate(1, 0.0);
    let (outcome, _) = carry_out(Box::new(exploding), poured(&[]), &shaking);
    let error = outcome.expect_err("NaN must not pass");
    let StageError::World { last_good, .. } = error else { panic!("{error}") };
    let good = &last_good.state;
    assert!(good.time > 0.0, "expected a look before it failed, got none");
    let motion = shaking.motion().expect("a motion");
    let expected = motion.displacement(good.time).x;
    near("the table at the last look, m", good.table_x, expected, 1e-12);
}

/// Keeps what it is warned of.
struct Warned(Vec<String>);

impl Observer for Warned {
    fn observe(&mut self, _: &Specimen, _: Moment) {}

    fn warn(&mut self, finding: &str) {
        self.0.push(finding.to_owned());
    }
}

/// Law: that grains had not settled under the plate is said once its first part has ended, and not
/// lost where a later part of the stage fails.
#[test]
fn a_warning_of_the_seating_outlives_the_failure_of_a_later_part() {
    let (worlds, restless) = (AtomicU32::new(0), restless());
    let make = |_: &EngineSettings, _: Vector, _: &PairTable| {
        if worlds.fetch_add(1, Ordering::Relaxed) > 0 {
            return Err(WorldError::Engine("refused".to_owned()));
        }
        Ok(Box::new(restless()) as Box<dyn World + Send>)
    };
    let seated = json!({ "stage": "place_top_plate", "time_limit_s": 0.5, "seating_load_n": 2 });
    let mut heard = Warned(Vec::new());
    let outcome = run_stage(&scenario(), &make, poured(&[]), &stage(seated), None, &mut heard);
    let error = outcome.expect_err("law: no world for the weight").to_string();
    assert!(error.contains("refused"), "law: it fails as it did, got `{error}`");
    let told = heard.0.iter().filter(|text| text.contains("of seating the top plate")).count();
    assert_eq!(told, 1, "law: said once, got {:?}", heard.0);
}

#[test]
fn a_request_to_stop_is_heard() {
    let setup = Setup::new(&scenario()).expect("a laboratory");
    let (make, cancel) = (scripted_worlds(still()), AtomicBool::new(true));
    let outcome = run(&setup, &make, poured(&[]), &rest(100.0), None, &mut (), &cancel);
    assert!(matches!(outcome, Err(StageError::Cancelled)));
}

#[test]
fn stages_out_of_order_are_refused() {
    let mut in_funnel = poured(&[]);
    in_funnel.state.cylinder = false;
    for stage in [vibrate(1, 0.0), place()] {
        let (outcome, _) = carry_out(still(), in_funnel.clone(), &stage);
        assert!(matches!(outcome, Err(StageError::OutOfOrder { .. })), "{stage:?}");
    }
    let pour = StageSpec::Pour { falling_height_mm: 0.0, time_limit_s: 1.0 };
    let (outcome, _) = carry_out(still(), poured(&[]), &pour);
    assert!(matches!(outcome, Err(StageError::OutOfOrder { stage: "pour", .. })));
}
