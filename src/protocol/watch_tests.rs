//! Unexplained energy gains and impossible speeds are found; what falls, lies or is
//! shaken is not taken for them.

use super::testing::*;
use super::*;
use crate::world::scripted::ScriptedWorld;

const GRAVITY: f64 = 9.81;

fn moving(z: f64, speed: f64) -> BodyState {
    BodyState {
        linear_velocity: Vector::new(speed, 0.0, 0.0),
        ..BodyState::at_rest(Pose::translation(0.0, 0.0, z))
    }
}

const MASS: f64 = 2e-3;
const INERTIA: Vector = Vector::new(2e-8, 2e-8, 2e-8);

fn body(state: &BodyState) -> Moving<'_> {
    (MASS, &INERTIA, state)
}

/// Looks at one body after the other state, with the table's velocity at each.
fn watched(states: &[(BodyState, f64)], table_peak: f64) -> (Watch, Vec<Finding>) {
    let mut watch = Watch::default();
    let (first, table) = &states[0];
    let along = |x: f64| Vector::new(x, 0.0, 0.0);
    let first_body = std::iter::once(body(first));
    watch.begin(first_body, -0.05, GRAVITY, (table_peak, along(*table)), -1.0);
    let findings = states[1..].iter().enumerate().map(|(n, (state, table))| {
        let now = Tally::of(std::iter::once(body(state)), GRAVITY);
        // A second passes between looks.
        watch.table_moved(along(f64::midpoint(states[n].1, *table)));
        watch.look(&now, along(*table), n as f64)
    });
    let findings = findings.collect();
    (watch, findings)
}

#[test]
fn a_fall_and_a_blow_of_the_table_cost_nothing() {
    // From 0.2 m to the floor, where half of the speed is lost.
    let fall = (2.0 * GRAVITY * 0.2_f64).sqrt();
    let mut landing = moving(0.0, 0.0);
    landing.linear_velocity.z = -fall;
    let mut up = landing;
    up.linear_velocity.z = fall / 2.0;
    let (watch, findings) = watched(&[(moving(0.2, 0.0), 0.0), (landing, 0.0), (up, 0.0)], 0.0);
    assert!(findings.iter().all(|f| *f == Ok(None)), "{findings:?}");
    assert!(watch.energy.worst < 1e-15, "law: falling gains nothing, got {}", watch.energy.worst);
    // A wall at 0.4 m/s takes the body along, then stops it; elastic is twice its speed.
    let shaken = [(moving(0.0, 0.0), 0.4), (moving(0.0, 0.8), 0.4), (moving(0.0, 0.0), 0.0)];
    let (watch, findings) = watched(&shaken, 0.4);
    assert!(findings.iter().all(|f| *f == Ok(None)), "{findings:?}");
    let got = watch.energy.worst;
    assert!(
        got < 1e-15,
        "law: ½ m (2V)² is V times the momentum 2mV, got {got} J without a source"
    );
}

#[test]
fn unexplained_energy_is_told_and_then_ends_it() {
    let available = MASS * GRAVITY * 0.05;
    let rising = |share: f64| moving(share * 0.05, 0.0);
    let at = |share| (rising(share), 0.0);
    let (watch, findings) = watched(&[at(0.0), at(0.04), at(0.06), at(0.07), at(1.01)], 0.0);
    assert_eq!(findings[0], Ok(None), "law: up to 5 %");
    assert!(matches!(&findings[1], Ok(Some(t)) if t.contains("unexplained energy gain")));
    assert_eq!(findings[2], Ok(None), "law: told once");
    assert!(matches!(&findings[3], Err(t) if t.contains("unexplained energy gain")));
    let share = watch.energy.worst / available;
    assert!((share - 1.01).abs() < 1e-12, "law: m g z of the rise, expected 1.01, got {share}");
    assert_eq!(watch.energy.first_beyond_s, Some(1.0));
    // The same momentum, from a table at rest, has no source.
    let (_, findings) = watched(&[(moving(0.0, 0.0), 0.0), (moving(0.0, 0.8), 0.0)], 0.4);
    assert!(matches!(findings[0], Ok(Some(_))), "{findings:?}");
}

