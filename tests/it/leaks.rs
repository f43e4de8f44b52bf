//! Worlds made and dropped by the hundred: what a process holds must not grow.
//!
//! They are made in a process of their own, this test program started anew for
//! one test, so that nothing else in it asks for memory meanwhile.

use std::{env, fs, process::Command, sync::Arc};

use pluvia::geometry::{ConvexPolyhedron, Pose, Vector};
use pluvia::scenario::{ContactPath, EngineSettings, ManifoldSettings};
use pluvia::world::{
    self, Body, BodyState, Material, Motion, PairCoefficients, PairTable, RememberedContact,
};

use super::soak::Soak;

/// How many worlds the other process is to make; set in that one alone.
const WORLDS: &str = "PLUVIA_LEAK_WORLDS";

/// Worlds after which pools, caches and stacks have their size.
const FIRST: usize = 100;

/// How much more a process may hold at the end than after the first worlds, in
/// KiB: what pages that are used here and there make, not what grows with the
/// number of worlds.
const TOLERANCE: i64 = 1024;

/// Both contact paths, Pluvia's own with one thread and with two.
fn kinds() -> [EngineSettings; 3] {
    let manifold = |threads| EngineSettings {
        contact_path: ContactPath::Manifold,
        manifold: ManifoldSettings { threads, ..Default::default() },
        ..Default::default()
    };
    let bullet = EngineSettings { contact_path: ContactPath::Bullet, ..Default::default() };
    [manifold(1), manifold(2), bullet]
}

fn cuboid(sides: Vector) -> Arc<ConvexPolyhedron> {
    Arc::new(ConvexPolyhedron::cuboid(sides).expect("a box"))
}

/// A world with a driven table, boxes that fall, touch and roll, one of them
/// taken out on the way; stepped, read, told contacts, and dropped.
fn one(settings: &EngineSettings) {
    let pairs = PairTable::uniform(PairCoefficients { friction: 0.5, restitution: 0.3 });
    let down = Vector::new(0.0, 0.0, -9.81);
    let mut world = world::create(settings, down, &pairs).expect("a world");
    let at = |x: f64, z: f64| BodyState::at_rest(Pose::translation(x, 0.0, z));
    let (table, grain) = (cuboid(Vector::new(0.2, 0.2, 0.02)), cuboid(Vector::repeat(0.01)));
    let table = world
        .add(&Body {
            shape: table,
            motion: Motion::Driven,
            material: Material::Wall,
            state: at(0.0, -0.01),
        })
        .expect("added");
    let grains: Vec<_> = (0..12)
        .map(|i| {
            let (x, z) = (0.011 * f64::from(i % 4), 0.0052 + 0.0103 * f64::from(i / 4));
            let motion = Motion::Free { mass: 2.65e-3, inertia: Vector::repeat(4.4e-8) };
            let shape = Arc::clone(&grain);
            let body = Body { shape, motion, material: Material::Grain, state: at(x, z) };
            world.add(&body).expect("added")
        })
        .collect();
    let told = RememberedContact {
        a: table,
        b: grains[0],
        point: Vector::zeros(),
        normal: Vector::new(0.0, 0.0, -1.0),
        force: Vector::new(0.0, 0.0, -0.01),
        feature: [0, 0],
    };
    world.recall(&[told]).expect("told");
    let (mut states, mut contacts, mut remembered) = (Vec::new(), Vec::new(), Vec::new());
    let mut touched = 0;
    for step in 0..12 {
        let x = 1e-4 * f64::from(step);
        world.drive(table, &Pose::translation(x, 0.0, -0.01)).expect("driven");
        world.step().expect("a step");
        world.read(&mut states);
        world.contacts(&mut contacts);
        world.remember(&mut remembered);
        touched += contacts.len();
        if step == 6 {
            world.remove(grains[5]).expect("removed");
        }
    }
    assert!(touched > 12, "the check has contacts, got {touched}");
    // What is refused holds nothing either.
    assert!(world.remove(grains[5]).is_err());
    let other = EngineSettings { contact_threshold_mm: 0.7, ..settings.clone() };
    assert!(world::create(&other, down, &pairs).is_err(), "two thresholds in one process");
}

