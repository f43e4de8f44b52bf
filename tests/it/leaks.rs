//! Worlds made and dropped by the hundred: what a process holds must not grow.
//!
//! They are made in a process of their own, this test program started anew for
//! one test, so that nothing else in it asks for memory meanwhile. What it holds
//! is counted by the allocator, to the byte: pages that the system has put behind
//! it come and go by themselves, large ones by megabytes.

use std::{env, fs, hint::black_box, mem, process::Command, sync::Arc};

use pluvia::geometry::{ConvexPolyhedron, Pose, Vector};
use pluvia::scenario::{ContactSolver, EngineSettings, NativeSettings};
use pluvia::world::bullet::probe::{HullPair, ProbeSettings, bytes_handed_out};
use pluvia::world::{
    self, Body, BodyState, Material, Motion, PairCoefficients, PairTable, RememberedContact, World,
};

use super::soak::Ground;

/// How many worlds the other process is to make, and after how many each it is to
/// say what it holds; set in that one alone.
const WORLDS: &str = "PLUVIA_LEAK_WORLDS";

/// What the other process leaks with every world, by intent; see [`Leak`].
const LEAKS: &str = "PLUVIA_LEAK";

/// Worlds after which pools, caches and stacks have their size.
const FIRST: usize = 100;

/// The same where something is leaked by intent: enough to be found, too few to
/// take long.
const FEW: usize = 20;

/// How many bytes more the process may have been handed out at the end than
/// after the first worlds. Measured: none.
const MORE_BYTES: i64 = 256;

/// How many KiB more it may have mapped, whoever asked for them: one piece that
/// the allocator takes at once. Measured: none. A page leaked by each of a hundred
/// worlds, or one block of a pool (cpp/pool.cpp), is more.
const MORE_MAPPED_KIB: i64 = 256;

/// How the allocator works in the other process: one arena, nothing set aside
/// by the threads, which would count as handed out, and large blocks always
/// mapped by themselves.
const ALLOCATOR: &str = "glibc.malloc.arena_max=1:glibc.malloc.tcache_count=0:\
                         glibc.malloc.mmap_threshold=131072";

/// What a process holds.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Held {
    /// Bytes that the allocator has handed out.
    bytes: i64,
    /// KiB of memory that can be written, whether it has been yet or not; without
    /// the main thread's stack.
    mapped_kib: i64,
}

/// What may be leaked by intent, to see that it is found.
#[derive(Debug, Clone, Copy)]
enum Leak {
    /// Nothing.
    Nothing,
    /// Rust leaks this number of bytes per world.
    Bytes(usize),
    /// A pair of hulls a world, made in C++.
    Hulls,
    /// One world alone, with the blocks of its pools.
    World,
}

impl Leak {
    /// As the other process reads it.
    fn told(self) -> String {
        match self {
            Self::Nothing => "nothing".into(),
            Self::Bytes(bytes) => bytes.to_string(),
            Self::Hulls => "hulls".into(),
            Self::World => "world".into(),
        }
    }

    /// What this process was told.
    fn asked() -> Self {
        match env::var(LEAKS).as_deref() {
            Err(_) | Ok("nothing") => Self::Nothing,
            Ok("hulls") => Self::Hulls,
            Ok("world") => Self::World,
            Ok(bytes) => Self::Bytes(bytes.parse().expect("a number of bytes")),
        }
    }

    /// Leaks with world number `made`, which is not needed any more.
    fn with(self, made: usize, world: Box<dyn World + Send>) {
        match self {
            Self::Bytes(bytes) => mem::forget(black_box(vec![1_u8; bytes])),
            Self::Hulls => {
                let cube = ConvexPolyhedron::cuboid(Vector::repeat(0.01)).expect("a box");
                let pair = HullPair::new(&cube, &cube, ProbeSettings::default());
                mem::forget(pair.expect("a pair"));
            }
            Self::World if made == FEW + 1 => mem::forget(world),
            Self::World | Self::Nothing => {}
        }
    }
}

/// Both contact solvers, Pluvia's own with one thread and with two.
fn kinds() -> [EngineSettings; 3] {
    let native = |threads: u32| EngineSettings {
        contact_solver: ContactSolver::Native,
        native: NativeSettings { threads: Some(threads), ..Default::default() },
        ..Default::default()
    };
    let bullet = EngineSettings { contact_solver: ContactSolver::Stock, ..Default::default() };
    [native(1), native(2), bullet]
}

fn cuboid(sides: Vector) -> Arc<ConvexPolyhedron> {
    Arc::new(ConvexPolyhedron::cuboid(sides).expect("a box"))
}