#[test]
fn what_is_gained_in_small_pieces_adds_up_and_losses_take_it_away() {
    let rise = |n: u32| (moving(1e-4 * f64::from(n), 0.0), 0.0);
    let states: Vec<_> = (0..40).map(rise).collect();
    let (watch, findings) = watched(&states, 0.0);
    assert!(findings.iter().any(|f| matches!(f, Ok(Some(_)))), "law: 39 × 0.2 % is 7.8 %");
    assert!(watch.energy.worst > 0.07 * MASS * GRAVITY * 0.05);
    let back_and_forth: Vec<_> = (0..1000).map(|n| rise(n % 2)).collect();
    let (watch, _) = watched(&back_and_forth, 0.0);
    let share = watch.energy.worst / (MASS * GRAVITY * 0.05);
    assert!(share < 0.0021, "law: what goes back is not counted, got {share}");
}

#[test]
fn impossible_speeds_are_told_and_then_end_it() {
    // A heavy budget of energy, so that speed alone is at fault.
    let natural = (2.0 * GRAVITY * 0.05_f64).sqrt();
    let mut watch = Watch::default();
    let bodies = [moving(0.0, 0.0)];
    let heavy = bodies.iter().map(|state| (1e6, &INERTIA, state));
    watch.begin(heavy, -0.05, GRAVITY, (0.0, Vector::zeros()), 0.0);
    let mut look = |factor: f64| {
        let state = moving(0.0, factor * natural);
        watch.look(&Tally::of(std::iter::once(body(&state)), GRAVITY), Vector::zeros(), factor)
    };
    assert_eq!(look(1.49), Ok(None));
    assert!(matches!(look(1.51), Ok(Some(t)) if t.contains("speed")));
    assert_eq!(look(4.9), Ok(None), "law: told once");
    assert!(matches!(look(5.1), Err(t) if t.contains("speed")));
    assert_eq!((watch.speed.looks, watch.speed.beyond), (4, 3));
}

/// Law: an energy or a speed that is no number ends the stage, also where the springs of contacts
/// might have given it back, and where the next body has a number: it is not passed over.
#[test]
fn what_is_no_number_ends_it() {
    let still = moving(0.0, 0.0);
    let one = || Tally::of(std::iter::once(body(&still)), GRAVITY);
    let begun = || {
        let mut watch = Watch::default();
        let first = std::iter::once(body(&still));
        watch.begin(first, -0.05, GRAVITY, (0.0, Vector::zeros()), 0.0);
        watch.press(0.0, 1e-3);
        watch
    };
    let mut watch = begun();
    watch.given(f64::NAN);
    // Twice, as between two checks under a fast table.
    watch.follow(&one(), Vector::zeros(), 0.5);
    let found = watch.look(&one(), Vector::zeros(), 1.0);
    let told = found.expect_err("law: work that is no number is no work");
    assert!(told.contains("unexplained energy gain: NaN J"), "law: it is said, got {told}");
    for speeds in [[f64::NAN, 0.0], [0.0, f64::NAN]] {
        let [first, second] = speeds;
        let now = one().and(0.0, first).and(0.0, second);
        let found = begun().look(&now, Vector::zeros(), 1.0);
        let told = found.expect_err("law: a speed that is no number is none");
        assert!(told.contains("a speed of NaN m/s"), "law: it is said, got {told}");
    }
}

#[test]
fn a_fast_table_is_looked_at_sixteen_times_a_cycle() {
    for (frequency, expected) in [(3.0, 10), (10.0, 3), (30.0, 1), (400.0, 1)] {
        assert_eq!(steps_a_look(frequency, STEP), expected, "law: at {frequency} Hz");
    }
}

#[derive(Default)]
struct Heard(Vec<String>);

impl Observer for Heard {
    fn observe(&mut self, _: &Specimen, _: Moment) {}