/// What this process holds in memory, in KiB.
fn resident() -> i64 {
    let status = fs::read_to_string("/proc/self/status").expect("Linux tells");
    let line = status.lines().find(|l| l.starts_with("VmRSS:")).expect("resident memory");
    line.split_whitespace().nth(1).and_then(|n| n.parse().ok()).expect("a number of KiB")
}

/// Says when memory held after each hundred worlds (KiB) grew, as a sentence.
fn growth(held: &[i64]) -> Result<i64, String> {
    let (Some(first), Some(last)) = (held.first(), held.last()) else {
        return Err("nothing was measured".into());
    };
    let grown = last - first;
    if grown > TOLERANCE {
        return Err(format!(
            "law: memory held stays flat, expected at most {TOLERANCE} KiB more after the last \
             worlds than after the first, got {grown} KiB: {held:?}"
        ));
    }
    Ok(grown)
}

#[test]
fn a_growth_is_told_from_none() {
    assert_eq!(growth(&[50_000, 50_000, 50_000]), Ok(0));
    assert_eq!(growth(&[50_000, 50_900, 50_000 + TOLERANCE]), Ok(TOLERANCE));
    assert_eq!(growth(&[50_000, 49_000]), Ok(-1000));
    assert!(growth(&[50_000, 50_001 + TOLERANCE]).is_err(), "law: more is refused");
    assert!(growth(&[]).is_err(), "law: nothing measured is no proof");
    // A kilobyte a world, over two thousand of them.
    let leaking: Vec<i64> = (0..20).map(|hundreds| 50_000 + 100 * hundreds).collect();
    assert!(growth(&leaking).is_err(), "law: a slow leak is seen in the long run");
}

/// The other process: makes worlds, and prints what it holds after each hundred.
#[test]
fn leaks_other_process() {
    let Ok(worlds) = env::var(WORLDS) else { return };
    let worlds: usize = worlds.parse().expect("a number of worlds");
    let kinds = kinds();
    for made in 1..=worlds {
        one(&kinds[made % kinds.len()]);
        if made % FIRST == 0 {
            println!("held {}", resident());
        }
    }
}

/// Makes worlds in another process; what it held after each hundred, in KiB.
fn held(worlds: usize) -> Vec<i64> {
    let this = env::current_exe().expect("this program");
    let output = Command::new(this)
        .args(["--exact", "leaks::leaks_other_process", "--nocapture", "--test-threads=1"])
        .env(WORLDS, worlds.to_string())
        .output()
        .expect("it starts");
    let said = String::from_utf8_lossy(&output.stdout);
    assert!(
        output.status.success(),
        "the other process ended with {}: {said}{}",
        output.status,
        String::from_utf8_lossy(&output.stderr)
    );
    let held = said.split("held ").skip(1).map(|rest| {
        let number = rest.split_whitespace().next().unwrap_or_default();
        number.parse().unwrap_or_else(|_| panic!("a number of KiB: {rest}"))
    });
    let held: Vec<i64> = held.collect();
    assert_eq!(held.len(), worlds / FIRST, "the other process measured: {said}");
    held
}

#[test]
fn worlds_leave_nothing_behind() {
    growth(&held(2 * FIRST)).unwrap_or_else(|grown| panic!("{grown}"));
}

/// `make soak`: two thousand worlds at a time, for as long as there is time.
#[test]
fn soak_leaks() {
    let Some(soak) = Soak::begin() else { return };
    let mut worlds = 0;
    while soak.goes_on() {
        let held = held(20 * FIRST);
        worlds += 20 * FIRST;
        let grown = growth(&held).unwrap_or_else(|grown| panic!("{grown}"));
        println!(
            "soak, worlds: {worlds} made and dropped, the last 2000 in one process, which held \
             {} KiB after the first hundred and {grown} KiB more at the end",
            held[0]
        );
    }
}
