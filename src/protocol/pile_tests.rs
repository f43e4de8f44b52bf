//! Piles, on a world that follows a script.

use super::testing::*;
use super::*;
use crate::scenario::{BaseKind, BaseSpec, Scenario, SlowPluviationSpec};
use crate::specimen::Base;
use crate::world::scripted::ScriptedWorld;

const FEED_RATE: f64 = 20.0;
const DROP: f64 = 0.012;
const SPOUT: f64 = 0.03;

fn scenario() -> Scenario {
    scenario_of(json!({ "grains": { "total_mass_g": 60, "density_kg_per_m3": 2673.9 } }))
}

fn specimen() -> Specimen {
    specimen_of(&scenario(), 1)
}

fn slow_pluviation(base: BaseSpec, time_limit_s: f64) -> StageSpec {
    StageSpec::SlowPluviation(SlowPluviationSpec {
        feed_rate_grains_per_s: FEED_RATE,
        drop_height_mm: DROP * 1e3,
        spout_diameter_mm: SPOUT * 1e3,
        base,
        base_diameter_mm: 200.0,
        time_limit_s,
    })
}

fn plane(friction: f64) -> BaseSpec {
    BaseSpec { kind: BaseKind::Plane, friction: Some(friction) }
}

/// Time and every present grain's place.
type Observation = (f64, Vec<(usize, Vector)>);

/// Every observation.
struct Seen(Vec<Observation>);

impl Observer for Seen {
    fn observe(&mut self, specimen: &Specimen, moment: Moment) {
        let at = |i: usize| (i, specimen.state.bodies[i].body.pose.translation.vector);
        let present = specimen.present().map(at).collect();
        self.0.push((moment.stage_time, present));
    }
}

fn build(
    make: impl Fn() -> ScriptedWorld + Sync,
    stage: &StageSpec,
) -> (StageOutcome, Vec<Observation>) {
    build_in_segments(None, make, stage)
}

/// The same in segments of a simulated time in s.
fn build_in_segments(
    checkpoint_every_s: Option<f64>,
    make: impl Fn() -> ScriptedWorld + Sync,
    stage: &StageSpec,
) -> (StageOutcome, Vec<Observation>) {
    let mut scenario = scenario();
    scenario.engine.native.checkpoint_every_s = checkpoint_every_s;
    let (make, mut seen) = (scripted_worlds(make), Seen(Vec::new()));
    let outcome = run_stage(&scenario, &make, specimen(), stage, None, &mut seen);
    (outcome.expect("it can be run"), seen.0)
}

/// In a world where nothing falls, each grain counts as the top of the pile
/// once it should have landed: a tower of all of them.
#[test]
fn grains_are_fed_at_their_rate_above_the_pile_and_clear_of_each_other() {
    let (outcome, seen) = build(|| ScriptedWorld::still(STEP), &slow_pluviation(plane(0.5), 60.0));
    let state = &outcome.specimen.state;
    let count = state.bodies.len();
    assert!(count > 20, "{count} grains are enough to see a rate");
    assert!(state.bodies.iter().all(|g| g.fate == Fate::Present), "all have been fed");
    assert_eq!(outcome.warnings, Vec::<String>::new());
    assert!(!state.cylinder && state.funnel.is_none(), "nothing else stands there");
    for (time, present) in &seen {
        let most = (time * FEED_RATE).floor() as usize + 1;
        assert!(
            present.len() <= most,
            "law: at most rate × time + 1 grains, at {time} s expected ≤ {most}, got {}",
            present.len()
        );
    }
    let set = &outcome.specimen.grains;
    let radius = |i: usize| set.grains[i].shape.radius_about_origin();
    let place = |i: usize| state.bodies[i].body.pose.translation.vector;
    let mut lowest = f64::INFINITY;
    for i in 0..count {
        let at = place(i);
        assert!(at.xy().norm() <= SPOUT / 2.0 + 1e-12, "grain {i} under the spout: {at:?}");
        lowest = lowest.min(at.z - radius(i));
        for j in 0..i {
            let gap = (at - place(j)).norm() - radius(i) - radius(j);
            assert!(gap > 0.0, "law: spheres of grains let go are apart, {i} and {j}: {gap} m");
        }
    }
    let expected = DROP + set.rain_clearance();
    near("the first sphere begins the drop height above the base", lowest, expected, 1e-12);
}

#[test]
fn a_feed_that_cannot_end_says_so() {
    // A spout that rises for ever takes its time: half a second is too short.
    let (outcome, _) = build(|| ScriptedWorld::still(STEP), &slow_pluviation(plane(0.5), 0.5));
    let waiting = outcome.specimen.state.bodies.iter().filter(|g| g.fate == Fate::Waiting).count();
    assert!(waiting > 0, "some wait");
    let said = format!("{waiting} grains had not been fed");
    assert!(outcome.warnings.iter().any(|w| w.contains(&said)), "{:?}", outcome.warnings);
}