    fn warn(&mut self, finding: &str) {
        self.0.push(finding.to_owned());
    }
}

fn rest(make: impl Fn() -> ScriptedWorld + Sync) -> (Result<StageOutcome, StageError>, Heard) {
    let grains = json!({ "total_mass_g": 30, "density_kg_per_m3": 2673.9 });
    let scenario = scenario_of(json!({ "grains": grains }));
    let mut specimen = specimen_of(&scenario, 1);
    specimen.state.cylinder = true;
    for grain in &mut specimen.state.bodies {
        grain.body.pose = Pose::translation(0.0, 0.0, 0.05);
    }
    let (make, mut heard) = (scripted_worlds(make), Heard::default());
    let stage = StageSpec::Rest { duration_s: 1.0 };
    let outcome = run_stage(&scenario, &make, specimen, &stage, None, &mut heard);
    (outcome, heard)
}

fn scripted(script: fn(&BodyState) -> BodyState) -> (Result<StageOutcome, StageError>, Heard) {
    rest(move || ScriptedWorld::new(STEP, Box::new(move |_, s, _, _| script(s))))
}

#[test]
fn grains_that_rise_by_themselves_end_the_stage_with_the_last_good_state() {
    let (outcome, heard) = scripted(|state| {
        let mut next = *state;
        next.pose.translation.vector.z += 1e-3;
        next
    });
    let error = outcome.expect_err("law: no stage in which grains rise for ever");
    let StageError::World { source, last_good } = error else { panic!("{error}") };
    assert!(source.to_string().contains("unexplained energy gain"), "{source}");
    let height = last_good.state.bodies[0].body.pose.translation.z;
    assert!((0.05..0.2).contains(&height), "law: kept from before, got {height} m");
    assert_eq!(heard.0.len(), 1, "law: it was told once before, got {:?}", heard.0);
}

#[test]
fn a_stage_of_which_nothing_is_to_be_told_says_how_often_it_was_looked_at() {
    let (outcome, heard) = scripted(|state| BodyState::at_rest(state.pose));
    let watch = outcome.expect("rests").watch;
    // Every 10 steps, and at samples 38 or 39 steps apart.
    assert!((48..=62).contains(&watch.checks), "law: every 0.02 s, got {}", watch.checks);
    assert_eq!((watch.speed.looks, watch.energy.looks), (watch.checks, watch.checks));
    assert_eq!((watch.energy.passed(), watch.speed.passed()), (Some(true), Some(true)));
    assert!(heard.0.is_empty(), "{:?}", heard.0);
}

#[test]
fn a_grain_that_the_engine_loses_ends_the_stage() {
    let forgetful = || {
        let mut world = ScriptedWorld::still(STEP);
        world.forgets_after = 100;
        world
    };
    let (outcome, _) = rest(forgetful);
    let error = outcome.expect_err("law: no grain is lost in silence").to_string();
    let is_grain = error.contains(": grain_") && error.contains("no longer in the engine");
    assert!(is_grain, "law: a grain that files name, got `{error}`");
}