/// A world with a kinematic table, boxes that fall, touch and roll, one of them
/// taken out on the way; stepped, read, and told contacts.
fn one(settings: &EngineSettings) -> Box<dyn World + Send> {
    let pairs = PairTable::uniform(PairCoefficients { friction: 0.5, restitution: 0.3 });
    let down = Vector::new(0.0, 0.0, -9.81);
    let mut world = world::create(settings, down, &pairs).expect("a world");
    let at = |x: f64, z: f64| BodyState::at_rest(Pose::translation(x, 0.0, z));
    let (table, grain) = (cuboid(Vector::new(0.2, 0.2, 0.02)), cuboid(Vector::repeat(0.01)));
    let table = world
        .add(&Body {
            shape: table,
            motion: Motion::Kinematic,
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
        warm_start: 1.0,
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
    let other = EngineSettings { length_scale: 2.0 * settings.length_scale, ..settings.clone() };
    let stock = settings.contact_solver == ContactSolver::Stock;
    let beside = world::create(&other, down, &pairs);
    assert_eq!(beside.is_err(), stock, "law: stock worlds alone have one margin for the process");
    world
}

/// What this process holds.
fn held_here() -> Held {
    let status = fs::read_to_string("/proc/self/status").expect("Linux tells");
    let line = status.lines().find(|l| l.starts_with("VmData:")).expect("memory mapped");
    Held {
        bytes: bytes_handed_out().expect("glibc tells"),
        mapped_kib: line.split_whitespace().nth(1).and_then(|n| n.parse().ok()).expect("KiB"),
    }
}

/// Says when memory held grew from the first to the last measurement, as a
/// sentence; else by how many bytes it did.
fn growth(held: &[Held]) -> Result<i64, String> {
    let (Some(first), Some(last)) = (held.first(), held.last()) else {
        return Err("nothing was measured".into());
    };
    let bytes = last.bytes - first.bytes;
    let mapped_kib = last.mapped_kib - first.mapped_kib;
    if bytes > MORE_BYTES || mapped_kib > MORE_MAPPED_KIB {
        return Err(format!(
            "law: memory held stays flat, expected at most {MORE_BYTES} bytes handed out and \
             {MORE_MAPPED_KIB} KiB mapped more after the last worlds than after the first, got \
             {bytes} bytes and {mapped_kib} KiB: {held:?}"
        ));
    }
    Ok(bytes)
}

#[test]
fn a_growth_is_told_from_none() {
    let held = |bytes, mapped_kib| Held { bytes, mapped_kib };
    let first = held(50_000, 9000);
    assert_eq!(growth(&[first, first, first]), Ok(0));
    assert_eq!(growth(&[first, held(90_000, 9000), held(50_016, 9100)]), Ok(16));
    assert_eq!(growth(&[first, held(49_000, 8000)]), Ok(-1000));
    let bytes = growth(&[first, held(50_001 + MORE_BYTES, 9000)]);
    assert!(bytes.is_err(), "law: more bytes are refused");
    let mapped = growth(&[first, held(50_000, 9001 + MORE_MAPPED_KIB)]);
    assert!(mapped.is_err(), "law: more that is mapped is refused");
    assert!(growth(&[]).is_err(), "law: nothing measured is no proof");
}

/// The other process: makes worlds, and prints what it holds after each round.
#[test]
fn leaks_other_process() {
    let Ok(worlds) = env::var(WORLDS) else { return };
    let (worlds, each) = worlds.split_once(" by ").expect("two numbers");
    let worlds: usize = worlds.parse().expect("a number of worlds");
    let each: usize = each.parse().expect("a number of worlds");
    let (kinds, leak) = (kinds(), Leak::asked());
    for made in 1..=worlds {
        leak.with(made, one(&kinds[made % kinds.len()]));
        if made % each == 0 {
            let Held { bytes, mapped_kib } = held_here();
            println!("held {bytes} {mapped_kib}");
        }
    }
}

/// Makes worlds in another process; what it held after each round.
fn held(worlds: usize, each: usize, leak: Leak) -> Vec<Held> {
    let this = env::current_exe().expect("this program");
    let output = Command::new(this)
        .args(["--exact", "leaks::leaks_other_process", "--nocapture", "--test-threads=1"])
        .env(WORLDS, format!("{worlds} by {each}"))
        .env(LEAKS, leak.told())
        .env("GLIBC_TUNABLES", ALLOCATOR)
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
        let mut numbers = rest.split_whitespace().map(|n| n.parse().expect("a number"));
        let mut next = || numbers.next().unwrap_or_else(|| panic!("two numbers: {rest}"));
        Held { bytes: next(), mapped_kib: next() }
    });
    let held: Vec<Held> = held.collect();
    assert_eq!(held.len(), worlds / each, "the other process measured: {said}");
    held
}

#[test]
fn worlds_leave_nothing_behind() {
    growth(&held(2 * FIRST, FIRST, Leak::Nothing)).unwrap_or_else(|grown| panic!("{grown}"));
}

#[test]
fn what_worlds_leave_behind_is_found() {
    for leak in [Leak::Bytes(1024), Leak::Bytes(1), Leak::Hulls, Leak::World] {
        let held = held(2 * FEW, FEW, leak);
        assert!(growth(&held).is_err(), "law: {leak:?} is found, got {held:?}");
    }
    let none = held(2 * FEW, FEW, Leak::Nothing);
    assert!(growth(&none).is_ok(), "law: nothing is found where nothing is leaked, got {none:?}");
}

/// `make soak`: two thousand worlds in a process.
pub fn round(ground: &mut Ground) {
    let held = held(20 * FIRST, FIRST, Leak::Nothing);
    growth(&held).unwrap_or_else(|grown| panic!("{grown}"));
    let outcome = "made and dropped, as many bytes held at the end as after the first hundred";
    ground.log.cases("worlds", "both contact solvers", outcome, 20 * FIRST as u64);
}