#[test]
fn what_leaves_the_base_has_fallen_off_or_has_passed_the_floor() {
    let gravity = Vector::new(0.0, 0.0, -9.81);
    // Straight down, through a floor that this world does not have.
    let (outcome, _) =
        build(move || ScriptedWorld::falling(STEP, gravity), &slow_pluviation(plane(0.5), 3.0));
    let fates: Vec<Fate> = outcome.specimen.state.bodies.iter().map(|g| g.fate).collect();
    assert!(fates.contains(&Fate::ThroughWall), "through the floor: {fates:?}");
    assert!(!fates.contains(&Fate::Spilled), "none over the edge: {fates:?}");
    // Shifted sideways while it falls, beyond the edge before it is down; by a
    // speed that it does not have, since energy is watched.
    let aside = Vector::new(5.0, 0.0, 0.0);
    let shifted = move || {
        let script = move |_, state: &BodyState, _, step: f64| {
            let mut next = *state;
            next.linear_velocity += gravity * step;
            next.pose.translation.vector += (next.linear_velocity + aside) * step;
            next
        };
        ScriptedWorld::new(STEP, Box::new(script))
    };
    let (outcome, _) = build(shifted, &slow_pluviation(plane(0.5), 3.0));
    let fates: Vec<Fate> = outcome.specimen.state.bodies.iter().map(|g| g.fate).collect();
    assert!(fates.contains(&Fate::Spilled), "over the edge: {fates:?}");
    assert!(!fates.contains(&Fate::ThroughWall), "none through the floor: {fates:?}");
}

fn fixed(seed: u64, configuration: u32) -> Base {
    let spec = BaseSpec { kind: BaseKind::FixedGrains, friction: None };
    base::build(&spec, 0.1, &specimen().grains, seed, configuration)
}

#[test]
fn fixed_grains_cover_the_base_and_are_sunk_to_half() {
    let base = fixed(1, 1);
    let set = specimen().grains;
    let pitch =
        set.grains.iter().map(|g| g.equivalent_diameter).sum::<f64>() / set.grains.len() as f64;
    // A triangular lattice has one point in √3/2 pitch².
    let expected = std::f64::consts::PI * 0.01 / (3f64.sqrt() / 2.0 * pitch * pitch);
    let got = base.fixed_grains.len() as f64;
    near("area over the lattice's cell", got, expected, 0.05 * expected);
    for fixed in &base.fixed_grains {
        let (low, high) = set.grains[fixed.grain].shape.transformed(&fixed.pose).bounding_box();
        let middle = f64::midpoint(low.z, high.z);
        assert!(middle.abs() < 1e-12, "law: half of its height is below z = 0, middle {middle} m");
        assert!(fixed.pose.translation.vector.xy().norm() <= 0.1, "within the radius");
    }
    assert_eq!(base, fixed(1, 1), "same seed and configuration, same bits");
    assert_ne!(base, fixed(2, 1), "another seed");
    assert_ne!(base, fixed(1, 2), "another configuration");
}

#[test]
fn a_plane_has_its_own_friction_and_fixed_grains_that_of_grains() {
    let setup = Setup::new(&scenario()).expect("a laboratory");
    let mut specimen = specimen();
    let with = |specimen: &Specimen| {
        let pairs = base::pairs(&setup, &specimen.state);
        [Material::Wall, Material::Grain].map(|m| pairs.get(Material::Grain, m).friction)
    };
    assert_eq!(with(&specimen), [0.5, 0.793], "the laboratory's own without a base");
    assert!(base_pieces(&specimen.grains, specimen.state.base.as_ref()).expect("none").is_empty());
    specimen.state.base = Some(base::build(&plane(0.3), 0.1, &specimen.grains, 1, 1));
    assert_eq!(with(&specimen), [0.3, 0.793], "the plane's between grains and floor");
    let pieces = base_pieces(&specimen.grains, specimen.state.base.as_ref()).expect("a floor");
    assert_eq!((pieces.len(), pieces[0].1), (1, Material::Wall), "a floor of wall");
    specimen.state.base = Some(fixed(1, 1));
    assert_eq!(with(&specimen), [0.5, 0.793], "fixed grains change no pair");
    let pieces = base_pieces(&specimen.grains, specimen.state.base.as_ref()).expect("a base");
    assert!(pieces.len() > 100 && pieces.iter().all(|(_, m)| *m == Material::Grain));
}

/// In a world where nothing moves, segments can be told by nothing: what waits in
/// the spout, and the order of random numbers, cross every seam.
#[test]
fn a_pile_fed_in_segments_is_the_same_pile() {
    let stage = slow_pluviation(plane(0.5), 3.0);
    let make = || ScriptedWorld::still(STEP);
    let (whole, seen) = build(make, &stage);
    for segment in [0.02, 0.1, 0.9] {
        let (in_segments, also_seen) = build_in_segments(Some(segment), make, &stage);
        assert_eq!(
            seen, also_seen,
            "law: segments of {segment} s: the same grains at the same times"
        );
        assert_eq!(
            whole.specimen.state, in_segments.specimen.state,
            "law: segments of {segment} s"
        );
        assert_eq!(whole.warnings, in_segments.warnings, "law: segments of {segment} s");
        assert_eq!(whole.steps, in_segments.steps, "law: segments of {segment} s");
    }
}
