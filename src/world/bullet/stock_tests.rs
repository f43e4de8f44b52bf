//! What only stock Bullet contacts can be told, against what it must do.

use super::tests::{
    GRAVITY, exclusive_turn, free_box, shared_turn, slab, snapshot, state, steps, uniform,
};
use super::*;
use crate::geometry::testing::near;
use crate::scenario::{ContactSolver, InertiaRule, StockSettings};
use crate::units::from_mm;

fn on(stock: StockSettings) -> EngineSettings {
    EngineSettings { contact_solver: ContactSolver::Stock, stock, ..Default::default() }
}

fn world(settings: &EngineSettings) -> BulletBackend {
    BulletBackend::new(settings, GRAVITY, &uniform(0.8, 0.0)).expect("a world")
}

/// A cube of 10 mm on a kinematic slab.
fn cube_on_slab(settings: &EngineSettings) -> (BulletBackend, BodyId, BodyId) {
    let mut world = world(settings);
    let floor = world.add(&slab(Motion::Kinematic)).expect("added");
    let margin = from_mm(settings.stock.collision_margin_mm);
    let at = Vector::new(0.0, 0.0, 0.0051 + 2.0 * margin);
    let cube = world.add(&free_box(Vector::repeat(0.01), at)).expect("added");
    (world, floor, cube)
}

#[test]
fn a_margin_keeps_both_surfaces_apart() {
    let _turn = shared_turn();
    for margin_mm in [0.0, 0.4] {
        let settings = on(StockSettings { collision_margin_mm: margin_mm, ..Default::default() });
        let (mut world, _, cube) = cube_on_slab(&settings);
        steps(&mut world, 480);
        let got = 1e3 * state(&world, cube).pose.translation.z;
        let expected = 5.0 + 2.0 * margin_mm;
        near("a cube of 10 mm rests at 5 mm and both margins", got, expected, 0.05);
        let held = world.effective()["collision_margin_m"].as_f64().expect("a number");
        assert!((held - from_mm(margin_mm)).abs() < 1e-9, "read back: {held} m");
    }
}

#[test]
fn slow_bodies_sleep_after_two_seconds_and_wake_with_the_table() {
    let _turn = shared_turn();
    for sleeping in [false, true] {
        let settings = on(StockSettings { sleeping, ..Default::default() });
        let (mut world, floor, cube) = cube_on_slab(&settings);
        // ISLAND_SLEEPING is 2 (btCollisionObject.h).
        let asleep = |world: &BulletBackend| world.effective()["activation_state"] == 2.0;
        steps(&mut world, 480);
        assert!(!asleep(&world), "law: nothing sleeps within the two seconds");
        steps(&mut world, 3 * 480);
        assert_eq!(asleep(&world), sleeping, "law: it sleeps where that is asked for");
        let at_rest = state(&world, cube);
        if sleeping {
            assert_eq!(at_rest.linear_velocity, Vector::zeros(), "law: what sleeps is at rest");
        }
        // The table shakes: x = A sin 2πft at 3 Hz and 25 mm for a quarter of a cycle.
        let mut furthest: f64 = 0.0;
        for step in 1..=40 {
            let t = f64::from(step) / 480.0;
            let x = 0.025 * (std::f64::consts::TAU * 3.0 * t).sin();
            world.drive(floor, &Pose::translation(x, 0.0, -0.01)).expect("driven");
            world.step().expect("a step");
            furthest = furthest.max(state(&world, cube).pose.translation.x);
        }
        assert!(
            furthest > 0.005,
            "law: friction takes it along whether it slept or not (sleeping {sleeping}): \
             it went {furthest} m, expected more than 0.005 m"
        );
    }
}

#[test]
fn boxes_give_the_inertia_of_the_box_and_the_least_mass_weighs() {
    let _turn = shared_turn();
    let ratio = |inertia, least_mass_g| {
        let settings = on(StockSettings { inertia, least_mass_g, ..Default::default() });
        let mut world = world(&settings);
        let sides = Vector::new(0.01, 0.014, 0.02);
        world.add(&free_box(sides, Vector::zeros())).expect("added");
        let held = world.effective();
        let number = |name: &str| held[name].as_f64().expect("a number");
        (number("largest_inertia_over_exact"), 1e3 * number("lightest_free_body_kg"))
    };
    // 10 × 14 × 20 mm at 2673.9 kg/m³.
    let mass_g = 2673.9 * 2.8e-3;
    // The box of a box is the box; with Bullet's margin of 0.04 units, 0.4 mm at
    // 100 units a metre, the shortest sides grow most: (10.8² + 14.8²)/(10² + 14²).
    let grown = (10.8_f64.powi(2) + 14.8_f64.powi(2)) / (100.0 + 196.0);
    for (rule, least_g, expected) in [
        (InertiaRule::Exact, 0.0, (1.0, mass_g)),
        (InertiaRule::BoundingBox, 0.0, (1.0, mass_g)),
        (InertiaRule::BoundingBoxWithDefaultMargin, 0.0, (grown, mass_g)),
        (InertiaRule::BoundingBox, 1.0, (1.0, mass_g)),
        (InertiaRule::BoundingBox, 20.0, (1.0, 20.0)),
    ] {
        let got = ratio(rule, least_g);
        let near = |a: f64, b: f64| (a - b).abs() < 1e-4 * b;
        assert!(
            near(got.0, expected.0) && near(got.1, expected.1),
            "law: {rule:?} with at least {least_g} g gives (ratio, g) {expected:?}; got {got:?}, \
             tolerance 1e-4 of it"
        );
    }
}