/// Law: what falls and comes to rest has dissipated m g h; what a table accelerates to v it has
/// given ½ m v²; what a piece lifts by h it has given m g h; nothing else is lost.
#[test]
fn input_and_dissipation_balance_what_is_stored() {
    let near = |what: &str, expected: f64, got: f64| {
        assert!((got - expected).abs() < 1e-12, "law: {what}: expected {expected} J, got {got} J");
    };
    let fall = (2.0 * GRAVITY * 0.2_f64).sqrt();
    let mut landing = moving(0.0, 0.0);
    landing.linear_velocity.z = -fall;
    let (watch, _) = watched(&[(moving(0.2, 0.0), 0.0), (landing, 0.0)], 0.0);
    near("a fall takes nothing", 0.0, watch.balance.dissipated);
    let states = [(moving(0.2, 0.0), 0.0), (landing, 0.0), (moving(0.0, 0.0), 0.0)];
    let (watch, _) = watched(&states, 0.0);
    near("m g h is dissipated", MASS * GRAVITY * 0.2, watch.balance.dissipated);
    near("nothing was put in", 0.0, watch.balance.input);
    // A body that goes with the table: its speed is that of the table at every look.
    let states = [0.0, 0.1, 0.3, 0.4].map(|v| (moving(0.0, v), v));
    let (watch, _) = watched(&states, 0.4);
    near("½ m v² is put in", 0.5 * MASS * 0.16, watch.balance.input);
    near("nothing is dissipated", 0.0, watch.balance.dissipated);
    // A body hit by a table of 0.4 m/s that it then slides on: half of what is put in is lost.
    let (watch, _) = watched(&[(moving(0.0, 0.0), 0.4), (moving(0.0, 0.4), 0.4)], 0.4);
    near("V m V is put in", MASS * 0.16, watch.balance.input);
    near("½ m V² is dissipated", 0.5 * MASS * 0.16, watch.balance.dissipated);
    let mut watch = Watch::default();
    let low = moving(0.0, 0.0);
    watch.begin(std::iter::once(body(&low)), -0.05, GRAVITY, (0.0, Vector::zeros()), 0.0);
    let lift = MASS * GRAVITY * 0.1;
    watch.given(1.5 * lift);
    let high = moving(0.1, 0.0);
    let _ = watch.look(&Tally::of(std::iter::once(body(&high)), GRAVITY), Vector::zeros(), 1.0);
    near("work of a piece is put in", 1.5 * lift, watch.balance.input);
    near("what does not lift is dissipated", 0.5 * lift, watch.balance.dissipated);
    // Who is let go brings energy, who leaves takes it along: neither is put in or dissipated.
    watch.let_go(body(&high));
    let both = [body(&high), body(&high)];
    let _ = watch.look(&Tally::of(both.into_iter(), GRAVITY), Vector::zeros(), 2.0);
    watch.taken_away(Tally::of(std::iter::once(body(&high)), GRAVITY));
    let _ = watch.look(&Tally::of(std::iter::once(body(&high)), GRAVITY), Vector::zeros(), 3.0);
    near("letting go is no input", 1.5 * lift, watch.balance.input);
    near("leaving is no loss", 0.5 * lift, watch.balance.dissipated);
}

/// Law: of a body that a weight thrice as heavy presses down by h, until both lie, the weight's 3 m
/// g h are put in and 4 m g h dissipated; while both fall freely the weight gives nothing.
#[test]
fn a_weight_gives_what_it_loses() {
    let heavy = |state: &BodyState| {
        let of = |mass: f64| Tally::of(std::iter::once((mass, &INERTIA, state)), GRAVITY);
        of(4.0 * MASS).with_weight(Some(of(3.0 * MASS).energy))
    };
    let top = moving(0.1, 0.0);
    let mut falling = moving(0.0, 0.0);
    falling.linear_velocity.z = -(2.0 * GRAVITY * 0.1_f64).sqrt();
    let mut watch = Watch::default();
    let first = std::iter::once((4.0 * MASS, &INERTIA, &top));
    watch.begin(first, -0.05, GRAVITY, (0.0, Vector::zeros()), 0.0);
    watch.weigh(Some(3.0 * MASS * GRAVITY * 0.1));
    let one = MASS * GRAVITY * 0.1;
    for (n, (state, input, dissipated)) in
        [(falling, 0.0, 0.0), (moving(0.0, 0.0), 3.0 * one, 4.0 * one)].into_iter().enumerate()
    {
        let _ = watch.look(&heavy(&state), Vector::zeros(), n as f64 + 1.0);
        let EnergyBalance { input: given, dissipated: taken } = watch.balance;
        assert!(
            (given - input).abs() < 1e-12 && (taken - dissipated).abs() < 1e-12,
            "law: {input} J given and {dissipated} J dissipated, got {given} and {taken} J, \
             tolerance 1e-12 J"
        );
    }
}