#[test]
fn a_relative_threshold_is_held_as_one() {
    let _turn = exclusive_turn();
    for relative in [0.0, 0.02] {
        let settings =
            on(StockSettings { relative_contact_threshold: relative, ..Default::default() });
        let held = world(&settings).effective()["relative_contact_threshold"].as_f64();
        near(&format!("asked {relative}, held {held:?}"), held.expect("a number"), relative, 1e-7);
    }
}

#[test]
fn our_own_contacts_refuse_all_of_it() {
    let _turn = shared_turn();
    let settings = EngineSettings {
        contact_solver: ContactSolver::Native,
        ..on(StockSettings { collision_margin_mm: 0.1, ..Default::default() })
    };
    let refused = BulletBackend::new(&settings, Vector::zeros(), &uniform(0.8, 0.0));
    assert!(
        matches!(refused, Err(WorldError::BadSetting { ref setting, .. }) if setting == "stock"),
        "law: a margin on the native contact solver is refused"
    );
}

/// Law: what only native contacts do is refused with stock ones, or there is none of it.
#[test]
fn what_only_native_contacts_do_is_refused_or_empty() {
    let _turn = shared_turn();
    let (mut world, floor, cube) = cube_on_slab(&on(StockSettings::default()));
    world.record_substeps();
    steps(&mut world, 48);
    let mut remembered = Vec::new();
    world.remember(&mut remembered);
    assert!(remembered.is_empty(), "law: contacts are not remembered, got {remembered:?}");
    let made_up = RememberedContact {
        a: cube,
        b: floor,
        point: Vector::zeros(),
        normal: Vector::z(),
        force: Vector::z(),
        warm_start: 1.0,
        feature: [0, 0],
    };
    assert!(world.recall(&[made_up]).is_ok(), "law: what is recalled is no fault");
    world.remember(&mut remembered);
    assert!(remembered.is_empty(), "law: nothing is recalled, got {remembered:?}");
    let found = world.find_contacts();
    assert!(
        matches!(&found, Err(WorldError::Engine(said)) if said.contains("only native contacts")),
        "law: contacts are found in steps alone, got {found:?}"
    );
    assert!(world.drives().is_empty(), "law: kinematic bodies go on from no step before");
    assert_eq!(world.recorded_substep(), SubstepRecord::default(), "law: there is no sub-step");
    assert_eq!(world.solver_residual(), None, "law: no residual is measured");
    let pressed = world.add(&slab(Motion::Pressed { mass: 1.0, direction: Vector::z() }));
    let turned = Motion::Turned { inertia: 1.0, axis: Vector::y(), about: Vector::zeros() };
    let turned = world.add(&slab(turned));
    let other = world.add(&slab(Motion::Kinematic)).expect("added");
    let joined = world.join(other, floor);
    for refused in [pressed.map(|_| ()), turned.map(|_| ()), joined] {
        let says = "only native contacts";
        assert!(
            matches!(&refused, Err(WorldError::BadBody(reason)) if reason.contains(says)),
            "law: pressed and turned bodies and bodies of parts are refused, got {refused:?}"
        );
    }
    let there = snapshot(&world).iter().flatten().count();
    assert_eq!(there, 3, "law: what is refused is not in the world");
}

/// Law: a value that Bullet cannot take is refused by the name that a scenario has for it.
#[test]
fn settings_out_of_range_are_refused_by_name() {
    let _turn = shared_turn();
    type Change = fn(&mut EngineSettings);
    let changes: [(&str, Change); 7] = [
        ("length_scale", |s| s.length_scale = f64::NAN),
        ("friction_directions", |s| s.friction_directions = 3),
        ("stock.collision_margin_mm", |s| s.stock.collision_margin_mm = -1.0),
        ("stock.least_mass_g", |s| s.stock.least_mass_g = f64::NAN),
        ("stock.relative_contact_threshold", |s| s.stock.relative_contact_threshold = -0.1),
        ("stock.sleeping_speed_m_per_s", |s| s.stock.sleeping_speed_m_per_s = f64::INFINITY),
        ("stock.sleeping_spin_rad_per_s", |s| s.stock.sleeping_spin_rad_per_s = -1.0),
    ];
    for (name, change) in changes {
        let mut asked = on(StockSettings::default());
        change(&mut asked);
        let made = BulletBackend::new(&asked, Vector::zeros(), &uniform(0.8, 0.0));
        assert!(
            matches!(&made, Err(WorldError::BadSetting { setting, .. }) if setting == name),
            "law: {name} is refused by name"
        );
    }
}
